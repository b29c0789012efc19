//! Plain tables for people.

/// A number with four significant digits (whole numbers below 10⁹ with all of theirs) and no useless zeros.
pub fn number(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{}", value + 0.0);
    }
    let digits = libm::floor(libm::log10(value.abs())) as i32;
    if !(-4..9).contains(&digits) {
        return format!("{value:.3e}");
    }
    let text = format!("{value:.*}", (3 - digits).max(0) as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_string() } else { text }
}

/// Rows under a heading, columns aligned: those of numbers to the right, the others to the left.
pub fn table(heading: &[&str], rows: &[Vec<String>]) -> String {
    let width = |i: usize| {
        let cells = rows.iter().filter_map(|row| row.get(i)).map(|cell| cell.chars().count());
        cells.chain(heading.get(i).map(|cell| cell.chars().count())).max().unwrap_or(0)
    };
    let widths: Vec<_> = (0..heading.len()).map(width).collect();
    let is_number =
        |cell: &String| cell == "-" || cell.trim_start_matches('-').starts_with(|c: char| c.is_ascii_digit());
    let numbers = |i: usize| rows.iter().filter_map(|row| row.get(i)).all(is_number);
    let right: Vec<_> = (0..heading.len()).map(numbers).collect();
    let line = |cells: Vec<&str>| {
        let padded = cells.iter().zip(&widths).zip(&right).map(|((cell, &width), right)| match right {
            false => format!("{cell:<width$}"),
            true => format!("{cell:>width$}"),
        });
        padded.collect::<Vec<_>>().join("  ").trim_end().to_string() + "\n"
    };
    let mut text = line(heading.to_vec());
    rows.iter().for_each(|row| text += &line(row.iter().map(String::as_str).collect()));
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (value, text) in [
            (0.0, "0"),
            (-0.0, "0"),
            (312.0, "312"),
            (0.1234567, "0.1235"),
            (1000.02, "1000"),
            (12.5, "12.5"),
            (1e-9, "1.000e-9"),
            (63000.0, "63000"),
            (-2.5, "-2.5"),
        ] {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn columns_line_up() {
        let text =
            table(&["sensor", "Hz"], &[vec!["gyro".into(), "1000".into()], vec!["mag".into(), "100".into()]]);
        assert_eq!(text, "sensor    Hz\ngyro    1000\nmag      100\n");
    }
}
