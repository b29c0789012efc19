//! The similarity of two series of angular rates, at all lags at once.
//!
//! At the lag `l`, `aᵢ` of one series meets `bᵢ₊ₗ` of the other. With their sums of squares `A` and `B` and the
//! matrix `C = Σ aᵢ bᵢ₊ₗᵀ`, all over cells known in both, they differ by `A + B − 2·tr C`. After the rotation that
//! brings them closest ([`Products::best_turn`]) the trace is larger. Fourier transforms give the sums, so that all
//! lags of an hour take about a second.

use super::rates::Rates;
use super::turn::Products;
use glam::DVec3;
use rustfft::num_complex::Complex64;
use rustfft::{Fft, FftPlanner};
use std::sync::Arc;

/// The sums at every lag.
pub(super) struct Sums {
    /// By how many cells the second is ahead at the first lag.
    first: i64,
    /// Pairs of cells known in both.
    count: Vec<f64>,
    squares: [Vec<f64>; 2],
    products: [Vec<f64>; 9],
}

/// The agreement of two series of rates at one lag.
#[derive(Clone, Copy, Debug)]
pub(super) struct Alike {
    /// The number of cells known in both.
    pub cells: f64,
    /// Mean squares of the two, (rad/s)².
    pub squares: [f64; 2],
    /// The mean square of their difference, (rad/s)².
    pub apart: f64,
}

/// Rates smaller than this contain no information, rad/s.
const FLOOR: f64 = 0.003;

impl Alike {
    /// The information of one about the other, in nats: `n/2·ln(B/(A + B − 2·C))` of `n` cells, both with the
    /// floor.
    pub fn information(&self) -> f64 {
        0.5 * self.cells * libm::log(self.floored(self.squares[1]) / self.floored(self.apart))
    }

    /// The share of the squares of both that they have in common, at most 1.
    pub fn share(&self) -> f64 {
        1.0 - self.apart / self.squares[0].min(self.squares[1]).max(f64::MIN_POSITIVE)
    }

    /// By what factor the difference is larger than the other's.
    pub fn worse_than(&self, other: &Alike) -> f64 {
        self.floored(self.apart) / self.floored(other.apart)
    }

    fn floored(&self, square: f64) -> f64 {
        square + FLOOR * FLOOR
    }
}

impl Sums {
    /// The sums of two series of rates with the same step.
    pub fn new(a: &Rates, b: &Rates) -> Sums {
        let (n, m) = (a.values.len(), b.values.len());
        let fourier = Transform::new(n + m);
        let spectra = |rates: &Rates| {
            let rate = |i: usize| if rates.known[i] { rates.values[i] } else { DVec3::ZERO };
            let all = || (0..rates.values.len()).map(rate);
            let axis = |axis: usize| fourier.spectrum(all().map(|rate| rate[axis]));
            let known = rates.known.iter().map(|known| f64::from(u8::from(*known)));
            let squares = fourier.spectrum(all().map(|rate| rate.length_squared()));
            ([axis(0), axis(1), axis(2)], fourier.spectrum(known), squares)
        };
        let ((ra, known_a, square_a), (rb, known_b, square_b)) = (spectra(a), spectra(b));
        let (lags, back) = ((n + m).saturating_sub(1), n.saturating_sub(1));
        let of = |x: &[Complex64], y: &[Complex64]| fourier.correlation(x, y, lags, back);
        Sums {
            first: b.first - a.first - (n as i64 - 1),
            count: of(&known_a, &known_b),
            squares: [of(&square_a, &known_b), of(&known_a, &square_b)],
            products: std::array::from_fn(|i| of(&ra[i / 3], &rb[i % 3])),
        }
    }

    /// The number of lags.
    pub fn len(&self) -> usize {
        self.count.len()
    }

    /// By how many cells the second is ahead at lag number `i`.
    pub fn ahead(&self, i: usize) -> i64 {
        self.first + i as i64
    }

