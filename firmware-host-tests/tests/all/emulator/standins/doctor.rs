//! Changes what packets of samples say, whatever their protocol.

use ratetable_firmware_host_tests::standin::Make;
use ratetable_protocols::{ilabs, mavlink, mip, msp, sbg, vectornav};

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
        Make::Px4Vectornav => vectornav::Decoder::new().feed(packet, |received| match received {
            Ok(vectornav::Packet::Inertial(mut it)) => {
                floats([&mut it.gyro, &mut it.accel, &mut [0.0; 3]]);
                changed = Some(encoded(&vectornav::Packet::Inertial(it)));
            }
            Ok(vectornav::Packet::Navigation(mut it)) => {
                floats([&mut [0.0; 3], &mut [0.0; 3], &mut it.mag]);
                changed = Some(encoded(&vectornav::Packet::Navigation(it)));
            }
            _ => {}
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
        Make::ArdupilotIlabs | Make::Px4Ilabs => changed = frame(packet, change),
        Make::ArdupilotSbg => changed = unit(packet, change),
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

/// Whether a packet has samples of the gyro: one of PX4's with groups 36 has the field alone.
pub fn has_samples(make: Make, packet: &[u8]) -> bool {
    let mut has = false;
    doctor(make, packet, &mut |_| has = true);
    has && !(make == Make::Px4Vectornav && packet.get(1) == Some(&0x36))
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

/// A frame of an Inertial Labs unit changed, its vectors as forward, right, down; `None` of any other.
fn frame(packet: &[u8], change: &mut dyn FnMut(&mut Vectors)) -> Option<Vec<u8>> {
    let mut told = None;
    ilabs::Decoder::new().feed(packet, |received| told = received.ok());
    let mut it = told?;
    // Its own inverse.
    let turned = |[x, y, z]: [f64; 3]| [y, x, -z];
    let counts = [it.gyro?.map(f64::from), it.accel?.map(f64::from), it.mag?.map(f64::from)];
    let mut vectors = counts.map(turned);
    change(&mut vectors);
    let [gyro, accel, mag] = vectors.map(turned);
    it.gyro = Some(gyro.map(|count| count.round() as i32));
    it.accel = Some(accel.map(|count| count.round() as i32));
    it.mag = Some(mag.map(|count| count.round() as i16));
    let mut bytes = [0; ilabs::MAX_LEN];
    let len = ilabs::encode(&it, &mut bytes).unwrap();
    Some(bytes[..len].to_vec())
}

/// A packet of an SBG Systems unit changed: IMU_SHORT has no field and MAG no gyro; `None` of any other.
fn unit(packet: &[u8], change: &mut dyn FnMut(&mut Vectors)) -> Option<Vec<u8>> {
    let mut told = None;
    sbg::Decoder::new().feed(packet, |received| told = received.ok().and_then(|received| received.packet));
    let changed = match told? {
        sbg::Packet::ImuShort(mut it) => {
            let mut vectors = [it.gyro.map(f64::from), it.accel.map(f64::from), [0.0; 3]];
            change(&mut vectors);
            [it.gyro, it.accel] = [vectors[0], vectors[1]].map(|v| v.map(|count| count.round() as i32));
            sbg::Packet::ImuShort(it)
        }
        sbg::Packet::Mag(mut it) => {
            let mut vectors = [[0.0; 3], it.accel.map(f64::from), it.field.map(f64::from)];
            change(&mut vectors);
            [it.accel, it.field] = [vectors[1], vectors[2]].map(|v| v.map(|c| c as f32));
            sbg::Packet::Mag(it)
        }
        _ => return None,
    };
    let mut bytes = [0; sbg::MAX_LEN];
    let len = sbg::encode(&changed, &mut bytes).unwrap();
    Some(bytes[..len].to_vec())
}

/// A VN-100's packet.
pub fn encoded(packet: &vectornav::Packet) -> Vec<u8> {
    let mut bytes = [0; vectornav::MAX_LEN];
    let len = vectornav::encode(packet, &mut bytes).unwrap();
    bytes[..len].to_vec()
}
