//! Encodes and decodes packets with nothing but buffers: `encode` and `decode` here use `core` alone, as a firmware's
//! would (an example has a `main`, which needs `std`).
//!
//! `cargo run -p ratetable-protocols --example packets`

#![expect(clippy::print_stdout, reason = "an example says what it found")]

use ratetable_protocols::mpu::{self, Decoder, Packet, gyro};

/// A gyroscope's packet into a buffer; its length.
fn encode(counts: [i16; 3], seq: u8, t_us: u32, buffer: &mut [u8; mpu::MAX_LEN]) -> Option<usize> {
    mpu::encode(seq, t_us, &Packet::Gyro(gyro::Repr { gyro: counts }), buffer).ok()
}

/// The sum of every count in a stream, and how many packets were damaged.
fn decode(stream: &[u8]) -> ([i32; 3], u32) {
    let (mut decoder, mut sum, mut damaged) = (Decoder::new(), [0; 3], 0);
    decoder.feed(stream, |received| match received {
        Ok(received) => {
            if let Packet::Gyro(gyro) = received.packet {
                (0..3).for_each(|axis| sum[axis] += i32::from(gyro.gyro[axis]));
            }
        }
        Err(_) => damaged += 1,
    });
    (sum, damaged)
}

fn main() {
    let (mut stream, mut len) = ([0; 3 * mpu::MAX_LEN], 0);
    for k in 0..3 {
        let mut buffer = [0; mpu::MAX_LEN];
        let n = encode([k, 10 * k, -k], k as u8, 1000 * k as u32, &mut buffer)
            .expect("MAX_LEN holds every packet");
        stream[len..len + n].copy_from_slice(&buffer[..n]);
        len += n;
    }
    let (sum, damaged) = decode(&stream[..len]);
    println!("{len} bytes, sums {sum:?}, {damaged} damaged");
    assert_eq!((sum, damaged), ([3, 30, -3], 0));
    // One flipped bit costs one packet.
    stream[4] ^= 0x80;
    let (sum, damaged) = decode(&stream[..len]);
    assert_eq!((sum, damaged), ([3, 30, -3], 1));
}
