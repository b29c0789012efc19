//! The interval of a series of times, as it is between losses: independent of losses, jitter and steps of the
//! clock. Memory is fixed.

use crate::report::Times;
use std::f64::consts::TAU;

/// Steps examined before the first interval is known.
const EARLY: usize = 64;

/// The most rounds that place these steps again, each with the interval found so far.
const ROUNDS: usize = 8;

/// The share of a sample's distance from its place that the next place takes over. With less, a late sample and the
/// early one after it look like a gap; with all of it, the places would not follow a clock that drifts.
const KEPT: f64 = 0.8;

/// A step of the clock is longer than this, ns, …
const SHORTEST_JUMP: i64 = 1_000_000_000;

/// … and longer than this many intervals.
const JUMP: f64 = 100.0;

/// Steps longer than this, in intervals, do not contribute to the interval: one place more or less would change it.
const SHORT: f64 = 16.0;

/// What is known of a step besides its length.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Evidence {
    /// Nothing confirms that this much time passed, so a long step is a step of the clock.
    pub may_jump: bool,
    /// The sequence numbers show that no packet of the sender is missing in it.
    pub lossless: bool,
}

/// Steps from one sample time to the next, all forward.
///
/// Each sample has its place on a grid that follows the stream: the number of intervals to it is the number of
/// places passed. The interval is `span / places` over their sum, so a gap changes nothing. Two places passed at
/// once without a loss count as one: a sensor sent at the ticks of a faster one, or in whole ms, sometimes has no
/// sample at a tick. A jump of the clock is left out.
#[derive(Clone, Debug)]
pub(super) struct Pace {
    steps: Times,
    /// The first steps, until the interval is known.
    early: Vec<(i64, Evidence)>,
    /// ns; 0 until known.
    interval: f64,
    /// The number of places that all steps passed.
    places: u64,
    /// The total length of the short steps, ns, and their places.
    short: (i64, u64),
    /// How far the newest sample lags behind its place, in intervals.
    late: f64,
    jumps: u64,
    longest_jump: i64,
}

impl Pace {
    pub fn new() -> Pace {
        Pace {
            steps: Times::new(),
            early: Vec::with_capacity(EARLY),
            interval: 0.0,
            places: 0,
            short: (0, 0),
            late: 0.0,
            jumps: 0,
            longest_jump: 0,
        }
    }

    /// Records a step longer than zero, ns.
    pub fn take(&mut self, step: i64, evidence: Evidence) {
        if self.interval > 0.0 {
            self.place(step, evidence);
            self.measure();
            if self.steps.count().is_power_of_two() {
                self.doubt();
            }
            return;
        }
        self.early.push((step, evidence));
        if self.early.len() == EARLY {
            self.settle();
        }
    }

    /// The result so far, from however few steps.
    pub fn settled(&self) -> Pace {
        let mut settled = self.clone();
        settled.settle();
        settled.doubt();
        settled
    }

    /// Places passed a second, Hz.
    pub fn rate(&self) -> Option<f64> {
        let (span, places) = self.short;
        (places > 0).then(|| places as f64 * 1e9 / span as f64)
    }

    /// Places passed without a sample; `None` without a step.
    pub fn missing(&self) -> Option<u64> {
        (self.steps.count() > 0).then(|| self.places.saturating_sub(self.steps.count()))
    }

    /// The steps, without jumps.
    pub fn steps(&self) -> &Times {
        &self.steps
    }

    /// How often the clock jumped forward, and the longest jump, ns.
    pub fn jumps(&self) -> (u64, i64) {
        (self.jumps, self.longest_jump)
    }

    /// Whether a step is too long to be explained by lost samples.
    pub fn is_long(&self, step: i64) -> bool {
        step > SHORTEST_JUMP && step as f64 > JUMP * self.interval
    }

    /// Determines the interval from the first steps and places them.
    fn settle(&mut self) {
        let early = std::mem::take(&mut self.early);
        if early.is_empty() {
            return;
        }
        let mut steps = Times::new();
        early.iter().for_each(|(step, _)| steps.record(*step));
        // The right guess puts the samples nearest to their places.
        let rounds = guesses(&steps).map(|guess| Pace::placed(&early, guess));
        let nearest =
            rounds.into_iter().reduce(|best, other| if other.1 < 0.999 * best.1 { other } else { best });
        if let Some((pace, _)) = nearest {
            *self = pace;
        }
    }

    /// Places these steps, starting from a guess of the interval, until the interval agrees with the places. Also
    /// returns the sum of squared distances of the samples from their places.
    fn placed(early: &[(i64, Evidence)], guess: f64) -> (Pace, f64) {
        let mut interval = guess;
        for left in (0..ROUNDS).rev() {
            let late = KEPT * lateness(early, interval);
            let mut round = Pace { interval, late, ..Pace::new() };
            let away = early.iter().map(|(step, evidence)| round.place(*step, *evidence).powi(2)).sum();
            round.measure();
            if left == 0 || round.interval == interval {
                return (round, away);
            }
            interval = round.interval;
        }
        (Pace { interval, ..Pace::new() }, f64::INFINITY)
    }

