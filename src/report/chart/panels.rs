//! Stacked time series with a common time axis.

use super::axis::{Axis, Options};
use super::canvas::{Canvas, Color, Font, INK, Pen, color, sheet};
use super::plot::{EndLabel, Frame, Head, LEADING, Legend, MARGIN, SMALL, Sign, longest};
use super::series::{drawable, range, runs, thin_runs};

const WIDTH: f64 = 800.0;
const HEIGHT: f64 = 160.0;

/// A chart of panels, one above the other.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Panels<'a> {
    /// The title of the chart.
    pub title: String,
    /// A second line; may be empty.
    pub subtitle: String,
    /// The quantity on the common axis, with its unit: `time (s)`.
    pub x_label: String,
    /// The panels, from top to bottom.
    pub panels: Vec<Panel<'a>>,
}

/// One panel.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Panel<'a> {
    /// The title of the panel.
    pub title: String,
    /// The quantity on the vertical axis, with its unit: `angular rate (rad/s)`.
    pub y_label: String,
    /// The lines, drawn in this order, truth last.
    pub lines: Vec<Line<'a>>,
    /// The period of an angle, in the unit of the axis: no line crosses a wrap.
    pub wrap: Option<f64>,
    /// Whether the vertical axis is logarithmic.
    pub log_y: bool,
}

/// One line of a panel.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Line<'a> {
    /// Its name.
    pub name: &'a str,
    /// Times. If `x` and `y` differ in length, only the common part counts.
    pub x: &'a [f64],
    /// Values; one that is not finite leaves a gap.
    pub y: &'a [f64],
    /// Its kind, which sets its style.
    pub kind: LineKind,
}

/// The meaning of a line.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum LineKind {
    /// A measured or estimated value, in its own colour with its name at its right end.
    #[default]
    Value,
    /// A true value: thin and dark, over the others, once in the legend.
    Truth,
}

/// Draws stacked panels of lines.
#[must_use]
pub fn panels(input: &Panels<'_>) -> String {
    let empty = [Panel::default()];
    let panels = match input.panels.as_slice() {
        [] => &empty,
        some => some,
    };
    let plans: Vec<Plan<'_>> = plan(panels);
    let left = plans.iter().map(|p| Frame::left_margin(&p.frame.y, &p.panel.y_label)).fold(0.0, f64::max);
    let right = plans.iter().map(|p| p.right_margin()).fold(2.0 * MARGIN, f64::max);
    let head = Head::new(&input.title, &input.subtitle, left + WIDTH);
    let mut height = head.height();
    let mut placed = Vec::new();
    for mut plan in plans {
        height += plan.head_height();
        (plan.frame.left, plan.frame.top) = (left, height);
        height += plan.frame.height + 10.0;
        placed.push(plan);
    }
    let width = (left + WIDTH + right).max(head.width() + 2.0 * MARGIN);
    sheet(width, height + 44.0, &input.title, |canvas| {
        head.draw(canvas, MARGIN);
        let last = placed.len() - 1;
        for (i, plan) in placed.iter_mut().enumerate() {
            plan.draw(canvas, i == last);
            let label = if i == last { &input.x_label } else { "" };
            plan.frame.draw_labels(canvas, label, &plan.panel.y_label, left);
        }
    })
}

/// A panel with its position and axes.
struct Plan<'a> {
    panel: &'a Panel<'a>,
    colors: Vec<Color>,
    title: Vec<String>,
    legend: Legend,
    frame: Frame,
}

fn plan<'a>(panels: &'a [Panel<'a>]) -> Vec<Plan<'a>> {
    let times = panels.iter().flat_map(|p| &p.lines).flat_map(|l| l.x);
    let x = Axis::new(times.copied(), &Options { room: 10, ..Options::default() });
    let plan = |(panel, colors): (&'a Panel<'a>, Vec<Color>)| {
        let height = HEIGHT.max(EndLabel::height(colors.len()));
        let shown = panel.lines.iter().flat_map(|l| l.y).copied();
        let options = Options {
            log: panel.log_y,
            room: (height / 30.0) as usize,
            pad: 0.05,
            wrap: panel.wrap,
            floor: None,
        };
        let legend = Legend::new(truth_entries(panel), WIDTH / 2.0);
        let font = Font::new(12.5, INK).bold();
        Plan {
            panel,
            colors,
            title: font.wrap(&panel.title, WIDTH - legend.width - 16.0),
            legend,
            frame: Frame {
                left: 0.0,
                top: 0.0,
                width: WIDTH,
                height,
                x: x.clone(),
                y: Axis::new(shown, &options),
            },
        }
    };
    panels.iter().zip(colors(panels)).map(plan).collect()
}

/// The lines other than truth.
fn values<'a>(panel: &'a Panel<'a>) -> impl Iterator<Item = &'a Line<'a>> {
    let value = |l: &&Line<'_>| l.kind == LineKind::Value;
    panel.lines.iter().filter(value)
}

