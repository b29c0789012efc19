//! The producer thread: plays the plan, turns it into packets, and keeps the ring full.

use super::Shared;
use super::feed::Feed;
use super::ring::Inlet;
use crate::motion::Truth;
use crate::player::{BLOCK, Moment, Player};
use crate::scene::Plan;
use crate::time::SimTime;
use crate::wire::Packet;
use std::sync::atomic::Ordering;
use std::time::Duration;

/// Wait when the ring is full: far shorter than its contents last.
const FULL: Duration = Duration::from_micros(200);
/// How far ahead of what is sent the rest is made, ns of stream time: so soon the scene can begin once it may. Where a
/// controller may ask for another rate the scene is made no further ahead either.
const LEAD: i64 = 200_000_000;
/// Time between two looks at the progress of sending: far less than the lead.
const AHEAD: Duration = Duration::from_millis(1);
/// The rest is made in blocks of few ticks, so that little is computed in vain at its end.
const REST_BLOCK: usize = 32;

/// What to play.
#[derive(Clone, Copy, Debug)]
pub(super) struct Task<'a> {
    pub plan: &'a Plan,
    /// Scene time at which it ends.
    pub end: SimTime,
    /// The shortest time to hold the vehicle still before the scene; `None` begins with the scene.
    pub rest: Option<SimTime>,
}

/// Everything stopped before the end.
struct Stopped;

/// Plays the task into the ring. Returns the feeds, which know what was made and hold the farewell.
pub(super) fn produce(task: Task<'_>, feeds: Vec<Feed>, ring: Inlet, shared: &Shared) -> Vec<Feed> {
    let follows = feeds.iter().any(Feed::follows);
    // A packet due between two ticks of one output must not wait behind a later one of another output.
    let mixed = feeds.len() > 1 || feeds.iter().any(Feed::is_faulty);
    let mut maker = Maker { feeds, follows, mixed, sorted: Vec::new(), start: SimTime::ZERO, ring, shared };
    // Stopping early is no failure: what was made is counted either way.
    let _ = maker.play(task);
    maker.end();
    shared.all_made.store(true, Ordering::Release);
    maker.feeds
}

struct Maker<'a> {
    /// One for each output.
    feeds: Vec<Feed>,
    /// Whether one makes what is asked for meanwhile, so that the scene too is made little ahead.
    follows: bool,
    /// Whether packets may be made in another order than that in which they are due.
    mixed: bool,
    /// Those made last, with the output of each, by their due times.
    sorted: Vec<(usize, Packet)>,
    /// Stream time at which the present part began.
    start: SimTime,
    ring: Inlet,
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

    /// Holds the vehicle at rest for at least `rest` and until every side is ready. Returns the stream time at
    /// which the scene begins.
    fn hold_still(&mut self, plan: &Plan, rest: SimTime) -> Result<SimTime, Stopped> {
        /// The rest is over: the scene begins at this stream time.
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

    /// Waits until sending comes close to `t`, or nothing is left to send.
    fn wait_for_lead(&self, t: SimTime) -> Result<(), Stopped> {
        let far = || t.0 - self.shared.stream_ns.load(Ordering::Relaxed) > LEAD;
        while far() && !self.ring.is_empty() {
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
        let truth = &Truth { t, ..*truth };
        self.hand_over(|feed, sent| feed.make(&Moment { t, truth, readings }, sent));
        Ok(())
    }

    /// Releases what faults still hold.
    fn end(&mut self) {
        self.hand_over(|feed, _| feed.end());
    }

    /// Passes on what each feed makes, given what has gone out.
    fn hand_over(&mut self, make: impl Fn(&mut Feed, SimTime) -> &[Packet]) {
        let (sent, ring, shared) = (self.shared.sent(), &mut self.ring, self.shared);
        for (lane, feed) in self.feeds.iter_mut().enumerate() {
            let packets = make(feed, sent);
            match self.mixed {
                true => self.sorted.extend(packets.iter().map(|packet| (lane, *packet))),
                false => packets.iter().for_each(|packet| push(ring, lane, packet, shared)),
            }
        }
        self.sorted.sort_by_key(|(_, packet)| packet.due);
        self.sorted.drain(..).for_each(|(lane, packet)| push(ring, lane, &packet, shared));
    }
}

/// Waits for room in the ring. After a stop, whoever counts what is left empties the ring; once nobody holds the
/// ring any more, the packet is dropped.
fn push(ring: &mut Inlet, lane: usize, packet: &Packet, shared: &Shared) {
    while ring.push(lane, packet).is_err() {
        if shared.stopped() && ring.is_abandoned() {
            return;
        }
        std::thread::sleep(FULL);
    }
}
