//! What a run, a measurement or a stream does, for people who look on: an embedded page and the viewers that they
//! have.
//!
//! Whoever runs something puts what happens on a [`Board`]. One thread takes it from there ten times a second, and tells
//! whoever looks on: the page over a WebSocket, and viewers that speak Foxglove's protocol on the same port. The
//! readings are not passed on by the run: the same scene, played again, has the same ones, and is played only where
//! somebody looks. A slow viewer loses its own oldest messages, and holds nobody up.
//!
//! ```
//! use ratetable::live::{About, End, Live, Scene};
//! use ratetable::{scene::Plan, time::SimTime};
//! use std::sync::Arc;
//!
//! let plan = Arc::new(Plan::load("still", &["duration=1 s".into()])?);
//! let about = About::scene("run", &plan, plan.duration, vec!["mpu@pty".into()]);
//! let scene = Scene { plan: plan.clone(), end: plan.duration, records: None };
//! let live = Live::start(about, Some(scene), Some("127.0.0.1:0".parse()?), true)?;
//! assert!(live.url().is_some_and(|url| url.starts_with("http://127.0.0.1:")));
//! let report = live.end(End { ok: true, ..End::default() }, Some(plan.duration)).report();
//! assert!(report.contains("still"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod about;
mod at;
mod batch;
mod board;
mod door;
mod end;
mod foxglove;
mod hub;
mod lateness;
mod message;
mod page;
mod reel;
mod server;
mod status;
mod story;
mod strip;
mod thread;
mod track;
mod viewer;

pub use about::{About, Column, Shown, Span, columns};
pub use at::At;
pub use batch::{Batch, Readings, Told};
pub use board::Board;
pub use end::{Axis, Cell, Chart, End, Figure, Grid, GridRow, Series, Table};
pub use message::{Link, Notice};

use crate::geometry::Attitude;
use crate::scene::Plan;
use crate::session::Record;
use crate::time::SimTime;
use door::Door;
use rtrb::Consumer;
use std::io::{self, ErrorKind};
use std::sync::Arc;
use std::thread::JoinHandle;
use story::Story;
use thread::Task;
use tokio::net::TcpListener;

/// A scene that is shown while it plays.
pub struct Scene {
    /// The scene.
    pub plan: Arc<Plan>,
    /// Scene time at which it ends.
    pub end: SimTime,
    /// The pacing thread's records, for lateness and delivered rates.
    pub records: Option<Consumer<Record>>,
}

/// Why nobody can look on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LiveError {
    /// The port is in use.
    #[error(
        "--live: {0} is in use, by another run perhaps: name another port (--live=127.0.0.1:8421), or 0 for any that is free"
    )]
    Taken(At),
    /// The address is not this machine's, or may not be used.
    #[error("--live: cannot serve on {at}: {source}; name an address of this machine and a port above 1023")]
    Address {
        /// As asked for.
        at: At,
        /// Why not.
        source: io::Error,
    },
    /// The system refused something.
    #[error("--live: {0}")]
    System(#[from] io::Error),
}

/// Something that is shown.
pub struct Live {
    board: Arc<Board>,
    url: Option<String>,
    thread: JoinHandle<Story>,
}

impl Live {
    /// Shows what `about` says, of a scene or of a stream, to whoever comes to this address; without one it is kept
    /// for a report alone. `keeps` is whether a report is wanted in the end.
    ///
    /// # Errors
    /// The address cannot be served on.
    pub fn start(about: About, scene: Option<Scene>, at: Option<At>, keeps: bool) -> Result<Live, LiveError> {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        let inside = runtime.enter();
        let opened = at.map(open).transpose()?;
        drop(inside);
        let url = opened.as_ref().map(|(_, door)| url(door));
        let session = token()?;
        let board = Arc::<Board>::default();
        let task = Task {
            story: Story::new(about, scene.as_ref().map(|scene| scene.plan.clone())),
            scene,
            board: board.clone(),
            runtime,
            listening: opened.map(|(listener, door)| (listener, door, session)),
            keeps,
        };
        let thread = std::thread::Builder::new().name("live".into()).spawn(move || thread::run(task))?;
        Ok(Live { board, url, thread })
    }

    /// Where to put what happens.
    pub fn board(&self) -> &Board {
        &self.board
    }

    /// Where to look on.
    pub fn url(&self) -> Option<&str> {
        self.url.as_deref()
    }

    /// Tells everybody what came of it, and ends; `until` is how far the scene was played.
    pub fn end(self, end: End, until: Option<SimTime>) -> Ended {
        self.board.put_end(end, until);
        Ended(self.thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
    }
}

/// Everything that was shown.
pub struct Ended(Story);

impl Ended {
    /// The same page with everything in it: HTML.
    pub fn report(&self) -> String {
        let end = self.0.end.as_ref().map(story::json);
        let messages: Vec<_> = [self.0.begin(), self.0.so_far()].into_iter().chain(end).collect();
        page::with(&messages)
    }
}

/// Attitudes that are known as they are.
#[derive(Clone, Debug, Default)]
pub struct Paths {
    /// The truth, in order of time.
    pub truth: Vec<(SimTime, Attitude)>,
    /// Each estimate: when it held what, and how far it was off in inclination and in heading, deg.
    pub told: Vec<Vec<(SimTime, Attitude, [f64; 2])>>,
}

/// A page with everything in it, HTML: attitudes with their errors, and what came of it.
pub fn page(about: &About, paths: &Paths, end: &End) -> String {
    let messages =
        [story::json(&message::Begin::of(about, None)), story::json(&message::More::of(about, paths))];
    page::with(&messages.into_iter().chain([story::json(end)]).collect::<Vec<_>>())
}

/// Serves on this address; elsewhere than on loopback, who comes needs a token.
fn open(at: At) -> Result<(TcpListener, Door), LiveError> {
    let listener = std::net::TcpListener::bind(at.0).map_err(|source| match source.kind() {
        ErrorKind::AddrInUse => LiveError::Taken(at),
        _ => LiveError::Address { at, source },
    })?;
    listener.set_nonblocking(true)?;
    let here = listener.local_addr()?;
    let token = if at.is_loopback() { None } else { Some(token()?) };
    Ok((TcpListener::from_std(listener)?, Door { at: here, token }))
}

/// Where to look on: a URL.
fn url(door: &Door) -> String {
    let query = door.token.as_ref().map_or(String::new(), |token| format!("?token={token}"));
    format!("http://{}/{query}", door.at)
}

/// 128 random bits, in hex.
fn token() -> io::Result<String> {
    let mut bytes = [0; 16];
    rustix::rand::getrandom(&mut bytes, rustix::rand::GetRandomFlags::empty())?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}
