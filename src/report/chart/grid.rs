//! A table of verdicts.

use super::canvas::{Anchor, Canvas, Color, FAINT, Font, GREEN, INK, ORANGE, Pen, WHITE, sheet};
use super::plot::{Head, LEADING, MARGIN, SMALL, longest};
use plotters::style::RGBColor;

const CELL: f64 = 26.0;
/// Column headings wrap at about this width.
const HEADING: f64 = 130.0;
/// The names of rows wrap at about this width.
const NAME: f64 = 200.0;

/// Rows by columns, with a verdict in each cell.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Grid {
    /// The title of the table.
    pub title: String,
    /// A second line; may be empty.
    pub subtitle: String,
    /// The headings of the columns.
    pub columns: Vec<String>,
    /// The rows, from top to bottom.
    pub rows: Vec<Row>,
}

/// One row of the table.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Row {
    /// The name of the row.
    pub name: String,
    /// One cell for each column; a missing one counts as not run.
    pub cells: Vec<Cell>,
}

/// One cell of the table.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Cell {
    /// The verdict, shown as a colour and a sign.
    pub verdict: Verdict,
    /// The text in the cell, with its unit; may be empty.
    pub figure: String,
}

/// The verdict of a cell.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Verdict {
    /// Works as it should: a disc on green.
    Stable,
    /// Works less well: a triangle on yellow.
    Degraded,
    /// Does not work: a cross on red.
    Fails,
    /// Was not run: a dash on white.
    #[default]
    NotRun,
}

impl Verdict {
    const ALL: [Self; 4] = [Self::Stable, Self::Degraded, Self::Fails, Self::NotRun];

    fn word(self) -> &'static str {
        match self {
            Self::Stable => "stable",
            Self::Degraded => "degraded",
            Self::Fails => "fails",
            Self::NotRun => "not run",
        }
    }

    fn fill(self) -> (Color, f64) {
        match self {
            Self::Stable => (GREEN, 0.25),
            Self::Degraded => (ORANGE, 0.45),
            Self::Fails => (RGBColor(0xb8, 0x3a, 0x00), 1.0),
            Self::NotRun => (FAINT, 0.08),
        }
    }

    fn ink(self) -> Color {
        match self {
            Self::Fails => WHITE,
            Self::NotRun => FAINT,
            _ => INK,
        }
    }
}

/// Draws a table of verdicts.
#[must_use]
pub fn grid(input: &Grid) -> String {
    let plan = Plan::new(input);
    let head = Head::new(&input.title, &input.subtitle, plan.width().max(500.0));
    let legend = legend_of(input);
    let top = head.height() + if legend.is_empty() { 0.0 } else { 34.0 };
    let body = top + plan.heading_height;
    let height = body + plan.rows.iter().sum::<f64>().max(2.0 * CELL) + MARGIN;
    let width = plan.width().max(head.width()).max(420.0) + 2.0 * MARGIN;
    sheet(width, height, &input.title, |canvas| {
        head.draw(canvas, MARGIN);
        draw_legend(canvas, &legend, head.height() + 14.0);
        plan.draw_headings(canvas, body);
        let mut row_top = body;
        for (i, row) in input.rows.iter().enumerate() {
            plan.draw_row(canvas, row, i, row_top);
            row_top += plan.rows[i];
        }
        if plan.columns.is_empty() || input.rows.is_empty() {
            let font = Font::new(14.0, FAINT).anchor(Anchor::Middle);
            canvas.text("no data", (width / 2.0, body + CELL), &font);
        }
    })
}

/// The layout of a table.
struct Plan {
    columns: Vec<Vec<String>>,
    heading_height: f64,
    /// The lines of each row's name, and the width of the longest.
    lines: Vec<Vec<String>>,
    names: f64,
    /// The height of each row.
    rows: Vec<f64>,
    cells: Vec<f64>,
}

fn name_font() -> Font {
    Font::new(12.0, INK)
}

fn figure_font(color: Color) -> Font {
    Font::new(SMALL, color)
}

impl Plan {
    fn new(input: &Grid) -> Self {
        let font = name_font();
        let wrap = |text: &String| font.wrap(text, HEADING);
        let columns: Vec<Vec<String>> = input.columns.iter().map(wrap).collect();
        let heading_height = columns.iter().map(|c| longest(&font, c)).fold(0.0, f64::max) + 10.0;
        let lines: Vec<Vec<String>> = input.rows.iter().map(|row| font.wrap(&row.name, NAME)).collect();
        let rows = input.rows.iter().zip(&lines).map(|(row, lines)| {
            let figures = row.cells.iter().take(columns.len()).any(|cell| !cell.figure.trim().is_empty());
            let cell = if figures { CELL + LEADING } else { CELL };
            cell.max(LEADING * lines.len() as f64 + 8.0)
        });
        let cell = |(i, lines): (usize, &Vec<String>)| {
            let figures = input.rows.iter().filter_map(|r| r.cells.get(i));
            let figures = figures.map(|c| figure_font(INK).width(&c.figure));
            let widest = 9.0 + figures.fold(0.0, f64::max);
            widest.max(lines.len() as f64 * LEADING + 6.0).max(36.0)
        };
        let cells: Vec<f64> = columns.iter().enumerate().map(cell).collect();
        let names = lines.iter().map(|lines| longest(&font, lines)).fold(0.0, f64::max) + 10.0;
        Self { rows: rows.collect(), columns, heading_height, lines, names, cells }
    }

