//! The conversations of a run: what the other sides send, the replies, and the stage of each.
//!
//! It reads no clock and never waits: the control side passes in bytes and the time.

use super::heard::{Heard, Judgement, Judging};
use super::lane::Lane;
use super::side::Side;
use crate::link::Sender;
use crate::scene::Output;
use crate::time::SimTime;
use crate::wire::dialogue::{self, Dialogue, Said, Stage};
use std::thread::Thread;

/// The conversations on all links.
pub(super) struct Talk {
    /// One for each output.
    pub sides: Vec<Side>,
    pub heard: Heard,
    notices: Vec<String>,
    /// Whether the user has heard that estimates are not judged.
    told_untimed: bool,
    /// A ground station, and the link with the controller that it talks to.
    ground: Option<(Sender, usize)>,
    /// The thread that waits for an answer in lockstep.
    pub pacing: Option<Thread>,
}

impl Talk {
    pub(super) fn new(sides: Vec<Side>, heard: Heard) -> Talk {
        Talk { sides, heard, notices: Vec::new(), told_untimed: false, ground: None, pacing: None }
    }

    /// Forwards to a ground station what the controller on a link sends.
    pub(super) fn bridge(&mut self, sender: Sender, link: usize) {
        self.ground = Some((sender, link));
    }

    /// Processes bytes that arrived on a link at `now`, ns on the run's clock.
    pub(super) fn hear(&mut self, link: usize, bytes: &[u8], now: i64) {
        self.sides[link].bytes += bytes.len() as u64;
        self.converse(link, |dialogue, talk| {
            dialogue.hear(bytes, now, &mut |said| {
                talk.sides[link].messages += u64::from(!matches!(said, Said::Notice(_)));
                talk.said(link, said, now);
            });
        });
    }

    /// Processes what the other side of a link told elsewhere at `now`, ns on the run's clock.
    pub(super) fn overhear(&mut self, link: usize, bytes: &[u8], now: i64) {
        self.converse(link, |dialogue, talk| {
            dialogue.overhear(bytes, now, &mut |said| talk.said(link, said, now));
        });
        self.sides[link].greet_aside(now);
    }

    /// Sends what is due without a request.
    pub(super) fn tick(&mut self, now: i64) {
        for link in 0..self.sides.len() {
            self.converse(link, |dialogue, talk| dialogue.tick(now, &mut |said| talk.said(link, said, now)));
            let side = &mut self.sides[link];
            let notices = [side.look(now), side.settle_unheard(now)];
            self.notices.extend(notices.into_iter().flatten().map(|notice| format!("{}: {notice}", side.to)));
        }
    }

    /// The run ends before the stream began.
    pub(super) fn leave(&mut self) {
        for link in 0..self.sides.len() {
            self.converse(link, |dialogue, talk| dialogue.leave(&mut |said| talk.said(link, said, 0)));
        }
    }

    fn converse(&mut self, link: usize, with: impl FnOnce(&mut dyn Dialogue, &mut Talk)) {
        if let Some(mut dialogue) = self.sides[link].dialogue.take() {
            with(&mut *dialogue, self);
            let side = &mut self.sides[link];
            side.dialogue = Some(dialogue);
            side.pass_on();
            self.notices.extend(side.follow_speed());
        }
    }

    fn said(&mut self, link: usize, said: Said<'_>, now: i64) {
        let side = &mut self.sides[link];
        let answer = match &said {
            Said::Estimate(_) => side.answered(false, now, self.heard.scene_time(now)),
            Said::Took => side.answered(true, now, self.heard.scene_time(now)),
            _ => None,
        };
        self.notices.extend(answer.map(|notice| format!("{}: {notice}", side.to)));
        match said {
            Said::Estimate(estimate) if self.heard.is_timed(&estimate) => {
                if let Some(off) = self.heard.off_rest(&estimate, now) {
                    self.notices.extend(side.rests(off, now).map(|how| format!("{}: {how}", side.to)));
                }
                side.estimates.extend(self.heard.take_in(estimate, now));
            }
            Said::Estimate(_) => {
                if !std::mem::replace(&mut self.told_untimed, true) {
                    self.notices.push("attitudes come back that do not say which sample they rest on; at --speed max nothing else tells when they held, so they are not judged: leave --speed out".into());
                }
            }
            Said::Reply(bytes) => side.reply(bytes),
            Said::Ahead(bytes) => side.send_ahead(bytes),
            Said::Took => {
                side.took();
                side.fed(now);
                if let Some(pacing) = &self.pacing {
                    pacing.unpark();
                }
            }
            Said::Speed(baud) => side.change_speed(baud),
            Said::Notice(text) => {
                side.keep(&text);
                self.notices.push(text);
            }
            Said::Restart(text) => {
                side.answers.restarts += 1;
                self.notices.push(text);
            }
            Said::Pass(frame) => {
                if let Some((sender, _)) = self.ground.as_mut().filter(|(_, with)| *with == link) {
                    // A ground station that is absent or too slow misses it.
                    let _ = sender.send(frame);
                }
            }
        }
    }

    /// Forwards to the controller what the ground station sends.
    pub(super) fn pass_down(&mut self, datagram: &[u8]) {
        let Some(&(_, link)) = self.ground.as_ref() else { return };
        dialogue::frames(datagram).for_each(|frame| self.sides[link].reply(frame));
    }

    /// Gives a link to the pacing thread.
    pub(super) fn lane(&mut self, link: usize, output: &Output) -> Lane {
        let bridged = self.ground.as_ref().is_some_and(|(_, with)| *with == link);
        self.sides[link].lane(output, bridged)
    }

    /// The first link whose other side does not accept samples yet.
    pub(super) fn silent(&self) -> Option<usize> {
        self.sides.iter().position(|side| side.stage() == Stage::Silent)
    }

    /// The first link whose other side is not ready for the scene.
    pub(super) fn unready(&self) -> Option<usize> {
        self.sides.iter().position(|side| side.stage() < Stage::Ready)
    }

    /// Takes the notices that the user has not seen yet.
    pub(super) fn take_notices(&mut self) -> Vec<String> {
        std::mem::take(&mut self.notices)
    }

    /// Whether any estimate of the scene arrived.
    pub(super) fn has_estimates(&self) -> bool {
        self.sides.iter().any(|side| !side.estimates.is_empty())
    }

    /// Judges the estimates of the side on which an attitude is only heard, or else that sent most, for a scene that played up to `played`.
    pub(super) fn judge(&self, judging: Judging, played: SimTime) -> Judgement {
        let told = |side: &&Side| !side.estimates.is_empty();
        let sides = self.sides.iter().rev().filter(told);
        // Where an attitude is heard apart, that one is asked for.
        let most = sides.max_by_key(|side| (side.is_mute, side.estimates.len())).map(|side| &side.estimates);
        most.map_or_else(Judgement::default, |said| self.heard.judge(said, judging, played))
    }
}

#[cfg(test)]
impl Talk {
    /// Replaces the protocol's own dialogue on a link by this one.
    pub(super) fn script(&mut self, link: usize, dialogue: Box<dyn Dialogue>) {
        self.sides[link].dialogue = Some(dialogue);
    }

    /// When the newest estimate arrived, in scene time.
    pub(super) fn newest_arrival(&self) -> Option<SimTime> {
        self.sides.iter().filter_map(|side| Some(side.estimates.last()?.arrival)).max()
    }
}
