//! Commands and their answers: `$text*XX` and CR LF.
//!
//! Text is printable ASCII without `$` and `*`; XX is the exclusive or of its bytes, in hexadecimal.
//!
//! ```
//! use ratetable_protocols::vectornav::line::Line;
//!
//! let line = Line::new("VNRRG,01")?;
//! assert!(line.terms().eq(["VNRRG", "01"]));
//! let mut bytes = [0; 14];
//! assert_eq!(line.buffer_len(), bytes.len());
//! line.emit(&mut bytes);
//! assert_eq!(&bytes, b"$VNRRG,01*72\r\n");
//! # Ok::<(), ratetable_protocols::Error>(())
//! ```

use crate::bytes;
use crate::error::Error;
use crate::scanner::Verdict;

/// Bytes of the longest text.
pub const MAX_TEXT_LEN: usize = 96;

/// The first byte.
pub(super) const START: u8 = b'$';

/// Between text and checksum.
const STAR: u8 = b'*';

/// Bytes of checksum and line end.
const TAIL_LEN: usize = 5;

/// Bytes of the longest line.
pub const MAX_LEN: usize = 1 + MAX_TEXT_LEN + TAIL_LEN;

/// A command or an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Line {
    /// Zero behind the text.
    text: [u8; MAX_TEXT_LEN],
    len: usize,
}

impl Line {
    /// The line with this text, `$` and checksum left out.
    ///
    /// # Errors
    /// [`Error::Length`] if it has more than [`MAX_TEXT_LEN`] bytes, [`Error::Malformed`] if one
    /// of them cannot be in a line.
    pub fn new(text: &str) -> Result<Self, Error> {
        Self::from_bytes(text.as_bytes())
    }

    fn from_bytes(text: &[u8]) -> Result<Self, Error> {
        let mut line = Self { text: [0; MAX_TEXT_LEN], len: text.len() };
        if text.len() > MAX_TEXT_LEN {
            return Err(Error::Length { expected: MAX_TEXT_LEN, found: text.len() });
        }
        if !text.iter().all(|&byte| is_text(byte)) {
            return Err(Error::Malformed);
        }
        bytes::copy(text, &mut line.text);
        Ok(line)
    }

    /// The text, `$` and checksum left out.
    pub fn text(&self) -> &str {
        core::str::from_utf8(&self.text[..self.len]).unwrap_or_default()
    }

    /// What stands between the commas.
    pub fn terms(&self) -> impl Iterator<Item = &str> {
        self.text().split(',')
    }

    /// Bytes on the wire.
    pub const fn buffer_len(&self) -> usize {
        1 + self.len + TAIL_LEN
    }

    /// Writes as much of the line as `out` holds.
    pub fn emit(&self, out: &mut [u8]) {
        let mut whole = [0; MAX_LEN];
        whole[0] = START;
        bytes::copy(&self.text[..self.len], &mut whole[1..]);
        let [high, low] = hex(checksum(&self.text[..self.len]));
        bytes::copy(&[STAR, high, low, b'\r', b'\n'], &mut whole[1 + self.len..]);
        bytes::copy(&whole[..self.buffer_len()], out);
    }
}

/// Says what bytes whose first is [`START`] begin: a line ends with LF, CR or both.
pub(super) fn judge(held: &[u8]) -> Verdict<Line> {
    let rest = &held[1..];
    let Some(star) = rest.iter().position(|&byte| !is_text(byte)) else {
        return if rest.len() > MAX_TEXT_LEN { Verdict::Not(Error::Malformed) } else { Verdict::Wait };
    };
    match rest[star..] {
        [STAR] => Verdict::Wait,
        [STAR, high] if high.is_ascii_hexdigit() => Verdict::Wait,
        [STAR, high, low] if high.is_ascii_hexdigit() && low.is_ascii_hexdigit() => Verdict::Wait,
        [STAR, high, low, b'\r' | b'\n', ..] if high.is_ascii_hexdigit() && low.is_ascii_hexdigit() => {
            let text = &rest[..star];
            if hex(checksum(text)) != [high, low].map(|digit| digit.to_ascii_uppercase()) {
                return Verdict::Not(Error::Checksum);
            }
            match Line::from_bytes(text) {
                Ok(line) => Verdict::Packet(Ok(line), 1 + star + 4),
                Err(error) => Verdict::Not(error),
            }
        }
        _ => Verdict::Not(Error::Malformed),
    }
}

/// Whether a byte may be in a line's text.
const fn is_text(byte: u8) -> bool {
    matches!(byte, b' '..=b'~') && byte != START && byte != STAR
}

/// The exclusive or of all bytes.
fn checksum(text: &[u8]) -> u8 {
    text.iter().fold(0, |sum, byte| sum ^ byte)
}

/// Two hexadecimal digits, in capitals.
fn hex(byte: u8) -> [u8; 2] {
    const DIGITS: [u8; 16] = *b"0123456789ABCDEF";
    [DIGITS[usize::from(byte >> 4)], DIGITS[usize::from(byte & 15)]]
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: &[u8] = b"$VNWRG,06,0,1*71\r\n";

    #[test]
    fn a_line_is_written_with_its_checksum() {
        let line = Line::new("VNWRG,06,0,1").unwrap();
        let mut out = [0; MAX_LEN];
        line.emit(&mut out);
        assert_eq!(&out[..line.buffer_len()], GOLDEN);
        assert!(line.terms().eq(["VNWRG", "06", "0", "1"]));
    }

    #[test]
    fn a_line_is_read_with_any_line_end_and_small_hexadecimal_digits() {
        for end in [&b"\r\n"[..], b"\n", b"\r"] {
            let mut bytes = [0; 40];
            bytes[..13].copy_from_slice(b"$VNWRG,75,3,8");
            bytes[13..16].copy_from_slice(b"*7f");
            bytes[16..16 + end.len()].copy_from_slice(end);
            let Verdict::Packet(Ok(line), len) = judge(&bytes[..16 + end.len()]) else { panic!() };
            assert_eq!((line.text(), len), ("VNWRG,75,3,8", 17));
        }
    }

    #[test]
    fn what_cannot_be_in_a_line_is_refused() {
        for text in ["a$b", "a*b", "ü", "a\r", "\0"] {
            assert_eq!(Line::new(text), Err(Error::Malformed), "{text}");
        }
        let long = [b'a'; MAX_TEXT_LEN + 1];
        let long = core::str::from_utf8(&long).unwrap();
        assert!(Line::new(&long[1..]).is_ok());
        assert_eq!(Line::new(long), Err(Error::Length { expected: MAX_TEXT_LEN, found: MAX_TEXT_LEN + 1 }));
    }
}
