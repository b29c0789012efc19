//! The conversation with one other side: who it is, what it sent, and how it gets replies.

use super::answers::Answers;
use super::lane::Lane;
use super::off::Off;
use super::replies::Way;
use super::settling::Settling;
use super::step::{Step, in_lockstep};
use super::tally::Tally;
use crate::geometry::Attitude;
use crate::link::{Baud, Sender};
use crate::report::AnswersReport;
use crate::scene::{Output, Tells};
use crate::score::{HeldAt, Timed};
use crate::time::{NANOS, SimTime};
use crate::wire::Protocol;
use crate::wire::dialogue::{Dialogue, Peer, Stage};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender as News, channel};

/// What is waited for on all links.
#[derive(Clone, Copy, Debug)]
pub(super) struct Waits {
    /// Whether wall time means anything.
    pub paced: bool,
    /// How long the vehicle rests at least before the scene.
    pub rest: Option<SimTime>,
}

/// One other side.
pub(super) struct Side {
    pub dialogue: Option<Box<dyn Dialogue>>,
    /// Its estimates, in order of arrival.
    pub estimates: Vec<Timed>,
    /// How many of them were told.
    told: usize,
    /// Bytes received, and the messages in them.
    pub bytes: u64,
    pub messages: u64,
    pub answers: Answers,
    /// As the user asked for it: `inav@/dev/ttyACM0`.
    pub to: String,
    /// The speed of its port, where it has one.
    pub baud: Option<Baud>,
    /// The speed that it asked for, until what was said before has gone out.
    next_baud: Option<u32>,
    /// To whom it is told what is known of it, once that changes.
    news: Option<(Peer, News<Peer>)>,
    protocol: Protocol,
    /// Whether a controller of its make answers while the scene is played.
    must_answer: bool,
    /// Whether nothing is sent to it.
    pub is_mute: bool,
    /// Whether it can know its heading.
    has_heading: bool,
    lockstep: bool,
    /// Where the scene waits for its estimator.
    settling: Option<Settling>,
    /// Where it tells its attitude besides, and when it was greeted there last, ns.
    pub aside: Option<Sender>,
    greeted: Option<i64>,
    /// The newest notice that its dialogue gave.
    notice: Option<String>,
    /// Whether a silence means anything.
    timed: bool,
    /// The way out to its link.
    way: Way,
    /// Where it is spoken with, if not there: the pacing thread has no part in that.
    apart: Option<Way>,
    /// In lockstep: the number of packets it has read.
    took: Arc<AtomicU64>,
}

impl Side {
    /// The other side of an output; `sender` is the way to its link, `apart` the way to where it answers, if not there.
    /// `waits` says what is waited for.
    pub(super) fn new(output: &Output, sender: Sender, apart: Option<Sender>, waits: Waits) -> Side {
        let tells = output.to.target.map_or(Tells::Nothing, |target| target.tells);
        let Waits { paced, rest } = waits;
        let overheard = output.to.overheard();
        let dialogue = || output.to.protocol.dialogue(output.wire.controller);
        Side {
            dialogue: output.to.is_spoken_with().then(dialogue).flatten(),
            estimates: Vec::new(),
            told: 0,
            bytes: 0,
            messages: 0,
            answers: Answers::default(),
            to: output.to.to_string(),
            must_answer: tells != Tells::Nothing,
            is_mute: output.wire.is_mute,
            has_heading: output.to.target.is_none_or(|target| target.has_heading),
            lockstep: in_lockstep(output),
            settling: rest
                .filter(|_| paced && tells == Tells::Attitude || overheard.is_some())
                .map(Settling::new),
            aside: None,
            greeted: None,
            notice: None,
            timed: paced || in_lockstep(output),
            baud: None,
            next_baud: None,
            news: None,
            protocol: output.to.protocol,
            way: Way::Link(sender, 0),
            apart: apart.map(|sender| Way::Link(sender, 0)),
            took: Arc::default(),
        }
    }

    /// Sends a reply. A lost reply does no harm: the other side repeats its request.
    pub(super) fn reply(&mut self, bytes: &[u8]) {
        let _ = self.apart.as_mut().unwrap_or(&mut self.way).reply(bytes);
    }

    /// Sends a packet on its link, as long as the stream has not begun.
    pub(super) fn send_ahead(&mut self, bytes: &[u8]) {
        if let Way::Link(..) = self.way {
            let _ = self.way.reply(bytes);
        }
    }

    /// Counts another packet as read.
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

    /// Counts an answer that came at `now`, ns, at that scene time: an acknowledgement, or an estimate. In lockstep only
    /// acknowledgements count. Returns a notice.
    pub(super) fn answered(&mut self, acknowledges: bool, now: i64, t: Option<SimTime>) -> Option<String> {
        let counts = acknowledges == self.lockstep;
        counts.then(|| self.answers.take(now, t)).flatten()
    }

