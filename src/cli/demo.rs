//! The other end of the demonstration: a driver and an AHRS that open the pty by its path, as firmware would.

use crate::earth;
use crate::os;
use crate::report::SensorReport;
use crate::scene::Plan;
use ratetable_firmware_host_tests::board::{Board, Options, Step};
use ratetable_firmware_host_tests::driver::{Counts, Protocol};
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// How often it answers with its attitude, in sample time.
const ANSWER_EVERY_US: u64 = 20_000;
/// Below that of the pacing thread.
const PRIORITY: i32 = 40;
/// A turn of its loop.
const TURN: Duration = Duration::from_millis(20);

/// A firmware at work in a thread of its own.
pub struct Firmware {
    stop: Arc<AtomicBool>,
    thread: JoinHandle<io::Result<Received>>,
}

/// What it received.
#[derive(Clone, Debug, Default)]
pub struct Received {
    /// Packets, damage, losses.
    pub counts: Counts,
    /// First and last arrival and count, of gyro, accel, mag.
    arrivals: [Option<(Instant, Instant, u64, u64)>; 3],
}

impl Firmware {
    /// Starts on the pty at `path`; it knows the field's declination, as any firmware is told.
    pub fn start(path: &str, plan: &Plan) -> Firmware {
        let stop = Arc::new(AtomicBool::new(false));
        let options = Options {
            declination_rad: earth::declination(plan.trajectory.field()),
            answer_every_us: Some(ANSWER_EVERY_US),
            quiet: None,
            ..Options::default()
        };
        let (path, stopped) = (path.to_string(), stop.clone());
        Firmware { stop, thread: std::thread::spawn(move || receive(&path, options, &stopped)) }
    }

    /// Ends it and gives back what it received.
    ///
    /// # Errors
    /// What its link said.
    pub fn end(self) -> io::Result<Received> {
        self.stop.store(true, Ordering::Relaxed);
        self.thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    }
}

fn receive(path: &str, options: Options, stop: &AtomicBool) -> io::Result<Received> {
    // A firmware has a processor of its own: where it is allowed, this one goes before ordinary work.
    let _ = os::set_realtime_priority(PRIORITY);
    let mut board = Board::open(path, Protocol::Mpu, options)?;
    let mut received = Received::default();
    while !stop.load(Ordering::Relaxed) {
        match board.step(TURN)? {
            Step::Data { .. } => received.see(board.report().counts, Instant::now()),
            Step::Idle => {}
            Step::Closed => break,
        }
        // Its estimates were answered; nobody here looks back at them.
        drop(board.take_history());
    }
    Ok(received)
}

impl Received {
    fn see(&mut self, counts: Counts, now: Instant) {
        let totals = [counts.gyro, counts.accel, counts.mag];
        for (arrival, total) in self.arrivals.iter_mut().zip(totals) {
            match arrival {
                None if total > 0 => *arrival = Some((now, now, total, total)),
                Some((_, last, _, seen)) if total > *seen => (*last, *seen) = (now, total),
                _ => {}
            }
        }
        self.counts = counts;
    }

    /// Adds the rates at this end to the report, (n − 1)/(t_last − t_first), and the packets missed.
    pub fn add_to(&self, sensors: &mut [SensorReport], links: &mut [crate::report::LinkReport]) {
        for sensor in sensors {
            let index = ["gyro", "accel", "mag"].iter().position(|name| *name == sensor.name);
            // What its registers do not have, it does not receive.
            let Some(index) = index else { continue };
            sensor.received_hz = self.arrivals[index].and_then(|(first, last, before, total)| {
                let span = last.duration_since(first).as_secs_f64();
                (span > 0.0).then(|| (total - before) as f64 / span)
            });
        }
        for link in links {
            link.lost_seq = Some(self.counts.lost);
            link.crc_errors += self.counts.damaged;
        }
    }
}