    /// Computes the interval from everything placed so far.
    fn measure(&mut self) {
        let (span, places) = self.short;
        if places > 0 {
            self.interval = span as f64 / places as f64;
        }
    }

    /// The distance of the sample from its place, in intervals.
    fn place(&mut self, step: i64, evidence: Evidence) -> f64 {
        if evidence.may_jump && self.is_long(step) {
            self.jumps += 1;
            self.longest_jump = self.longest_jump.max(step);
            self.late = 0.0;
            return 0.0;
        }
        self.steps.record(step);
        let passed = step as f64 / self.interval + self.late;
        let mut places = passed.round().max(0.0);
        let away = passed - places;
        self.late = KEPT * away;
        if evidence.lossless && places == 2.0 {
            (places, self.late) = (1.0, 0.0);
        }
        self.places += places as u64;
        if places < SHORT {
            self.short = (self.short.0.saturating_add(step), self.short.1 + places as u64);
        }
        away
    }

    /// Starts again from all steps if the first ones differ from the others.
    fn doubt(&mut self) {
        if self.steps.count() == 0 {
            return;
        }
        let [_, fitted, median] = guesses(&self.steps);
        let unlike = |guess: f64| !(0.7..1.4).contains(&(guess / self.interval));
        if unlike(fitted) && unlike(median) {
            let passed = |(step, count): (f64, f64)| [step * count, places(step, fitted) * count];
            let all =
                values(&self.steps).map(passed).fold([0.0; 2], |sum, one| [sum[0] + one[0], sum[1] + one[1]]);
            (self.places, self.late) = (all[1] as u64, 0.0);
            self.short = (all[0] as i64, all[1] as u64);
            self.measure();
        }
    }
}

/// Each distinct step, ns, with its count.
fn values(steps: &Times) -> impl Iterator<Item = (f64, f64)> {
    steps.values().into_iter().map(|(us, count)| (1e3 * us, count as f64))
}

fn places(step: f64, interval: f64) -> f64 {
    (step / interval).round().max(1.0)
}

/// How far the sample before these steps lags behind its place, if the places match the samples on average, in
/// intervals.
fn lateness(early: &[(i64, Evidence)], interval: f64) -> f64 {
    let (mut at, mut sin, mut cos) = (0.0, 0.0, 1.0);
    for step in early.iter().map(|(step, _)| *step as f64).filter(|step| *step < JUMP * interval) {
        at += step / interval;
        let angle = TAU * (at - at.round());
        sin += libm::sin(angle);
        cos += libm::cos(angle);
    }
    -libm::atan2(sin, cos) / TAU
}

/// Guesses of the interval, ns: the mean of the steps near the median (times in whole ms of a 400 Hz stream have
/// steps of 2 and 3 ms, and none of 2.5), the one of which all steps are about a multiple, and the median itself.
fn guesses(steps: &Times) -> [f64; 3] {
    let median = 1e3 * steps.late().map_or(0.0, |late| late.p50);
    let near = (0.25 * median)..(1.9 * median);
    let near =
        mean(values(steps).filter(|(step, _)| near.contains(step)).map(|(step, count)| (step, count, 1.0)));
    let mut whole = near;
    for _ in 0..ROUNDS {
        let short = values(steps).filter(|(step, _)| *step < JUMP * whole);
        let next = mean(short.map(|(step, count)| (step, count, places(step, whole))));
        if next == whole {
            break;
        }
        whole = next;
    }
    [near, whole, median].map(|interval| interval.max(1.0))
}

