//! Small multiples of cost against error, both logarithmic, one below the other: a page is not wide enough for two.

use super::axis::{Axis, Options};
use super::canvas::{Canvas, Font, INK, Pen, color, mark, sheet};
use super::front;
use super::plot::{EndLabel, Frame, Head, Legend, MARGIN, Sign};
use super::series::drawable;

const WIDTH: f64 = 560.0;
const HEIGHT: f64 = 250.0;
/// Space above each plot for its title, and below it for its axis.
const ABOVE: f64 = 40.0;
const BELOW: f64 = 44.0;

/// One plot for each motion, with the same axes.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LogLog {
    /// The title of the chart.
    pub title: String,
    /// A second line; may be empty.
    pub subtitle: String,
    /// The quantity on the horizontal axis, with its unit: `cost (ns per simulated second)`.
    pub x_label: String,
    /// The quantity on the vertical axis, with its unit: `error (deg)`.
    pub y_label: String,
    /// Errors at or below this lie on the floor of the plots; without it, only non-positive errors do.
    pub y_floor: Option<f64>,
    /// The plots.
    pub motions: Vec<Motion>,
}

/// One plot.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Motion {
    /// The title of the plot.
    pub title: String,
    /// The methods in it.
    pub methods: Vec<Method>,
}

/// One method on one motion.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Method {
    /// Its name: the same method has the same colour and mark in every plot.
    pub name: String,
    /// Cost and error, one point for each rate, in the order to join them. A point that is not finite, or has no
    /// positive cost, is left out.
    pub points: Vec<(f64, f64)>,
}

impl Method {
    /// The drawable points; errors below the floor count as on it.
    fn drawn(&self, floor: f64) -> impl Iterator<Item = (f64, f64)> + '_ {
        let drawn = |p: &&(f64, f64)| drawable(p.0) && drawable(p.1) && p.0 > 0.0;
        self.points.iter().filter(drawn).map(move |p| (p.0, p.1.max(floor)))
    }
}

/// Draws cost against error, with the front of the points that no cheaper one beats.
#[must_use]
pub fn loglog(input: &LogLog) -> String {
    let empty = [Motion::default()];
    let motions = match input.motions.as_slice() {
        [] => &empty,
        some => some,
    };
    let names = names(motions);
    let plan = Plan::new(input, motions, &names);
    let inner = plan.width;
    let head = Head::new(&input.title, &input.subtitle, inner);
    let legend = Legend::new(entries(&names), inner);
    let top = head.height() + 6.0 + legend.height;
    let width = inner.max(head.width()).max(legend.width) + 2.0 * MARGIN;
    let height = top + (ABOVE + plan.height + BELOW) * motions.len() as f64 + MARGIN / 2.0;
    sheet(width, height, &input.title, |canvas| {
        head.draw(canvas, MARGIN);
        legend.draw(canvas, MARGIN, head.height() + 4.0);
        for (i, motion) in motions.iter().enumerate() {
            let frame = plan.frame(i, top);
            plan.draw(canvas, motion, &frame);
        }
    })
}

/// The names of the methods, in order of appearance.
fn names(motions: &[Motion]) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for method in motions.iter().flat_map(|m| &m.methods) {
        if !names.contains(&method.name.as_str()) {
            names.push(&method.name);
        }
    }
    names
}

fn entries(names: &[&str]) -> Vec<(Sign, String)> {
    let method = |(i, name): (usize, &&str)| {
        let sign = Sign::Marked(mark(i), Pen::new(color(i), 1.25));
        (sign, (*name).to_owned())
    };
    let mut entries: Vec<_> = names.iter().enumerate().map(method).collect();
    if !entries.is_empty() {
        let sign = Sign::Ring(front::pen(), ring_pen());
        entries.push((sign, "cheapest for its error (name in bold)".to_owned()));
    }
    entries
}

fn ring_pen() -> Pen {
    Pen::new(INK, 1.5)
}

/// The value below which no plot distinguishes errors.
fn floor(input: &LogLog) -> f64 {
    input.y_floor.filter(|f| drawable(*f) && *f > 0.0).unwrap_or(0.0)
}

/// The layout that all plots share.
struct Plan<'a> {
    input: &'a LogLog,
    names: &'a [&'a str],
    x: Axis,
    y: Axis,
    left: f64,
    height: f64,
    /// The width of a plot with its labels.
    width: f64,
}

impl<'a> Plan<'a> {
    fn new(input: &'a LogLog, motions: &[Motion], names: &'a [&'a str]) -> Self {
        let most = motions.iter().map(|m| m.methods.len()).max().unwrap_or(0);
        let height = HEIGHT.max(EndLabel::height(most));
        let floor = floor(input);
        let points = || motions.iter().flat_map(|m| &m.methods).flat_map(|m| m.drawn(floor));
        let x = Options { log: true, room: 8, pad: 0.04, ..Options::default() };
        let y = Options {
            log: true,
            room: (height / 26.0) as usize,
            pad: 0.04,
            floor: input.y_floor,
            ..Options::default()
        };
        let x = Axis::new(points().map(|p| p.0), &x);
        let y = Axis::new(points().map(|p| p.1), &y);
        let left = Frame::left_margin(&y, &input.y_label);
        let font = Font::new(super::plot::SMALL, INK).bold();
        let labels = names.iter().map(|n| font.width(n)).fold(0.0, f64::max);
        Self { input, names, left, height, width: left + WIDTH + labels + 42.0, x, y }
    }

    fn frame(&self, row: usize, top: f64) -> Frame {
        Frame {
            left: self.left,
            top: top + ABOVE + (ABOVE + self.height + BELOW) * row as f64,
            width: WIDTH,
            height: self.height,
            x: self.x.clone(),
            y: self.y.clone(),
        }
    }

    fn draw(&self, canvas: &mut Canvas<'_>, motion: &Motion, frame: &Frame) {
        let title = Font::new(13.0, INK).bold();
        canvas.text(&motion.title, (frame.left, frame.top - 14.0), &title);
        frame.draw_axes(canvas, true);
        frame.draw_labels(canvas, &self.input.x_label, &self.input.y_label, self.left);
        let floor = floor(self.input);
        let front = front::best(motion.methods.iter().flat_map(|m| m.drawn(floor)));
        front::draw(canvas, frame, &front);
        let mut labels = Vec::new();
        for method in &motion.methods {
            let n = self.names.iter().position(|n| *n == method.name).unwrap_or(0);
            let points: Vec<_> = method.drawn(floor).map(|p| frame.at(p)).collect();
            if points.len() > 1 {
                canvas.path(&points, &Pen::new(color(n), 1.25));
            }
            for &point in &points {
                canvas.mark(mark(n), point, 3.4, color(n));
            }
            let Some(&end) = points.last() else { continue };
            labels.push(EndLabel {
                text: method.name.clone(),
                color: color(n),
                mark: Some(mark(n)),
                bold: method.drawn(floor).any(|p| front.contains(&p)),
                end,
            });
        }
        for &point in &front {
            canvas.ring(frame.at(point), 6.0, &ring_pen());
        }
        EndLabel::draw(&labels, canvas, frame);
        if labels.is_empty() {
            frame.draw_no_data(canvas);
        }
    }
}
