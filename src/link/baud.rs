//! Baud rates: their capacity, and how one is written after an address.

use std::path::PathBuf;

use super::problem::{self, Problem};

/// The speed of a serial port that is given none: 921 600 baud.
pub const DEFAULT_BAUD: u32 = 921_600;

/// The speeds that serial drivers of Linux know by name, from 9600 on (`asm-generic/termbits.h`); ports take
/// others too.
pub const STANDARD_BAUDS: &[u32] = &[
    9600, 19_200, 38_400, 57_600, 115_200, 230_400, 460_800, 500_000, 576_000, 921_600, 1_000_000, 1_152_000,
    1_500_000, 2_000_000, 2_500_000, 3_000_000, 3_500_000, 4_000_000,
];

/// Bits that a byte takes on the wire with 8 data bits, no parity, one stop bit: a start bit comes before.
pub(super) const BITS_PER_BYTE: u32 = 10;

/// Bytes a second that 8N1 carries at this speed.
pub fn bytes_per_second(baud: u32) -> f64 {
    f64::from(baud) / f64::from(BITS_PER_BYTE)
}

/// The speeds that make sense, in baud.
const SPEEDS: std::ops::RangeInclusive<u32> = 50..=20_000_000;

/// Reads the speed that stands after `before` and a comma.
pub(super) fn speed(before: &str, digits: &str) -> Result<u32, Problem> {
    digits.parse().ok().filter(|baud| SPEEDS.contains(baud)).ok_or_else(|| {
        Problem::new(
            format!("`{digits}` is not a baud rate ({} to {})", SPEEDS.start(), SPEEDS.end()),
            format!("say {before},{DEFAULT_BAUD}"),
        )
    })
}

/// Reads `PATH[,BAUD]`, which stands after `scheme`.
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
