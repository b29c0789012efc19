//! `SYSTEM_TIME` (2): the sender's date and its time since boot.

message! {
    SYSTEM_TIME: id 2, crc_extra 137;
    #[derive(Eq)]
    fields {
        /// Time since 1970-01-01 UTC, µs; 0 where no date is known.
        time_unix_usec / set_time_unix_usec: u64,
        /// Time since boot, ms.
        time_boot_ms / set_time_boot_ms: u32,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [0x40, 0x22, 0x20, 0x18, 0x24, 0x0a, 0x06, 0x00, 0xcd, 0x81, 0x01, 0x00];

    fn repr() -> Repr {
        Repr { time_unix_usec: 1700000000123456, time_boot_ms: 98765 }
    }

    golden_tests!(GOLDEN, repr());
}
