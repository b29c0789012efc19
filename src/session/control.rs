//! The control side of a run: opens links, starts the threads, serves the user and the other sides, and ends
//! cleanly.

use super::absence::Absence;
use super::account::Account;
use super::command::Program;
use super::ears::Ears;
use super::feed::Feed;
use super::granted::Granted;
use super::heard::Heard;
use super::hold::Hold;
use super::lane::Lane;
use super::open::{BEAT, OpenOutput};
use super::outside::Outside;
use super::pace::Pace;
use super::pacer::Pacer;
use super::pacing::{LivePacer, Pacing};
use super::producing::Producing;
use super::shared::{LaneCounts, TICK};
use super::side::{Side, Waits};
use super::talk::Talk;
use super::watch::Watching;
use super::{Event, Job, LinkProgress, Outcome, Progress, SessionError, Shared, Speed, budget, ring, step};
use crate::clock::{Clock, Policy, Precise, WallClock};
use crate::link::Link;
use crate::motion::Truth;
use crate::report::LinkReport;
use crate::scene::{Output, Overload};
use crate::time::SimTime;
use crate::wire::Protocol;
use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;
use tokio::time::{Instant, interval, sleep};

/// Packets made ahead, 2.6 MB: about a second of the fastest sensors, and seven at 1 kHz.
const RING: usize = 8192;
/// Time between two progress reports.
const PROGRESS: Duration = Duration::from_millis(100);
/// Time between two looks at the links.
const LOOK: Duration = Duration::from_millis(20);
/// Time for answers that are still on their way when the last packet is sent.
pub(super) const LAST_ANSWERS: Duration = Duration::from_millis(200);
/// A link that does not take a farewell within this time does not get it.
const FAREWELL: Duration = Duration::from_secs(1);

pub(super) struct Control {
    pub(super) job: Job,
    pub(super) shared: Arc<Shared>,
    pub(super) clock: WallClock,
    pub(super) outputs: Vec<OpenOutput>,
    pub(super) talk: Rc<RefCell<Talk>>,
    pub(super) ears: Ears,
    hold: Hold,
    /// What the lanes publish of their counts, once they are at work.
    counts: Vec<Arc<LaneCounts>>,
    /// Set where nothing moves without a reader and nothing else ends the run.
    absence: Option<Absence>,
    /// Why the run ended before the scene began.
    failed: Option<SessionError>,
}

impl Control {
    /// Opens every link.
    pub(super) async fn ready(
        job: Job,
        absence: Duration,
        outside: &mut Outside<'_>,
    ) -> Result<Control, SessionError> {
        let mut control = Control::open(job, absence).await?;
        control.open_ground(outside).await?;
        control.outputs.iter().for_each(|output| output.introduce(outside));
        Ok(control)
    }

    /// Streams to the end.
    pub(super) async fn go(self, mut outside: Outside<'_>) -> Result<Outcome, SessionError> {
        let mut control = self;
        let (inlet, outlet) = ring::ring(RING);
        let mut producing = Producing::NotYet(inlet);
        // Packets that do not depend on the other side's answers are made during the wait.
        if control.talk.borrow().silent().is_none() {
            producing = control.start(producing);
        }
        let Job { command, keep_stdout, .. } = &control.job;
        outside.program = Program::start(command, control.outputs[0].name(), *keep_stdout)?;
        let here = match control.wait(&mut outside).await {
            Ok(true) => control.afford_asked(&mut outside).map(|()| true),
            here => here,
        };
        if !matches!(here, Ok(true)) {
            control.shared.stop.store(true, Ordering::Relaxed);
            drop(outlet);
            producing.abandon();
            control.talk.borrow_mut().leave();
            here?;
            return Ok(control.never_started(&outside));
        }
        control.compare_rates(&mut outside);
        let producing = control.start(producing);
        outside.tell(if control.job.rest.is_some() { Event::Still } else { Event::Started });
        let pacer = control.pacer(outlet);
        let mut pacing = Pacing::start(pacer, control.job.cpu)?;
        control.talk.borrow_mut().pacing = Some(pacing.thread());
        control.attend(&mut pacing, &mut outside).await;
        let (mut pacer, granted) = pacing.join();
        let feeds = producing.collect(&mut pacer);
        control.finish(outside, pacer, granted, feeds).await
    }

