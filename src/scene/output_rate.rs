//! Which rates a part can output, and which are nearest to the one that a scene asks for.

use super::parts::{self, Filter, OutputRate};
use crate::sensor::SensorKind;
use crate::time::Rate;

/// Rates this near are one: no oscillator of these parts is as good as that (a per cent or more by their sheets).
const SAME: f64 = 0.005;

/// Whether the part can output this rate.
pub(super) fn has(rates: &[OutputRate], wanted: Rate) -> bool {
    neighbours(rates, wanted).any(|rate| (rate.as_hz() / wanted.as_hz() - 1.0).abs() < SAME)
}

/// The part's fastest rate that is not above this one; `None` where its sheet says nothing of rates.
pub fn at_most(part: &str, kind: SensorKind, most: Rate) -> Option<Rate> {
    let rates = parts::settings(crate::sensor::parts::find(part, kind)?, kind).ok()?.rates;
    let not_above = |rate: &Rate| rate.as_hz() <= most.as_hz();
    neighbours(&rates, most).filter(not_above).max_by(|a, b| a.as_hz().total_cmp(&b.as_hz()))
}

/// The part's nearest rates, the slower first.
pub(super) fn nearest(rates: &[OutputRate], wanted: Rate) -> Vec<Rate> {
    let by_hz = |a: &Rate, b: &Rate| a.as_hz().total_cmp(&b.as_hz());
    let slower = neighbours(rates, wanted).filter(|rate| rate.as_hz() < wanted.as_hz()).max_by(by_hz);
    let faster = neighbours(rates, wanted).filter(|rate| rate.as_hz() > wanted.as_hz()).min_by(by_hz);
    slower.into_iter().chain(faster).collect()
}

/// Of the settings called so, the one for the rate, else the one for the nearest.
pub(super) fn setting<'a>(
    filters: impl Iterator<Item = &'a Filter>,
    rates: &[OutputRate],
    wanted: Rate,
) -> Option<&'a Filter> {
    let off = |filter: &&Filter| {
        let rates = with(std::slice::from_ref(*filter), rates);
        let off = |rate: Rate| libm::log(rate.as_hz() / wanted.as_hz()).abs();
        neighbours(&rates, wanted).map(off).fold(f64::INFINITY, f64::min)
    };
    filters.min_by(|a, b| off(a).total_cmp(&off(b)))
}

/// The rates that go with at least one of the filters.
pub(super) fn with(filters: &[Filter], rates: &[OutputRate]) -> Vec<OutputRate> {
    let goes = |rate: &&OutputRate| {
        filters.iter().any(|filter| filter.at.is_empty() || filter.at.contains(&rate.rate))
    };
    rates.iter().filter(goes).copied().collect()
}

/// Each rate divided by the two whole numbers between which the wanted one lies.
fn neighbours(rates: &[OutputRate], wanted: Rate) -> impl Iterator<Item = Rate> {
    rates.iter().flat_map(move |output| {
        // Saturates where the wanted one is slower than any number divides to.
        let below = (output.rate.as_hz() / wanted.as_hz()) as u32;
        [below, below.saturating_add(1)]
            .into_iter()
            .filter_map(|divider| output.rate.times(1, divider.clamp(1, output.divide).into()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const MPU: [OutputRate; 2] =
        [OutputRate { rate: Rate::hz(8000), divide: 1 }, OutputRate { rate: Rate::hz(1000), divide: 256 }];

    #[test]
    fn a_part_has_a_fastest_rate_below_any() {
        let most = |hz: u32| at_most("MPU-9250", SensorKind::Gyro, Rate::hz(hz)).unwrap().as_hz();
        assert_eq!([most(404), most(500), most(999), most(1000)], [1000.0 / 3.0, 500.0, 500.0, 1000.0]);
        assert_eq!(at_most("no such part", SensorKind::Gyro, Rate::hz(400)), None);
    }

    #[test]
    fn a_divided_rate_is_one_of_the_parts_and_its_neighbours_are_not() {
        for divider in 1..=256 {
            assert!(has(&MPU, Rate::new(1000, divider).unwrap()), "{divider}");
        }
        for (hz, expected) in [
            (900, vec![Rate::hz(500), Rate::hz(1000)]),
            (2000, vec![Rate::hz(1000), Rate::hz(8000)]),
            (9000, vec![Rate::hz(8000)]),
            (3, vec![Rate::new(1000, 256).unwrap()]),
            (300, vec![Rate::hz(250), Rate::new(1000, 3).unwrap()]),
        ] {
            assert!(!has(&MPU, Rate::hz(hz)), "{hz}");
            assert_eq!(nearest(&MPU, Rate::hz(hz)), expected, "{hz}");
        }
        assert!(has(&MPU, Rate::new(3334, 10).unwrap()), "333.4 Hz are 1 kHz / 3 within what a clock keeps");
    }

    #[test]
    fn a_setting_is_the_one_of_its_rate() {
        let filter = |low_pass, hz| Filter {
            name: "BW".into(),
            low_pass,
            order: 1,
            delay: None,
            at: vec![Rate::hz(hz)],
        };
        let filters = [filter(90.0, 200), filter(200.0, 500)];
        let rates = [200, 500].map(|hz| OutputRate { rate: Rate::hz(hz), divide: 1 });
        for (hz, low_pass) in [(200, 90.0), (500, 200.0), (100, 90.0), (8000, 200.0)] {
            let found = setting(filters.iter(), &rates, Rate::hz(hz)).unwrap();
            assert_eq!(found.low_pass, low_pass, "{hz}");
        }
        assert_eq!(with(&filters[..1], &rates), rates[..1]);
    }
}
