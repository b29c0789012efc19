//! Command 167, from Betaflight 2026.6 and later: its attitude as a quaternion.

use crate::msp::Direction;

/// The command on the wire.
pub const COMMAND: u16 = 167;

/// Which way it goes.
pub const DIRECTION: Direction = Direction::Reply;

/// [`Repr::q`] of 1.
pub const SCALE: f64 = 32_767.0;

payload! {
    little, exactly, "the payload of an `attitude_quaternion` reply";
    /// Bytes of payload.
    LEN;
    #[derive(Eq)]
    fields {
        /// w, x, y, z in 1/32767: from forward, left, up to north, west, up.
        q / set_q: [i16; 4],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [0xff, 0x7f, 0x01, 0x80, 0, 0, 0xff, 0xff];

    fn repr() -> Repr {
        Repr { q: [32767, -32767, 0, -1] }
    }

    golden_tests!(GOLDEN, repr());
}