    /// The agreement at lag number `i`; `free` allows a rotation of the second's body axes.
    pub fn at(&self, i: usize, free: bool) -> Alike {
        let cells = libm::round(self.count[i]).max(0.0);
        let per = 1.0 / cells.max(1.0);
        let squares = [self.squares[0][i].max(0.0) * per, self.squares[1][i].max(0.0) * per];
        let products = Products(std::array::from_fn(|k| self.products[k][i] * per));
        let common = if free { products.best_turn().1 } else { products.trace() };
        Alike { cells, squares, apart: (squares[0] + squares[1] - 2.0 * common).max(0.0) }
    }
}

/// Fourier transforms of one length.
struct Transform {
    length: usize,
    forward: Arc<dyn Fft<f64>>,
    inverse: Arc<dyn Fft<f64>>,
}

impl Transform {
    /// A transform of the next power of two.
    fn new(least: usize) -> Transform {
        let length = least.next_power_of_two();
        let mut planner = FftPlanner::new();
        Transform {
            length,
            forward: planner.plan_fft_forward(length),
            inverse: planner.plan_fft_inverse(length),
        }
    }

    fn spectrum(&self, values: impl Iterator<Item = f64>) -> Vec<Complex64> {
        let mut buffer: Vec<_> = values.map(Complex64::from).collect();
        buffer.resize(self.length, Complex64::default());
        self.forward.process(&mut buffer);
        buffer
    }

    /// `Σ xᵢ yᵢ₊ₗ` at `lags` lags from `−back` on.
    fn correlation(&self, x: &[Complex64], y: &[Complex64], lags: usize, back: usize) -> Vec<f64> {
        let mut product: Vec<_> = x.iter().zip(y).map(|(x, y)| x.conj() * y).collect();
        self.inverse.process(&mut product);
        let scale = 1.0 / self.length as f64;
        (0..lags).map(|lag| product[(lag + self.length - back) % self.length].re * scale).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{exp, rotate};

    /// Rates that never repeat, with some unknown.
    fn rates(first: i64, values: impl Fn(f64) -> DVec3, count: usize) -> Rates {
        let at = |i: usize| values((first + i as i64) as f64 * 0.02);
        Rates {
            first,
            step: 20_000_000,
            values: (0..count).map(at).collect(),
            known: (0..count).map(|i| i % 17 != 3).collect(),
        }
    }

    fn motion(t: f64) -> DVec3 {
        DVec3::new(libm::sin(t), libm::cos(1.7 * t * t * 0.01), libm::sin(0.3 * t * t) * 0.5)
    }

    #[test]
    fn the_sums_are_those_taken_one_by_one() {
        let (a, b) = (rates(5, motion, 60), rates(-20, |t| motion(t + 0.3) * 0.9, 90));
        let sums = Sums::new(&a, &b);
        assert_eq!(sums.len(), 149);
        for i in 0..sums.len() {
            let pairs = (0..60i64).filter_map(|k| {
                let other = a.first + k + sums.ahead(i) - b.first;
                let other = usize::try_from(other).ok().filter(|other| *other < 90)?;
                (a.known[k as usize] && b.known[other]).then(|| (a.values[k as usize], b.values[other]))
            });
            let pairs: Vec<_> = pairs.collect();
            let n = pairs.len().max(1) as f64;
            let apart = pairs.iter().map(|(x, y)| (*x - *y).length_squared()).sum::<f64>() / n;
            let found = sums.at(i, false);
            assert_eq!(found.cells, pairs.len() as f64);
            assert!((found.apart - apart).abs() < 1e-9, "{} against {apart}", found.apart);
        }
    }

    #[test]
    fn a_turn_of_the_body_axes_is_no_difference_where_it_is_free() {
        let turn = exp(DVec3::new(0.5, -1.0, 2.0));
        let (a, b) = (rates(0, motion, 400), rates(0, |t| rotate(turn, motion(t)), 400));
        let sums = Sums::new(&a, &b);
        let here = (0..sums.len()).find(|&i| sums.ahead(i) == 0).unwrap();
        assert!(sums.at(here, true).share() > 1.0 - 1e-9);
        assert!(sums.at(here, false).share() < 0.5);
        assert!(sums.at(here, true).information() > 1000.0);
        assert!(sums.at(here + 60, true).worse_than(&sums.at(here, true)) > 100.0);
    }
}
