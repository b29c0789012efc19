//! The width of printed text.

use crate::report::{table_within, wrap};
use std::io::IsTerminal;
use std::os::fd::AsFd;

/// Characters a line where nobody looks on: a file, a pipe, a log.
const UNSEEN: usize = 120;
/// Characters a line of a terminal that does not say.
const UNSAID: usize = 80;

/// Where a text is printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stream {
    /// Standard output: results.
    Out,
    /// Standard error: what accompanies them.
    Err,
}

impl Stream {
    /// Characters a line of the terminal that it is; `None` where it is none.
    fn terminal(self) -> Option<usize> {
        match self {
            Stream::Out => columns(&std::io::stdout()),
            Stream::Err => columns(&std::io::stderr()),
        }
    }

    /// Characters a line: 120 where it is no terminal.
    pub fn width(self) -> usize {
        self.terminal().unwrap_or(UNSEEN)
    }

    /// A table that fits.
    pub fn table(self, heading: &[&str], rows: &[Vec<String>]) -> String {
        table_within(heading, rows, self.width())
    }

    /// Text with its long lines broken at spaces on a terminal, what follows indented by two more than the line. In a
    /// file or a pipe a line stays one, so that it can be searched for.
    pub fn fold(self, text: &str) -> String {
        let Some(width) = self.terminal() else { return text.to_string() };
        text.lines().map(|line| folded(line, width)).collect()
    }
}

fn columns(stream: &(impl IsTerminal + AsFd)) -> Option<usize> {
    stream.is_terminal().then(|| {
        let size = rustix::termios::tcgetwinsize(stream);
        size.ok().map(|size| usize::from(size.ws_col)).filter(|columns| *columns > 0).unwrap_or(UNSAID)
    })
}

fn folded(line: &str, width: usize) -> String {
    if line.chars().count() <= width {
        return format!("{line}\n");
    }
    let text = line.trim_start();
    let indent = line.len() - text.len();
    // What is lined up by spaces within the line is no prose.
    if text.contains("  ") {
        return format!("{line}\n");
    }
    let lines = wrap(text, width.saturating_sub(indent + 2).max(1));
    let indented = |(i, text): (usize, &String)| {
        let indent = if i == 0 { indent } else { indent + 2 };
        format!("{}{text}\n", " ".repeat(indent))
    };
    lines.iter().enumerate().map(indented).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_line_is_broken_at_spaces_and_hangs_by_two() {
        let text = folded("  rate: how often, such as \"1 kHz\" or more", 24);
        assert_eq!(text, "  rate: how often,\n    such as \"1 kHz\" or\n    more\n");
        assert_eq!(folded("short", 24), "short\n");
        let lined_up = "gyro    1000 Hz     -  0.2236 deg/s";
        assert_eq!(folded(lined_up, 24), format!("{lined_up}\n"), "a table is no prose");
    }
}
