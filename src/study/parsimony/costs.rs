//! Nanoseconds that a part takes a sample: the scene with it and without, turn by turn.

use super::parts::Part;
use super::variant::Variant;
use crate::scene::{Plan, SceneError};
use crate::sensor::SensorKind;
use crate::time::SimTime;
use std::hint::black_box;
use std::time::Duration;

/// How a cost is measured.
pub struct Rounds<'a> {
    /// How often each is played; its quickest time counts, because whatever else runs on the machine only ever adds.
    pub rounds: usize,
    /// About how many ticks a playing has.
    pub ticks: u64,
    /// A clock that never goes back.
    pub now: &'a dyn Fn() -> Duration,
}

/// What parts cost, and how far such a difference can be off.
#[derive(Clone, Debug, Default)]
pub struct Costs {
    /// Of each part, in their order: nanoseconds a sample of its sensor, or a tick of the scene.
    pub ns: Vec<f64>,
    /// The largest difference that was measured between a scene and itself, in the same unit.
    pub ns_of_nothing: f64,
}

impl Rounds<'_> {
    /// The cost of each part. That of a sensor's is measured on the sensor alone, so that it is not a small difference
    /// of large numbers.
    ///
    /// # Errors
    /// A variant that is no scene.
    pub fn costs(&self, whole: &Variant, without: &[(Part, Variant)]) -> Result<Costs, SceneError> {
        let mut costs = Costs { ns: vec![0.0; without.len()], ns_of_nothing: 0.0 };
        let mut owners: Vec<Option<SensorKind>> = without.iter().map(|(part, _)| part.sensor).collect();
        owners.dedup();
        for owner in owners {
            let of = |variant: &Variant| owner.map_or_else(|| variant.clone(), |kind| variant.alone(kind));
            let mine: Vec<usize> = (0..without.len()).filter(|&i| without[i].0.sensor == owner).collect();
            // The whole twice: what it differs by from itself is the measurement's own.
            let variants = [whole, whole].into_iter().chain(mine.iter().map(|&i| &without[i].1));
            let (ns, _) = self.least(&variants.map(of).collect::<Vec<_>>())?;
            costs.ns_of_nothing = costs.ns_of_nothing.max((ns[0] - ns[1]).abs());
            let with = ns[0].min(ns[1]);
            mine.iter().zip(&ns[2..]).for_each(|(&i, without)| costs.ns[i] = with - without);
        }
        Ok(costs)
    }

    /// Nanoseconds that each takes for a nine-axis sample: three samples of any sensor.
    ///
    /// # Errors
    /// A variant that is no scene.
    pub fn nine_axis(&self, variants: &[Variant]) -> Result<Vec<f64>, SceneError> {
        let (ns, ticks) = self.least(variants)?;
        Ok(ns.iter().zip(ticks).map(|(ns, [ticks, samples])| 3.0 * ns * ticks / samples).collect())
    }

    /// Nanoseconds a distinct tick of each, least of all rounds, and how many ticks and samples there are.
    fn least(&self, variants: &[Variant]) -> Result<(Vec<f64>, Vec<[f64; 2]>), SceneError> {
        let plans = variants.iter().map(|variant| variant.plan(0)).collect::<Result<Vec<_>, _>>()?;
        let end = plans.iter().map(|plan| end(plan, self.ticks)).min().unwrap_or_default();
        let mut best = vec![Duration::MAX; variants.len()];
        let mut counts = vec![[1.0; 2]; variants.len()];
        for _ in 0..self.rounds {
            for (i, (variant, plan)) in variants.iter().zip(&plans).enumerate() {
                let mut player = variant.player(plan, end, &[]);
                let (mut ticks, mut samples) = (0, 0);
                let start = (self.now)();
                while let Some(columns) = player.play_columns() {
                    ticks += columns.truth.len();
                    samples += columns.sensors().map(|block| block.len()).sum::<usize>();
                    black_box(columns);
                }
                best[i] = best[i].min((self.now)().saturating_sub(start));
                counts[i] = [ticks.max(1) as f64, samples.max(1) as f64];
            }
        }
        let ns = best.iter().zip(&counts).map(|(best, [ticks, _])| best.as_nanos() as f64 / ticks);
        Ok((ns.collect(), counts))
    }
}

/// When the quickest sensor has had about so many ticks; the scene's own end if that comes first.
fn end(plan: &Plan, ticks: u64) -> SimTime {
    let hz = plan.sensors.iter().map(|sensor| sensor.rate.as_hz()).fold(1e-3, f64::max);
    plan.duration.min(SimTime((ticks as f64 / hz * 1e9) as i64))
}
