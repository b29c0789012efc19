//! Requests an autopilot's attitude often enough to score it.

use super::{Autopilot, Said, Voice};
use crate::time::NANOS;
use ratetable_protocols::mavlink::{Message, attitude, attitude_quaternion, command_ack, command_long};

/// The requested interval: 50 Hz.
const INTERVAL_US: f32 = 20_000.0;
/// At half of that, messages flow well enough.
const ENOUGH_HZ: u32 = 25;
/// Time between two requests, ns. Only one is open at a time, so that an answer belongs to it.
const PAUSE: i64 = NANOS / 2;

/// The wanted messages and their state.
#[derive(Debug)]
pub(super) struct Asking {
    wanted: [Wanted; 2],
    /// The last request, and its time.
    last: Option<(usize, i64)>,
}

#[derive(Debug)]
struct Wanted {
    id: u32,
    /// The request was granted, or refused for good.
    settled: bool,
    /// It flowed once. What stops then is requested again: a controller that restarts forgets the request.
    flowed: bool,
    flow: Flow,
}

/// Messages received in the second since `since`, and in the second before.
#[derive(Debug, Default)]
struct Flow {
    since: i64,
    count: u32,
    before: u32,
}

impl Default for Asking {
    fn default() -> Asking {
        let wanted = |id| Wanted { id, settled: false, flowed: false, flow: Flow::default() };
        Asking { wanted: [attitude_quaternion::ID, attitude::ID].map(wanted), last: None }
    }
}

impl Asking {
    /// Counts a received message of that id.
    pub(super) fn hear(&mut self, id: u32, now: i64) {
        if let Some(wanted) = self.wanted.iter_mut().find(|wanted| wanted.id == id) {
            wanted.flow.at(now);
            wanted.flow.count += 1;
            wanted.flowed |= wanted.flow.is_enough(now);
        }
    }

    /// Handles the answer to a command.
    pub(super) fn answered(&mut self, command: u16, result: u8) {
        let for_now = [command_ack::TEMPORARILY_REJECTED, command_ack::IN_PROGRESS].contains(&result);
        if command == command_long::SET_MESSAGE_INTERVAL
            && !for_now
            && let Some((last, _)) = self.last
        {
            self.wanted[last].settled = true;
        }
    }

    /// Requests the next message that does not flow.
    pub(super) fn tick(
        &mut self,
        now: i64,
        autopilot: &Autopilot,
        voice: &mut Voice,
        say: &mut dyn FnMut(Said<'_>),
    ) {
        if self.last.is_some_and(|(_, at)| now - at < PAUSE) {
            return;
        }
        let after = self.last.map_or(0, |(last, _)| last + 1);
        let mut turn = (after..after + self.wanted.len()).map(|i| i % self.wanted.len());
        let Some(next) = turn.find(|&i| self.wanted[i].is_missing(now)) else { return };
        self.last = Some((next, now));
        self.wanted[next].flowed = false;
        self.wanted[next].settled = false;
        let command = command_long::Repr {
            params: [self.wanted[next].id as f32, INTERVAL_US, 0.0, 0.0, 0.0, 0.0, 0.0],
            command: command_long::SET_MESSAGE_INTERVAL,
            target_system: autopilot.system,
            target_component: autopilot.component,
            confirmation: 0,
        };
        voice.say(&Message::CommandLong(command), say);
    }
}

impl Wanted {
    /// Whether it does not flow, and a request may help.
    fn is_missing(&self, now: i64) -> bool {
        (!self.settled || self.flowed) && !self.flow.is_enough(now)
    }
}

impl Flow {
    fn at(&mut self, now: i64) {
        let seconds = (now - self.since) / NANOS;
        if seconds != 0 {
            self.before = if seconds == 1 { self.count } else { 0 };
            (self.count, self.since) = (0, self.since + seconds * NANOS);
        }
    }

    fn is_enough(&self, now: i64) -> bool {
        let newest = match (now - self.since) / NANOS {
            0 => self.before.max(self.count),
            1 => self.count,
            _ => 0,
        };
        newest >= ENOUGH_HZ
    }
}
