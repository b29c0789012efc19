//! What the producer thread does: it plays the plan, has packets made of it, and keeps the ring full.

use super::feed::Feed;
use super::{Item, Shared};
use crate::motion::Truth;
use crate::player::{BLOCK, Moment, Player};
use crate::scene::Plan;
use crate::time::SimTime;
use rtrb::{Producer, PushError};
use std::sync::atomic::Ordering;
use std::time::Duration;

/// How long to wait when the ring is full: far less than it holds.
const FULL: Duration = Duration::from_micros(200);
/// How far ahead of what is sent the rest is made, ns of stream time: so soon the scene can begin once it may. Where a
/// controller may ask for another rate the scene is made no further ahead either.
const LEAD: i64 = 200_000_000;
/// Between two looks at how far what is sent has come: far less than the lead.
const AHEAD: Duration = Duration::from_millis(1);
/// The rest is made in blocks of so few ticks that little is computed in vain at its end.
const REST_BLOCK: usize = 32;

/// What is to be played.
#[derive(Clone, Copy, Debug)]
pub(super) struct Task<'a> {
    pub plan: &'a Plan,
    /// Scene time at which it ends.
    pub end: SimTime,
    /// How long the vehicle is held still before the scene at the least; `None` begins with the scene.
    pub rest: Option<SimTime>,
}

/// Everything stopped before the end.
struct Stopped;

/// Plays the task into the ring; gives back the feeds, which know what was made and how to take leave.
pub(super) fn produce(task: Task<'_>, feeds: Vec<Feed>, ring: Producer<Item>, shared: &Shared) -> Vec<Feed> {
    let follows = feeds.iter().any(Feed::follows);
    let mut maker = Maker { feeds, follows, items: Vec::new(), start: SimTime::ZERO, ring, shared };
    // Stopping early is no failure: what was made is counted either way.
    let _ = maker.play(task);
    maker.end();
    shared.all_made.store(true, Ordering::Release);
    maker.feeds
}

struct Maker<'a> {
    /// One an output.
    feeds: Vec<Feed>,
    /// Whether one makes what is asked for meanwhile, so that the scene too is made little ahead.
    follows: bool,
    /// What was made last.
    items: Vec<Item>,
    /// Stream time at which what is played began.
    start: SimTime,
    ring: Producer<Item>,
    shared: &'a Shared,
}

impl Maker<'_> {
    fn play(&mut self, Task { plan, end, rest }: Task<'_>) -> Result<(), Stopped> {
        if let Some(rest) = rest {
            self.start = self.hold_still(plan, rest)?;
            self.shared.scene_starts_ns.store(self.start.0, Ordering::Release);
        }
        self.feeds.iter_mut().for_each(|feed| feed.scene_starts(self.start));
        Player::new(plan, end, BLOCK).play(|moment| self.make(moment))
    }

    /// The vehicle at rest for at least so long and until everybody is ready; gives back the stream time at which the
    /// scene begins.
    fn hold_still(&mut self, plan: &Plan, rest: SimTime) -> Result<SimTime, Stopped> {
        /// The rest is over: the scene begins then.
        enum Over {
            At(SimTime),
            Stopped,
        }
        let (at_rest, seam) = (plan.at_rest(), plan.seam());
        let mut next = SimTime((rest.0.max(0) + seam.0 - 1) / seam.0 * seam.0);
        let over = Player::new(&at_rest, SimTime::FOREVER, REST_BLOCK).play(|moment| {
            while moment.t >= next {
                if self.shared.ready.load(Ordering::Relaxed) {
                    return Err(Over::At(next));
                }
                next = next + seam;
            }
            self.wait_for_lead(moment.t).map_err(|Stopped| Over::Stopped)?;
            self.make(moment).map_err(|Stopped| Over::Stopped)
        });
        match over {
            Err(Over::At(start)) => Ok(start),
            _ => Err(Stopped),
        }
    }

    /// Waits until what is sent has come near to `t`, or nothing is left to send.
    fn wait_for_lead(&self, t: SimTime) -> Result<(), Stopped> {
        let far = || t.0 - self.shared.stream_ns.load(Ordering::Relaxed) > LEAD;
        while far() && self.ring.slots() < self.ring.buffer().capacity() {
            if self.shared.stopped() {
                return Err(Stopped);
            }
            std::thread::sleep(AHEAD);
        }
        Ok(())
    }

    fn make(&mut self, Moment { t, truth, readings }: Moment<'_>) -> Result<(), Stopped> {
        if self.shared.stopped() {
            return Err(Stopped);
        }
        let t = self.start + t;
        if self.follows {
            self.wait_for_lead(t)?;
        }
        let moment = Moment { t, truth: &Truth { t, ..*truth }, readings };
        let sent = self.shared.sent();
        for (lane, feed) in self.feeds.iter_mut().enumerate() {
            self.items.extend(feed.make(&moment, sent).iter().map(|&packet| Item { lane, packet }));
        }
        self.hand_over();
        Ok(())
    }

    /// What faults still hold goes out.
    fn end(&mut self) {
        for (lane, feed) in self.feeds.iter_mut().enumerate() {
            self.items.extend(feed.end().iter().map(|&packet| Item { lane, packet }));
        }
        self.hand_over();
    }

    fn hand_over(&mut self) {
        if self.feeds.len() > 1 || self.feeds.iter().any(Feed::is_faulty) {
            // A packet due between two ticks of one output must not wait behind a later one of another.
            self.items.sort_by_key(|item| item.packet.due);
        }
        self.items.drain(..).for_each(|item| push(&mut self.ring, item, self.shared));
    }
}

/// Waits for room; once everything stops, a packet more than fits is put in the place of waiting for ever: the
/// ring is then emptied by whoever counts what was left.
fn push(ring: &mut Producer<Item>, mut item: Item, shared: &Shared) {
    while let Err(PushError::Full(back)) = ring.push(item) {
        item = back;
        if shared.stopped() && ring.is_abandoned() {
            return;
        }
        std::thread::sleep(FULL);
    }
}
