//! A study's pictures, each in two forms: drawn for a page of text, and as points for a page that is asked.

use crate::live;
use crate::report::chart::{self, Bars, Curves, Grid, LogLog, Points, Verdict};

/// Something that a study draws.
pub(super) trait Picture {
    /// As SVG.
    fn svg(&self) -> String;

    /// As charts to ask.
    fn charts(&self) -> Vec<live::Chart> {
        Vec::new()
    }

    /// As verdicts to ask.
    fn grids(&self) -> Vec<live::Grid> {
        Vec::new()
    }
}

fn axis(label: &str, is_linear: bool) -> live::Axis {
    live::Axis { label: label.into(), log: !is_linear }
}

fn some(text: &str) -> Option<String> {
    (!text.is_empty()).then(|| text.into())
}

impl Picture for LogLog {
    fn svg(&self) -> String {
        chart::loglog(self)
    }

    fn charts(&self) -> Vec<live::Chart> {
        // What is not above the floor lies on it.
        let floor = self.y_floor.unwrap_or(f64::MIN_POSITIVE);
        let series = |method: &chart::Method| live::Series {
            name: method.name.clone(),
            line: true,
            points: method.points.iter().map(|&(x, y)| (x, y.max(floor), None)).collect(),
        };
        let chart = |motion: &chart::Motion| live::Chart {
            title: motion.title.clone(),
            subtitle: some(&self.subtitle),
            x: axis(&self.x_label, false),
            y: axis(&self.y_label, false),
            series: motion.methods.iter().map(series).collect(),
        };
        self.motions.iter().map(chart).collect()
    }
}

impl Picture for Points {
    fn svg(&self) -> String {
        chart::points(self)
    }

    fn charts(&self) -> Vec<live::Chart> {
        let floor = self.y_floor.unwrap_or(f64::NEG_INFINITY);
        let group = |(of, name): (usize, &String)| live::Series {
            name: name.clone(),
            line: false,
            points: self
                .points
                .iter()
                .filter(|point| point.group == of)
                .map(|point| (point.x, point.y.max(floor), some(&point.name)))
                .collect(),
        };
        vec![live::Chart {
            title: self.title.clone(),
            subtitle: some(&self.subtitle),
            x: axis(&self.x_label, self.x_linear),
            y: axis(&self.y_label, self.y_linear),
            series: self.groups.iter().enumerate().map(group).collect(),
        }]
    }
}

/// One below the other.
impl Picture for Vec<Points> {
    fn svg(&self) -> String {
        chart::stacked(&self.iter().map(Picture::svg).collect::<Vec<_>>())
    }

    fn charts(&self) -> Vec<live::Chart> {
        self.iter().flat_map(Picture::charts).collect()
    }
}

/// One below the other.
impl Picture for Vec<Curves> {
    fn svg(&self) -> String {
        chart::stacked(&self.iter().map(chart::curves).collect::<Vec<_>>())
    }

    fn charts(&self) -> Vec<live::Chart> {
        let series = |curve: &chart::Curve| live::Series {
            name: curve.name.clone(),
            line: true,
            points: curve.points.iter().map(|&(x, y)| (x, y, None)).collect(),
        };
        let chart = |curves: &Curves| live::Chart {
            title: curves.title.clone(),
            subtitle: some(&curves.subtitle),
            x: axis(&curves.x_label, curves.linear),
            y: axis(&curves.y_label, curves.linear),
            series: curves.curves.iter().map(series).collect(),
        };
        self.iter().map(chart).collect()
    }
}

impl Picture for Bars {
    fn svg(&self) -> String {
        chart::bars(self)
    }

    /// The sum after each step.
    fn charts(&self) -> Vec<live::Chart> {
        let step = |(i, bar): (usize, &chart::Bar)| {
            (
                i as f64 + 1.0,
                bar.value,
                Some(format!("{} (+{} {})", bar.name, crate::report::number(bar.added), self.unit)),
            )
        };
        let sums = live::Series {
            name: "with each term".into(),
            line: true,
            points: self.bars.iter().enumerate().map(step).collect(),
        };
        let line = self.line.iter().map(|(name, value)| live::Series {
            name: name.clone(),
            line: true,
            points: vec![(1.0, *value, None), (self.bars.len() as f64, *value, None)],
        });
        vec![live::Chart {
            title: self.title.clone(),
            subtitle: some(&self.subtitle),
            x: axis("terms", true),
            y: axis(&self.x_label, true),
            series: [sums].into_iter().chain(line).collect(),
        }]
    }
}

impl Picture for Grid {
    fn svg(&self) -> String {
        chart::grid(self)
    }

    fn grids(&self) -> Vec<live::Grid> {
        let cell = |cell: &chart::Cell| live::Cell {
            verdict: match cell.verdict {
                Verdict::Stable => "stable",
                Verdict::Degraded => "degraded",
                Verdict::Fails => "fails",
                Verdict::NotRun => "not run",
            }
            .into(),
            text: cell.figure.clone(),
        };
        let row = |row: &chart::Row| live::GridRow {
            name: row.name.clone(),
            cells: row.cells.iter().map(cell).collect(),
        };
        vec![live::Grid {
            title: self.title.clone(),
            columns: self.columns.clone(),
            rows: self.rows.iter().map(row).collect(),
        }]
    }
}
