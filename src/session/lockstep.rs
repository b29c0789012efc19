//! Lockstep: the next packet of samples waits until the other side has taken the one before.

use super::Shared;
use super::overload::RETRY;
use super::pacer::{Pacer, Speed};
use crate::clock::Clock;
use crate::sensor::{ByKind, SensorKind};
use crate::time::SimTime;
use crate::wire::{Packet, Protocol};
use crate::{scene::Output, wire::Controller};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// After the first answer: for so long without another one, ns, the answers to packets that were sent before it are
/// waited for, so that from then on each belongs to the packet before.
const STRAGGLERS: i64 = 50_000_000;
/// An answer that takes longer, ns, is not waited for.
pub(super) const PATIENCE: i64 = 3_000_000_000;
/// The kinds whose samples are answered.
const ANSWERED: ByKind<bool> = {
    let mut answered = [false; SensorKind::COUNT];
    answered[SensorKind::Gyro as usize] = true;
    answered[SensorKind::Accel as usize] = true;
    answered
};

/// Whether the other side of an output answers each packet of samples.
pub(super) fn in_lockstep(output: &Output) -> bool {
    output.to.protocol == Protocol::Mavlink && output.wire.controller == Some(Controller::Px4Sitl)
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

    pub(super) fn is_unanswered(&self) -> bool {
        self.mode == Mode::Unanswered
    }
}

fn is_answered(carries: u8) -> bool {
    ANSWERED.iter().enumerate().any(|(kind, answered)| *answered && carries >> kind & 1 == 1)
}

impl<C: Clock> Pacer<C> {
    /// How fast stream time goes now.
    pub(super) fn tempo(&self) -> Speed {
        let unanswered = self.steps.iter().flatten().any(Step::is_unanswered);
        match self.speed {
            Speed::Times(times) if times <= 1.0 => self.speed,
            _ if unanswered => Speed::Times(1.0),
            _ => self.speed,
        }
    }

    /// Whether the next packet, due at `t`, has to wait for the other side; if so, some of that wait has passed.
    pub(super) fn steps_after(&mut self, output: usize, carries: u8, t: SimTime, shared: &Shared) -> bool {
        let Some(step) = self.steps[output].as_mut().filter(|_| is_answered(carries)) else { return false };
        if self.gone[output].is_some() {
            return false;
        }
        let (now, taken) = (self.clock.now(), step.taken());
        let came = taken != step.seen;
        let (mode, waits) = match step.mode {
            Mode::Unanswered if came => (Mode::Stragglers(now + STRAGGLERS), true),
            Mode::Unanswered => (Mode::Unanswered, false),
            Mode::Stragglers(_) if came => (Mode::Stragglers(now + STRAGGLERS), true),
            Mode::Stragglers(until) if now < until => (step.mode, true),
            Mode::Stragglers(_) | Mode::Even => (Mode::Even, false),
            Mode::Owed(..) if came => (Mode::Even, false),
            Mode::Owed(since, _) if now - since < PATIENCE => (Mode::Owed(since, true), true),
            Mode::Owed(..) => (Mode::Unanswered, false),
        };
        let before = std::mem::replace(&mut step.mode, mode);
        if !matches!(mode, Mode::Owed(..)) {
            step.seen = taken;
        }
        match (before, mode) {
            // The tempo is another from here on.
            (Mode::Stragglers(_), Mode::Even) => self.due_now(t, shared),
            (Mode::Owed(..), Mode::Unanswered) => {
                shared.untaken.fetch_add(1, Ordering::Relaxed);
                self.due_now(t, shared);
            }
            (Mode::Owed(_, true), Mode::Even) => self.stand_still_until(now, t, shared),
            _ => {}
        }
        if waits {
            self.clock.doze_until(now + RETRY);
        }
        waits
    }

    /// Scene time stood still for the other side, where this packet was due before `now`.
    fn stand_still_until(&mut self, now: i64, t: SimTime, shared: &Shared) {
        let due = self.due(t);
        if due != i64::MIN {
            self.shift(now - due, t.0, shared);
        }
    }

    /// From here on the stream goes as if what is due at `t` were due now.
    fn due_now(&mut self, t: SimTime, shared: &Shared) {
        let due = self.due(t);
        if due != i64::MIN {
            self.start += self.clock.now() - due;
            shared.start_ns.store(self.start, Ordering::Relaxed);
        }
    }
}
