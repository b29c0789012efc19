//! Whether a MAVLink recording is a ground station's log, and what its stamps say.

use super::SimTime;
use ratetable_protocols::mavlink::{Decoder, Received};

/// How many bytes of a recording are examined.
pub(in crate::wire) const JUDGED: usize = 16_384;

/// How many stamped packets identify a log.
const ENOUGH: u64 = 2;

/// A longer time between two stamps is a step of the logging clock, ns.
const LONGEST: i64 = 3_600_000_000_000;

/// Whether the bytes decode better with a stamp before each packet than without.
pub(in crate::wire) fn has_stamps(bytes: &[u8]) -> bool {
    let (plain, stamped) = (read(Decoder::new(), bytes), read(Decoder::stamped(), bytes));
    stamped.packets >= ENOUGH && stamped.gaps < plain.gaps && 2 * stamped.dated > stamped.packets
}

#[derive(Default)]
struct Read {
    /// Packets with a correct checksum.
    packets: u64,
    /// Those whose stamp is a time of this century or the previous one.
    dated: u64,
    /// Stretches of bytes that are no packet.
    gaps: u64,
}

fn read(mut decoder: Decoder, bytes: &[u8]) -> Read {
    let mut read = Read::default();
    decoder.feed(bytes, |received| match received {
        Ok(Received { checked: true, stamp_us, .. }) => {
            read.packets += 1;
            read.dated += u64::from(stamp_us.is_some_and(|us| time(us).is_some()));
        }
        Ok(_) => {}
        Err(_) => read.gaps += 1,
    });
    read
}

/// A stamp as time since 1970; `None` after the year 2112, which is no stamp.
pub(in crate::wire) fn time(us: u64) -> Option<SimTime> {
    (us >> 52 == 0).then(|| SimTime(us as i64 * 1000))
}

/// The stamps of a log.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stamps {
    newest: Option<SimTime>,
    /// Total time from stamp to stamp without steps, ns.
    pub span_ns: i64,
    /// How often a stamp was earlier than the previous one, or more than an hour later.
    pub steps: u64,
}

impl Stamps {
    pub(in crate::wire) fn take(&mut self, t: SimTime) {
        let Some(before) = self.newest.replace(t) else { return };
        let step = t.0 - before.0;
        if (0..=LONGEST).contains(&step) {
            self.span_ns += step;
        } else {
            self.steps += 1;
        }
    }
}
