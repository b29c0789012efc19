//! The control side of a run: opens links, starts the threads, listens, ends cleanly.

use super::answers::Heard;
use super::granted::Granted;
use super::hold::Hold;
use super::links::{LOOK, Lookout};
use super::lockstep::{self, Step};
use super::pacer::Pacer;
use super::producer::{self, Encoders, Made, Task};
use super::talk::Talk;
use super::watch::Watching;
use super::{Event, Item, Job, Outcome, Progress, SessionError, Shared, Speed, command, ears};
use crate::clock::{Clock, Policy, Precise, WallClock};
use crate::interrupt::Interrupt;
use crate::link::{Link, Sender};
use crate::time::SimTime;
use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread::{self, JoinHandle};
use std::time::Duration;
use tokio::process::Child;
use tokio::sync::oneshot;
use tokio::time::Instant;

/// Packets made ahead, 2.6 MB: about a second of the fastest sensors, and seven at 1 kHz.
const RING: usize = 8192;
/// From the start of the pacing thread to stream time 0.
const LEAD: i64 = 5_000_000;
/// Between two reports of progress.
const PROGRESS: Duration = Duration::from_millis(100);
/// Between two looks at what is due by itself in a conversation.
pub(super) const TICK: Duration = Duration::from_millis(10);

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
    tokio::task::LocalSet::new().block_on(&runtime, Run::go(job, absence, on))
}

pub(super) struct Run {
    pub job: Job,
    pub shared: Arc<Shared>,
    pub clock: WallClock,
    pub talk: Rc<RefCell<Talk>>,
    pub interrupted: bool,
    /// The command's exit code, once it has ended by itself.
    pub ended: Option<i32>,
    /// Whether what comes back on the first link goes to the job's tap.
    pub tapped: bool,
    /// Tasks that read what comes back; each holds its link open.
    pub ears: Vec<tokio::task::JoinHandle<()>>,
    absence: Duration,
    /// The link whose reader has left for good.
    pub left: Option<usize>,
    pub lookout: Lookout,
    hold: Hold,
    /// Why it ended before the scene began.
    pub failed: Option<SessionError>,
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

/// The command, if there is one; without one, its end never comes.
pub(super) struct Program(pub Option<Child>);

impl Program {
    pub(super) async fn ended(&mut self) -> i32 {
        match &mut self.0 {
            Some(child) => child.wait().await.map_or(1, command::code),
            None => std::future::pending().await,
        }
    }
}

impl Run {
    fn new(job: Job, absence: Duration, senders: Vec<Sender>) -> Run {
        let shared = Arc::new(Shared::before(job.rest));
        let lockstep = job.outputs.iter().any(lockstep::in_lockstep);
        let heard = Heard::new(job.plan.clone(), shared.clone(), job.speed, lockstep);
        let talk = Talk::new(&job.outputs, senders, heard);
        let lookout = Lookout::new(job.outputs.len());
        let clock = job.watch.as_ref().map_or_else(WallClock::start, |watch| watch.clock);
        let hold = Hold::new(job.rest);
        Run {
            job,
            lookout,
            shared,
            clock,
            talk: Rc::new(RefCell::new(talk)),
            interrupted: false,
            ended: None,
            tapped: false,
            ears: Vec::new(),
            absence,
            left: None,
            hold,
            failed: None,
        }
    }

