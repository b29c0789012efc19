//! Consistent Overhead Byte Stuffing: bytes without a zero, so that a zero can end a packet.
//!
//! Each run of up to 254 non-zero bytes is preceded by its length plus one; the zeros between
//! runs are left out. A receiver that was cut off finds its place again at the next zero.
//!
//! ```
//! use ratetable_protocols::cobs;
//!
//! let mut stuffed = [0; cobs::max_encoded_len(3)];
//! let len = cobs::encode(&[1, 0, 2], &mut stuffed)?;
//! assert_eq!(stuffed[..len], [2, 1, 2, 2]);
//!
//! let mut back = [0; 3];
//! assert_eq!(cobs::decode(&stuffed[..len], &mut back)?, 3);
//! assert_eq!(back, [1, 0, 2]);
//! # Ok::<(), ratetable_protocols::Error>(())
//! ```

use crate::error::Error;

/// The longest that `len` bytes become, the closing zero not counted.
pub const fn max_encoded_len(len: usize) -> usize {
    len + len.div_ceil(254) + (len == 0) as usize
}

/// Writes `data` without zeros into `out` and returns the length; the closing zero is not written.
///
/// # Errors
/// [`Error::BufferTooSmall`] if `out` does not have [`max_encoded_len`] bytes.
pub fn encode(data: &[u8], out: &mut [u8]) -> Result<usize, Error> {
    let needed = max_encoded_len(data.len());
    if out.len() < needed {
        return Err(Error::BufferTooSmall { needed });
    }
    if data.len() <= SHORT {
        out[1..=data.len()].copy_from_slice(data);
        stuff(&mut out[..=data.len()]);
        return Ok(data.len() + 1);
    }
    let (mut code_at, mut len, mut code) = (0, 1, 1);
    for (i, &byte) in data.iter().enumerate() {
        if byte != 0 {
            out[len] = byte;
            len += 1;
            code += 1;
        }
        if byte == 0 || (code == 0xff && i + 1 < data.len()) {
            out[code_at] = code;
            (code_at, code) = (len, 1);
            len += 1;
        }
    }
    out[code_at] = code;
    Ok(len)
}

/// Bytes whose runs are never full.
const SHORT: usize = 253;

/// Encodes in place what lies behind the first byte, at most [`SHORT`] bytes: each zero becomes the length of the run
/// behind it.
pub(crate) fn stuff(out: &mut [u8]) {
    debug_assert!((1..=SHORT + 1).contains(&out.len()));
    let (mut code_at, mut at) = (0, 1);
    while at < out.len() {
        let end = out.len().min(at + 8);
        let mut zeros = zero_bytes(&out[at..end]);
        while zeros != 0 {
            let zero_at = at + (zeros.trailing_zeros() / 8) as usize;
            out[code_at] = (zero_at - code_at) as u8;
            code_at = zero_at;
            zeros &= zeros - 1;
        }
        at = end;
    }
    out[code_at] = (out.len() - code_at) as u8;
}

/// One bit, the highest, in each byte of a word that stands for a zero among up to eight bytes, the first lowest.
fn zero_bytes(bytes: &[u8]) -> u64 {
    const LOW: u64 = 0x7f7f_7f7f_7f7f_7f7f;
    let word = match bytes.try_into() {
        Ok(bytes) => u64::from_le_bytes(bytes),
        Err(_) => bytes.iter().rev().fold(u64::MAX, |word, &byte| word << 8 | u64::from(byte)),
    };
    !(((word & LOW) + LOW) | word | LOW)
}

