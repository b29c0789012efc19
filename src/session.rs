//! The live loop: prepare, wait, send.
//!
//! ```text
//! producer thread: player ─ encoders ─▶ ring ─▶ pacing thread: wait until due, write ─▶ links
//!                                  ring of replies ─▶ (between packets)                    │
//!                                          └── control (this thread, tokio): dialogues ◀───┘ Ctrl-C, the command
//! ```
//!
//! A prescribed motion does not depend on the wall clock, so everything is computed ahead and the pacing thread only
//! waits and writes: the cost of the models never shows up as jitter. It allocates nothing and takes no lock.
//!
//! Two times go by. *Stream time* is what packets are due at, from the first one on. *Scene time* begins when the
//! scene does: at once, or after a rest in which the vehicle is held still for the other side's estimator to settle.

mod answers;
mod command;
mod control;
mod ears;
mod finish;
mod granted;
mod hold;
mod links;
mod lockstep;
mod overload;
#[cfg(test)]
mod overload_tests;
mod pacer;
mod producer;
mod replies;
mod talk;
mod tally;
mod waiting;
mod watch;

pub use answers::{Judging, Off};
pub use control::run;
pub use pacer::Speed;
pub use watch::{Record, Watch, Watched};

use crate::geometry::Attitude;
use crate::link::{Address, LinkError};
use crate::report::{LinkReport, PacingReport, SensorReport};
use crate::scene::{Output, Plan};
use crate::score::Figures;
use crate::time::SimTime;
use crate::wire::Packet;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicI64, AtomicU64, Ordering};
use std::time::Duration;

/// What to run.
#[derive(Debug)]
pub struct Job {
    /// The scene.
    pub plan: Arc<Plan>,
    /// Where to: at least one.
    pub outputs: Vec<Output>,
    /// Scene time at which it ends.
    pub end: SimTime,
    /// How long the vehicle is held still before the scene at the least, and then until every other side is ready;
    /// `None` begins with the scene.
    pub rest: Option<SimTime>,
    /// A ground station, and which of the outputs has the controller that it is to talk to.
    pub ground: Option<(Address, usize)>,
    /// How fast scene time goes.
    pub speed: Speed,
    /// How long to wait for somebody on the other side; zero starts at once.
    pub wait: Duration,
    /// A program to start when the links are ready, with its arguments.
    pub command: Vec<String>,
    /// Whether standard output is ours alone: the command's then goes to standard error.
    pub keep_stdout: bool,
    /// How what the other side estimates is judged.
    pub judging: Judging,
    /// The processor that the pacing thread is to keep to.
    pub cpu: Option<usize>,
    /// A comparison with a bare timer, on the pacing thread.
    pub watch: Option<Watch>,
    /// Who takes in what comes back on the first link, in place of the score: a loopback plug returns the packets.
    pub tap: Option<Tap>,
}

/// Called with bytes as they arrive.
pub type OnBytes = dyn FnMut(&[u8]);

/// Takes in what a link receives.
pub struct Tap(pub Box<OnBytes>);

impl std::fmt::Debug for Tap {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Tap")
    }
}

