//! Frames out of a stream of bytes, however it is cut up.

use super::{CRC, CRC_LEN, Direction, HEADER_LEN, Message, Received, START, field};
use crate::bytes;
use crate::error::Error;
use crate::scanner::{Format, Verdict, decoder};

/// Bytes of the longest payload that is taken in: a reply to `simulator` with a screen of text has a hundred.
const MAX_HELD_PAYLOAD: usize = 512;

/// The longest frame and the byte after it.
const HELD_LEN: usize = HEADER_LEN + MAX_HELD_PAYLOAD + CRC_LEN + 1;

decoder! {
    /// Finds frames in a stream; holds what has come of the next one.
    ///
    /// After damage it looks on from the byte behind the false start, so that a damaged size hides no
    /// frame. A frame of more than 512 bytes of payload is damage.
    Msp in HELD_LEN => Received;
    /// Takes more of the stream and calls `on` with each frame that it completes.
    ///
    /// Damage is reported once, however many bytes it takes to be in step again:
    /// [`Error::Checksum`], [`Error::Malformed`] where no frame starts; [`Error::Length`] for a
    /// frame whose payload is not as long as its command's.
    feed
}

/// How a frame is recognised.
struct Msp;

impl Format for Msp {
    type Packet = Received;

    fn may_start(byte: u8) -> bool {
        byte == START[0]
    }

    fn judge(held: &[u8]) -> Verdict<Received> {
        let start = held.len().min(START.len());
        if held[..start] != START[..start] {
            return Verdict::Not(Error::Malformed);
        }
        let Some(&symbol) = held.get(field::DIRECTION.start) else { return Verdict::Wait };
        let Some(direction) = Direction::from_symbol(symbol) else { return Verdict::Not(Error::Malformed) };
        if held.len() < HEADER_LEN {
            return Verdict::Wait;
        }
        let size = usize::from(bytes::le::<u16>(held, field::SIZE));
        if size > MAX_HELD_PAYLOAD {
            return Verdict::Not(Error::Malformed);
        }
        let crc_at = HEADER_LEN + size;
        let Some(&said) = held.get(crc_at) else { return Verdict::Wait };
        if CRC.checksum(&held[field::FLAGS.start..crc_at]) != said {
            return Verdict::Not(Error::Checksum);
        }
        let command = bytes::le(held, field::COMMAND);
        let message = Message::parse(direction, command, &held[HEADER_LEN..crc_at]);
        Verdict::Packet(message.map(|message| Received { direction, command, message }), crc_at + CRC_LEN)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{MAX_LEN, attitude, encode, fc_variant};
    use super::*;

    fn two_frames(out: &mut [u8; 2 * MAX_LEN]) -> (usize, usize) {
        let first = Message::Attitude(attitude::Repr { roll: i16::from_le_bytes(START), pitch: -1, yaw: 9 });
        let second = Message::FcVariant(fc_variant::Repr { name: fc_variant::INAV });
        let start = encode(&first, out).unwrap();
        let end = start + encode(&second, &mut out[start..]).unwrap();
        (start, end)
    }

    #[test]
    fn a_flipped_bit_anywhere_costs_one_frame_and_hides_no_other() {
        let mut bytes = [0; 2 * MAX_LEN];
        let (first, end) = two_frames(&mut bytes);
        for bit in 0..first * 8 {
            let mut hurt = bytes;
            hurt[bit / 8] ^= 1 << (bit % 8);
            let (mut attitudes, mut variants, mut bad) = (0, 0, 0);
            let mut decoder = Decoder::new();
            let mut on = |received: Result<Received, Error>| match received.map(|received| received.message) {
                Ok(Some(Message::Attitude(_))) => attitudes += 1,
                Ok(Some(Message::FcVariant(_))) => variants += 1,
                // The direction is not under the checksum: the other one is a frame that is not known.
                Ok(None) | Err(_) => bad += 1,
                Ok(other) => panic!("{other:?}"),
            };
            decoder.feed(&hurt[..end], &mut on);
            decoder.finish(&mut on);
            assert_eq!((attitudes, variants, bad), (0, 1, 1), "bit {bit}");
        }
    }

    #[test]
    fn frames_that_are_not_known_are_reported_by_their_command() {
        let mut bytes = [0; MAX_LEN];
        // MSP_SERVO (103) with a payload of one byte.
        let frame = [b'$', b'X', b'>', 0, 103, 0, 1, 0, 7];
        bytes[..9].copy_from_slice(&frame);
        bytes[9] = CRC.checksum(&frame[3..]);
        let mut seen = None;
        Decoder::new().feed(&bytes[..10], |received| seen = Some(received));
        let expected = Received { direction: Direction::Reply, command: 103, message: None };
        assert_eq!(seen, Some(Ok(expected)));
    }
}
