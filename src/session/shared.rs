//! State that the threads of a run share.

use crate::time::SimTime;
use std::ops::Deref;
use std::sync::atomic::{AtomicBool, AtomicI64, AtomicU64, Ordering};
use std::time::Duration;

/// Time between two looks at what a conversation has due.
pub(super) const TICK: Duration = Duration::from_millis(10);

/// A value on cache lines of its own: a thread that reads it with every packet does not wait for writes beside it.
#[derive(Debug, Default)]
#[repr(align(128))]
pub(super) struct Apart<T>(T);

impl<T> Deref for Apart<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.0
    }
}

/// A count that only the pacing thread adds to and others read. With one writer it needs no locked instruction.
#[derive(Debug, Default)]
pub(super) struct Count(AtomicU64);

impl Count {
    /// Adds to the count; only for the pacing thread.
    pub(super) fn add(&self, more: u64) {
        self.0.store(self.get() + more, Ordering::Relaxed);
    }

    /// Sets the count; only for the pacing thread.
    pub(super) fn set(&self, count: u64) {
        self.0.store(count, Ordering::Relaxed);
    }

    /// The present count.
    pub(super) fn get(&self) -> u64 {
        self.0.load(Ordering::Relaxed)
    }
}

/// One output's counts so far, as its lane publishes them for whoever looks on.
#[derive(Debug, Default)]
#[repr(align(128))]
pub(super) struct LaneCounts {
    pub packets: Count,
    pub bytes: Count,
    pub dropped: Count,
    pub queued: Count,
}

/// State that the threads of a run share.
#[derive(Debug, Default)]
pub(super) struct Shared {
    /// Everything is to end soon.
    pub stop: Apart<AtomicBool>,
    /// The producer has pushed its last packet.
    pub all_made: AtomicBool,
    /// Due time of the packet sent last, ns of stream time.
    pub stream_ns: AtomicI64,
    /// Every other side is ready for the scene.
    pub ready: AtomicBool,
    /// Stream time at which the scene starts, ns; the greatest number before that is known.
    pub scene_starts_ns: AtomicI64,
    /// Wall time of stream time 0 on the run's clock, ns; −1 before the start. It moves when scene time is
    /// stretched.
    pub start_ns: AtomicI64,
    /// Stream time of the last stretch, ns: packets due before it were due by an earlier start.
    pub stretched_at_ns: AtomicI64,
    pub packets: Count,
    pub dropped: Count,
    /// What was answered on a bus.
    pub bus: LaneCounts,
    /// Packets for whose answer the wait was given up.
    pub untaken: Count,
}

impl Shared {
    /// The state before the start of a run with this rest.
    pub(super) fn before(rest: Option<SimTime>) -> Shared {
        let scene_starts_ns = AtomicI64::new(if rest.is_some() { i64::MAX } else { 0 });
        Shared { start_ns: AtomicI64::new(-1), scene_starts_ns, ..Shared::default() }
    }

    /// Scene time at a stream time; `None` before the scene.
    pub(super) fn scene_time(&self, stream: SimTime) -> Option<SimTime> {
        let starts = SimTime(self.scene_starts_ns.load(Ordering::Acquire));
        (stream >= starts).then(|| stream - starts)
    }

    /// Stream time at which the packet sent last was due.
    pub(super) fn sent(&self) -> SimTime {
        SimTime(self.stream_ns.load(Ordering::Relaxed))
    }

    /// How long the vehicle has been held still so far.
    pub(super) fn rest(&self) -> SimTime {
        SimTime(self.scene_starts_ns.load(Ordering::Relaxed)).min(self.sent())
    }

    /// Whether everything is to end.
    pub(super) fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}
