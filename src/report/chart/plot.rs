//! Shared parts of charts: a head, a frame with two axes, a legend, and labels at the ends of lines.

use super::axis::Axis;
use super::canvas::{Anchor, Canvas, Color, FAINT, Font, INK, Mark, Pen, RULE, dark};
use super::series::spread;

/// The font size of ticks, labels and legends, in pixels.
pub(super) const SMALL: f64 = 11.5;
/// Distance between lines of text.
pub(super) const LEADING: f64 = 15.0;
/// Margin of a chart.
pub(super) const MARGIN: f64 = 16.0;

/// The title of a chart and the line below it, wrapped to fit.
pub(super) struct Head {
    title: Vec<String>,
    subtitle: Vec<String>,
}

impl Head {
    pub fn new(title: &str, subtitle: &str, width: f64) -> Self {
        Self {
            title: Self::title_font().wrap(title, width),
            subtitle: Self::subtitle_font().wrap(subtitle, width),
        }
    }

    fn title_font() -> Font {
        Font::new(17.0, INK).bold()
    }

    fn subtitle_font() -> Font {
        Font::new(12.5, FAINT)
    }

    pub fn height(&self) -> f64 {
        MARGIN + 22.0 * self.title.len() as f64 + 17.0 * self.subtitle.len() as f64
    }

    /// The width of the longest line: a single long word does not wrap.
    pub fn width(&self) -> f64 {
        longest(&Self::title_font(), &self.title).max(longest(&Self::subtitle_font(), &self.subtitle))
    }

    pub fn draw(&self, canvas: &mut Canvas<'_>, x: f64) {
        let mut y = MARGIN + 7.0;
        for line in &self.title {
            canvas.text(line, (x, y), &Self::title_font());
            y += 22.0;
        }
        y -= 2.0;
        for line in &self.subtitle {
            canvas.text(line, (x, y), &Self::subtitle_font());
            y += 17.0;
        }
    }
}

/// The width of the longest of some lines of text.
pub(super) fn longest<S: AsRef<str>>(font: &Font, lines: &[S]) -> f64 {
    lines.iter().map(|line| font.width(line.as_ref())).fold(0.0, f64::max)
}

/// The position of a plot with its axes.
pub(super) struct Frame {
    pub left: f64,
    pub top: f64,
    pub width: f64,
    pub height: f64,
    pub x: Axis,
    pub y: Axis,
}

impl Frame {
    /// The width of the labels left of a plot.
    pub fn left_margin(y: &Axis, y_label: &str) -> f64 {
        let font = Font::new(SMALL, INK);
        let ticks = y.ticks.iter().map(|t| font.width(&t.label));
        let power = y.power.iter().map(|p| font.width(p));
        let label = if y_label.is_empty() { 0.0 } else { 20.0 };
        MARGIN + ticks.chain(power).fold(0.0, f64::max) + 8.0 + label
    }

    pub fn right(&self) -> f64 {
        self.left + self.width
    }

    pub fn bottom(&self) -> f64 {
        self.top + self.height
    }

    /// The position of a data point on the sheet.
    pub fn at(&self, (x, y): (f64, f64)) -> (f64, f64) {
        (self.left + self.x.place(x) * self.width, self.bottom() - self.y.place(y) * self.height)
    }

    /// The grid, the axis lines, and the tick labels.
    pub fn draw_axes(&self, canvas: &mut Canvas<'_>, x_labels: bool) {
        let (grid, font) = (Pen::new(RULE, 0.75), Font::new(SMALL, INK));
        for tick in &self.x.ticks {
            let x = self.left + tick.at * self.width;
            canvas.line((x, self.top), (x, self.bottom()), &grid);
            if x_labels && !tick.label.is_empty() {
                let font = font.anchor(Anchor::Middle);
                canvas.text(&tick.label, (x, self.bottom() + 14.0), &font);
            }
        }
        for tick in &self.y.ticks {
            let y = self.bottom() - tick.at * self.height;
            canvas.line((self.left, y), (self.right(), y), &grid);
            if !tick.label.is_empty() {
                let font = font.anchor(Anchor::End);
                canvas.text(&tick.label, (self.left - 6.0, y), &font);
            }
        }
        if let Some(power) = &self.y.power {
            let font = font.anchor(Anchor::End);
            canvas.text(power, (self.left - 6.0, self.top - 12.0), &font);
        }
        if let (Some(power), true) = (&self.x.power, x_labels) {
            let at = (self.right(), self.bottom() + 32.0);
            canvas.text(power, at, &font.anchor(Anchor::End));
        }
        let edge = Pen::new(FAINT, 0.75);
        let corners = [(self.left, self.top), (self.left, self.bottom()), (self.right(), self.bottom())];
        canvas.path(&corners, &edge);
    }

    /// The axis labels: below the plot, and left of it by `margin` less the sheet's own.
    pub fn draw_labels(&self, canvas: &mut Canvas<'_>, x_label: &str, y_label: &str, margin: f64) {
        let font = Font::new(12.0, INK).anchor(Anchor::Middle);
        let middle = self.left + self.width / 2.0;
        canvas.text(x_label, (middle, self.bottom() + 32.0), &font);
        if !y_label.is_empty() {
            let x = self.left - margin + MARGIN + 4.0;
            let middle = self.top + self.height / 2.0;
            canvas.text(y_label, (x, middle), &font.upright());
        }
    }

