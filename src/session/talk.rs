//! The conversations of a run: what the other sides say, what they are answered, how far each is.
//!
//! It reads no clock and waits for nothing: the control side hands it bytes and the time.

use super::answers::Heard;
use super::replies::{Replies, Way};
use crate::link::Sender;
use crate::scene::Output;
use crate::wire::dialogue::{self, Dialogue, Peer, Said, Stage};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread::Thread;

/// Everything that is said on all links.
pub(super) struct Talk {
    sides: Vec<Side>,
    pub heard: Heard,
    notices: Vec<String>,
    /// Whether the user knows that estimates are not judged.
    told_untimed: bool,
    /// A ground station, and on which link the controller is that it talks to.
    ground: Option<(Sender, usize)>,
    /// Who waits for an answer in lockstep.
    pub pacing: Option<Thread>,
}

/// One link's conversation.
struct Side {
    dialogue: Option<Box<dyn Dialogue>>,
    protocol: &'static str,
    way: Way,
    /// Bytes that came, and messages among them.
    bytes: u64,
    messages: u64,
    took: Arc<AtomicU64>,
}

impl Talk {
    /// One sender an output.
    pub(super) fn new(outputs: &[Output], senders: Vec<Sender>, heard: Heard) -> Talk {
        let side = |(output, sender): (&Output, Sender)| Side {
            dialogue: dialogue::dialogue(output.to.protocol, output.wire.controller),
            protocol: output.to.protocol.name(),
            way: Way::Link(sender, 0),
            bytes: 0,
            messages: 0,
            took: Arc::default(),
        };
        let sides = outputs.iter().zip(senders).map(side).collect();
        Talk { sides, heard, notices: Vec::new(), told_untimed: false, ground: None, pacing: None }
    }

    /// Holds this conversation on a link in place of its protocol's own.
    #[cfg(test)]
    pub(super) fn script(&mut self, link: usize, dialogue: Box<dyn Dialogue>) {
        self.sides[link].dialogue = Some(dialogue);
    }

    /// Passes on to a ground station what the controller on a link says.
    pub(super) fn bridge(&mut self, sender: Sender, link: usize) {
        self.ground = Some((sender, link));
    }

    /// Takes in what arrived on a link at `now`, ns on the run's clock.
    pub(super) fn hear(&mut self, link: usize, bytes: &[u8], now: i64) {
        self.sides[link].bytes += bytes.len() as u64;
        self.converse(link, |dialogue, talk| {
            dialogue.hear(bytes, now, &mut |said| {
                talk.sides[link].messages += u64::from(!matches!(said, Said::Notice(_)));
                talk.said(link, said, now);
            });
        });
    }

    /// What is due by itself.
    pub(super) fn tick(&mut self, now: i64) {
        for link in 0..self.sides.len() {
            self.converse(link, |dialogue, talk| dialogue.tick(now, &mut |said| talk.said(link, said, now)));
        }
    }

    fn converse(&mut self, link: usize, with: impl FnOnce(&mut dyn Dialogue, &mut Talk)) {
        if let Some(mut dialogue) = self.sides[link].dialogue.take() {
            with(&mut *dialogue, self);
            self.sides[link].dialogue = Some(dialogue);
        }
    }

    fn said(&mut self, link: usize, said: Said<'_>, now: i64) {
        match said {
            Said::Estimate(estimate) if self.heard.is_timed(&estimate) => {
                self.heard.take_in(link, estimate, now);
            }
            Said::Estimate(_) => {
                if !std::mem::replace(&mut self.told_untimed, true) {
                    self.notices.push("attitudes come back that do not say which sample they rest on; at --speed max nothing else tells when they held, so they are not judged: leave --speed out".into());
                }
            }
            Said::Reply(bytes) => self.reply(link, bytes),
            Said::Took => {
                self.sides[link].took.fetch_add(1, Ordering::Release);
                if let Some(pacing) = &self.pacing {
                    pacing.unpark();
                }
            }
            Said::Notice(text) => self.notices.push(text),
            Said::Pass(frame) => {
                if let Some((sender, _)) = self.ground.as_mut().filter(|(_, with)| *with == link) {
                    // A ground station that is not there, or not fast enough, misses it.
                    let _ = sender.send(frame);
                }
            }
        }
    }

    fn reply(&mut self, link: usize, bytes: &[u8]) {
        // Whoever asked and is not answered asks again.
        let _ = self.sides[link].way.reply(bytes);
    }

    /// Passes on to the controller what the ground station says.
    pub(super) fn pass_down(&mut self, datagram: &[u8]) {
        let Some(&(_, link)) = self.ground.as_ref() else { return };
        dialogue::frames(datagram).for_each(|frame| self.reply(link, frame));
    }

    /// Gives a link away to the pacing thread.
    pub(super) fn hand_over(&mut self, link: usize) -> (Sender, Option<Replies>) {
        let side = &mut self.sides[link];
        let (sender, replies) = side.way.hand_over();
        let bridged = self.ground.as_ref().is_some_and(|(_, with)| *with == link);
        (sender, (side.dialogue.is_some() || bridged).then_some(replies))
    }

    /// Counts the packets that the other side of a link has taken.
    pub(super) fn took(&self, link: usize) -> Arc<AtomicU64> {
        self.sides[link].took.clone()
    }

    fn stages(&self) -> impl Iterator<Item = Stage> {
        self.sides.iter().map(|side| side.dialogue.as_ref().map_or(Stage::Ready, |dialogue| dialogue.stage()))
    }

    /// The first link on which nobody may be sent samples yet.
    pub(super) fn silent(&self) -> Option<usize> {
        self.stages().position(|stage| stage == Stage::Silent)
    }

    /// The first link whose other side is not ready for the scene.
    pub(super) fn unready(&self) -> Option<usize> {
        self.stages().position(|stage| stage < Stage::Ready)
    }

    /// What came on a link, for whoever waited in vain.
    pub(super) fn what_came(&self, link: usize) -> String {
        let Side { protocol, bytes, messages, .. } = &self.sides[link];
        match (bytes, messages) {
            (0, _) => {
                "nothing came from it (is it switched on, wired TX to RX, and at this end of the link?)"
                    .into()
            }
            (_, 0) => format!(
                "{bytes} bytes came and no {protocol} message among them (is it at this baud rate, and does it speak {protocol} on this port?)"
            ),
            _ => format!("{messages} messages came in {bytes} bytes, but not what it begins with"),
        }
    }

    /// What is known of each other side.
    pub(super) fn peers(&self) -> Vec<Peer> {
        let known = |side: &Side| side.dialogue.as_ref().map_or(Peer::default(), |dialogue| dialogue.peer());
        self.sides.iter().map(known).collect()
    }

    /// What the user should know and was not told yet.
    pub(super) fn take_notices(&mut self) -> Vec<String> {
        std::mem::take(&mut self.notices)
    }

    /// Damaged packets, by link.
    pub(super) fn damaged(&self) -> Vec<u64> {
        self.sides
            .iter()
            .map(|side| side.dialogue.as_ref().map_or(0, |dialogue| dialogue.damaged()))
            .collect()
    }

    /// Replies that each link took before it was given away.
    pub(super) fn replies(&self) -> Vec<u64> {
        self.sides.iter().map(|side| side.way.written()).collect()
    }
}
