use super::*;

const PERIOD: i64 = 1_000_000;

/// Waits for the ticks of `period` ns up to `ticks`, and returns how late each wait ended.
fn waits<C: Clock>(clock: &mut C, period: i64, ticks: i64) -> Vec<i64> {
    (1..=ticks)
        .map(|k| {
            clock.wait_until(k * period);
            clock.now() - k * period
        })
        .collect()
}

/// Waits for so many ticks of `period` ns from now on.
fn waits_from<C: Clock>(clock: &mut C, period: i64, ticks: i64) {
    let start = clock.now();
    (1..=ticks).for_each(|k| clock.wait_until(start + k * period));
}

#[test]
fn a_virtual_clock_jumps_and_never_goes_back() {
    let mut clock = VirtualClock::waking_late([0, 7]);
    for (t, now) in [(100, 100), (200, 207), (150, 207), (300, 300)] {
        clock.wait_until(t);
        assert_eq!(clock.now(), now);
    }
}

#[test]
fn a_wall_clock_never_wakes_early() {
    let mut bare = WallClock::start();
    let mut precise = Precise::new(bare, Policy::Adaptive);
    for step in [1_000, 100_000, 2_000_000] {
        for clock in [&mut bare as &mut dyn Clock, &mut precise] {
            let t = clock.now() + step;
            clock.wait_until(t);
            assert!(clock.now() >= t, "{step} ns");
        }
    }
}

/// The share of waits of `period` ns that end late, and the margin, where sleeps end 10.0 to 19.9 µs late, all values
/// equally often.
fn once_learnt(period: i64) -> (f64, i64) {
    let late: Vec<_> = (0..200).map(|i| 10_000 + (i * 73 % 200) * 50).collect();
    let mut clock = Precise::new(VirtualClock::waking_late(late), Policy::Adaptive);
    waits(&mut clock, period, 10_000);
    let ticks = 20_000;
    let late = (10_001..=10_000 + ticks).filter(|k| {
        clock.wait_until(k * period);
        clock.now() > k * period
    });
    (late.count() as f64 / ticks as f64, clock.margin().ns())
}

#[test]
fn the_margin_comes_to_cover_all_but_a_share_of_the_wakes_that_grows_with_the_rate() {
    for (period, accepted) in [(10 * PERIOD, 0.01), (PERIOD, 0.03), (125_000, 0.24), (50_000, 0.25)] {
        let (late, margin) = once_learnt(period);
        assert!((late - accepted).abs() < 0.003 + 0.1 * accepted, "{period}: {late} of the waits ended late");
        // That quantile, and how far a step takes it off.
        let quantile = 10_000.0 + 10_000.0 * (1.0 - accepted);
        assert!((margin as f64 - quantile).abs() < 2_500.0, "{period}: {margin} ns for {quantile}");
    }
}

#[test]
fn waits_that_a_sleep_would_miss_are_spun_with_rests() {
    let mut clock = Precise::new(VirtualClock::waking_late([40_000]), Policy::Adaptive);
    waits(&mut clock, PERIOD, 1_000);
    let (spun, start, period) = (clock.inner().spun, clock.now(), 31_250);
    let in_time = (1..=32_000).filter(|k| {
        clock.wait_until(start + k * period);
        clock.now() == start + k * period
    });
    let in_time = in_time.count() as f64 / 32_000.0;
    let awake = (clock.inner().spun - spun) as f64 / (clock.now() - start) as f64;
    assert!(in_time > 0.6, "{in_time} of the waits end on time");
    assert!((0.6..0.75).contains(&awake), "{awake} of the time is spun");
    let sleeps = clock.inner().sleeps;
    waits_from(&mut clock, PERIOD, 100);
    assert_eq!(clock.inner().sleeps, sleeps + 100, "longer waits are slept");
}

#[test]
fn a_machine_that_wakes_sooner_again_is_found_out_by_waits_that_were_spun() {
    let late = [vec![40_000; 1_000], vec![5_000; 100_000]].concat();
    let mut clock = Precise::new(VirtualClock::waking_late(late), Policy::Adaptive);
    waits(&mut clock, PERIOD, 1_000);
    waits_from(&mut clock, 31_250, 32_000);
    let sleeps = clock.inner().sleeps;
    waits_from(&mut clock, 31_250, 1_000);
    assert_eq!(clock.inner().sleeps, sleeps + 1_000, "each of them");
}

#[test]
fn the_margin_follows_a_machine_that_changes_and_stays_within_its_bounds() {
    let late = [vec![5_000_000; 1_000], vec![0; 5_000]].concat();
    let mut clock = Precise::new(VirtualClock::waking_late(late), Policy::Adaptive);
    waits(&mut clock, 10 * PERIOD, 1_000);
    assert_eq!(clock.margin().ns() as f64, Margin::BOUNDS.1, "a machine that is always late");
    for k in 0..5_000 {
        clock.wait_until(clock.now() + (1 + k % 3) * PERIOD);
    }
    assert_eq!(clock.margin().ns() as f64, Margin::BOUNDS.0, "one that never is");
}

#[test]
fn an_eighth_of_a_wait_of_any_length_is_slept() {
    for period in [10_000, 40_000, 125_000, PERIOD] {
        let mut clock = Precise::new(VirtualClock::default(), Policy::Fixed(80_000));
        let late = waits(&mut clock, period, 1_000);
        assert!(late.iter().all(|&late| late == 0));
        assert_eq!(clock.inner().spun, 1_000 * (period / 8 * 7).min(80_000), "{period}");
        assert_eq!(clock.inner().sleeps, 1_000);
    }
}

#[test]
fn a_fixed_margin_learns_nothing() {
    let mut clock = Precise::new(VirtualClock::waking_late([70_000]), Policy::Fixed(40_000));
    let late = waits(&mut clock, PERIOD, 100);
    assert!(late.iter().all(|&late| late == 30_000));
    assert_eq!(clock.margin().ns(), 40_000);
}

/// A clock where every look takes a microsecond: a thread that works and never sleeps.
#[derive(Default)]
struct Busy {
    now: std::cell::Cell<i64>,
    slept: i64,
}

impl Clock for Busy {
    fn now(&self) -> i64 {
        self.now.set(self.now.get() + 1_000);
        self.now.get()
    }

    fn sleep_until(&mut self, t: i64) {
        self.slept += (t - self.now.get()).max(0);
        self.now.set(self.now.get().max(t));
    }
}

#[test]
fn what_is_never_in_time_to_sleep_rests_before_the_kernel_stops_it() {
    let mut clock = Precise::new(Busy::default(), Policy::Adaptive);
    while clock.now() < 1_000_000_000 {
        clock.wait_until(0);
    }
    let share = clock.inner().slept as f64 / 1e9;
    assert!((0.06..0.12).contains(&share), "{share}");
}
