//! The serving thread: it waits for a driver's bytes and answers them at once.

use super::News;
use super::hints::Hints;
use super::served::Served;
use crate::bus::{Board, Change, fit};
use crate::clock::{Clock, WallClock};
use crate::link::{Link, Sender, Sent};
use crate::report::Times;
use crate::scene::{Output, Plan};
use crate::session::SessionError;
use crate::session::granted::Granted;
use crate::session::open::BEAT;
use crate::session::pace::Speed;
use crate::session::shared::Shared;
use crate::time::SimTime;
use bytes::BytesMut;
use ratetable_protocols::bridge::{Bridge, Counts};
use std::pin::pin;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread::JoinHandle;
use std::time::Duration;
use tokio::sync::mpsc::UnboundedSender;
use tokio::time::{Instant, MissedTickBehavior, interval};

/// Time after which the scene is played on although nobody asks.
const TICK: Duration = Duration::from_millis(1);
/// A reader that comes within this time is not worth a word.
const PATIENCE: Duration = Duration::from_millis(500);
/// After so long without a byte, ns, a command that was cut short is forgotten.
const PAUSE: i64 = 1_000_000_000;
/// Time between two looks at whether to stop while nobody has come.
const LOOK: Duration = Duration::from_millis(50);

/// What to serve.
pub(super) struct Task {
    pub plan: Arc<Plan>,
    pub output: Output,
    /// Scene time at which it ends.
    pub end: SimTime,
    /// How long the vehicle rests after a first sample is read.
    pub rest: SimTime,
    pub speed: Speed,
    pub wait: Duration,
    pub cpu: Option<usize>,
}

/// The running thread.
pub(super) struct Serving(JoinHandle<()>);

impl Serving {
    /// Starts it.
    pub(super) fn start(
        task: Task,
        shared: Arc<Shared>,
        clock: WallClock,
        news: UnboundedSender<News>,
    ) -> Result<Serving, SessionError> {
        let body = move || {
            let served = tokio::runtime::Builder::new_current_thread().enable_all().build();
            let served =
                served.map_err(|source| SessionError::System { doing: "start the serving loop", source });
            let served = served.and_then(|runtime| runtime.block_on(serve(&task, &shared, clock, &news)));
            // Who does not listen any more need not know.
            let _ = news.send(News::Over(Box::new(served)));
        };
        let thread = std::thread::Builder::new().name("bus".into()).spawn(body);
        let thread =
            thread.map_err(|source| SessionError::System { doing: "start the bus's thread", source })?;
        Ok(Serving(thread))
    }

    /// Waits for its end.
    pub(super) fn join(self) {
        self.0.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
    }
}

async fn serve(
    task: &Task,
    shared: &Shared,
    clock: WallClock,
    news: &UnboundedSender<News>,
) -> Result<Served, SessionError> {
    let tell = |new| _ = news.send(new);
    let mut link = Link::open(&task.output.to.address).await?;
    link.notices().iter().for_each(|notice| tell(News::Notice(notice.clone())));
    tell(News::Open(link.name().to_string()));
    let rest = task.plan.at_rest();
    let fitted = fit(&task.plan.sensors, task.output.wire.chip).map_err(SessionError::Bus)?;
    let chips: Vec<String> = fitted.iter().map(ToString::to_string).collect();
    tell(News::Notice(format!("on the bus: {}", chips.join(", "))));
    if !wait_for_driver(task, &mut link, shared, news).await? {
        let (to, name) = (task.output.to.to_string(), link.name().to_string());
        return Ok(Served { to, name, chips, ..Served::default() });
    }
    let granted = Granted::ask(task.cpu);
    granted.refused.iter().for_each(|refused| tell(News::Notice(refused.clone())));
    let board = Board::new(&task.plan, &rest, fitted, task.rest).map_err(SessionError::Bus)?;
    let speed = match task.speed {
        Speed::Times(times) => times,
        Speed::Max => 1.0,
    };
    let mut server = Server {
        board,
        bridge: Bridge::new(),
        sender: link.sender(),
        hints: Hints::default(),
        clock,
        start: clock.now(),
        speed,
        end: task.end,
        latency: Times::new(),
        bytes: 0,
        before: Counts::default(),
        answer: Vec::new(),
        shared,
        news,
    };
    shared.start_ns.store(server.start, Ordering::Relaxed);
    if task.wait.is_zero() {
        server.board.begin(SimTime::ZERO);
        server.begin();
    } else {
        tell(News::Still);
    }
    server.run(task, &mut link).await?;
    let served = server.end(task, chips, &link, granted);
    link.close().await;
    Ok(served)
}

