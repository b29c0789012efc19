//! `ratetable study allan`: the Allan deviation of a scene's sensors against theory.

use super::{Outcome, Request, Study};
use crate::cli::Refusal;
use crate::cli::terminal::Stream;
use crate::report::chart;
use crate::report::number;
use crate::scene::Plan;
use crate::study::allan::{self, Effort};

pub(super) static STUDY: Study = Study { name: "allan", files: &["allan.csv", "allan.svg"], run };

/// The scene whose noise is studied where none is given: at rest, nothing but noise is in the readings.
const SCENE: &str = "still";

fn run(request: &Request) -> Result<Outcome, Refusal> {
    let effort = if request.quick { Effort::QUICK } else { Effort::FULL };
    let points = match request.scene {
        Some(plan) => allan::run(plan, effort),
        None => allan::run(&Plan::load(SCENE, &[])?, effort),
    };
    Outcome::of("allan", &points, table(&points))?.csv(&points)?.picture("allan.svg", &chart(&points))
}

/// A picture a sensor: its axes with their bands, and theory.
fn chart(points: &[allan::Point]) -> Vec<chart::Curves> {
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
        chart::Curves {
            title: format!("Allan deviation of the {sensor}"),
            subtitle:
                "of reading less error-free reading; theory of white noise, counts, walk and wandering bias"
                    .into(),
            x_label: "averaging time τ (s)".into(),
            y_label: format!("Allan deviation ({})", allan::unit(sensor)),
            linear: false,
            band: "95 % confidence".into(),
            curves: axes.iter().map(measured).chain(theories).collect(),
        }
    };
    sensors.iter().map(picture).collect()
}

/// Measured and expected deviations nearest to round averaging times, the mean of the three axes.
fn table(points: &[allan::Point]) -> String {
    const TAUS: [f64; 4] = [0.1, 1.0, 10.0, 100.0];
    let mut sensors: Vec<_> = points.iter().map(|point| point.sensor).collect();
    sensors.dedup();
    let cell = |sensor: &str, tau: f64| {
        let far = |point: &allan::Point| libm::log2(point.tau_s / tau).abs();
        let of = || points.iter().filter(|point| point.sensor == sensor && far(point) <= 0.5);
        let mean = |pick: fn(&allan::Point) -> f64| of().map(pick).sum::<f64>() / of().count() as f64;
        match of().count() {
            0 => "-".to_string(),
            _ => {
                format!("{} ({})", number(mean(|point| point.deviation)), number(mean(|point| point.theory)))
            }
        }
    };
    let rows = sensors.iter().map(|sensor| {
        let cells = TAUS.iter().map(|&tau| cell(sensor, tau));
        [sensor.to_string(), allan::unit(sensor).to_string()].into_iter().chain(cells).collect()
    });
    let text = Stream::Out
        .table(&["sensor", "unit", "about 0.1 s", "1 s", "10 s", "100 s"], &rows.collect::<Vec<_>>());
    format!("Allan deviation, and by theory\n{text}")
}
