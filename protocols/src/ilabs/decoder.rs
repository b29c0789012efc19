//! Frames out of a stream of bytes, however it is cut up.

use super::{HEADER_LEN, START, SUM_LEN, UNCOUNTED_LEN, data, sum};
use crate::bytes;
use crate::error::Error;
use crate::scanner::{Format, Verdict, decoder};

/// The longest frame that is waited for: ArduPilot's driver holds no longer one.
const LONGEST: usize = 256;

/// Of a frame with one id of one byte.
const SHORTEST: usize = HEADER_LEN + 3 + SUM_LEN;

/// The longest frame and the byte after it.
const HELD_LEN: usize = LONGEST + 1;

decoder! {
    /// Finds frames in a stream; holds what has come of the next one.
    ///
    /// After damage it looks on from the byte behind the false start, so that a damaged length hides no frame. The sum finds
    /// a flipped bit, but not two that cancel.
    Ilabs in HELD_LEN => data::Repr;
    /// Takes more of the stream and calls `on` with each frame that it completes.
    ///
    /// Damage is reported once, however many bytes it takes to be in step again: [`Error::Checksum`], or
    /// [`Error::Malformed`] where no frame starts. A whole frame with an id that is not known here is
    /// [`Error::UnknownType`], one whose data are not as long as its ids say [`Error::Length`].
    feed
}

/// How a frame is recognised.
struct Ilabs;

impl Format for Ilabs {
    type Packet = data::Repr;

    fn may_start(byte: u8) -> bool {
        byte == START[0]
    }

    fn judge(held: &[u8]) -> Verdict<data::Repr> {
        let start = held.len().min(START.len());
        if held[..start] != START[..start] {
            return Verdict::Not(Error::Malformed);
        }
        if held.len() < HEADER_LEN {
            return Verdict::Wait;
        }
        let len = UNCOUNTED_LEN + usize::from(bytes::le::<u16>(held, START.len()..HEADER_LEN));
        if !(SHORTEST..=LONGEST).contains(&len) {
            return Verdict::Not(Error::Malformed);
        }
        let Some(frame) = held.get(..len) else { return Verdict::Wait };
        let sum_at = len - SUM_LEN;
        if sum(&frame[UNCOUNTED_LEN..sum_at]) != bytes::le::<u16>(frame, sum_at..len) {
            return Verdict::Not(Error::Checksum);
        }
        Verdict::Packet(parse(&frame[HEADER_LEN..sum_at]), len)
    }
}

/// Reads what a frame tells.
fn parse(told: &[u8]) -> Result<data::Repr, Error> {
    Ok(data::Repr::parse(&data::Payload::new_checked(told)?))
}

#[cfg(test)]
mod tests {
    use super::super::{MAX_LEN, encode};
    use super::*;

    #[test]
    fn a_flipped_bit_anywhere_costs_one_frame_and_hides_no_other() {
        let first = data::Repr { gyro: Some([1, -2, 3]), accel: Some([0, 0, 999_597]), ..Default::default() };
        let second = data::Repr { mag: Some([-1100, 1905, -4300]), time_ms: Some(500), ..Default::default() };
        let mut bytes = [0; 2 * MAX_LEN];
        let start = encode(&first, &mut bytes).unwrap();
        let end = start + encode(&second, &mut bytes[start..]).unwrap();
        for bit in 0..start * 8 {
            let mut hurt = bytes;
            hurt[bit / 8] ^= 1 << (bit % 8);
            let (mut good, mut bad) = (0, 0);
            let mut decoder = Decoder::new();
            let mut on = |received: Result<data::Repr, Error>| match received {
                Ok(frame) => {
                    assert_eq!(frame, second, "bit {bit}");
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
    fn a_frame_with_an_id_that_is_not_known_or_a_stray_byte_is_told_of_and_stepped_over() {
        let good = data::Repr { status: Some(0), ..Default::default() };
        for (told, error) in [
            (&[1, 0x26, 9][..], Error::UnknownType(0x26)),
            (&[1, 0x52, 9, 9, 9], Error::Length { expected: 4, found: 5 }),
            (&[0, 0, 0], Error::Malformed),
        ] {
            let mut bytes = [0; 2 * MAX_LEN];
            let sum_at = HEADER_LEN + told.len();
            bytes[..START.len()].copy_from_slice(&START);
            bytes[START.len()] = (sum_at + SUM_LEN - UNCOUNTED_LEN) as u8;
            bytes[HEADER_LEN..sum_at].copy_from_slice(told);
            let sum = sum(&bytes[UNCOUNTED_LEN..sum_at]);
            bytes[sum_at..sum_at + SUM_LEN].copy_from_slice(&sum.to_le_bytes());
            let len = sum_at + SUM_LEN + encode(&good, &mut bytes[sum_at + SUM_LEN..]).unwrap();
            let (mut seen, mut count) = ([None; 2], 0);
            Decoder::new().feed(&bytes[..len], |received| {
                seen[count] = Some(received);
                count += 1;
            });
            assert_eq!(seen, [Some(Err(error)), Some(Ok(good))]);
        }
    }
}
