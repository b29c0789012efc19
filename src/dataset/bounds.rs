//! How much a dataset comes to, before any of it is made.

use super::table::{self, Table};
use crate::scene::Plan;
use crate::sensor::SensorPlan;
use crate::time::SimTime;
use serde::Serialize;

/// More samples than any disk holds: some hundred terabytes.
const MOST_SAMPLES: u64 = 1_000_000_000_000;
/// The longest number of a table, as of −2.2250738585072014e−308, and the comma before it.
const CELL: u64 = 25;

/// Bounds of a scene played from its start to an end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bounds {
    /// Samples made, of all sensors: exact where no fault withholds some.
    pub samples: u64,
    /// Bytes of a dataset's CSV tables: an upper bound.
    pub bytes: u64,
    /// Seconds of scene.
    pub seconds: f64,
}

impl Bounds {
    /// Of a plan.
    pub fn of(plan: &Plan, end: SimTime) -> Bounds {
        let samples = |sensor: &SensorPlan| sensor.ticks_before(end);
        let all = plan.sensors.iter().map(samples).fold(0, u64::saturating_add);
        let reference =
            plan.reference.map_or(0, |reference| reference.rate().ticks_before(SimTime::ZERO, end));
        let time = end.0.max(1).ilog10() as u64 + 1;
        let rows = |table: &Table| match plan.sensors.iter().find(|sensor| sensor.kind.name() == table.name) {
            Some(sensor) => samples(sensor),
            None if table.name == "reference" => reference.saturating_add(1),
            // The truth has a row at every distinct tick, and at no others.
            None => all,
        };
        let bytes = |table: &Table| {
            let header: usize = table.columns.iter().map(|column| column.name.len() + 1).sum();
            let row = time + 1 + CELL * (table.columns.len() as u64 - 1);
            rows(table).saturating_mul(row).saturating_add(header as u64)
        };
        let bytes = table::of(plan, false).iter().map(bytes).fold(0, u64::saturating_add);
        Bounds { samples: all, bytes, seconds: end.seconds() }
    }

    /// So many times as much.
    pub fn times(self, runs: u64) -> Bounds {
        Bounds {
            samples: self.samples.saturating_mul(runs),
            bytes: self.bytes.saturating_mul(runs),
            seconds: self.seconds * runs as f64,
        }
    }

    /// Why nobody can want so much, if so.
    pub fn absurd(&self) -> Option<String> {
        let Bounds { samples, bytes, seconds } = self;
        (*samples > MOST_SAMPLES).then(|| {
            format!(
                "{samples} samples in {seconds:.3e} s of scene, up to {:.0} TB in CSV, above the limit of {MOST_SAMPLES} samples: use a shorter `duration`, lower rates or fewer runs",
                *bytes as f64 / 1e12
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Options, write};
    use super::*;

    fn plan(scene: &str) -> Plan {
        Plan::parse(scene, "test", "test", &[]).unwrap_or_else(|error| panic!("{error}"))
    }

    #[test]
    fn samples_are_exact_and_no_dataset_is_larger_than_its_bound() {
        let noisy = "seed = 3\nduration = \"1.234 s\"\n[[motion]]\nkind = \"rotate\"\nyaw = \"33 deg/s\"\nduration = \"1 s\"\n[gyro]\nrate = \"1 kHz\"\nnoise_std = \"0.1 deg/s\"\n[mag]\nrate = \"70 Hz\"\nphase = \"3 ms\"\nnoise_std = \"0.1 uT\"\n[baro]\nrate = \"10 Hz\"\n[reference]\nmethod = \"paper\"\nfrom = \"gyro\"\n";
        for (scene, samples) in
            [(noisy, 1234 + 87 + 13), ("duration = \"2 s\"\n[gyro]\nrate = \"400/3 Hz\"\n", 267)]
        {
            let plan = plan(scene);
            let bounds = Bounds::of(&plan, plan.duration);
            let home = tempfile::tempdir().unwrap();
            let out = home.path().join("out");
            write(&plan, plan.duration, &out, Options::new(&mut |_| {})).unwrap();
            let tables = std::fs::read_dir(&out).unwrap().map(Result::unwrap);
            let tables = tables.filter(|file| file.path().extension().is_some_and(|end| end == "csv"));
            let bytes: u64 = tables.map(|file| file.metadata().unwrap().len()).sum();
            assert_eq!(bounds.samples, samples);
            assert!((bytes..10 * bytes).contains(&bounds.bytes), "{bytes} {bounds:?}");
            assert_eq!(bounds.absurd(), None);
        }
    }

    #[test]
    fn what_no_disk_holds_is_absurd_and_a_day_at_full_rate_is_not() {
        let of = |duration: &str| {
            let plan = plan(&format!("duration = \"{duration}\"\n[gyro]\nrate = \"1 MHz\"\n"));
            Bounds::of(&plan, plan.duration)
        };
        assert!(of("2.5e6 h").absurd().is_some_and(|why| why.contains("TB")));
        assert_eq!(of("24 h").absurd(), None);
        assert!(of("24 h").times(100).absurd().is_some());
    }
}
