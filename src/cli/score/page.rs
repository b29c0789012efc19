//! The comparison as a page that plays: the truth and an estimate as bodies, their errors, the table.

use super::charts::Drawn;
use super::sources::Truth;
use super::text;
use crate::live::{self, About, End, Figure, Paths};
use crate::report::{ScoreReport, number};

/// As many attitudes of the truth are drawn.
const POINTS: usize = 4000;

/// The page, HTML.
pub(super) fn of(report: &ScoreReport, drawn: &[Drawn], truth: &Truth) -> String {
    let about = About {
        axes: truth.axes,
        reference: Some("truth"),
        estimators: drawn.iter().map(|drawn| drawn.name().to_string()).collect(),
        ..About::of_data("score", report.truth.clone())
    };
    let paths = Paths {
        truth: truth.track.every(truth.track.len().div_ceil(POINTS)).collect(),
        told: drawn.iter().map(Drawn::path).collect(),
    };
    live::page(&about, &paths, &end(report))
}

fn end(report: &ScoreReport) -> End {
    let figure = |scored: &crate::report::Scored| {
        let figures = scored.figures.as_ref();
        Figure {
            label: scored.name.clone(),
            value: figures.map_or("not known".into(), |figures| number(figures.errors.rms_deg)),
            unit: if figures.is_some() { "deg RMS".into() } else { String::new() },
        }
    };
    let tables = [text::errors(report).table("Errors"), text::angles(report).table("Roll, pitch and yaw")];
    End {
        ok: report.ok,
        failed: report.failed.clone(),
        figures: report.estimates.iter().map(figure).collect(),
        tables: tables.into_iter().flatten().collect(),
        ..End::default()
    }
}
