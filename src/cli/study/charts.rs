//! The studies' data for the charts.

use super::tables::{label, series};
use crate::motion::method::METHODS;
use crate::report::chart::{self, Cell, Grid, LogLog};
use crate::report::number;
use crate::study::accuracy;
use crate::study::allan;
use crate::study::cost::Cost;
use crate::study::motions::Case;
use crate::study::stability::{self, CASES, Verdict};

/// Below this the truth itself is not known better, degrees.
const FLOOR: f64 = 1e-12;

/// Cost against error, a plot a motion, a point a rate.
pub fn accuracy(rows: &[accuracy::Row], cases: &[Case]) -> String {
    let motion = |case: &Case| {
        let of: Vec<_> = rows.iter().filter(|row| row.motion == case.name).collect();
        let method = |name: String| {
            let points = of.iter().filter(|row| label(row) == name);
            let points = points.filter_map(|row| Some((row.ns_per_simulated_s, row.error_deg?))).collect();
            chart::Method { name, points }
        };
        chart::Motion {
            title: format!("{}: {}, {} s", case.name, case.about, number(case.duration)),
            methods: series(of.iter().copied()).into_iter().map(method).collect(),
        }
    };
    chart::loglog(&LogLog {
        title: "What each attitude method costs and how far it ends from the truth".into(),
        subtitle: format!("a point a sample rate, {}; one thread", rates(cases)),
        x_label: "cost (ns per simulated second)".into(),
        y_label: "error at the end (deg)".into(),
        y_floor: Some(FLOOR),
        motions: cases.iter().map(motion).collect(),
    })
}

fn rates(cases: &[Case]) -> String {
    let all = || cases.iter().flat_map(|case| &case.rates);
    match (all().min(), all().max()) {
        (Some(least), Some(most)) => format!("from {least} to {most} Hz, the lowest leftmost"),
        _ => String::new(),
    }
}

/// Verdicts, a row a case, a column a method.
pub fn stability(rows: &[stability::Row]) -> String {
    let cell = |case: &str, method: &str| {
        let found = rows.iter().find(|row| row.case == case && row.method == method);
        found.map_or_else(Cell::default, |row| Cell { verdict: verdict(row.verdict), figure: figure(row) })
    };
    let row = |case: &stability::Case| chart::Row {
        name: format!("{}: {}", case.name, case.about),
        cells: METHODS.iter().map(|method| cell(case.name, method.name)).collect(),
    };
    chart::grid(&Grid {
        title: "Where attitude methods fail".into(),
        subtitle: "a figure is what the row names last; # is the first step at which the method fails".into(),
        columns: METHODS.iter().map(|method| method.name.to_string()).collect(),
        rows: CASES.iter().map(row).collect(),
    })
}

/// How much where it is worse, when where it fails.
fn figure(row: &stability::Row) -> String {
    match (row.verdict, row.first_failing_step) {
        (Verdict::Stable, _) => String::new(),
        (Verdict::Fails, Some(step)) => format!("#{}", number(step as f64)),
        _ => format!("{:.0e}", row.figure),
    }
}

fn verdict(verdict: Verdict) -> chart::Verdict {
    match verdict {
        Verdict::Stable => chart::Verdict::Stable,
        Verdict::Degraded => chart::Verdict::Degraded,
        Verdict::Fails => chart::Verdict::Fails,
    }
}

/// A bar a term, and the floor.
pub fn cost(cost: &Cost) -> String {
    let mut before = 0.0;
    let bars = cost.terms.iter().map(|term| {
        let added = term.ns_per_sample - std::mem::replace(&mut before, term.ns_per_sample);
        chart::Bar { name: term.term.replace('_', " "), value: term.ns_per_sample, added }
    });
    let ratio = cost.ratio.map_or(String::new(), |ratio| {
        let normals = number(cost.normals_per_sample);
        format!(", {} times the cost of its {normals} normal numbers alone", number(ratio))
    });
    chart::bars(&chart::Bars {
        title: format!("What a nine-axis sample of {} costs as error terms are added", cost.scene),
        subtitle: format!(
            "one thread, in memory: {} million a second{ratio}",
            number(cost.nine_axis_samples_per_s / 1e6)
        ),
        unit: "ns".into(),
        bars: bars.collect(),
        line: cost.floor_samples_per_s.map(|floor| ("its normal numbers alone".into(), 1e9 / floor)),
    })
}

/// A picture a sensor: its axes with their bands, and theory.
pub fn allan(points: &[allan::Point]) -> String {
    let mut sensors: Vec<_> = points.iter().map(|point| point.sensor).collect();
    sensors.dedup();
    let picture = |sensor: &&str| {
        let of = |axis: &str| -> Vec<&allan::Point> {
            points.iter().filter(|point| point.sensor == *sensor && point.axis == axis).collect()
        };
        let measured = |axis: &&str| {
            let of = of(axis);
            // Two standard errors of neighbours that share an average.
            let band = |point: &&allan::Point| {
                let share = 2.0 * libm::sqrt(1.5 / (2.0 * point.differences as f64));
                (point.tau_s, point.deviation * (1.0 - share).max(0.01), point.deviation * (1.0 + share))
            };
            chart::Curve {
                name: axis.to_string(),
                kind: chart::CurveKind::Measured,
                points: of.iter().map(|point| (point.tau_s, point.deviation)).collect(),
                band: of.iter().map(band).collect(),
            }
        };
        let theory = |axis: &&str| chart::Curve {
            name: format!("theory {axis}"),
            kind: chart::CurveKind::Theory,
            points: of(axis).iter().map(|point| (point.tau_s, point.theory)).collect(),
            band: Vec::new(),
        };
        let mut axes: Vec<_> =
            points.iter().filter(|point| point.sensor == *sensor).map(|point| point.axis).collect();
        axes.dedup();
        let first = axes.first().copied().unwrap_or_default();
        let same = |axis: &str| of(axis).iter().zip(of(first)).all(|(a, b)| a.theory == b.theory);
        let theories = axes.iter().filter(|axis| **axis == first || !same(axis)).map(theory);
        chart::curves(&chart::Curves {
            title: format!("Allan deviation of the {sensor}"),
            subtitle:
                "of reading less error-free reading; theory of white noise, counts, walk and wandering bias"
                    .into(),
            x_label: "averaging time τ (s)".into(),
            y_label: format!("Allan deviation ({})", allan::unit(sensor)),
            linear: false,
            band: "95 % confidence".into(),
            curves: axes.iter().map(measured).chain(theories).collect(),
        })
    };
    chart::stacked(&sensors.iter().map(picture).collect::<Vec<_>>())
}
