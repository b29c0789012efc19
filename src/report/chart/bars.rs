//! Horizontal bars, one below the other, each with its figure.

use super::canvas::{Anchor, FAINT, Font, INK, Pen, RULE, WHITE, color, sheet};
use super::plot::{Head, MARGIN, SMALL, longest};
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

/// Draws bars.
#[must_use]
pub fn bars(input: &Bars) -> String {
    let font = Font::new(12.0, INK);
    let small = Font::new(SMALL, INK);
    let names: Vec<&str> = input.bars.iter().map(|bar| bar.name.as_str()).collect();
    let left = MARGIN + longest(&font, &names) + 10.0;
    let figure = |bar: &Bar| match bar.value.is_finite() {
        true => {
            let sign = if bar.added < 0.0 { "−" } else { "+" };
            format!("{} {} ({sign}{})", number(bar.value), input.unit, number(bar.added.abs()))
        }
        false => "-".to_string(),
    };
    let figures: Vec<String> = input.bars.iter().map(figure).collect();
    let head = Head::new(&input.title, &input.subtitle, left + WIDTH);
    let top = head.height() + if input.line.is_some() { 26.0 } else { 8.0 };
    let bottom = top + BAR * input.bars.len().max(2) as f64;
    let right = left + WIDTH + longest(&small, &figures) + 14.0;
    let values = input.bars.iter().map(|bar| bar.value).chain(input.line.iter().map(|line| line.1));
    let most = values.filter(|value| value.is_finite() && *value > 0.0).fold(0.0, f64::max);
    let at = |value: f64| {
        left + if value.is_finite() && most > 0.0 { (value / most).clamp(0.0, 1.0) * WIDTH } else { 0.0 }
    };
    let width = right.max(head.width()) + MARGIN;
    sheet(width, bottom + MARGIN, &input.title, |canvas| {
        head.draw(canvas, MARGIN);
        canvas.line((left, top - 2.0), (left, bottom + 2.0), &Pen::new(RULE, 1.5));
        if input.bars.is_empty() {
            let font = Font::new(14.0, FAINT).anchor(Anchor::Middle);
            canvas.text("no data", (left + WIDTH / 2.0, top + BAR), &font);
        }
        for (i, bar) in input.bars.iter().enumerate() {
            let (upper, middle) = (top + i as f64 * BAR + 4.0, top + (i as f64 + 0.5) * BAR);
            let (end, old) = (at(bar.value), at(bar.value - bar.added.max(0.0)));
            canvas.rect((left, upper), (old - left, BAR - 8.0), color(0), 0.35);
            canvas.rect((old, upper), (end - old, BAR - 8.0), color(0), 1.0);
            canvas.text(&bar.name, (left - 8.0, middle), &font.anchor(Anchor::End));
        }
        if let Some((name, value)) = &input.line {
            canvas.line(
                (at(*value), top - 6.0),
                (at(*value), bottom + 2.0),
                &Pen::new(INK, 1.2).dashed(5.0, 3.0),
            );
            canvas.text(name, (at(*value) + 5.0, top - 12.0), &small);
        }
        for (i, (bar, figure)) in input.bars.iter().zip(&figures).enumerate() {
            let (from, middle) = (at(bar.value) + 8.0, top + (i as f64 + 0.5) * BAR);
            // The figure gets a background where the line would cross it.
            canvas.rect((from - 3.0, middle - 8.0), (small.width(figure) + 6.0, 16.0), WHITE, 1.0);
            canvas.text(figure, (from, middle), &small);
        }
    })
}
