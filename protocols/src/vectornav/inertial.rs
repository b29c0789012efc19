//! Binary output 1 as PX4 asks for it: angular rate and specific force.
//!
//! Time group with TimeStartup, IMU group with Accel and AngularRate. Axes are forward, right, down.

/// What follows the synchronisation byte: which groups of outputs there are, and which outputs of each.
pub const GROUPS: &[u8] = &[0x06, 0x01, 0x00, 0x00, 0x06];

payload! {
    little, exactly, "the payload of an `inertial` packet";
    /// Bytes of payload.
    LEN;
    fields {
        /// Time since the unit started, ns.
        time_ns / set_time_ns: u64,
        /// Specific force, m/s²: level at rest is 0, 0, -9.8.
        accel / set_accel: [f32; 3],
        /// Angular rate, rad/s.
        gyro / set_gyro: [f32; 3],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0x00, 0xca, 0x9a, 0x3b, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x3f, 0x00, 0x00, 0x80, 0xbe, 0x00,
        0x00, 0x1c, 0xc1, 0x00, 0x00, 0x00, 0x3e, 0x00, 0x00, 0x00, 0xbf, 0x00, 0x00, 0x40, 0x3f,
    ];

    fn repr() -> Repr {
        Repr { time_ns: 1000000000, accel: [0.5, -0.25, -9.75], gyro: [0.125, -0.5, 0.75] }
    }

    golden_tests!(GOLDEN, repr());
}
