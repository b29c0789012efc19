//! Command 2, from the firmware: who it is.

use crate::msp::Direction;

/// The command on the wire.
pub const COMMAND: u16 = 2;

/// Which way it goes.
pub const DIRECTION: Direction = Direction::Reply;

/// [`Repr::name`] of INAV.
pub const INAV: [u8; 4] = *b"INAV";

/// [`Repr::name`] of Betaflight.
pub const BETAFLIGHT: [u8; 4] = *b"BTFL";

payload! {
    little, exactly, "the payload of an `fc_variant` reply";
    /// Bytes of payload.
    LEN;
    #[derive(Eq)]
    fields {
        /// Four letters: `INAV`, `BTFL`, ….
        name / set_name: [u8; 4],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [0x49, 0x4e, 0x41, 0x56];

    fn repr() -> Repr {
        Repr { name: [73, 78, 65, 86] }
    }

    golden_tests!(GOLDEN, repr());
}
