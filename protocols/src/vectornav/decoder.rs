//! Packets and lines out of a stream of bytes, however it is cut up.

use super::{CRC, CRC_LEN, MAX_LEN, Packet, SYNC, ahrs, imu, inertial, line, navigation};
use crate::bytes;
use crate::error::Error;
use crate::scanner::{Format, Verdict, decoder};

/// The longest packet and the byte after it.
const HELD_LEN: usize = MAX_LEN + 1;

decoder! {
    /// Finds packets and lines in a stream; holds what has come of the next one.
    ///
    /// After damage it looks on from the byte behind the false start, so that damage hides no other
    /// packet. Binary packets of other groups are damage: their length is not known.
    Vectornav in HELD_LEN => Packet;
    /// Takes more of the stream and calls `on` with each packet that it completes.
    ///
    /// Damage is reported once, however many bytes it takes to be in step again:
    /// [`Error::Checksum`], or [`Error::Malformed`] where no packet starts.
    feed
}

/// How packets are recognised.
struct Vectornav;

impl Format for Vectornav {
    type Packet = Packet;

    fn may_start(byte: u8) -> bool {
        byte == SYNC || byte == line::START
    }

    fn judge(held: &[u8]) -> Verdict<Packet> {
        match held[0] {
            SYNC => binary(held),
            line::START => match line::judge(held) {
                Verdict::Packet(line, len) => Verdict::Packet(line.map(Packet::Line), len),
                Verdict::Not(error) => Verdict::Not(error),
                Verdict::Filler(count) => Verdict::Filler(count),
                Verdict::Wait => Verdict::Wait,
            },
            // What is left of a line's end, or a blank one.
            b'\r' | b'\n' => Verdict::Filler(1),
            _ => Verdict::Not(Error::Malformed),
        }
    }
}

/// A kind of binary packet: its groups, the bytes of its payload, and how that is read.
type Binary = (&'static [u8], usize, fn(&[u8]) -> Result<Packet, Error>);

/// Every kind of binary packet.
const BINARY: [Binary; 4] = [
    (imu::GROUPS, imu::LEN, |payload| {
        Ok(Packet::Imu(imu::Repr::parse(&imu::Payload::new_checked(payload)?)))
    }),
    (ahrs::GROUPS, ahrs::LEN, |payload| {
        Ok(Packet::Ahrs(ahrs::Repr::parse(&ahrs::Payload::new_checked(payload)?)))
    }),
    (inertial::GROUPS, inertial::LEN, |payload| {
        Ok(Packet::Inertial(inertial::Repr::parse(&inertial::Payload::new_checked(payload)?)))
    }),
    (navigation::GROUPS, navigation::LEN, |payload| {
        Ok(Packet::Navigation(navigation::Repr::parse(&navigation::Payload::new_checked(payload)?)))
    }),
];

/// Judges bytes whose first is [`SYNC`].
fn binary(held: &[u8]) -> Verdict<Packet> {
    let mut wait = false;
    for (groups, len, parse) in BINARY {
        let said = &held[1..held.len().min(1 + groups.len())];
        if !groups.starts_with(said) {
            continue;
        }
        let crc_at = 1 + groups.len() + len;
        let Some(packet) = held.get(..crc_at + CRC_LEN) else {
            wait = true;
            continue;
        };
        if CRC.of(&packet[1..crc_at]) != bytes::be::<u16>(packet, crc_at..crc_at + CRC_LEN) {
            return Verdict::Not(Error::Checksum);
        }
        return Verdict::Packet(parse(&packet[1 + groups.len()..crc_at]), crc_at + CRC_LEN);
    }
    if wait { Verdict::Wait } else { Verdict::Not(Error::Malformed) }
}

#[cfg(test)]
mod tests {
    use super::super::encode;
    use super::line::Line;
    use super::*;

    fn packets() -> [Packet; 5] {
        let imu = imu::Repr { time_ns: 0x24fa_0001_0701_fa24, pressure: 94.5, ..Default::default() };
        let ahrs = ahrs::Repr { time_ns: 1, xyzw: [0.5, -0.5, 0.5, 0.5], ..Default::default() };
        let inertial =
            inertial::Repr { time_ns: 0xfa06_0100_0006, accel: [0.5, 1.0, 2.0], ..Default::default() };
        let navigation = navigation::Repr { time_ns: 2, position: [59.9, 30.3, 10.0], ..Default::default() };
        [
            Packet::Imu(imu),
            Packet::Ahrs(ahrs),
            Packet::Inertial(inertial),
            Packet::Navigation(navigation),
            Packet::Line(Line::new("VNASY,1").unwrap()),
        ]
    }

    #[test]
    fn a_flipped_bit_anywhere_costs_one_packet_and_hides_no_other() {
        for first in packets() {
            for second in packets() {
                let mut bytes = [0; 2 * MAX_LEN];
                let start = encode(&first, &mut bytes).unwrap();
                let end = start + encode(&second, &mut bytes[start..]).unwrap();
                for bit in 0..start * 8 {
                    let mut hurt = bytes;
                    hurt[bit / 8] ^= 1 << (bit % 8);
                    let (mut good, mut bad, mut found) = (0, 0, false);
                    let mut decoder = Decoder::new();
                    let mut on = |received: Result<Packet, Error>| match received {
                        Ok(packet) => {
                            found |= packet == second;
                            good += 1;
                        }
                        Err(_) => bad += 1,
                    };
                    decoder.feed(&hurt[..end], &mut on);
                    decoder.finish(&mut on);
                    assert!(found, "{first:?} {second:?} bit {bit}");
                    // A line's end may change into its other spelling, and a digit into its small letter.
                    let harmless = good == 2 && matches!(first, Packet::Line(_));
                    assert!(harmless || (good, bad) == (1, 1), "{first:?} bit {bit}: {good} {bad}");
                }
            }
        }
    }
}
