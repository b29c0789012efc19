//! Type 02: the AK8963 magnetometer inside an MPU-9250.
//!
//! Registers 0x02 to 0x09 exactly as they lie in the part: little-endian two's complement, in the
//! AK8963's own axes, which differ from the gyro's (see [`swap_mag_axes`]).
//!
//! [`swap_mag_axes`]: super::registers::swap_mag_axes

/// The packet type on the wire.
pub const TYPE: u8 = 0x02;

payload! {
    little, exactly, "the payload of a `mag` packet";
    /// Bytes of payload.
    LEN;
    #[derive(Eq)]
    fields {
        /// Status 1: data ready, data overrun.
        st1 / set_st1: u8,
        /// Raw counts along the AK8963's x, y and z, before the sensitivity adjustment.
        field / set_field: [i16; 3],
        /// Status 2: overflow, output width.
        st2 / set_st2: u8,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [0x01, 0x7b, 0x00, 0x38, 0xfe, 0x08, 0x80, 0x10];

    fn repr() -> Repr {
        Repr { st1: 1, field: [123, -456, -32760], st2: 16 }
    }

    golden_tests!(GOLDEN, repr());
}
