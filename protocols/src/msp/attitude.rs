//! Command 108, from the firmware: its attitude, the heading in whole degrees.

use crate::msp::Direction;

/// The command on the wire.
pub const COMMAND: u16 = 108;

/// Which way it goes.
pub const DIRECTION: Direction = Direction::Reply;

payload! {
    little, exactly, "the payload of an `attitude` reply";
    /// Bytes of payload.
    LEN;
    #[derive(Eq)]
    fields {
        /// Roll, 0.1 degrees.
        roll / set_roll: i16,
        /// Pitch, nose down positive, 0.1 degrees.
        pitch / set_pitch: i16,
        /// Heading, 0 to 360 degrees.
        yaw / set_yaw: i16,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [0x2e, 0xfb, 0x37, 0x02, 0x67, 0x01];

    fn repr() -> Repr {
        Repr { roll: -1234, pitch: 567, yaw: 359 }
    }

    golden_tests!(GOLDEN, repr());
}
