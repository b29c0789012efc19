//! Type 01: accelerometer, thermometer and gyro as one burst read of the chip.
//!
//! Registers 0x3B to 0x48 exactly as they lie in the chip: big-endian two's complement, chip axes
//! (z up when the part lies flat). Scales are in the [`config`](super::config) packet.

/// The packet type on the wire.
pub const TYPE: u8 = 0x01;

payload! {
    big, exactly, "the payload of an `imu` packet";
    /// Bytes of payload.
    LEN;
    #[derive(Eq)]
    fields {
        /// Raw counts along the chip's x, y and z: specific force.
        accel / set_accel: [i16; 3],
        /// Raw counts of the die thermometer.
        temperature / set_temperature: i16,
        /// Raw counts about the chip's x, y and z: angular rate.
        gyro / set_gyro: [i16; 3],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] =
        [0xc0, 0x00, 0x04, 0xd2, 0x3f, 0xff, 0xfd, 0xf7, 0x00, 0x83, 0xfe, 0xfa, 0x7f, 0xff];

    fn repr() -> Repr {
        Repr { accel: [-16384, 1234, 16383], temperature: -521, gyro: [131, -262, 32767] }
    }

    golden_tests!(GOLDEN, repr());
}
