//! Tables for people, fitted to the width of the output.

/// Space between two columns.
const GAP: usize = 2;

/// Rows under a heading with aligned columns: numbers to the right, other text to the left.
pub fn table(heading: &[&str], rows: &[Vec<String>]) -> String {
    table_within(heading, rows, usize::MAX)
}

/// The same with at most `width` characters a line, as far as possible without breaking a number.
///
/// What does not fit first wraps at spaces: headings, and the words of text columns. If it still does not fit, it
/// becomes several tables one below the other, each with the columns that identify the row. A number, a number with
/// its unit, and a word stay whole: a word longer than the line extends beyond it.
pub fn table_within(heading: &[&str], rows: &[Vec<String>], width: usize) -> String {
    let columns: Vec<_> = (0..heading.len()).map(|i| Column::new(heading[i], rows, i)).collect();
    let names = naming(&columns);
    let mut text = String::new();
    for group in groups(&columns, names, width) {
        if !text.is_empty() {
            text.push('\n');
        }
        text += &laid_out(&group, width);
    }
    text
}

/// One column of a table.
struct Column<'a> {
    heading: &'a str,
    cells: Vec<&'a str>,
    is_number: bool,
    /// Width of its longest cell or heading, in characters.
    natural: usize,
    /// Width of its longest unbreakable piece, in characters.
    least: usize,
}

impl<'a> Column<'a> {
    fn new(heading: &'a str, rows: &'a [Vec<String>], i: usize) -> Column<'a> {
        let cells: Vec<&str> = rows.iter().map(|row| row.get(i).map_or("", String::as_str)).collect();
        let is_number = cells.iter().all(|cell| is_number(cell));
        let longest = |pieces: Vec<&str>| pieces.into_iter().map(chars).max().unwrap_or(0);
        let whole = |cell: &&'a str| if is_number { chars(cell) } else { longest(pieces(cell)) };
        Column {
            heading,
            natural: cells.iter().map(|cell| chars(cell)).chain([chars(heading)]).max().unwrap_or(0),
            least: cells.iter().map(whole).chain([longest(pieces(heading))]).max().unwrap_or(0),
            cells,
            is_number,
        }
    }

    /// For each width from the least to the natural one: the number of lines of the heading and of each cell.
    fn heights(&self) -> Vec<Vec<usize>> {
        let of =
            |width| [self.heading].iter().chain(&self.cells).map(|cell| wrap(cell, width).len()).collect();
        (self.least..=self.natural).map(of).collect()
    }
}

fn chars(text: &str) -> usize {
    text.chars().count()
}

fn is_number(cell: &str) -> bool {
    cell == "-" || cell.trim_start_matches('-').starts_with(|c: char| c.is_ascii_digit())
}

/// A cell split at the spaces where it may wrap: not between a number and its unit.
fn pieces(cell: &str) -> Vec<&str> {
    let mut pieces = Vec::new();
    let (mut begin, mut before) = (0, 0);
    for (at, _) in cell.match_indices(' ') {
        if !is_number(&cell[before..at]) {
            pieces.push(&cell[begin..at]);
            begin = at + 1;
        }
        before = at + 1;
    }
    pieces.push(&cell[begin..]);
    pieces
}

/// How many of the first columns identify the row: those that are blank in some row, and the first that is not.
fn naming(columns: &[Column<'_>]) -> usize {
    let blank = columns.iter().take_while(|column| column.cells.iter().any(|cell| cell.is_empty())).count();
    (blank + 1).min(columns.len())
}

/// The columns side by side in each table: all of them if that fits.
fn groups<'c, 'a>(columns: &'c [Column<'a>], names: usize, width: usize) -> Vec<Vec<&'c Column<'a>>> {
    let least = |group: &[&Column<'_>]| {
        group.iter().map(|column| column.least + GAP).sum::<usize>().saturating_sub(GAP)
    };
    let (naming, others) = columns.split_at(names);
    let mut groups: Vec<Vec<&Column<'_>>> = vec![naming.iter().collect()];
    for column in others {
        let group =
            groups.last_mut().unwrap_or_else(|| unreachable!("the first is there from the beginning"));
        if group.len() == names || least(group) + GAP + column.least <= width {
            group.push(column);
        } else {
            groups.push(naming.iter().chain([column]).collect());
        }
    }
    groups
}

