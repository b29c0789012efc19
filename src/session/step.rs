//! Lockstep: the next packet of samples waits until the other side has taken the one before.

use crate::clock::Clock;
use crate::scene::Output;
use crate::sensor::{Kinds, SensorKind};
use crate::wire::{Controller, Packet};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// After the first answer: for so long without another one, ns, the answers to packets that were sent before it are
/// waited for, so that from then on each belongs to the packet before.
const STRAGGLERS: i64 = 50_000_000;
/// An answer that takes longer, ns, is not waited for.
pub(super) const PATIENCE: i64 = 3_000_000_000;
/// The kinds whose samples are answered.
const ANSWERED: Kinds = Kinds::of(&[SensorKind::Gyro, SensorKind::Accel]);

/// Whether the other side of an output answers each packet of samples.
pub(super) fn in_lockstep(output: &Output) -> bool {
    output.wire.controller == Some(Controller::Px4Sitl)
}

/// One output in lockstep.
#[derive(Debug)]
pub(super) struct Step {
    /// Answers so far, counted by whoever hears them.
    took: Arc<AtomicU64>,
    /// How many there were when the last packet was sent, or when it was last looked.
    seen: u64,
    mode: Mode,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Mode {
    /// Nothing was answered yet: a controller that boots leaves some tens to hundreds of packets unanswered.
    /// They go out no faster than in real time.
    Unanswered,
    /// The first answer came; until then others may follow that belong to packets sent before.
    Stragglers(i64),
    /// Everything sent is answered.
    Even,
    /// The packet sent then is not; whether another had to wait for it.
    Owed(i64, bool),
}

/// What the other side's answers mean for the next packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub(super) enum Turn {
    /// It goes when it is due.
    Goes,
    /// It waits for an answer.
    Waits,
    /// It goes now that the answer is there: scene time stood still for it.
    WasLate,
    /// From now on each packet waits for the answer to the one before.
    Even,
    /// No answer came: it goes without one.
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

    /// A packet was sent at `now`, before which there were so many answers.
    pub(super) fn sent(&mut self, packet: &Packet, taken: u64, now: i64) {
        if self.mode == Mode::Even && is_answered(packet.carries) {
            self.seen = taken;
            self.mode = Mode::Owed(now, false);
        }
    }

    /// Whether nothing was answered yet, or nothing any more.
    pub(super) fn is_unanswered(&self) -> bool {
        self.mode == Mode::Unanswered
    }

    /// Whether a packet that carries these kinds may go now.
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
    /// What follows at `now`, where answers came since the last look or did not, and what it means for the next packet.
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

fn is_answered(carries: Kinds) -> bool {
    !(ANSWERED & carries).is_empty()
}
