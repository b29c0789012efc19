//! Distributions: histograms, and the share below or above a value.

use super::axis::{Axis, Options};
use super::canvas::{Anchor, Canvas, Color, FAINT, Font, INK, Pen, color, dark, sheet};
use super::plot::{Frame, Head, Legend, MARGIN, SMALL, Sign};
use super::series::drawable;

const WIDTH: f64 = 800.0;
const HEIGHT: f64 = 330.0;
const BINS: usize = 80;
/// Distance between rows of marker labels.
const ROW: f64 = 15.0;

/// A chart of one or several distributions.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Histogram {
    /// The title of the chart.
    pub title: String,
    /// A second line; may be empty.
    pub subtitle: String,
    /// The quantity, with its unit: `lateness (µs)`.
    pub x_label: String,
    /// The way to show a distribution.
    pub shape: Shape,
    /// Whether the axis of the values is logarithmic.
    pub log_x: bool,
    /// Whether the axis of the shares is logarithmic.
    pub log_y: bool,
    /// The distributions, each in its own colour.
    pub distributions: Vec<Distribution>,
    /// Vertical lines with labels above the plot.
    pub markers: Vec<Marker>,
}

/// The way to show a distribution. Shares are relative to its own samples, in percent.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Shape {
    /// The share of samples in each of 80 bins.
    #[default]
    Bins,
    /// The share of samples at or below a value (the empirical distribution function).
    Below,
    /// The share of samples above a value, which shows rare large ones when `log_y` is set.
    Above,
}

/// Values, each with its count.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Distribution {
    /// What was measured.
    pub name: String,
    /// A value and its count, in any order.
    pub values: Vec<(f64, u64)>,
}

impl Distribution {
    /// A distribution of samples, each counted once.
    #[must_use]
    pub fn of_samples(name: &str, samples: impl IntoIterator<Item = f64>) -> Self {
        Self { name: name.to_owned(), values: samples.into_iter().map(|v| (v, 1)).collect() }
    }

    /// The drawable values, in order.
    fn sorted(&self) -> Vec<(f64, f64)> {
        let drawn = |p: &&(f64, u64)| drawable(p.0) && p.1 > 0;
        let shares = self.values.iter().filter(drawn);
        let mut sorted: Vec<_> = shares.map(|p| (p.0, p.1 as f64)).collect();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        sorted
    }
}

/// A vertical line.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Marker {
    /// Its position, in the unit of the values.
    pub x: f64,
    /// Its label: `gyro p99 61 µs`.
    pub label: String,
    /// The distribution whose colour it takes; dark if `None`.
    pub of: Option<usize>,
}

/// Draws distributions.
#[must_use]
pub fn histogram(input: &Histogram) -> String {
    let sorted: Vec<_> = input.distributions.iter().map(Distribution::sorted).collect();
    let x = x_axis(input, &sorted);
    let traces: Vec<_> = sorted.iter().map(|s| trace(input.shape, s, &x)).collect();
    let y = y_axis(input, &traces);
    let left = Frame::left_margin(&y, y_label(input.shape));
    let head = Head::new(&input.title, &input.subtitle, left + WIDTH);
    let legend = Legend::new(entries(input), WIDTH);
    let labels = place_labels(input, &x, left);
    let rows = labels.iter().map(|l| l.row + 1).max().unwrap_or(0) as f64;
    let mut frame = Frame {
        left,
        top: head.height() + 8.0 + legend.height + 12.0 + rows * ROW,
        width: WIDTH,
        height: HEIGHT,
        x,
        y,
    };
    if frame.y.power.is_some() && rows == 0.0 {
        frame.top += ROW;
    }
    let reach = labels.iter().map(|l| l.right).fold(frame.right(), f64::max);
    let width = (reach + 2.0 * MARGIN).max(head.width() + 2.0 * MARGIN);
    sheet(width, frame.bottom() + 48.0, &input.title, |canvas| {
        head.draw(canvas, MARGIN);
        legend.draw(canvas, left, head.height() + 8.0);
        frame.draw_axes(canvas, true);
        frame.draw_labels(canvas, &input.x_label, y_label(input.shape), left);
        for (i, trace) in traces.iter().enumerate() {
            draw_trace(canvas, &frame, input.shape, trace, i);
        }
        draw_markers(canvas, &frame, &labels);
        if traces.iter().all(Vec::is_empty) {
            frame.draw_no_data(canvas);
        }
    })
}

fn x_axis(input: &Histogram, sorted: &[Vec<(f64, f64)>]) -> Axis {
    let values = sorted.iter().flatten().map(|p| p.0);
    let marks = input.markers.iter().map(|m| m.x);
    let options = Options { log: input.log_x, room: 9, pad: 0.02, ..Options::default() };
    Axis::new(values.chain(marks), &options)
}

fn y_axis(input: &Histogram, traces: &[Vec<(f64, f64)>]) -> Axis {
    let shares = traces.iter().flatten().map(|p| p.1);
    let positive = shares.filter(|s| *s > 0.0 || !input.log_y);
    // Bins start at zero; shares end at 100 %.
    let ends = match (input.log_y, input.shape) {
        (false, Shape::Bins) => {
            let shares = traces.iter().flatten().map(|p| p.1);
            let highest = shares.fold(0.0, f64::max);
            vec![0.0, if highest > 0.0 { 1.06 * highest } else { 100.0 }]
        }
        (false, _) => vec![0.0, 100.0],
        (true, Shape::Bins) => vec![],
        (true, _) => vec![100.0],
    };
    let options = Options {
        log: input.log_y,
        room: 10,
        pad: if input.log_y { 0.05 } else { 0.0 },
        ..Options::default()
    };
    Axis::new(positive.chain(ends), &options)
}

