//! Packets out of a stream of bytes: datagrams one after another, as a recording holds them.

use super::state::{self, Payload, Repr};
use crate::error::Error;
use crate::scanner::{Format, Verdict, decoder};

/// A packet and the byte after it.
const HELD_LEN: usize = state::LEN + 1;

decoder! {
    /// Finds packets in a stream; holds what has come of the next one.
    ///
    /// Nothing marks a packet's start and no checksum covers it, so a packet is whatever
    /// [is plausible](Repr::is_plausible) in so many bytes. Damage that leaves it plausible is not seen; after other
    /// damage, or a datagram of another length, it looks on from the next byte.
    Betaflight in HELD_LEN => Repr;
    /// Takes more of the stream and calls `on` with each packet that it completes.
    ///
    /// Damage is reported once as [`Error::Malformed`], however many bytes it takes to be in step again.
    feed
}

/// How a packet is recognised.
struct Betaflight;

impl Format for Betaflight {
    type Packet = Repr;

    fn may_start(_: u8) -> bool {
        true
    }

    fn judge(held: &[u8]) -> Verdict<Repr> {
        let Some(packet) = held.get(..state::LEN) else { return Verdict::Wait };
        let repr = Payload::new_checked(packet).map(|payload| Repr::parse(&payload));
        match repr {
            Ok(repr) if repr.is_plausible() => Verdict::Packet(Ok(repr), state::LEN),
            _ => Verdict::Not(Error::Malformed),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{MAX_LEN, encode};
    use super::*;

    /// Level, yet no two packets alike.
    fn packet(k: usize) -> (Repr, [u8; MAX_LEN]) {
        let repr = Repr { gyro: [k as f64, 0.5, -0.25], ..Repr::LEVEL };
        let mut bytes = [0; MAX_LEN];
        encode(&repr, &mut bytes).unwrap();
        (repr, bytes)
    }

    fn read<'a>(pieces: impl IntoIterator<Item = &'a [u8]>) -> (usize, usize) {
        let (mut decoder, mut whole, mut damaged) = (Decoder::new(), 0, 0);
        let mut on = |received: Result<Repr, Error>| match received {
            Ok(_) => whole += 1,
            Err(_) => damaged += 1,
        };
        pieces.into_iter().for_each(|piece| decoder.feed(piece, &mut on));
        decoder.finish(&mut on);
        (whole, damaged)
    }

    #[test]
    fn a_datagram_that_is_too_short_or_too_long_costs_itself_alone() {
        let [one, two, three] = [1, 2, 3].map(|k| packet(k).1);
        assert_eq!(read([&one[..], &two, &three]), (3, 0));
        assert_eq!(read([&one[..], &two[..143], &three]), (2, 1));
        assert_eq!(read([&one[..], &two[..136], &three]), (2, 1));
        assert_eq!(read([&one[..], &two, &[7], &three]), (3, 1));
        assert_eq!(read([&one[..], &[0xff; 20], &three]), (2, 1));
        assert_eq!(read([&one[30..], &two, &three]), (2, 1));
        assert_eq!(read([&[0; 1000][..], &three]), (1, 1));
    }

    #[test]
    fn what_comes_is_what_was_sent_and_a_half_is_nothing() {
        let (repr, bytes) = packet(5);
        let mut seen = None;
        Decoder::new().feed(&bytes, |received| seen = Some(received));
        assert_eq!(seen, Some(Ok(repr)));
        assert_eq!(read([&bytes[..143]]), (0, 1));
    }
}
