//! Lockstep: the next packet of samples waits until the other side has read the one before.

use crate::clock::Clock;
use crate::scene::Output;
use crate::sensor::{Kinds, SensorKind};
use crate::wire::{Controller, Packet};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Settling time after the first answer, ns: until no answer has come for this long, answers may belong to earlier
/// packets. After that each belongs to the packet before it.
const STRAGGLERS: i64 = 50_000_000;
/// Timeout for an answer, ns.
pub(super) const PATIENCE: i64 = 3_000_000_000;
/// The kinds whose samples are answered.
const ANSWERED: Kinds = Kinds::of(&[SensorKind::Gyro, SensorKind::Accel]);

/// Whether the other side of an output answers each packet of samples.
pub(super) fn in_lockstep(output: &Output) -> bool {
    output.wire.controller == Some(Controller::Px4Sitl)
}

/// Lockstep of one output.
#[derive(Debug)]
pub(super) struct Step {
    /// Answers so far; the receiving side counts them.
    took: Arc<AtomicU64>,
    /// Their number when the last packet was sent, or at the last look.
    seen: u64,
    mode: Mode,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Mode {
    /// Nothing was answered yet: a booting controller leaves tens to hundreds of packets unanswered. They go out no
    /// faster than in real time.
    Unanswered,
    /// The first answer came; answers to earlier packets may still follow.
    Stragglers(i64),
    /// Every packet is answered.
    Even,
    /// The packet sent at this time is unanswered; the flag says whether another one had to wait for it.
    Owed(i64, bool),
}

/// What the answers mean for the next packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub(super) enum Turn {
    /// It goes when due.
    Goes,
    /// It waits for an answer.
    Waits,
    /// It goes because the answer has come: scene time stood still for it.
    WasLate,
    /// From now on each packet waits for the answer to the one before.
    Even,
    /// No answer came within the timeout: it goes without one.
    Untaken,
}

impl Step {
    pub(super) fn new(took: Arc<AtomicU64>) -> Step {
        Step { took, seen: 0, mode: Mode::Unanswered }
    }

    /// Answers so far.
    pub(super) fn taken(&self) -> u64 {
        self.took.load(Ordering::Acquire)
    }

    /// Records a packet sent at `now`, with the number of answers before it.
    pub(super) fn sent(&mut self, packet: &Packet, taken: u64, now: i64) {
        if self.mode == Mode::Even && is_answered(packet.carries) {
            self.seen = taken;
            self.mode = Mode::Owed(now, false);
        }
    }

    /// Whether nothing was answered yet, or answers have stopped.
    pub(super) fn is_unanswered(&self) -> bool {
        self.mode == Mode::Unanswered
    }

    /// Whether a packet with these kinds may go now.
    pub(super) fn turn(&mut self, carries: Kinds, clock: &impl Clock) -> Turn {
        if !is_answered(carries) {
            return Turn::Goes;
        }
        let (now, taken) = (clock.now(), self.taken());
        let (mode, turn) = self.mode.next(taken != self.seen, now);
        if !matches!(mode, Mode::Owed(..)) {
            self.seen = taken;
        }
        self.mode = mode;
        turn
    }
}

impl Mode {
    /// The next mode at `now` and its meaning for the next packet; `came` says whether answers came since the last
    /// look.
    fn next(self, came: bool, now: i64) -> (Mode, Turn) {
        match self {
            Mode::Unanswered if came => (Mode::Stragglers(now + STRAGGLERS), Turn::Waits),
            Mode::Unanswered => (Mode::Unanswered, Turn::Goes),
            Mode::Stragglers(_) if came => (Mode::Stragglers(now + STRAGGLERS), Turn::Waits),
            Mode::Stragglers(until) if now < until => (self, Turn::Waits),
            Mode::Stragglers(_) => (Mode::Even, Turn::Even),
            Mode::Even => (Mode::Even, Turn::Goes),
            Mode::Owed(_, true) if came => (Mode::Even, Turn::WasLate),
            Mode::Owed(_, false) if came => (Mode::Even, Turn::Goes),
            Mode::Owed(since, _) if now - since < PATIENCE => (Mode::Owed(since, true), Turn::Waits),
            Mode::Owed(..) => (Mode::Unanswered, Turn::Untaken),
        }
    }
}

/// Whether the other side answers a packet that carries these kinds.
pub(super) fn is_answered(carries: Kinds) -> bool {
    !(ANSWERED & carries).is_empty()
}
