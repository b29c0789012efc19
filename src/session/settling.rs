//! Whether an estimator that is fed the vehicle at rest has settled: what it says agrees with the rest, or does not
//! change any more, or has had its time.
//!
//! A controller that booted before the run, or was left at another heading, first turns to the new attitude. A scene
//! that starts meanwhile is judged on that turn (INAV, measured: up to 1.3 degrees in place of 0.12).

use crate::report::number;
use crate::time::{NANOS, SimTime};
use std::collections::VecDeque;

/// It agrees when it is no further off than this, degrees, ...
const AGREES: f64 = 0.5;
/// ... for this long, ns.
const AGREES_FOR: i64 = 2 * NANOS;
/// It is steady when its error changes by no more than this, degrees, ...
const STEADY: f64 = 0.1;
/// ... for this long, ns. Such an error is that of its sensors, or of a heading that nothing tells it.
const STEADY_FOR: i64 = 10 * NANOS;
/// How long after the rest a scene needs it has to settle, ns.
const PATIENCE: i64 = 20 * NANOS;
/// An estimator that is not heard has this long from its first answer on, ns: PX4 as a program was seen to need up to
/// 25 s of wall time to boot.
const UNHEARD: i64 = 25 * NANOS;
/// Errors closer in time are merged, ns.
const GRAIN: i64 = NANOS / 10;

/// The errors of the last seconds at rest.
#[derive(Debug)]
pub(super) struct Settling {
    /// How long the vehicle rests at least, ns.
    rest: i64,
    first: Option<i64>,
    /// When it first took a packet, ns, where that is told.
    fed: Option<i64>,
    grains: VecDeque<Grain>,
    settled: bool,
}

/// The least and the greatest of merged errors, degrees; the first came at `t`, ns.
#[derive(Clone, Copy, Debug)]
struct Grain {
    t: i64,
    low: f64,
    high: f64,
}

impl Settling {
    /// For a vehicle that rests at least this long.
    pub(super) fn new(rest: SimTime) -> Settling {
        Settling { rest: rest.0, first: None, fed: None, grains: VecDeque::new(), settled: false }
    }

    /// Whether it has settled.
    pub(super) fn is_settled(&self) -> bool {
        self.settled
    }

    /// Takes an estimate that is `off` by so many degrees at `now`, ns. Returns how it has settled, once.
    pub(super) fn take(&mut self, off: f64, now: i64) -> Option<String> {
        if self.settled {
            return None;
        }
        let first = *self.first.get_or_insert(now);
        match self.grains.back_mut().filter(|grain| now - grain.t < GRAIN) {
            Some(grain) => (grain.low, grain.high) = (grain.low.min(off), grain.high.max(off)),
            None => self.grains.push_back(Grain { t: now, low: off, high: off }),
        }
        while self.grains.get(1).is_some_and(|second| now - second.t >= STEADY_FOR) {
            self.grains.pop_front();
        }
        let how = if self.over(AGREES_FOR, now).is_some_and(|(_, high)| high <= AGREES) {
            format!("its attitude agrees with the rest within {AGREES} deg")
        } else if self.over(STEADY_FOR, now).is_some_and(|(low, high)| high - low <= STEADY) {
            format!("its attitude has settled {} deg off the rest", number(off))
        } else if now - first >= self.rest + PATIENCE {
            let waited = (now - first) / NANOS;
            format!(
                "its attitude is still {} deg off the rest after {waited} s: the scene starts all the same",
                number(off)
            )
        } else {
            return None;
        };
        self.settled = true;
        Some(how)
    }

    /// It took a packet at `now`, ns.
    pub(super) fn feed(&mut self, now: i64) {
        self.fed.get_or_insert(now);
    }

    /// Whether it is not waited for any longer, because nothing is heard of it. Returns a notice.
    pub(super) fn give_up(&mut self, now: i64) -> Option<String> {
        let waited = now - self.fed.filter(|_| self.first.is_none() && !self.settled)?;
        (waited >= UNHEARD).then(|| {
            self.settled = true;
            format!(
                "its attitude is not heard: the scene starts {} s after its first answer",
                UNHEARD / NANOS
            )
        })
    }

    /// What is known of one that has not settled.
    pub(super) fn why_not(&self) -> Option<String> {
        let off = self.grains.back().filter(|_| !self.settled)?.high;
        Some(format!("its attitude is {} deg off the rest and still changes", number(off)))
    }

    /// The least and the greatest error of the last `span` ns, once they are covered.
    fn over(&self, span: i64, now: i64) -> Option<(f64, f64)> {
        let covered = self.first.is_some_and(|first| now - first >= span);
        let last = self.grains.iter().filter(|grain| now - grain.t < span);
        let ends =
            last.fold((f64::INFINITY, 0.0_f64), |(low, high), it| (low.min(it.low), high.max(it.high)));
        covered.then_some(ends)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// When, in seconds, and how one settles whose error at `t` seconds is `off`.
    fn settles(rest: i64, off: impl Fn(f64) -> f64) -> Option<(f64, String)> {
        let mut settling = Settling::new(SimTime(rest * NANOS));
        (0..20_000).find_map(|k| {
            let t = f64::from(k) * 0.01;
            let how = settling.take(off(t), k as i64 * 10_000_000)?;
            assert!(settling.is_settled() && settling.take(90.0, i64::from(k + 1) * 10_000_000).is_none());
            Some((t, how))
        })
    }

    #[test]
    fn one_that_agrees_is_ready_after_two_seconds_of_it() {
        let (t, how) = settles(20, |_| 0.3).unwrap();
        assert_eq!((t, how.as_str()), (2.0, "its attitude agrees with the rest within 0.5 deg"));
        // 90 degrees off with a time constant of 2 s: half a degree after 10.4 s.
        let (t, how) = settles(20, |t| 90.0 * libm::exp(-t / 2.0)).unwrap();
        assert!((12.3..12.6).contains(&t) && how.contains("agrees"), "{t}: {how}");
    }

    #[test]
    fn one_that_stays_off_is_ready_when_its_error_no_longer_changes() {
        // 20 mg of bias are 1.15 degrees of tilt.
        let (t, how) = settles(20, |t| 1.15 + 5.0 * libm::exp(-t)).unwrap();
        assert!((13.0..16.0).contains(&t), "{t}");
        assert_eq!(how, "its attitude has settled 1.15 deg off the rest");
    }

    #[test]
    fn one_that_never_settles_has_its_time_and_that_is_said() {
        let (t, how) = settles(20, |t| 10.0 + t).unwrap();
        assert_eq!(t, 40.0);
        assert_eq!(
            how,
            "its attitude is still 50 deg off the rest after 40 s: the scene starts all the same"
        );
        let mut unheard = Settling::new(SimTime(0));
        assert_eq!(unheard.give_up(100 * NANOS), None, "it took nothing yet");
        unheard.feed(3 * NANOS);
        assert_eq!(unheard.give_up(27 * NANOS), None);
        assert!(unheard.give_up(28 * NANOS).unwrap().contains("25 s after its first answer"));
        assert!(unheard.is_settled() && unheard.give_up(29 * NANOS).is_none());
        let mut settling = Settling::new(SimTime(0));
        assert_eq!(settling.why_not(), None);
        settling.take(3.0, 0);
        assert_eq!(settling.why_not().unwrap(), "its attitude is 3 deg off the rest and still changes");
    }
}