    async fn open(job: Job, absence: Duration) -> Result<Control, SessionError> {
        let mut outputs = Vec::new();
        // A bus has a thread of its own, which opens its link.
        for output in job.outputs.iter().filter(|output| output.to.protocol != Protocol::Bus) {
            outputs.push(OpenOutput::open(output, job.ground.is_some()).await?);
        }
        let waits = Waits { paced: job.speed.is_paced(), rest: job.rest };
        let sides = outputs.iter_mut().map(|it| {
            let baud = it.link.baud();
            let apart = it.answers.as_mut().map(Link::sender);
            let mut side = Side::new(&it.output, it.link.sender(), apart, waits);
            side.baud = baud;
            side.aside = it.aside.as_mut().and_then(|aside| aside.as_mut().ok()).map(Link::sender);
            side
        });
        let sides = sides.collect();
        let shared = Arc::new(Shared::before(job.rest));
        let lockstep = job.outputs.iter().any(step::in_lockstep);
        let heard = Heard::new(job.plan.clone(), shared.clone(), job.speed, lockstep);
        // A paced run drops and counts a packet that nobody reads, and a command ends the run when it ends.
        let waits = !job.speed.is_paced() && job.command.is_empty();
        Ok(Control {
            shared,
            clock: job.watch.as_ref().map_or_else(WallClock::start, |watch| watch.clock),
            outputs,
            talk: Rc::new(RefCell::new(Talk::new(sides, heard))),
            ears: Ears::default(),
            hold: Hold::new(job.rest),
            counts: Vec::new(),
            absence: waits.then(|| Absence::new(absence)),
            failed: None,
            job,
        })
    }

    /// Opens the link to a ground station, and listens to it.
    async fn open_ground(&mut self, outside: &mut Outside<'_>) -> Result<(), SessionError> {
        let Some((address, output)) = &self.job.ground else { return Ok(()) };
        let mut link = Link::open(address).await?;
        self.talk.borrow_mut().bridge(link.sender(), *output);
        outside.tell(Event::Ground(link.name()));
        if let Some(receiver) = link.receiver() {
            self.ears.listen_to_ground(receiver, &self.talk);
        }
        Ok(())
    }

    /// Starts the producer thread if it has not started.
    fn start(&self, producing: Producing) -> Producing {
        let mut talk = self.talk.borrow_mut();
        let peers = talk.sides.iter_mut().zip(&self.outputs).map(|(side, output)| {
            let (peer, news) = side.tell();
            (peer, Some(news).filter(|_| output.speaks))
        });
        producing.start(&self.job, &self.shared, peers)
    }

    /// True when every link has somebody and every other side accepts samples; false when the user or the command
    /// ended the wait.
    async fn wait(&mut self, outside: &mut Outside<'_>) -> Result<bool, SessionError> {
        let waited = self.job.wait;
        let deadline = Instant::now() + waited;
        let sends = |output: &&mut OpenOutput| !waited.is_zero() && !output.output.wire.is_mute;
        for output in self.outputs.iter_mut().filter(sends) {
            if !output.wait_for_reader(waited, deadline, outside).await? {
                return Ok(false);
            }
        }
        self.listen();
        self.wait_to_be_heard(outside).await
    }

    /// Hears what comes back.
    pub(super) fn listen(&mut self) {
        for (i, output) in self.outputs.iter_mut().enumerate() {
            if let Some(Ok(aside)) = &mut output.aside
                && let Some(receiver) = aside.receiver()
            {
                self.ears.overhear(i, receiver, &self.talk, self.clock);
            }
            let Some(receiver) = output.receiver() else { continue };
            match self.job.tap.take_if(|_| i == 0) {
                Some(tap) => self.ears.tap(receiver, tap),
                None => self.ears.listen(i, receiver, &self.talk, self.clock),
            }
        }
    }