/// Reads what [`encode`] wrote (without a closing zero) into `out` and returns the length.
///
/// # Errors
/// [`Error::Malformed`] if a length points past the end or there is a zero within,
/// [`Error::BufferTooSmall`] if `out` is shorter than what was encoded.
pub fn decode(data: &[u8], out: &mut [u8]) -> Result<usize, Error> {
    let mut len = 0;
    let mut rest = data;
    while let Some((&code, tail)) = rest.split_first() {
        let count = usize::from(code).checked_sub(1).ok_or(Error::Malformed)?;
        let (run, after) = tail.split_at_checked(count).ok_or(Error::Malformed)?;
        if run.contains(&0) {
            return Err(Error::Malformed);
        }
        let zero = code != 0xff && !after.is_empty();
        let end = len + count + usize::from(zero);
        let place = out.get_mut(len..end).ok_or(Error::BufferTooSmall { needed: end })?;
        place[..count].copy_from_slice(run);
        place[count..].fill(0);
        (len, rest) = (end, after);
    }
    Ok(len)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The examples of the encoding's published description.
    const CASES: [(&[u8], &[u8]); 6] = [
        (&[], &[1]),
        (&[0], &[1, 1]),
        (&[0, 0], &[1, 1, 1]),
        (&[0x11, 0x22, 0, 0x33], &[3, 0x11, 0x22, 2, 0x33]),
        (&[0x11, 0, 0, 0], &[2, 0x11, 1, 1, 1]),
        (&[0x11, 0x22, 0x33, 0x44], &[5, 0x11, 0x22, 0x33, 0x44]),
    ];

    #[test]
    fn published_examples_go_both_ways() {
        for (plain, stuffed) in CASES {
            let mut out = [0xee; 16];
            assert_eq!(encode(plain, &mut out), Ok(stuffed.len()));
            assert_eq!(&out[..stuffed.len()], stuffed);
            let mut back = [0xee; 16];
            assert_eq!(decode(stuffed, &mut back), Ok(plain.len()));
            assert_eq!(&back[..plain.len()], plain);
        }
    }

    #[test]
    fn runs_around_254_bytes_come_back() {
        for len in 252..=258 {
            let plain: [u8; 258] = core::array::from_fn(|i| (i % 255) as u8 + 1);
            let (mut out, mut back) = ([0; 300], [0; 300]);
            let stuffed = encode(&plain[..len], &mut out).unwrap();
            assert!(stuffed <= max_encoded_len(len));
            assert!(!out[..stuffed].contains(&0));
            assert_eq!(decode(&out[..stuffed], &mut back), Ok(len));
            assert_eq!(back[..len], plain[..len]);
        }
    }

    #[test]
    fn zeros_at_every_place_of_every_length_come_back() {
        let (mut plain, mut out, mut back) = ([0; 300], [0; 310], [0; 310]);
        for len in (0..40).chain(250..260) {
            for pattern in 0..64_usize {
                // Every byte a zero, none, every other, …
                plain[..len].iter_mut().enumerate().for_each(|(i, byte)| {
                    *byte = if pattern >> (i % 6) & 1 == 1 { 0 } else { (i % 255) as u8 + 1 };
                });
                let stuffed = encode(&plain[..len], &mut out).unwrap();
                assert!(stuffed <= max_encoded_len(len));
                assert!(!out[..stuffed].contains(&0));
                assert_eq!(decode(&out[..stuffed], &mut back), Ok(len), "{len} {pattern}");
                assert_eq!(back[..len], plain[..len]);
            }
        }
    }

    #[test]
    fn a_length_past_the_end_and_a_zero_within_are_refused() {
        let mut out = [0; 8];
        assert_eq!(decode(&[5, 1, 2], &mut out), Err(Error::Malformed));
        assert_eq!(decode(&[3, 1, 0], &mut out), Err(Error::Malformed));
        assert_eq!(decode(&[0], &mut out), Err(Error::Malformed));
        let full = Err(Error::BufferTooSmall { needed: 2 });
        assert_eq!(decode(&[3, 1, 2], &mut out[..1]), full);
        let full = Err(Error::BufferTooSmall { needed: 3 });
        assert_eq!(encode(&[1, 2], &mut out[..2]), full);
    }
}
