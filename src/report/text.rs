//! Numbers and counts for people.

/// A number with four significant digits (integers below 10⁹ with all of theirs) and no trailing zeros.
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

/// A count with its noun, plural unless it is one: `1 run`, `2 runs`.
pub fn count(n: u64, what: &str) -> String {
    match n {
        1 => format!("1 {what}"),
        n => format!("{n} {what}s"),
    }
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
    fn one_of_something_is_no_plural() {
        assert_eq!([0, 1, 2].map(|n| count(n, "run")), ["0 runs", "1 run", "2 runs"]);
    }
}
