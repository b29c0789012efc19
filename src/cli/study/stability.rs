//! `ratetable study stability`: what makes methods fail, and which ones.

use super::{Outcome, Request, Study};
use crate::cli::Refusal;
use crate::cli::progress::Bar;
use crate::cli::terminal::Stream;
use crate::motion::method::METHODS;
use crate::report::chart::{self, Cell, Grid};
use crate::report::number;
use crate::study::all_cores;
use crate::study::stability::{self, CASES, Effort, Verdict};

pub(super) static STUDY: Study = Study { name: "stability", files: &["stability.csv", "stability.svg"], run };

fn run(request: &Request) -> Result<Outcome, Refusal> {
    let bar = Bar::of_jobs("stability");
    let effort = if request.quick { Effort::QUICK } else { Effort::FULL };
    let rows = stability::run(effort, all_cores(), &|done, all| bar.jobs(done, all));
    bar.clear();
    Outcome::of("stability", &rows, table(&rows))?.csv(&rows)?.picture("stability.svg", &chart(&rows))
}

/// Verdicts, a row a case, a column a method.
fn chart(rows: &[stability::Row]) -> Grid {
    let cell = |case: &str, method: &str| {
        let found = rows.iter().find(|row| row.case == case && row.method == method);
        found.map_or_else(Cell::default, |row| Cell { verdict: verdict(row.verdict), figure: figure(row) })
    };
    let row = |case: &stability::Case| chart::Row {
        name: format!("{}: {}", case.name, case.about),
        cells: METHODS.iter().map(|method| cell(case.name, method.name)).collect(),
    };
    Grid {
        title: "Where attitude methods fail".into(),
        subtitle: "a figure is what the row names last; # is the first step at which the method fails".into(),
        columns: METHODS.iter().map(|method| method.name.to_string()).collect(),
        rows: CASES.iter().map(row).collect(),
    }
}

/// How much where it is worse, when where it fails.
fn figure(row: &stability::Row) -> String {
    match (row.verdict, row.first_failing_step) {
        (Verdict::Stable, _) => String::new(),
        (Verdict::Fails, Some(step)) if step >= 10_000 => format!("#{:.1e}", step as f64),
        (Verdict::Fails, Some(step)) => format!("#{}", number(step as f64)),
        _ => format!("{:.0e}", row.figure),
    }
}

fn verdict(verdict: Verdict) -> chart::Verdict {
    match verdict {
        Verdict::Stable => chart::Verdict::Stable,
        Verdict::Degraded => chart::Verdict::Degraded,
        Verdict::Fails => chart::Verdict::Fails,
    }
}

/// A line a method, a sign a case, and what the cases are.
fn table(rows: &[stability::Row]) -> String {
    let numbers: Vec<_> = (1..=CASES.len()).map(|n| n.to_string()).collect();
    let heading: Vec<_> = ["method"].into_iter().chain(numbers.iter().map(String::as_str)).collect();
    let line = |name: &'static str| {
        let sign = |case: &stability::Case| {
            let row = rows.iter().find(|row| row.method == name && row.case == case.name);
            row.map_or("-", |row| sign(row.verdict)).to_string()
        };
        [name.to_string()].into_iter().chain(CASES.iter().map(sign)).collect()
    };
    let lines: Vec<_> = METHODS.iter().map(|method| line(method.name)).collect();
    let about: String = CASES
        .iter()
        .zip(&numbers)
        .map(|(case, n)| format!("{n:>2} {}: {}\n", case.name, case.about))
        .collect();
    format!(
        "where methods fail: . stable, ~ degraded, X fails\n{}\n{about}",
        Stream::Out.table(&heading, &lines)
    )
}

fn sign(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Stable => ".",
        Verdict::Degraded => "~",
        Verdict::Fails => "X",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::study::picture::Picture;

    #[test]
    fn a_failure_is_told_to_machines_and_to_people() {
        let failed = stability::Row {
            method: "paper",
            case: "rate-1e6",
            verdict: Verdict::Fails,
            figure: f64::INFINITY,
            first_failing_step: Some(1),
        };
        let rows = vec![failed];
        let outcome = Outcome::of("stability", &rows, table(&rows)).unwrap().csv(&rows).unwrap();
        assert_eq!(
            String::from_utf8_lossy(&outcome.files[0].1),
            "method,case,verdict,figure,first_failing_step\npaper,rate-1e6,fails,inf,1\n"
        );
        assert!(outcome.text.contains("~ degraded") && chart(&rows).svg().contains("rate-1e6"));
    }
}
