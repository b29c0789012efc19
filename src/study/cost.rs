//! What a nine-axis sample costs: in memory, in one thread, without files, set against the least that it could.
//!
//! The floor draws as many normal numbers as the scene does, from the same generator, and adds each to a column: no
//! emulator with this noise could do with less. Scene and floor take turns in short rounds, and each counts with its
//! quickest round, because whatever else runs on the machine only ever adds.

mod cores;

pub use cores::Cores;

use crate::motion::Wants;
use crate::os;
use crate::player::{BLOCK, Player};
use crate::random::{self, Normals};
use crate::scene::Plan;
use crate::sensor::TERMS;
use crate::time::SimTime;
use serde::Serialize;
use std::hint::black_box;
use std::time::Duration;

/// What a scene's samples cost.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cost {
    /// The scene's name.
    pub scene: String,
    /// Nine-axis samples in a round: three-axis samples of all sensors, divided by three.
    pub samples: u64,
    /// Of the whole scene.
    pub nine_axis_samples_per_s: f64,
    /// Of drawing its normal numbers alone; none where it has none.
    pub floor_samples_per_s: Option<f64>,
    /// Floor ÷ scene: at least 1 but for noise of the clock.
    pub ratio: Option<f64>,
    /// Normal numbers that a nine-axis sample draws.
    pub normals_per_sample: f64,
    /// The truth, then each error term in the order of the chain.
    pub terms: Vec<TermCost>,
    /// All processors together; none where there is but one.
    pub cores: Option<Cores>,
}

/// What a sample costs with the terms up to one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TermCost {
    /// `truth`, or the name of the error term that joins.
    pub term: &'static str,
    /// Nanoseconds a nine-axis sample, everything before it included.
    pub ns_per_sample: f64,
}

/// How many rounds there are, and how long one is.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    rounds: usize,
    ticks: u64,
}

impl Effort {
    /// Some seconds.
    pub const FULL: Effort = Effort { rounds: 60, ticks: 40_000 };
    /// A fraction of one.
    pub const QUICK: Effort = Effort { rounds: 8, ticks: 8_000 };
}

/// Measures `plan`; `now` is a clock that never goes back.
pub fn run(plan: &Plan, effort: Effort, now: &dyn Fn() -> Duration) -> Cost {
    let end = end(plan, effort.ticks);
    let active: Vec<&'static str> = TERMS
        .iter()
        .map(|term| term.name)
        .filter(|name| plan.sensors.iter().any(|sensor| plan.build(sensor).terms().contains(name)))
        .collect();
    // With none of them, with the first, with the first two …
    let left_out: Vec<&[&str]> = (0..=active.len()).map(|count| &active[count..]).collect();
    let mut best = vec![Duration::MAX; left_out.len()];
    let mut floor = Floor::new(plan, end);
    let mut least = Duration::MAX;
    for _ in 0..effort.rounds {
        for (best, left_out) in best.iter_mut().zip(&left_out) {
            let mut player = Player::without(plan, end, BLOCK, left_out);
            let start = now();
            while let Some(columns) = player.play_columns(Wants::NONE) {
                black_box(columns);
            }
            *best = (*best).min(now().saturating_sub(start));
        }
        let start = now();
        floor.draw();
        least = least.min(now().saturating_sub(start));
    }
    let samples = nine_axis(plan, end);
    let each = |time: Duration| time.as_nanos() as f64 / samples;
    let names = ["truth"].into_iter().chain(active.iter().copied());
    let terms = names.zip(&best).map(|(term, &time)| TermCost { term, ns_per_sample: each(time) }).collect();
    let (scene, floor_ns) = (each(best[best.len() - 1]), (floor.normals > 0).then(|| each(least)));
    Cost {
        scene: plan.name.clone(),
        samples: libm::round(samples) as u64,
        nine_axis_samples_per_s: 1e9 / scene,
        floor_samples_per_s: floor_ns.map(|ns| 1e9 / ns),
        ratio: floor_ns.map(|ns| scene / ns),
        normals_per_sample: floor.normals as f64 / samples,
        terms,
        cores: cores::run(plan, end, samples, effort.rounds, now),
    }
}

/// When the sensors have had about so many ticks together; the scene's own end if that comes first.
fn end(plan: &Plan, ticks: u64) -> SimTime {
    let hz: f64 = plan.sensors.iter().map(|sensor| sensor.rate.as_hz()).fold(0.0, f64::max);
    let seconds = ticks as f64 / hz.max(1e-3);
    plan.duration.min(SimTime((seconds * 1e9) as i64))
}