/// What happens meanwhile.
#[derive(Debug)]
pub enum Event<'a> {
    /// Something the user should know.
    Notice(String),
    /// A link is open: protocol and what to connect to.
    Ready(&'a str),
    /// A ground station is spoken to there.
    Ground(&'a str),
    /// Nobody has come to that link yet: until that is so for this long, it is waited for somebody.
    Waiting {
        /// Who is waited for, and where.
        whom: String,
        /// From now on, at the most.
        left: Duration,
    },
    /// The controller on that link is waited for: nothing is streamed before it is heard.
    Silent(&'a str),
    /// The stream starts with the vehicle held still.
    Still,
    /// The scene starts.
    Started,
    /// How far it is.
    Progress(Progress),
}

/// How far a run is.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Scene time; while the vehicle is held still, for how long.
    pub t: SimTime,
    /// Whether it is held still before the scene.
    pub still: bool,
    /// Packets sent.
    pub packets: u64,
    /// Samples lost.
    pub dropped: u64,
    /// How far the newest estimate is off.
    pub error: Option<Off>,
}

/// What came of it.
#[derive(Debug)]
pub struct Outcome {
    /// Scene time reached: the end, or where it was stopped.
    pub played: SimTime,
    /// Whether it was stopped by the user.
    pub interrupted: bool,
    /// For how long the vehicle was held still before the scene, s.
    pub rest_s: f64,
    /// For how long scene time stood still for a link that was full or a controller in lockstep, s.
    pub stretched_s: f64,
    /// Whether the pacing thread had real-time priority.
    pub realtime: bool,
    /// Whether the process was locked in memory.
    pub memory_locked: bool,
    /// How the pacing thread waited; `None` where nothing was paced.
    pub pacing: Option<PacingReport>,
    /// The comparison, where one was asked for.
    pub watched: Option<Watched>,
    /// Each sensor's counts, rates and lateness.
    pub sensors: Vec<SensorReport>,
    /// Each link's counts.
    pub links: Vec<LinkReport>,
    /// The faults of outputs that acted: `mpu@pty drop from 2 s to 3 s`.
    pub faults: Vec<String>,
    /// What the other side estimated, judged.
    pub attitude: Option<Figures>,
    /// Every estimate that came back, with the scene time at which it held as far as that is known.
    pub estimates: Vec<(SimTime, Attitude)>,
    /// The command's exit code; `None` without a command, or when it was ended by us.
    pub command: Option<i32>,
}

/// Why nothing could be run.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// A link could not be opened or broke while waiting.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// Nobody came.
    #[error("nobody came to {link} in {}: open it from the other side, or wait longer with --wait TIME, or start at once with --wait 0", seconds(*waited))]
    Nobody {
        /// What to connect to.
        link: String,
        /// For how long we waited.
        waited: Duration,
    },
    /// A controller never said what it begins with.
    #[error("{link} was not heard in {}: {came}; wait longer with --wait TIME, or start at once with --wait 0", seconds(*waited))]
    Unheard {
        /// What to connect to.
        link: String,
        /// For how long we waited.
        waited: Duration,
        /// What came instead, and what may be wrong.
        came: String,
    },
    /// A controller's estimator did not settle.
    #[error(
        "{link} is not ready after {rested} at rest: {came}; wait longer with --wait TIME, or start at once with --wait 0"
    )]
    NotReady {
        /// What to connect to.
        link: String,
        /// For how long it was fed the vehicle at rest.
        rested: SimTime,
        /// What came of it.
        came: String,
    },
    /// The command could not be started.
    #[error("`{program}` could not be started: {source}")]
    Command {
        /// The program.
        program: String,
        /// Why.
        source: std::io::Error,
    },
    /// The system refused what every run needs.
    #[error("could not {doing}: {source}")]
    System {
        /// What was tried.
        doing: &'static str,
        /// Why not.
        source: std::io::Error,
    },
}

fn seconds(duration: Duration) -> String {
    SimTime(i64::try_from(duration.as_nanos()).unwrap_or(i64::MAX)).to_string()
}

/// A packet on its way to one of the outputs.
#[derive(Clone, Copy, Debug)]
struct Item {
    output: usize,
    packet: Packet,
}

/// What the threads of a run tell each other.
#[derive(Debug, Default)]
struct Shared {
    /// Ends everything soon.
    stop: AtomicBool,
    /// The producer has pushed its last packet.
    all_made: AtomicBool,
    /// Due time of the packet sent last, ns of stream time.
    stream_ns: AtomicI64,
    /// Every other side is ready for the scene.
    ready: AtomicBool,
    /// Stream time at which the scene starts, ns; the greatest number before that is known.
    scene_starts_ns: AtomicI64,
    /// Wall time of stream time 0 on the run's clock, ns; −1 before the start. It moves when scene time is stretched.
    start_ns: AtomicI64,
    /// Stream time at which it was stretched last, ns: what was due earlier was due by an earlier start.
    stretched_at_ns: AtomicI64,
    packets: AtomicU64,
    dropped: AtomicU64,
    /// Packets whose answer was not waited for any longer.
    untaken: AtomicU64,
}

impl Shared {
    /// Before the start of a run with such a rest.
    fn before(rest: Option<SimTime>) -> Shared {
        let scene_starts_ns = AtomicI64::new(if rest.is_some() { i64::MAX } else { 0 });
        Shared { start_ns: AtomicI64::new(-1), scene_starts_ns, ..Shared::default() }
    }

    /// Scene time at a stream time; `None` before the scene.
    fn scene_time(&self, stream: SimTime) -> Option<SimTime> {
        let starts = SimTime(self.scene_starts_ns.load(Ordering::Acquire));
        (stream >= starts).then(|| stream - starts)
    }

    fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

#[cfg(test)]
mod fault_tests;
#[cfg(test)]
mod session_tests;
#[cfg(test)]
mod talk_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod watch_tests;
