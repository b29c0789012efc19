//! Horizontal bars, one below the other, each with its figure.

use super::axis::{Axis, Options};
use super::canvas::{Anchor, Font, INK, Pen, color, sheet};
use super::plot::{Frame, Head, MARGIN, SMALL, longest};
use super::series::drawable;
use crate::report::number;

const WIDTH: f64 = 420.0;
const BAR: f64 = 26.0;

/// A chart of bars from zero.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Bars {
    /// The title of the chart.
    pub title: String,
    /// A second line; may be empty.
    pub subtitle: String,
    /// The quantity on the horizontal axis, with its unit: `cost (ns per sample)`.
    pub x_label: String,
    /// The unit of the figures.
    pub unit: String,
    /// The bars, from top to bottom.
    pub bars: Vec<Bar>,
    /// A vertical line across all bars with its name: their reference.
    pub line: Option<(String, f64)>,
}

/// One bar.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Bar {
    /// Its name.
    pub name: String,
    /// Its length; a negative or non-finite one is not drawn.
    pub value: f64,
    /// The part at its end that is new relative to the bar above; drawn darker.
    pub added: f64,
}

/// Draws bars. Their figures stand in a column of their own, so that the line crosses none.
#[must_use]
pub fn bars(input: &Bars) -> String {
    let (font, small) = (Font::new(12.0, INK), Font::new(SMALL, INK));
    let names: Vec<&str> = input.bars.iter().map(|bar| bar.name.as_str()).collect();
    let figures: Vec<String> = input.bars.iter().map(|bar| figure(bar, &input.unit)).collect();
    let left = MARGIN + longest(&font, &names) + 10.0;
    let head = Head::new(&input.title, &input.subtitle, left + WIDTH);
    let frame = Frame {
        left,
        top: head.height() + if input.line.is_some() { 26.0 } else { 8.0 },
        width: WIDTH,
        height: BAR * input.bars.len().max(2) as f64,
        x: axis(input),
        y: Axis::new([], &Options::default()).without_ticks(),
    };
    let right = frame.right() + 12.0 + longest(&small, &figures);
    let name_end =
        input.line.as_ref().map_or(0.0, |(name, value)| frame.at((*value, 0.0)).0 + 5.0 + small.width(name));
    let width = right.max(name_end).max(head.width()) + MARGIN;
    sheet(width, frame.bottom() + 46.0, &input.title, |canvas| {
        head.draw(canvas, MARGIN);
        frame.draw_axes(canvas, true);
        frame.draw_labels(canvas, &input.x_label, "", left);
        if input.bars.is_empty() {
            frame.draw_no_data(canvas);
        }
        for (i, (bar, figure)) in input.bars.iter().zip(&figures).enumerate() {
            let (upper, middle) = (frame.top + i as f64 * BAR + 4.0, frame.top + (i as f64 + 0.5) * BAR);
            let at = |value: f64| if value.is_finite() { frame.at((value, 0.0)).0 } else { left };
            let (end, old) = (at(bar.value), at(bar.value - bar.added.max(0.0)));
            canvas.rect((left, upper), (old - left, BAR - 8.0), color(0), 0.35);
            canvas.rect((old, upper), (end - old, BAR - 8.0), color(0), 1.0);
            canvas.text(&bar.name, (left - 8.0, middle), &font.anchor(Anchor::End));
            canvas.text(figure, (frame.right() + 12.0, middle), &small);
        }
        if let Some((name, value)) = &input.line {
            let x = frame.at((*value, 0.0)).0;
            canvas.line((x, frame.top - 6.0), (x, frame.bottom()), &Pen::new(INK, 1.2).dashed(5.0, 3.0));
            canvas.text(name, (x + 5.0, frame.top - 12.0), &small);
        }
    })
}

/// What a bar comes to, and what it adds.
fn figure(bar: &Bar, unit: &str) -> String {
    if !bar.value.is_finite() {
        return "-".to_string();
    }
    let sign = if bar.added < 0.0 { "−" } else { "+" };
    format!("{} {unit} ({sign}{})", number(bar.value), number(bar.added.abs()))
}

/// From zero to the longest bar, or to the line.
fn axis(input: &Bars) -> Axis {
    let values = input.bars.iter().map(|bar| bar.value).chain(input.line.iter().map(|line| line.1));
    let most = values.filter(|value| drawable(*value)).fold(0.0, f64::max);
    let most = if most > 0.0 { most } else { 1.0 };
    Axis::new([0.0, most], &Options { room: 8, ..Options::default() })
}
