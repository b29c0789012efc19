//! What leaving a part out changes in the readings of its sensor.

use super::parts::{Part, What};
use super::variant::Variant;
use crate::motion::Wants;
use crate::scene::{Plan, SceneError};
use crate::sensor::{SensorKind, SensorPlan, lsb, white_noise};
use crate::time::SimTime;

/// How much readings change, on the axis that shows it most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change {
    /// Whose readings.
    pub sensor: SensorKind,
    /// RMS and largest, in counts; `None` for a sensor without counts.
    pub counts: Option<[f64; 2]>,
    /// RMS and largest, in standard deviations of the white noise of a sample; `None` for one without noise.
    pub noise: Option<[f64; 2]>,
    /// Whether it also changes what has neither: which samples there are, a temperature or a velocity beside them.
    pub beside: bool,
}

impl Change {
    /// The largest change as a multiple of what readings can show: half a count or a tenth of the noise, whichever is
    /// more. Rounding is not set against the count, nor noise against the noise.
    pub fn times_shown(&self, part: Part) -> f64 {
        let counts = self.counts.filter(|_| !part.is_term("resolution")).map(|[_, most]| most / HALF_A_COUNT);
        let noise = self.noise.filter(|_| !part.is_term("white_noise")).map(|[_, most]| most / A_TENTH);
        match (counts, noise) {
            (Some(counts), Some(noise)) => counts.min(noise),
            (counts, noise) => counts.or(noise).unwrap_or(f64::INFINITY),
        }
    }
}

/// Below this many counts a change is mostly rounded away.
pub const HALF_A_COUNT: f64 = 0.5;
/// Below this many standard deviations of a sample a change drowns in the noise.
pub const A_TENTH: f64 = 0.1;

/// The change of `part`'s sensor, or of the sensor that shows most of it, from 0 up to `end`, at the scene's own seed.
/// It is taken before the range cuts and the counts round, which would hide or enlarge what is small.
///
/// # Errors
/// A variant that is no scene.
pub fn change(
    part: Part,
    [with, without]: [&Variant; 2],
    end: SimTime,
) -> Result<Option<Change>, SceneError> {
    let besides: &[&str] = match part.what {
        What::Term("resolution") => &[],
        What::Term("range") | What::Faults => &["resolution"],
        _ => &["range", "resolution"],
    };
    let [before, after] = [with.plan(0)?, without.plan(0)?];
    let [with, without] = [played(with, &before, end, besides), played(without, &after, end, besides)];
    let sensors = before.sensors.iter().zip(with.iter().zip(&without));
    let mine = sensors.filter(|(sensor, _)| part.sensor.is_none_or(|kind| kind == sensor.kind));
    let changes = mine.map(|(sensor, (with, without))| between(sensor, with, without));
    Ok(changes.max_by(|a, b| a.times_shown(part).total_cmp(&b.times_shown(part))))
}

/// A sensor's samples.
#[derive(Default)]
struct Samples {
    reading: [Vec<f64>; 3],
    /// A velocity and a temperature beside the reading.
    beside: [Vec<f64>; 4],
    missing: Vec<bool>,
}

fn played(variant: &Variant, plan: &Plan, end: SimTime, besides: &[&'static str]) -> Vec<Samples> {
    let mut all: Vec<Samples> = plan.sensors.iter().map(|_| Samples::default()).collect();
    let mut player = variant.player(plan, end, besides);
    while let Some(columns) = player.play_columns(Wants::NONE) {
        for (samples, block) in all.iter_mut().zip(columns.sensors()) {
            let beside = block.velocity.iter().chain([&block.temperature]);
            samples.beside.iter_mut().zip(beside).for_each(|(all, new)| all.extend(new));
            samples.reading.iter_mut().zip(&block.reading).for_each(|(all, new)| all.extend(new));
            samples.missing.extend(&block.missing);
            // A block of which none is missing has no marks.
            samples.missing.resize(samples.reading[0].len(), false);
        }
    }
    all
}

fn between(sensor: &SensorPlan, with: &Samples, without: &Samples) -> Change {
    let there = with.missing.iter().zip(&without.missing).map(|(a, b)| !a && !b).collect::<Vec<_>>();
    let axis = |axis: usize| {
        let pairs = with.reading[axis].iter().zip(&without.reading[axis]).zip(&there);
        let differences =
            pairs.filter(|(_, there)| **there).map(|((with, without), _)| (with - without).abs());
        let (mut squares, mut most, mut n) = (0.0, 0.0f64, 0);
        for difference in differences {
            squares += difference * difference;
            most = most.max(difference);
            n += 1;
        }
        [libm::sqrt(squares / f64::from(n.max(1))), most]
    };
    let count = sensor.kind.axes().len();
    let changes: Vec<[f64; 2]> = (0..count).map(axis).collect();
    let noise = white_noise::sigma(&sensor.values, sensor.kind, sensor.rate).unwrap_or_default();
    // The largest of each over the axes that have such a unit.
    let in_units = |unit: &dyn Fn(usize) -> f64| {
        let of = (0..count).filter(|&axis| unit(axis) > 0.0);
        of.map(|axis| changes[axis].map(|change| change / unit(axis)))
            .reduce(|a, b| [a[0].max(b[0]), a[1].max(b[1])])
    };
    let size = lsb(&sensor.values, sensor.kind);
    Change {
        sensor: sensor.kind,
        counts: size.and_then(|size| in_units(&|_| size)),
        noise: in_units(&|axis| noise[axis]),
        beside: with.missing != without.missing || with.beside != without.beside,
    }
}
