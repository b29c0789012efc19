//! Packets out of a stream of bytes, however it is cut up.

use super::{
    CRC_LEN, Header, MAX_LEN, Message, Received, SIGNATURE_LEN, STAMP_LEN, Version, checksum, known,
};
use crate::bytes;
use crate::error::Error;

/// The longest packet and the byte after it, each with its stamp.
const HELD_LEN: usize = 2 * STAMP_LEN + MAX_LEN + 1;

/// `incompatible` bit: a signature follows the checksum.
const SIGNED: u8 = 0x01;

/// Finds packets in a stream; holds what has come of the next one.
///
/// After damage it looks on from the byte behind the false start, so that a damaged length hides
/// no packet. Messages beyond the table [`KNOWN`](super::KNOWN) cannot be checked: they are believed
/// only where a packet is due and another follows, so each is reported when the byte after it comes.
#[derive(Debug, Clone)]
pub struct Decoder {
    held: [u8; HELD_LEN],
    len: usize,
    in_step: bool,
    /// Bytes in front of each packet.
    stamp: usize,
    skipped: usize,
}

/// What the held bytes are.
enum Verdict {
    /// The start of something: more bytes will tell.
    Wait,
    /// No packet starts at the first byte.
    Not(Error),
    /// A packet of so many bytes.
    Packet(Received, usize),
}

/// What the bytes before the payload say.
struct Start {
    header: Header,
    id: u32,
    crc_at: usize,
    end: usize,
}

impl Default for Decoder {
    fn default() -> Self {
        Self::new()
    }
}

impl Decoder {
    /// A decoder that holds nothing.
    pub const fn new() -> Self {
        Self { held: [0; HELD_LEN], len: 0, in_step: true, stamp: 0, skipped: 0 }
    }

    /// A decoder of a ground station's log (`.tlog`): in front of each packet stand eight bytes, big-endian, the µs
    /// since 1970 at which it was logged.
    pub const fn stamped() -> Self {
        Self { stamp: STAMP_LEN, ..Self::new() }
    }

    /// Takes more of the stream and calls `on` with each packet that it completes.
    ///
    /// Damage is reported once, however many bytes it takes to be in step again:
    /// [`Error::Checksum`], or [`Error::Malformed`] where no packet starts.
    pub fn feed(&mut self, bytes: &[u8], mut on: impl FnMut(Result<Received, Error>)) {
        self.feed_whole(bytes, |received| on(received.map(|(received, _)| received)));
    }

    /// The same, with each packet's own bytes, signature included: for who passes packets on. An
    /// unknown message is passed as it came, unchecked.
    pub fn feed_whole(&mut self, bytes: &[u8], mut on: impl FnMut(Result<(Received, &[u8]), Error>)) {
        for &byte in bytes {
            self.held[self.len] = byte;
            self.len += 1;
            self.scan(false, &mut on);
        }
    }

    /// Judges what is held as if no more were to come: for the end of a stream or a long pause.
    pub fn finish(&mut self, mut on: impl FnMut(Result<Received, Error>)) {
        self.finish_whole(|received| on(received.map(|(received, _)| received)));
    }

    /// The same, with each packet's own bytes.
    pub fn finish_whole(&mut self, mut on: impl FnMut(Result<(Received, &[u8]), Error>)) {
        self.scan(true, &mut on);
    }

    /// Takes all that can be judged from the front of what is held.
    fn scan(&mut self, at_end: bool, on: &mut impl FnMut(Result<(Received, &[u8]), Error>)) {
        while self.len > 0 {
            match self.judge(at_end) {
                Verdict::Wait => return,
                Verdict::Not(error) => {
                    if self.in_step {
                        on(Err(error));
                    }
                    self.in_step = false;
                    self.drop_false_start();
                }
                Verdict::Packet(mut received, len) => {
                    let end = self.stamp + len;
                    received.skipped = core::mem::take(&mut self.skipped);
                    received.stamp_us = self.stamp_us();
                    on(Ok((received, &self.held[self.stamp..end])));
                    self.in_step = true;
                    self.drop_front(end);
                }
            }
        }
    }

