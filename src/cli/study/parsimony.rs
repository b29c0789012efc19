//! `ratetable study parsimony`: what each term of a scene costs and does, and the scene without what it does not need.

use super::{Outcome, Request, Study};
use crate::cli::Refusal;
use crate::cli::progress::Bar;
use crate::cli::terminal::Stream;
use crate::report::{count, number};
use crate::scene::Plan;
use crate::study::all_cores;
use crate::study::parsimony::{self, CONFIDENCE, Effort, Parsimony, Row};
use std::time::Instant;

pub(super) static STUDY: Study =
    Study { name: "parsimony", files: &["parsimony.csv", "lean.toml"], run };

/// The scene that is studied where none is given: turns, holds, vibration of a motor, a part's noise and counts.
const SCENE: &str = "vibration";

fn run(request: &Request) -> Result<Outcome, Refusal> {
    let effort = if request.quick { Effort::QUICK } else { Effort::FULL };
    let bar = Bar::of_jobs("parsimony");
    let start = Instant::now();
    let of = |plan: &Plan| {
        parsimony::run(plan, effort, all_cores(), &|| start.elapsed(), &|done, all| bar.jobs(done, all))
    };
    let found = match request.scene {
        Some(plan) => of(plan),
        None => of(&Plan::load(SCENE, &[])?),
    };
    bar.clear();
    let found = found?;
    Outcome::of("parsimony", &found, text(&found))?.csv(&found.rows)?.file("lean.toml", found.lean.text.clone())
}

/// The table, and what the leaner scene is.
fn text(found: &Parsimony) -> String {
    let heading =
        ["sensor", "term", "ns", "counts", "largest", "of noise", "largest", "filter", "error deg", "verdict"];
    let lines: Vec<Vec<String>> = found.rows.iter().map(line).collect();
    let seconds = number(found.seconds);
    format!(
        "{}: {seconds} s, {} seeds; what each term adds\n{}\n{}{}",
        found.scene,
        found.seeds,
        Stream::Out.table(&heading, &lines),
        legend(found),
        lean(found)
    )
}

fn line(row: &Row) -> Vec<String> {
    let or_dash = |value: Option<f64>| value.map_or("-".into(), short);
    let error = row.change_deg.zip(row.interval_deg).map_or("-".into(), |(change, half)| {
        format!("{:+.4} ± {half:.4}", change + 0.0)
    });
    let seeds = row.seeds_to_decide.map_or(String::new(), |seeds| {
        if seeds < 1e5 { format!(" (about {seeds} seeds would tell)") } else { String::new() }
    });
    vec![
        row.sensor.into(),
        row.term.replace('_', " "),
        format!("{:.1}", row.ns_per_sample + 0.0),
        or_dash(row.rms_counts),
        or_dash(row.largest_counts),
        or_dash(row.rms_of_noise),
        or_dash(row.largest_of_noise),
        row.filter.clone().unwrap_or("-".into()),
        error,
        format!("{}{seeds}", row.verdict),
    ]
}

/// Three digits.
fn short(value: f64) -> String {
    match value {
        0.0 => "0".into(),
        _ if value.abs() >= 100.0 => format!("{value:.0}"),
        _ if value.abs() < 1e-3 => format!("{value:.0e}"),
        _ => {
            let digits = libm::floor(libm::log10(value.abs())) as i32;
            let text = format!("{value:.*}", (2 - digits).max(0) as usize);
            if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
        }
    }
}

fn legend(found: &Parsimony) -> String {
    format!(
        "ns: a sample of the sensor, or a tick of the scene; below {:.1} it is the clock's own.\n\
         counts, of noise: RMS and largest change of a reading, in counts and in the noise of a sample.\n\
         error: what the RMS attitude error of the filter that decides is more without the term, at {} %.\n",
        found.ns_of_nothing,
        CONFIDENCE * 100.0
    )
}

fn lean(found: &Parsimony) -> String {
    let lean = &found.lean;
    let all = lean.kept.len() + lean.left_out.len();
    let cost = format!("{:.1} ns a nine-axis sample before, {:.1} after", lean.ns_before, lean.ns_after);
    let put_back = match &lean.put_back[..] {
        [] => String::new(),
        some => format!("\nput back, for they do not go with the others: {}", some.join(", ")),
    };
    match lean.left_out.len() {
        0 => format!("\nNothing can be left out: the lean scene is the whole one.{put_back}\n"),
        _ => format!(
            "\nlean.toml: {} of {} remain, {}; {cost}{put_back}\n{}",
            lean.kept.len(),
            count(all as u64, "term"),
            lean.kept.join(", "),
            bounds(found)
        ),
    }
}

/// How far the leaner scene's filters can be from the whole scene's.
fn bounds(found: &Parsimony) -> String {
    if found.lean.filters.is_empty() {
        return "No filter reads its sensors: this rests on their readings alone.\n".into();
    }
    let rows = found.lean.filters.iter().map(|filter| {
        vec![
            filter.filter.clone(),
            format!("{:.4}", filter.rms_deg),
            format!("{:+.4} ± {:.4}", filter.change.mean + 0.0, filter.change.half),
            format!("{:.4}", filter.margin_deg),
        ]
    });
    Stream::Out.table(&["filter", "whole deg", "lean is more by", "margin"], &rows.collect::<Vec<_>>())
}
