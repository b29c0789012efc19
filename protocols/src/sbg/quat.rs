//! Class 0, id 7: the attitude, from body (forward, right, down) to nav (north, east, down).

/// The class on the wire.
pub const CLASS: u8 = super::LOG;

/// The id on the wire.
pub const ID: u8 = 7;

payload! {
    little, at_least, "the payload of a `quat` packet";
    /// Bytes of payload.
    LEN;
    fields {
        /// Since the unit started, µs; it begins again after 71 minutes.
        time_us / set_time_us: u32,
        /// The quaternion, its scalar first.
        wxyz / set_wxyz: [f32; 4],
        /// Standard deviation of roll, pitch and yaw, rad.
        uncertainty / set_uncertainty: [f32; 3],
        /// How good the unit's solution is: 0 is none.
        status / set_status: u32,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0x40, 0x42, 0x0f, 0x00, 0x00, 0x00, 0x00, 0x3f, 0x00, 0x00, 0x00, 0xbf, 0x00, 0x00, 0x00, 0x3f, 0x00,
        0x00, 0x00, 0x3f, 0x00, 0x00, 0x00, 0x3e, 0x00, 0x00, 0x80, 0x3e, 0x00, 0x00, 0x00, 0x3f, 0x32, 0x00,
        0x00, 0x00,
    ];

    fn repr() -> Repr {
        Repr {
            time_us: 1_000_000,
            wxyz: [0.5, -0.5, 0.5, 0.5],
            uncertainty: [0.125, 0.25, 0.5],
            status: 0x32,
        }
    }

    golden_tests!(GOLDEN, repr());
}
