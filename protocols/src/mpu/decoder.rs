//! Packets out of a stream of bytes, however it is cut up.

use super::{CRC_LEN, HEADER_LEN, MAX_LEN, PAYLOAD_LENS, Received, decode};
use crate::cobs;
use crate::error::Error;

/// Two packets: enough to find the second where damage hid the zero between them.
const HELD_LEN: usize = 2 * MAX_LEN;

/// Finds packets in a stream; holds what has come of the next one.
///
/// Each zero byte ends a packet, so the decoder is in step again one zero after any damage. If
/// the damage is to that zero, the packet behind it is still found, by its length.
#[derive(Debug, Clone)]
pub struct Decoder {
    held: [u8; HELD_LEN],
    len: usize,
    overlong: bool,
}

impl Default for Decoder {
    fn default() -> Self {
        Self::new()
    }
}

impl Decoder {
    /// A decoder that holds nothing.
    pub const fn new() -> Self {
        Self { held: [0; HELD_LEN], len: 0, overlong: false }
    }

    /// Takes more of the stream and calls `on` with each packet that it completes.
    ///
    /// Errors are what [`decode`] refuses, one for each stretch between zeros; a stretch whose
    /// end holds a whole packet gives the error and then that packet.
    pub fn feed(&mut self, bytes: &[u8], mut on: impl FnMut(Result<Received, Error>)) {
        for &byte in bytes {
            if byte == 0 {
                self.close(&mut on);
            } else {
                self.hold(byte);
            }
        }
    }

    /// Keeps a byte; of an overlong stretch, its end.
    fn hold(&mut self, byte: u8) {
        if self.len == HELD_LEN {
            self.held.copy_within(MAX_LEN.., 0);
            self.len -= MAX_LEN;
            self.overlong = true;
        }
        self.held[self.len] = byte;
        self.len += 1;
    }

    /// Judges what has come since the last zero.
    fn close(&mut self, on: &mut impl FnMut(Result<Received, Error>)) {
        let stuffed = &self.held[..self.len];
        if !stuffed.is_empty() {
            let whole = if self.overlong { Err(Error::Malformed) } else { decode(stuffed) };
            on(whole);
            if whole.is_err()
                && let Some(last) = salvage(stuffed)
            {
                on(Ok(last));
            }
        }
        self.len = 0;
        self.overlong = false;
    }
}

/// The packet at the end of a damaged stretch, if a whole one is there.
fn salvage(stuffed: &[u8]) -> Option<Received> {
    PAYLOAD_LENS.iter().find_map(|payload_len| {
        let len = cobs::max_encoded_len(HEADER_LEN + payload_len + CRC_LEN);
        let start = stuffed.len().checked_sub(len).filter(|&start| start > 0)?;
        decode(&stuffed[start..]).ok()
    })
}

#[cfg(test)]
mod tests {
    use super::super::{Packet, accel, encode, gyro};
    use super::*;

    fn two_packets(out: &mut [u8; 2 * MAX_LEN]) -> (usize, usize) {
        let gyro = Packet::Gyro(gyro::Repr { gyro: [1, 0, -3] });
        let accel = Packet::Accel(accel::Repr { accel: [0, 5, 9] });
        let first = encode(1, 10, &gyro, out).unwrap();
        let second = encode(2, 20, &accel, &mut out[first..]).unwrap();
        (first, first + second)
    }

    #[test]
    fn a_flipped_bit_anywhere_costs_one_packet_and_is_reported() {
        let mut bytes = [0; 2 * MAX_LEN];
        let (first, end) = two_packets(&mut bytes);
        for bit in 0..first * 8 {
            let mut hurt = bytes;
            hurt[bit / 8] ^= 1 << (bit % 8);
            let (mut good, mut bad) = ([0; 2], 0);
            Decoder::new().feed(&hurt[..end], |received| match received {
                Ok(received) => good[usize::from(received.seq) - 1] += 1,
                Err(_) => bad += 1,
            });
            assert_eq!(good, [0, 1], "bit {bit}");
            assert!(bad > 0, "bit {bit}");
        }
    }

    #[test]
    fn a_packet_behind_endless_rubbish_is_found() {
        let mut bytes = [0; 2 * MAX_LEN];
        let (_, end) = two_packets(&mut bytes);
        let mut decoder = Decoder::new();
        let mut seen = [0; 3];
        let mut on = |received: Result<Received, Error>| {
            seen[received.map_or(0, |received| usize::from(received.seq))] += 1;
        };
        decoder.feed(&[0x55; 1000], &mut on);
        decoder.feed(&bytes[..end], &mut on);
        assert_eq!(seen, [1, 1, 1]);
    }

    #[test]
    fn zeros_between_packets_are_nothing() {
        Decoder::new().feed(&[0; 10], |received| panic!("{received:?}"));
    }
}
