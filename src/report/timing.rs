//! The additional report of `timing`.

use super::{Late, Limit, Report, Spread, Times};
use crate::time::Rate;
use serde::Serialize;

/// A run's report with the same figures for the other end and for a bare timer.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct TimingReport {
    /// The report of the run.
    #[serde(flatten)]
    pub run: Report,
    /// The receiver: a reader on the pty, or the port itself through a loopback plug; absent if only the sending
    /// side was measured.
    pub received_by: Option<&'static str>,
    /// The bare timer.
    pub baseline: Baseline,
    /// p99 lateness of the gyro (without one, of the first sensor) divided by that of the bare timer.
    pub ratio_p99: Option<f64>,
    /// Samples and wake-ups missing from `timing.csv` because the disk was too slow.
    pub unrecorded: u64,
}

impl TimingReport {
    /// A report with every possible field, to check limits against: those of a run of this shape, and more.
    pub fn shape(mut run: Report) -> TimingReport {
        run.sensors.iter_mut().for_each(|sensor| sensor.timing = Some(SensorTiming::shape()));
        run.attitude = None;
        TimingReport {
            run,
            received_by: None,
            baseline: Baseline { late_us: Some(Late::default()), ..Baseline::default() },
            ratio_p99: Some(0.0),
            unrecorded: 0,
        }
    }

    /// Adds to a judged run what the other end missed, and broken limits.
    ///
    /// # Errors
    /// The report cannot be written as JSON.
    pub fn judge(&mut self, limits: &[Limit]) -> serde_json::Result<()> {
        let missed = self.run.sensors.iter().filter_map(|sensor| {
            let missed = sensor.timing?.missed?;
            // Dropped samples are reported already.
            (missed > sensor.dropped).then(|| format!("sensors.{}.missed = {missed} > 0", sensor.name))
        });
        let missed: Vec<_> = missed.collect();
        self.run.failed.extend(missed);
        let value = serde_json::to_value(&*self)?;
        self.run.failed.extend(limits.iter().filter_map(|limit| limit.broken(&value)));
        self.run.ok = self.run.failed.is_empty();
        Ok(())
    }
}

/// A loop that only sleeps until the next tick of the gyro's rate, on the pacing thread, between the slices of the
/// stream.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Baseline {
    /// Its rate, Hz.
    pub rate_hz: f64,
    /// Wake-ups.
    pub wakes: u64,
    /// Wake-ups late by more than a whole period.
    pub overdue: u64,
    /// Time after the wake-up minus the due time, µs.
    pub late_us: Option<Late>,
}

impl Baseline {
    /// The baseline for this lateness at this rate.
    pub fn new(late: &Times, rate: Rate) -> Baseline {
        Baseline {
            rate_hz: rate.as_hz(),
            wakes: late.count(),
            overdue: late.above((rate.period() * 1e9) as i64),
            late_us: late.late(),
        }
    }
}

/// The additional figures of `timing` for a sensor.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct SensorTiming {
    /// `sent_hz` relative to `rate_hz`, parts per million of the monotonic clock.
    pub sent_ppm: Option<f64>,
    /// `received_hz` relative to `rate_hz`.
    pub received_ppm: Option<f64>,
    /// Samples sent late by more than a whole period of their sensor.
    pub overdue: u64,
    /// Samples that arrived; absent if nothing is received.
    pub received: Option<u64>,
    /// Samples made for the link that did not arrive.
    pub missed: Option<u64>,
    /// Time from just before the write call to just after the receiver's read, µs.
    pub transit_us: Option<Spread>,
}

impl SensorTiming {
    /// An entry with every possible field.
    fn shape() -> SensorTiming {
        SensorTiming {
            sent_ppm: Some(0.0),
            received_ppm: Some(0.0),
            overdue: 0,
            received: Some(0),
            missed: Some(0),
            transit_us: Some(Spread::default()),
        }
    }
}
