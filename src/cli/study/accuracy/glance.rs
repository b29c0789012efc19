//! The chart that leads: a few methods on two motions at one rate, with what each gains over the paper's step.

use super::{FLOOR, input};
use crate::report::chart::{Point, Points};
use crate::report::number;
use crate::study::accuracy::Row;
use crate::study::motions::Case;

/// The motions that are shown, those of them that were run: a smooth one, and one whose rate jumps.
const MOTIONS: [&str; 2] = ["A", "H"];
/// The rate of the gyroscope, Hz.
const RATE: u32 = 100;
/// What others are compared with.
const PAPER: &str = "paper";
/// Methods whose labels say what they gain; of the others only those on the front are shown.
const NAMED: [&str; 5] = [PAPER, "exp-average", "magnus-4", "coning-2", "polynomial-fit"];

/// One plot a motion, one below the other.
pub(super) fn chart(rows: &[Row], cases: &[Case]) -> Vec<Points> {
    let shown = cases.iter().filter(|case| MOTIONS.contains(&case.name.as_str()));
    shown.map(|case| inputs(rows, case)).collect()
}

/// What is drawn of one motion.
fn inputs(rows: &[Row], case: &Case) -> Points {
    let of: Vec<&Row> = rows.iter().filter(|row| counts(row, case)).collect();
    let paper = of.iter().find(|row| row.method == PAPER).copied();
    let shown = of.iter().filter(|row| NAMED.contains(&row.method) || on_front(row, &of));
    let point = |row: &&Row| Point {
        name: name(row, paper),
        group: usize::from(input(row) == Some("increments")),
        x: row.ns_per_simulated_s,
        y: row.error_deg.unwrap_or(f64::NAN),
        spread: None,
    };
    Points {
        title: format!("How far each method ends from the truth, from a gyroscope at {RATE} Hz"),
        subtitle: format!(
            "{}: {}, {} s; further left is cheaper, lower is nearer the truth",
            case.name,
            case.about,
            number(case.duration)
        ),
        x_label: "processor time for a second of motion (ns)".into(),
        y_label: "error at the end (deg)".into(),
        y_floor: Some(FLOOR),
        groups: vec!["reads the rate".into(), "reads the angle turned since the last sample".into()],
        points: shown.map(point).collect(),
        front: true,
        ..Points::default()
    }
}

fn counts(row: &Row, case: &Case) -> bool {
    row.motion == case.name && row.rate_hz == RATE && row.precision == "f64" && row.error_deg.is_some()
}

/// Whether no row is both cheaper and nearer the truth.
fn on_front(row: &Row, of: &[&Row]) -> bool {
    !of.iter().any(|other| other.ns_per_simulated_s < row.ns_per_simulated_s && error(other) <= error(row))
}

/// An error, of which nothing below the floor counts.
fn error(row: &Row) -> f64 {
    row.error_deg.map_or(f64::INFINITY, |error| error.max(FLOOR))
}

/// A method's name, and for the named ones what it gains over the paper's step.
fn name(row: &Row, paper: Option<&Row>) -> String {
    match paper {
        _ if row.method == PAPER => format!("{PAPER}: what the paper prints"),
        Some(paper) if NAMED.contains(&row.method) => format!("{}: {}", row.method, gain(row, paper)),
        _ => row.method.to_string(),
    }
}

/// "twice as fast and 19 thousand times nearer": both figures from the rows.
fn gain(row: &Row, paper: &Row) -> String {
    let speed = match paper.ns_per_simulated_s / row.ns_per_simulated_s {
        ratio if ratio >= 1.05 => format!("{} as fast", times(ratio)),
        ratio if ratio <= 0.95 => format!("{} the cost", times(1.0 / ratio)),
        _ => "as fast".to_string(),
    };
    // On the floor the truth itself is not known better.
    let least = if error(row) <= FLOOR { "over " } else { "" };
    let nearness = match error(paper) / error(row) {
        ratio if ratio >= 1.05 => format!("{least}{} nearer", times(ratio)),
        ratio if ratio <= 0.95 => format!("{} further off", times(1.0 / ratio)),
        _ => "no nearer".to_string(),
    };
    format!("{speed} and {nearness}")
}

