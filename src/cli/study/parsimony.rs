//! `ratetable study parsimony`: what each term of a scene costs and does, and the scene without what it does not need.

use super::{Outcome, Request, Study};
use crate::cli::Refusal;
use crate::cli::progress::Bar;
use crate::cli::terminal::Stream;
use crate::report::{chart, count, number};
use crate::scene::Plan;
use crate::study::all_cores;
use crate::study::parsimony::{self, CONFIDENCE, Effort, Parsimony, Row, Verdict};
use std::time::Instant;

pub(super) static STUDY: Study =
    Study { name: "parsimony", files: &["parsimony.csv", "parsimony.svg", "lean.toml"], run };

/// The scene that is studied where none is given: it has almost every error term, and turns about all axes.
const SCENE: &str = "full-mpu9250";
/// A study of more seeds than these is not proposed.
const MANY: f64 = 10_000.0;
/// Effects below this are drawn on the floor of the chart, in margins.
const FLOOR: f64 = 1e-3;

fn run(request: &Request) -> Result<Outcome, Refusal> {
    let effort = if request.quick { Effort::QUICK } else { Effort::FULL };
    let bar = Bar::of_jobs("parsimony");
    let start = Instant::now();
    let default;
    let plan = match request.scene {
        Some(plan) => plan,
        None => {
            default = Plan::load(SCENE, &[])?;
            &default
        }
    };
    let found =
        parsimony::run(plan, effort, all_cores(), &|| start.elapsed(), &|done, all| bar.jobs(done, all));
    bar.clear();
    let found = found?;
    let of_its_own = serde_json::json!({ "parsimony": &found });
    let mut outcome = Outcome::of("parsimony", &of_its_own, text(&found))?.csv(&found.rows)?;
    outcome = outcome.picture("parsimony.svg", &chart(&found))?.file("lean.toml", found.lean.text.clone())?;
    // The lean scene names its logs as a copy of the scene does, beside it.
    for file in &plan.attached {
        outcome = outcome.file(&file.name, file.contents()?)?;
    }
    Ok(outcome)
}

/// A point a part: its cost, and its effect in what would just be noticed.
fn chart(found: &Parsimony) -> chart::Points {
    // What costs less than the clock can tell lies where that begins.
    let least = found.ns_of_nothing.max(0.1);
    let group = |verdict: Verdict| Verdict::ALL.iter().position(|known| *known == verdict).unwrap_or(0);
    let point = |row: &Row| {
        Some(chart::Point {
            name: format!("{} {}", row.sensor, row.term.replace('_', " ")),
            group: group(row.verdict),
            x: row.ns_per_sample.max(least),
            y: row.times_noticed?,
            spread: None,
        })
    };
    chart::Points {
        title: format!("What each term of {} costs and what it does", found.scene),
        subtitle: format!(
            "{}, {} seeds; the effect is the largest that the {} % interval of any filter's change allows",
            played(found),
            found.seeds,
            CONFIDENCE * 100.0
        ),
        x_label: "cost (ns a sample of its sensor)".into(),
        y_label: "effect (times what is noticed)".into(),
        y_floor: Some(FLOOR),
        groups: Verdict::ALL.iter().map(Verdict::to_string).collect(),
        points: found.rows.iter().filter_map(point).collect(),
        levels: vec![chart::Level { name: "below: nothing is noticed".into(), y: 1.0 }],
        notes: vec![format!(
            "Costs below {} ns are drawn there: it is what the clock can tell.",
            number(least)
        )],
        ..chart::Points::default()
    }
}

/// The table, and what the leaner scene is.
fn text(found: &Parsimony) -> String {
    let heading = ["sensor", "term", "ns", "counts", "of noise", "filter", "error deg", "verdict"];
    let lines: Vec<Vec<String>> = found.rows.iter().map(line).collect();
    if lines.is_empty() {
        return format!(
            "{}: it has no error term, and nothing else that a key could leave out\n",
            found.scene
        );
    }
    let played = played(found);
    format!(
        "{}: {played}, {} seeds; what each term adds\n{}\n{}\n{}",
        found.scene,
        found.seeds,
        Stream::Out.table(&heading, &lines),
        legend(found),
        lean(found)
    )
}

/// How much of the scene was played.
fn played(found: &Parsimony) -> String {
    match found.seconds < found.whole_seconds {
        true => format!("the first {} s of {}", number(found.seconds), number(found.whole_seconds)),
        false => format!("{} s", number(found.seconds)),
    }
}

fn line(row: &Row) -> Vec<String> {
    let both = |rms: Option<f64>, most: Option<f64>| {
        rms.zip(most).map_or("-".into(), |(rms, most)| format!("{}, {}", short(rms), short(most)))
    };
    let error = row
        .change_deg
        .zip(row.interval_deg)
        .map_or("-".into(), |(change, half)| format!("{:+.4} ± {half:.4}", change + 0.0));
    let seeds = match row.seeds_to_decide {
        None => String::new(),
        Some(seeds) if seeds < MANY => format!(": about {seeds} seeds would tell"),
        Some(_) => format!(": not even {MANY} seeds would tell"),
    };
    vec![
        row.sensor.into(),
        row.term.replace('_', " "),
        format!("{:.1}", row.ns_per_sample + 0.0),
        both(row.rms_counts, row.largest_counts),
        both(row.rms_of_noise, row.largest_of_noise),
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
    let error = match found.filters.iter().all(Vec::is_empty) {
        true => "error: no filter reads these sensors, for each needs gyro and accel: verdicts rest on readings alone.".into(),
        false => format!(
            "error: what the RMS attitude error of the filter that decides is more without the term, at {} %.",
            CONFIDENCE * 100.0
        ),
    };
    format!(
        "ns: a sample of the sensor, or a tick of the scene; below {} it is the clock's own.\n\
         counts, of noise: RMS and largest change of a reading, in counts and in the white noise of a sample.\n\
         {error}\n",
        short(found.ns_of_nothing),
    )
}

fn lean(found: &Parsimony) -> String {
    let lean = &found.lean;
    let all = count((lean.kept.len() + lean.left_out.len()) as u64, "term");
    let put_back = match &lean.put_back[..] {
        [] => String::new(),
        some => format!("put back: {}\n", some.join(", ")),
    };
    if lean.left_out.is_empty() {
        return format!("Nothing can be left out: the lean scene is the whole one.\n{put_back}");
    }
    let cost = format!("{:.1} ns a nine-axis sample before, {:.1} after", lean.ns_before, lean.ns_after);
    let names = lean.kept.join(", ");
    let kept = lean.kept.len();
    format!("lean.toml has {kept} of {all}: {names}\n{put_back}{cost}\n{}", bounds(found))
}

/// How far the leaner scene's filters can be from the whole scene's.
fn bounds(found: &Parsimony) -> String {
    if found.lean.filters.is_empty() {
        return String::new();
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