    async fn go(job: Job, absence: Duration, on: &mut dyn FnMut(Event<'_>)) -> Result<Outcome, SessionError> {
        let signals = Interrupt::listen();
        let mut signals =
            signals.map_err(|source| SessionError::System { doing: "listen for Ctrl-C", source })?;
        let mut links = Vec::new();
        for output in &job.outputs {
            links.push(Link::open(&output.to.address).await?);
        }
        let senders = links.iter_mut().map(Link::sender).collect();
        let mut run = Run::new(job, absence, senders);
        run.open_ground(on).await?;
        for (link, output) in links.iter().zip(&run.job.outputs) {
            link.notices().iter().for_each(|notice| on(Event::Notice(notice.clone())));
            on(Event::Ready(&output.to.at(link.name())));
        }
        let names: Vec<String> = links.iter().map(|link| link.name().to_string()).collect();
        let (ring, consumer) = rtrb::RingBuffer::new(RING);
        let mut ring = Some(ring);
        // What does not depend on what the other side says is made while it is waited for.
        let mut producer = None;
        if run.talk.borrow().silent().is_none() {
            producer = ring.take().map(|ring| run.start_producer(ring));
        }
        let mut program = Program(None);
        if !run.job.command.is_empty() {
            program.0 = Some(command::start(&run.job.command, &names[0], run.job.keep_stdout)?);
        }
        let mut here = run.wait_for_peers(on, &mut links, &mut signals, &mut program).await;
        if matches!(here, Ok(true)) {
            run.listen(&mut links);
            here = run.wait_to_be_heard(on, &names, &mut signals, &mut program).await;
        }
        if !matches!(here, Ok(true)) {
            run.shared.stop.store(true, Ordering::Relaxed);
            drop(consumer);
            producer.map(JoinHandle::join);
            here?;
            return Ok(run.never_started(names));
        }
        run.compare_rates(on);
        let producer = match (producer, ring) {
            (None, Some(ring)) => run.start_producer(ring),
            (producer, _) => producer.unwrap_or_else(|| unreachable!("the ring went to a producer")),
        };
        on(if run.job.rest.is_some() { Event::Still } else { Event::Started });
        let pacer = run.pacer(consumer);
        let (pacing, mut notices, mut done) = run.start_pacer(pacer)?;
        run.talk.borrow_mut().pacing = Some(pacing.thread().clone());
        run.attend(on, &links, &names, &mut signals, &mut program, &mut notices, &mut done).await;
        let (mut pacer, granted) = pacing.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        let made = run.collect(producer, &mut pacer);
        run.finish(Ended { pacer, links, program, names, granted, made }).await
    }

    /// Opens the way to a ground station, and listens to it.
    async fn open_ground(&mut self, on: &mut dyn FnMut(Event<'_>)) -> Result<(), SessionError> {
        let Some((address, output)) = &self.job.ground else { return Ok(()) };
        let mut link = Link::open(address).await?;
        self.talk.borrow_mut().bridge(link.sender(), *output);
        on(Event::Ground(link.name()));
        if let Some(receiver) = link.receiver() {
            let ear = ears::listen_to_ground(receiver, self.talk.clone());
            self.ears.push(tokio::task::spawn_local(ear));
        }
        Ok(())
    }

    fn start_producer(&self, ring: rtrb::Producer<Item>) -> JoinHandle<(Made, Encoders)> {
        let (plan, outputs, shared) = (self.job.plan.clone(), self.job.outputs.clone(), self.shared.clone());
        let (end, rest, peers) = (self.job.end, self.job.rest, self.talk.borrow().peers());
        thread::spawn(move || {
            let task = Task { plan: &plan, outputs: &outputs, peers: &peers, end, rest };
            producer::produce(task, ring, &shared)
        })
    }

    fn listen(&mut self, links: &mut [Link]) {
        for (i, link) in links.iter_mut().enumerate() {
            let Some(receiver) = link.receiver() else { continue };
            if let Some(tap) = self.job.tap.take_if(|_| i == 0) {
                self.ears.push(tokio::task::spawn_local(ears::tapped(receiver, tap)));
                self.tapped = true;
                continue;
            }
            let ear = ears::listen(i, receiver, self.talk.clone(), self.clock);
            self.ears.push(tokio::task::spawn_local(ear));
        }
    }

    /// The pacing thread's work, with the links.
    fn pacer(&mut self, consumer: rtrb::Consumer<Item>) -> Pacer<Precise<WallClock>> {
        let mut talk = self.talk.borrow_mut();
        let outputs = &self.job.outputs;
        let (senders, replies) = (0..outputs.len()).map(|link| talk.hand_over(link)).unzip();
        let policies = outputs.iter().map(|output| output.overload);
        let clock = Precise::new(self.clock, Policy::Adaptive);
        let mut pacer = Pacer::new(clock, consumer, senders, policies, self.job.speed);
        pacer.watching = self.job.watch.take().map(Watching::new);
        pacer.replies = replies;
        let step = |(link, output)| lockstep::in_lockstep(output).then(|| Step::new(talk.took(link)));
        pacer.steps = outputs.iter().enumerate().map(step).collect();
        pacer
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

    #[expect(clippy::too_many_arguments, reason = "one for each that may end it")]
    /// Reports progress until the pacing thread has ended, or the user, the command or a reader that is gone ends it.
    async fn attend(
        &mut self,
        on: &mut dyn FnMut(Event<'_>),
        links: &[Link],
        names: &[String],
        signals: &mut Interrupt,
        program: &mut Program,
        notices: &mut oneshot::Receiver<Option<String>>,
        done: &mut oneshot::Receiver<()>,
    ) {
        if let Ok(Some(notice)) = notices.await {
            on(Event::Notice(notice));
        }
        let mut ticks = tokio::time::interval(PROGRESS);
        let mut looks = tokio::time::interval(LOOK);
        let mut beats = tokio::time::interval(TICK);
        // Paced, a packet that nobody reads is dropped and counted; and a command ends the run by ending.
        let waits = self.job.speed == Speed::Max && self.job.command.is_empty();
        let mut absence = Absence { packets: 0, since: Instant::now() };
        loop {
            tokio::select! {
                _ = &mut *done => break,
                _ = beats.tick() => {
                    self.tick(on);
                    self.look_on(on, names);
                }
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
        let stream = SimTime(self.shared.stream_ns.load(Ordering::Relaxed));
        let scene = self.shared.scene_time(stream);
        Progress {
            t: scene.unwrap_or(stream),
            still: scene.is_none(),
            packets: self.shared.packets.load(Ordering::Relaxed),
            dropped: self.shared.dropped.load(Ordering::Relaxed),
            error: self.talk.borrow().heard.newest,
        }
    }

    /// Whether the scene may begin, has begun, or is not waited for any more.
    fn look_on(&mut self, on: &mut dyn FnMut(Event<'_>), names: &[String]) {
        let unready = {
            let talk = self.talk.borrow();
            talk.unready().map(|link| (names[link].clone(), talk.what_came(link)))
        };
        match self.hold.look(&self.shared, unready, self.job.wait) {
            Ok(true) => on(Event::Started),
            Ok(false) => {}
            Err(error) => {
                self.failed.get_or_insert(error);
                self.shared.stop.store(true, Ordering::Relaxed);
            }
        }
        if let Some(notice) = self.hold.untaken(&self.shared) {
            on(Event::Notice(notice));
        }
    }
}

/// What is left when both threads have ended.
pub(super) struct Ended {
    pub pacer: Pacer<Precise<WallClock>>,
    pub links: Vec<Link>,
    pub program: Program,
    pub names: Vec<String>,
    pub granted: Granted,
    /// What was made, what of it is left, and who can take leave.
    pub made: super::finish::Collected,
}

type Paced = (
    JoinHandle<(Pacer<Precise<WallClock>>, Granted)>,
    oneshot::Receiver<Option<String>>,
    oneshot::Receiver<()>,
);

#[cfg(test)]
mod tests {
    use super::super::Judging;
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
            rest: None,
            ground: None,
            speed: Speed::Max,
            wait: Duration::from_secs(60),
            command: Vec::new(),
            keep_stdout: false,
            judging: Judging::default(),
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
