//! Named points on two axes: cost across, error up, the front of the cheapest, and levels to compare with.

use super::axis::{Axis, Options};
use super::canvas::{Anchor, Canvas, FAINT, Font, INK, Pen, WHITE, color, dark, mark, sheet};
use super::front;
use super::labels::{Area, Place, Wanted, place};
use super::plot::{EndLabel, Frame, Head, LEADING, Legend, MARGIN, SMALL, Sign, longest};
use super::series::drawable;

/// The width of the whole, kept where the names beside the plot leave room.
const WHOLE: f64 = 800.0;
const NARROWEST: f64 = 420.0;
const HEIGHT: f64 = 320.0;
/// A plot whose labels find no room becomes higher, up to this.
const HIGHEST: f64 = 1000.0;
/// The longest line of a label.
const LINE: f64 = 210.0;
/// Height of a line of a label.
const LINE_HEIGHT: f64 = 13.5;

/// A chart of named points, on logarithmic axes unless they are declared linear.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Points {
    /// The title of the chart.
    pub title: String,
    /// A second line; may be empty.
    pub subtitle: String,
    /// The quantity on the horizontal axis, with its unit: `cost (ns per simulated second)`.
    pub x_label: String,
    /// The quantity on the vertical axis, with its unit: `error (deg)`.
    pub y_label: String,
    /// Whether the horizontal axis is linear.
    pub x_linear: bool,
    /// Whether the vertical axis is linear.
    pub y_linear: bool,
    /// On a logarithmic axis, values at or below this lie on the floor of the plot, marked "≤"; without it, only those
    /// that are not positive do.
    pub y_floor: Option<f64>,
    /// The names of the groups, in a legend. A group has one colour and one shape.
    pub groups: Vec<String>,
    /// The points.
    pub points: Vec<Point>,
    /// Dashed horizontal lines, their names right of the plot.
    pub levels: Vec<Level>,
    /// Whether a staircase joins the points that no cheaper point beats (cheaper is further left, better is lower).
    pub front: bool,
    /// Lines below the plot, such as what the error bars are; may be empty.
    pub notes: Vec<String>,
}

/// One point.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Point {
    /// Its label; a point without a name has none.
    pub name: String,
    /// Its group: the place of the group's name in [`Points::groups`].
    pub group: usize,
    /// Where it lies across. A point that is not finite, or not positive on a logarithmic axis, is left out.
    pub x: f64,
    /// Where it lies up. A point that is not finite is left out; one that is not positive lies on the floor of a
    /// logarithmic axis.
    pub y: f64,
    /// The ends of its error bar, lower first.
    pub spread: Option<(f64, f64)>,
}

/// A horizontal line to compare with.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Level {
    /// Its name.
    pub name: String,
    /// Where it lies up. It is left out if it is not finite, or not positive on a logarithmic axis.
    pub y: f64,
}

impl Points {
    /// The points that can be drawn, those below the floor on it.
    fn drawn(&self) -> impl Iterator<Item = &Point> {
        let place = |p: &&Point| drawable(p.x) && drawable(p.y) && (self.x_linear || p.x > 0.0);
        self.points.iter().filter(place)
    }

    /// Where a point counts as lying: not below the floor.
    fn value(&self, point: &Point) -> (f64, f64) {
        let floor = self.y_floor.filter(|floor| drawable(*floor) && *floor > 0.0).unwrap_or(0.0);
        (point.x, if self.y_linear { point.y } else { point.y.max(floor) })
    }

    fn shown(&self, y: f64) -> bool {
        drawable(y) && (self.y_linear || y > 0.0)
    }

    fn levels(&self) -> impl Iterator<Item = &Level> {
        self.levels.iter().filter(|level| self.shown(level.y))
    }

    /// The ends of a point's error bar; an end that a logarithmic axis cannot show is its bottom.
    fn bar(&self, point: &Point) -> Option<(f64, f64)> {
        let (low, high) = point.spread.filter(|(low, high)| drawable(*low) && self.shown(*high))?;
        Some((low.min(high), high))
    }
}

