//! What `timing` reports beyond a run.

use super::{Late, Report, Spread};
use serde::Serialize;

/// A run's report with the same figures for the other end and for a bare timer.
#[derive(Clone, Debug, Serialize)]
pub struct TimingReport {
    /// As of any run.
    #[serde(flatten)]
    pub run: Report,
    /// Who received: a reader on the pty, or the port itself through a loopback plug; absent where only the sending
    /// side was measured.
    pub received_by: Option<&'static str>,
    /// The bare timer.
    pub baseline: Baseline,
    /// p99 lateness of the gyro (without one, of the first sensor) over that of the bare timer.
    pub ratio_p99: Option<f64>,
    /// Samples and wakes that no line of `timing.csv` tells of, because the disk was too slow.
    pub unrecorded: u64,
}

/// A loop that does nothing but sleep until the next tick of the gyro's rate, on the pacing thread, between the
/// slices of the stream.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Baseline {
    /// Its rate, Hz.
    pub rate_hz: f64,
    /// Wake-ups.
    pub wakes: u64,
    /// Those later than a whole period.
    pub overdue: u64,
    /// The moment after the wake-up minus due, µs.
    pub late_us: Option<Late>,
}

/// What `timing` adds to a sensor.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct SensorTiming {
    /// `sent_hz` against `rate_hz`, parts per million of the monotonic clock.
    pub sent_ppm: Option<f64>,
    /// `received_hz` against `rate_hz`.
    pub received_ppm: Option<f64>,
    /// Samples sent later than a whole period of their sensor.
    pub overdue: u64,
    /// Samples that arrived; absent where nothing is received.
    pub received: Option<u64>,
    /// Samples made for the link that did not arrive.
    pub missed: Option<u64>,
    /// From just before the write call to just after the receiver's read, µs.
    pub transit_us: Option<Spread>,
}
