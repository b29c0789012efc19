use super::*;
use crate::random::normals;
use crate::random::ziggurat::{self, Table};

/// Enough for 250 beyond 4 σ.
const N: usize = 4_000_000;

fn numbers(seed: u64, name: &str, n: usize) -> Vec<f64> {
    let mut source = normals(seed, name, [true, false, false]);
    let mut numbers = Vec::with_capacity(n);
    source.runs(n, |_, [x, ..]| numbers.extend(x));
    numbers
}

/// The part of the normal distribution below `x`.
fn below(x: f64) -> f64 {
    0.5 * libm::erfc(-x * std::f64::consts::FRAC_1_SQRT_2)
}

/// By how many of their own standard errors counts differ from these probabilities altogether: Pearson's χ², of which
/// the mean is its degrees of freedom and the variance twice that.
fn misfit(counts: &[u64], probabilities: &[f64]) -> f64 {
    let n = counts.iter().sum::<u64>() as f64;
    let term = |(count, p): (&u64, &f64)| (*count as f64 - n * p).powi(2) / (n * p);
    let freedom = counts.len() as f64 - 1.0;
    (counts.iter().zip(probabilities).map(term).sum::<f64>() - freedom) / libm::sqrt(2.0 * freedom)
}

/// Against 256 cells of the same probability.
fn misfit_evenly(numbers: &[f64]) -> f64 {
    let mut counts = [0; 256];
    numbers.iter().for_each(|&x| counts[((below(x) * 256.0) as usize).min(255)] += 1);
    misfit(&counts, &[1.0 / 256.0; 256])
}

/// Against cells that end where the ziggurat's layers do: whatever is wrong with what lies beside the density is here.
fn misfit_at_edges(numbers: &[f64]) -> f64 {
    let edges: Vec<f64> = Table::new().edges().iter().rev().copied().collect();
    let mut counts = vec![0; 2 * edges.len()];
    for x in numbers {
        let cell = edges.partition_point(|&edge| edge <= x.abs());
        counts[if *x < 0.0 { cell - 1 } else { edges.len() + cell - 1 }] += 1;
    }
    let ends = edges.iter().skip(1).copied().chain([f64::INFINITY]);
    let one_side: Vec<_> = edges.iter().zip(ends).map(|(from, to)| below(-from) - below(-to)).collect();
    misfit(&counts, &[&one_side[..], &one_side].concat())
}

/// The largest of the first four moments' errors, in their standard errors.
fn worst_moment(numbers: &[f64]) -> f64 {
    let n = numbers.len() as f64;
    // The mean and the variance of each power of a standard normal number.
    let powers = [(1, 0.0, 1.0), (2, 1.0, 2.0), (3, 0.0, 15.0), (4, 3.0, 96.0f64)];
    let error = |(power, mean, variance): (i32, f64, f64)| {
        let found = numbers.iter().map(|x| x.powi(power)).sum::<f64>() / n;
        (found - mean).abs() / libm::sqrt(variance / n)
    };
    powers.into_iter().map(error).fold(0.0, f64::max)
}

/// The largest error of the counts beyond 3, 3.5, … σ on either side, in their standard errors.
fn worst_tail(numbers: &[f64]) -> f64 {
    let error = |k: i32| {
        let (from, n) = (0.5 * f64::from(k), numbers.len() as f64);
        let expected = n * below(-from);
        [1.0, -1.0].map(|sign| {
            let count = numbers.iter().filter(|&x| sign * x > from).count() as f64;
            (count - expected).abs() / libm::sqrt(expected)
        })
    };
    (6..=9).flat_map(error).fold(0.0, f64::max)
}

/// The greatest correlation of one number with another so many places on, in its standard error.
fn worst_correlation(a: &[f64], b: &[f64], lags: Range<usize>) -> f64 {
    let correlation = |lag: usize| {
        let pairs = a.iter().zip(&b[lag..]);
        pairs.map(|(a, b)| a * b).sum::<f64>().abs() / libm::sqrt((b.len() - lag) as f64)
    };
    lags.map(correlation).fold(0.0, f64::max)
}

#[test]
fn their_distribution_is_the_normal_one_to_its_tails() {
    let mut numbers = numbers(7, "gyro/white_noise", N);
    assert!(misfit_evenly(&numbers).abs() < 5.0, "{}", misfit_evenly(&numbers));
    assert!(misfit_at_edges(&numbers).abs() < 5.0, "{}", misfit_at_edges(&numbers));
    assert!(worst_moment(&numbers) < 4.5, "{}", worst_moment(&numbers));
    assert!(worst_tail(&numbers) < 4.5, "{}", worst_tail(&numbers));
    // Each of these sees what is wrong: a hundredth too wide; nothing beyond 4 σ.
    numbers.iter_mut().for_each(|x| *x = (*x * 1.01).clamp(-4.0, 4.0));
    assert!(misfit_evenly(&numbers) > 5.0 && misfit_at_edges(&numbers) > 5.0);
    assert!(worst_moment(&numbers) > 4.5 && worst_tail(&numbers) > 4.5);
}