/// Draws named points.
#[must_use]
pub fn points(input: &Points) -> String {
    let plot = Plot::new(input);
    let frame = &plot.frame;
    let right = EndLabel::margin(&plot.beside).max(MARGIN) + MARGIN;
    let width = (frame.right() + right).max(plot.head.width() + 2.0 * MARGIN);
    let width = width.max(plot.legend.width + 2.0 * MARGIN);
    let note = Font::new(SMALL, FAINT);
    let notes: Vec<String> =
        input.notes.iter().flat_map(|text| note.wrap(text, width - 2.0 * MARGIN)).collect();
    let width = width.max(longest(&note, &notes) + 2.0 * MARGIN);
    let below = frame.bottom() + 50.0;
    let height = below + LEADING * notes.len() as f64 + if notes.is_empty() { 0.0 } else { 8.0 };
    sheet(width, height, &input.title, |canvas| {
        plot.draw(canvas, input);
        for (i, line) in notes.iter().enumerate() {
            canvas.text(line, (MARGIN, below + LEADING * (i as f64 + 0.5)), &note);
        }
    })
}

/// Everything in its place.
struct Plot<'a> {
    head: Head,
    legend: Legend,
    frame: Frame,
    left: f64,
    labels: Vec<(Label<'a>, Place)>,
    beside: Vec<EndLabel>,
}

/// A label beside its point.
struct Label<'a> {
    point: &'a Point,
    lines: Vec<String>,
}

fn font() -> Font {
    Font::new(12.0, INK)
}

impl<'a> Plot<'a> {
    fn new(input: &'a Points) -> Self {
        let (x, y) = axes(input);
        let left = Frame::left_margin(&y, &input.y_label);
        let names = EndLabel::margin(&levels(input, None));
        let width = (WHOLE - left - names.max(MARGIN) - MARGIN).max(NARROWEST);
        let head = Head::new(&input.title, &input.subtitle, left + width);
        let legend = Legend::new(entries(input), left + width - MARGIN);
        let top = head.height() + 14.0 + legend.height + if y.power.is_some() { 14.0 } else { 0.0 };
        let height = HEIGHT.max(EndLabel::height(input.levels.len()));
        let mut frame = Frame { left, top, width, height, x, y };
        let mut labels = placed(input, &frame);
        while labels.iter().any(|label| label.1.is_none()) && frame.height < HIGHEST {
            frame.height *= 1.25;
            labels = placed(input, &frame);
        }
        let mut beside = levels(input, Some(&frame));
        beside.extend(labels.iter().filter(|label| label.1.is_none()).map(|(label, _)| EndLabel {
            text: label.point.name.clone(),
            color: color(label.point.group),
            mark: Some(mark(label.point.group)),
            bold: false,
            end: frame.at(input.value(label.point)),
        }));
        frame.height = frame.height.max(EndLabel::height(beside.len()));
        let labels = labels.into_iter().filter_map(|(label, place)| Some((label, place?))).collect();
        Self { head, legend, frame, left, labels, beside }
    }

    fn draw(&self, canvas: &mut Canvas<'_>, input: &Points) {
        let frame = &self.frame;
        self.head.draw(canvas, MARGIN);
        self.legend.draw(canvas, MARGIN, self.head.height() + 4.0);
        frame.draw_axes(canvas, true);
        frame.draw_labels(canvas, &input.x_label, &input.y_label, self.left);
        for level in input.levels() {
            let y = frame.at((0.0, level.y)).1;
            canvas.line((frame.left, y), (frame.right(), y), &Pen::new(FAINT, 1.0).dashed(6.0, 4.0));
        }
        if input.front {
            front::draw(canvas, frame, &front::best(input.drawn().map(|point| input.value(point))));
        }
        EndLabel::draw(&self.beside, canvas, frame);
        for point in input.drawn() {
            draw_point(canvas, frame, input, point);
        }
        for (label, place) in &self.labels {
            label.draw(canvas, place, frame.at(input.value(label.point)).0);
        }
        if input.drawn().next().is_none() {
            frame.draw_no_data(canvas);
        }
    }
}

fn axes(input: &Points) -> (Axis, Axis) {
    let x = Options { log: !input.x_linear, room: 8, pad: 0.05, ..Options::default() };
    let y = Options {
        log: !input.y_linear,
        room: (HEIGHT / 26.0) as usize,
        pad: 0.05,
        floor: input.y_floor,
        ..Options::default()
    };
    let bars = input.drawn().filter_map(|point| input.bar(point)).flat_map(|(low, high)| [low, high]);
    let others = bars.chain(input.levels().map(|level| level.y)).filter(|y| input.shown(*y));
    let ys = input.drawn().map(|point| input.value(point).1).chain(others);
    (Axis::new(input.drawn().map(|point| point.x), &x), Axis::new(ys, &y))
}

