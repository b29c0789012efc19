//! Binary output 2 as PX4 asks for it: magnetic field, pressure, attitude, position.
//!
//! Time group with TimeStartup, IMU group with Temp, Pres and Mag, attitude group with Quaternion and
//! LinearAccelNED, INS group with InsStatus, PosLla, VelNed, PosU and VelU. Body axes are forward, right,
//! down; nav axes north, east, down.

/// What follows the synchronisation byte: which groups of outputs there are, and which outputs of each.
pub const GROUPS: &[u8] = &[0x36, 0x01, 0x00, 0x30, 0x01, 0x84, 0x00, 0x13, 0x06];

payload! {
    little, exactly, "the payload of a `navigation` packet";
    /// Bytes of payload.
    LEN;
    fields {
        /// Time since the unit started, ns.
        time_ns / set_time_ns: u64,
        /// Temperature, °C.
        temperature / set_temperature: f32,
        /// Pressure, kPa.
        pressure / set_pressure: f32,
        /// Magnetic field on body axes, gauss.
        mag / set_mag: [f32; 3],
        /// The quaternion from body to nav, its scalar last.
        xyzw / set_xyzw: [f32; 4],
        /// Acceleration along nav axes, gravity taken out, m/s².
        acceleration / set_acceleration: [f32; 3],
        /// How the unit's own filter does; its lowest two bits are 0 until it tracks a position.
        status / set_status: u16,
        /// Latitude and longitude, degrees, and altitude, m.
        position / set_position: [f64; 3],
        /// Velocity along nav axes, m/s.
        velocity / set_velocity: [f32; 3],
        /// Standard deviation of the position, m.
        position_uncertainty / set_position_uncertainty: f32,
        /// Standard deviation of the velocity, m/s.
        velocity_uncertainty / set_velocity_uncertainty: f32,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0x00, 0xca, 0x9a, 0x3b, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xc8, 0x41, 0x00, 0x00, 0xbd, 0x42, 0x00,
        0x00, 0x80, 0x3e, 0x00, 0x00, 0x80, 0x3d, 0x00, 0x00, 0x00, 0xbf, 0x00, 0x00, 0x00, 0x3f, 0x00, 0x00,
        0x00, 0xbf, 0x00, 0x00, 0x00, 0x3f, 0x00, 0x00, 0x80, 0x3e, 0x00, 0x00, 0x80, 0x3f, 0x00, 0x00, 0x00,
        0xc0, 0x00, 0x00, 0x40, 0x40, 0x02, 0x81, 0xd7, 0xa3, 0x70, 0x3d, 0x0a, 0xf7, 0x4d, 0x40, 0x8f, 0xc2,
        0xf5, 0x28, 0x5c, 0x4f, 0x3e, 0xc0, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x29, 0x40, 0x00, 0x00, 0x80,
        0xc0, 0x00, 0x00, 0xa0, 0x40, 0x00, 0x00, 0xc0, 0xc0, 0x00, 0x00, 0xc0, 0x3f, 0x00, 0x00, 0x00, 0x3e,
    ];

    fn repr() -> Repr {
        Repr {
            time_ns: 1000000000,
            temperature: 25.0,
            pressure: 94.5,
            mag: [0.25, 0.0625, -0.5],
            xyzw: [0.5, -0.5, 0.5, 0.25],
            acceleration: [1.0, -2.0, 3.0],
            status: 0x8102,
            position: [59.93, -30.31, 12.5],
            velocity: [-4.0, 5.0, -6.0],
            position_uncertainty: 1.5,
            velocity_uncertainty: 0.125,
        }
    }

    golden_tests!(GOLDEN, repr());
}
