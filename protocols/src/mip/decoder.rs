//! Packets out of a stream of bytes, however it is cut up.

use super::{CHECKSUM_LEN, HEADER_LEN, START, fletcher, imu};
use crate::error::Error;
use crate::scanner::{Format, Verdict, decoder};

/// The longest packet and the byte after it.
const HELD_LEN: usize = HEADER_LEN + u8::MAX as usize + CHECKSUM_LEN + 1;

decoder! {
    /// Finds packets in a stream; holds what has come of the next one.
    ///
    /// After damage it looks on from the byte behind the false start, so that a damaged length hides no
    /// packet.
    Mip in HELD_LEN => imu::Repr;
    /// Takes more of the stream and calls `on` with each packet that it completes.
    ///
    /// Damage is reported once, however many bytes it takes to be in step again:
    /// [`Error::Checksum`], or [`Error::Malformed`] where no packet starts. A whole packet of
    /// another descriptor is [`Error::UnknownType`].
    feed
}

/// How a packet is recognised.
struct Mip;

impl Format for Mip {
    type Packet = imu::Repr;

    fn may_start(byte: u8) -> bool {
        byte == START[0]
    }

    fn judge(held: &[u8]) -> Verdict<imu::Repr> {
        let start = held.len().min(START.len());
        if held[..start] != START[..start] {
            return Verdict::Not(Error::Malformed);
        }
        let &[_, _, descriptor, len, ..] = held else { return Verdict::Wait };
        let sum_at = HEADER_LEN + usize::from(len);
        let Some(said) = held.get(sum_at..sum_at + CHECKSUM_LEN) else { return Verdict::Wait };
        if fletcher(&held[..sum_at]) != said {
            return Verdict::Not(Error::Checksum);
        }
        Verdict::Packet(parse(descriptor, &held[HEADER_LEN..sum_at]), sum_at + CHECKSUM_LEN)
    }
}

/// Reads the fields of a packet.
fn parse(descriptor: u8, fields: &[u8]) -> Result<imu::Repr, Error> {
    match descriptor {
        imu::DESCRIPTOR => Ok(imu::Repr::parse(&imu::Payload::new_checked(fields)?)),
        unknown => Err(Error::UnknownType(unknown)),
    }
}

#[cfg(test)]
mod tests {
    use super::super::{MAX_LEN, encode};
    use super::*;

    #[test]
    fn a_flipped_bit_anywhere_costs_one_packet_and_hides_no_other() {
        let first = imu::Repr { gyro: Some([1.0, -2.0, 3.0]), pressure: Some(1013.25), ..Default::default() };
        let second = imu::Repr { mag: Some([0.5; 3]), accel: Some([0.0, 0.0, -1.0]), ..Default::default() };
        let mut bytes = [0; 2 * MAX_LEN];
        let start = encode(&first, &mut bytes).unwrap();
        let end = start + encode(&second, &mut bytes[start..]).unwrap();
        for bit in 0..start * 8 {
            let mut hurt = bytes;
            hurt[bit / 8] ^= 1 << (bit % 8);
            let (mut good, mut bad) = (0, 0);
            let mut decoder = Decoder::new();
            let mut on = |received: Result<imu::Repr, Error>| match received {
                Ok(packet) => {
                    assert_eq!(packet, second, "bit {bit}");
                    good += 1;
                }
                Err(_) => bad += 1,
            };
            decoder.feed(&hurt[..end], &mut on);
            decoder.finish(&mut on);
            assert_eq!((good, bad), (1, 1), "bit {bit}");
        }
    }

    #[test]
    fn packets_of_other_descriptors_are_named_and_stepped_over() {
        let mut bytes = [0; MAX_LEN + 8];
        // A filter packet (82) with one field of two bytes.
        bytes[..6].copy_from_slice(&[0x75, 0x65, 0x82, 2, 2, 0x10]);
        let sum = fletcher(&bytes[..6]);
        bytes[6..8].copy_from_slice(&sum);
        let imu = imu::Repr { gyro: Some([0.0; 3]), ..Default::default() };
        let len = encode(&imu, &mut bytes[8..]).unwrap();
        let mut seen = [None; 2];
        let mut count = 0;
        Decoder::new().feed(&bytes[..8 + len], |received| {
            seen[count] = Some(received);
            count += 1;
        });
        assert_eq!(seen, [Some(Err(Error::UnknownType(0x82))), Some(Ok(imu))]);
    }
}