/// A colour for every value of every panel. A name keeps its colour between panels; a panel without a name in
/// common with those above starts again.
fn colors(panels: &[Panel<'_>]) -> Vec<Vec<Color>> {
    let mut known: Vec<(&str, usize)> = Vec::new();
    let mut all = Vec::new();
    for panel in panels {
        let find = |known: &[(&str, usize)], name: &str| {
            let same = |k: &&(&str, usize)| k.0 == name;
            known.iter().find(same).map(|k| k.1)
        };
        let shares = values(panel).any(|l| find(&known, l.name).is_some());
        let mut next = match shares {
            true => known.iter().map(|k| k.1 + 1).max().unwrap_or(0),
            false => 0,
        };
        let mut own = Vec::new();
        for line in values(panel) {
            let n = find(&known, line.name).unwrap_or_else(|| {
                known.push((line.name, next));
                next += 1;
                next - 1
            });
            own.push(color(n));
        }
        all.push(own);
    }
    all
}

fn truth(panel: &Panel<'_>) -> Pen {
    let only = panel.lines.iter().all(|l| l.kind == LineKind::Truth);
    Pen::new(INK, if only { 1.4 } else { 0.9 })
}

fn truth_entries(panel: &Panel<'_>) -> Vec<(Sign, String)> {
    let mut names: Vec<&str> = Vec::new();
    for line in panel.lines.iter().filter(|l| l.kind == LineKind::Truth) {
        if !names.contains(&line.name) {
            names.push(line.name);
        }
    }
    let entry = |name: &str| (Sign::Line(truth(panel)), name.to_owned());
    names.into_iter().map(entry).collect()
}

impl Plan<'_> {
    fn head_height(&self) -> f64 {
        12.0 + (16.0 * self.title.len() as f64).max(self.legend.height).max(4.0) + 4.0
    }

    fn right_margin(&self) -> f64 {
        let names: Vec<&str> = values(self.panel).map(|l| l.name).collect();
        22.0 + longest(&Font::new(SMALL, INK), &names) + MARGIN
    }

    fn draw(&mut self, canvas: &mut Canvas<'_>, last: bool) {
        let (left, top) = (self.frame.left, self.frame.top);
        let above = top - self.head_height() + 12.0;
        for (i, line) in self.title.iter().enumerate() {
            let font = Font::new(12.5, INK).bold();
            canvas.text(line, (left, above + 7.0 + i as f64 * LEADING), &font);
        }
        let x = self.frame.right() - self.legend.width + 16.0;
        self.legend.draw(canvas, x, above - 2.0);
        self.frame.draw_axes(canvas, last);
        let mut labels = Vec::new();
        // A broad pale line stays visible under a thin dark one.
        let truth_too = self.legend.height > 0.0;
        let (width, alpha) = if truth_too { (3.0, 0.6) } else { (1.4, 1.0) };
        for (line, &color) in values(self.panel).zip(&self.colors) {
            self.draw_line(canvas, line, &Pen::new(color, width).alpha(alpha));
            if let Some(end) = self.end(line) {
                labels.push(EndLabel { text: line.name.to_owned(), color, mark: None, bold: false, end });
            }
        }
        for line in &self.panel.lines {
            if line.kind == LineKind::Truth {
                self.draw_line(canvas, line, &truth(self.panel));
            }
        }
        EndLabel::draw(&labels, canvas, &self.frame);
        let drawn = |l: &Line<'_>| l.x.iter().zip(l.y).any(|(x, y)| drawable(*x) && drawable(*y));
        if !self.panel.lines.iter().any(drawn) {
            self.frame.draw_no_data(canvas);
        }
    }

    fn draw_line(&self, canvas: &mut Canvas<'_>, line: &Line<'_>, pen: &Pen) {
        let place = |run: Vec<(f64, f64)>| run.into_iter().map(|p| self.frame.at(p)).collect();
        let placed: Vec<Vec<(f64, f64)>> =
            runs(line.x, line.y, self.panel.wrap).into_iter().map(place).collect();
        let runs = thin_runs(&placed, self.frame.width);
        // A single value is a dot; among many, a dash as long as a pixel column.
        let lone = if runs.len() <= 100 { 2.5 } else { 0.5 };
        for run in runs {
            match run.as_slice() {
                &[(x, y)] => {
                    let pen = Pen { width: pen.width.max(2.0 * lone), ..*pen };
                    canvas.line((x - lone, y), (x + lone, y), &pen);
                }
                run => canvas.path(run, pen),
            }
        }
    }

    /// The position of a line's name: its end, for a noisy line the middle of its last hundredth. A line without a
    /// value keeps its name, half-way up.
    fn end(&self, line: &Line<'_>) -> Option<(f64, f64)> {
        let runs = runs(line.x, line.y, self.panel.wrap);
        let Some(run) = runs.last() else {
            let frame = &self.frame;
            return Some((frame.right(), frame.top + frame.height / 2.0));
        };
        let start = run.len() - (run.len() / 100).max(1);
        let (lo, hi) = range(run[start..].iter().map(|p| p.1))?;
        Some(self.frame.at((run.last()?.0, lo / 2.0 + hi / 2.0)))
    }
}
