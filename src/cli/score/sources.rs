//! Where truth and estimates come from: folders, files, filters.

use super::{Refusal, Source};
use crate::dataset::read::{self as stored, readings};
use crate::filters::{self, FILTERS, Readings, SIX};
use crate::geometry::Axes;
use crate::scene::{Plan, nearest};
use crate::score::{self, Recorded, Stamp, Timed, Track};
use crate::sensor::SensorKind;
use crate::time::SimTime;
use std::path::{Path, PathBuf};

/// What estimates are set against.
pub(super) struct Truth {
    pub track: Track,
    pub axes: Axes,
    /// The dataset's folder, where it is one.
    folder: Option<PathBuf>,
}

/// Reads the truth: of a dataset with its manifest, or of any file of time and attitude.
pub(super) fn truth(path: &Path, axes: Option<Axes>) -> Result<Truth, Refusal> {
    let beside = path.parent().map(|folder| folder.join("manifest.json"));
    let is_dataset =
        path.is_dir() || (path.ends_with("truth.csv") && beside.is_some_and(|file| file.exists()));
    let (rows, axes) = if is_dataset {
        let truth = stored::truth(path)?;
        (truth.attitudes, truth.axes)
    } else {
        let axes = axes.unwrap_or_default();
        let Recorded { estimates, axes, .. } = score::read(path, axes)?;
        (estimates.iter().map(|estimate| (estimate.arrival, estimate.attitude)).collect(), axes)
    };
    let track = Track::new(rows).map_err(|why| Refusal(format!("{}: {why}", path.display())))?;
    Ok(Truth { track, axes, folder: path.is_dir().then(|| path.to_path_buf()) })
}

/// Reads the files and runs the filters; every one that cannot be is told.
pub(super) fn estimates(truth: &Truth, names: &[String], axes: Option<Axes>) -> Result<Vec<Source>, Refusal> {
    let mut data = None;
    let mut sources: Vec<Source> = Vec::new();
    let mut mistakes = Vec::new();
    for name in names {
        let found = match filters::from_name(name) {
            Some(_) if !Path::new(name).exists() => run(truth, name, &mut data),
            _ => file(truth, name, axes),
        };
        match found {
            Ok(mut source) => {
                let taken = sources.iter().filter(|other| {
                    other.name == source.name || other.name.starts_with(&format!("{}-", source.name))
                });
                let taken = taken.count();
                if taken > 0 && sources.iter().any(|other| other.name == source.name) {
                    source.name = format!("{}-{}", source.name, taken + 1);
                }
                sources.push(source);
            }
            Err(Refusal(why)) => mistakes.push(why),
        }
    }
    if mistakes.is_empty() { Ok(sources) } else { Err(Refusal(mistakes.join("\n"))) }
}

fn file(truth: &Truth, name: &str, axes: Option<Axes>) -> Result<Source, Refusal> {
    let path = Path::new(name);
    if !path.exists() {
        let names = FILTERS.map(|kind| kind.name);
        let near = nearest(name, names).map_or(String::new(), |near| format!("; did you mean `{near}`?"));
        return Err(Refusal(format!(
            "`{name}` is neither a file nor a filter ({}, each also with {SIX}){near}",
            names.join(", ")
        )));
    }
    let path = if path.is_dir() { path.join("estimate.csv") } else { path.to_path_buf() };
    let recorded = score::read(&path, axes.unwrap_or(truth.axes))?;
    // A dot would end the name in a limit's field.
    let stem = path.file_stem().map_or(name.into(), |stem| stem.to_string_lossy().replace('.', "-"));
    Ok(Source { name: stem, source: name.to_string(), recorded })
}

/// What filters run on: the dataset's readings and its declination.
type Data = (Readings, f64);

fn run(truth: &Truth, name: &str, data: &mut Option<Data>) -> Result<Source, Refusal> {
    let Some((kind, with_mag)) = filters::from_name(name) else { return Err(Refusal(name.to_string())) };
    let Some(folder) = &truth.folder else {
        return Err(Refusal(format!(
            "the filter {name} needs readings: give a dataset's folder as the truth"
        )));
    };
    if data.is_none() {
        *data = Some((of_dataset(folder)?, declination(folder)?));
    }
    let Some((readings, declination)) = data else { return Err(Refusal(name.to_string())) };
    for (sensor, column) in [("gyro", &readings.gyro), ("accel", &readings.accel)] {
        if column.is_empty() {
            return Err(Refusal(format!(
                "the filter {name} needs readings of {sensor}, and {} has none",
                folder.display()
            )));
        }
    }
    let timed = |(t, attitude): (SimTime, _)| Timed { arrival: t, stamp: Stamp::Sample(t), attitude };
    let estimates = filters::run(kind, readings, with_mag, *declination).into_iter().map(timed).collect();
    let remarks = match with_mag && readings.mag.is_empty() {
        true => vec!["the dataset has no magnetometer: heading is from where it starts".to_string()],
        false => Vec::new(),
    };
    let recorded = Recorded { estimates, axes: Axes::NedFrd, others: Vec::new(), remarks };
    Ok(Source { name: name.to_string(), source: name.to_string(), recorded })
}

fn of_dataset(folder: &Path) -> Result<Readings, Refusal> {
    let of = |kind: SensorKind| match stored::has(folder, kind) {
        true => readings(folder, kind),
        false => Ok(Vec::new()),
    };
    Ok(Readings { gyro: of(SensorKind::Gyro)?, accel: of(SensorKind::Accel)?, mag: of(SensorKind::Mag)? })
}

/// How far east of true north the scene's field points, rad: a filter is told it, as a controller is.
fn declination(folder: &Path) -> Result<f64, Refusal> {
    let scene = folder.join("scene.toml");
    let plan = Plan::load(&scene.display().to_string(), &[])?;
    let truth = plan.trajectory.at(SimTime::ZERO);
    let field = truth.attitude.apply(truth.field).v;
    Ok(libm::atan2(field.y, field.x))
}