/// True when somebody is on the link; false when the run was ended before.
async fn wait_for_driver(
    task: &Task,
    link: &mut Link,
    shared: &Shared,
    news: &UnboundedSender<News>,
) -> Result<bool, SessionError> {
    if task.wait.is_zero() {
        return Ok(true);
    }
    let (name, since) = (link.name().to_string(), Instant::now());
    let (mut peer, mut looks, mut told) = (pin!(link.peer()), interval(LOOK), None::<Duration>);
    loop {
        tokio::select! {
            peer = &mut peer => return Ok(peer.map(|()| true)?),
            _ = looks.tick() => {}
        }
        let left = task.wait.checked_sub(since.elapsed());
        match left {
            _ if shared.stopped() => return Ok(false),
            None => return Err(SessionError::Nobody { link: name, waited: task.wait, hint: String::new() }),
            Some(left) => {
                let since = since.elapsed();
                if since >= PATIENCE && told.is_none_or(|told| since >= told + BEAT) {
                    told = Some(since);
                    let _ = news.send(News::Waiting(left));
                }
            }
        }
    }
}

struct Server<'a> {
    board: Board<'a>,
    bridge: Bridge,
    sender: Sender,
    hints: Hints,
    clock: WallClock,
    /// The run's clock at stream time 0, ns.
    start: i64,
    speed: f64,
    /// Scene time at which it ends.
    end: SimTime,
    /// From a read of the link to the end of the write that answers it.
    latency: Times,
    /// Bytes of answers in the scene.
    bytes: u64,
    /// What the bridge had done before the scene.
    before: Counts,
    answer: Vec<u8>,
    shared: &'a Shared,
    news: &'a UnboundedSender<News>,
}

