//! Selects the estimates that count, with their times on one clock.

use super::clock;
use super::given::{HeldAt, Timed};
use super::series::Series;
use crate::geometry::Attitude;
use crate::time::SimTime;

/// The estimates that count, by index, with their times.
pub(super) struct Stamped {
    of: Vec<usize>,
    times: Vec<i64>,
    pub is_echoed: bool,
}

impl Stamped {
    /// Selects estimates with the most common kind of stamp and a valid attitude.
    pub fn of(estimates: &[Timed]) -> Stamped {
        let kind = |stamp: HeldAt| match stamp {
            HeldAt::Sample(_) => 0,
            HeldAt::Own(_) => 1,
            HeldAt::Arrival => 2,
        };
        let count = |of: usize| estimates.iter().filter(|estimate| kind(estimate.stamp) == of).count();
        let most = (0..3).max_by_key(|&of| (count(of), 2 - of)).unwrap_or(0);
        let is_good = |estimate: &Timed| {
            estimate.attitude.q.is_finite() && (0.5..2.0).contains(&estimate.attitude.q.length())
        };
        let counts = |i: &usize| kind(estimates[*i].stamp) == most && is_good(&estimates[*i]);
        let of: Vec<usize> = (0..estimates.len()).filter(counts).collect();
        let arrivals: Vec<i64> = of.iter().map(|&i| estimates[i].arrival.0).collect();
        let stamp = |&i: &usize| match estimates[i].stamp {
            HeldAt::Sample(t) => t.0,
            HeldAt::Own(t) => t,
            HeldAt::Arrival => estimates[i].arrival.0,
        };
        let stamps: Vec<i64> = of.iter().map(stamp).collect();
        let times = if most == 1 { clock::runs_onto_ours(&stamps, &arrivals) } else { stamps };
        Stamped { of, times, is_echoed: most == 0 }
    }

    /// Their attitudes, or others of the same estimates.
    pub fn series(&self, attitude: impl Fn(usize) -> Attitude) -> Series {
        Series::new(self.times.iter().zip(&self.of).map(|(t, &i)| (*t, attitude(i))))
    }

    /// The median of arrival minus the time it held, ms.
    pub fn delay_ms(&self, estimates: &[Timed], delay: i64) -> Option<f64> {
        let late = |(&i, &t): (&usize, &i64)| estimates[i].arrival.0 - (t - delay);
        let mut delays: Vec<i64> = self.of.iter().zip(&self.times).map(late).collect();
        delays.sort_unstable();
        delays.get(delays.len() / 2).map(|&ns| ns as f64 * 1e-6)
    }

    /// When each estimate held, if those that count are `delay` ns late by their times.
    pub fn held(&self, estimates: &[Timed], delay: i64) -> Vec<SimTime> {
        let late = self.delay_ms(estimates, delay).map_or(0, |ms| libm::round(ms * 1e6) as i64);
        let mut held: Vec<_> = estimates.iter().map(|estimate| estimate.arrival - SimTime(late)).collect();
        for (&i, &t) in self.of.iter().zip(&self.times) {
            held[i] = SimTime(t.saturating_sub(delay));
        }
        held
    }
}
