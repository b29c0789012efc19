//! The time of a run on the pacing thread: its clock, where stream time 0 is on it, and how long scene time stood
//! still.

use super::Shared;
use super::effort::Effort;
use super::watch::Watching;
use crate::clock::{Clock, Precise, WallClock};
use crate::report::PacingReport;
use crate::time::SimTime;
use crate::wire::Packet;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// How fast scene time goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Speed {
    /// This many scene seconds a second.
    Times(f64),
    /// As fast as the other side reads: nothing is paced, nothing is dropped.
    Max,
}

impl Default for Speed {
    /// Real time.
    fn default() -> Speed {
        Speed::Times(1.0)
    }
}

impl Speed {
    /// The entry for the report: a number, or `max`.
    pub fn report(self) -> serde_json::Value {
        match self {
            Speed::Times(times) => times.into(),
            Speed::Max => "max".into(),
        }
    }

    /// Whether packets wait for their due time.
    pub fn is_paced(self) -> bool {
        self != Speed::Max
    }
}

/// Due without a wait, where nothing is paced.
pub(super) const AT_ONCE: i64 = i64::MIN;

/// The time of one run.
pub(super) struct Pace<C> {
    pub clock: C,
    pub speed: Speed,
    pub shared: Arc<Shared>,
    /// The comparison with a bare timer that `timing` asks for.
    pub watching: Option<Watching>,
    /// How long scene time stood still, ns: `start` has moved by that much.
    pub stretched: i64,
    /// Stream time 0 on the clock, ns.
    start: i64,
    effort: Effort,
}

impl<C: Clock> Pace<C> {
    pub(super) fn new(clock: C, speed: Speed, shared: Arc<Shared>) -> Pace<C> {
        let effort = Effort::default();
        Pace { clock, speed, shared, watching: None, stretched: 0, start: 0, effort }
    }

    /// Sets stream time 0 to `start` on the clock, ns.
    pub(super) fn begin(&mut self, start: i64) {
        self.effort.resume(self.clock.now());
        self.starts_at(start);
    }

    /// Nothing more is sent.
    pub(super) fn end(&mut self) {
        self.effort.pause(self.clock.now());
    }

    fn starts_at(&mut self, start: i64) {
        self.start = start;
        self.shared.start_ns.store(start, Ordering::Relaxed);
    }

    /// The due time on the clock of the stream time `t` at this tempo, ns, or [`AT_ONCE`].
    pub(super) fn due(&self, t: SimTime, tempo: Speed) -> i64 {
        match tempo {
            Speed::Times(1.0) => self.start + t.0,
            Speed::Times(times) => self.start + (t.0 as f64 / times) as i64,
            Speed::Max => AT_ONCE,
        }
    }

    /// Delays everything from the stream time `t` on by `by` ns.
    pub(super) fn shift(&mut self, by: i64, t: SimTime) {
        if by > 0 {
            self.stretched += by;
            self.shared.stretched_at_ns.store(t.0, Ordering::Relaxed);
            self.starts_at(self.start + by);
        }
    }

    /// Records that scene time stood still until now, where what is due at `t` was due on the clock at `due`.
    pub(super) fn stood_still(&mut self, due: i64, t: SimTime) {
        if due != AT_ONCE {
            self.shift(self.clock.now() - due, t);
        }
    }

    /// Moves the stream so that what is due on the clock at `due` is due now.
    pub(super) fn due_now(&mut self, due: i64) {
        if due != AT_ONCE {
            self.starts_at(self.start + self.clock.now() - due);
        }
    }

    /// Waits this many ns.
    pub(super) fn wait(&mut self, ns: i64) {
        let until = self.clock.now() + ns;
        self.clock.wait_until(until);
    }

    /// Whether a slice of the bare timer comes before what is due at `t`.
    pub(super) fn is_bare_timers_turn(&self, t: SimTime) -> bool {
        self.watching.as_ref().is_some_and(|watching| watching.interrupts(t))
    }

    /// Runs a slice of the bare timer; scene time stands still meanwhile.
    pub(super) fn compare(&mut self) {
        let Some(watching) = &mut self.watching else { return };
        let Some(bare) = watching.bare() else { return };
        self.effort.pause(self.clock.now());
        let start = watching.bare_timer(bare, &mut self.clock, &self.shared);
        self.starts_at(start);
        self.effort.resume(self.clock.now());
    }

    /// Records a packet that was written at `sent`.
    pub(super) fn record_sent(&mut self, packet: &Packet, due: i64, sent: i64) {
        if let Some(watching) = &mut self.watching {
            watching.packet(packet, due, Some(sent));
        }
    }

    /// Records a lost packet.
    pub(super) fn record_lost(&mut self, packet: &Packet) {
        if let Some(watching) = &mut self.watching {
            watching.packet(packet, self.start + packet.due.0, None);
        }
    }
}

impl Pace<Precise<WallClock>> {
    /// How the thread waited, on the processor it was bound to; `None` if nothing was paced.
    pub(super) fn report(&self, pinned_cpu: Option<usize>) -> Option<PacingReport> {
        let pacing_cpu = self.effort.share().filter(|_| self.speed.is_paced())?;
        let spin_us = self.clock.margin().ns() as f64 / 1000.0;
        Some(PacingReport { spin_us, pacing_cpu, pinned_cpu })
    }
}