    /// Says what the first held byte starts.
    fn judge(&self, at_end: bool) -> Verdict {
        let short = if at_end { Verdict::Not(Error::Malformed) } else { Verdict::Wait };
        let Some(held) = self.held[..self.len].get(self.stamp..).filter(|held| !held.is_empty()) else {
            return short;
        };
        let start = match start(held) {
            Ok(Some(start)) => start,
            Ok(None) => return short,
            Err(error) => return Verdict::Not(error),
        };
        let known = known(start.id);
        if known.is_none() && !self.in_step {
            return Verdict::Not(Error::Malformed);
        }
        let Some(packet) = held.get(..start.end) else {
            return short;
        };
        match known {
            Some(known) => checked(&start, packet, known.crc_extra),
            None => unchecked(&start, held.get(start.end + self.stamp), at_end),
        }
    }

    /// Drops the first byte and all up to the next that may start a packet, or its stamp.
    fn drop_false_start(&mut self) {
        let rest = self.held[..self.len].get(self.stamp + 1..).unwrap_or_default();
        let skip = rest.iter().position(|&byte| Version::from_magic(byte).is_some());
        // Of a stamp that has not ended the bytes are kept.
        let skip = skip.map_or(self.len.saturating_sub(self.stamp).max(1), |skip| skip + 1);
        self.skipped += skip;
        self.drop_front(skip);
    }

    /// The stamp in front of the first packet.
    fn stamp_us(&self) -> Option<u64> {
        (self.stamp > 0).then(|| bytes::be(&self.held, 0..STAMP_LEN))
    }

    /// Drops bytes from the front.
    fn drop_front(&mut self, count: usize) {
        self.held.copy_within(count..self.len, 0);
        self.len -= count;
    }
}

/// Reads what comes before the payload; `None` if there are too few bytes yet.
fn start(held: &[u8]) -> Result<Option<Start>, Error> {
    let version = held.first().and_then(|&magic| Version::from_magic(magic));
    let version = version.ok_or(Error::Malformed)?;
    let (len, flags, [seq, system, component], id) = match (version, held) {
        (Version::V1, &[_, len, seq, system, component, id, ..]) => {
            (len, 0, [seq, system, component], u32::from(id))
        }
        (Version::V2, &[_, len, flags, _, seq, system, component, a, b, c, ..]) => {
            (len, flags, [seq, system, component], u32::from_le_bytes([a, b, c, 0]))
        }
        _ => return Ok(None),
    };
    if flags & !SIGNED != 0 {
        return Err(Error::Malformed);
    }
    let crc_at = version.header_len() + usize::from(len);
    let signature = if flags & SIGNED == 0 { 0 } else { SIGNATURE_LEN };
    Ok(Some(Start {
        header: Header { version, seq, system, component },
        id,
        crc_at,
        end: crc_at + CRC_LEN + signature,
    }))
}

/// A packet whose checksum can be checked.
fn checked(start: &Start, packet: &[u8], extra: u8) -> Verdict {
    let said: u16 = bytes::le(packet, start.crc_at..start.crc_at + CRC_LEN);
    if checksum(&packet[1..start.crc_at], extra) != said {
        return Verdict::Not(Error::Checksum);
    }
    let payload = &packet[start.header.version.header_len()..start.crc_at];
    // Others of the table are whole, and of no concern here.
    let message = Message::parse(start.id, payload).ok();
    Verdict::Packet(Received { checked: true, ..start.received(message) }, start.end)
}

/// A packet that is believed because of what follows it.
fn unchecked(start: &Start, following: Option<&u8>, at_end: bool) -> Verdict {
    match following {
        None if !at_end => Verdict::Wait,
        Some(&byte) if Version::from_magic(byte).is_none() => Verdict::Not(Error::Malformed),
        _ => Verdict::Packet(start.received(None), start.end),
    }
}