fn nine_axis(plan: &Plan, end: SimTime) -> f64 {
    let samples = plan.sensors.iter().map(|sensor| sensor.rate.ticks_before(sensor.phase, end));
    samples.sum::<u64>().max(1) as f64 / 3.0
}

/// The normal numbers of a scene and nothing else.
struct Floor {
    /// Of each sensor: its streams, as many axes as it draws normal numbers a sample, and its samples.
    streams: Vec<(Vec<Normals>, u64)>,
    columns: [Vec<f64>; 3],
    normals: u64,
}

impl Floor {
    fn new(plan: &Plan, end: SimTime) -> Floor {
        let streams = plan.sensors.iter().map(|sensor| {
            let samples = sensor.rate.ticks_before(sensor.phase, end);
            let count = plan.build(sensor).normals();
            let three = |i| {
                let wanted = [i, i + 1, i + 2].map(|i| i < count);
                random::normals(plan.seed, &format!("{}/{i}", sensor.kind), wanted)
            };
            ((0..count).step_by(3).map(three).collect::<Vec<_>>(), samples)
        });
        let streams: Vec<_> = streams.collect();
        let drawn = |(streams, samples): &(Vec<Normals>, u64)| {
            streams.iter().map(Normals::count).sum::<usize>() as u64 * samples
        };
        let normals = streams.iter().map(drawn).sum();
        Floor { streams, columns: [(); 3].map(|()| vec![0.0; BLOCK]), normals }
    }

    fn draw(&mut self) {
        for (streams, samples) in &mut self.streams {
            for first in (0..*samples).step_by(BLOCK) {
                let count = (BLOCK as u64).min(*samples - first) as usize;
                for normals in &mut *streams {
                    let columns = self.columns.each_mut().map(|column| &mut column[..count]);
                    os::widest(
                        #[inline(always)]
                        || normals.zip(columns, |_, value, normal| *value += normal),
                    );
                }
            }
        }
        black_box(&self.columns);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parallel;
    use std::cell::Cell;

    #[test]
    fn terms_are_those_of_the_scene_in_order_and_a_clock_of_its_own_gives_exact_figures() {
        let plan = Plan::load("mpu-9250", &["duration=1 s".into()]).unwrap();
        // A millisecond passes between two looks, so that every round takes as long as any other.
        let looks = Cell::new(0);
        let now = || {
            looks.set(looks.get() + 1);
            Duration::from_millis(looks.get())
        };
        let cost = run(&plan, Effort { rounds: 2, ticks: 500 }, &now);
        let names: Vec<_> = cost.terms.iter().map(|term| term.term).collect();
        assert_eq!(names[0], "truth");
        let expected = TERMS.iter().map(|term| term.name).filter(|name| names.contains(name));
        assert_eq!(names[1..], expected.collect::<Vec<_>>()[..]);
        assert!(names.contains(&"white_noise") && names.contains(&"resolution"), "{names:?}");
        assert_eq!(cost.ratio, Some(1.0));
        let ns = 1e6 / nine_axis(&plan, end(&plan, 500));
        assert!(cost.terms.iter().all(|term| (term.ns_per_sample - ns).abs() < 1e-9 * ns), "{cost:?}");
        assert!((cost.nine_axis_samples_per_s * ns * 1e-9 - 1.0).abs() < 1e-9);
        if let Some(cores) = cost.cores {
            assert_eq!((cores.threads, cores.times_one), (parallel::all_cores(), 1.0));
            let runs = cores.nine_axis_samples_per_s / cost.nine_axis_samples_per_s;
            assert!((runs - (cores.threads * cores::RUNS_EACH) as f64).abs() < 1e-6, "{runs}");
        }
    }

    #[test]
    fn the_floor_draws_what_the_scene_draws() {
        let of = |keys: &str| {
            let text = format!("duration = \"1 s\"\n[gyro]\nrate = \"1 kHz\"\n{keys}");
            let plan = Plan::parse(&text, "test", "test", &[]).unwrap();
            Floor::new(&plan, plan.duration).normals
        };
        assert_eq!(of(""), 0);
        assert_eq!(of("noise_std = \"1 rad/s\"\n"), 3000);
        assert_eq!(of("noise_std = \"[1, 0, 1] rad/s\"\nbias_step_std = \"1 rad/s\"\n"), 5000);
        let wander = "bias_instability = \"1 rad/s\"\ncorrelation_time = \"1 s\"\n";
        assert_eq!(of(wander), 3000);
    }
}
