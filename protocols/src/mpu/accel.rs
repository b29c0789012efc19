//! Type 04: the accelerometer alone.
//!
//! Registers 0x3B to 0x40 exactly as they lie in the chip: big-endian two's complement, chip axes.

/// The packet type on the wire.
pub const TYPE: u8 = 0x04;

payload! {
    big, exactly, "the payload of an `accel` packet";
    /// Bytes of payload.
    LEN;
    #[derive(Eq)]
    fields {
        /// Raw counts along the chip's x, y and z: specific force.
        accel / set_accel: [i16; 3],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [0x00, 0x00, 0x00, 0x00, 0x40, 0x00];

    fn repr() -> Repr {
        Repr { accel: [0, 0, 16384] }
    }

    golden_tests!(GOLDEN, repr());
}
