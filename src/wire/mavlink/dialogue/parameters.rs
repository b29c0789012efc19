//! Reads integer parameters of a PX4 by name, and retransmits requests that stay unanswered.

use super::{Autopilot, Said, Voice};
use crate::time::NANOS;
use ratetable_protocols::mavlink::{Message, param_id, param_name, param_request_read, param_value};

/// Time between two requests of any name, ns: the stream of samples stays even.
const BETWEEN: i64 = NANOS / 50;
/// Time until a retransmission for the same name, ns.
const RESEND: i64 = NANOS / 2;
/// The most requests for one name: a controller does not answer for a parameter that it does not have.
const TIMES: u32 = 5;

/// The requested parameters and what is known of each.
#[derive(Debug, Default)]
pub(super) struct Parameters {
    wanted: Vec<Wanted>,
    asked_at: Option<i64>,
}

#[derive(Debug)]
struct Wanted {
    name: &'static str,
    value: Option<i32>,
    asked: u32,
    asked_at: i64,
}

impl Parameters {
    /// Requests one more parameter, once.
    pub(super) fn want(&mut self, name: &'static str) {
        if !self.wanted.iter().any(|wanted| wanted.name == name) {
            self.wanted.push(Wanted { name, value: None, asked: 0, asked_at: 0 });
        }
    }

    /// Forgets everything, after a reboot of the controller.
    pub(super) fn forget(&mut self) {
        *self = Parameters::default();
    }

    /// Stores a value. PX4 puts the bits of an integer into the float of the message.
    pub(super) fn take(&mut self, message: &param_value::Repr) {
        let name = param_name(&message.param_id);
        if let Some(wanted) = self.wanted.iter_mut().find(|wanted| wanted.name == name) {
            wanted.value = Some(match message.param_type {
                param_value::REAL32 => message.param_value as i32,
                _ => message.param_value.to_bits().cast_signed(),
            });
        }
    }

    /// The value of a parameter, if known.
    pub(super) fn get(&self, name: &str) -> Option<i32> {
        self.wanted.iter().find(|wanted| wanted.name == name)?.value
    }

    /// Whether no more answers are expected for a parameter: it arrived, or its requests ran out.
    pub(super) fn settled(&self, name: &str, now: i64) -> bool {
        let given_up = |wanted: &Wanted| wanted.asked >= TIMES && now - wanted.asked_at > RESEND;
        let wanted = self.wanted.iter().find(|wanted| wanted.name == name);
        wanted.is_none_or(|wanted| wanted.value.is_some() || given_up(wanted))
    }

    /// Sends the next request that is due.
    pub(super) fn tick(
        &mut self,
        now: i64,
        autopilot: &Autopilot,
        voice: &mut Voice,
        say: &mut dyn FnMut(Said<'_>),
    ) {
        if self.asked_at.is_some_and(|at| now - at < BETWEEN) {
            return;
        }
        let due = |wanted: &&mut Wanted| {
            let pause_is_over = wanted.asked == 0 || now - wanted.asked_at >= RESEND;
            wanted.value.is_none() && wanted.asked < TIMES && pause_is_over
        };
        let Some(wanted) = self.wanted.iter_mut().filter(due).min_by_key(|wanted| wanted.asked) else {
            return;
        };
        (wanted.asked, wanted.asked_at, self.asked_at) = (wanted.asked + 1, now, Some(now));
        let request = param_request_read::Repr {
            param_index: -1,
            target_system: autopilot.system,
            target_component: autopilot.component,
            param_id: param_id(wanted.name),
        };
        voice.say(&Message::ParamRequestRead(request), say);
    }
}
