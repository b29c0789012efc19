//! The live loop: prepare, wait, send.
//!
//! ```text
//! producer thread: player ─ encoders ─▶ ring ─▶ pacing thread: wait until due, write ─▶ links
//!                                                control (this thread, tokio): peers, answers, Ctrl-C, the command
//! ```
//!
//! A prescribed motion does not depend on the wall clock, so everything is computed ahead and the pacing thread only
//! waits and writes: the cost of the models never shows up as jitter. It allocates nothing and takes no lock.

mod answers;
mod command;
mod control;
mod granted;
mod interrupt;
mod links;
mod overload;
#[cfg(test)]
mod overload_tests;
mod pacer;
mod producer;
mod tally;
mod watch;

pub use control::run;
pub use interrupt::on_interrupt;
pub use pacer::Speed;
pub use watch::{Record, Watch, Watched};

use crate::geometry::Attitude;
use crate::link::LinkError;
use crate::report::{LinkReport, PacingReport, SensorReport};
use crate::scene::{Output, Plan};
use crate::score::Score;
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
    /// How fast scene time goes.
    pub speed: Speed,
    /// How long to wait for somebody on the other side; zero starts at once.
    pub wait: Duration,
    /// A program to start when the links are ready, with its arguments.
    pub command: Vec<String>,
    /// Whether standard output is ours alone: the command's then goes to standard error.
    pub keep_stdout: bool,
    /// What the estimator on the other side is called in the score.
    pub estimator: String,
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
    /// Somebody is there and the scene starts.
    Started,
    /// How far it is.
    Progress(Progress),
}

/// How far a run is.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Scene time.
    pub t: SimTime,
    /// Packets sent.
    pub packets: u64,
    /// Samples lost.
    pub dropped: u64,
    /// The newest estimate's whole error in degrees.
    pub error_deg: Option<f64>,
}

/// What came of it.
#[derive(Debug)]
pub struct Outcome {
    /// Scene time reached: the end, or where it was stopped.
    pub played: SimTime,
    /// Whether it was stopped by the user.
    pub interrupted: bool,
    /// For how long scene time stood still for a link that was full, s.
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
    pub score: Option<Score>,
    /// Every estimate that came back.
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
    /// Due time of the packet sent last, ns.
    scene_ns: AtomicI64,
    /// Wall time of scene time 0 on the run's clock, ns; −1 before the start. It moves when scene time is stretched.
    start_ns: AtomicI64,
    /// Scene time at which it was stretched last, ns: what was due earlier was due by an earlier start.
    stretched_at_ns: AtomicI64,
    packets: AtomicU64,
    dropped: AtomicU64,
}

impl Shared {
    fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

#[cfg(test)]
mod fault_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod watch_tests;
