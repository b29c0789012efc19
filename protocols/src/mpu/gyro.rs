//! Type 03: the gyro alone.
//!
//! Registers 0x43 to 0x48 exactly as they lie in the chip: big-endian two's complement, chip axes.

/// The packet type on the wire.
pub const TYPE: u8 = 0x03;

payload! {
    big, exactly, "the payload of a `gyro` packet";
    /// Bytes of payload.
    LEN;
    #[derive(Eq)]
    fields {
        /// Raw counts about the chip's x, y and z: angular rate.
        gyro / set_gyro: [i16; 3],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [0x00, 0x01, 0xff, 0xfe, 0x80, 0x00];

    fn repr() -> Repr {
        Repr { gyro: [1, -2, -32768] }
    }

    golden_tests!(GOLDEN, repr());
}