/// The sum of all steps divided by all places that they pass, each with its count.
fn mean(steps: impl Iterator<Item = (f64, f64, f64)>) -> f64 {
    let (span, passed) = steps.fold((0.0, 0.0), |(span, passed), (step, count, places)| {
        (span + step * count, passed + places * count)
    });
    span / passed
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const MS: i64 = 1_000_000;

    /// The pace of these times, without jumps.
    fn pace(times: impl IntoIterator<Item = i64>) -> Pace {
        let times: Vec<i64> = times.into_iter().collect();
        let mut pace = Pace::new();
        times
            .windows(2)
            .filter(|pair| pair[1] > pair[0])
            .for_each(|pair| pace.take(pair[1] - pair[0], Evidence::default()));
        pace.settled()
    }

    fn is(pace: &Pace, hz: f64, missing: u64) -> bool {
        (pace.rate().unwrap() / hz - 1.0).abs() < 1e-4 && pace.missing() == Some(missing)
    }

    #[test]
    fn a_clock_that_is_off_loses_nothing_however_long() {
        for ppm in [-20_000, -200, 0, 200, 20_000i64] {
            let period = MS + ppm;
            let pace = pace((0..200_000).map(|k| k * period));
            assert!(is(&pace, 1e9 / period as f64, 0), "{ppm} ppm: {:?} {:?}", pace.rate(), pace.missing());
        }
    }

    #[test]
    fn a_drifting_clock_is_followed() {
        // From 1 ms to 1.02 ms.
        let mut t = 0;
        let pace = pace((0..100_000i64).map(|k| {
            t += MS + k / 5;
            t
        }));
        assert!(is(&pace, 1e9 / 1.01e6, 0), "{:?} {:?}", pace.rate(), pace.missing());
    }

    #[test]
    fn times_coarser_than_the_interval_hide_nothing() {
        for (hz, unit) in [(400, MS), (600, MS), (300, MS), (1000 / 3, MS), (8000, 1000), (100, 10 * MS)] {
            let pace = pace((0..20_000).map(|k| k * 1_000_000_000 / hz / unit * unit));
            assert!(is(&pace, hz as f64, 0), "{hz} Hz: {:?} {:?}", pace.rate(), pace.missing());
        }
    }

    #[test]
    fn one_missing_of_each_twenty_changes_no_rate_and_is_counted() {
        for unit in [1, MS] {
            let times = (0..20_000).filter(|k| k % 20 != 7).map(|k| k * 2_500_000 / unit * unit);
            let pace = pace(times);
            assert!(is(&pace, 400.0, 1000), "{:?} {:?}", pace.rate(), pace.missing());
        }
        let pace = pace((0..100_000).filter(|k| k % 50_000 < 20_000).map(|k| k * MS));
        assert!(is(&pace, 1000.0, 30_000), "one long gap: {:?}", pace.missing());
    }

    #[test]
    fn first_steps_that_are_not_like_the_others_do_not_stay() {
        let pace = pace((0..200).map(|k| k * 10 * MS).chain((0..50_000).map(|k| 2000 * MS + k * MS)));
        assert!((pace.rate().unwrap() - 1000.0).abs() < 1.0, "{:?}", pace.rate());
        // Two hundred steps of ten intervals each, including the one into the even part.
        assert_eq!(pace.missing(), Some(200 * 9));
    }

    #[test]
    fn a_tick_without_a_sample_is_no_gap_where_the_numbers_have_none() {
        // 999.8 Hz and 800 Hz, sent at the ticks of 1 kHz.
        for (hz, missing_without) in [(999.8, 20), (800.0, 25_000)] {
            let times: Vec<i64> =
                (0..).map(|k| (f64::from(k) * 1000.0 / hz).ceil() as i64 * MS).take(100_000).collect();
            for lossless in [true, false] {
                let mut pace = Pace::new();
                times
                    .windows(2)
                    .for_each(|pair| pace.take(pair[1] - pair[0], Evidence { may_jump: false, lossless }));
                let pace = pace.settled();
                let (rate, missing) = if lossless { (hz, 0) } else { (1000.0, missing_without) };
                assert!(
                    (pace.rate().unwrap() / rate - 1.0).abs() < 1e-4,
                    "{hz} {lossless}: {:?}",
                    pace.rate()
                );
                assert!(
                    pace.missing().unwrap().abs_diff(missing) <= 1,
                    "{hz} {lossless}: {:?}",
                    pace.missing()
                );
            }
        }
        // A longer gap still counts: the sender took no samples.
        let mut pace = Pace::new();
        (0..1000).for_each(|k| {
            pace.take(if k == 500 { 7 * MS } else { MS }, Evidence { may_jump: false, lossless: true })
        });
        assert_eq!(pace.settled().missing(), Some(6));
    }

    #[test]
    fn only_what_may_jump_and_is_long_does() {
        for (jump, may, jumps) in
            [(5_000 * MS, true, 1), (5_000 * MS, false, 0), (900 * MS, true, 0), (3_600_000 * MS, true, 1)]
        {
            for at in [3, 500] {
                let mut pace = Pace::new();
                let evidence = Evidence { may_jump: may, lossless: false };
                (0..1000).for_each(|k| pace.take(if k == at { jump } else { MS }, evidence));
                let settled = pace.settled();
                assert_eq!(settled.jumps().0, jumps, "{jump} {may} at {at}");
                let missing = if jumps == 1 { 0 } else { (jump / MS - 1) as u64 };
                assert!(is(&settled, 1000.0, missing), "{:?} {:?}", settled.rate(), settled.missing());
            }
        }
        // A stream of one sample in two seconds has no jumps.
        let mut pace = Pace::new();
        (0..20).for_each(|_| pace.take(2000 * MS, Evidence { may_jump: true, lossless: false }));
        assert_eq!((pace.settled().jumps().0, pace.settled().missing()), (0, Some(0)));
    }

    proptest! {
        #[test]
        fn jitter_of_a_quarter_of_the_interval_hides_nothing_and_what_is_lost_is_found(
            jitter in prop::collection::vec(-250_000i64..250_000, 400),
            lost in prop::collection::btree_set(1usize..399, 0..20),
        ) {
            let times = jitter.iter().enumerate().filter(|(k, _)| !lost.contains(k));
            let pace = pace(times.map(|(k, late)| k as i64 * MS + late));
            prop_assert!(pace.missing().unwrap().abs_diff(lost.len() as u64) <= 1, "{:?}", pace.missing());
            prop_assert!((pace.rate().unwrap() / 1000.0 - 1.0).abs() < 6e-3, "{:?}", pace.rate());
        }
    }
}
