//! The far end: whoever receives the stream, noting when each sample came.

use crate::clock::{Clock, WallClock};
use crate::os;
use crate::sensor::SensorKind;
use crate::time::SimTime;
use crate::wire::Protocol;
use crate::wire::samples::Samples;
use ratetable_firmware_host_tests::board::{Arrival as Read, Device, Port};
use rtrb::Producer;
use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

/// Below that of the pacing thread.
const PRIORITY: i32 = 40;
/// A turn of its loop.
const TURN: Duration = Duration::from_millis(20);

/// A sample came.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Arrival {
    /// Of which sensor.
    pub kind: SensorKind,
    /// When its packet was due in the scene, as the packet says: in whole µs, rounded down, where it is no text.
    pub t: SimTime,
    /// When it was there, ns of the run's clock.
    pub at: i64,
}

/// Decodes what comes and hands it on without waiting.
pub struct Arrivals {
    samples: Samples,
    clock: WallClock,
    ring: Producer<Arrival>,
    came: u64,
    /// What did not fit.
    unrecorded: u64,
}

/// What came altogether.
#[derive(Clone, Copy, Debug, Default)]
pub struct Came {
    /// Samples.
    pub samples: u64,
    /// Packets missing by their sequence numbers, where they have such.
    pub lost_seq: Option<u64>,
    /// Damaged ones.
    pub damaged: u64,
    /// Arrivals that could not be handed on.
    pub unrecorded: u64,
}

impl Arrivals {
    /// Of a stream of this protocol.
    pub fn new(protocol: Protocol, clock: WallClock, ring: Producer<Arrival>) -> Arrivals {
        Arrivals { samples: Samples::new(protocol), clock, ring, came: 0, unrecorded: 0 }
    }

    /// Takes in what has just been read.
    pub fn take(&mut self, bytes: &[u8]) {
        let at = self.clock.now();
        let Arrivals { samples, ring, came, unrecorded, .. } = self;
        samples.feed(bytes, |sample| {
            let Some(t) = sample.t else { return };
            *came += 1;
            *unrecorded += u64::from(ring.push(Arrival { kind: sample.kind, t, at }).is_err());
        });
    }

    /// What came.
    pub fn came(&self) -> Came {
        let counts = self.samples.counts();
        Came {
            samples: self.came,
            lost_seq: counts.numbered.then_some(counts.lost),
            damaged: counts.damaged,
            unrecorded: self.unrecorded,
        }
    }
}

/// A thread that reads a pty by its path, as firmware would.
pub struct Reader {
    stop: Arc<AtomicBool>,
    thread: JoinHandle<io::Result<Came>>,
}

impl Reader {
    /// Starts on the terminal at `path`.
    pub fn start(path: PathBuf, mut arrivals: Arrivals) -> Reader {
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = stop.clone();
        let body = move || {
            // A firmware has a processor of its own: where it is allowed, this one goes before ordinary work.
            let _ = os::set_realtime_priority(PRIORITY);
            os::set_punctual_sleep();
            let mut port = Device::open(&path, None)?;
            let mut bytes = [0; 4096];
            while !stopped.load(Ordering::Relaxed) {
                match port.read(&mut bytes, TURN)? {
                    Read::Bytes(count) => arrivals.take(&bytes[..count]),
                    Read::Idle => {}
                    Read::Closed => break,
                }
            }
            Ok(arrivals.came())
        };
        Reader { stop, thread: std::thread::spawn(body) }
    }

    /// Ends it.
    ///
    /// # Errors
    /// What the terminal said.
    pub fn end(self) -> io::Result<Came> {
        self.stop.store(true, Ordering::Relaxed);
        self.thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    }
}
