//! What is heard of a stream, put on one time: that since its first bytes.

use crate::listen::Event;
use crate::live::{Board, Told};
use crate::time::SimTime;
use crate::wire::samples::Sensed;
use std::time::Duration;

/// While too many values wait to be shown, those of a recording wait so long.
const PAUSE: Duration = Duration::from_millis(1);

/// The times of a stream.
#[derive(Default)]
pub struct Clocks {
    /// Since the first bytes.
    elapsed: SimTime,
    /// Of a recording: its first sample's time.
    first: Option<SimTime>,
    /// From a controller's own clock to the time since the first bytes, ns.
    ahead: Option<i64>,
}

impl Clocks {
    /// Puts an event on the board.
    pub fn put(&mut self, event: &Event<'_>, board: &Board) {
        match event {
            Event::Notice(notice) => board.put_notice(notice.clone()),
            Event::Ready(name) => {
                board.put_notice(format!("listening: {name}"));
                board.put_waiting(format!("waiting for the first bytes on {name}"));
            }
            Event::Progress(progress) => {
                if progress.meter.counts().bytes > 0 {
                    let elapsed = i64::try_from(progress.elapsed.as_nanos()).unwrap_or(i64::MAX);
                    self.elapsed = self.elapsed.max(SimTime(elapsed));
                    board.put_heard(self.elapsed, progress);
                }
            }
            Event::Values(came, values) => {
                let timed = values.iter().filter_map(|value| {
                    // A recording has no times of arrival: those of its samples are shown, from the first on.
                    let t = came.or_else(|| Some(value.t? - *self.first.get_or_insert(value.t?)))?;
                    let numbers = match value.sensed {
                        Sensed::Body(body) => body.v.to_array().to_vec(),
                        Sensed::Pressure(pascals) => vec![pascals],
                    };
                    Some((value.stream, t, numbers))
                });
                let timed: Vec<_> = timed.collect();
                if let Some((_, t, _)) = timed.last().filter(|_| came.is_none()) {
                    self.elapsed = self.elapsed.max(*t);
                }
                while !board.put_values(timed.iter().cloned()) && came.is_none() {
                    std::thread::sleep(PAUSE);
                }
            }
            Event::Told(told) => {
                let elapsed = self.elapsed.0;
                board.put_told(told.iter().map(|(own, attitude)| {
                    let ahead = *self.ahead.get_or_insert(elapsed - own);
                    Told { of: 0, t: SimTime(own + ahead), attitude: *attitude }
                }));
            }
        }
    }
}