    /// Looks at `now`, ns, whether answers stay away. Returns a notice.
    pub(super) fn look(&mut self, now: i64) -> Option<String> {
        self.timed.then(|| self.answers.look(now)).flatten()
    }

    /// What came back during the scene, given what went out; `None` of an other side that does not answer.
    pub(super) fn report(&self, tally: &Tally) -> Option<AnswersReport> {
        let (span, end) = tally.scene();
        let each = self.lockstep || self.dialogue.as_ref().is_some_and(|it| it.answers_every_packet());
        let mut report = self.answers.report(Some(tally.asked).filter(|_| each), span, end)?;
        report.stopped_at_s = report.stopped_at_s.filter(|_| self.timed);
        (self.must_answer || report.received > 0).then_some(report)
    }

    /// The counter of packets that it has read.
    pub(super) fn counter(&self) -> Arc<AtomicU64> {
        self.took.clone()
    }

    /// Gives the link to the pacing thread; `bridged` where a ground station may also send beside the stream.
    pub(super) fn lane(&mut self, output: &Output, bridged: bool) -> Lane {
        let (sender, replies) = self.way.hand_over();
        let mut lane = Lane::new(sender, output.overload);
        let spoken_with = self.dialogue.is_some() && self.apart.is_none();
        lane.replies = (spoken_with || bridged).then_some(replies);
        lane.step = in_lockstep(output).then(|| Step::new(self.counter()));
        lane
    }

    /// The stage of the conversation.
    pub(super) fn stage(&self) -> Stage {
        // Whoever only tells its attitude is not waited for.
        if self.is_mute {
            return Stage::Ready;
        }
        let stage = self.dialogue.as_ref().map_or(Stage::Ready, |dialogue| dialogue.stage());
        match &self.settling {
            Some(settling) if !settling.is_settled() => stage.min(Stage::Still),
            _ => stage,
        }
    }

    /// The estimates that were not told yet, each with the scene time at which it held, as far as known by now.
    pub(super) fn untold(&mut self) -> Vec<(SimTime, Attitude)> {
        let held = |it: &Timed| match it.stamp {
            HeldAt::Sample(t) => t,
            HeldAt::Own(_) | HeldAt::Arrival => it.arrival,
        };
        let told = std::mem::replace(&mut self.told, self.estimates.len());
        self.estimates[told..].iter().map(|it| (held(it), it.attitude)).collect()
    }

    /// Takes an estimate of the vehicle at rest that is `off` by so much. Returns a notice.
    pub(super) fn rests(&mut self, off: Off, now: i64) -> Option<String> {
        // Without a source of heading any will do.
        let off = if self.has_heading { off.total_deg } else { libm::hypot(off.roll_deg, off.pitch_deg) };
        self.settling.as_mut()?.take(off, now)
    }

    /// Greets it where it tells its attitude besides, once a second: some say little to whom they do not hear.
    pub(super) fn greet_aside(&mut self, now: i64) {
        if self.greeted.is_some_and(|at| now - at < NANOS) {
            return;
        }
        let seq = self.greeted.map_or(0, |at| (at / NANOS) as u8);
        self.greeted = Some(now);
        if let Some(aside) = &mut self.aside {
            // If it is lost, the next one follows.
            let _ = aside.send(&self.protocol.greeting(seq));
        }
    }

    /// It took a packet at `now`, ns.
    pub(super) fn fed(&mut self, now: i64) {
        self.settling.iter_mut().for_each(|settling| settling.feed(now));
    }

    /// Gives up on an estimator that is not heard. Returns a notice.
    pub(super) fn settle_unheard(&mut self, now: i64) -> Option<String> {
        self.settling.as_mut()?.give_up(now)
    }

    /// Keeps a notice of its dialogue: it may be why it never becomes ready.
    pub(super) fn keep(&mut self, notice: &str) {
        self.notice = Some(notice.into());
    }

    /// Why it is not ready, as far as that is known.
    pub(super) fn why_not_ready(&self) -> String {
        let settling = self.settling.as_ref().and_then(Settling::why_not);
        let causes: Vec<_> = settling.into_iter().chain(self.notice.clone()).collect();
        if causes.is_empty() { self.what_came() } else { causes.join("; ") }
    }

    /// What is known of the other side.
    pub(super) fn peer(&self) -> Peer {
        self.dialogue.as_ref().map_or(Peer::default(), |dialogue| dialogue.peer())
    }

    /// Damaged packets received.
    pub(super) fn damaged(&self) -> u64 {
        self.dialogue.as_ref().map_or(0, |dialogue| dialogue.damaged())
    }

    /// The number of replies that the link took before it was given away, and of all that went where it answers apart.
    pub(super) fn replies(&self) -> u64 {
        self.way.written() + self.apart.as_ref().map_or(0, Way::written)
    }

    /// A summary of what arrived, for the message after a timeout.
    pub(super) fn what_came(&self) -> String {
        let Side { bytes, messages, .. } = self;
        let protocol = self.protocol.name();
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
