//! Changes what packets of samples say, whatever their protocol.

use ratetable_firmware_host_tests::standin::Make;
use ratetable_protocols::{mavlink, mip, msp, vectornav};

/// Gyro, accel and mag as they stand in a packet.
pub type Vectors = [[f64; 3]; 3];

/// The packet with its samples changed, or as it is if it has none.
pub fn doctor(make: Make, packet: &[u8], change: &mut dyn FnMut(&mut Vectors)) -> Vec<u8> {
    let mut floats = |[gyro, accel, mag]: [&mut [f32; 3]; 3]| {
        let mut vectors = [*gyro, *accel, *mag].map(|vector| vector.map(f64::from));
        change(&mut vectors);
        [*gyro, *accel, *mag] = vectors.map(|vector| vector.map(|c| c as f32));
    };
    let mut changed = None;
    match make {
        Make::Px4 | Make::Px4Sitl => mavlink::Decoder::new().feed(packet, |received| {
            if let Ok(mavlink::Received {
                header, message: Some(mavlink::Message::HilSensor(mut it)), ..
            }) = received
            {
                floats([&mut it.gyro, &mut it.accel, &mut it.mag]);
                let mut bytes = [0; mavlink::MAX_LEN];
                let len = mavlink::encode(&header, &mavlink::Message::HilSensor(it), &mut bytes).unwrap();
                changed = Some(bytes[..len].to_vec());
            }
        }),
        Make::Ardupilot => vectornav::Decoder::new().feed(packet, |received| {
            if let Ok(vectornav::Packet::Imu(mut it)) = received {
                floats([&mut it.gyro, &mut it.accel, &mut it.mag]);
                changed = Some(encoded(&vectornav::Packet::Imu(it)));
            }
        }),
        Make::ArdupilotMip => mip::Decoder::new().feed(packet, |received| {
            let mut it = received.unwrap();
            let (Some(gyro), Some(accel), Some(mag)) = (&mut it.gyro, &mut it.accel, &mut it.mag) else {
                return;
            };
            floats([gyro, accel, mag]);
            let mut bytes = [0; mip::MAX_LEN];
            let len = mip::encode(&it, &mut bytes).unwrap();
            changed = Some(bytes[..len].to_vec());
        }),
        // Its own tests change its packets.
        Make::Betaflight => {}
        Make::Inav => {
            changed = simulator(packet, |it| {
                let mut vectors = [it.gyro, it.accel, it.mag].map(|vector| vector.map(f64::from));
                change(&mut vectors);
                [it.gyro, it.accel, it.mag] = vectors.map(|vector| vector.map(|c| c.round() as i16));
            })
        }
    }
    changed.unwrap_or_else(|| packet.to_vec())
}

/// Whether a packet has samples.
pub fn has_samples(make: Make, packet: &[u8]) -> bool {
    let mut has = false;
    doctor(make, packet, &mut |_| has = true);
    has
}

/// A simulator message changed; `None` of any other.
pub fn simulator(packet: &[u8], change: impl FnOnce(&mut msp::simulator::Repr)) -> Option<Vec<u8>> {
    let mut found = None;
    msp::Decoder::new().feed(packet, |received| {
        if let Ok(msp::Received { message: Some(msp::Message::Simulator(it)), .. }) = received {
            found = Some(it);
        }
    });
    let mut it = found?;
    change(&mut it);
    let mut bytes = [0; msp::MAX_LEN];
    let len = msp::encode(&msp::Message::Simulator(it), &mut bytes).unwrap();
    Some(bytes[..len].to_vec())
}

/// A VN-100's packet.
pub fn encoded(packet: &vectornav::Packet) -> Vec<u8> {
    let mut bytes = [0; vectornav::MAX_LEN];
    let len = vectornav::encode(packet, &mut bytes).unwrap();
    bytes[..len].to_vec()
}
