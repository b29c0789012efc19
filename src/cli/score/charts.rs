//! The comparison as charts: attitudes and errors over time, in the dataset's axes.

use super::sources::Truth;
use crate::geometry::{Axes, Euler};
use crate::report::chart::{Line, LineKind, Panel, Panels, panels};
use crate::report::{ScoreReport, Scored, number};
use crate::score::Row;
use crate::time::SimTime;

/// As many points of a line are drawn.
const POINTS: usize = 4000;
/// Points further apart than so many of the usual leave a gap, and than this, s.
const GAP: (f64, f64) = (5.0, 0.25);

/// One estimate, thinned out for a picture.
pub(super) struct Drawn {
    name: String,
    every: u64,
    seen: u64,
    t: Vec<f64>,
    times: Vec<SimTime>,
    /// Attitudes, in the program's own axes.
    attitudes: Vec<crate::geometry::Attitude>,
    /// The whole error, inclination and heading, deg.
    errors: [Vec<f64>; 3],
}

impl Drawn {
    /// Of an estimate of so many rows.
    pub fn new(name: &str, rows: u64) -> Drawn {
        let every = rows.div_ceil(POINTS as u64).max(1);
        Drawn {
            name: name.into(),
            every,
            seen: 0,
            t: Vec::new(),
            times: Vec::new(),
            attitudes: Vec::new(),
            errors: Default::default(),
        }
    }

    /// Takes the next row in.
    pub fn add(&mut self, row: &Row) {
        let is_drawn = self.seen.is_multiple_of(self.every);
        self.seen += 1;
        if !is_drawn {
            return;
        }
        self.t.push(row.t.seconds());
        self.times.push(row.t);
        self.attitudes.push(row.attitude);
        let errors = [row.error.total, row.error.inclination, row.error.heading];
        self.errors.iter_mut().zip(errors).for_each(|(column, error)| column.push(error.to_degrees()));
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// When it held what, with the error in inclination and in heading, deg.
    pub fn path(&self) -> Vec<(SimTime, crate::geometry::Attitude, [f64; 2])> {
        let [_, inclination, heading] = &self.errors;
        let errors = inclination.iter().zip(heading).map(|(inclination, heading)| [*inclination, *heading]);
        let fixes = self.times.iter().zip(&self.attitudes).zip(errors);
        fixes.map(|((t, attitude), errors)| (*t, *attitude, errors)).collect()
    }

    /// How much its error moves from point to point, deg: what moves most is drawn first, behind the others, in every
    /// chart.
    pub fn restless(&self) -> f64 {
        self.errors[0].windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum()
    }

    /// Roll, pitch and yaw, deg.
    fn angles(&self, axes: Axes) -> [Vec<f64>; 3] {
        angles(self.attitudes.iter().copied(), axes)
    }
}

fn angles(attitudes: impl Iterator<Item = crate::geometry::Attitude> + Clone, axes: Axes) -> [Vec<f64>; 3] {
    let all = attitudes.map(|attitude| Euler::from_quat(axes.attitude_out(attitude)));
    let of = |angle: fn(Euler) -> f64| all.clone().map(|euler| angle(euler).to_degrees()).collect();
    [of(|euler| euler.roll), of(|euler| euler.pitch), of(|euler| euler.yaw)]
}

/// A line's points with a break wherever rows are missing.
fn with_gaps(t: &[f64], y: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let mut steps: Vec<f64> = t.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_unstable_by(f64::total_cmp);
    let longest = steps.get(steps.len() / 2).map_or(f64::INFINITY, |usual| GAP.1.max(GAP.0 * usual));
    let mut points = (Vec::with_capacity(t.len()), Vec::with_capacity(t.len()));
    for (i, (&t_i, &y_i)) in t.iter().zip(y).enumerate() {
        if i > 0 && t_i - t[i - 1] > longest {
            points.0.push(t_i);
            points.1.push(f64::NAN);
        }
        points.0.push(t_i);
        points.1.push(y_i);
    }
    points
}

/// A panel's lines.
struct Lines(Vec<(String, Vec<f64>, Vec<f64>)>);

impl Lines {
    fn of<'a>(drawn: impl Iterator<Item = (&'a str, &'a [f64], &'a [f64])>) -> Lines {
        let line = |(name, t, y): (&str, &[f64], &[f64])| {
            let (t, y) = with_gaps(t, y);
            (name.to_string(), t, y)
        };
        Lines(drawn.map(line).collect())
    }

    fn lines(&self) -> Vec<Line<'_>> {
        self.0.iter().map(|(name, x, y)| Line { name, x, y, kind: LineKind::Value }).collect()
    }
}

