//! Curves with their bands, and theory for comparison.

use super::axis::{Axis, Options};
use super::canvas::{Canvas, Color, FAINT, INK, Mark, Pen, color, mark, sheet};
use super::plot::{EndLabel, Frame, Head, Legend, MARGIN, Sign};
use super::series::{drawable, thin};

const WIDTH: f64 = 720.0;
const HEIGHT: f64 = 420.0;
/// A measured curve with at most this many points has a mark at each.
const MARKED: usize = 60;

/// A chart of curves on two axes.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Curves {
    /// The title of the chart.
    pub title: String,
    /// A second line; may be empty.
    pub subtitle: String,
    /// The quantity on the horizontal axis, with its unit: `averaging time τ (s)`.
    pub x_label: String,
    /// The quantity on the vertical axis, with its unit: `Allan deviation (rad/s)`.
    pub y_label: String,
    /// Whether the axes are linear, not logarithmic.
    pub linear: bool,
    /// The meaning of the bands: `95 % confidence`.
    pub band: String,
    /// The curves, drawn in this order.
    pub curves: Vec<Curve>,
}

/// One curve.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Curve {
    /// Its name.
    pub name: String,
    /// Its kind, which sets its style.
    pub kind: CurveKind,
    /// Its points, joined in this order. It leaves out points that are not finite, or not positive on a logarithmic
    /// axis.
    pub points: Vec<(f64, f64)>,
    /// A band around it: `(x, lowest, highest)`; may be empty.
    pub band: Vec<(f64, f64, f64)>,
}

/// The meaning of a curve.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum CurveKind {
    /// Measured: coloured, with marks.
    #[default]
    Measured,
    /// Expected: dark and dashed.
    Theory,
}

/// Draws curves, on logarithmic axes by default.
#[must_use]
pub fn curves(input: &Curves) -> String {
    let looks = looks(input);
    let (x, y) = axes(input);
    let left = Frame::left_margin(&y, &input.y_label);
    let head = Head::new(&input.title, &input.subtitle, left + WIDTH);
    let legend = Legend::new(entries(input, &looks), WIDTH);
    let frame = Frame {
        left,
        top: head.height() + 10.0 + legend.height + if y.power.is_some() { 20.0 } else { 6.0 },
        width: WIDTH,
        height: HEIGHT.max(EndLabel::height(input.curves.len())),
        x,
        y,
    };
    let labels = end_labels(input, &looks, &frame);
    let right = EndLabel::margin(&labels).max(MARGIN) + MARGIN;
    let width = (frame.right() + right).max(head.width() + 2.0 * MARGIN);
    sheet(width, frame.bottom() + 46.0, &input.title, |canvas| {
        head.draw(canvas, MARGIN);
        legend.draw(canvas, left, head.height() + 8.0);
        frame.draw_axes(canvas, true);
        frame.draw_labels(canvas, &input.x_label, &input.y_label, left);
        for (curve, look) in input.curves.iter().zip(&looks) {
            draw_band(canvas, &frame, input, curve, look);
        }
        for (curve, look) in input.curves.iter().zip(&looks) {
            draw_curve(canvas, &frame, input, curve, look);
        }
        EndLabel::draw(&labels, canvas, &frame);
        if labels.is_empty() {
            frame.draw_no_data(canvas);
        }
    })
}

/// The style of a curve.
struct Look {
    color: Color,
    mark: Option<Mark>,
    pen: Pen,
}

fn looks(input: &Curves) -> Vec<Look> {
    let (mut measured, mut theories) = (0, 0);
    let look = |curve: &Curve| match curve.kind {
        CurveKind::Measured => {
            measured += 1;
            let color = color(measured - 1);
            Look { color, mark: Some(mark(measured - 1)), pen: Pen::new(color, 1.75) }
        }
        CurveKind::Theory => {
            theories += 1;
            let dashes = [(8.0, 4.0), (2.5, 3.0), (14.0, 4.0)][(theories - 1) % 3];
            Look { color: INK, mark: None, pen: Pen::new(INK, 1.25).dashed(dashes.0, dashes.1) }
        }
    };
    input.curves.iter().map(look).collect()
}

fn axes(input: &Curves) -> (Axis, Axis) {
    let options = Options { log: !input.linear, room: 10, pad: 0.03, ..Options::default() };
    let points = || input.curves.iter().flat_map(|c| drawn(input, c));
    let bands = || input.curves.iter().flat_map(|c| band(input, c));
    let x = points().map(|p| p.0).chain(bands().map(|b| b.0));
    let y = points().map(|p| p.1);
    let y = y.chain(bands().flat_map(|b| [b.1, b.2]));
    (Axis::new(x, &options), Axis::new(y, &options))
}

fn shown(input: &Curves, v: f64) -> bool {
    drawable(v) && (input.linear || v > 0.0)
}

fn drawn<'a>(input: &'a Curves, curve: &'a Curve) -> impl Iterator<Item = (f64, f64)> + 'a {
    let keep = |p: &(f64, f64)| shown(input, p.0) && drawable(p.1);
    curve.points.iter().copied().filter(keep)
}

fn band<'a>(input: &'a Curves, curve: &'a Curve) -> impl Iterator<Item = (f64, f64, f64)> + 'a {
    let keep = |b: &(f64, f64, f64)| shown(input, b.0) && drawable(b.1) && drawable(b.2);
    curve.band.iter().copied().filter(keep)
}

/// Legend entries for everything without a label at a line's end: the bands, and curves without points.
fn entries(input: &Curves, looks: &[Look]) -> Vec<(Sign, String)> {
    let mut entries = Vec::new();
    for (curve, look) in input.curves.iter().zip(looks) {
        if drawn(input, curve).next().is_none() {
            entries.push((Sign::Line(look.pen), format!("{} (no data)", curve.name)));
        }
    }
    if input.curves.iter().any(|c| !c.band.is_empty()) {
        let name = if input.band.is_empty() { "confidence band" } else { &input.band };
        entries.push((Sign::Area(FAINT, 0.25), name.to_owned()));
    }
    entries
}

fn end_labels(input: &Curves, looks: &[Look], frame: &Frame) -> Vec<EndLabel> {
    let label = |(curve, look): (&Curve, &Look)| {
        let end = drawn(input, curve).last()?;
        Some(EndLabel {
            text: curve.name.clone(),
            color: look.color,
            mark: look.mark,
            bold: false,
            end: frame.at(end),
        })
    };
    input.curves.iter().zip(looks).filter_map(label).collect()
}

fn draw_band(canvas: &mut Canvas<'_>, frame: &Frame, input: &Curves, curve: &Curve, look: &Look) {
    let side = |pick: fn((f64, f64, f64)) -> f64| {
        let points: Vec<_> = band(input, curve).map(|b| frame.at((b.0, pick(b)))).collect();
        thin(&points)
    };
    let mut outline = side(|b| b.2);
    let mut lower = side(|b| b.1);
    lower.reverse();
    outline.append(&mut lower);
    if outline.len() > 2 {
        canvas.polygon(&outline, look.color, 0.2);
    }
}

fn draw_curve(canvas: &mut Canvas<'_>, frame: &Frame, input: &Curves, curve: &Curve, look: &Look) {
    let points: Vec<_> = drawn(input, curve).map(|p| frame.at(p)).collect();
    let points = thin(&points);
    if points.len() > 1 {
        canvas.path(&points, &look.pen);
    }
    if let Some(mark) = look.mark.filter(|_| points.len() <= MARKED) {
        for &point in &points {
            canvas.mark(mark, point, 3.4, look.color);
        }
    }
}
