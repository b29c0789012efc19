//! The control side of a run: opens links, waits for peers, starts the threads, listens, ends cleanly.

use super::answers::{self, Ear, Heard};
use super::granted::Granted;
use super::links::{self, Account, LOOK, Lookout};
use super::pacer::{Left, Pacer};
use super::producer::{self, Made};
use super::tally::{self, LinkTally};
use super::watch::Watching;
use super::{Event, Item, Job, Outcome, Progress, SessionError, Shared, Speed, command};
use crate::clock::{Clock, Policy, Precise, WallClock};
use crate::link::Link;
use crate::report::{LinkReport, PacingReport};
use crate::sensor::ByKind;
use crate::time::SimTime;
use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread::{self, JoinHandle};
use std::time::Duration;
use tokio::process::Child;
use tokio::signal::unix::{Signal, SignalKind, signal};
use tokio::sync::oneshot;
use tokio::time::Instant;

/// Packets made ahead, 2 MB: about a second of the fastest sensors, and seven at 1 kHz.
const RING: usize = 8192;
/// From the start of the pacing thread to scene time 0.
const LEAD: i64 = 5_000_000;
/// Between two reports of progress.
const PROGRESS: Duration = Duration::from_millis(100);
/// For answers that are still on their way when the last packet is out.
const LAST_ANSWERS: Duration = Duration::from_millis(200);

/// At full speed nothing moves without a reader; one who is away for so long has left for good.
const ABSENCE: Duration = Duration::from_secs(5);

