//! Baud rates: their capacity, and their spelling after an address.

use std::path::PathBuf;

use super::problem::{self, Problem};

/// The speed of a serial port without a given one: 921 600 baud.
pub const DEFAULT_BAUD: u32 = 921_600;

/// The speeds that Linux serial drivers have names for, from 9600 up (`asm-generic/termbits.h`); ports accept
/// others too.
pub const STANDARD_BAUDS: &[u32] = &[
    9600, 19_200, 38_400, 57_600, 115_200, 230_400, 460_800, 500_000, 576_000, 921_600, 1_000_000, 1_152_000,
    1_500_000, 2_000_000, 2_500_000, 3_000_000, 3_500_000, 4_000_000,
];

/// Bits on the wire for a byte with 8 data bits, no parity, one stop bit, and the start bit.
pub(super) const BITS_PER_BYTE: u32 = 10;

/// Bytes a second that 8N1 carries at this speed.
pub fn bytes_per_second(baud: u32) -> f64 {
    f64::from(baud) / f64::from(BITS_PER_BYTE)
}

/// The range of sensible speeds, in baud.
const SPEEDS: std::ops::RangeInclusive<u32> = 50..=20_000_000;

/// Reads the speed after `before` and a comma.
pub(super) fn speed(before: &str, digits: &str) -> Result<u32, Problem> {
    digits.parse().ok().filter(|baud| SPEEDS.contains(baud)).ok_or_else(|| {
        Problem::new(
            format!("`{digits}` is not a baud rate ({} to {})", SPEEDS.start(), SPEEDS.end()),
            format!("say {before},{DEFAULT_BAUD}"),
        )
    })
}

/// Reads `PATH[,BAUD]` after `scheme`.
pub(super) fn path_and_speed(
    scheme: &str,
    rest: &str,
    example: &str,
) -> Result<(PathBuf, Option<u32>), Problem> {
    if let Some((path, digits)) = rest.rsplit_once(',') {
        let there = problem::path(path, example)?;
        return Ok((there, Some(speed(&format!("{scheme}{path}"), digits)?)));
    }
    if let Some((path, digits)) = rest.rsplit_once(':')
        && digits.parse::<u32>().is_ok_and(|number| number >= *SPEEDS.start())
    {
        return Err(Problem::new(
            "write the baud rate after a comma",
            format!("say {scheme}{path},{digits}"),
        ));
    }
    Ok((problem::path(rest, example)?, None))
}