impl Server<'_> {
    fn stream_time(&self, now: i64) -> SimTime {
        SimTime(((now - self.start) as f64 * self.speed) as i64)
    }

    /// The scene has begun.
    fn begin(&mut self) {
        let Some(start) = self.board.start() else { return };
        self.shared.scene_starts_ns.store(start.0, Ordering::Release);
        self.before = self.bridge.counts();
        self.latency = Times::new();
        self.bytes = 0;
        let _ = self.news.send(News::Started);
    }

    async fn run(&mut self, task: &Task, link: &mut Link) -> Result<(), SessionError> {
        let Some(mut receiver) = link.receiver() else {
            return Err(SessionError::Bus(format!(
                "{}: nothing comes back on this link, and a driver asks",
                link.name()
            )));
        };
        let mut ticks = interval(TICK);
        ticks.set_missed_tick_behavior(MissedTickBehavior::Skip);
        let (mut buffer, mut heard) = (BytesMut::with_capacity(8192), self.clock.now());
        let deadline =
            self.clock.now().saturating_add(i64::try_from(task.wait.as_nanos()).unwrap_or(i64::MAX));
        while !self.shared.stopped() {
            tokio::select! {
                biased;
                got = receiver.recv(&mut buffer) => match got {
                    Ok(1..) => {
                        heard = self.clock.now();
                        self.take(&buffer, heard)?;
                        buffer.clear();
                        if let Some(baud) = self.bridge.take_speed() {
                            self.set_speed(baud, link);
                        }
                    }
                    // The other side has left, and may come back.
                    _ => tokio::time::sleep(TICK).await,
                },
                _ = ticks.tick() => {}
            }
            let now = self.clock.now();
            if now - heard > PAUSE && self.bridge.forget() {
                self.say("a command was cut short: its rest did not come within 1 s".into());
            }
            self.go_on(now)?;
            if self.board.start().is_some_and(|start| self.stream_time(now) - start >= task.end) {
                return Ok(());
            }
            if !self.board.has_begun() && now > deadline {
                return Err(self.unread(task, link));
            }
        }
        Ok(())
    }

    /// Plays on to this time of the clock.
    fn go_on(&mut self, now: i64) -> Result<(), SessionError> {
        let (had_begun, mut t) = (self.board.has_begun(), self.stream_time(now));
        // An end is exclusive: a sample that is due then is not made.
        if let Some(start) = self.board.start() {
            t = t.min(SimTime(start.0.saturating_add(self.end.0) - 1));
        }
        self.board.advance(t).map_err(SessionError::Bus)?;
        self.shared.stream_ns.store(t.0, Ordering::Relaxed);
        if !had_begun && self.board.has_begun() {
            self.begin();
        }
        self.tell_changes();
        Ok(())
    }

    /// Answers bytes that were read at this time.
    fn take(&mut self, bytes: &[u8], now: i64) -> Result<(), SessionError> {
        self.go_on(now)?;
        let had_begun = self.board.has_begun();
        let before = self.bridge.counts().transfers;
        let Server { board, bridge, answer, .. } = self;
        answer.clear();
        bridge.feed(bytes, board, &mut |reply| answer.extend_from_slice(reply));
        if !answer.is_empty() {
            // Whoever does not take an answer asks again.
            let sent = self.sender.send_all(&self.answer, &self.shared.stop);
            self.bytes += if sent == Sent::Done { self.answer.len() as u64 } else { 0 };
            self.latency.record(self.clock.now() - now);
        }
        let now = self.bridge.counts().transfers;
        self.shared.packets.add(now - before);
        self.shared.bus.packets.set(now);
        self.shared.bus.bytes.set(self.bytes);
        if !had_begun && self.board.has_begun() {
            self.begin();
        }
        if let Some(address) = self.bridge.take_refused()
            && let Some(hint) = self.hints.refused(address, self.board.chips())
        {
            self.say(hint);
        }
        let lacks: Vec<_> = self.board.lacks().collect();
        for hint in
            lacks.into_iter().filter_map(|(chip, what)| self.hints.lacks(chip, what)).collect::<Vec<_>>()
        {
            self.say(hint);
        }
        self.tell_changes();
        Ok(())
    }

    /// Tells what the driver has set in the scene since this was told last.
    fn tell_changes(&mut self) {
        if !self.board.has_begun() {
            return;
        }
        let told = |change: &Change| match change.setting.start {
            SimTime::ZERO => format!("as the scene begins, {change}"),
            t => format!("the driver sets {change}, from {t} on"),
        };
        let news: Vec<_> = self.board.news().iter().map(|change| (change.clone(), told(change))).collect();
        for (change, notice) in news {
            let _ = self.news.send(News::Set(Box::new(change)));
            self.say(notice);
        }
    }

    /// Goes on at the speed that the client has set.
    fn set_speed(&mut self, baud: u32, link: &Link) {
        let notice = match link.baud() {
            Some(port) if port.now() == baud => return,
            Some(port) => match port.set(baud) {
                Ok(()) => format!("the driver sets the bridge to {baud} baud: the port goes on at that"),
                Err(error) => format!(
                    "the driver sets the bridge to {baud} baud, and the port does not follow ({error})"
                ),
            },
            None => format!("the driver sets the bridge to {baud} baud; this link has no speed to set"),
        };
        self.say(notice);
    }

    fn say(&self, notice: String) {
        let _ = self.news.send(News::Notice(notice));
    }

    fn unread(&self, task: &Task, link: &Link) -> SessionError {
        let Counts { transfers, refused, strange } = self.bridge.counts();
        let came = match (transfers, strange) {
            (0, 0) => "nothing came".to_string(),
            (0, strange) => format!(
                "{strange} bytes came that begin no command of a bridge (is it at this speed, and does it speak SC18IM700?)"
            ),
            (transfers, _) => format!("{transfers} transfers came, {refused} of them not acknowledged"),
        };
        SessionError::Unread { link: link.name().to_string(), waited: task.wait, came }
    }

    fn end(self, task: &Task, chips: Vec<String>, link: &Link, granted: Granted) -> Served {
        let now = self.stream_time(self.clock.now());
        let start = self.board.start();
        let played = start.map_or(SimTime::ZERO, |start| (now - start).min(task.end));
        let counts = self.bridge.counts();
        Served {
            to: task.output.to.to_string(),
            name: link.name().to_string(),
            chips,
            played,
            rest: start.unwrap_or(now),
            counts: Counts {
                transfers: counts.transfers - self.before.transfers,
                refused: counts.refused - self.before.refused,
                strange: counts.strange,
            },
            bytes: self.bytes,
            latency: self.latency,
            reads: self.board.reads().to_vec(),
            changes: self.board.changes().to_vec(),
            realtime: granted.priority,
            memory_locked: granted.memory,
            baud: link.baud().map(|port| port.now()).or(task.output.to.address.baud()),
        }
    }
}
