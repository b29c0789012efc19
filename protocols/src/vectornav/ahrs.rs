//! Binary output 2: the attitude.
//!
//! Common group with TimeStartup, attitude group with Ypr, Quaternion and YprU. From body (forward,
//! right, down) to nav (north, east, down).

/// What follows the synchronisation byte: which groups of outputs there are, and which outputs of each.
pub const GROUPS: &[u8] = &[0x11, 0x01, 0x00, 0x06, 0x01];

payload! {
    little, exactly, "the payload of an `ahrs` packet";
    /// Bytes of payload.
    LEN;
    fields {
        /// Time since the unit started, ns.
        time_ns / set_time_ns: u64,
        /// Yaw, pitch and roll, degrees.
        yaw_pitch_roll / set_yaw_pitch_roll: [f32; 3],
        /// The quaternion, its scalar last.
        xyzw / set_xyzw: [f32; 4],
        /// Standard deviation of yaw, pitch and roll, degrees.
        uncertainty / set_uncertainty: [f32; 3],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0x00, 0xca, 0x9a, 0x3b, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xb4, 0x42, 0x00, 0x00, 0x00, 0x00, 0x00,
        0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x3f, 0x00, 0x00, 0x00, 0xbf, 0x00, 0x00, 0x00, 0x3f, 0x00, 0x00,
        0x00, 0x3f, 0x00, 0x00, 0x00, 0x3e, 0x00, 0x00, 0x00, 0x3e, 0x00, 0x00, 0x00, 0x3f,
    ];

    fn repr() -> Repr {
        Repr {
            time_ns: 1000000000,
            yaw_pitch_roll: [90.0, 0.0, 0.0],
            xyzw: [0.5, -0.5, 0.5, 0.5],
            uncertainty: [0.125, 0.125, 0.5],
        }
    }

    golden_tests!(GOLDEN, repr());
}
