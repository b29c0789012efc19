use super::*;
use crate::random::normals;

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
    assert!(worst_moment(&numbers) < 4.5, "{}", worst_moment(&numbers));
    assert!(worst_tail(&numbers) < 4.5, "{}", worst_tail(&numbers));
    // Each of these sees what is wrong: a hundredth too wide; nothing beyond 4 σ.
    numbers.iter_mut().for_each(|x| *x = (*x * 1.01).clamp(-4.0, 4.0));
    assert!(misfit_evenly(&numbers) > 5.0);
    assert!(worst_moment(&numbers) > 4.5 && worst_tail(&numbers) > 4.5);
}

/// Where a radius takes 53 bits more, beyond 4.08 σ, its square halved goes on as an exponential distribution.
#[test]
fn beyond_the_bits_of_a_word_the_tail_goes_on() {
    let mut rest = Stream::seed_from_u64(3);
    let mut counts = [0; 100];
    for k in 0..6_000u64 {
        // Words whose upper half is below 2⁻¹², at random.
        let words: [u64; PAIRS] = std::array::from_fn(|_| rest.next_u64() >> 12);
        let mut normals = [0.0; CHUNK];
        box_muller::convert::<Standard>(&words, &mut normals, &mut rest);
        for j in 0..PAIRS {
            let square = normals[j] * normals[j] + normals[PAIRS + j] * normals[PAIRS + j];
            let part = libm::exp(-0.5 * square) * 4096.0;
            assert!(part < 1.0 + 1e-6, "{k} {j}: {part}");
            counts[((part * 100.0) as usize).min(99)] += 1;
        }
    }
    assert!(misfit(&counts, &[0.01; 100]).abs() < 5.0);
}

/// Mean powers of a periodogram in bands of frequency, in standard errors from those of white noise: the worst.
fn worst_band(numbers: &[f64]) -> f64 {
    const LENGTH: usize = 1024;
    const BANDS: usize = 32;
    let fourier = rustfft::FftPlanner::new().plan_fft_forward(LENGTH);
    let mut powers = [0.0; BANDS];
    let stretches = numbers.as_chunks::<LENGTH>().0;
    for stretch in stretches {
        let mut values = stretch.map(|re| rustfft::num_complex::Complex { re, im: 0.0 });
        fourier.process(&mut values);
        // Without the mean and the highest frequency, whose powers have another distribution.
        for (k, value) in values.iter().enumerate().take(LENGTH / 2).skip(1) {
            powers[k * BANDS / (LENGTH / 2)] += value.norm_sqr() / LENGTH as f64;
        }
    }
    let count = |band: usize| (stretches.len() * (LENGTH / 2 / BANDS - usize::from(band == 0))) as f64;
    let error = |(band, power): (usize, f64)| (power / count(band) - 1.0).abs() * libm::sqrt(count(band));
    powers.into_iter().enumerate().map(error).fold(0.0, f64::max)
}

/// The Allan variance at averages of 1, 2, 4 … numbers over that of white noise, 1/m, in standard errors of such an
/// estimate, √(3/(n/m)): the worst.
fn worst_allan(numbers: &[f64]) -> f64 {
    let error = |power: u32| {
        let m = 1usize << power;
        let means: Vec<f64> =
            numbers.chunks_exact(m).map(|part| part.iter().sum::<f64>() / m as f64).collect();
        let steps = means.windows(2).map(|pair| (pair[1] - pair[0]).powi(2));
        let variance = steps.sum::<f64>() / (2.0 * (means.len() - 1) as f64);
        (variance * m as f64 - 1.0).abs() / libm::sqrt(3.0 / means.len() as f64)
    };
    (0..=10).map(error).fold(0.0, f64::max)
}

#[test]
fn they_are_white_at_every_frequency_and_over_every_time() {
    let mut numbers = numbers(5, "gyro/white_noise", 1 << 20);
    assert!(worst_band(&numbers) < 5.0, "{}", worst_band(&numbers));
    assert!(worst_allan(&numbers) < 5.0, "{}", worst_allan(&numbers));
    // A walk of a hundredth beside them is seen over long times, a twentieth of the number before at high frequencies.
    let mut walk = 0.0;
    let walked: Vec<_> = numbers
        .iter()
        .rev()
        .map(|n| {
            walk += 0.001 * n;
            walk
        })
        .collect();
    let wandering: Vec<_> = numbers.iter().zip(&walked).map(|(n, walk)| n + walk).collect();
    assert!(worst_allan(&wandering) > 5.0);
    (1..numbers.len()).rev().for_each(|i| numbers[i] += 0.05 * numbers[i - 1]);
    assert!(worst_band(&numbers) > 5.0);
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
    // Two streams of one seed are one.
    assert!(worst_correlation(&first, &numbers(7, "gyro/white_noise", n), 0..CHUNK) > 100.0);
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