    /// True when every other side accepts samples; false when the user or the command ended the wait.
    async fn wait_to_be_heard(&mut self, outside: &mut Outside<'_>) -> Result<bool, SessionError> {
        let waited = self.job.wait;
        let deadline = Instant::now() + waited;
        let mut ticks = interval(TICK);
        let mut told: Option<Instant> = None;
        loop {
            self.tick(outside);
            let Some(silent) = self.talk.borrow().silent().filter(|_| !waited.is_zero()) else {
                return Ok(true);
            };
            let name = self.outputs[silent].name();
            if Instant::now() >= deadline {
                let came = self.talk.borrow().sides[silent].what_came();
                return Err(SessionError::Unheard { link: name.to_string(), waited, came });
            }
            if told.is_none_or(|told| told.elapsed() >= BEAT) {
                told = Some(Instant::now());
                let whom = format!("the controller on {name} to speak");
                outside.tell(Event::Waiting { whom: &whom, left: deadline - Instant::now() });
            }
            tokio::select! {
                _ = ticks.tick() => {}
                () = outside.ends() => return Ok(false),
            }
        }
    }

    /// Rejects a controller that asks for more packets than its link carries, unless that is forced.
    ///
    /// # Errors
    /// What does not fit, and what would.
    fn afford_asked(&self, outside: &mut Outside<'_>) -> Result<(), SessionError> {
        let Speed::Times(speed) = self.job.speed else { return Ok(()) };
        let talk = self.talk.borrow();
        for (output, side) in self.outputs.iter().map(|it| &it.output).zip(&talk.sides) {
            let over = budget::afford_asked(&self.job.plan, output, speed, side.peer());
            match over.filter(|_| output.overload != Overload::Stretch) {
                None => {}
                Some(over) if output.force => outside.notice(format!("{over}; the rest is lost")),
                Some(over) => return Err(SessionError::TooSlow(over)),
            }
        }
        Ok(())
    }

    /// Reports a controller for higher rates than the scene has.
    fn compare_rates(&self, outside: &mut Outside<'_>) {
        let sensors = self.job.plan.sensors.iter();
        let Some(fastest) = sensors.max_by(|a, b| a.rate.as_hz().total_cmp(&b.rate.as_hz())) else { return };
        let talk = self.talk.borrow();
        let asked = talk.sides.iter().filter_map(|side| side.peer().rate);
        for rate in asked.filter(|rate| rate.as_hz() > fastest.rate.as_hz()) {
            outside.notice(format!(
                "the controller asks for {rate}, and the scene's fastest sensor, {}, has {}: --set {}.rate='{rate}' gives it all",
                fastest.kind, fastest.rate, fastest.kind
            ));
        }
    }

    /// The pacing thread's work, with the links.
    fn pacer(&mut self, ring: ring::Outlet) -> LivePacer {
        let mut pace =
            Pace::new(Precise::new(self.clock, Policy::Adaptive), self.job.speed, self.shared.clone());
        pace.watching = self.job.watch.take().map(Watching::new);
        let mut talk = self.talk.borrow_mut();
        let lanes = self.outputs.iter().enumerate().map(|(i, it)| talk.lane(i, &it.output));
        let lanes: Vec<_> = lanes.collect();
        self.counts = lanes.iter().map(|lane| lane.counts.clone()).collect();
        Pacer::new(pace, ring, lanes)
    }

    /// Reports progress until the pacing thread ends, or until the user, the command or a departed reader ends it.
    async fn attend(&mut self, pacing: &mut Pacing, outside: &mut Outside<'_>) {
        if let Some(refused) = pacing.refused().await {
            outside.notice(refused);
        }
        let (mut beats, mut looks, mut ticks) = (interval(TICK), interval(LOOK), interval(PROGRESS));
        loop {
            tokio::select! {
                () = pacing.over() => break,
                _ = beats.tick() => {
                    self.tick(outside);
                    self.look_on(outside);
                }
                _ = looks.tick() => self.outputs.iter_mut().for_each(|output| output.look(outside)),
                _ = ticks.tick() => {
                    let progress = self.progress();
                    if let Some(absence) = &mut self.absence
                        && absence.look(progress.packets, &mut self.outputs)
                    {
                        self.shared.stop.store(true, Ordering::Relaxed);
                    }
                    outside.tell(Event::Progress(progress));
                    self.tell_more(outside);
                }
                () = outside.ends() => self.shared.stop.store(true, Ordering::Relaxed),
            }
        }
        self.outputs.iter_mut().for_each(|output| output.look(outside));
        outside.tell(Event::Progress(self.progress()));
        self.tell_more(outside);
    }

