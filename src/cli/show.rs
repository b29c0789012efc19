//! Shows what goes on while it does, and keeps it for a page to look at later: `--live`, `report.html`.

pub mod ends;
pub mod heard;

use super::{Refusal, options, tell};
use crate::live::{About, At, Board, End, Live, Scene};
use crate::session::{Event, Record, Watch};
use crate::time::SimTime;
use rtrb::{Consumer, RingBuffer};

/// The page of an output folder.
pub const PAGE: &str = "report.html";
/// Records of samples that wait to be shown, at most: seven seconds of the fastest sensors.
const RECORDS: usize = 1 << 16;

/// `--live`.
#[derive(Debug, clap::Args)]
pub struct LiveArguments {
    /// Show it while it runs, as a page for a browser and for Foxglove's viewers [default: 127.0.0.1:8420]
    #[arg(long, value_name = "ADDR:PORT", num_args = 0..=1, require_equals = true, default_missing_value = "127.0.0.1:8420", value_parser = options::at)]
    pub live: Option<At>,
}

/// What is shown, if anybody wants it.
pub struct Show {
    live: Option<Live>,
    /// Whether a page is wanted in the end.
    keeps: bool,
}

impl Show {
    /// Nobody wants it.
    pub fn none() -> Show {
        Show { live: None, keeps: false }
    }

    /// Shows this at an address, and keeps it for a page where that is wanted; tells where to look.
    ///
    /// # Errors
    /// The address cannot be served on.
    pub fn start(about: About, scene: Option<Scene>, at: Option<At>, keeps: bool) -> Result<Show, Refusal> {
        if at.is_none() && !keeps {
            return Ok(Show::none());
        }
        let live = Live::start(about, scene, at, keeps)?;
        if let Some(url) = live.url() {
            tell(&format!("live: {url}"));
        }
        Ok(Show { live: Some(live), keeps })
    }

    /// Where to put what happens, if anybody wants it.
    pub fn board(&self) -> Option<&Board> {
        self.live.as_ref().map(Live::board)
    }

    /// Shows an event of a run.
    pub fn event(&self, event: &Event<'_>) {
        if let Some(board) = self.board() {
            board.put(event);
        }
    }

    /// Shows what came of it, of a scene that was played up to `until`; the page, where one is wanted.
    pub fn end(self, end: impl FnOnce() -> End, until: Option<SimTime>) -> Option<String> {
        let ended = self.live?.end(end(), until);
        self.keeps.then(|| ended.report())
    }

    /// Shows why it did not come to an end.
    pub fn fail(self, refusal: Refusal) -> Refusal {
        let failed = vec![refusal.0.clone()];
        self.end(|| End { failed, ..End::default() }, None);
        refusal
    }
}

/// Records of what is sent, and the request for them on a clock.
pub fn records(clock: crate::clock::WallClock) -> (Watch, Consumer<Record>) {
    let (records, recorded) = RingBuffer::new(RECORDS);
    (Watch { clock, bare: None, records }, recorded)
}
