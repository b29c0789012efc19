//! Binary output 1: what the inertial sensors read.
//!
//! Common group with TimeStartup, AngularRate, Accel, Imu and MagPres. Axes are forward, right, down.

/// What follows the synchronisation byte: which groups of outputs there are, and which outputs of each.
pub const GROUPS: &[u8] = &[0x01, 0x21, 0x07];

payload! {
    little, exactly, "the payload of an `imu` packet";
    /// Bytes of payload.
    LEN;
    fields {
        /// Time since the unit started, ns.
        time_ns / set_time_ns: u64,
        /// Angular rate, rad/s.
        gyro / set_gyro: [f32; 3],
        /// Specific force, m/s²: level at rest is 0, 0, -9.8.
        accel / set_accel: [f32; 3],
        /// Specific force before the unit's own compensation, m/s².
        raw_accel / set_raw_accel: [f32; 3],
        /// Angular rate before the unit's own compensation, rad/s.
        raw_gyro / set_raw_gyro: [f32; 3],
        /// Magnetic field, gauss.
        mag / set_mag: [f32; 3],
        /// Temperature, °C.
        temperature / set_temperature: f32,
        /// Pressure, kPa.
        pressure / set_pressure: f32,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0x00, 0xca, 0x9a, 0x3b, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x3e, 0x00, 0x00, 0x80, 0xbe, 0x00,
        0x00, 0x00, 0x3f, 0x00, 0x00, 0x00, 0x3f, 0x00, 0x00, 0x80, 0xbe, 0x00, 0x00, 0x1c, 0xc1, 0x00, 0x00,
        0x00, 0x3f, 0x00, 0x00, 0x80, 0xbe, 0x00, 0x00, 0x1c, 0xc1, 0x00, 0x00, 0x00, 0x3e, 0x00, 0x00, 0x80,
        0xbe, 0x00, 0x00, 0x00, 0x3f, 0x00, 0x00, 0x80, 0x3e, 0x00, 0x00, 0x80, 0x3d, 0x00, 0x00, 0x00, 0xbf,
        0x00, 0x00, 0xc8, 0x41, 0x00, 0x00, 0xbd, 0x42,
    ];

    fn repr() -> Repr {
        Repr {
            time_ns: 1000000000,
            gyro: [0.125, -0.25, 0.5],
            accel: [0.5, -0.25, -9.75],
            raw_accel: [0.5, -0.25, -9.75],
            raw_gyro: [0.125, -0.25, 0.5],
            mag: [0.25, 0.0625, -0.5],
            temperature: 25.0,
            pressure: 94.5,
        }
    }

    golden_tests!(GOLDEN, repr());
}
