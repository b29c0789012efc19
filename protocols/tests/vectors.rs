//! Golden packets made by other implementations, both ways, and shown by the documentation.

mod common;

use common::{int, mavlink_header, mavlink_message, mpu_packet, vectors};
use ratetable_protocols::{mavlink, mpu};

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
        };
        let mut seen = Vec::new();
        mavlink::Decoder::new().feed(&vector.bytes, |received| seen.push(received));
        assert_eq!(seen, [Ok(expected)], "{}", vector.name());
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
    for format in ["mpu", "mavlink"] {
        let path = format!("{}/../docs/wire/{format}.md", env!("CARGO_MANIFEST_DIR"));
        let page = std::fs::read_to_string(&path).unwrap();
        for vector in vectors(format) {
            assert!(page.contains(vector.name()), "{path} lacks {}", vector.name());
            assert!(page.contains(vector.hex()), "{path} lacks {}", vector.hex());
        }
    }
}
