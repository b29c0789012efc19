//! `ratetable study cost`: the cost of a scene's samples as error terms are added.

use super::{Outcome, Request, Study};
use crate::cli::Refusal;
use crate::cli::terminal::Stream;
use crate::report::chart;
use crate::report::number;
use crate::scene::Plan;
use crate::study::cost::{self, Cost, Effort};
use std::time::Instant;

pub(super) static STUDY: Study = Study { name: "cost", files: &["cost.csv", "cost.svg"], run };

/// The scene whose cost is studied where none is given.
const SCENE: &str = "full-mpu9250";

fn run(request: &Request) -> Result<Outcome, Refusal> {
    let effort = if request.quick { Effort::QUICK } else { Effort::FULL };
    let start = Instant::now();
    let now = || start.elapsed();
    let cost = match request.scene {
        Some(plan) => cost::run(plan, effort, &now),
        None => cost::run(&Plan::load(SCENE, &[])?, effort, &now),
    };
    Outcome::of("cost", &cost, table(&cost))?.csv(&cost.terms)?.picture("cost.svg", &chart(&cost))
}

/// A bar a term, and the floor.
fn chart(cost: &Cost) -> chart::Bars {
    let mut before = 0.0;
    let bars = cost.terms.iter().map(|term| {
        let added = term.ns_per_sample - std::mem::replace(&mut before, term.ns_per_sample);
        chart::Bar { name: term.term.replace('_', " "), value: term.ns_per_sample, added }
    });
    let ratio = cost.ratio.map_or(String::new(), |ratio| {
        let normals = number(cost.normals_per_sample);
        format!(", {} times the cost of its {normals} normal numbers alone", number(ratio))
    });
    chart::Bars {
        title: format!("What a nine-axis sample of {} costs as error terms are added", cost.scene),
        subtitle: format!(
            "one thread, in memory: {} million a second{ratio}",
            number(cost.nine_axis_samples_per_s / 1e6)
        ),
        x_label: "cost (ns per nine-axis sample)".into(),
        unit: "ns".into(),
        bars: bars.collect(),
        line: cost.floor_samples_per_s.map(|floor| ("its normal numbers alone".into(), 1e9 / floor)),
    }
}

/// What a sample costs with the terms up to each.
fn table(cost: &Cost) -> String {
    let mut before = 0.0;
    let rows = cost.terms.iter().map(|term| {
        let added = term.ns_per_sample - std::mem::replace(&mut before, term.ns_per_sample);
        vec![term.term.to_string(), number(added), number(term.ns_per_sample)]
    });
    let millions = |rate: f64| number(rate / 1e6);
    let floor = cost.floor_samples_per_s.zip(cost.ratio).map_or(String::new(), |(floor, ratio)| {
        let normals = number(cost.normals_per_sample);
        format!("; its {normals} normal numbers alone: {} million; ratio {}", millions(floor), number(ratio))
    });
    let cores = cost.cores.as_ref().map_or(String::new(), |cores| {
        let (rate, times) = (millions(cores.nine_axis_samples_per_s), number(cores.times_one));
        format!("{} threads, a run each: {rate} million; {times} times one\n", cores.threads)
    });
    format!(
        "{}\n{} million nine-axis samples/s of {}, one thread{floor}\n{cores}",
        Stream::Out.table(&["with", "ns more", "ns a sample"], &rows.collect::<Vec<_>>()),
        millions(cost.nine_axis_samples_per_s),
        cost.scene,
    )
}
