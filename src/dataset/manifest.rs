//! `manifest.json`: what a program needs to know of a dataset without reading its numbers.

use super::conventions::conventions;
use super::error::DatasetError;
use super::folder::Folder;
use super::format::Written;
use super::listed::{Holds, MANIFEST, OtherEntry, checksum};
use super::reference::Quality;
use super::run::Run;
use super::table::Column;
use crate::scene::{Drawn, Plan};
use crate::sensor::{FILTER, LOW_PASS, RANGE, Sampling, Segment, SensorPlan, lsb};
use crate::time::SimTime;
use serde::Serialize;
use std::collections::BTreeMap;
use std::io;
use std::path::Path;

/// A file of numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FileEntry {
    /// Its name in the folder.
    pub name: String,
    /// The name of its format.
    pub format: &'static str,
    /// Rows, the header not counted; messages, where it has those.
    pub rows: u64,
    /// Its columns in order; none where the format has something else.
    pub columns: Vec<Column>,
    /// SHA-256 of its bytes, in hexadecimal.
    pub sha256: String,
}

impl FileEntry {
    pub(super) fn of(
        folder: &Folder,
        written: Written,
        format: &'static str,
    ) -> Result<FileEntry, DatasetError> {
        let Written { name, rows, columns } = written;
        let sha256 = checksum(&folder.path(&name))?;
        Ok(FileEntry { name, format, rows, columns, sha256 })
    }
}

#[derive(Serialize)]
struct Manifest<'a> {
    program: &'static str,
    version: &'static str,
    holds: &'static str,
    scene: &'a str,
    seed: u64,
    axes: String,
    duration_ns: i64,
    complete: bool,
    conventions: BTreeMap<&'static str, String>,
    sensors: Vec<SensorEntry>,
    parts: BTreeMap<&'static str, &'static str>,
    drawn: &'a [Drawn],
    faults: Vec<String>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    settings: Vec<SettingEntry>,
    #[serde(skip_serializing_if = "Option::is_none")]
    run: Option<&'a Run>,
    #[serde(skip_serializing_if = "Option::is_none")]
    reference: Option<&'a Quality>,
    files: &'a [FileEntry],
    other_files: Vec<OtherEntry<'a>>,
}

#[derive(Serialize)]
struct SensorEntry {
    name: &'static str,
    unit: &'static str,
    rate: String,
    rate_hz: f64,
    phase_ns: i64,
    sampling: &'static str,
    mount: Option<String>,
    terms: Vec<&'static str>,
    samples: u64,
    clipped: u64,
}

/// From when on a sensor was set to something else.
#[derive(Serialize)]
struct SettingEntry {
    sensor: &'static str,
    /// The first tick with it; where it is off, since when.
    t_ns: i64,
    /// `off` while it takes no samples.
    rate: String,
    /// In the unit of the sensor's columns.
    range: Option<f64>,
    count: Option<f64>,
    low_pass_hz: Option<f64>,
}

/// What was made of a scene.
pub(super) struct Made<'a> {
    pub files: &'a [FileEntry],
    /// The names of the files without numbers.
    pub others: &'a [&'a str],
    /// Samples of each sensor.
    pub samples: &'a [u64],
    /// Clipped samples of each sensor.
    pub clipped: &'a [u64],
    pub quality: Option<&'a Quality>,
    pub run: Option<&'a Run>,
    pub link_faults: &'a [String],
}

/// The manifest of a dataset whose other files are written.
pub(super) fn text(
    plan: &Plan,
    end: SimTime,
    made: &Made<'_>,
    folder: &Folder,
) -> Result<String, DatasetError> {
    let &Made { files, others, samples, clipped, quality, run, link_faults } = made;
    let other = |&name| Ok(OtherEntry { name, sha256: checksum(&folder.path(name))? });
    let part = |sensor: &SensorPlan| sensor.part.map(|part| (sensor.kind.name(), part));
    let manifest = Manifest {
        program: env!("CARGO_PKG_NAME"),
        version: env!("CARGO_PKG_VERSION"),
        holds: Holds::Dataset.name(),
        scene: &plan.name,
        seed: plan.seed,
        axes: plan.axes.to_string(),
        duration_ns: end.0,
        complete: true,
        conventions: conventions(plan),
        sensors: sensors(plan, samples, clipped),
        parts: plan.sensors.iter().filter_map(part).collect(),
        drawn: &plan.drawn,
        faults: [plan.faults_until(end), link_faults.to_vec()].concat(),
        settings: plan.sensors.iter().flat_map(|sensor| settings(sensor, end)).collect(),
        run,
        reference: quality,
        files,
        other_files: others.iter().map(other).collect::<Result<_, DatasetError>>()?,
    };
    let text = serde_json::to_string_pretty(&manifest).map_err(io::Error::other);
    Ok(text.map_err(DatasetError::io("write", Path::new(MANIFEST)))? + "\n")
}

/// What a sensor was set to before `end`.
fn settings(sensor: &SensorPlan, end: SimTime) -> Vec<SettingEntry> {
    if sensor.settings.is_empty() {
        return Vec::new();
    }
    let segments = sensor.segments().into_iter().filter(|segment| segment.from < end);
    let entry = |segment: Segment| {
        let values = &segment.plan.values;
        SettingEntry {
            sensor: sensor.kind.name(),
            t_ns: segment.from.0,
            rate: segment.clock.map_or("off".into(), |_| segment.plan.rate.to_string()),
            range: values.get(RANGE),
            count: lsb(values, sensor.kind),
            low_pass_hz: values.get(FILTER).and_then(|filter| filter.get(LOW_PASS)),
        }
    };
    segments.map(entry).collect()
}

fn sensors(plan: &Plan, samples: &[u64], clipped: &[u64]) -> Vec<SensorEntry> {
    let entry = |((sensor, &samples), &clipped): ((&SensorPlan, &u64), &u64)| SensorEntry {
        name: sensor.kind.name(),
        unit: sensor.kind.unit(),
        rate: sensor.rate.to_string(),
        rate_hz: sensor.rate.as_hz(),
        phase_ns: sensor.phase.0,
        sampling: sampling_name(sensor.sampling),
        mount: sensor.mount.map(|mount| mount.to_string()),
        terms: plan.build(sensor).terms().to_vec(),
        samples,
        clipped,
    };
    plan.sensors.iter().zip(samples).zip(clipped).map(entry).collect()
}

/// As a scene spells it.
pub(super) fn sampling_name(sampling: Sampling) -> &'static str {
    match sampling {
        Sampling::Point => "point",
        Sampling::Average => "average",
    }
}
