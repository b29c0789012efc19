//! The comparison as a person reads it.

use crate::cli::terminal::Stream;
use crate::report::{ScoreReport, Scored, number};
use crate::score::DelayKnown;

pub(super) fn report(report: &ScoreReport) -> String {
    let heading =
        ["estimate", "samples", "RMS deg", "max", "inclination RMS", "max", "heading RMS", "max", "delay ms"];
    let row = |scored: &Scored| {
        let f = &scored.figures;
        let errors = [
            f.rms_deg,
            f.max_deg,
            f.inclination_rms_deg,
            f.inclination_max_deg,
            f.heading_rms_deg,
            f.heading_max_deg,
        ];
        let mut row = vec![scored.name.clone(), f.samples.to_string()];
        row.extend(errors.map(number));
        row.push(f.delay_ms.map_or("-".into(), number));
        row
    };
    let mut text = Stream::Err.table(&heading, &report.estimates.iter().map(row).collect::<Vec<_>>());
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

/// What stands below the table.
fn notes(scored: &Scored) -> Vec<String> {
    let f = &scored.figures;
    let mut notes = scored.remarks.clone();
    if let Some(looks) = &f.looks {
        let without =
            f.looks_rms_deg.map_or(String::new(), |rms| format!(" ({} deg RMS without that)", number(rms)));
        notes.push(format!("estimate looks {looks}{without}"));
    }
    if let Some(heading) = f.heading_offset_deg {
        notes.push(format!("a heading of {} deg is taken out", number(heading)));
    }
    if let Some(offset) = f.clock_offset_s {
        notes.push(format!("its clock is {offset:.6} s ahead of the truth's, its delay included"));
    }
    // Of an estimate that is mistaken the motion says nothing of time.
    if let (DelayKnown::Unknown, Some(doubt), None) = (f.delay_known, f.delay_doubt, &f.looks) {
        notes.push(format!("its delay is not known: {doubt}"));
    }
    notes
}