/// The columns side by side, as text.
fn laid_out(columns: &[&Column<'_>], width: usize) -> String {
    let widths = widths(columns, width);
    let line = |cells: Vec<&str>, is_heading: bool| {
        let wrapped: Vec<_> = cells.iter().zip(&widths).map(|(cell, width)| wrap(cell, *width)).collect();
        let height = wrapped.iter().map(Vec::len).max().unwrap_or(0);
        let mut text = String::new();
        for at in 0..height {
            let cell = |((lines, width), column): ((&Vec<String>, &usize), &&Column<'_>)| {
                // A heading of several lines aligns at the bottom.
                let above = if is_heading { height - lines.len() } else { 0 };
                let cell = at.checked_sub(above).and_then(|at| lines.get(at)).map_or("", String::as_str);
                if column.is_number { format!("{cell:>width$}") } else { format!("{cell:<width$}") }
            };
            let cells: Vec<_> = wrapped.iter().zip(&widths).zip(columns).map(cell).collect();
            text += cells.join("  ").trim_end();
            text.push('\n');
        }
        text
    };
    let mut text = line(columns.iter().map(|column| column.heading).collect(), true);
    let rows = columns.iter().map(|column| column.cells.len()).max().unwrap_or(0);
    (0..rows).for_each(|i| text += &line(columns.iter().map(|column| column.cells[i]).collect(), false));
    text
}

/// The width of each column: its natural one if everything fits, else at least its least one, and the rest where it
/// saves most lines.
fn widths(columns: &[&Column<'_>], width: usize) -> Vec<usize> {
    let room = width.saturating_sub(GAP * columns.len().saturating_sub(1));
    let natural: Vec<_> = columns.iter().map(|column| column.natural).collect();
    if natural.iter().sum::<usize>() <= room {
        return natural;
    }
    let heights: Vec<Vec<Vec<usize>>> = columns.iter().map(|column| column.heights()).collect();
    // Count lines of the table first, then lines of its cells, so that two columns can grow one after the other.
    let cost = |widths: &[usize]| {
        let rows = columns.first().map_or(0, |column| column.cells.len() + 1);
        let of = |row: usize| {
            let cells = (0..columns.len()).map(|i| heights[i][widths[i] - columns[i].least][row]);
            cells.clone().max().unwrap_or(0) * 1000 + cells.sum::<usize>()
        };
        (0..rows).map(of).sum::<usize>()
    };
    let mut widths: Vec<_> = columns.iter().map(|column| column.least).collect();
    loop {
        let spare = room.saturating_sub(widths.iter().sum());
        let now = cost(&widths);
        let mut best: Option<(usize, Vec<usize>)> = None;
        for i in 0..columns.len() {
            for more in 1..=spare.min(natural[i] - widths[i]) {
                let mut wider = widths.clone();
                wider[i] += more;
                let gain = now.saturating_sub(cost(&wider)) / more;
                if gain > best.as_ref().map_or(0, |(best, _)| *best) {
                    best = Some((gain, wider));
                }
            }
        }
        match best {
            Some((_, wider)) => widths = wider,
            None => return widths,
        }
    }
}

/// Wraps at spaces into lines of at most `width` characters, as far as its pieces allow.
pub fn wrap(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for piece in pieces(text) {
        let line = lines.last_mut().unwrap_or_else(|| unreachable!("the first is there from the beginning"));
        if line.is_empty() {
            line.push_str(piece);
        } else if chars(line) + 1 + chars(piece) <= width {
            line.push(' ');
            line.push_str(piece);
        } else {
            lines.push(piece.to_string());
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(rows: &[&[&str]]) -> Vec<Vec<String>> {
        rows.iter().map(|row| row.iter().map(|cell| cell.to_string()).collect()).collect()
    }

    fn widest(text: &str) -> usize {
        text.lines().map(chars).max().unwrap()
    }

    #[test]
    fn columns_line_up() {
        let text = table(&["sensor", "Hz"], &rows(&[&["gyro", "1000"], &["mag", "100"]]));
        assert_eq!(text, "sensor    Hz\ngyro    1000\nmag      100\n");
        let blank = table(&["sensor", "effect"], &rows(&[&["gyro", "bias"], &["", "noise"]]));
        assert_eq!(blank, "sensor  effect\ngyro    bias\n        noise\n");
    }

    const HEADING: [&str; 6] =
        ["sensor", "asked Hz", "received Hz", "missed by receiver", "late µs p50", "note"];

    fn wide() -> Vec<Vec<String>> {
        rows(&[
            &["gyro", "1000", "999.992", "0", "0.095", "left out but would be seen, at 0.05 deg/s or more"],
            &["magnetometer", "100", "100.000", "12", "11.05", "modelled"],
        ])
    }

    #[test]
    fn a_table_keeps_to_the_width_that_it_is_given_and_says_the_same() {
        let natural = table(&HEADING, &wide());
        assert!(widest(&natural) > 100);
        assert_eq!(table_within(&HEADING, &wide(), widest(&natural)), natural, "it fits as it is");
        for width in [40, 60, 80, 100] {
            let text = table_within(&HEADING, &wide(), width);
            assert!(widest(&text) <= width, "{width}:\n{text}");
            for word in HEADING.iter().flat_map(|heading| heading.split(' ')) {
                assert!(text.contains(word), "{width}: {word} is gone:\n{text}");
            }
            for cell in wide().iter().flatten().flat_map(|cell| pieces(cell)) {
                assert!(text.contains(cell), "{width}: {cell} is gone:\n{text}");
            }
        }
    }

    #[test]
    fn a_number_is_never_parted_from_its_unit() {
        assert_eq!(pieces("at 0.05 deg/s or 1e-9 rad"), ["at", "0.05 deg/s", "or", "1e-9 rad"]);
        assert_eq!(pieces("left out and below"), ["left", "out", "and", "below"]);
        assert_eq!(wrap("at 0.05 deg/s or", 10), ["at", "0.05 deg/s", "or"]);
        let long = table_within(&["name", "x"], &rows(&[&["a", "123456789012345678901234567890"]]), 20);
        assert!(long.contains("123456789012345678901234567890"), "{long}");
    }

    #[test]
    fn tables_one_under_another_each_say_whose_row_it_is() {
        let text = table_within(&HEADING, &wide(), 40);
        assert!(text.matches("magnetometer").count() > 1 && text.contains("\n\n"), "{text}");
        let blank = rows(&[
            &["gyro", "bias", "20 deg/s", "modelled"],
            &["", "white noise", "0.05 deg/s", "left out"],
        ]);
        let text = table_within(&["sensor", "effect", "size", "verdict"], &blank, 28);
        assert!(text.matches("white").count() > 1, "a blank name is no name:\n{text}");
    }
}