fn y_label(shape: Shape) -> &'static str {
    match shape {
        Shape::Bins => "share of samples (%)",
        Shape::Below => "samples at or below (%)",
        Shape::Above => "samples above (%)",
    }
}

/// The corners of a distribution's outline: values and shares in percent.
fn trace(shape: Shape, sorted: &[(f64, f64)], x: &Axis) -> Vec<(f64, f64)> {
    let total: f64 = sorted.iter().map(|p| p.1).sum();
    if sorted.is_empty() {
        return Vec::new();
    }
    match shape {
        Shape::Bins => bins(sorted, total, x),
        Shape::Below | Shape::Above => cumulated(shape, sorted, total, x),
    }
}

fn bins(sorted: &[(f64, f64)], total: f64, x: &Axis) -> Vec<(f64, f64)> {
    let mut counts = vec![0.0; BINS];
    for (value, count) in sorted {
        let bin = (x.place(*value) * BINS as f64) as usize;
        counts[bin.min(BINS - 1)] += count;
    }
    let edges = x.edges(BINS);
    let mut outline = vec![(edges[0], 0.0)];
    for (pair, count) in edges.windows(2).zip(counts) {
        let share = 100.0 * count / total;
        outline.push((pair[0], share));
        outline.push((pair[1], share));
    }
    outline.push((edges[BINS], 0.0));
    outline
}

/// Steps at the values, at most one in each pixel column.
fn cumulated(shape: Shape, sorted: &[(f64, f64)], total: f64, x: &Axis) -> Vec<(f64, f64)> {
    let share = |below: f64| match shape {
        Shape::Above => 100.0 * (total - below) / total,
        _ => 100.0 * below / total,
    };
    let column = |v: f64| (x.place(v) * WIDTH).floor();
    let mut outline = Vec::new();
    let mut below = 0.0;
    for group in sorted.chunk_by(|a, b| column(a.0) == column(b.0)) {
        let at = group[group.len() - 1].0;
        outline.push((at, share(below)));
        below += group.iter().map(|p| p.1).sum::<f64>();
        outline.push((at, share(below)));
    }
    outline
}

fn entries(input: &Histogram) -> Vec<(Sign, String)> {
    let entry = |(i, d): (usize, &Distribution)| {
        let total: u64 = d.values.iter().map(|v| v.1).fold(0, u64::saturating_add);
        let name = format!("{} ({total} samples)", d.name);
        (Sign::Line(pen(i)), name)
    };
    input.distributions.iter().enumerate().map(entry).collect()
}

/// Colours, and dashes for every second line, so that lines on top of each other are both visible.
fn pen(i: usize) -> Pen {
    let pen = Pen::new(color(i), 1.75);
    if i % 2 == 1 { pen.dashed(7.0, 3.0) } else { pen }
}

fn draw_trace(canvas: &mut Canvas<'_>, frame: &Frame, shape: Shape, trace: &[(f64, f64)], i: usize) {
    let mut points: Vec<_> = trace.iter().map(|&p| frame.at(p)).collect();
    let (Some(&first), Some(&last)) = (points.first(), points.last()) else {
        return;
    };
    match shape {
        Shape::Bins => canvas.polygon(&points, color(i), 0.12),
        // A distribution function continues to both sides.
        Shape::Below => points.push((frame.right(), last.1)),
        Shape::Above => points.insert(0, (frame.left, first.1)),
    }
    canvas.path(&points, &pen(i));
}

/// A marker's label with its position above the plot.
struct Label<'a> {
    text: &'a str,
    color: Color,
    x: f64,
    left: f64,
    right: f64,
    row: usize,
}

/// Puts each label in the lowest row where it overlaps no other.
fn place_labels<'a>(input: &'a Histogram, x: &Axis, left: f64) -> Vec<Label<'a>> {
    let font = Font::new(SMALL, INK);
    let mut markers: Vec<&Marker> = input.markers.iter().filter(|m| drawable(m.x)).collect();
    markers.sort_by(|a, b| a.x.total_cmp(&b.x));
    let mut ends: Vec<f64> = Vec::new();
    let mut labels = Vec::new();
    // From right to left: a label is to the right of its line, clear of the lines that pass it upwards.
    for marker in markers.into_iter().rev() {
        let at = left + x.place(marker.x) * WIDTH;
        let (start, end) = (at - 2.0, at + 4.0 + font.width(&marker.label));
        let row = ends.iter().position(|taken| end + 6.0 <= *taken);
        let row = row.unwrap_or_else(|| {
            ends.push(f64::INFINITY);
            ends.len() - 1
        });
        // The line crosses the rows below: labels there must stay to the right of it.
        for taken in &mut ends[..=row] {
            *taken = taken.min(start);
        }
        labels.push(Label {
            text: &marker.label,
            color: marker.of.map_or(INK, color),
            x: at,
            left: at + 4.0,
            right: end,
            row,
        });
    }
    labels
}

fn draw_markers(canvas: &mut Canvas<'_>, frame: &Frame, labels: &[Label<'_>]) {
    for label in labels {
        let y = frame.top - 8.0 - label.row as f64 * ROW;
        let pen = Pen::new(label.color, 1.0).dashed(3.0, 3.0);
        canvas.line((label.x, frame.top), (label.x, frame.bottom()), &pen);
        let stem = Pen::new(if label.color == INK { FAINT } else { label.color }, 1.0);
        canvas.line((label.x, y - 6.0), (label.x, frame.top), &stem);
        let font = Font::new(SMALL, dark(label.color)).anchor(Anchor::Start);
        canvas.text(label.text, (label.left, y), &font);
    }
}
