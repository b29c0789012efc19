//! `TIMESYNC` (111): compares two clocks.

message! {
    TIMESYNC: id 111, crc_extra 34;
    #[derive(Eq)]
    fields {
        /// The answerer's clock, ns; 0 in a question.
        tc1 / set_tc1: i64,
        /// The asker's clock when it asked, ns: an answer repeats it.
        ts1 / set_ts1: i64,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] =
        [0xcb, 0x04, 0xfb, 0x71, 0x1f, 0x01, 0x00, 0x00, 0x16, 0xe9, 0x4f, 0xb3, 0xfd, 0xff, 0xff, 0xff];

    fn repr() -> Repr {
        Repr { tc1: 1234567890123, ts1: -9876543210 }
    }

    golden_tests!(GOLDEN, repr());
}
