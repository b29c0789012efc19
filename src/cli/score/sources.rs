//! Where truth and estimates come from: folders, files, filters.

use super::units::{self, Unit};
use super::{Arguments, Estimates, Refusal, Source, hints};
use crate::cli::progress::Bar;
use crate::dataset::{self, read as stored};
use crate::filters::{self, FILTERS, FilterKind, SIX, Stream, Streams};
use crate::geometry::Axes;
use crate::scene::{Plan, nearest};
use crate::score::{self, AttitudeTrack, Clock, Reading, Recorded, Series};
use crate::sensor::SensorKind;
use crate::table::{TimeUnit, Times};
use crate::time::SimTime;
use std::cell::RefCell;
use std::path::{Path, PathBuf};

/// What estimates are set against.
pub(super) struct Truth {
    pub track: AttitudeTrack,
    pub axes: Axes,
    /// For how long before it the vehicle was held still, where a run's report says so.
    pub rest: SimTime,
    /// The unit of its times.
    pub unit: TimeUnit,
    /// What the user should know of how it was read.
    pub remarks: Vec<String>,
    /// The dataset's folder, where it is one.
    folder: Option<PathBuf>,
}

/// The truth as it was read.
enum Read {
    Dataset(AttitudeTrack, Axes),
    File(Box<Recorded>),
}

