//! The conversation with one other side: who they are, what came from them, how they are answered.

use super::lane::Lane;
use super::replies::Way;
use super::step::{Step, in_lockstep};
use crate::link::{Baud, Sender};
use crate::scene::Output;
use crate::score::Timed;
use crate::wire::dialogue::{Dialogue, Peer, Stage};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender as News, channel};

/// One of them.
pub(super) struct Side {
    pub dialogue: Option<Box<dyn Dialogue>>,
    /// Its estimates, in the order in which they arrived.
    pub estimates: Vec<Timed>,
    /// Bytes that came, and messages among them.
    pub bytes: u64,
    pub messages: u64,
    /// The speed of its port, where it has one.
    pub baud: Option<Baud>,
    /// The speed that it asked for, until what was said before has gone out.
    next_baud: Option<u32>,
    /// To whom it is told what is known of it, once that changes.
    news: Option<(Peer, News<Peer>)>,
    protocol: &'static str,
    way: Way,
    /// In lockstep: packets that it has taken.
    took: Arc<AtomicU64>,
}

impl Side {
    /// Of an output, with the way out to its link.
    pub(super) fn new(output: &Output, sender: Sender) -> Side {
        Side {
            dialogue: output.to.protocol.dialogue(output.wire.controller),
            estimates: Vec::new(),
            bytes: 0,
            messages: 0,
            baud: None,
            next_baud: None,
            news: None,
            protocol: output.to.protocol.name(),
            way: Way::Link(sender, 0),
            took: Arc::default(),
        }
    }

    /// Answers. Whoever asked and is not answered asks again.
    pub(super) fn reply(&mut self, bytes: &[u8]) {
        let _ = self.way.reply(bytes);
    }

    /// It has taken another packet.
    pub(super) fn took(&mut self) {
        self.took.fetch_add(1, Ordering::Release);
    }

    /// It goes on at another speed.
    pub(super) fn change_speed(&mut self, baud: u32) {
        self.next_baud = self.baud.as_ref().map(|_| baud);
    }

    /// Follows it to the speed that it asked for, as soon as what it was answered is written; what the user should know.
    pub(super) fn follow_speed(&mut self) -> Option<String> {
        let baud = self.next_baud.take_if(|_| self.way.is_empty())?;
        let port = self.baud.as_ref().filter(|port| port.now() != baud)?;
        Some(match port.set(baud) {
            Ok(()) => format!("the flight controller sets {baud} baud: the port goes on at that"),
            Err(error) => format!(
                "the flight controller sets {baud} baud, and the port does not follow ({error}): it stays at {}",
                port.now()
            ),
        })
    }

    /// What is known of it now; what changes is told to whoever has the other end.
    pub(super) fn tell(&mut self) -> (Peer, Receiver<Peer>) {
        let (news, other_end) = channel();
        let peer = self.peer();
        self.news = Some((peer, news));
        (peer, other_end)
    }

    /// Tells what has changed.
    pub(super) fn pass_on(&mut self) {
        let peer = self.peer();
        if let Some((told, news)) = self.news.as_mut().filter(|(told, _)| *told != peer) {
            *told = peer;
            // Who makes no packets any more need not know.
            let _ = news.send(peer);
        }
    }

    /// Counts the packets that it has taken.
    pub(super) fn counter(&self) -> Arc<AtomicU64> {
        self.took.clone()
    }

    /// Gives the link away to the pacing thread; `bridged` where somebody else may want to send beside the stream.
    pub(super) fn lane(&mut self, output: &Output, bridged: bool) -> Lane {
        let (sender, replies) = self.way.hand_over();
        let mut lane = Lane::new(sender, output.overload);
        lane.replies = (self.dialogue.is_some() || bridged).then_some(replies);
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

    /// Replies that the link took before it was given away.
    pub(super) fn replies(&self) -> u64 {
        self.way.written()
    }

    /// What came, for whoever waited in vain.
    pub(super) fn what_came(&self) -> String {
        let Side { protocol, bytes, messages, .. } = self;
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
}