/// Roll, pitch and yaw over time, with the truth.
pub(super) fn attitude(report: &ScoreReport, drawn: &[Drawn], truth: &Truth) -> String {
    let axes = truth.axes;
    let rows = || truth.track.every(truth.track.len().div_ceil(POINTS));
    let t: Vec<f64> = rows().map(|(t, _)| t.seconds()).collect();
    let attitudes: Vec<_> = rows().map(|(_, attitude)| attitude).collect();
    let true_angles = angles(attitudes.iter().copied(), axes).map(|y| with_gaps(&t, &y));
    let all: Vec<[Vec<f64>; 3]> = drawn.iter().map(|drawn| drawn.angles(axes)).collect();
    let of = |i: usize| {
        let each = drawn.iter().zip(&all);
        Lines::of(each.map(|(drawn, angles)| (drawn.name.as_str(), &drawn.t[..], &angles[i][..])))
    };
    let lines = [0, 1, 2].map(of);
    let panel = |(i, name): (usize, &str)| {
        let mut lines = lines[i].lines();
        lines.push(Line { name: "truth", x: &true_angles[i].0, y: &true_angles[i].1, kind: LineKind::Truth });
        Panel {
            title: name.to_string(),
            y_label: format!("{} (deg)", name.to_lowercase()),
            lines,
            wrap: (i != 1).then_some(360.0),
            log_y: false,
        }
    };
    panels(&Panels {
        title: format!("Estimated attitude and truth, {}", named(axes)),
        subtitle: subtitle(report),
        x_label: "time (s)".into(),
        panels: ["Roll", "Pitch", "Yaw"].into_iter().enumerate().map(panel).collect(),
    })
}

/// Axes as a title says them.
fn named(axes: Axes) -> &'static str {
    match axes {
        Axes::NedFrd => "North-East-Down and Forward-Right-Down",
        Axes::EnuFlu => "East-North-Up and Forward-Left-Up",
    }
}

/// Errors over time.
pub(super) fn error(report: &ScoreReport, drawn: &[Drawn]) -> String {
    let of = |i: usize| {
        Lines::of(drawn.iter().map(|drawn| (drawn.name.as_str(), &drawn.t[..], &drawn.errors[i][..])))
    };
    let lines = [0, 1, 2].map(of);
    let panel = |(i, name): (usize, &str)| Panel {
        title: name.to_string(),
        y_label: "error (deg)".into(),
        lines: lines[i].lines(),
        ..Panel::default()
    };
    let titles =
        ["The whole error", "Inclination: the part that tilts", "Heading: the turn about the vertical"];
    panels(&Panels {
        title: "Error of the estimated attitude".into(),
        subtitle: subtitle(report),
        x_label: "time (s)".into(),
        panels: titles.into_iter().enumerate().map(panel).collect(),
    })
}

/// Who is how good.
fn subtitle(report: &ScoreReport) -> String {
    let one = |scored: &Scored| match &scored.figures {
        Some(figures) => format!("{} {} deg RMS", scored.name, number(figures.errors.rms_deg)),
        None => format!("{} not known", scored.name),
    };
    let each: Vec<_> = report.estimates.iter().map(one).collect();
    format!("{}: {}", report.truth, each.join(", "))
}
