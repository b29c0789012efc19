//! The one thread that shows things: ten times a second it takes what has happened and tells whoever looks on.

use super::Scene;
use super::batch::Batch;
use super::board::{Board, Mail};
use super::door::Door;
use super::hub::Hub;
use super::reel::{Reel, gather, values};
use super::server::serve;
use super::status;
use super::story::Story;
use crate::session::Record;
use crate::time::{NANOS, SimTime};
use rtrb::Consumer;
use std::collections::VecDeque;
use std::rc::Rc;
use std::sync::Arc;
use std::time::Duration;
use tokio::net::TcpListener;
use tokio::runtime::Runtime;
use tokio::task::{LocalSet, spawn_local};
use tokio::time::{Instant, MissedTickBehavior, interval, sleep};

/// Between two looks at what has happened.
const TICK: Duration = Duration::from_millis(100);
/// How much of a tick the scene may be played for.
const BUDGET: Duration = Duration::from_millis(40);
/// In the end viewers have this long to take what waits for them.
const LEAVE: Duration = Duration::from_secs(1);
/// Ticks from one status to the next.
const STATUS: u64 = 10;
/// Records of a tick, at most.
const RECORDED: usize = 16_384;
/// Readings in a batch, at most: older ones are not sent to viewers that want each.
const BATCH: SimTime = SimTime(NANOS);

/// What the thread needs.
pub(super) struct Task {
    pub story: Story,
    pub scene: Option<Scene>,
    pub board: Arc<Board>,
    pub runtime: Runtime,
    /// Where viewers come, if they may, and what tells this run from others.
    pub listening: Option<(TcpListener, Door, String)>,
    /// Whether the readings of the whole run are wanted in the end.
    pub keeps: bool,
}

/// Shows what happens until the end has been put on the board; then everything.
pub(super) fn run(task: Task) -> Story {
    let Task { story, scene, board, runtime, listening, keeps } = task;
    let (plan, records) = scene.map_or((None, None), |scene| (Some((scene.plan, scene.end)), scene.records));
    let reel = plan.as_ref().map(|(plan, end)| Reel::new(plan, *end, Vec::new()));
    let show = Show { story, reel, records, recorded: VecDeque::new(), ticks: 0, board, keeps };
    LocalSet::new().block_on(&runtime, show.go(listening))
}

struct Show<'a> {
    story: Story,
    reel: Option<Reel<'a>>,
    records: Option<Consumer<Record>>,
    recorded: VecDeque<Record>,
    ticks: u64,
    board: Arc<Board>,
    keeps: bool,
}

impl Show<'_> {
    async fn go(mut self, listening: Option<(TcpListener, Door, String)>) -> Story {
        let hub = listening.map(|(listener, door, session)| {
            let hub = Rc::new(Hub::new(&self.story.about, session));
            spawn_local(serve(listener, Rc::new(door), hub.clone()));
            hub
        });
        let mut ticks = interval(TICK);
        ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
        while self.story.end.is_none() {
            ticks.tick().await;
            let (mail, grows) = self.take();
            if let Some(hub) = &hub {
                if grows {
                    hub.renew(&self.story.about);
                }
                self.show(hub, mail);
            }
        }
        if let Some(hub) = &hub {
            hub.end(&self.story);
            let begun = Instant::now();
            while !hub.is_done() && begun.elapsed() < LEAVE {
                sleep(TICK / 10).await;
            }
        }
        self.complete();
        self.story
    }

    /// Takes in what has happened. True where there are sensors that were not there before.
    fn take(&mut self) -> (Mail, bool) {
        let mut mail = self.board.take();
        while let Some(record) = self.records.as_mut().and_then(|records| records.pop().ok()) {
            self.recorded.push_back(record);
        }
        match mail.starts {
            Some(starts) => self.recorded.drain(..).for_each(|record| self.story.record(record, starts)),
            // Of the rest before the scene nothing is shown; that the scene has begun is known a tick later.
            None => drop(self.recorded.drain(..self.recorded.len().saturating_sub(RECORDED))),
        }
        for (sensor, setting) in &mail.settings {
            if let Some(reel) = &mut self.reel
                && reel.set(*sensor, setting.clone())
            {
                self.story.forget_readings();
            }
        }
        let grows = self.story.take(&mut mail);
        (mail, grows)
    }

    /// Plays the scene up to now and tells whoever looks on. Nothing is played while nobody does.
    fn show(&mut self, hub: &Hub, mail: Mail) {
        if !hub.is_watched() {
            return self.story.skip_news();
        }
        let mut batch = Batch { estimates: mail.told, ..Batch::default() };
        let wanted = hub.has_subscribers();
        self.play(BUDGET, wanted.then_some(&mut batch));
        if wanted {
            mail.values.into_iter().for_each(|heard| batch.heard(heard));
        }
        hub.tell_pages(&mut self.story);
        self.ticks += 1;
        let asks = wanted && self.ticks.is_multiple_of(STATUS);
        let status = asks.then(|| status::of(&self.story));
        hub.tell_subscribers(self.story.t, &batch, status.as_deref());
    }

    /// Plays the scene up to now, for at most so long; into a batch what is not older than a second.
    fn play(&mut self, budget: Duration, mut batch: Option<&mut Batch>) {
        let (Some(reel), Some(now)) = (&mut self.reel, self.story.t) else { return };
        let axes = self.story.about.axes;
        let story = &mut self.story;
        reel.play(now, budget, &mut |moment| {
            for reading in moment.readings {
                let (values, truth) = values(axes, reading);
                story.reading(reading.sensor, moment.t, values.get(), truth.get());
            }
            if let Some(batch) = batch.as_deref_mut().filter(|_| now - moment.t <= BATCH) {
                gather(batch, axes, &moment);
            }
        });
    }

    /// Plays what is lacking, for those who look later.
    fn complete(&mut self) {
        if self.keeps {
            self.play(Duration::MAX, None);
        }
    }
}

/// A whole scene as one batch.
#[cfg(test)]
pub(super) fn gathered(plan: &crate::scene::Plan) -> Batch {
    let mut batch = Batch::default();
    let mut reel = Reel::new(plan, plan.duration, Vec::new());
    reel.play(plan.duration, Duration::MAX, &mut |moment| gather(&mut batch, plan.axes, &moment));
    batch
}
