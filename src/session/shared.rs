//! What the threads of a run tell each other.

use crate::time::SimTime;
use crate::wire::Packet;
use std::ops::Deref;
use std::sync::atomic::{AtomicBool, AtomicI64, AtomicU64, Ordering};
use std::time::Duration;

/// Between two looks at what is due by itself in a conversation.
pub(super) const TICK: Duration = Duration::from_millis(10);

/// A packet on its way to one of the outputs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Item {
    /// Which output's.
    pub lane: usize,
    pub packet: Packet,
}

/// On cache lines of its own: a thread that reads it with every packet does not wait for what another writes beside it.
#[derive(Debug, Default)]
#[repr(align(128))]
pub(super) struct Apart<T>(T);

impl<T> Deref for Apart<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.0
    }
}

/// A count that the pacing thread alone adds to and others read. No two threads add, so it takes no locked instruction.
#[derive(Debug, Default)]
pub(super) struct Count(AtomicU64);

impl Count {
    /// Adds to it, on the pacing thread.
    pub(super) fn add(&self, more: u64) {
        self.0.store(self.get() + more, Ordering::Relaxed);
    }

    /// What it is now.
    pub(super) fn get(&self) -> u64 {
        self.0.load(Ordering::Relaxed)
    }
}

/// What the threads of a run tell each other.
#[derive(Debug, Default)]
pub(super) struct Shared {
    /// Ends everything soon.
    pub stop: Apart<AtomicBool>,
    /// The producer has pushed its last packet.
    pub all_made: AtomicBool,
    /// Due time of the packet sent last, ns of stream time.
    pub stream_ns: AtomicI64,
    /// Every other side is ready for the scene.
    pub ready: AtomicBool,
    /// Stream time at which the scene starts, ns; the greatest number before that is known.
    pub scene_starts_ns: AtomicI64,
    /// Wall time of stream time 0 on the run's clock, ns; −1 before the start. It moves when scene time is stretched.
    pub start_ns: AtomicI64,
    /// Stream time at which it was stretched last, ns: what was due earlier was due by an earlier start.
    pub stretched_at_ns: AtomicI64,
    pub packets: Count,
    pub dropped: Count,
    /// Packets whose answer was not waited for any longer.
    pub untaken: Count,
}

impl Shared {
    /// Before the start of a run with such a rest.
    pub(super) fn before(rest: Option<SimTime>) -> Shared {
        let scene_starts_ns = AtomicI64::new(if rest.is_some() { i64::MAX } else { 0 });
        Shared { start_ns: AtomicI64::new(-1), scene_starts_ns, ..Shared::default() }
    }

    /// Scene time at a stream time; `None` before the scene.
    pub(super) fn scene_time(&self, stream: SimTime) -> Option<SimTime> {
        let starts = SimTime(self.scene_starts_ns.load(Ordering::Acquire));
        (stream >= starts).then(|| stream - starts)
    }

    /// Stream time at which the packet was due that was sent last.
    pub(super) fn sent(&self) -> SimTime {
        SimTime(self.stream_ns.load(Ordering::Relaxed))
    }

    /// For how long the vehicle was held still, so far.
    pub(super) fn rest(&self) -> SimTime {
        SimTime(self.scene_starts_ns.load(Ordering::Relaxed)).min(self.sent())
    }

    /// Whether everything is to end.
    pub(super) fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}
