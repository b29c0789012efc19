//! `ratetable study filters`: every filter on every scene, and through what breaks filters.

mod charts;
mod text;

use super::{Outcome, Request, Study};
use crate::cli::progress::Bar;
use crate::cli::{Refusal, tell};
use crate::study::all_cores;
use crate::study::filters::scenes::{self, Scene};
use crate::study::filters::{self, Effort, Row, stability};
use serde::Serialize;
use std::time::Instant;

pub(super) static STUDY: Study = Study {
    name: "filters",
    files: &[
        "filters.csv",
        "filters.svg",
        "filters-glance.svg",
        "filters-stability.csv",
        "filters-stability.svg",
    ],
    run,
};

/// Runs of each scene, each with its own noise.
const SEEDS: u64 = 4;
const QUICK_SEEDS: u64 = 2;

/// Left out when quick: it takes longer than all the others together.
const LEFT_OUT: &str = "eskf";

/// The fields of the JSON.
#[derive(Serialize)]
struct Results<'a> {
    filters: &'a [Row],
    filters_stability: &'a [stability::Row],
}

fn run(request: &Request) -> Result<Outcome, Refusal> {
    let scenes = scenes(request)?;
    let (seeds, hardship) = match request.quick {
        true => (QUICK_SEEDS, stability::Effort::QUICK),
        false => (SEEDS, stability::Effort::FULL),
    };
    let effort = Effort { seeds, threads: all_cores() };
    let mut subjects = filters::subjects();
    subjects.retain(|subject| !request.quick || subject.kind.name != LEFT_OUT);
    let bar = Bar::of_jobs("filters");
    let start = Instant::now();
    let now = || start.elapsed();
    let rows = filters::run(&scenes, &subjects, effort, &now, &|done, all| bar.jobs(done, all))?;
    bar.clear();
    let bar = Bar::of_jobs("filters, stability");
    let verdicts = stability::run(&subjects, hardship, all_cores(), &|done, all| bar.jobs(done, all));
    bar.clear();
    let text = text::all(&rows, &scenes, &verdicts);
    let results = Results { filters: &rows, filters_stability: &verdicts };
    Outcome::of("filters", &results, text)?
        .csv(&rows)?
        .table("filters-stability.csv", &verdicts)?
        .picture("filters.svg", &charts::rates(&rows, &scenes, seeds))?
        .picture("filters-glance.svg", &charts::glance(&rows))?
        .picture("filters-stability.svg", &charts::verdicts(&verdicts))
}

/// The built-in scenes, and the one given. Where other studies are asked for too, one that suits no filter is left out.
fn scenes(request: &Request) -> Result<Vec<Scene>, Refusal> {
    let mut scenes = scenes::built_in(request.quick)?;
    let Some((plan, source)) = request.scene.zip(request.source) else { return Ok(scenes) };
    let rates: &[u32] = if request.quick { &scenes::QUICK_RATES } else { &scenes::RATES };
    let given = match Scene::given(source, plan, rates) {
        Ok(given) => given,
        Err(why) if request.is_alone => return Err(Refusal(why)),
        Err(why) => {
            tell(&format!("filters: without {source}: {why}"));
            return Ok(scenes);
        }
    };
    // A scene that takes the name of a built-in one stands for it.
    scenes.retain(|scene| scene.name != given.name);
    scenes.push(given);
    Ok(scenes)
}

/// Each name once, in order of appearance.
fn once<'a>(all: impl Iterator<Item = &'a String>) -> Vec<&'a str> {
    let mut names: Vec<&str> = Vec::new();
    for name in all {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    names
}

/// The filters that were run, in order of appearance.
fn names(rows: &[Row]) -> Vec<&str> {
    once(rows.iter().map(|row| &row.filter))
}

/// The filters that were tried, in order of appearance.
fn tried(rows: &[stability::Row]) -> Vec<&str> {
    once(rows.iter().map(|row| &row.filter))
}

/// The middle of some values: of an even number, the mean of the two in the middle; none of none.
fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let half = values.len() / 2;
    match values.len() {
        0 => None,
        count if count % 2 == 1 => Some(values[half]),
        _ => Some(0.5 * (values[half - 1] + values[half])),
    }
}

#[cfg(test)]
mod tests;