    fn width(&self) -> f64 {
        self.names + self.cells.iter().sum::<f64>()
    }

    fn x(&self, column: usize) -> f64 {
        MARGIN + self.names + self.cells[..column].iter().sum::<f64>()
    }

    fn draw_headings(&self, canvas: &mut Canvas<'_>, bottom: f64) {
        let font = name_font().upright();
        for (i, lines) in self.columns.iter().enumerate() {
            let block = (lines.len() as f64 - 1.0) * LEADING;
            let first = self.x(i) + self.cells[i] / 2.0 - block / 2.0;
            for (k, line) in lines.iter().enumerate() {
                canvas.text(line, (first + k as f64 * LEADING, bottom - 6.0), &font);
            }
        }
    }

    fn draw_row(&self, canvas: &mut Canvas<'_>, row: &Row, index: usize, top: f64) {
        let font = name_font().anchor(Anchor::End);
        let (lines, height) = (&self.lines[index], self.rows[index]);
        let middle = top + height / 2.0;
        let first = middle - LEADING * (lines.len() as f64 - 1.0) / 2.0;
        for (k, line) in lines.iter().enumerate() {
            canvas.text(line, (self.x(0) - 8.0, first + LEADING * k as f64), &font);
        }
        let none = Cell::default();
        for (i, &width) in self.cells.iter().enumerate() {
            let cell = row.cells.get(i).unwrap_or(&none);
            let x = self.x(i);
            let (fill, alpha) = cell.verdict.fill();
            canvas.rect((x + 0.75, top + 0.75), (width - 1.5, height - 1.5), fill, alpha);
            let center = x + width / 2.0;
            if cell.figure.trim().is_empty() {
                draw_sign(canvas, cell.verdict, (center, middle));
            } else {
                draw_sign(canvas, cell.verdict, (center, middle - 7.5));
                let font = figure_font(cell.verdict.ink()).anchor(Anchor::Middle);
                canvas.text(&cell.figure, (center, middle + 8.5), &font);
            }
        }
    }
}

fn draw_sign(canvas: &mut Canvas<'_>, verdict: Verdict, (x, y): (f64, f64)) {
    let pen = Pen::new(verdict.ink(), 2.0);
    match verdict {
        Verdict::Stable => canvas.ring((x, y), 4.5, &Pen::new(verdict.ink(), 1.5)),
        Verdict::Degraded => {
            let corners = [(x, y - 5.5), (x + 5.5, y + 4.5), (x - 5.5, y + 4.5)];
            canvas.polygon(&corners, verdict.ink(), 1.0);
        }
        Verdict::Fails => {
            canvas.line((x - 4.5, y - 4.5), (x + 4.5, y + 4.5), &pen);
            canvas.line((x - 4.5, y + 4.5), (x + 4.5, y - 4.5), &pen);
        }
        Verdict::NotRun => canvas.line((x - 4.0, y), (x + 4.0, y), &pen),
    }
}

/// The verdicts, each with its number of cells; "not run" only where it occurs.
fn legend_of(input: &Grid) -> Vec<(Verdict, usize)> {
    let columns = input.columns.len();
    let count = |verdict: Verdict| {
        let row = |row: &Row| {
            let given = row.cells.iter().take(columns);
            let missing = columns.saturating_sub(row.cells.len());
            let same = given.filter(|c| c.verdict == verdict).count();
            same + if verdict == Verdict::NotRun { missing } else { 0 }
        };
        (verdict, input.rows.iter().map(row).sum())
    };
    let shown = |v: &(Verdict, usize)| v.0 != Verdict::NotRun || v.1 > 0;
    Verdict::ALL.into_iter().map(count).filter(shown).collect()
}

fn draw_legend(canvas: &mut Canvas<'_>, legend: &[(Verdict, usize)], top: f64) {
    let font = Font::new(SMALL, INK);
    let mut x = MARGIN;
    for &(verdict, count) in legend {
        let (fill, alpha) = verdict.fill();
        canvas.rect((x, top - 9.0), (24.0, 18.0), fill, alpha);
        draw_sign(canvas, verdict, (x + 12.0, top));
        let text = format!("{} ({count})", verdict.word());
        canvas.text(&text, (x + 30.0, top), &font);
        x += 30.0 + font.width(&text) + 18.0;
    }
}