fn entries(input: &Points) -> Vec<(Sign, String)> {
    let group = |(i, name): (usize, &String)| (Sign::Mark(mark(i), color(i)), name.clone());
    let mut entries: Vec<_> = input.groups.iter().enumerate().map(group).collect();
    if input.front {
        entries.push((Sign::Line(front::pen()), "the front: no cheaper point is better".to_owned()));
    }
    entries
}

/// The names of the levels; without a frame only their widths count.
fn levels(input: &Points, frame: Option<&Frame>) -> Vec<EndLabel> {
    let label = |level: &Level| EndLabel {
        text: level.name.clone(),
        color: FAINT,
        mark: None,
        bold: false,
        end: frame.map_or((0.0, 0.0), |frame| (frame.right(), frame.at((0.0, level.y)).1)),
    };
    input.levels().map(label).collect()
}

/// The labels of the named points, and the free place of each.
fn placed<'a>(input: &'a Points, frame: &Frame) -> Vec<(Label<'a>, Option<Place>)> {
    let named = input.drawn().filter(|point| !point.name.trim().is_empty());
    let labels: Vec<Label<'a>> =
        named.map(|point| Label { point, lines: font().wrap(&point.name, LINE) }).collect();
    let wanted: Vec<Wanted> = labels
        .iter()
        .map(|label| Wanted {
            at: frame.at(input.value(label.point)),
            size: (longest(&font(), &label.lines) + 4.0, LINE_HEIGHT * label.lines.len() as f64 + 2.0),
        })
        .collect();
    let marks: Vec<_> = input.drawn().map(|point| frame.at(input.value(point))).collect();
    let bounds = Area {
        left: frame.left + 2.0,
        top: frame.top - 6.0,
        right: frame.right() + 2.0,
        bottom: frame.bottom() - 2.0,
    };
    labels.into_iter().zip(place(&wanted, &marks, &lines(input, frame), &bounds)).collect()
}

/// What no label may lie on: the levels, the front and the error bars. All run along an axis.
fn lines(input: &Points, frame: &Frame) -> Vec<Area> {
    let mut areas = Vec::new();
    for level in input.levels() {
        let y = frame.at((0.0, level.y)).1;
        areas.push(Area::between((frame.left, y), (frame.right(), y), 2.0));
    }
    if input.front {
        let front = front::best(input.drawn().map(|point| input.value(point)));
        areas.extend(
            front::corners(frame, &front).windows(2).map(|pair| Area::between(pair[0], pair[1], 4.0)),
        );
    }
    for point in input.drawn() {
        if let Some((low, high)) = input.bar(point) {
            let (low, high) = (frame.at((point.x, low)), frame.at((point.x, high)));
            areas.push(Area::between(low, high, 4.5));
        }
    }
    areas
}

fn draw_point(canvas: &mut Canvas<'_>, frame: &Frame, input: &Points, point: &Point) {
    let color = color(point.group);
    if let Some((low, high)) = input.bar(point) {
        let (low, high) = (frame.at((point.x, low)), frame.at((point.x, high)));
        let pen = Pen::new(color, 1.25);
        canvas.line(low, high, &pen);
        for (x, y) in [low, high] {
            canvas.line((x - 3.5, y), (x + 3.5, y), &pen);
        }
    }
    canvas.mark(mark(point.group), frame.at(input.value(point)), 4.8, color);
}

impl Label<'_> {
    /// Draws a label in its place; `x` is where its point lies across.
    fn draw(&self, canvas: &mut Canvas<'_>, place: &Place, x: f64) {
        let area = &place.area;
        if let Some((from, to)) = place.leader {
            canvas.line(from, to, &Pen::new(FAINT, 0.75));
        }
        // Grid lines end at a label.
        let size = (area.right - area.left, area.bottom - area.top);
        canvas.rect((area.left, area.top), size, WHITE, 1.0);
        // The text begins on the side of its point: it is narrower than its estimate.
        let (anchor, at) = match area {
            right if right.left > x => (Anchor::Start, area.left + 2.0),
            left if left.right < x => (Anchor::End, area.right - 2.0),
            _ => (Anchor::Middle, area.middle().0),
        };
        let font = Font { color: dark(color(self.point.group)), ..font() }.anchor(anchor);
        for (i, line) in self.lines.iter().enumerate() {
            let y = area.top + 1.0 + LINE_HEIGHT * (i as f64 + 0.5);
            canvas.text(line, (at, y), &font);
        }
    }
}
