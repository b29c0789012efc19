//! The thread that keeps the ledger while a run goes on, and writes `timing.csv`.

use super::ledger::{HEADING, Ledger};
use super::reader::Arrival;
use crate::dataset::{DatasetError, Sink};
use crate::session::Record;
use rtrb::{Consumer, Producer};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

/// Between two looks at what came.
const TURN: Duration = Duration::from_millis(10);
/// Records and arrivals that wait for the ledger, at most: seven seconds of the fastest sensors, and 5 MB each.
pub const RING: usize = 1 << 16;

/// The ledger at work.
pub struct Collector {
    stop: Arc<AtomicBool>,
    thread: JoinHandle<Result<Ledger, DatasetError>>,
}

impl Collector {
    /// Starts on what the two ends hand over.
    pub fn start(
        ledger: Ledger,
        records: Consumer<Record>,
        arrivals: Consumer<Arrival>,
        to: Onward,
    ) -> Collector {
        let stop = Arc::new(AtomicBool::new(false));
        let book = Book { ledger, records, arrivals, to };
        let stopped = stop.clone();
        Collector { stop, thread: std::thread::spawn(move || book.keep(&stopped)) }
    }

    /// The whole ledger; both ends must be at rest.
    ///
    /// # Errors
    /// `timing.csv` could not be written.
    pub fn end(self) -> Result<Ledger, DatasetError> {
        self.stop.store(true, Ordering::Release);
        self.thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    }
}

/// What becomes of the records.
#[derive(Default)]
pub struct Onward {
    /// Where the ledger's lines go.
    pub csv: Option<Sink>,
    /// To whoever looks on; those that do not fit are not shown.
    pub shown: Option<Producer<Record>>,
}

struct Book {
    ledger: Ledger,
    records: Consumer<Record>,
    arrivals: Consumer<Arrival>,
    to: Onward,
}

impl Book {
    fn keep(mut self, stop: &AtomicBool) -> Result<Ledger, DatasetError> {
        // After an error the rings are emptied all the same, so that the figures of the run are whole.
        let mut failed = self.write(HEADING).err();
        loop {
            let last = stop.load(Ordering::Acquire);
            self.take();
            if last {
                self.ledger.end();
            }
            let lines = self.ledger.lines();
            if failed.is_none() {
                failed = self.write(&lines).err();
            }
            if last {
                break;
            }
            std::thread::sleep(TURN);
        }
        if let Some(error) = failed {
            return Err(error);
        }
        self.to.csv.map_or(Ok(()), Sink::close)?;
        Ok(self.ledger)
    }

    fn take(&mut self) {
        // An arrival may be here before the record of its sending, never long after: the ledger waits for both.
        while let Ok(arrival) = self.arrivals.pop() {
            self.ledger.arrival(arrival);
        }
        while let Ok(record) = self.records.pop() {
            self.ledger.record(record);
            if let Some(shown) = &mut self.to.shown {
                let _ = shown.push(record);
            }
        }
        self.ledger.settle();
    }

    fn write(&mut self, lines: &str) -> Result<(), DatasetError> {
        self.to.csv.as_mut().map_or(Ok(()), |csv| csv.put(lines.as_bytes()))
    }
}