    /// Tells each link's counts and the attitudes that came back.
    pub(super) fn tell_more(&self, outside: &mut Outside<'_>) {
        let links = self.links_so_far();
        outside.tell(Event::Links(&links));
        let count = self.outputs.len();
        for i in 0..count {
            let untold = self.talk.borrow_mut().sides[i].untold();
            if !untold.is_empty() {
                outside.tell(Event::Estimates(self.place(i), &untold));
            }
        }
    }

    /// The index among the job's outputs of an output that is no bus.
    fn place(&self, i: usize) -> usize {
        let is_bus = |output: &Output| output.to.protocol == Protocol::Bus;
        let others = self.job.outputs.iter().enumerate().filter(|(_, output)| !is_bus(output));
        others.map(|(place, _)| place).nth(i).unwrap_or(i)
    }

    /// Each output's counts by now, in the job's order.
    fn links_so_far(&self) -> Vec<LinkProgress> {
        let none = LaneCounts::default();
        let mut open = self.outputs.iter().enumerate();
        let talk = self.talk.borrow();
        let progress = |output: &Output| {
            if output.to.protocol == Protocol::Bus {
                return LinkProgress::of(&self.shared.bus);
            }
            let Some((i, it)) = open.next() else { return LinkProgress::default() };
            let (side, counts) = (&talk.sides[i], self.counts.get(i));
            LinkProgress {
                unread: it.unread(),
                received: side.bytes,
                damaged: side.dialogue.is_some().then(|| side.damaged()),
                ..LinkProgress::of(counts.map_or(&none, |counts| counts))
            }
        };
        self.job.outputs.iter().map(progress).collect()
    }

    pub(super) fn progress(&self) -> Progress {
        let stream = self.shared.sent();
        let scene = self.shared.scene_time(stream);
        let at = scene.unwrap_or_default().min(self.job.end);
        Progress {
            truth: self.job.plan.trajectory.at(at).attitude,
            t: scene.unwrap_or(stream),
            stream,
            still: scene.is_none(),
            packets: self.shared.packets.get(),
            dropped: self.shared.dropped.get(),
            estimate: self.talk.borrow().heard.newest,
        }
    }

    /// Sends what the conversations have due, and passes on notices from the other sides.
    pub(super) fn tick(&self, outside: &mut Outside<'_>) {
        self.talk.borrow_mut().tick(self.clock.now());
        let notices = self.talk.borrow_mut().take_notices();
        notices.into_iter().for_each(|notice| outside.notice(notice));
    }

    /// Checks whether the scene may begin, has begun, or waited too long.
    fn look_on(&mut self, outside: &mut Outside<'_>) {
        let unready = {
            let talk = self.talk.borrow();
            talk.unready().map(|i| (self.outputs[i].name().to_string(), talk.sides[i].why_not_ready()))
        };
        match self.hold.look(&self.shared, unready, self.job.wait) {
            Ok(true) => outside.tell(Event::Started),
            Ok(false) => {}
            Err(error) => {
                self.failed.get_or_insert(error);
                self.shared.stop.store(true, Ordering::Relaxed);
            }
        }
        if let Some(notice) = self.hold.untaken(&self.shared) {
            outside.notice(notice);
        }
    }

