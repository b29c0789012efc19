//! Asks a controller for its attitude while it is listened to, as a ground station does, and keeps what it says.

use crate::geometry::Attitude;
use crate::link::Sender;
use crate::wire::Protocol;
use crate::wire::dialogue::{Dialogue, Estimate, Said, Stamp};

/// An attitude that a controller told: its time, ns, and body to nav (north-east-down).
pub type Told = (i64, Attitude);

/// The conversation with one controller.
pub(super) struct Asking {
    dialogue: Box<dyn Dialogue>,
    sender: Sender,
    told: Vec<Told>,
}

impl Asking {
    /// Over this link; `None` for a protocol in which nothing can be asked.
    pub(super) fn new(protocol: Protocol, sender: Sender) -> Option<Asking> {
        let dialogue = protocol.dialogue(None)?;
        Some(Asking { dialogue, sender, told: Vec::new() })
    }

    /// Greets the controller: some say little to whom they do not hear.
    pub(super) fn greet(&mut self, greeting: &[u8]) {
        // If it is lost, the next one follows.
        let _ = self.sender.send(greeting);
    }

    /// Reads bytes that arrived at `now`, ns. Returns notices.
    pub(super) fn hear(&mut self, bytes: &[u8], now: i64) -> Vec<String> {
        self.converse(now, |dialogue, say| dialogue.hear(bytes, now, say))
    }

    /// Asks for what does not come. Call it about every ten milliseconds. Returns notices.
    pub(super) fn tick(&mut self, now: i64) -> Vec<String> {
        self.converse(now, |dialogue, say| dialogue.tick(now, say))
    }

    /// What was told so far, in order of arrival.
    pub(super) fn told(&self) -> &[Told] {
        &self.told
    }

    /// What was told, in order of arrival.
    pub(super) fn into_told(self) -> Vec<Told> {
        self.told
    }

    fn converse(
        &mut self,
        now: i64,
        with: impl FnOnce(&mut dyn Dialogue, &mut dyn FnMut(Said<'_>)),
    ) -> Vec<String> {
        let Asking { dialogue, sender, told } = self;
        let mut notices = Vec::new();
        with(&mut **dialogue, &mut |said| match said {
            Said::Estimate(Estimate { stamp, attitude }) => told.push((time(stamp, now), attitude)),
            Said::Reply(bytes) => {
                // A lost question is asked again.
                let _ = sender.send(bytes);
            }
            Said::Notice(text) | Said::Restart(text) => notices.push(text),
            Said::Took | Said::Pass(_) | Said::Speed(_) | Said::Ahead(_) => {}
        });
        notices
    }
}

/// When an attitude held, ns: by the controller's own clock, or where it has none, when it arrived.
fn time(stamp: Stamp, now: i64) -> i64 {
    match stamp {
        Stamp::Sample(t) => t.0,
        Stamp::Own(ns) => ns,
        Stamp::Arrival => now,
    }
}
