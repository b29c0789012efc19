//! The size of an error term that has no entry of its own: what the sensor reads with it and without.

use super::survey::most as ticks_of;
use super::terms::key;
use super::{EFFECTS, Found, Survey, TICKS};
use crate::player::Feed;
use crate::sensor::{Block, Sensor};
use glam::DVec3;

/// Rounding and clipping would hide or enlarge a small difference.
const LAST: [&str; 2] = ["range", "resolution"];

/// Every term that the sensor uses and [`EFFECTS`] does not have, by its name.
pub(super) fn others(survey: &Survey<'_>) -> Vec<(&'static str, Found)> {
    let known = |term: &&str| EFFECTS.iter().any(|effect| effect.name == *term);
    let others = survey.terms.iter().copied().filter(|term| !known(term));
    others.filter_map(|term| measure(survey, term).map(|found| (term, found))).collect()
}

/// The largest difference over the first samples, contiguous so that a state may grow; `None` for a term that cannot
/// be built.
pub(super) fn measure(survey: &Survey<'_>, term: &str) -> Option<Found> {
    let without =
        |others: &[&str]| Sensor::without(survey.sensor, survey.plan.seed, &[&LAST, others].concat());
    let (mut with, mut without) = (without(&[]).ok()?, without(&[term]).ok()?);
    let mut block = error_free(survey, &with);
    with.read(&mut block);
    let reading = block.reading.clone();
    without.read(&mut block);
    let most = |axis: usize| {
        let pairs = reading[axis].iter().zip(&block.reading[axis]);
        pairs.map(|(with, without)| (with - without).abs()).fold(0.0, f64::max)
    };
    let statistic = match survey.ticks {
        0..=TICKS => "largest, measured",
        _ => "largest, over at most the first 20 000 samples",
    };
    let size = DVec3::new(most(0), most(1), most(2));
    Some(Found { key: key(survey, term), ..Found::modelled(size, statistic) })
}

/// What the sensor is given at its first ticks.
fn error_free(survey: &Survey<'_>, sensor: &Sensor) -> Block {
    let (plan, path) = (survey.sensor, survey.trajectory());
    let (mut block, mut feed) =
        (Block::default(), Feed::new(plan, survey.plan.origin(), survey.plan.seed, sensor));
    for k in 0..survey.ticks.min(ticks_of(survey.plan, plan)) {
        let t = plan.tick(k);
        feed.push(t, &path.at(t), path, &mut block);
    }
    block
}
