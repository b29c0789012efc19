//! Golden packets made by other implementations, both ways, and shown by the documentation.

use super::common::{
    betaflight_packet, ilabs_frame, int, mavlink_header, mavlink_message, mip_packet, mpu_packet,
    msp_direction, msp_message, sbg_packet, vectornav_packet, vectors,
};
use ratetable_protocols::{Error, betaflight, ilabs, mavlink, mip, mpu, msp, sbg, vectornav};

#[test]
fn mpu_packets_are_the_golden_bytes() {
    for vector in vectors("mpu") {
        let (seq, t_us) = (int(&vector.json["seq"]), int(&vector.json["t_us"]));
        let mut out = [0xee; mpu::MAX_LEN];
        let len = mpu::encode(seq, t_us, &mpu_packet(&vector.json), &mut out).unwrap();
        assert_eq!(out[..len], vector.bytes, "{}", vector.name());
    }
}

#[test]
fn golden_mpu_bytes_are_the_packets() {
    for vector in vectors("mpu") {
        let expected = mpu::Received {
            seq: int(&vector.json["seq"]),
            t_us: int(&vector.json["t_us"]),
            packet: mpu_packet(&vector.json),
        };
        let mut seen = Vec::new();
        mpu::Decoder::new().feed(&vector.bytes, |received| seen.push(received));
        assert_eq!(seen, [Ok(expected)], "{}", vector.name());
    }
}

#[test]
fn mavlink_packets_are_the_golden_bytes() {
    for vector in vectors("mavlink") {
        let message = mavlink_message(&vector.json);
        let mut out = [0xee; mavlink::MAX_LEN];
        let len = mavlink::encode(&mavlink_header(&vector.json), &message, &mut out).unwrap();
        assert_eq!(out[..len], vector.bytes, "{}", vector.name());
    }
}

#[test]
fn golden_mavlink_bytes_are_the_messages() {
    for vector in vectors("mavlink") {
        let message = mavlink_message(&vector.json);
        let expected = mavlink::Received {
            header: mavlink_header(&vector.json),
            id: message.id(),
            message: Some(message),
            checked: true,
            stamp_us: None,
            len: vector.bytes.len(),
            skipped: 0,
        };
        let mut seen = Vec::new();
        mavlink::Decoder::new().feed(&vector.bytes, |received| seen.push(received));
        assert_eq!(seen, [Ok(expected)], "{}", vector.name());
    }
}

#[test]
fn msp_frames_are_the_golden_bytes_and_back() {
    for vector in vectors("msp") {
        let (direction, message) = (msp_direction(&vector.json), msp_message(&vector.json));
        let mut out = [0xee; msp::MAX_LEN];
        let len = msp::encode(&message, &mut out).unwrap();
        assert_eq!(out[..len], vector.bytes, "{}", vector.name());
        let expected =
            msp::Received { direction, command: int(&vector.json["command"]), message: Some(message) };
        let mut seen = Vec::new();
        msp::Decoder::new().feed(&vector.bytes, |received| seen.push(received));
        assert_eq!(seen, [Ok(expected)], "{}", vector.name());
    }
}

#[test]
fn vectornav_packets_are_the_golden_bytes_and_back() {
    for vector in vectors("vectornav") {
        let packet = vectornav_packet(&vector.json);
        let mut out = [0xee; vectornav::MAX_LEN];
        let len = vectornav::encode(&packet, &mut out).unwrap();
        assert_eq!(out[..len], vector.bytes, "{}", vector.name());
        let mut seen = Vec::new();
        vectornav::Decoder::new().feed(&vector.bytes, |received| seen.push(received));
        assert_eq!(seen, [Ok(packet)], "{}", vector.name());
    }
}

#[test]
fn mip_packets_are_the_golden_bytes_and_back() {
    for vector in vectors("mip") {
        let packet = mip_packet(&vector.json);
        let mut out = [0xee; mip::MAX_LEN];
        let len = mip::encode(&packet, &mut out).unwrap();
        assert_eq!(out[..len], vector.bytes, "{}", vector.name());
        let mut seen = Vec::new();
        mip::Decoder::new().feed(&vector.bytes, |received| seen.push(received));
        assert_eq!(seen, [Ok(packet)], "{}", vector.name());
    }
}

#[test]
fn ilabs_frames_are_the_golden_bytes_and_back() {
    for vector in vectors("ilabs") {
        let frame = ilabs_frame(&vector.json);
        let mut out = [0xee; ilabs::MAX_LEN];
        let len = ilabs::encode(&frame, &mut out).unwrap();
        assert_eq!(out[..len], vector.bytes, "{}", vector.name());
        let mut seen = Vec::new();
        ilabs::Decoder::new().feed(&vector.bytes, |received| seen.push(received));
        assert_eq!(seen, [Ok(frame)], "{}", vector.name());
    }
}

#[test]
fn sbg_packets_are_the_golden_bytes_and_back() {
    for vector in vectors("sbg") {
        let packet = sbg_packet(&vector.json);
        let mut out = [0xee; sbg::MAX_LEN];
        let len = sbg::encode(&packet, &mut out).unwrap();
        assert_eq!(out[..len], vector.bytes, "{}", vector.name());
        let (class, id) = packet.kind();
        let mut seen = Vec::new();
        sbg::Decoder::new().feed(&vector.bytes, |received| seen.push(received));
        assert_eq!(seen, [Ok(sbg::Received { class, id, packet: Some(packet) })], "{}", vector.name());
    }
}

