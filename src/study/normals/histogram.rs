//! Counts of numbers in narrow cells, set against the normal distribution.

/// Cells on either side of zero.
const HALF: usize = 1 << 15;
/// Cells a σ.
const PER_SIGMA: f64 = 4096.0;

/// How many numbers fell in each cell of 1/4096 σ out to 8 σ; the outermost hold all beyond.
#[derive(Clone, Debug)]
pub(crate) struct Histogram {
    counts: Vec<u64>,
    squares: f64,
}

impl Default for Histogram {
    fn default() -> Self {
        Histogram { counts: vec![0; 2 * HALF], squares: 0.0 }
    }
}

impl Histogram {
    /// Takes in numbers.
    pub fn count(&mut self, numbers: &[f64]) {
        for x in numbers {
            let cell = (libm::floor(x * PER_SIGMA) + HALF as f64).clamp(0.0, (2 * HALF - 1) as f64);
            self.counts[cell as usize] += 1;
        }
        self.squares += numbers.iter().map(|x| x * x).sum::<f64>();
    }

    /// Takes in what another has.
    pub fn add(&mut self, other: &Histogram) {
        self.counts.iter_mut().zip(&other.counts).for_each(|(all, part)| *all += part);
        self.squares += other.squares;
    }

    /// How many numbers there are.
    pub fn draws(&self) -> u64 {
        self.counts.iter().sum()
    }

    /// The largest difference of the distribution function from the normal one, at the ends of the cells.
    pub fn ks(&self) -> f64 {
        let n = self.draws() as f64;
        let mut sum = 0;
        let mut worst = 0.0;
        for (cell, count) in self.counts.iter().enumerate().take(2 * HALF - 1) {
            sum += count;
            let end = (cell as f64 + 1.0 - HALF as f64) / PER_SIGMA;
            worst = f64::max(worst, (sum as f64 / n - below(end)).abs());
        }
        worst
    }

    /// The worst of the counts beyond 3, 4, 5 and 6 σ on either side, in standard errors; where less than one is
    /// expected, as if it were one.
    pub fn tail_z(&self) -> f64 {
        let n = self.draws() as f64;
        let error = |sigma: usize| {
            let expected = n * below(-(sigma as f64));
            let cells = HALF - sigma * PER_SIGMA as usize;
            let sides = [&self.counts[..cells], &self.counts[2 * HALF - cells..]];
            sides.map(|side| {
                (side.iter().sum::<u64>() as f64 - expected).abs() / libm::sqrt(expected.max(1.0))
            })
        };
        (3..=6).flat_map(error).fold(0.0, f64::max)
    }

    /// The error of the mean square in standard errors of it: √(2/n) for normal numbers.
    pub fn variance_z(&self) -> f64 {
        let n = self.draws() as f64;
        (self.squares / n - 1.0).abs() / libm::sqrt(2.0 / n)
    }
}

/// The part of the normal distribution below `x`.
pub(super) fn below(x: f64) -> f64 {
    0.5 * libm::erfc(-x * std::f64::consts::FRAC_1_SQRT_2)
}
