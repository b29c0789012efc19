//! A firmware's own estimate.

use std::collections::VecDeque;

use super::record::{Moment, Record};
use crate::ahrs::Kind;
use crate::board::Estimator;
use crate::sample::Sample;

/// Runs an estimator on samples at times of the firmware's clock, and keeps what comes of it.
pub(super) struct Own {
    estimator: Estimator,
    /// The senders' times of gyro readings that are held back while periods are measured.
    said_us: VecDeque<Option<u64>>,
    fresh: Vec<(u64, [f64; 4])>,
}

impl Own {
    pub(super) fn new(kind: Kind, declination_rad: f64) -> Self {
        Self { estimator: Estimator::new(kind, declination_rad), said_us: VecDeque::new(), fresh: Vec::new() }
    }

    /// Takes a sample whose `t_us` is the firmware's time of it.
    pub(super) fn take(&mut self, sample: &Sample, said_us: Option<u64>, record: &mut Record) {
        if sample.gyro.is_some() {
            self.said_us.push_back(said_us);
        }
        self.estimator.take(sample, &mut self.fresh);
        for (t_us, attitude) in self.fresh.drain(..) {
            let said_us = self.said_us.pop_front().flatten();
            record.history.push(Moment { t_us, said_us, attitude });
        }
    }
}
