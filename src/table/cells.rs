//! One line of a table in its cells.

use std::ops::Range;

/// What parts two cells: the semicolon, then the likelier of comma and tab; a space means any white space.
pub(super) fn delimiter(line: &str) -> u8 {
    let count = |delimiter: u8| line.bytes().filter(|byte| *byte == delimiter).count();
    let (commas, tabs) = (count(b','), count(b'\t'));
    match () {
        () if count(b';') > 0 => b';',
        // A tab may pad a cell behind a comma.
        () if commas > 0 && commas >= tabs => b',',
        () if tabs > 0 => b'\t',
        () => b' ',
    }
}

/// Where the cells of a line are, without the white space and the quotes around them.
pub(super) fn split(line: &str, delimiter: u8, cells: &mut Vec<Range<usize>>) {
    cells.clear();
    let bytes = line.as_bytes();
    if delimiter == b' ' {
        let mut from = None;
        for (i, byte) in bytes.iter().enumerate() {
            match (byte.is_ascii_whitespace(), from) {
                (false, None) => from = Some(i),
                (true, Some(start)) => {
                    cells.push(bare(line, start..i));
                    from = None;
                }
                _ => {}
            }
        }
        cells.extend(from.map(|start| bare(line, start..bytes.len())));
        return;
    }
    let (mut start, mut quoted) = (0, false);
    for (i, byte) in bytes.iter().enumerate() {
        // A quote opens only where a cell begins.
        match byte {
            b'"' if quoted || line[start..i].trim().is_empty() => quoted = !quoted,
            byte if *byte == delimiter && !quoted => {
                cells.push(bare(line, start..i));
                start = i + 1;
            }
            _ => {}
        }
    }
    cells.push(bare(line, start..bytes.len()));
}

/// How many cells a line has.
pub(super) fn count(line: &str, delimiter: u8) -> usize {
    let mut cells = Vec::new();
    split(line, delimiter, &mut cells);
    cells.len()
}

fn bare(line: &str, mut range: Range<usize>) -> Range<usize> {
    let bytes = line.as_bytes();
    let is_edge = |byte: u8| byte.is_ascii_whitespace() || byte == b'"';
    while range.start < range.end && is_edge(bytes[range.start]) {
        range.start += 1;
    }
    while range.start < range.end && is_edge(bytes[range.end - 1]) {
        range.end -= 1;
    }
    range
}

/// The cells of a line of names: white space does not part a unit in brackets from the name before it.
pub(super) fn names(line: &str, delimiter: u8) -> Vec<String> {
    let mut cells = Vec::new();
    split(line, delimiter, &mut cells);
    let mut names: Vec<String> = Vec::new();
    let mut open = None;
    for cell in cells.into_iter().map(|cell| &line[cell]) {
        let begins = cell.starts_with(['[', '(']).then(|| if cell.starts_with('[') { ']' } else { ')' });
        match (names.last_mut(), open.or(begins)) {
            (Some(name), Some(close)) if delimiter == b' ' => {
                name.push(' ');
                name.push_str(cell);
                open = (!cell.contains(close)).then_some(close);
            }
            _ => names.push(cell.to_string()),
        }
    }
    names
}

/// What stands in a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Cell {
    /// A finite number.
    Number(f64),
    /// Nothing, or what programs write for nothing.
    Missing,
    /// A word.
    Word,
}

/// Reads a cell; with `comma` a comma is the decimal point.
pub(super) fn cell(text: &str, comma: bool) -> Cell {
    let text = text.trim();
    let number = match comma && text.contains(',') && !text.contains('.') {
        true => text.replacen(',', ".", 1).parse::<f64>(),
        false => text.parse::<f64>(),
    };
    match number {
        Ok(number) if number.is_finite() => Cell::Number(number),
        Ok(_) => Cell::Missing,
        Err(_) => {
            let missing = ["", "-", "null", "none", "na", "n/a", "-nan(ind)", "1.#qnan", "-1.#ind"];
            let is_missing = missing.iter().any(|word| text.eq_ignore_ascii_case(word));
            if is_missing { Cell::Missing } else { Cell::Word }
        }
    }
}

/// Whether a cell is a number, or one that is not finite.
pub(super) fn is_number(text: &str) -> bool {
    text.parse::<f64>().is_ok() || cell(text, true) != Cell::Word && !text.is_empty() && text != "-"
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells(line: &str) -> Vec<String> {
        names(line, delimiter(line))
    }

    #[test]
    fn a_line_is_parted_by_whatever_parts_it() {
        for (line, expected) in [
            ("a,b, c", &["a", "b", "c"][..]),
            ("a;b,c;d", &["a", "b,c", "d"]),
            ("a\tb\t", &["a", "b", ""]),
            ("1,\t2,\t3", &["1", "2", "3"]),
            ("  a  b c ", &["a", "b", "c"]),
            ("\"time, s\",\"qw\"", &["time, s", "qw"]),
            ("t [s] q_w [] wx [rad s^-1] q[0]", &["t [s]", "q_w []", "wx [rad s^-1]", "q[0]"]),
            ("time (s) qw", &["time (s)", "qw"]),
            ("", &[]),
        ] {
            assert_eq!(cells(line), expected, "{line}");
        }
    }

    #[test]
    fn what_is_missing_is_told_from_a_word() {
        for text in ["", "nan", "NaN", "inf", "-Infinity", "null", "N/A", "-nan(ind)"] {
            assert_eq!(cell(text, false), Cell::Missing, "{text}");
        }
        for text in ["zero", "1.2.3", "0x10", "12:30", "1,5"] {
            assert_eq!(cell(text, false), Cell::Word, "{text}");
        }
        assert_eq!((cell("1,5", true), cell("-2.5e1", true)), (Cell::Number(1.5), Cell::Number(-25.0)));
        assert_eq!(cell("1,000.5", true), Cell::Word, "a comma that parts thousands is no decimal one");
    }
}
