//! The conversation with one other side: who they are, what came from them, how they are answered.

use super::lane::Lane;
use super::replies::Way;
use super::step::{Step, in_lockstep};
use crate::link::Sender;
use crate::scene::Output;
use crate::score::Timed;
use crate::wire::dialogue::{Dialogue, Peer, Stage};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// One of them.
pub(super) struct Side {
    pub dialogue: Option<Box<dyn Dialogue>>,
    /// Its estimates, in the order in which they arrived.
    pub estimates: Vec<Timed>,
    /// Bytes that came, and messages among them.
    pub bytes: u64,
    pub messages: u64,
    protocol: &'static str,
    /// The way out to its link.
    way: Way,
    /// Where it is spoken with, if not there: the pacing thread has no part in that.
    apart: Option<Way>,
    /// In lockstep: packets that it has taken.
    took: Arc<AtomicU64>,
}

impl Side {
    /// Of an output, with the way out to its link, and to where the other side answers if not there.
    pub(super) fn new(output: &Output, sender: Sender, apart: Option<Sender>) -> Side {
        let dialogue = || output.to.protocol.dialogue(output.wire.controller);
        Side {
            dialogue: output.to.is_spoken_with().then(dialogue).flatten(),
            estimates: Vec::new(),
            bytes: 0,
            messages: 0,
            protocol: output.to.protocol.name(),
            way: Way::Link(sender, 0),
            apart: apart.map(|sender| Way::Link(sender, 0)),
            took: Arc::default(),
        }
    }

    /// Answers. Whoever asked and is not answered asks again.
    pub(super) fn reply(&mut self, bytes: &[u8]) {
        let _ = self.apart.as_mut().unwrap_or(&mut self.way).reply(bytes);
    }

    /// Sends a packet on its link, as long as the stream has not begun.
    pub(super) fn send_ahead(&mut self, bytes: &[u8]) {
        if let Way::Link(..) = self.way {
            let _ = self.way.reply(bytes);
        }
    }

    /// It has taken another packet.
    pub(super) fn took(&mut self) {
        self.took.fetch_add(1, Ordering::Release);
    }

    /// Counts the packets that it has taken.
    pub(super) fn counter(&self) -> Arc<AtomicU64> {
        self.took.clone()
    }

    /// Gives the link away to the pacing thread; `bridged` where somebody else may want to send beside the stream.
    pub(super) fn lane(&mut self, output: &Output, bridged: bool) -> Lane {
        let (sender, replies) = self.way.hand_over();
        let mut lane = Lane::new(sender, output.overload);
        let spoken_with = self.dialogue.is_some() && self.apart.is_none();
        lane.replies = (spoken_with || bridged).then_some(replies);
        lane.step = in_lockstep(output).then(|| Step::new(self.counter()));
        lane
    }

    /// How far the conversation is.
    pub(super) fn stage(&self) -> Stage {
        self.dialogue.as_ref().map_or(Stage::Ready, |dialogue| dialogue.stage())
    }

    /// What is known of the other side.
    pub(super) fn peer(&self) -> Peer {
        self.dialogue.as_ref().map_or(Peer::default(), |dialogue| dialogue.peer())
    }

    /// Damaged packets that came.
    pub(super) fn damaged(&self) -> u64 {
        self.dialogue.as_ref().map_or(0, |dialogue| dialogue.damaged())
    }

    /// Replies that the link took before it was given away, and all that went where it is spoken with apart.
    pub(super) fn replies(&self) -> u64 {
        self.way.written() + self.apart.as_ref().map_or(0, Way::written)
    }

    /// What came, for whoever waited in vain.
    pub(super) fn what_came(&self) -> String {
        let Side { protocol, bytes, messages, .. } = self;
        match (bytes, messages) {
            (0, _) => {
                "nothing came from it (is it switched on, wired TX to RX, and at this end of the link?)"
                    .into()
            }
            (_, 0) if self.apart.is_some() => {
                format!("it answers ({bytes} bytes came), but is not to be fed yet (a notice says why)")
            }
            (_, 0) => format!(
                "{bytes} bytes came and no {protocol} message among them (is it at this baud rate, and does it speak {protocol} on this port?)"
            ),
            _ => format!("{messages} messages came in {bytes} bytes, but not what it begins with"),
        }
    }
}