/// An estimate as it was read.
enum Given {
    File(PathBuf, Box<Recorded>),
    Filter(&'static FilterKind, bool),
}

/// Reads truth and estimates; every file that cannot be read is told.
pub(super) fn load(arguments: &Arguments, bar: &Bar) -> Result<(Truth, Vec<Source>), Refusal> {
    let path = &arguments.truth;
    bar.step(format!("reads {}", path.display()));
    let read = truth(path, arguments)?;
    let axes = match &read {
        Read::Dataset(_, axes) => *axes,
        Read::File(recorded) => recorded.axes,
    };
    let folder = path.is_dir().then(|| path.clone());
    let (mut given, mut mistakes) = (Vec::new(), Vec::new());
    for name in &arguments.estimate {
        bar.step(format!("reads {name}"));
        match estimate(name, folder.as_deref(), axes, arguments) {
            Ok(one) => given.push((name, one)),
            Err(Refusal(why)) => mistakes.push(why),
        }
    }
    if !mistakes.is_empty() {
        return Err(Refusal(mistakes.join("\n")));
    }
    let (unit, units) = choose(path, &read, &given, arguments)?;
    let truth = settled(path, read, axes, unit, folder)?;
    let mut sources: Vec<Source> = Vec::new();
    for ((name, given), unit) in given.into_iter().zip(units) {
        let mut source = match given {
            Given::File(path, recorded) => file(&truth, name, &path, *recorded, unit)?,
            Given::Filter(kind, with_mag) => {
                bar.step(format!("runs {name}"));
                run(&truth, name, kind, with_mag)?
            }
        };
        source.name = unlike(source.name, &sources);
        sources.push(source);
    }
    Ok((truth, sources))
}

/// A name that no other source has.
fn unlike(name: String, others: &[Source]) -> String {
    let alike = |other: &&Source| other.name == name || other.name.starts_with(&format!("{name}-"));
    let taken = others.iter().filter(alike).count();
    if others.iter().any(|other| other.name == name) { format!("{name}-{}", taken + 1) } else { name }
}

fn reading(arguments: &Arguments, axes: Axes) -> Reading {
    Reading { axes: arguments.axes.unwrap_or(axes), columns: arguments.columns.choice() }
}

/// Reads the truth: of a dataset with its manifest, or of any file of time and attitude.
fn truth(path: &Path, arguments: &Arguments) -> Result<Read, Refusal> {
    let beside = path.parent().map(|folder| folder.join("manifest.json"));
    let is_dataset =
        path.is_dir() || (path.ends_with("truth.csv") && beside.is_some_and(|file| file.exists()));
    if !is_dataset {
        return Ok(Read::File(Box::new(score::read_as(path, &reading(arguments, Axes::default()))?)));
    }
    let truth = stored::truth(path)?;
    let track =
        AttitudeTrack::new(truth.attitudes).map_err(|why| Refusal(format!("{}: {why}", path.display())))?;
    Ok(Read::Dataset(track, truth.axes))
}

/// The truth with its times.
fn settled(
    path: &Path,
    read: Read,
    axes: Axes,
    unit: TimeUnit,
    folder: Option<PathBuf>,
) -> Result<Truth, Refusal> {
    let refuse = |why: String| Refusal(format!("{}: {why}", path.display()));
    let (track, remarks) = match read {
        Read::Dataset(track, _) => (track, Vec::new()),
        Read::File(recorded) => {
            if !recorded.times.breaks.is_empty() {
                let why = recorded.remarks.last().cloned().unwrap_or_default();
                return Err(refuse(format!("{why}: a truth has one clock; cut the file there")));
            }
            let (series, remarks) = timed(*recorded, unit, None).map_err(refuse)?;
            (AttitudeTrack::of(series).map_err(|why| refuse(why.to_string()))?.with_gaps(), remarks)
        }
    };
    let rest = folder.as_deref().and_then(stored::rest).unwrap_or(SimTime::ZERO);
    Ok(Truth { track, axes, rest, unit, remarks, folder })
}

/// Reads one estimate, or names the filter.
fn estimate(name: &str, folder: Option<&Path>, axes: Axes, arguments: &Arguments) -> Result<Given, Refusal> {
    let path = Path::new(name);
    if let Some((kind, with_mag)) = filters::from_name(name).filter(|_| !path.exists()) {
        let lacking =
            || Refusal(format!("the filter {name} needs readings: give a dataset's folder as the truth"));
        folder.ok_or_else(lacking)?;
        return Ok(Given::Filter(kind, with_mag));
    }
    if !path.exists() {
        let names = FILTERS.map(|kind| kind.name);
        let near = nearest(name, names).map_or(String::new(), |near| format!("; did you mean `{near}`?"));
        return Err(Refusal(format!(
            "`{name}` is neither a file nor a filter ({}, each also with {SIX}){near}",
            names.join(", ")
        )));
    }
    // A recording of `listen` is in the program's own axes, whatever the truth's are.
    let axes = if dataset::is_recording(path) { Axes::NedFrd } else { axes };
    let path = if path.is_dir() { path.join("estimate.csv") } else { path.to_path_buf() };
    let recorded = score::read_as(&path, &reading(arguments, axes))?;
    Ok(Given::File(path, Box::new(recorded)))
}

/// The units of the truth's times and of each estimate's.
fn choose(
    path: &Path,
    read: &Read,
    given: &[(&String, Given)],
    arguments: &Arguments,
) -> Result<(TimeUnit, Vec<TimeUnit>), Refusal> {
    let told = arguments.time_unit;
    let place = path.display().to_string();
    let ours = match read {
        Read::Dataset(track, _) => Times::of_ns([track.first().0, track.last().0]),
        Read::File(_) => Times::default(),
    };
    let truth = match read {
        Read::Dataset(..) => Unit { name: &place, column: "t_ns", times: &ours, told },
        Read::File(read) => Unit { name: &place, column: &read.time_name, times: &read.times, told },
    };
    let files: Vec<Unit<'_>> = given
        .iter()
        .map(|(name, given)| match given {
            Given::File(_, read) => Unit { name, column: &read.time_name, times: &read.times, told },
            // A filter's times are the dataset's.
            Given::Filter(..) => truth,
        })
        .collect();
    units::choose(&truth, &files)
}

/// What a file holds at the times that a unit makes of them: of several clocks that follow each other, or of times that
/// jump by more than `longest` ns, the longest stretch.
fn timed(recorded: Recorded, unit: TimeUnit, longest: Option<i64>) -> Result<(Series, Vec<String>), String> {
    let Recorded { attitudes, times, time_name, mut remarks, .. } = recorded;
    if times.unit.is_none() {
        remarks.push(format!("its column `{time_name}` is read as {unit}"));
    }
    let ns = times.in_ns(unit).ok_or_else(|| format!("its times, read as {unit}, are beyond 292 years"))?;
    let all = ns.len();
    let is_jump = |pair: &[i64]| longest.is_some_and(|longest| pair[1].saturating_sub(pair[0]) > longest);
    let jumps = ns.windows(2).enumerate().filter(|(_, pair)| is_jump(pair)).map(|(i, _)| i + 1);
    let mut cuts: Vec<usize> = times.breaks.iter().copied().chain(jumps).chain([0, all]).collect();
    cuts.sort_unstable();
    cuts.dedup();
    let series = Series::of(ns, attitudes);
    let stretch =
        cuts.windows(2).map(|pair| pair[0]..pair[1]).max_by_key(|range| range.len()).unwrap_or(0..all);
    if stretch.len() == all {
        return Ok((series, remarks));
    }
    remarks.push(format!(
        "its clock jumps {} times: of its {all} rows only the longest stretch, {} rows from row {}, is judged",
        cuts.len() - 2,
        stretch.len(),
        stretch.start + 1
    ));
    Ok((series.part(stretch), remarks))
}

fn file(
    truth: &Truth,
    name: &str,
    path: &Path,
    recorded: Recorded,
    unit: TimeUnit,
) -> Result<Source, Refusal> {
    // A dot would end the name in a limit's field.
    let stem = path.file_stem().map_or(name.into(), |stem| stem.to_string_lossy().replace('.', "-"));
    let (axes, rows) = (recorded.axes, recorded.rows.clone());
    let mut recorded = recorded;
    let others = std::mem::take(&mut recorded.others);
    // Rows before and after cannot both be within the truth.
    let longest = truth.track.last() - truth.track.first() + SimTime(1_000_000_000);
    let whole = recorded.attitudes.len();
    let times = if others.is_empty() { None } else { recorded.times.in_ns(unit) };
    let (series, remarks) =
        timed(recorded, unit, Some(longest.0)).map_err(|why| Refusal(format!("{name}: {why}")))?;
    let others = match times {
        // Of part of a file the other readings are not looked through.
        Some(times) if series.len() == whole => {
            others.into_iter().map(|(what, attitudes)| (what, Series::of(times.clone(), attitudes))).collect()
        }
        _ => Vec::new(),
    };
    // An estimate in the dataset's own folder is the dataset's.
    let is_ours = truth.folder.as_deref().is_some_and(|folder| is_within(path, folder));
    Ok(Source {
        name: stem,
        source: name.to_string(),
        clock: if is_ours { Clock::Truth } else { Clock::Auto },
        time_unit: unit,
        rows: Some(rows),
        recorded: Estimates { series, others, axes, remarks },
        hints: truth.known(false),
    })
}

/// Whether a file is the estimate that a dataset's manifest lists.
fn is_within(path: &Path, folder: &Path) -> bool {
    let same =
        |a: &Path, b: &Path| a.canonicalize().ok().zip(b.canonicalize().ok()).is_some_and(|(a, b)| a == b);
    path.file_stem().is_some_and(|stem| stem == "estimate")
        && path.parent().is_some_and(|parent| same(parent, folder))
        && folder.join("manifest.json").exists()
}

impl Truth {
    /// What is known of an estimate that was made with it.
    fn known(&self, without_mag: bool) -> hints::Known {
        let folder = self.folder.as_deref();
        hints::Known {
            declination_deg: folder.and_then(|folder| declination(folder).ok()).map(f64::to_degrees),
            without_mag: without_mag || folder.is_some_and(|folder| !stored::has(folder, SensorKind::Mag)),
        }
    }
}

/// Runs a filter on a dataset's readings, which are read meanwhile.
fn run(truth: &Truth, name: &str, kind: &FilterKind, with_mag: bool) -> Result<Source, Refusal> {
    let Some(folder) = &truth.folder else { return Err(Refusal(name.to_string())) };
    for sensor in [SensorKind::Gyro, SensorKind::Accel] {
        if !stored::has(folder, sensor) {
            let folder = folder.display();
            return Err(Refusal(format!("the filter {name} needs {sensor} readings, but {folder} has none")));
        }
    }
    let failed = RefCell::new(None);
    let of = |sensor: SensorKind| -> Result<Stream<'_>, Refusal> {
        if !stored::has(folder, sensor) {
            return Ok(Box::new(std::iter::empty()));
        }
        let readings = stored::as_read(folder, sensor)?;
        let failed = &failed;
        Ok(Box::new(readings.map_while(move |reading| match reading {
            Ok(reading) => Some(reading),
            Err(error) => {
                failed.borrow_mut().get_or_insert(error);
                None
            }
        })))
    };
    let has_mag = stored::has(folder, SensorKind::Mag);
    let mag = if with_mag { of(SensorKind::Mag)? } else { Box::new(std::iter::empty()) };
    let streams = Streams { gyro: of(SensorKind::Gyro)?, accel: of(SensorKind::Accel)?, mag };
    let mut series = Series::default();
    let options = filters::Options { with_mag, declination: declination(folder)?, start: None };
    filters::run_as_read(kind, streams, &options, |t, attitude| series.push(t.0, attitude));
    if let Some(error) = failed.into_inner() {
        return Err(error.into());
    }
    let lacks = with_mag && !has_mag;
    let remarks = if lacks {
        vec!["the dataset has no magnetometer: heading is relative to its start".to_string()]
    } else {
        Vec::new()
    };
    Ok(Source {
        name: name.to_string(),
        source: name.to_string(),
        clock: Clock::Sample,
        time_unit: TimeUnit::Ns,
        rows: None,
        recorded: Estimates { series, others: Vec::new(), axes: Axes::NedFrd, remarks },
        hints: truth.known(!with_mag || lacks),
    })
}

/// How far east of true north the scene's field points, rad: a filter is told it, as a controller is.
fn declination(folder: &Path) -> Result<f64, Refusal> {
    let scene = folder.join("scene.toml");
    let plan = Plan::load(&scene.display().to_string(), &[])?;
    let truth = plan.trajectory.at(SimTime::ZERO);
    let field = truth.attitude.apply(truth.field).v;
    Ok(libm::atan2(field.y, field.x))
}
