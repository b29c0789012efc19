//! The paired comparison: a figure of two scenes over the same seeds, and whether they are the same.
//!
//! Seed i gives one figure with a term and one without; their differences dᵢ share the noise of everything else, so
//! that it cancels. The interval of the mean difference is `d̄ ± t·s/√n`, t the quantile of Student's distribution with
//! n − 1 degrees of freedom. Two scenes are *the same* where the whole interval lies within ± a margin (two one-sided
//! tests; D. J. Schuirmann, *J. Pharmacokinetics and Biopharmaceutics* 15, 1987), *different* where all of it lies
//! outside. Anything else is not known yet.

use serde::{Serialize, Serializer};
use std::f64::consts::FRAC_2_PI;

/// The share of intervals that hold the true mean.
pub const CONFIDENCE: f64 = 0.95;

/// Whether two scenes give the same figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finding {
    /// The interval lies within ± the margin.
    Same,
    /// The interval lies outside of it.
    Different,
    /// The interval reaches both.
    Undecided,
}

impl Serialize for Finding {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(match self {
            Finding::Same => "same",
            Finding::Different => "different",
            Finding::Undecided => "undecided",
        })
    }
}

/// A mean of paired differences, in the figures' unit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Paired {
    /// The mean of what is more without.
    pub mean: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// Half of its interval's length at [`CONFIDENCE`].
    pub half: f64,
    /// How many pairs.
    pub pairs: usize,
}

impl Paired {
    /// Of `without − with`, pair by pair; `None` for fewer than two pairs.
    pub fn of(with: &[f64], without: &[f64]) -> Option<Paired> {
        let n = with.len().min(without.len());
        if n < 2 {
            return None;
        }
        let differences = || with.iter().zip(without).map(|(with, without)| without - with);
        let mean = differences().sum::<f64>() / n as f64;
        let squares: f64 = differences().map(|difference| (difference - mean).powi(2)).sum();
        let standard_error = libm::sqrt(squares / ((n - 1) * n) as f64);
        Some(Paired { mean, standard_error, half: quantile(n - 1) * standard_error, pairs: n })
    }

    /// The end of the interval that is farther from zero, without its sign.
    pub fn bound(&self) -> f64 {
        self.mean.abs() + self.half
    }

    /// Whether the two are the same within ± `margin`. What is not a number is different from everything.
    pub fn finding(&self, margin: f64) -> Finding {
        if self.bound() <= margin {
            Finding::Same
        } else if self.mean.abs() - self.half <= margin {
            Finding::Undecided
        } else {
            Finding::Different
        }
    }

    /// About how many pairs would decide it, if the spread stays as it is: as many as narrow the interval to the gap
    /// between mean and margin. A mean that may as well be zero is taken for zero.
    pub fn pairs_to_decide(&self, margin: f64) -> f64 {
        let mean = if self.mean.abs() < self.half { 0.0 } else { self.mean.abs() };
        libm::ceil((self.half / (mean - margin).abs()).powi(2) * self.pairs as f64)
    }
}

/// t such that a share of [`CONFIDENCE`] of Student's distribution lies within ± t.
pub fn quantile(degrees: usize) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    while within(high, degrees) < CONFIDENCE {
        high *= 2.0;
    }
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if within(middle, degrees) < CONFIDENCE { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// The share of Student's distribution within ± t: the finite series for whole degrees of freedom (M. Abramowitz, I. A.
/// Stegun, *Handbook of Mathematical Functions*, 1964, eq. 26.7.3 and 26.7.4).
fn within(t: f64, degrees: usize) -> f64 {
    let angle = libm::atan(t / libm::sqrt(degrees as f64));
    let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
    let odd = degrees % 2 == 1;
    // 1 + 1/2·cos² + (1·3)/(2·4)·cos⁴ …, or cos + 2/3·cos³ + (2·4)/(3·5)·cos⁵ …
    let (mut factor, mut sum) = (if odd { cosine } else { 1.0 }, 0.0);
    let first = if odd { 1 } else { 0 };
    for power in (first..=degrees.saturating_sub(2)).step_by(2) {
        sum += factor;
        factor *= cosine * cosine * (power + 1) as f64 / (power + 2) as f64;
    }
    match (odd, degrees) {
        (_, 0) => 0.0,
        (true, 1) => FRAC_2_PI * angle,
        (true, _) => FRAC_2_PI * (angle + sine * sum),
        (false, _) => sine * sum,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        // Abramowitz & Stegun, table 26.10, Q = 0.025.
        for (degrees, t) in [
            (1, 12.706),
            (2, 4.303),
            (3, 3.182),
            (4, 2.776),
            (5, 2.571),
            (9, 2.262),
            (10, 2.228),
            (19, 2.093),
            (30, 2.042),
            (120, 1.980),
        ] {
            assert!((quantile(degrees) - t).abs() < 6e-4, "{degrees}: {} for {t}", quantile(degrees));
        }
        // To the normal distribution's.
        assert!((quantile(100_000) - 1.959_964).abs() < 1e-4);
    }

    #[test]
    fn an_interval_holds_the_true_mean_as_often_as_it_says() {
        let mut normals = random::normals(3, "paired", [true; 3]);
        let (trials, true_mean) = (4000, 0.3);
        let mut held = 0;
        for _ in 0..trials {
            let differences: Vec<f64> = (0..6).map(|_| true_mean + normals.draw()[0]).collect();
            let paired = Paired::of(&[0.0; 6], &differences).unwrap();
            held += usize::from((paired.mean - true_mean).abs() <= paired.half);
        }
        let share = held as f64 / f64::from(trials);
        let sigma = libm::sqrt(CONFIDENCE * (1.0 - CONFIDENCE) / f64::from(trials));
        assert!((share - CONFIDENCE).abs() < 4.0 * sigma, "{share}");
    }

    #[test]
    fn what_all_pairs_share_cancels_and_the_interval_decides() {
        let with: Vec<f64> = (0..20).map(|i| 10.0 + f64::from(i)).collect();
        let more = |size: f64, spread: f64| {
            let off = |(i, with): (usize, &f64)| with + size + if i % 2 == 0 { spread } else { -spread };
            Paired::of(&with, &with.iter().enumerate().map(off).collect::<Vec<_>>()).unwrap()
        };
        let small = more(0.05, 0.1);
        assert!((small.mean - 0.05).abs() < 1e-12 && small.standard_error < 0.03, "{small:?}");
        assert_eq!(small.finding(0.2), Finding::Same);
        assert_eq!(more(0.5, 0.1).finding(0.2), Finding::Different);
        assert_eq!(more(-0.5, 0.1).finding(0.2), Finding::Different);
        let unsure = more(0.05, 2.0);
        assert_eq!(unsure.finding(0.2), Finding::Undecided, "a wide interval proves nothing");
        // With as many pairs as it says the interval just reaches the margin, from zero or from a mean that is not zero.
        let clear = more(0.19, 0.1);
        assert_eq!(clear.finding(0.2), Finding::Undecided);
        for (paired, mean) in [(unsure, 0.0), (clear, 0.19)] {
            let pairs = paired.pairs_to_decide(0.2);
            let half = paired.half * libm::sqrt(20.0 / pairs);
            assert!((mean + half - 0.2).abs() < 1e-3 && pairs > 20.0, "{pairs}");
        }
        assert_eq!(more(0.0, 0.0).finding(0.0), Finding::Same);
        assert_eq!(Paired::of(&[1.0], &[2.0]), None);
        let lost = Paired::of(&[1.0, 1.0], &[f64::NAN, 1.0]).unwrap();
        assert_eq!(lost.finding(1e9), Finding::Different);
    }
}