/// A ratio in words, to two digits.
fn times(ratio: f64) -> String {
    let scales = [(1e12, " trillion"), (1e9, " billion"), (1e6, " million"), (1e3, " thousand"), (1.0, "")];
    let (scale, word) = scales.into_iter().find(|scale| ratio >= scale.0 * 0.995).unwrap_or((1.0, ""));
    match (ratio / scale, word) {
        (two, "") if (1.9..2.1).contains(&two) => "twice".to_string(),
        (few, word) if few < 9.95 => format!("{}{word} times", (few * 10.0).round() / 10.0),
        (many, word) => {
            let digits = 10f64.powf(many.log10().floor() - 1.0);
            format!("{}{word} times", (many / digits).round() * digits)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::study::picture::Picture;
    use crate::study::motions;

    fn row(method: &'static str, ns_per_simulated_s: f64, error_deg: f64) -> Row {
        Row {
            method,
            motion: "A".into(),
            rate_hz: RATE,
            precision: "f64",
            error_deg: Some(error_deg),
            norm_error: Some(0.0),
            ns_per_step: 1.0,
            ns_per_simulated_s,
        }
    }

    fn rows() -> Vec<Row> {
        vec![
            row(PAPER, 1000.0, 2e-2),
            row("exp-average", 1250.0, 2e-2),
            row("coning-2", 500.0, 1e-8),
            row("coning-3", 400.0, 1e-6),
            row("increment-1", 900.0, 1e-2),
            row("polynomial-fit", 3000.0, 1e-15),
        ]
    }

    fn names(rows: &[Row]) -> Vec<String> {
        inputs(rows, &motions::built_in()[0]).points.into_iter().map(|point| point.name).collect()
    }

    #[test]
    fn the_figures_of_the_labels_follow_from_the_rows() {
        let mut rows = rows();
        let expected = [
            "paper: what the paper prints",
            "exp-average: 1.3 times the cost and no nearer",
            "coning-2: twice as fast and 2 million times nearer",
            "coning-3",
            "polynomial-fit: 3 times the cost and over 20 billion times nearer",
        ];
        assert_eq!(names(&rows), expected);
        rows[2] = row("coning-2", 250.0, 0.4);
        assert_eq!(names(&rows)[2], "coning-2: 4 times as fast and 20 times further off");
    }

    #[test]
    fn only_rows_of_the_motion_and_rate_in_double_precision_are_shown() {
        let mut rows = rows();
        rows[2].precision = "f32";
        rows[3].rate_hz = 1000;
        rows[4].motion = "B".into();
        rows[5].error_deg = None;
        assert_eq!(names(&rows).len(), 2);
        rows.remove(0);
        assert_eq!(names(&rows), ["exp-average"], "nothing to compare with");
    }

    #[test]
    fn a_ratio_has_two_digits_and_a_word() {
        for (ratio, words) in [
            (1.46, "1.5 times"),
            (2.0, "twice"),
            (9.97, "10 times"),
            (18.7, "19 times"),
            (437.0, "440 times"),
            (18_779.0, "19 thousand times"),
            (999_999.0, "1 million times"),
            (2.6e11, "260 billion times"),
            (3e15, "3000 trillion times"),
        ] {
            assert_eq!(times(ratio), words, "{ratio}");
        }
    }

    #[test]
    fn motions_that_were_not_run_are_left_out() {
        let plots = |cases: &[Case]| chart(&rows(), cases).svg().matches("<title>").count();
        assert_eq!((plots(&motions::built_in()), plots(&motions::quick())), (2, 1));
    }
}
