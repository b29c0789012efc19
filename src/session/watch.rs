//! What `timing` adds to the pacing thread: slices of a bare timer between those of the stream, and a record of
//! every sample and every wake-up.

use super::Shared;
use crate::clock::{Clock, WallClock};
use crate::report::Times;
use crate::sensor::SensorKind;
use crate::time::{Rate, SimTime};
use crate::wire::Packet;
use rtrb::Producer;

/// From the end of the bare timer's slice to the next packet, ns.
const LEAD: i64 = 1_000_000;

/// Asks the pacing thread for a comparison.
#[derive(Debug)]
pub struct Watch {
    /// The clock that records are in, shared with whoever receives.
    pub clock: WallClock,
    /// How long a slice of the bare timer is, in which scene time stands still, and then one of the stream. Both begin
    /// with half of one, so that no slice begins where packets are due that are sent once a second.
    pub slice: SimTime,
    /// The bare timer's rate.
    pub rate: Rate,
    /// Where records go; what does not fit is counted.
    pub records: Producer<Record>,
}

/// What happened, in ns of the run's clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Record {
    /// A sample's packet was written, or not taken by the link.
    Sample {
        /// Which sensor's.
        kind: SensorKind,
        /// When its packet is due in the scene.
        t: SimTime,
        /// The same on the clock.
        due: i64,
        /// Just before the write call; `None` where the link was full or gone.
        sent: Option<i64>,
    },
    /// The bare timer woke.
    Wake {
        /// Its count over all slices.
        k: u64,
        /// For when it was set.
        due: i64,
        /// Just after.
        woke: i64,
    },
}

/// A comparison under way.
#[derive(Debug)]
pub(super) struct Watching {
    asked: Watch,
    /// Scene time of the next slice of the bare timer.
    next: SimTime,
    pub seen: Watched,
}

/// What came of it.
#[derive(Clone, Debug, Default)]
pub struct Watched {
    /// Lateness of the bare timer's wake-ups.
    pub late: Times,
    /// Records that did not fit.
    pub unrecorded: u64,
}

impl Watching {
    pub(super) fn new(asked: Watch) -> Watching {
        Watching { asked, next: SimTime::ZERO, seen: Watched::default() }
    }

    /// Whether the bare timer's turn comes before what is due at `t`.
    pub(super) fn interrupts(&self, t: SimTime) -> bool {
        t >= self.next
    }

    /// The bare timer's slice; answers where scene time 0 is then, so that the stream goes on as if there had been
    /// none.
    pub(super) fn bare_timer(&mut self, clock: &mut impl Clock, shared: &Shared) -> i64 {
        let start = clock.now() + LEAD;
        let (rate, before) = (self.asked.rate, self.seen.late.count());
        let stream = self.next;
        let first = stream == SimTime::ZERO;
        let length = SimTime(if first { self.asked.slice.0 / 2 } else { self.asked.slice.0 });
        self.next = stream + length;
        for i in 1..=rate.ticks_before(SimTime::ZERO, length) {
            if shared.stopped() {
                break;
            }
            let due = start + rate.tick(i).0;
            clock.sleep_until(due);
            let woke = clock.now();
            self.seen.late.record(woke - due);
            self.record(Record::Wake { k: before + i - 1, due, woke });
        }
        clock.now() + LEAD - stream.0
    }

    /// Records a packet's samples.
    pub(super) fn packet(&mut self, packet: &Packet, due: i64, sent: Option<i64>) {
        let carried = |kind: &&SensorKind| packet.carries.contains(**kind);
        for kind in SensorKind::ALL.iter().filter(carried) {
            self.record(Record::Sample { kind: *kind, t: packet.due, due, sent });
        }
    }

    fn record(&mut self, record: Record) {
        self.seen.unrecorded += u64::from(self.asked.records.push(record).is_err());
    }
}
