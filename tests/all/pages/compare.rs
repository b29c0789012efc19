//! What a page quotes against what was said.

use super::block::Numbers;

/// Anything may stand for this: a line of it alone for any lines, at the end of a line for the rest of it.
const ANYTHING: &str = "…";

/// The first line that a page quotes and that was not said, or what was said beyond it.
///
/// # Errors
/// That line, and what stood in its place.
pub fn compare(quoted: &str, said: &str, numbers: Numbers) -> Result<(), String> {
    let (quoted, said) = (trimmed(quoted), trimmed(said));
    let said: Vec<&str> = said.lines().collect();
    let mut at = 0;
    let mut skips = false;
    for line in quoted.lines() {
        if line.trim() == ANYTHING {
            skips = true;
            continue;
        }
        let rest = said.get(at..).unwrap_or_default();
        let found = match skips {
            true => rest.iter().position(|said| same(line, said, numbers)),
            false => rest.first().and_then(|said| same(line, said, numbers).then_some(0)),
        };
        let Some(found) = found else {
            let instead = rest.first().map_or("nothing more", |line| line);
            return Err(format!("quoted: {line}\n    said:   {instead}"));
        };
        (at, skips) = (at + found + 1, false);
    }
    match said.get(at..) {
        Some([first, ..]) if !skips => Err(format!("said beyond what is quoted: {first}")),
        _ => Ok(()),
    }
}

/// Without blank lines before and after, and without spaces at the ends of lines.
fn trimmed(text: &str) -> String {
    let lines: Vec<_> = text.lines().map(str::trim_end).collect();
    lines.join("\n").trim_matches('\n').to_string()
}

/// Whether a line says what is quoted.
fn same(quoted: &str, said: &str, numbers: Numbers) -> bool {
    let (quoted, said) = (quoted.trim_end(), said.trim_end());
    if quoted == said {
        return true;
    }
    if let Some(begins) = quoted.strip_suffix(ANYTHING) {
        return said
            .char_indices()
            .map(|(i, _)| i)
            .chain([said.len()])
            .any(|end| same(begins, &said[..end], numbers));
    }
    if numbers == Numbers::Exact {
        return false;
    }
    let (quoted, said) = (pieces(quoted), pieces(said));
    let alike = |(quoted, said): (&Piece<'_>, &Piece<'_>)| match (quoted, said, numbers) {
        (Piece::Text(quoted), Piece::Text(said), _) => quoted == said,
        (Piece::Number(_), Piece::Number(_), Numbers::Vary) => true,
        (Piece::Number(quoted), Piece::Number(said), Numbers::Within(share)) => {
            (quoted - said).abs() <= share * quoted.abs().max(said.abs())
        }
        _ => false,
    };
    quoted.len() == said.len() && quoted.iter().zip(&said).all(alike)
}

#[derive(Debug, PartialEq)]
enum Piece<'a> {
    Text(&'a str),
    Number(f64),
}

/// Words and numbers; how many spaces stand between them depends on the numbers' lengths, and is left out.
fn pieces(line: &str) -> Vec<Piece<'_>> {
    let mut pieces = Vec::new();
    for word in line.split_whitespace() {
        let mut rest = word;
        while !rest.is_empty() {
            let digit = rest.find(|c: char| c.is_ascii_digit()).unwrap_or(rest.len());
            // A sign belongs to its number unless something stands right before it.
            let sign = digit > 0
                && rest[..digit].ends_with('-')
                && (digit == 1 || rest[..digit - 1].ends_with(['(', '[', '=']));
            let begin = if sign { digit - 1 } else { digit };
            if begin > 0 {
                pieces.push(Piece::Text(&rest[..begin]));
            }
            let number = &rest[begin..];
            let Some((value, length)) = number_at(number) else { break };
            pieces.push(Piece::Number(value));
            rest = &number[length..];
        }
    }
    pieces
}

/// The longest number at the beginning.
fn number_at(text: &str) -> Option<(f64, usize)> {
    let is_part = |c: char| c.is_ascii_digit() || "+-.e".contains(c);
    let longest = text.find(|c: char| !is_part(c)).unwrap_or(text.len());
    (1..=longest).rev().find_map(|length| {
        let ends = text[..length].ends_with(|c: char| c.is_ascii_digit());
        Some((text[..length].parse().ok().filter(|_| ends)?, length))
    })
}

#[test]
fn a_number_is_told_from_what_stands_beside_it() {
    assert_eq!(
        pieces("gyro  -2.5e-3 deg/s"),
        [Piece::Text("gyro"), Piece::Number(-2.5e-3), Piece::Text("deg/s")]
    );
    assert_eq!(pieces("p99.9: (-1)").len(), 6);
    assert!(same("/dev/pts/0 at 10 %", "/dev/pts/12 at 9.5 %", Numbers::Vary));
    assert!(same("at 10 %", "at   9.5 %", Numbers::Within(0.06)));
}

#[test]
fn a_wrong_word_a_wrong_number_and_a_line_more_or_less_are_seen() {
    let said = "gyro 1000 Hz\nmag 100 Hz\n";
    for (quoted, numbers, right) in [
        (said, Numbers::Exact, true),
        ("gyro 1000 Hz\n…\n", Numbers::Exact, true),
        ("…\nmag 100 …\n", Numbers::Exact, true),
        ("gyro 1001 Hz\nmag 100 Hz\n", Numbers::Exact, false),
        ("gyro 1001 Hz\nmag 100 Hz\n", Numbers::Within(0.01), true),
        ("gyro 1100 Hz\nmag 100 Hz\n", Numbers::Within(0.01), false),
        ("gyro 3 Hz\nmag 5 Hz\n", Numbers::Vary, true),
        ("accel 3 Hz\nmag 5 Hz\n", Numbers::Vary, false),
        ("gyro fast Hz\nmag 5 Hz\n", Numbers::Vary, false),
        ("gyro 1000 Hz\n", Numbers::Exact, false),
        ("gyro 1000 Hz\nmag 100 Hz\nbaro\n", Numbers::Exact, false),
        ("", Numbers::Exact, false),
    ] {
        assert_eq!(compare(quoted, said, numbers).is_ok(), right, "{quoted} {numbers:?}");
    }
}
