//! The comparison as text.

use super::hints::angle;
use crate::cli::sheet::Sheet;
use crate::cli::terminal::Stream;
use crate::report::{ScoreReport, Scored, number};
use crate::score::{DelayKnown, Errors, Figures};

pub(super) fn report(report: &ScoreReport) -> String {
    let mut text = String::new();
    if judged(report).next().is_some() {
        text += &errors(report).text(Stream::Err);
        text += "\n";
        text += &angles(report).text(Stream::Err);
    }
    for remark in &report.truth_remarks {
        text += &format!("{}: {remark}\n", report.truth);
    }
    for scored in &report.estimates {
        for note in notes(scored) {
            text += &format!("{}: {note}\n", scored.name);
        }
    }
    for failure in &report.failed {
        text += &format!("FAILED: {failure}\n");
    }
    text
}

fn judged(report: &ScoreReport) -> impl Iterator<Item = (&Scored, &Figures)> {
    report.estimates.iter().filter_map(|scored| Some((scored, scored.figures.as_ref()?)))
}

/// The errors of each estimate.
pub(super) fn errors(report: &ScoreReport) -> Sheet {
    let rows = judged(report).flat_map(|(scored, figures)| rows(scored, figures));
    Sheet { heading: HEADING.to_vec(), rows: rows.collect() }
}

/// The errors of each estimate by angle.
pub(super) fn angles(report: &ScoreReport) -> Sheet {
    let heading = ["estimate", "roll RMS deg", "max", "pitch RMS deg", "max", "yaw RMS deg", "max"];
    let rows = judged(report).map(|(scored, figures)| angles_of(scored, figures));
    Sheet { heading: heading.to_vec(), rows: rows.collect() }
}

const HEADING: [&str; 10] = [
    "estimate",
    "samples",
    "covers",
    "RMS deg",
    "max",
    "inclination RMS",
    "max",
    "heading RMS",
    "max",
    "delay ms",
];

/// As given, and with the delay taken out.
fn rows(scored: &Scored, figures: &Figures) -> Vec<Vec<String>> {
    let row = |name: String, counts: [String; 2], errors: &Errors, delay: String| {
        let errors = [
            errors.rms_deg,
            errors.max_deg,
            errors.inclination_rms_deg,
            errors.inclination_max_deg,
            errors.heading_rms_deg,
            errors.heading_max_deg,
        ];
        let mut row = vec![name];
        row.extend(counts);
        row.extend(errors.map(number));
        row.push(delay);
        row
    };
    let counts = [figures.samples.to_string(), format!("{} %", number(100.0 * figures.coverage))];
    let delay = match (figures.clock_offset_s, figures.delay_known, figures.delay_ms) {
        (Some(_), ..) => "in its clock".to_string(),
        (None, DelayKnown::Echoed, Some(ms)) => number(ms),
        (None, DelayKnown::Unknown, _) => "not known".to_string(),
        _ => "left in".to_string(),
    };
    let mut rows = vec![row(scored.name.clone(), counts, &figures.errors, delay)];
    if let Some(fitted) = &figures.fitted {
        let taken = format!("{} out", number(fitted.delay_ms));
        rows.push(row(format!("{} less delay", scored.name), Default::default(), &fitted.errors, taken));
    }
    rows
}

fn angles_of(scored: &Scored, figures: &Figures) -> Vec<String> {
    let e = &figures.errors;
    let angles =
        [e.roll_rms_deg, e.roll_max_deg, e.pitch_rms_deg, e.pitch_max_deg, e.yaw_rms_deg, e.yaw_max_deg];
    std::iter::once(scored.name.clone()).chain(angles.map(number)).collect()
}

/// What stands below the table.
fn notes(scored: &Scored) -> Vec<String> {
    let mut notes = scored.remarks.clone();
    notes.extend(scored.unknown.clone());
    let Some(f) = &scored.figures else { return notes };
    if let Some(looks) = &f.looks {
        let without =
            f.looks_rms_deg.map_or(String::new(), |rms| format!(" ({} deg RMS without that)", number(rms)));
        notes.push(format!("estimate looks {looks}{without}"));
    }
    if let Some(aligned) = f.aligned {
        let body = if aligned.body_deg > 0.0 {
            format!(" and one of the body of {} deg", angle(aligned.body_deg))
        } else {
            String::new()
        };
        notes.push(match f.heading_offset_deg {
            Some(heading) => format!("a heading of {} deg is removed", angle(heading)),
            None => format!(
                "a rotation of the world of {} deg ({} deg of it heading){body} is removed",
                angle(aligned.world_deg),
                angle(aligned.heading_deg)
            ),
        });
    }
    if let Some(offset) = f.clock_offset_s {
        let std = f.clock_std_ms.map_or(String::new(), |ms| format!(" (standard error {} ms)", number(ms)));
        notes.push(format!(
            "its clock is {offset:.6} s ahead of the truth's{std}, by the motion; its delay is part of that"
        ));
    }
    // Of an estimate that is mistaken the motion says nothing of time.
    if let (DelayKnown::Unknown, Some(doubt), None) = (f.delay_known, f.delay_doubt, &f.looks) {
        notes.push(format!("its delay is unknown: {doubt}"));
    }
    notes.extend(scored.hints.clone());
    notes
}
