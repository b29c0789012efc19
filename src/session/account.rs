//! The final account of each output of a run.

use super::feed::Made;
use super::left::Left;
use super::tally::{SensorTally, Tally};
use crate::report::SensorReport;
use crate::sensor::SensorPlan;
use std::io::ErrorKind;

/// What was made for one output, and what happened to it.
#[derive(Debug, Default)]
pub(super) struct Account {
    pub made: Made,
    pub tally: Tally,
    pub left: Left,
    /// Why its link stopped taking packets.
    pub end: Option<ErrorKind>,
}

impl Account {
    /// A sensor's report: counts summed over outputs, histograms merged. `paced` says whether lateness is
    /// meaningful.
    pub(super) fn sensor(accounts: &[Account], sensor: &SensorPlan, paced: bool) -> SensorReport {
        let kind = sensor.kind as usize;
        let sum = |of: fn(&Account, usize) -> u64| accounts.iter().map(|it| of(it, kind)).sum();
        let mut all = SensorTally::default();
        accounts.iter().for_each(|it| all.add(&it.tally.sensors[kind]));
        let sent_hz = accounts.iter().find_map(|it| it.tally.sensors[kind].hz());
        SensorReport {
            name: sensor.kind.name().to_string(),
            rate_hz: sensor.rate.as_hz(),
            sent_hz: sent_hz.filter(|_| paced),
            made: sum(|it, kind| it.made.samples[kind]),
            sent: all.sent,
            dropped: all.dropped,
            replaced: all.replaced,
            merged: all.merged,
            queued: sum(|it, kind| it.left.samples[kind] + it.made.waiting[kind]),
            late_us: all.late.late().filter(|_| paced),
            interval_us: all.interval.interval().filter(|_| paced),
            write_us: all.write.spread(),
            ..SensorReport::default()
        }
    }
}
