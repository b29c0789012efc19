//! Command 3, from the firmware: which version of it this is.

use crate::msp::Direction;

/// The command on the wire.
pub const COMMAND: u16 = 3;

/// Which way it goes.
pub const DIRECTION: Direction = Direction::Reply;

payload! {
    little, at_least, "the payload of an `fc_version` reply";
    /// Bytes that every version sends.
    LEN;
    #[derive(Eq)]
    fields {
        /// The first part; of versions that are named after a year, years since 2000.
        major / set_major: u8,
        /// The second part; of those, the month.
        minor / set_minor: u8,
        /// The third part.
        patch / set_patch: u8,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [26, 12, 0];

    fn repr() -> Repr {
        Repr { major: 26, minor: 12, patch: 0 }
    }

    golden_tests!(GOLDEN, repr());
}
