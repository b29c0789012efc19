//! What came of it: the last message that the page gets, from figures, tables and charts as data.

use serde::Serialize;

/// What came of a run, a measurement or a study.
#[derive(Clone, Debug, Default, Serialize)]
#[serde(tag = "kind", rename = "end")]
pub struct End {
    /// Whether nothing failed.
    pub ok: bool,
    /// What failed.
    pub failed: Vec<String>,
    /// The figures that matter most.
    pub figures: Vec<Figure>,
    /// Tables, as they are printed.
    pub tables: Vec<Table>,
    /// Charts.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub charts: Vec<Chart>,
    /// Verdicts by row and column.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub grids: Vec<Grid>,
}

/// A figure, as a report prints it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figure {
    /// What it is.
    pub label: String,
    /// The number.
    pub value: String,
    /// Its unit.
    pub unit: String,
}

/// A table of texts.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Table {
    /// What it is about.
    pub title: String,
    /// The names of its columns, with their units.
    pub heading: Vec<String>,
    /// As many cells as columns.
    pub rows: Vec<Vec<String>>,
}

/// A chart of points.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Chart {
    /// What it shows.
    pub title: String,
    /// More about that.
    pub subtitle: Option<String>,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// What is compared.
    pub series: Vec<Series>,
}

/// An axis of a chart.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Axis {
    /// What it is, with its unit.
    pub label: String,
    /// Whether it is logarithmic.
    pub log: bool,
}

/// Points that belong together.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Series {
    /// What they belong to, such as a method.
    pub name: String,
    /// Whether a line joins them.
    pub line: bool,
    /// x, y, and what the point is.
    pub points: Vec<(f64, f64, Option<String>)>,
}

/// Verdicts by row and column.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Grid {
    /// What it shows.
    pub title: String,
    /// The names of the columns.
    pub columns: Vec<String>,
    /// The rows.
    pub rows: Vec<GridRow>,
}

/// A row of verdicts.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GridRow {
    /// Whose they are.
    pub name: String,
    /// One for each column.
    pub cells: Vec<Cell>,
}

/// A verdict.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cell {
    /// Such as `stable`, `degraded`, `fails`.
    pub verdict: String,
    /// The figure behind it.
    pub text: String,
}
