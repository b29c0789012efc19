//! The estimator, and the measuring of periods before it can start.

use crate::ahrs::{Ahrs, Kind, Periods};
use crate::sample::Sample;

/// Gyro readings to hold back while the periods are measured.
const HELD_READINGS: usize = 50;

/// The longest that samples are held back, µs of sample time.
const HELD_US: u64 = 1_000_000;

/// Gathers samples until each sensor's period is known, then estimates.
///
/// A firmware knows the rates that it has set; this one measures them, and puts the samples that
/// it held back through the estimator once it can be built, so none is lost.
pub(crate) struct Estimator {
    kind: Kind,
    declination_rad: f64,
    held: Vec<Sample>,
    running: Option<Running>,
}

/// An estimator that has started.
struct Running {
    ahrs: Box<dyn Ahrs + Send>,
    last_gyro_us: Option<u64>,
}

impl Estimator {
    pub(crate) fn new(kind: Kind, declination_rad: f64) -> Self {
        Self { kind, declination_rad, held: Vec::new(), running: None }
    }

    /// Takes a sample; adds an attitude to `history` after each gyro reading.
    pub(crate) fn take(&mut self, sample: &Sample, history: &mut Vec<(u64, [f64; 4])>) {
        if let Some(running) = &mut self.running {
            running.take(sample, history);
            return;
        }
        self.held.push(*sample);
        if is_enough(&self.held) {
            self.settle(history);
        }
    }

    /// Starts with what is known by now, and puts the held samples through.
    pub(crate) fn settle(&mut self, history: &mut Vec<(u64, [f64; 4])>) {
        if self.running.is_some() || self.held.is_empty() {
            return;
        }
        let ahrs = self.kind.build(periods(&self.held), self.declination_rad);
        let mut running = Running { ahrs, last_gyro_us: None };
        for sample in self.held.drain(..) {
            running.take(&sample, history);
        }
        self.running = Some(running);
    }

    /// The attitude by now, once it has started.
    pub(crate) fn attitude(&self) -> Option<[f64; 4]> {
        self.running.as_ref().map(|running| running.ahrs.attitude())
    }
}

impl Running {
    /// Gives a sample's readings to the filter, in the order gyro, accelerometer, magnetometer.
    fn take(&mut self, sample: &Sample, history: &mut Vec<(u64, [f64; 4])>) {
        if let Some(rate) = sample.gyro {
            let last = self.last_gyro_us.replace(sample.t_us).unwrap_or(sample.t_us);
            let dt_us = sample.t_us.saturating_sub(last);
            self.ahrs.gyro(dt_us as f64 * 1e-6, rate);
            history.push((sample.t_us, self.ahrs.attitude()));
        }
        if let Some(force) = sample.accel {
            self.ahrs.accel(force);
        }
        if let Some(field) = sample.mag {
            self.ahrs.mag(field);
        }
    }
}

/// Whether the periods of the sensors that are there can be told.
fn is_enough(held: &[Sample]) -> bool {
    let span_us = match held {
        [first, .., last] => last.t_us.saturating_sub(first.t_us),
        _ => 0,
    };
    let gyro = held.iter().filter(|sample| sample.gyro.is_some()).count();
    let one = |present: fn(&Sample) -> bool| held.iter().filter(|s| present(s)).count() == 1;
    let waiting = one(|sample| sample.accel.is_some()) || one(|sample| sample.mag.is_some());
    span_us >= HELD_US || (gyro >= HELD_READINGS && !waiting)
}

/// Each sensor's period: the median of its intervals, or the default where there are none.
fn periods(held: &[Sample]) -> Periods {
    let default = Periods::default();
    let period = |present: fn(&Sample) -> bool, default: f64| {
        let times: Vec<u64> = held.iter().filter(|s| present(s)).map(|s| s.t_us).collect();
        median_interval_s(&times).unwrap_or(default)
    };
    Periods {
        gyro_s: period(|sample| sample.gyro.is_some(), default.gyro_s),
        accel_s: period(|sample| sample.accel.is_some(), default.accel_s),
        mag_s: period(|sample| sample.mag.is_some(), default.mag_s),
    }
}

/// The median of the positive intervals between times in µs, s.
fn median_interval_s(times: &[u64]) -> Option<f64> {
    let pairs = times.windows(2);
    let mut intervals: Vec<u64> =
        pairs.map(|pair| pair[1].saturating_sub(pair[0])).filter(|&interval| interval > 0).collect();
    intervals.sort_unstable();
    intervals.get(intervals.len() / 2).map(|&median| median as f64 * 1e-6)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn periods_are_measured_in_spite_of_a_loss() {
        let mut held = Vec::new();
        for k in (0..60_u64).filter(|&k| k != 7) {
            let due = |every| (k % every == 0).then_some([0.0, 0.0, 1.0]);
            held.push(Sample { t_us: k * 1000, gyro: due(1), accel: due(2), mag: due(10) });
        }
        let expected = Periods { gyro_s: 0.001, accel_s: 0.002, mag_s: 0.01 };
        let found = periods(&held);
        assert!((found.gyro_s - expected.gyro_s).abs() < 1e-12);
        assert!((found.accel_s - expected.accel_s).abs() < 1e-12);
        assert!((found.mag_s - expected.mag_s).abs() < 1e-12);
    }

    #[test]
    fn no_held_sample_is_lost() {
        let mut estimator = Estimator::new(Kind::Vqf, 0.0);
        let mut history = Vec::new();
        for k in 0..200 {
            let gyro = Some([0.0; 3]);
            let sample = Sample { t_us: k * 1000, gyro, ..Sample::default() };
            estimator.take(&sample, &mut history);
        }
        assert_eq!(history.len(), 200);
        assert!(history.windows(2).all(|pair| pair[0].0 < pair[1].0));
    }
}
