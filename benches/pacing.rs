//! How late waits end and what they cost a core, by how long before the due time they begin to spin.
//!
//! The policies take turns in short slices on one thread, so that whatever else the machine does disturbs all alike.
//! Run on its own (`cargo bench --bench pacing`, or with `-- --ordinary` without real-time priority, and `--slack`
//! with the kernel's own 50 µs of slack); as a test it only passes through.

use ratetable::clock::{Clock, Policy, Precise, WallClock};
use ratetable::os;
use ratetable::report::{Times, number, table};
use ratetable::time::{Rate, SimTime};
use std::time::Duration;

const SLICE: SimTime = SimTime(500_000_000);

/// One policy at one rate.
struct Trial {
    name: &'static str,
    rate: Rate,
    clock: Precise<WallClock>,
    late: Times,
    used: Duration,
}

impl Trial {
    fn slice(&mut self, slice: SimTime) {
        let start = self.clock.now() + 2_000_000;
        self.clock.sleep_until(start);
        let used = os::thread_cpu_time();
        for k in 1..=self.rate.ticks_before(SimTime::ZERO, slice) {
            let due = start + self.rate.tick(k).0;
            self.clock.wait_until(due);
            self.late.record(self.clock.now() - due);
        }
        self.used += os::thread_cpu_time() - used;
    }

    fn row(&self) -> Option<Vec<String>> {
        let late = self.late.late()?;
        let spent = self.late.count() as f64 * self.rate.period();
        let share = format!("{:.1} %", 100.0 * self.used.as_secs_f64() / spent);
        let margin = number(self.clock.margin().ns() as f64 / 1000.0);
        let row = [self.rate.to_string(), self.name.into(), margin];
        let figures = [late.p50, late.p99, late.p99_9, late.max].map(number);
        Some([row.to_vec(), figures.to_vec(), vec![share]].concat())
    }
}

fn main() {
    let given = |name: &str| std::env::args().any(|argument| argument == name);
    let priority = if given("--ordinary") { None } else { Some(50) };
    if !given("--slack") {
        os::set_punctual_sleep();
    }
    let realtime = priority.is_some_and(|priority| os::set_realtime_priority(priority).is_ok());
    let (slice, turns) = if given("--bench") { (SLICE, 20) } else { (SimTime(5_000_000), 1) };
    let policies = [
        ("bare sleep", Policy::Fixed(0)),
        ("20 µs", Policy::Fixed(20_000)),
        ("40 µs", Policy::Fixed(40_000)),
        ("60 µs", Policy::Fixed(60_000)),
        ("adaptive", Policy::Adaptive),
    ];
    let trial = |rate, (name, policy)| Trial {
        name,
        rate,
        clock: Precise::new(WallClock::start(), policy),
        late: Times::new(),
        used: Duration::ZERO,
    };
    let mut trials: Vec<_> = [1000, 8000, 32_000]
        .iter()
        .flat_map(|&hz| policies.map(|policy| trial(Rate::hz(hz), policy)))
        .collect();
    for _ in 0..turns {
        trials.iter_mut().for_each(|trial| trial.slice(slice));
    }
    let rows: Vec<_> = trials.iter().filter_map(Trial::row).collect();
    let heading = ["rate", "margin", "µs", "late p50 µs", "p99", "p99.9", "max", "of a core"];
    eprintln!("{} priority\n{}", if realtime { "real-time" } else { "ordinary" }, table(&heading, &rows));
}
