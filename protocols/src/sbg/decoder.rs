//! Packets out of a stream of bytes, however it is cut up.

use super::{CRC, END, HEADER_LEN, Packet, Received, START, TAIL_LEN, field};
use crate::bytes;
use crate::error::Error;
use crate::scanner::{Format, Verdict, decoder};

/// Bytes of the longest payload that is taken in: a unit's navigation has 72, and a stray start hides no more than this.
const MAX_HELD_PAYLOAD: usize = 256;

/// The longest packet and the byte after it.
const HELD_LEN: usize = HEADER_LEN + MAX_HELD_PAYLOAD + TAIL_LEN + 1;

decoder! {
    /// Finds packets in a stream; holds what has come of the next one.
    ///
    /// After damage it looks on from the byte behind the false start, so that a damaged length hides no packet. A packet of
    /// more than 256 bytes of payload is damage.
    Sbg in HELD_LEN => Received;
    /// Takes more of the stream and calls `on` with each packet that it completes.
    ///
    /// Damage is reported once, however many bytes it takes to be in step again: [`Error::Checksum`],
    /// [`Error::Malformed`] where no packet starts or ends; [`Error::Length`] for a packet whose payload is shorter than
    /// its id's.
    feed
}

/// How a packet is recognised.
struct Sbg;

impl Format for Sbg {
    type Packet = Received;

    fn may_start(byte: u8) -> bool {
        byte == START[0]
    }

    fn judge(held: &[u8]) -> Verdict<Received> {
        let start = held.len().min(START.len());
        if held[..start] != START[..start] {
            return Verdict::Not(Error::Malformed);
        }
        if held.len() < HEADER_LEN {
            return Verdict::Wait;
        }
        let len = usize::from(bytes::le::<u16>(held, field::LEN));
        if len > MAX_HELD_PAYLOAD {
            return Verdict::Not(Error::Malformed);
        }
        let crc_at = HEADER_LEN + len;
        let Some(&[low, high, end]) = held.get(crc_at..crc_at + TAIL_LEN) else { return Verdict::Wait };
        if CRC.of(&held[field::ID..crc_at]).to_le_bytes() != [low, high] {
            return Verdict::Not(Error::Checksum);
        }
        if end != END {
            return Verdict::Not(Error::Malformed);
        }
        let (id, class) = (held[field::ID], held[field::CLASS]);
        let packet = Packet::parse(class, id, &held[HEADER_LEN..crc_at]);
        Verdict::Packet(packet.map(|packet| Received { class, id, packet }), crc_at + TAIL_LEN)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{MAX_LEN, air_data, encode, imu_short};
    use super::*;

    #[test]
    fn a_flipped_bit_anywhere_costs_one_packet_and_hides_no_other() {
        // With a start of a packet in its payload.
        let first = imu_short::Repr { time_us: 0x5aff, gyro: [1, -2, 3], ..Default::default() };
        let second = Packet::AirData(air_data::Repr { pressure: 94_500.0, ..Default::default() });
        let mut bytes = [0; 2 * MAX_LEN];
        let start = encode(&Packet::ImuShort(first), &mut bytes).unwrap();
        let end = start + encode(&second, &mut bytes[start..]).unwrap();
        for bit in 0..start * 8 {
            let mut hurt = bytes;
            hurt[bit / 8] ^= 1 << (bit % 8);
            let (mut good, mut bad) = (0, 0);
            let mut decoder = Decoder::new();
            let mut on = |received: Result<Received, Error>| match received {
                Ok(received) => {
                    assert_eq!(received.packet, Some(second), "bit {bit}");
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
    fn what_is_not_known_is_named_and_a_longer_payload_is_read_as_far_as_it_is_known() {
        let quiet = Packet::AirData(air_data::Repr { pressure: 94_500.0, ..Default::default() });
        let mut bytes = [0; 2 * MAX_LEN];
        let len = encode(&quiet, &mut bytes).unwrap();
        // The same with two bytes more.
        let crc_at = len + 2 - TAIL_LEN;
        bytes[4] += 2;
        let sealed = |bytes: &mut [u8]| {
            let crc = CRC.of(&bytes[2..crc_at]);
            bytes[crc_at..crc_at + 2].copy_from_slice(&crc.to_le_bytes());
            bytes[crc_at + 2] = END;
        };
        let only = |bytes: &[u8]| {
            let mut seen = None;
            Decoder::new().feed(bytes, |received| seen = Some(received));
            seen
        };
        sealed(&mut bytes);
        let longer = Received { class: 0, id: air_data::ID, packet: Some(quiet) };
        assert_eq!(only(&bytes[..len + 2]), Some(Ok(longer)));
        bytes[2] = 13;
        sealed(&mut bytes);
        assert_eq!(only(&bytes[..len + 2]), Some(Ok(Received { class: 0, id: 13, packet: None })));
        // A magnetometer's has more bytes than these.
        bytes[2] = super::super::mag::ID;
        sealed(&mut bytes);
        assert_eq!(only(&bytes[..len + 2]), Some(Err(Error::Length { expected: 30, found: 28 })));
    }
}
