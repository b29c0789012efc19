use super::inverse::Inverse;
use super::makers::{Maker, from};
use super::*;
use std::cell::Cell;

/// Numbers of a way in a histogram.
fn histogram(maker: &mut dyn Maker, draws: usize, each: impl Fn(f64) -> f64) -> Histogram {
    let (mut histogram, mut numbers) = (Histogram::default(), [0.0; CHUNK]);
    for _ in 0..draws / CHUNK {
        maker.fill(&mut numbers);
        histogram.count(&numbers.map(&each));
    }
    histogram
}

/// The three figures in units of what chance allows: above 1 is wrong.
fn misfit(histogram: &Histogram) -> [f64; 3] {
    // Below 1.95/√n in 999 of 1000 runs; the others within 5 standard errors.
    let ks = histogram.ks() * libm::sqrt(histogram.draws() as f64) / 1.95;
    [ks, histogram.tail_z() / 5.0, histogram.variance_z() / 5.0]
}

const DRAWS: usize = 2_000_000;

#[test]
fn every_way_has_the_normal_distribution() {
    for way in &WAYS {
        let found = misfit(&histogram(&mut *(way.make)(11), DRAWS, |x| x));
        assert!(found.iter().all(|&part| part < 1.0), "{}: {found:?}", way.name);
    }
}

#[test]
fn a_wrong_entry_of_a_table_a_truncated_tail_and_a_wrong_width_are_seen() {
    let mut wrong = Inverse::<4, 3>::new();
    // Of 112 parts one in the first octave, which holds a sixteenth of the numbers.
    wrong.damage(13 * 8 + 2, 0.02);
    assert!(misfit(&histogram(&mut *from(11, wrong), DRAWS, |x| x))[0] > 1.0);
    let right = || from(11, Inverse::<4, 3>::new());
    assert!(misfit(&histogram(&mut *right(), DRAWS, |x| x.clamp(-3.5, 3.5)))[1] > 1.0);
    assert!(misfit(&histogram(&mut *right(), DRAWS, |x| x * 1.005))[2] > 1.0);
}

#[test]
fn errors_are_those_of_their_degree_and_the_standard_is_far_below_what_a_sensor_shows() {
    let error = |name: &str| {
        let way = WAYS.iter().find(|way| way.name == name).unwrap();
        way.error.unwrap()()
    };
    // Twice the parts, a fourth or more of the error for each power: 8 to 32 parts of cubics are 4⁴ apart.
    let (few, many) = (error("inverse-3x8"), error("inverse-3x32"));
    assert!((100.0..600.0).contains(&(few / many)), "{few} {many}");
    let (low, standard, high) = (error("box-muller-low"), error("box-muller"), error("box-muller-high"));
    assert!(
        high < 2e-11 && 10.0 * high < standard && standard < 6e-10 && 100.0 * standard < low,
        "{high} {standard} {low}"
    );
    assert!(error("box-muller-f32") > 1e-8);
    // A thousand million samples show a shift of 1/√10⁹ of σ.
    assert!(standard * 1e9f64.sqrt() < 1e-4);
}

#[test]
fn costs_are_by_the_clock_that_is_given() {
    let looks = Cell::new(0);
    let now = || {
        looks.set(looks.get() + 1);
        Duration::from_micros(64 * looks.get())
    };
    let rows = run(Effort { draws: 10_000 }, 2, &now, &|_, _| ());
    assert_eq!(rows.len(), WAYS.len());
    assert!(rows.iter().all(|row| (row.ns_per_number - 1.0).abs() < 1e-12 && row.draws >= 10_000));
    assert_eq!(rows.iter().filter(|row| row.is_default).count(), 1);
}