#[test]
fn betaflight_packets_are_the_golden_bytes_and_back() {
    for vector in vectors("betaflight") {
        let packet = betaflight_packet(&vector.json);
        let mut out = [0xee; betaflight::MAX_LEN];
        let len = betaflight::encode(&packet, &mut out).unwrap();
        assert_eq!(out[..len], vector.bytes, "{}", vector.name());
        let mut seen = Vec::new();
        betaflight::Decoder::new().feed(&vector.bytes, |received| seen.push(received));
        assert_eq!(seen, [Ok(packet)], "{}", vector.name());
    }
}

/// It has no checksum, so that a flipped bit is another packet or none, and never this one.
#[test]
fn a_golden_betaflight_packet_with_one_bit_flipped_is_another() {
    for vector in vectors("betaflight") {
        let whole = betaflight_packet(&vector.json);
        flip_every_bit(&vector.bytes, |hurt| {
            // As written, for which −0 is not 0.
            let expected = format!("{:?}", Ok::<_, Error>(whole));
            let differ = |received: Result<_, _>| assert_ne!(format!("{received:?}"), expected);
            let mut decoder = betaflight::Decoder::new();
            decoder.feed(hurt, differ);
            decoder.finish(differ);
        });
    }
}

#[test]
fn every_golden_packet_with_one_bit_flipped_is_refused() {
    for vector in vectors("mpu") {
        flip_every_bit(&vector.bytes, |hurt| {
            mpu::Decoder::new().feed(hurt, |received| assert!(received.is_err()));
        });
    }
    for vector in vectors("mavlink") {
        let whole = mavlink_message(&vector.json);
        flip_every_bit(&vector.bytes, |hurt| {
            let mut decoder = mavlink::Decoder::new();
            let refuse = |received: Result<mavlink::Received, _>| {
                let message = received.ok().and_then(|received| received.message);
                assert_ne!(message, Some(whole));
                assert_eq!(message, None);
            };
            decoder.feed(hurt, refuse);
            decoder.finish(refuse);
        });
    }
    for vector in vectors("msp") {
        let whole = msp_message(&vector.json);
        flip_every_bit(&vector.bytes, |hurt| {
            // The direction is not under the checksum.
            let turned = hurt[2] != vector.bytes[2];
            let refuse = |received: Result<msp::Received, _>| {
                assert!(turned || received.is_err());
                assert_ne!(received.ok().and_then(|received| received.message), Some(whole));
            };
            let mut decoder = msp::Decoder::new();
            decoder.feed(hurt, refuse);
            decoder.finish(refuse);
        });
    }
    for vector in vectors("vectornav") {
        let whole = vectornav_packet(&vector.json);
        flip_every_bit(&vector.bytes, |hurt| {
            // A line's checksum may be in small letters, and its end need not be CR LF.
            let line = matches!(whole, vectornav::Packet::Line(_));
            let said = &hurt[..hurt.len() - 4];
            let harmless = line && *said == vector.bytes[..said.len()];
            let refuse = |received: Result<_, _>| assert!(harmless || received.is_err());
            let mut decoder = vectornav::Decoder::new();
            decoder.feed(hurt, refuse);
            decoder.finish(refuse);
        });
    }
    for vector in vectors("mip") {
        flip_every_bit(&vector.bytes, |hurt| {
            let refuse = |received: Result<_, _>| assert!(received.is_err());
            let mut decoder = mip::Decoder::new();
            decoder.feed(hurt, refuse);
            decoder.finish(refuse);
        });
    }
    for vector in vectors("ilabs") {
        flip_every_bit(&vector.bytes, |hurt| {
            let refuse = |received: Result<_, _>| assert!(received.is_err());
            let mut decoder = ilabs::Decoder::new();
            decoder.feed(hurt, refuse);
            decoder.finish(refuse);
        });
    }
    for vector in vectors("sbg") {
        flip_every_bit(&vector.bytes, |hurt| {
            let refuse = |received: Result<_, _>| assert!(received.is_err());
            let mut decoder = sbg::Decoder::new();
            decoder.feed(hurt, refuse);
            decoder.finish(refuse);
        });
    }
}

fn flip_every_bit(bytes: &[u8], mut check: impl FnMut(&[u8])) {
    for bit in 0..bytes.len() * 8 {
        let mut hurt = bytes.to_vec();
        hurt[bit / 8] ^= 1 << (bit % 8);
        check(&hurt);
    }
}

#[test]
fn the_documentation_shows_every_vector() {
    for format in ["mpu", "mavlink", "msp", "vectornav", "mip", "ilabs", "sbg", "betaflight"] {
        let path = format!("{}/../docs/wire/{format}.md", env!("CARGO_MANIFEST_DIR"));
        let page = std::fs::read_to_string(&path).unwrap();
        for vector in vectors(format) {
            assert!(page.contains(vector.name()), "{path} lacks {}", vector.name());
            assert!(page.contains(vector.hex()), "{path} lacks {}", vector.hex());
        }
    }
}
