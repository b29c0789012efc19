//! Where a table's header is and where its rows begin.
//!
//! The line of names is the one before the rows whose names are known; it may stand in a comment, as NumPy and EuRoC
//! write it, under a title or a preamble of other lines, and above a line of units. Where no names are known it is the
//! line of words, or the comment, that has as many cells as the rows.

use super::cells::{self, delimiter};
use super::lines::Numbered;
use super::names::{self, Heading};
use super::units::{self, Unit};

/// What was found.
#[derive(Debug)]
pub(super) struct Head {
    /// The names, where there are any.
    pub names: Option<Vec<Heading>>,
    /// The line that they stand on.
    pub line: u64,
    /// Whether that is a comment.
    pub is_comment: bool,
    /// What parts the cells of the rows.
    pub delimiter: u8,
    /// How many of the lines come before the first row.
    pub rows_from: usize,
}

/// Whether these lines hold enough of the table to find its head: two rows one after the other that begin with a
/// number.
pub(super) fn is_enough(lines: &[Numbered]) -> bool {
    let mut last = lines.iter().rev().filter(|line| !line.is_comment()).take(2);
    last.next().is_some_and(begins_a_row) && last.next().is_some_and(begins_a_row)
}

fn begins_a_row(line: &Numbered) -> bool {
    let cells = cells::names(&line.text, delimiter(&line.text));
    cells.first().is_some_and(|cell| cells::is_number(cell))
}

/// Finds the head in the first lines of a file, none of them empty.
pub(super) fn find(lines: &[Numbered]) -> Head {
    let plain = |i: &usize| !lines[*i].is_comment();
    let rows_from = first_row(lines);
    let row = lines.get(rows_from).map(|line| line.text.as_str());
    let width = row.map(width);
    let of_line = |i: usize| {
        let text = lines[i].text.trim_start_matches(['#', '%']).trim();
        cells::names(text, delimiter(text))
    };
    let is_wordy = |names: &[String]| !names.is_empty() && !names.iter().any(|name| cells::is_number(name));
    // A comment is a header only if it names each column.
    let may_name = |i: usize, names: &[String]| {
        is_wordy(names) && (plain(&i) || (names.len() > 1 && width.is_none_or(|width| width == names.len())))
    };
    let candidates = || (0..rows_from).map(|i| (i, of_line(i))).filter(|(i, names)| may_name(*i, names));
    let known = candidates().map(|(i, names)| (known(&names), i)).filter(|(known, _)| *known > 0).max();
    let same = |names: &[String]| width == Some(names.len()) && names.len() > 1;
    let of_shape = || {
        let last = candidates().rfind(|(i, names)| plain(i) && same(names));
        // A file without a row may have a header still.
        let first = || candidates().find(|(i, _)| plain(i));
        last.or_else(first).or_else(|| candidates().rfind(|(_, names)| same(names))).map(|(i, _)| i)
    };
    let Some(at) = known.map(|(_, i)| i).or_else(of_shape) else {
        return Head {
            names: None,
            line: 0,
            is_comment: false,
            delimiter: row.map_or(b' ', delimiter),
            rows_from,
        };
    };
    let text = of_line(at);
    let mut names: Vec<Heading> = text.iter().map(|name| Heading::new(name)).collect();
    let mut from = at + 1;
    if let Some(units) =
        (from < lines.len()).then(|| of_line(from)).and_then(|cells| units_of(&cells, names.len()))
    {
        names.iter_mut().zip(units).for_each(|(name, unit)| name.unit = name.unit.take().or(unit));
        from += 1;
    }
    let rows_from = (from..lines.len()).find(plain).unwrap_or(lines.len());
    let header = delimiter(lines[at].text.trim_start_matches(['#', '%']).trim());
    // A decimal comma is no delimiter where the header is parted by something else.
    let delimiter = match lines.get(rows_from).map(|line| &line.text) {
        Some(row) if header != b' ' && row.as_bytes().contains(&header) => header,
        Some(row) => delimiter(row),
        None => header,
    };
    Head {
        names: Some(names),
        line: lines[at].number,
        is_comment: lines[at].is_comment(),
        delimiter,
        rows_from,
    }
}

/// The first of two rows one after the other that begin with a number; else the first line with any number in it.
fn first_row(lines: &[Numbered]) -> usize {
    let plain: Vec<usize> = (0..lines.len()).filter(|i| !lines[*i].is_comment()).collect();
    let begins = |k: usize| plain.get(k).is_none_or(|i| begins_a_row(&lines[*i]));
    let sure = (0..plain.len()).find(|&k| begins(k) && begins(k + 1)).map(|k| plain[k]);
    let any = || {
        let has_number = |i: &usize| {
            cells::names(&lines[*i].text, delimiter(&lines[*i].text))
                .iter()
                .any(|cell| cells::is_number(cell))
        };
        plain.iter().copied().find(has_number)
    };
    sure.or_else(any).unwrap_or(lines.len())
}

