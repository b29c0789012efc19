//! Nanoseconds that a part takes a sample: the scene with it and without, turn by turn.

use super::parts::Part;
use super::variant::Variant;
use crate::motion::Wants;
use crate::scene::{Plan, SceneError};
use crate::sensor::{Block, SensorKind};
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
    /// Of each part, in the order given, sensor by sensor: nanoseconds a sample of its sensor, or a tick of the scene.
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
        let mut owners: Vec<Option<SensorKind>> = without.iter().map(|(part, _)| part.sensor).collect();
        owners.dedup();
        let mut groups = Vec::new();
        for &owner in &owners {
            let of = |variant: &Variant| owner.map_or_else(|| variant.clone(), |kind| variant.alone(kind));
            // The whole twice: what it differs by from itself is the measurement's own.
            let mine = without.iter().filter(|(part, _)| part.sensor == owner).map(|(_, variant)| variant);
            groups.push(Group::new([whole, whole].into_iter().chain(mine).map(of), self.ticks)?);
        }
        self.play(&mut groups);
        let mut costs = Costs::default();
        for group in groups {
            let ns = group.ns_per_tick();
            costs.ns_of_nothing = costs.ns_of_nothing.max((ns[0] - ns[1]).abs());
            let with = ns[0].min(ns[1]);
            costs.ns.extend(ns[2..].iter().map(|without| with - without));
        }
        Ok(costs)
    }

    /// Nanoseconds that each takes for a nine-axis sample: three samples of any sensor.
    ///
    /// # Errors
    /// A variant that is no scene.
    pub fn nine_axis(&self, variants: &[Variant]) -> Result<Vec<f64>, SceneError> {
        let mut groups = [Group::new(variants.iter().cloned(), self.ticks)?];
        self.play(&mut groups);
        let [group] = groups;
        let each = group.ns_per_tick().into_iter().zip(&group.counts);
        Ok(each.map(|(ns, [ticks, samples])| 3.0 * ns * ticks / samples).collect())
    }

    /// Every scene of every group in turn, again and again, so that what disturbs the machine for a while disturbs all.
    fn play(&self, groups: &mut [Group]) {
        for _ in 0..self.rounds {
            for group in &mut *groups {
                group.play(self.now);
            }
        }
    }
}

/// Scenes that are compared with one another.
struct Group {
    variants: Vec<Variant>,
    plans: Vec<Plan>,
    end: SimTime,
    /// The quickest playing of each.
    best: Vec<Duration>,
    /// Distinct ticks of each, and samples of all its sensors.
    counts: Vec<[f64; 2]>,
}

impl Group {
    fn new(variants: impl Iterator<Item = Variant>, ticks: u64) -> Result<Group, SceneError> {
        let variants: Vec<Variant> = variants.collect();
        let plans = variants.iter().map(|variant| variant.plan(0)).collect::<Result<Vec<_>, _>>()?;
        let end = plans.iter().map(|plan| end(plan, ticks)).min().unwrap_or_default();
        let (best, counts) = (vec![Duration::MAX; variants.len()], vec![[1.0; 2]; variants.len()]);
        Ok(Group { variants, plans, end, best, counts })
    }

    fn play(&mut self, now: &dyn Fn() -> Duration) {
        for (i, (variant, plan)) in self.variants.iter().zip(&self.plans).enumerate() {
            let mut player = variant.player(plan, self.end, &[]);
            let (mut ticks, mut samples) = (0, 0);
            let start = now();
            while let Some(columns) = player.play_columns(Wants::NONE) {
                ticks += columns.truth.len();
                samples += columns.sensors().map(Block::len).sum::<usize>();
                black_box(columns);
            }
            self.best[i] = self.best[i].min(now().saturating_sub(start));
            self.counts[i] = [ticks.max(1) as f64, samples.max(1) as f64];
        }
    }

    /// Of a sensor alone a tick is a sample.
    fn ns_per_tick(&self) -> Vec<f64> {
        let each = self.best.iter().zip(&self.counts);
        each.map(|(best, [ticks, _])| best.as_nanos() as f64 / ticks).collect()
    }
}

/// When the quickest sensor has had about so many ticks; the scene's own end if that comes first.
fn end(plan: &Plan, ticks: u64) -> SimTime {
    let hz = plan.sensors.iter().map(|sensor| sensor.rate.as_hz()).fold(1e-3, f64::max);
    plan.duration.min(SimTime((ticks as f64 / hz * 1e9) as i64))
}
