//! The rest before the scene: whether the scene may begin, and how long the run waits for that.

use super::{SessionError, Shared, step};
use crate::time::SimTime;
use std::sync::atomic::Ordering;
use std::time::Duration;
use tokio::time::Instant;

/// State of the rest, on the control side.
pub(super) struct Hold {
    rest: SimTime,
    /// Since when the run waits only for the other side.
    since: Option<Instant>,
    began: bool,
    /// Lockstep answers that did not come.
    untaken: u64,
}

impl Hold {
    /// State for a scene that begins after this rest, or at once.
    pub(super) fn new(rest: Option<SimTime>) -> Hold {
        Hold { rest: rest.unwrap_or_default(), since: None, began: rest.is_none(), untaken: 0 }
    }

    /// Checks the rest: `unready` is a link whose other side is not ready, with what arrived on it. True when the
    /// scene has begun since the last look.
    ///
    /// # Errors
    /// The rest has been over for `wait` and some side is not ready.
    pub(super) fn look(
        &mut self,
        shared: &Shared,
        unready: Option<(String, String)>,
        wait: Duration,
    ) -> Result<bool, SessionError> {
        if self.began {
            return Ok(false);
        }
        shared.ready.store(unready.is_none() || wait.is_zero(), Ordering::Relaxed);
        let t = shared.sent();
        if shared.scene_time(t).is_some() {
            self.began = true;
            return Ok(true);
        }
        match unready.filter(|_| t >= self.rest && !wait.is_zero()) {
            None => self.since = None,
            Some((link, came)) => {
                let since = *self.since.get_or_insert_with(Instant::now);
                if since.elapsed() >= wait {
                    return Err(SessionError::NotReady { link, rested: t, came });
                }
            }
        }
        Ok(false)
    }

    /// A notice about lockstep answers that did not come.
    pub(super) fn untaken(&mut self, shared: &Shared) -> Option<String> {
        let untaken = shared.untaken.get();
        let patience = SimTime(step::PATIENCE);
        let before = std::mem::replace(&mut self.untaken, untaken);
        let what = format!("no answer to a packet of samples for {patience}");
        match (before, untaken) {
            (0, 1..) => Some(format!("{what}: the stream goes on in real time until the next one")),
            (1, 2..) => Some(format!("{what} again: from now on this is counted, not told")),
            _ => None,
        }
    }
}