/// Runs a job to its end, to Ctrl-C or to the command's end, and tells `on` what happens meanwhile.
///
/// # Errors
/// A link that cannot be opened, nobody on the other side in time, a command that does not start.
pub fn run(job: Job, on: &mut dyn FnMut(Event<'_>)) -> Result<Outcome, SessionError> {
    run_with(job, ABSENCE, on)
}

fn run_with(job: Job, absence: Duration, on: &mut dyn FnMut(Event<'_>)) -> Result<Outcome, SessionError> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let runtime =
        runtime.map_err(|source| SessionError::System { doing: "start the control loop", source })?;
    tokio::task::LocalSet::new().block_on(&runtime, Run::new(job, absence).go(on))
}

struct Run {
    job: Job,
    shared: Arc<Shared>,
    clock: WallClock,
    heard: Rc<RefCell<Heard>>,
    interrupted: bool,
    /// The command's exit code, once it has ended by itself.
    ended: Option<i32>,
    /// Whether what comes back on the first link goes to the job's tap.
    tapped: bool,
    /// Tasks that read what comes back; each holds its link open.
    ears: Vec<tokio::task::JoinHandle<()>>,
    absence: Duration,
    /// The link whose reader has left for good.
    left: Option<usize>,
    lookout: Lookout,
}

/// What ended a wait.
enum Woke<T> {
    Done(T),
    Interrupted,
    CommandEnded,
}

/// Since when no packet has moved because a reader is gone.
struct Absence {
    packets: u64,
    since: Instant,
}

impl Absence {
    /// The link whose reader has been gone for `limit`.
    fn look(&mut self, packets: u64, links: &[Link], limit: Duration) -> Option<usize> {
        let still = packets == self.packets;
        let left = still.then(|| links.iter().position(Link::peer_has_left)).flatten();
        if left.is_none() {
            *self = Absence { packets, since: Instant::now() };
        }
        left.filter(|_| self.since.elapsed() >= limit)
    }
}

struct Signals(Signal, Signal);

impl Signals {
    fn new() -> Result<Signals, SessionError> {
        let on =
            |kind| signal(kind).map_err(|source| SessionError::System { doing: "listen for Ctrl-C", source });
        Ok(Signals(on(SignalKind::interrupt())?, on(SignalKind::terminate())?))
    }

    async fn recv(&mut self) {
        tokio::select! { _ = self.0.recv() => {}, _ = self.1.recv() => {} }
    }
}

/// The command, if there is one; without one, its end never comes.
struct Program(Option<Child>);

impl Program {
    async fn ended(&mut self) -> i32 {
        match &mut self.0 {
            Some(child) => child.wait().await.map_or(1, command::code),
            None => std::future::pending().await,
        }
    }
}

impl Run {
    fn new(job: Job, absence: Duration) -> Run {
        let heard = Heard { damaged: vec![0; job.outputs.len()], ..Heard::default() };
        let shared = Shared::default();
        shared.start_ns.store(-1, Ordering::Relaxed);
        let lookout = Lookout::new(job.outputs.len());
        let clock = job.watch.as_ref().map_or_else(WallClock::start, |watch| watch.clock);
        Run {
            job,
            lookout,
            shared: Arc::new(shared),
            clock,
            heard: Rc::new(RefCell::new(heard)),
            interrupted: false,
            ended: None,
            tapped: false,
            ears: Vec::new(),
            absence,
            left: None,
        }
    }

    async fn go(mut self, on: &mut dyn FnMut(Event<'_>)) -> Result<Outcome, SessionError> {
        let mut signals = Signals::new()?;
        let mut links = Vec::new();
        for output in &self.job.outputs {
            links.push(Link::open(&output.to.address).await?);
        }
        for (link, output) in links.iter_mut().zip(&self.job.outputs) {
            link.notices().iter().for_each(|notice| on(Event::Notice(notice.clone())));
            on(Event::Ready(&format!("{}@{}", output.to.protocol.name(), link.name())));
        }
        let names: Vec<String> = links.iter().map(|link| link.name().to_string()).collect();
        let (ring, consumer) = rtrb::RingBuffer::new(RING);
        let producer = self.start_producer(ring);
        let mut program = Program(None);
        if !self.job.command.is_empty() {
            program.0 = Some(command::start(&self.job.command, &names[0], self.job.keep_stdout)?);
        }
        let here = self.wait_for_peers(&mut links, &mut signals, &mut program).await;
        if !matches!(here, Ok(true)) {
            self.shared.stop.store(true, Ordering::Relaxed);
            drop(consumer);
            let _ = producer.join();
            here?;
            return Ok(self.never_started(names));
        }
        on(Event::Started);
        let senders = links.iter_mut().map(Link::sender).collect();
        self.listen(&mut links);
        let policies = self.job.outputs.iter().map(|output| output.overload);
        let clock = Precise::new(self.clock, Policy::Adaptive);
        let mut pacer = Pacer::new(clock, consumer, senders, policies, self.job.speed);
        pacer.watching = self.job.watch.take().map(Watching::new);
        let (pacing, mut notices, mut done) = self.start_pacer(pacer)?;
        self.attend(on, &links, &mut signals, &mut program, &mut notices, &mut done).await;
        let (mut pacer, granted) = pacing.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        let made = self.collect(producer, &mut pacer);
        self.finish(Ended { pacer, links, program, names, granted, made }).await
    }

    fn start_producer(&self, ring: rtrb::Producer<Item>) -> JoinHandle<Made> {
        let (plan, outputs, end, shared) =
            (self.job.plan.clone(), self.job.outputs.clone(), self.job.end, self.shared.clone());
        thread::spawn(move || producer::produce(&plan, &outputs, end, ring, &shared))
    }

    /// True when somebody is on every link; false when the user or the command ended the wait.
    async fn wait_for_peers(
        &mut self,
        links: &mut [Link],
        signals: &mut Signals,
        program: &mut Program,
    ) -> Result<bool, SessionError> {
        if self.job.wait.is_zero() {
            return Ok(true);
        }
        let waited = self.job.wait;
        let deadline = Instant::now() + waited;
        for link in links {
            let name = link.name().to_string();
            let woke = tokio::select! {
                peer = tokio::time::timeout_at(deadline, link.peer()) => Woke::Done(peer),
                () = signals.recv() => Woke::Interrupted,
                code = program.ended() => {
                    self.ended = Some(code);
                    Woke::CommandEnded
                }
            };
            match woke {
                Woke::Done(Ok(peer)) => peer?,
                Woke::Done(Err(_)) => return Err(SessionError::Nobody { link: name, waited }),
                Woke::Interrupted => {
                    self.interrupted = true;
                    return Ok(false);
                }
                Woke::CommandEnded => return Ok(false),
            }
        }
        Ok(true)
    }

    fn listen(&mut self, links: &mut [Link]) {
        for (i, link) in links.iter_mut().enumerate() {
            let Some(receiver) = link.receiver() else { continue };
            if let Some(tap) = self.job.tap.take_if(|_| i == 0) {
                self.ears.push(tokio::task::spawn_local(answers::tapped(receiver, tap)));
                self.tapped = true;
                continue;
            }
            let ear = Ear {
                plan: self.job.plan.clone(),
                shared: self.shared.clone(),
                clock: self.clock,
                speed: self.job.speed,
                heard: self.heard.clone(),
            };
            self.ears.push(tokio::task::spawn_local(ear.listen(
                i,
                self.job.outputs[i].to.protocol,
                self.job.outputs[i].wire,
                receiver,
            )));
        }
    }

    /// Starts the pacing thread; the channels bring a notice about what it was not allowed, and its end.
    fn start_pacer(&self, mut pacer: Pacer<Precise<WallClock>>) -> Result<Paced, SessionError> {
        let (shared, paced, cpu) = (self.shared.clone(), self.job.speed != Speed::Max, self.job.cpu);
        let (tell, notices) = oneshot::channel();
        let (over, done) = oneshot::channel();
        let body = move || {
            let granted = if paced { Granted::ask(cpu) } else { Granted::default() };
            let _ = tell.send(granted.refused.clone());
            pacer.run(pacer.clock.now() + LEAD, &shared);
            let _ = over.send(());
            (pacer, granted)
        };
        let thread = thread::Builder::new().name("pacing".into()).spawn(body);
        let thread =
            thread.map_err(|source| SessionError::System { doing: "start the pacing thread", source })?;
        Ok((thread, notices, done))
    }

    /// Reports progress until the pacing thread has ended, or the user, the command or a reader that is gone ends it.
    async fn attend(
        &mut self,
        on: &mut dyn FnMut(Event<'_>),
        links: &[Link],
        signals: &mut Signals,
        program: &mut Program,
        notices: &mut oneshot::Receiver<Option<String>>,
        done: &mut oneshot::Receiver<()>,
    ) {
        if let Ok(Some(notice)) = notices.await {
            on(Event::Notice(notice));
        }
        let mut ticks = tokio::time::interval(PROGRESS);
        let mut looks = tokio::time::interval(LOOK);
        // Paced, a packet that nobody reads is dropped and counted; and a command ends the run by ending.
        let waits = self.job.speed == Speed::Max && self.job.command.is_empty();
        let mut absence = Absence { packets: 0, since: Instant::now() };
        loop {
            tokio::select! {
                _ = &mut *done => break,
                _ = looks.tick() => self.lookout.look(links, |notice| on(Event::Notice(notice))),
                _ = ticks.tick() => {
                    let progress = self.progress();
                    if waits && let Some(link) = absence.look(progress.packets, links, self.absence) {
                        self.left = Some(link);
                        self.shared.stop.store(true, Ordering::Relaxed);
                    }
                    on(Event::Progress(progress));
                }
                () = signals.recv(), if !self.interrupted => {
                    self.interrupted = true;
                    self.shared.stop.store(true, Ordering::Relaxed);
                }
                code = program.ended(), if self.ended.is_none() => {
                    self.ended = Some(code);
                    self.shared.stop.store(true, Ordering::Relaxed);
                }
            }
        }
        self.lookout.look(links, |notice| on(Event::Notice(notice)));
        on(Event::Progress(self.progress()));
    }

    fn progress(&self) -> Progress {
        Progress {
            t: SimTime(self.shared.scene_ns.load(Ordering::Relaxed)),
            packets: self.shared.packets.load(Ordering::Relaxed),
            dropped: self.shared.dropped.load(Ordering::Relaxed),
            error_deg: self.heard.borrow().newest_deg,
        }
    }

    /// Joins the producer, emptying the ring into the count of what was left while it ends.
    fn collect(&self, producer: JoinHandle<Made>, pacer: &mut Pacer<Precise<WallClock>>) -> (Made, Left) {
        self.shared.stop.store(true, Ordering::Relaxed);
        let mut left = Left::nothing(self.job.outputs.len());
        loop {
            // Asked before emptying: what the producer pushed last is then in the ring.
            let over = producer.is_finished();
            left += pacer.left();
            if over {
                break;
            }
            thread::sleep(Duration::from_micros(100));
        }
        (producer.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)), left)
    }

    /// Lets the other side take what was sent, closes everything, and adds up.
    async fn finish(mut self, ended: Ended) -> Result<Outcome, SessionError> {
        let Ended { mut pacer, links, program, names, granted, made: (mut made, left) } = ended;
        for (sender, gone) in pacer.senders.iter_mut().zip(&mut pacer.gone) {
            if let Err(error) = sender.finish() {
                gone.get_or_insert(error.kind());
            }
        }
        let pacing =
            pacer.effort.share().filter(|_| self.job.speed != Speed::Max).map(|share| PacingReport {
                spin_us: pacer.clock.margin().ns() as f64 / 1000.0,
                pacing_cpu: share,
                pinned_cpu: granted.cpu,
            });
        let (mut tallies, gone, stretched) = (pacer.tallies, pacer.gone, pacer.stretched);
        let now = self.clock.now();
        tallies.iter_mut().for_each(|tally| tally.gaps.end(now));
        drop(pacer.senders);
        if self.tapped || !self.heard.borrow().estimates.is_empty() {
            tokio::time::sleep(LAST_ANSWERS).await;
        }
        for ear in &self.ears {
            ear.abort();
        }
        for ear in std::mem::take(&mut self.ears) {
            // Only when its task is gone does a link's descriptor close, and the other side see the end.
            let _ = ear.await;
        }
        for link in links {
            link.close().await;
        }
        let command = match (self.ended, program.0) {
            (Some(code), _) => Some(code),
            (None, Some(child)) => command::end(child).await,
            (None, None) => None,
        };
        let sum = |rows: &[ByKind<u64>]| -> ByKind<u64> {
            std::array::from_fn(|i| rows.iter().map(|row| row[i]).sum())
        };
        let (total, waiting) = (sum(&made.samples), sum(&made.waiting));
        let queued = std::array::from_fn(|i| left.samples[i] + waiting[i]);
        let paced = self.job.speed != Speed::Max;
        let played = self.played(&gone);
        made.faults.iter_mut().flatten().for_each(|acts| acts.settle(played));
        let heard = self.heard.borrow();
        Ok(Outcome {
            played,
            interrupted: self.interrupted,
            stretched_s: stretched as f64 * 1e-9,
            realtime: granted.priority,
            memory_locked: granted.memory,
            pacing,
            watched: pacer.watching.map(|watching| watching.seen),
            sensors: tally::sensors(&self.job.plan, &tallies, total, queued, paced),
            links: self.link_reports(&tallies, &gone, names, &made, &left),
            faults: links::fired(&self.job.outputs, &made),
            score: heard.scorer.score(&self.job.estimator),
            estimates: heard.estimates.clone(),
            command,
        })
    }

    /// The end if all was played, else where the last packet was due.
    fn played(&self, gone: &[Option<std::io::ErrorKind>]) -> SimTime {
        let stopped = self.interrupted || self.ended.is_some() || self.left.is_some();
        let cut_short = stopped || !gone.contains(&None);
        // An end is exclusive: a nanosecond on, so that the last packet is within.
        let last = SimTime(self.shared.scene_ns.load(Ordering::Relaxed) + 1);
        if cut_short { last.min(self.job.end) } else { self.job.end }
    }

    fn link_reports(
        &self,
        tallies: &[LinkTally],
        gone: &[Option<std::io::ErrorKind>],
        names: Vec<String>,
        made: &Made,
        left: &Left,
    ) -> Vec<LinkReport> {
        let damaged = &self.heard.borrow().damaged;
        let (outputs, lookout, abandoned) = (&self.job.outputs, &self.lookout, self.left);
        Account { outputs, names, tallies, gone, made, left, lookout, damaged, abandoned }.reports()
    }

    fn never_started(&self, names: Vec<String>) -> Outcome {
        let tallies: Vec<_> = names.iter().map(|_| LinkTally::new()).collect();
        let gone = vec![None; names.len()];
        Outcome {
            played: SimTime::ZERO,
            interrupted: self.interrupted,
            stretched_s: 0.0,
            realtime: false,
            memory_locked: false,
            pacing: None,
            watched: None,
            sensors: tally::sensors(&self.job.plan, &tallies, ByKind::default(), ByKind::default(), false),
            links: self.link_reports(&tallies, &gone, names, &Made::default(), &Left::nothing(gone.len())),
            faults: Vec::new(),
            score: None,
            estimates: Vec::new(),
            command: self.ended,
        }
    }
}

/// What is left when both threads have ended.
struct Ended {
    pacer: Pacer<Precise<WallClock>>,
    links: Vec<Link>,
    program: Program,
    names: Vec<String>,
    granted: Granted,
    /// What was made, and what of it is left.
    made: (Made, Left),
}

type Paced = (
    JoinHandle<(Pacer<Precise<WallClock>>, Granted)>,
    oneshot::Receiver<Option<String>>,
    oneshot::Receiver<()>,
);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Output, Plan};
    use std::fs::OpenOptions;
    use std::io::Read;
    use std::os::unix::fs::OpenOptionsExt;

    #[test]
    fn at_full_speed_a_reader_that_leaves_for_good_ends_the_run() {
        let scene = "duration = \"1000 s\"\n[gyro]\nrate = \"8 kHz\"\n";
        let plan = Arc::new(Plan::parse(scene, "test", "test", &[]).unwrap());
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("imu");
        let job = Job {
            end: plan.duration,
            plan,
            outputs: vec![Output::to(format!("mpu@pty:{}", path.display()).parse().unwrap())],
            speed: Speed::Max,
            wait: Duration::from_secs(60),
            command: Vec::new(),
            keep_stdout: false,
            estimator: String::new(),
            cpu: None,
            watch: None,
            tap: None,
        };
        let read_a_while = move || {
            // Away for less than is allowed, it may come back.
            for _ in 0..2 {
                let mut port =
                    OpenOptions::new().read(true).custom_flags(libc::O_NOCTTY).open(&path).unwrap();
                port.read_exact(&mut vec![0; 100_000]).unwrap();
                drop(port);
                thread::sleep(Duration::from_millis(150));
            }
        };
        let mut reader = None;
        let outcome = run_with(job, Duration::from_secs(2), &mut |event| {
            if let Event::Ready(_) = event {
                reader = Some(thread::spawn(read_a_while.clone()));
            }
        });
        reader.unwrap().join().unwrap();
        let outcome = outcome.unwrap();
        let link = &outcome.links[0];
        assert_eq!(link.broken.as_deref(), Some("the reader left"));
        assert!(link.bytes >= 200_000, "{link:?}");
        assert!(outcome.played < SimTime(1_000_000_000_000));
        assert!(!outcome.interrupted);
    }
}
