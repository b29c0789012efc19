//! The tables for people.

use super::{median, names, tried};
use crate::cli::terminal::Stream;
use crate::filters::SIX;
use crate::report::number;
use crate::study::filters::scenes::Scene;
use crate::study::filters::stability::{self, CASES, COME_BACK, FAILS, STABLE, Verdict};
use crate::study::filters::{Row, START_UP};

/// Errors at these rates are shown.
const SHOWN_RATES: [u32; 2] = [100, 1000];

/// Errors at two rates, the best of each scene, and the verdicts.
pub(super) fn all(rows: &[Row], scenes: &[Scene], verdicts: &[stability::Row]) -> String {
    let mut text = String::new();
    for scene in scenes {
        text += &format!("{}: {}, {} s\n", scene.name, scene.about, number(scene.seconds()));
    }
    for rate in SHOWN_RATES {
        let kept: Vec<&Row> = rows.iter().filter(|row| row.rate_hz == rate).collect();
        if !kept.is_empty() {
            text += &format!(
                "\nattitude error at {rate} Hz after {} s, degrees RMS; -6d without magnetometer, its heading as drift\n",
                number(START_UP.seconds())
            );
            text += &errors(rows, &kept, scenes);
        }
    }
    text += "\nbest of each scene at any rate: with magnetometer, and least tilt without\n";
    text += &best(rows, scenes);
    text + &self::verdicts(verdicts)
}

/// A line a filter: its error on each scene, their median, and its cost.
fn errors(rows: &[Row], kept: &[&Row], scenes: &[Scene]) -> String {
    let scenes: Vec<&str> = scenes.iter().map(|scene| scene.name.as_str()).collect();
    let heading = [&["filter"], scenes.as_slice(), &["median", "ns/update"]].concat();
    let line = |filter: &&str| {
        let of: Vec<&&Row> = kept.iter().filter(|row| row.filter == **filter).collect();
        let cell = |scene: &&str| {
            let row = of.iter().find(|row| row.scene == **scene);
            row.map_or("-".to_string(), |row| degrees(row.error_deg))
        };
        let middle = median(of.iter().filter_map(|row| row.error_deg).collect());
        let ns = median(of.iter().map(|row| row.ns_per_update).collect());
        let ends = [degrees(middle), ns.map_or("-".into(), |ns| format!("{ns:.0}"))];
        [filter.to_string()].into_iter().chain(scenes.iter().map(cell)).chain(ends).collect()
    };
    Stream::Out.table(&heading, &names(rows).iter().map(line).collect::<Vec<_>>())
}

fn degrees(error: Option<f64>) -> String {
    error.map_or("lost".into(), |error| format!("{error:.2}"))
}

/// A line a scene.
fn best(rows: &[Row], scenes: &[Scene]) -> String {
    let least = |scene: &Scene, is_six: bool, of: fn(&Row) -> Option<f64>| {
        let tried = rows.iter().filter(|row| row.scene == scene.name);
        let tried = tried.filter(|row| row.filter.ends_with(SIX) == is_six);
        let known = tried.filter_map(|row| of(row).map(|error| (row, error)));
        let best = known.min_by(|a, b| a.1.total_cmp(&b.1));
        best.map_or("-".to_string(), |(row, error)| {
            format!("{} {} Hz: {error:.2} deg", row.filter, row.rate_hz)
        })
    };
    let line = |scene: &Scene| {
        vec![
            scene.name.clone(),
            least(scene, false, |row| row.error_deg),
            least(scene, true, |row| row.inclination_deg),
        ]
    };
    Stream::Out.table(
        &["scene", "attitude, with magnetometer", "tilt, without"],
        &scenes.iter().map(line).collect::<Vec<_>>(),
    )
}

/// A line a filter, a sign a case, and what the cases are.
fn verdicts(rows: &[stability::Row]) -> String {
    let numbers: Vec<_> = (1..=CASES.len()).map(|n| n.to_string()).collect();
    let heading: Vec<_> = ["filter"].into_iter().chain(numbers.iter().map(String::as_str)).collect();
    let line = |filter: &&str| {
        let sign = |case: &stability::Case| {
            let row = rows.iter().find(|row| row.filter == **filter && row.case == case.name);
            row.map_or("-", |row| sign(row.verdict)).to_string()
        };
        [filter.to_string()].into_iter().chain(CASES.iter().map(sign)).collect()
    };
    let lines: Vec<_> = tried(rows).iter().map(line).collect();
    let about = CASES.iter().zip(&numbers).map(|(case, n)| format!("{n:>2} {}: {}\n", case.name, case.about));
    format!(
        "\nwhere filters fail: . within {STABLE} deg, ~ degraded, ! not back {COME_BACK} s after, X fails ({FAILS} deg, no number)\n{}\n{}",
        Stream::Out.table(&heading, &lines),
        about.collect::<String>()
    )
}

fn sign(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Stable => ".",
        Verdict::Degraded => "~",
        Verdict::NeverComesBack => "!",
        Verdict::Fails => "X",
    }
}