#[test]
fn beyond_the_last_layer_the_density_goes_on() {
    let mut rest = Stream::seed_from_u64(3);
    let mut counts = [0; 100];
    let whole = below(-ziggurat::R);
    for _ in 0..200_000 {
        let x = ziggurat::tail(&mut rest);
        counts[((below(-x) / whole * 100.0) as usize).min(99)] += 1;
    }
    assert!(misfit(&counts, &[0.01; 100]).abs() < 5.0);
}

/// Lanes take turns and chunks follow each other within these lags.
#[test]
fn a_number_tells_nothing_of_those_after_it() {
    let (n, lags) = (300_000, 1..2 * CHUNK + 2);
    let numbers = numbers(1, "accel/bias_walk", n);
    assert!(worst_correlation(&numbers, &numbers, lags.clone()) < 5.0);
    let scaled = |x: &f64| (x * x - 1.0) / libm::sqrt(2.0);
    let squares: Vec<_> = numbers.iter().map(scaled).collect();
    assert!(worst_correlation(&squares, &squares, lags.clone()) < 5.0);
    // Two in a hundred from the same lane before is seen.
    let echo: Vec<_> =
        (0..n).map(|i| numbers[i] + 0.02 * if i < 16 { 0.0 } else { numbers[i - 16] }).collect();
    assert!(worst_correlation(&echo, &echo, lags) > 5.0);
}

#[test]
fn another_seed_name_or_axis_gives_numbers_that_have_nothing_to_do_with_these() {
    let n = 200_000;
    let first = numbers(7, "gyro/white_noise", n);
    assert_eq!(first, numbers(7, "gyro/white_noise", n));
    for (seed, name) in [(8, "gyro/white_noise"), (7, "accel/white_noise"), (7, "gyro/bias_walk")] {
        let other = numbers(seed, name, n);
        assert!(worst_correlation(&first, &other, 0..CHUNK) < 5.0, "{seed} {name}");
    }
    let mut source = normals(7, "gyro/white_noise", [true; 3]);
    let axes: Vec<_> = (0..n).map(|_| source.draw()).collect();
    let [x, y, z] = [0, 1, 2].map(|axis| axes.iter().map(|axes| axes[axis]).collect::<Vec<_>>());
    assert_eq!(x, first, "an axis beside it changes nothing");
    for (a, b) in [(&x, &y), (&y, &z), (&z, &x)] {
        assert!(worst_correlation(a, b, 0..CHUNK) < 5.0);
    }
}

#[test]
fn they_come_in_one_order_however_many_are_taken_at_once() {
    let all = numbers(7, "mag/flicker/0", 1000);
    let mut source = normals(7, "mag/flicker/0", [true, false, true]);
    let mut taken: Vec<f64> = Vec::new();
    // 1, 2, 3 … and more than is made at once.
    for count in (1..=25).chain([64, 65, 128, 200, 1]) {
        let before = taken.len();
        source.runs(count, |at, [x, y, z]| {
            assert!(at.start == taken.len() - before && at.len() == x.len() && x.len() == y.len());
            assert!(y.iter().all(|&y| y == 0.0) && z.iter().all(|&z| z != 0.0) && z.len() == x.len());
            taken.extend(x);
        });
        assert_eq!(taken.len(), before + count);
    }
    assert_eq!(taken, all[..taken.len()]);
    let mut source = normals(7, "mag/flicker/0", [true, false, true]);
    assert_eq!((0..1000).map(|_| source.draw()[0]).collect::<Vec<_>>(), all);
    let mut source = normals(7, "mag/flicker/0", [true, false, true]);
    let mut columns = [(); 3].map(|()| vec![1.0; 1000]);
    for part in 0..4 {
        let columns = columns.each_mut().map(|column| &mut column[250 * part..][..250]);
        source.zip(columns, |axis, value, n| *value += n * axis as f64);
    }
    assert!(columns[0].iter().chain(&columns[1]).all(|&value| value == 1.0));
    assert!(columns[2].iter().all(|&value| value != 1.0));
}

/// On a processor without AVX2 both are the same code.
#[test]
fn wider_vectors_change_no_bit() {
    let (mut plain, mut wide) = (Axis::new(9), Axis::new(9));
    let (mut a, mut b) = ([0.0; CHUNK], [0.0; CHUNK]);
    for _ in 0..20_000 {
        plain.fill(&mut a);
        os::widest(|| wide.fill(&mut b));
        assert_eq!(a.map(f64::to_bits), b.map(f64::to_bits));
    }
}