    /// Writes that there is no data.
    pub fn draw_no_data(&self, canvas: &mut Canvas<'_>) {
        let font = Font::new(14.0, FAINT).anchor(Anchor::Middle);
        let at = (self.left + self.width / 2.0, self.top + self.height / 2.0);
        canvas.text("no data", at, &font);
    }
}

/// The sign of an entry in a legend.
#[derive(Clone, Copy)]
pub(super) enum Sign {
    Line(Pen),
    /// A mark alone.
    Mark(Mark, Color),
    /// A line with a mark.
    Marked(Mark, Pen),
    /// A point of the front: a ring on a broad line.
    Ring(Pen, Pen),
    Area(Color, f64),
}

/// Entries in rows, as many in each as fit.
pub(super) struct Legend {
    entries: Vec<(Sign, String)>,
    /// The position of each entry relative to the legend's upper left corner.
    places: Vec<(f64, f64)>,
    pub width: f64,
    pub height: f64,
}

const SIGN: f64 = 24.0;

impl Legend {
    pub fn new(entries: Vec<(Sign, String)>, width: f64) -> Self {
        let font = Font::new(SMALL, INK);
        let length = |name: &str| SIGN + 6.0 + font.width(name) + 16.0;
        let lengths: Vec<f64> = entries.iter().map(|(_, name)| length(name)).collect();
        let column = lengths.iter().copied().fold(0.0, f64::max);
        let one_row = lengths.iter().sum::<f64>() <= width;
        let (mut x, mut y, mut widest) = (0.0, 0.0, 0.0_f64);
        let mut places = Vec::new();
        for length in lengths {
            // Several rows align in columns.
            let length = if one_row { length } else { column };
            if x > 0.0 && x + length > width {
                (x, y) = (0.0, y + 18.0);
            }
            places.push((x, y));
            x += length;
            widest = widest.max(x);
        }
        let height = if entries.is_empty() { 0.0 } else { y + 18.0 };
        Self { entries, places, width: widest, height }
    }

    pub fn draw(&self, canvas: &mut Canvas<'_>, left: f64, top: f64) {
        for ((sign, name), place) in self.entries.iter().zip(&self.places) {
            let (x, y) = (left + place.0, top + place.1 + 9.0);
            let middle = (x + SIGN / 2.0, y);
            match sign {
                Sign::Line(pen) => canvas.line((x, y), (x + SIGN, y), pen),
                Sign::Mark(mark, color) => canvas.mark(*mark, middle, 4.5, *color),
                Sign::Marked(mark, pen) => {
                    canvas.line((x, y), (x + SIGN, y), pen);
                    canvas.mark(*mark, middle, 4.0, pen.color);
                }
                Sign::Ring(line, ring) => {
                    canvas.line((x, y), (x + SIGN, y), line);
                    canvas.ring(middle, 5.0, ring);
                }
                Sign::Area(color, alpha) => {
                    canvas.rect((x, y - 6.0), (SIGN, 12.0), *color, *alpha);
                }
            }
            canvas.text(name, (x + SIGN + 6.0, y), &Font::new(SMALL, INK));
        }
    }
}

/// A label beside the right end of a line.
pub(super) struct EndLabel {
    pub text: String,
    pub color: Color,
    pub mark: Option<Mark>,
    pub bold: bool,
    /// The end of the line.
    pub end: (f64, f64),
}

impl EndLabel {
    fn font(&self) -> Font {
        let font = Font::new(SMALL, dark(self.color));
        if self.bold { font.bold() } else { font }
    }

    fn indent(&self) -> f64 {
        if self.mark.is_some() { 12.0 } else { 0.0 }
    }

    /// How far the labels extend to the right of the plot.
    pub fn margin(labels: &[Self]) -> f64 {
        let reach = |l: &Self| 22.0 + l.indent() + l.font().width(&l.text);
        labels.iter().map(reach).fold(0.0, f64::max)
    }

    /// Draws labels in a column right of the plot, connected to the ends of their lines.
    pub fn draw(labels: &[Self], canvas: &mut Canvas<'_>, frame: &Frame) {
        let wanted: Vec<f64> = labels.iter().map(|l| l.end.1).collect();
        let top = frame.top - 4.0;
        let places = spread(&wanted, LEADING - 1.0, top, frame.bottom() + 4.0);
        for (label, y) in labels.iter().zip(places) {
            let x = frame.right() + 18.0;
            let leader = Pen::new(FAINT, 0.5).alpha(0.6);
            let path = [label.end, (frame.right() + 4.0, label.end.1), (x - 3.0, y)];
            let direct = label.end.0 >= frame.right() - 1.0;
            canvas.path(if direct { &path[1..] } else { &path }, &leader);
            if let Some(mark) = label.mark {
                canvas.mark(mark, (x + 4.0, y), 3.6, label.color);
            }
            canvas.text(&label.text, (x + label.indent(), y), &label.font());
        }
    }

    /// The height that the labels need.
    pub fn height(count: usize) -> f64 {
        (LEADING - 1.0) * count as f64
    }
}