/// How many cells a row has, without an empty one behind the last delimiter.
pub(super) fn width(row: &str) -> usize {
    let cells = cells::names(row, delimiter(row));
    cells.len() - usize::from(cells.len() > 1 && cells.last().is_some_and(String::is_empty))
}

/// How much of a line of names is known: an attitude or a rate counts more than a time.
fn known(text: &[String]) -> u32 {
    let names: Vec<Heading> = text.iter().map(|name| Heading::new(name)).collect();
    let turns = names::quaternion(&names).is_some()
        || names::euler(&names).is_some()
        || names::angular_rate(&names).is_some();
    let has_time = names.len() > 1 && names::time(&names).is_some();
    2 * u32::from(turns) + u32::from(has_time)
}

/// The units of a line that has nothing else, one for each column.
fn units_of(cells: &[String], count: usize) -> Option<Vec<Option<Unit>>> {
    let unit = |cell: &String| {
        let bare = cell.trim_matches(['[', ']', '(', ')', ' ']);
        units::known(bare).map(|unit| (!cell.is_empty()).then_some(unit))
    };
    let units: Vec<_> = cells.iter().map(unit).collect::<Option<_>>()?;
    let says = units.iter().any(|unit| !matches!(unit, None | Some(Unit::One)));
    (units.len() == count && says).then_some(units)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn head(text: &str) -> (Option<Vec<String>>, u64, u8, usize) {
        let lines = text.lines().zip(1..).filter(|(line, _)| !line.trim().is_empty());
        let lines: Vec<_> = lines
            .map(|(text, number)| Numbered { number, text: text.trim().into(), is_open: false })
            .collect();
        let head = find(&lines);
        let names = head.names.map(|names| names.into_iter().map(|name| name.text).collect());
        (names, head.line, head.delimiter, lines.get(head.rows_from).map_or(0, |line| line.number as usize))
    }

    #[test]
    fn a_header_is_found_wherever_it_stands() {
        for (text, names, line, delimiter, rows) in [
            ("t_s,qw,qx,qy,qz\n0,1,0,0,0\n1,1,0,0,0", "t_s qw qx qy qz", 1, b',', 2),
            ("# made by hand\n# t_s,qw,qx,qy,qz\n\n0,1,0,0,0", "t_s qw qx qy qz", 2, b',', 4),
            ("Flight 5, 12 March\nt_s,qw,qx,qy,qz\n0,1,0,0,0", "t_s qw qx qy qz", 2, b',', 3),
            ("Log 5\nt_s;qw;qx;qy;qz\n0,5;1,0;0;0;0\n1,5;1;0;0;0", "t_s qw qx qy qz", 2, b';', 3),
            ("t;qw;qx;qy;qz\n[s];[];[];[];[]\n0;1;0;0;0", "t qw qx qy qz", 1, b';', 3),
            ("t qw qx qy qz\ns - - - -\n0 1 0 0 0", "t qw qx qy qz", 1, b' ', 3),
            (
                "\"Product\",\"x\"\n\"Version\",2\n\"time\",\"qw\",\"qx\",\"qy\",\"qz\"\n0,1,0,0,0\n1,1,0,0,0",
                "time qw qx qy qz",
                3,
                b',',
                4,
            ),
            ("a;b\n0;1\n1;2", "a b", 1, b';', 2),
            ("#t   wx wy  wz\n0   1   2   3", "t wx wy wz", 1, b' ', 2),
            ("t_s,qw,qx,qy,qz", "t_s qw qx qy qz", 1, b',', 0),
            ("t_ns,qw,qx,qy,qz\nzero,1,0,0,0\n4,1,0,0,0", "t_ns qw qx qy qz", 1, b',', 2),
        ] {
            let found = head(text);
            let expected = Some(names.split(' ').map(String::from).collect());
            assert_eq!(found, (expected, line, delimiter, rows), "{text}");
        }
    }

    #[test]
    fn what_names_no_columns_is_no_header() {
        for text in [
            "0 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1",
            "# recorded at time 5\n0 1 0 0 0",
            "1,2\n3,4",
            "# t x\n0 1 2",
        ] {
            assert_eq!(head(text).0, None, "{text}");
        }
    }
}