    /// Lets the other side read what was sent, closes everything, and adds up the counts.
    async fn finish(
        mut self,
        outside: Outside<'_>,
        pacer: LivePacer,
        granted: Granted,
        mut feeds: Vec<Feed>,
    ) -> Result<Outcome, SessionError> {
        let Pacer { pace, mut lanes, .. } = pacer;
        self.take_leave(&mut lanes, &mut feeds).await;
        let (played, now) = (self.played(&lanes, &outside), self.clock.now());
        let accounts = lanes.into_iter().zip(feeds).map(|(lane, feed)| {
            let mut made = feed.made();
            made.settle(played + self.shared.rest());
            lane.account(made, now)
        });
        let accounts: Vec<_> = accounts.collect();
        if self.ears.tapped || self.talk.borrow().has_estimates() {
            sleep(LAST_ANSWERS).await;
        }
        self.ears.close().await;
        let mut outcome = self.outcome(&accounts);
        for output in self.outputs {
            output.close().await;
        }
        outcome.interrupted = outside.interrupted;
        outcome.command = outside.finish().await;
        if let Some(error) = self.failed {
            return Err(error);
        }
        let judgement = self.talk.borrow().judge(self.job.judging, played);
        Ok(Outcome {
            played,
            rest_s: self.shared.rest().seconds(),
            stretched_s: pace.stretched as f64 * 1e-9,
            realtime: granted.priority,
            memory_locked: granted.memory,
            pacing: pace.report(granted.cpu),
            watched: pace.watching.map(|watching| watching.seen),
            attitude: judgement.figures,
            estimates: judgement.estimates,
            ..outcome
        })
    }

    /// Sends every other side a stationary vehicle as farewell, and everything that is still kept.
    async fn take_leave(&self, lanes: &mut [Lane], feeds: &mut [Feed]) {
        let end = self.sent_last();
        let deadline = Instant::now() + FAREWELL;
        for (lane, feed) in lanes.iter_mut().zip(feeds) {
            lane.take_leave(feed.farewell(&end), deadline).await;
        }
        lanes.iter_mut().for_each(Lane::finish);
    }

    /// Where the vehicle was in the last packet sent, a nanosecond on. The producer is ahead of that by up to a ring.
    fn sent_last(&self) -> Truth {
        let sent = self.shared.sent();
        let t = self.shared.scene_time(sent).unwrap_or_default().min(self.job.end);
        Truth { t: sent + SimTime(1), ..self.job.plan.trajectory.at(t) }
    }

    /// The end of the scene if everything was played, else the due time of the last packet.
    fn played(&self, lanes: &[Lane], outside: &Outside<'_>) -> SimTime {
        let stopped = outside.has_ended() || self.outputs.iter().any(|output| output.abandoned);
        let cut_short = stopped || !lanes.iter().any(Lane::is_open);
        // An end is exclusive: add a nanosecond so that the last packet is within.
        let last = self.shared.scene_time(self.shared.sent()).map_or(SimTime::ZERO, |t| t + SimTime(1));
        if cut_short { last.min(self.job.end) } else { self.job.end }
    }

    /// Collects the outcome of the run from the accounts of its outputs.
    fn outcome(&self, accounts: &[Account]) -> Outcome {
        let (plan, paced) = (&self.job.plan, self.job.speed.is_paced());
        let talk = self.talk.borrow();
        let outputs = || self.outputs.iter().zip(accounts);
        let links = outputs().zip(&talk.sides);
        Outcome {
            speed: self.job.speed,
            sensors: plan.sensors.iter().map(|it| Account::sensor(accounts, it, paced)).collect(),
            links: links.map(|((output, account), side)| output.report(account, side)).collect(),
            faults: outputs().flat_map(|(it, account)| account.made.fired(&it.output)).collect(),
            ..Outcome::default()
        }
    }

    /// The reports of links on which nothing was sent.
    pub(super) fn silent_links(&self) -> Vec<LinkReport> {
        let talk = self.talk.borrow();
        let account = Account::default();
        self.outputs.iter().zip(&talk.sides).map(|(output, side)| output.report(&account, side)).collect()
    }

    fn never_started(&self, outside: &Outside<'_>) -> Outcome {
        let accounts: Vec<_> = self.outputs.iter().map(|_| Account::default()).collect();
        Outcome { interrupted: outside.interrupted, command: outside.ended, ..self.outcome(&accounts) }
    }
}