impl Start {
    /// The whole packet, given its message.
    const fn received(&self, message: Option<Message>) -> Received {
        Received {
            header: self.header,
            id: self.id,
            message,
            checked: false,
            stamp_us: None,
            len: self.end,
            skipped: 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{encode, heartbeat, system_time};
    use super::*;

    /// A packet whose message id is not known here, its checksum arbitrary.
    const UNKNOWN: [u8; 14] = [0xfd, 2, 0, 0, 9, 1, 1, 0xff, 0xff, 0, 7, 8, 0x12, 0x34];

    fn two_packets(version: Version, out: &mut [u8; 2 * MAX_LEN]) -> (usize, usize) {
        let header = |seq| Header { version, seq, system: 1, component: 2 };
        let beat = Message::Heartbeat(heartbeat::Repr {
            custom_mode: 0xfe_fd,
            mavlink_version: 3,
            ..Default::default()
        });
        let time = Message::SystemTime(system_time::Repr { time_unix_usec: 0, time_boot_ms: 77 });
        let first = encode(&header(0), &beat, out).unwrap();
        let second = encode(&header(1), &time, &mut out[first..]).unwrap();
        (first, first + second)
    }

    #[test]
    fn a_flipped_bit_anywhere_costs_one_packet_and_hides_no_other() {
        for version in [Version::V1, Version::V2] {
            let mut bytes = [0; 2 * MAX_LEN];
            let (first, end) = two_packets(version, &mut bytes);
            for bit in 0..first * 8 {
                let mut hurt = bytes;
                hurt[bit / 8] ^= 1 << (bit % 8);
                let (mut beats, mut times) = (0, 0);
                let mut decoder = Decoder::new();
                let mut on = |received: Result<Received, Error>| match received
                    .ok()
                    .and_then(|received| received.message)
                {
                    Some(Message::Heartbeat(_)) => beats += 1,
                    Some(Message::SystemTime(_)) => times += 1,
                    _ => {}
                };
                decoder.feed(&hurt[..end], &mut on);
                decoder.finish(&mut on);
                assert_eq!((beats, times), (0, 1), "{version:?} bit {bit}");
            }
        }
    }

    #[test]
    fn an_unknown_message_is_reported_when_the_next_byte_comes() {
        let mut bytes = [0; 2 * MAX_LEN];
        let (_, end) = two_packets(Version::V2, &mut bytes);
        let mut ids = [0; 4];
        let mut count = 0;
        let mut on = |received: Result<Received, Error>| {
            ids[count] = received.unwrap().id;
            count += 1;
        };
        let mut decoder = Decoder::new();
        decoder.feed(&UNKNOWN, &mut on);
        decoder.feed(&bytes[..end], &mut on);
        decoder.feed(&UNKNOWN, &mut on);
        decoder.finish(&mut on);
        assert_eq!(ids, [0xffff, heartbeat::ID, system_time::ID, 0xffff]);
    }

    #[test]
    fn every_packet_comes_with_its_own_bytes_known_or_not() {
        for version in [Version::V1, Version::V2] {
            let mut bytes = [0; 2 * MAX_LEN];
            let (first, end) = two_packets(version, &mut bytes);
            let mut signed = [0; 2 * MAX_LEN];
            signed[..UNKNOWN.len()].copy_from_slice(&UNKNOWN);
            signed[2] = SIGNED;
            let expected =
                [&bytes[..first], &bytes[first..end], &UNKNOWN, &signed[..UNKNOWN.len() + SIGNATURE_LEN]];
            let mut count = 0;
            let mut on = |received: Result<(Received, &[u8]), Error>| {
                assert_eq!(received.unwrap().1, expected[count]);
                count += 1;
            };
            let mut decoder = Decoder::new();
            for packet in expected {
                packet.chunks(5).for_each(|piece| decoder.feed_whole(piece, &mut on));
            }
            decoder.finish_whole(&mut on);
            assert_eq!(count, expected.len());
        }
    }

    /// A packet of so many bytes behind its stamp.
    fn stamped(us: u64, packet: &[u8], out: &mut [u8]) -> usize {
        out[..STAMP_LEN].copy_from_slice(&us.to_be_bytes());
        out[STAMP_LEN..STAMP_LEN + packet.len()].copy_from_slice(packet);
        STAMP_LEN + packet.len()
    }

    #[test]
    fn in_a_log_each_packet_has_its_stamp_and_a_flipped_bit_costs_one() {
        let mut bytes = [0; 2 * MAX_LEN];
        let (first, end) = two_packets(Version::V2, &mut bytes);
        let mut log = [0; 4 * MAX_LEN];
        let mut len = stamped(1_700_000_000_000_001, &bytes[..first], &mut log);
        len += stamped(1_700_000_000_000_002, &UNKNOWN, &mut log[len..]);
        len += stamped(1_700_000_000_000_003, &bytes[first..end], &mut log[len..]);
        let read = |log: &[u8]| {
            let mut seen = [None; 8];
            let (mut count, mut bad, mut skipped) = (0, 0, 0);
            let mut on = |received: Result<Received, Error>| match received {
                Ok(received) => {
                    seen[count] = received.stamp_us;
                    count += 1;
                    skipped += received.skipped;
                }
                Err(_) => bad += 1,
            };
            let mut decoder = Decoder::stamped();
            log.chunks(3).for_each(|piece| decoder.feed(piece, &mut on));
            decoder.finish(&mut on);
            (seen.map(|stamp| stamp.map(|us| us % 10)), count, bad, skipped)
        };
        assert_eq!(read(&log[..len]).0[..4], [Some(1), Some(2), Some(3), None]);
        assert_eq!((read(&log[..len]).2, read(&log[..len]).3), (0, 0));
        for bit in STAMP_LEN * 8..(STAMP_LEN + first) * 8 {
            let mut hurt = log;
            hurt[bit / 8] ^= 1 << (bit % 8);
            // The one that cannot be checked is not believed behind damage, unless its id makes the first one unknown.
            let (seen, count, bad, _) = read(&hurt[..len]);
            assert_eq!(seen[count - 1], Some(3), "bit {bit}");
            assert!(bad == 1 || (count == 3 && (7..10).contains(&(bit / 8 - STAMP_LEN))), "bit {bit}");
        }
        // From the middle of a packet on, and up to the middle of one.
        let (seen, count, bad, skipped) = read(&log[STAMP_LEN + 5..len]);
        assert_eq!((seen[0], count, bad), (Some(3), 1, 1));
        assert_eq!(skipped, first - 5 + STAMP_LEN + UNKNOWN.len());
        assert_eq!(read(&log[..len - 3]).0[..3], [Some(1), Some(2), None]);
    }

    #[test]
    fn a_message_of_the_table_is_checked_though_it_is_not_read() {
        // VFR_HUD, whose fields are of no concern here.
        let mut packet = [0xfd, 4, 0, 0, 3, 1, 1, 74, 0, 0, 1, 2, 3, 4, 0, 0];
        let crc = checksum(&packet[1..14], known(74).unwrap().crc_extra);
        packet[14..].copy_from_slice(&crc.to_le_bytes());
        let read = |bytes: &[u8]| {
            let mut all = [None; 2];
            let mut count = 0;
            let mut decoder = Decoder::new();
            let mut on = |received: Result<Received, Error>| {
                all[count] = Some(received);
                count += 1;
            };
            decoder.feed(bytes, &mut on);
            decoder.finish(&mut on);
            all
        };
        let seen = read(&packet)[0].unwrap().unwrap();
        assert_eq!((seen.id, seen.message, seen.checked, seen.len), (74, None, true, packet.len()));
        packet[4] ^= 0x40;
        assert_eq!(read(&packet)[0], Some(Err(Error::Checksum)), "in its number");
        let unknown = read(&UNKNOWN)[0].unwrap().unwrap();
        assert!(
            !unknown.checked && unknown.message.is_none(),
            "control: beyond the table nothing is checked"
        );
    }

    #[test]
    fn damage_is_reported_once() {
        let mut bytes = [0; 2 * MAX_LEN];
        let (first, end) = two_packets(Version::V2, &mut bytes);
        bytes[first - 1] ^= 1;
        let (mut good, mut bad) = (0, 0);
        Decoder::new().feed(&bytes[..end], |received| match received {
            Ok(_) => good += 1,
            Err(error) => {
                assert_eq!(error, Error::Checksum);
                bad += 1;
            }
        });
        assert_eq!((good, bad), (1, 1));
    }
}
