//! How much faster several runs of a scene are made by all processors together than by one.

use crate::motion::Wants;
use crate::parallel;
use crate::player::{BLOCK, Player};
use crate::scene::Plan;
use crate::time::SimTime;
use serde::Serialize;
use std::hint::black_box;
use std::time::Duration;

/// Runs of a scene in memory over all processors, against as many in one thread.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cores {
    /// Threads, one a processor.
    pub threads: usize,
    /// Nine-axis samples a second of all together.
    pub nine_axis_samples_per_s: f64,
    /// Times that of one thread.
    pub times_one: f64,
}

/// How many times each processor plays the scene in a round, for starting a thread not to weigh.
pub(super) const RUNS_EACH: usize = 8;

/// Plays the plan so many times a processor, in one thread and over all of them in turns; each counts with its quickest
/// round. `samples` are those of one run; none where there is one processor.
pub(super) fn run(
    plan: &Plan,
    end: SimTime,
    samples: f64,
    rounds: usize,
    now: &dyn Fn() -> Duration,
) -> Option<Cores> {
    let all = parallel::all_cores();
    let runs = RUNS_EACH * all;
    let mut least = [1, all].map(|threads| (threads, Duration::MAX));
    for _ in 0..rounds {
        for (threads, least) in &mut least {
            let start = now();
            parallel::map(*threads, runs, &|_, _| (), |_| {
                let mut player = Player::new(plan, end, BLOCK);
                while let Some(columns) = player.play_columns(Wants::NONE) {
                    black_box(columns);
                }
            });
            *least = (*least).min(now().saturating_sub(start));
        }
    }
    let [(_, one), (threads, together)] = least.map(|(threads, time)| (threads, time.as_secs_f64()));
    (threads > 1).then(|| Cores {
        threads,
        nine_axis_samples_per_s: runs as f64 * samples / together,
        times_one: one / together,
    })
}
