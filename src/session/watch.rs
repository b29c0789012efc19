//! A record of every sample that the pacing thread sends, for whoever looks on; and the bare timer of `timing`, whose
//! slices come between those of the stream.

use super::Shared;
use crate::clock::{Clock, WallClock};
use crate::report::Times;
use crate::sensor::SensorKind;
use crate::time::{Rate, SimTime};
use crate::wire::Packet;
use rtrb::Producer;

/// Time from the end of the bare timer's slice to the next packet, ns.
const LEAD: i64 = 1_000_000;

/// A request for records from the pacing thread.
#[derive(Debug)]
pub struct Watch {
    /// The clock of the records, shared with the receiver.
    pub clock: WallClock,
    /// The timer to compare the stream with.
    pub bare: Option<BareTimer>,
    /// Where records go; those that do not fit are counted.
    pub records: Producer<Record>,
}

/// A request for a comparison on the pacing thread.
#[derive(Clone, Copy, Debug)]
pub struct BareTimer {
    /// Length of a slice of the bare timer, during which scene time stands still, and of each stream slice after
    /// it. Both start with half a slice, so that no slice begins where packets are due that are sent once a second.
    pub slice: SimTime,
    /// The bare timer's rate.
    pub rate: Rate,
}

/// An event, in ns of the run's clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Record {
    /// A sample's packet was written, or the link did not take it.
    Sample {
        /// The sensor.
        kind: SensorKind,
        /// When its packet is due in the scene.
        t: SimTime,
        /// Its due time on the clock.
        due: i64,
        /// Time just before the write call; `None` where the link was full or gone.
        sent: Option<i64>,
    },
    /// The bare timer woke.
    Wake {
        /// Its count over all slices.
        k: u64,
        /// The time it was set for.
        due: i64,
        /// The time just after it woke.
        woke: i64,
    },
}

/// Records being made.
#[derive(Debug)]
pub(super) struct Watching {
    asked: Watch,
    /// Scene time of the next slice of the bare timer.
    next: SimTime,
    pub seen: Watched,
}

/// What was recorded.
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

    /// Whether a slice of the bare timer comes before what is due at `t`.
    pub(super) fn interrupts(&self, t: SimTime) -> bool {
        self.asked.bare.is_some() && t >= self.next
    }

    /// Runs a slice of the bare timer. Returns the new clock time of scene time 0, so that the stream goes on as if
    /// there had been no slice.
    pub(super) fn bare_timer(
        &mut self,
        BareTimer { slice, rate }: BareTimer,
        clock: &mut impl Clock,
        shared: &Shared,
    ) -> i64 {
        let start = clock.now() + LEAD;
        let before = self.seen.late.count();
        let stream = self.next;
        let first = stream == SimTime::ZERO;
        let length = SimTime(if first { slice.0 / 2 } else { slice.0 });
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

    /// The timer that the stream takes turns with.
    pub(super) fn bare(&self) -> Option<BareTimer> {
        self.asked.bare
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
