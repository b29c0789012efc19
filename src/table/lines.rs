//! The lines of a file with their numbers, one at a time, whatever ends them and whatever bytes are in them.

use std::io::{self, BufRead};

/// A line that is not empty.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Numbered {
    /// Its number, from 1.
    pub number: u64,
    /// What stands in it, without white space around it.
    pub text: String,
    /// Whether it is the last of the file and no end of line follows: it may have been broken off.
    pub is_open: bool,
}

impl Numbered {
    /// Whether it is a comment.
    pub fn is_comment(&self) -> bool {
        self.text.starts_with(['#', '%'])
    }
}

/// Reads lines.
#[derive(Debug)]
pub(super) struct Lines<R> {
    reader: R,
    number: u64,
    bytes: Vec<u8>,
}

impl<R: BufRead> Lines<R> {
    pub fn new(reader: R) -> Lines<R> {
        Lines { reader, number: 0, bytes: Vec::new() }
    }

    /// The next line that is not empty, into `line`; `false` at the end. Bytes that are no UTF-8 are read as Latin 1,
    /// which no bytes contradict.
    pub fn next(&mut self, line: &mut Numbered) -> io::Result<bool> {
        loop {
            self.bytes.clear();
            if self.reader.read_until(b'\n', &mut self.bytes)? == 0 {
                return Ok(false);
            }
            let first = self.number == 0;
            self.number += 1;
            let bytes = match first {
                true => self.bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&self.bytes),
                false => &self.bytes,
            };
            line.is_open = !bytes.ends_with(b"\n");
            line.text.clear();
            match std::str::from_utf8(bytes) {
                Ok(text) => line.text.push_str(text.trim()),
                Err(_) => {
                    let text: String = bytes.iter().map(|byte| char::from(*byte)).collect();
                    line.text.push_str(text.trim());
                }
            }
            if !line.text.is_empty() {
                line.number = self.number;
                return Ok(true);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_keep_their_numbers_whatever_ends_them() {
        let mut lines = Lines::new(&b"\xef\xbb\xbfa\r\n\r\n  b \n\nroll [\xb0]"[..]);
        let mut line = Numbered::default();
        let mut found = Vec::new();
        while lines.next(&mut line).unwrap() {
            found.push((line.number, line.text.clone()));
        }
        assert_eq!(found, [(1, "a".to_string()), (3, "b".into()), (5, "roll [°]".into())]);
    }
}
