//! What `timing` reports beyond a run.

use super::{Late, Limit, Report, Spread, Times};
use crate::time::Rate;
use serde::Serialize;

/// A run's report with the same figures for the other end and for a bare timer.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
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

impl TimingReport {
    /// With every field that there can be, for limits to be checked against: those of a run of this shape, and more.
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

    /// What a run that has been judged has missed at the other end, and broken limits.
    ///
    /// # Errors
    /// The report cannot be written as JSON.
    pub fn judge(&mut self, limits: &[Limit]) -> serde_json::Result<()> {
        let missed = self.run.sensors.iter().filter_map(|sensor| {
            let missed = sensor.timing?.missed?;
            // What was dropped is told already.
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

/// A loop that does nothing but sleep until the next tick of the gyro's rate, on the pacing thread, between the
/// slices of the stream.
#[derive(Clone, Copy, Debug, Default, Serialize)]
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

impl Baseline {
    /// Of wake-ups this late at this rate.
    pub fn new(late: &Times, rate: Rate) -> Baseline {
        Baseline {
            rate_hz: rate.as_hz(),
            wakes: late.count(),
            overdue: late.above((rate.period() * 1e9) as i64),
            late_us: late.late(),
        }
    }
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

impl SensorTiming {
    /// With every field that there can be.
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
