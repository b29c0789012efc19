//! Command 102, from Betaflight: what its sensors read.

use crate::msp::Direction;

/// The command on the wire.
pub const COMMAND: u16 = 102;

/// Which way it goes.
pub const DIRECTION: Direction = Direction::Reply;

payload! {
    little, exactly, "the payload of a `raw_imu` reply";
    /// Bytes of payload.
    LEN;
    #[derive(Eq)]
    fields {
        /// Specific force forward, left and up, in the accelerometer's counts.
        accel / set_accel: [i16; 3],
        /// Angular rate about forward, left and up, in the gyro's counts.
        gyro / set_gyro: [i16; 3],
        /// Magnetic field, in the magnetometer's counts.
        mag / set_mag: [i16; 3],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] =
        [0x01, 0, 0xfe, 0xff, 0, 0x01, 0x14, 0, 0xec, 0xff, 0x07, 0, 0, 0x10, 0, 0, 0, 0x80];

    fn repr() -> Repr {
        Repr { accel: [1, -2, 256], gyro: [20, -20, 7], mag: [4096, 0, -32768] }
    }

    golden_tests!(GOLDEN, repr());
}
