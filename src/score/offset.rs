//! Two clocks that have nothing in common, brought together by the motion.
//!
//! The size of the angular rate is the same in any axes, whatever the order or sign of the quaternion, so the time at
//! which both say the same is found before anything else is known: by the correlation coefficient at every lag.

use super::delay::Series;
use super::sampled::Sampled;
use crate::geometry::angle_between;
use std::ops::Range;

/// Even steps on which rates are compared: at least this, ns.
const STEP: i64 = 20_000_000;
/// The most steps of the longer of the two.
const STEPS: i64 = 4096;
/// Less than this is no agreement.
const LEAST: f64 = 0.5;

/// How much the clock of `series` is ahead of the truth's, to about the second value, ns; `None` where the rates do
/// not agree anywhere, or do not vary.
pub(super) fn find(grid: &Sampled, truth: Range<i64>, series: &Series) -> Option<(i64, i64)> {
    let (&first, &last) = (series.times.first()?, series.times.last()?);
    let step = STEP.max((truth.end - truth.start).max(last - first) / STEPS);
    let ours = rates(truth.clone(), step, |t| grid.at(t));
    let mut near = 0;
    let theirs = rates(first..last, step, |t| {
        while near + 1 < series.times.len() && series.times[near + 1] <= t {
            near += 1;
        }
        let (a, b) = (near, (near + 1).min(series.times.len() - 1));
        let gap = series.times[b] - series.times[a];
        let share = if gap > 0 { (t - series.times[a]) as f64 / gap as f64 } else { 0.0 };
        Some(series.attitudes[a].slerp(series.attitudes[b], share.clamp(0.0, 1.0)))
    });
    let least = (ours.len().min(theirs.len()) / 2).max(8) as i64;
    let lags = least - theirs.len() as i64..=ours.len() as i64 - least;
    let (lag, best) = lags
        .filter_map(|lag| Some((lag, correlation(&ours, &theirs, lag)?)))
        .max_by(|a, b| a.1.total_cmp(&b.1))?;
    (best >= LEAST).then(|| (first - truth.start - lag * step, step))
}

/// The mean size of the angular rate over each step, rad/s.
fn rates(span: Range<i64>, step: i64, mut at: impl FnMut(i64) -> Option<glam::DQuat>) -> Vec<f64> {
    let attitudes: Vec<_> =
        (0..=(span.end - span.start) / step).filter_map(|i| at(span.start + i * step)).collect();
    attitudes.windows(2).map(|pair| angle_between(pair[0], pair[1]) / (step as f64 * 1e-9)).collect()
}

/// Of `ours[i + lag]` and `theirs[i]` where there are both.
fn correlation(ours: &[f64], theirs: &[f64], lag: i64) -> Option<f64> {
    let skip = |n: i64| usize::try_from(n.max(0)).unwrap_or(usize::MAX);
    let pairs = || ours.iter().skip(skip(lag)).zip(theirs.iter().skip(skip(-lag)));
    let n = pairs().count() as f64;
    let [mut a, mut b, mut aa, mut bb, mut ab] = [0.0; 5];
    for (x, y) in pairs() {
        (a, b, aa, bb, ab) = (a + x, b + y, aa + x * x, bb + y * y, ab + x * y);
    }
    let (va, vb) = (aa - a * a / n, bb - b * b / n);
    (va > 1e-9 * n && vb > 1e-9 * n).then(|| (ab - a * b / n) / libm::sqrt(va * vb))
}
