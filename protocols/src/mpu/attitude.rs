//! Type 10: the attitude that a firmware sends back.
//!
//! The packet's header repeats the `t_us` of the newest sample that went into the answer, which is
//! how its delay is known exactly.

/// The packet type on the wire.
pub const TYPE: u8 = 0x10;

payload! {
    little, exactly, "the payload of an `attitude` packet";
    /// Bytes of payload.
    LEN;
    fields {
        /// The receiver's own clock when it answered, µs, wrapping.
        clock_us / set_clock_us: u32,
        /// Attitude `w, x, y, z`: takes vectors in body axes (FRD) to nav (NED), unit norm.
        q / set_q: [f32; 4],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0x40, 0xe2, 0x01, 0x00, 0x00, 0x00, 0x00, 0x3f, 0x00, 0x00, 0x00, 0xbf, 0x00, 0x00, 0x00, 0x3f, 0x00,
        0x00, 0x00, 0x3f,
    ];

    fn repr() -> Repr {
        Repr { clock_us: 123456, q: [0.5, -0.5, 0.5, 0.5] }
    }

    golden_tests!(GOLDEN, repr());
}
