//! To the firmware: the state of the simulated vehicle.
//!
//! The firmware negates and rounds on its own. Of an angular rate p, q, r and a specific force f in
//! forward-right-down axes it wants:
//!
//! | field | 2026.6 and later | 2025.12, 4.5, or built with `ENABLE_GAZEBO_BRIDGE=0` |
//! |---|---|---|
//! | `gyro` | p, q, −r | p, q, r |
//! | `accel` | −fx, fy, fz | −fx, fy, fz |

/// Standard gravity, m/s².
const G: f64 = 9.80665;

payload! {
    little, exactly, "a `state` packet";
    /// Bytes of the packet.
    LEN;
    fields {
        /// The simulator's time, s. What it gains between two packets over what passes meanwhile speeds the
        /// firmware's clock up; while it is constant the clock keeps real time.
        timestamp / set_timestamp: f64,
        /// Angular rate, rad/s.
        gyro / set_gyro: [f64; 3],
        /// Specific force, m/s²; level at rest 0, 0, −9.80665.
        accel / set_accel: [f64; 3],
        /// Attitude as a unit quaternion w, x, y, z. Versions before 2026.6 take it in place of an estimate.
        orientation / set_orientation: [f64; 4],
        /// Velocity east, north and up, m/s.
        velocity / set_velocity: [f64; 3],
        /// Longitude and latitude, degrees, and altitude, m.
        position / set_position: [f64; 3],
        /// Pressure, Pa; 2026.6 and later make it of the altitude.
        pressure / set_pressure: f64,
    }
}

impl Repr {
    /// Level and still at longitude, latitude and altitude 0, in the standard atmosphere.
    pub const LEVEL: Self = Self {
        timestamp: 0.0,
        gyro: [0.0; 3],
        accel: [0.0, 0.0, -G],
        orientation: [1.0, 0.0, 0.0, 0.0],
        velocity: [0.0; 3],
        position: [0.0; 3],
        pressure: 101_325.0,
    };

    /// Whether these may be the values of a vehicle: numbers, an orientation of length 1 to a hundredth, and nothing
    /// beyond 10⁹ of its unit. With neither start nor checksum nothing else tells a packet from other bytes.
    pub fn is_plausible(&self) -> bool {
        let Self { timestamp, gyro, accel, orientation, velocity, position, pressure } = self;
        let square: f64 = orientation.iter().map(|part| part * part).sum();
        let parts = [gyro, accel, velocity, position].into_iter().flatten();
        let mut all = parts.chain([timestamp, pressure]);
        // Not-a-number is in no range.
        all.all(|value| (-1e9..=1e9).contains(value)) && (0.98..=1.02).contains(&square)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Python: `struct.pack('<18d', 1.5, .125, -.25, .5, 1, -2, -9.5, .5, -.5, .5, -.5, 3, -4, .25, -30.5, 60.25, 12,
    /// 94500)`.
    const GOLDEN: [u8; LEN] = [
        0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xf8, 0x3f, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xc0, 0x3f, 0x00,
        0x00, 0x00, 0x00, 0x00, 0x00, 0xd0, 0xbf, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xe0, 0x3f, 0x00, 0x00,
        0x00, 0x00, 0x00, 0x00, 0xf0, 0x3f, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xc0, 0x00, 0x00, 0x00,
        0x00, 0x00, 0x00, 0x23, 0xc0, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xe0, 0x3f, 0x00, 0x00, 0x00, 0x00,
        0x00, 0x00, 0xe0, 0xbf, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xe0, 0x3f, 0x00, 0x00, 0x00, 0x00, 0x00,
        0x00, 0xe0, 0xbf, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x08, 0x40, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
        0x10, 0xc0, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xd0, 0x3f, 0x00, 0x00, 0x00, 0x00, 0x00, 0x80, 0x3e,
        0xc0, 0x00, 0x00, 0x00, 0x00, 0x00, 0x20, 0x4e, 0x40, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x28, 0x40,
        0x00, 0x00, 0x00, 0x00, 0x40, 0x12, 0xf7, 0x40,
    ];

    fn repr() -> Repr {
        Repr {
            timestamp: 1.5,
            gyro: [0.125, -0.25, 0.5],
            accel: [1.0, -2.0, -9.5],
            orientation: [0.5, -0.5, 0.5, -0.5],
            velocity: [3.0, -4.0, 0.25],
            position: [-30.5, 60.25, 12.0],
            pressure: 94_500.0,
        }
    }

    golden_tests!(GOLDEN, repr());

    #[test]
    fn a_packet_is_plausible_with_numbers_of_a_vehicle_and_an_orientation() {
        assert!(repr().is_plausible() && Repr::LEVEL.is_plausible());
        let unlikely = [
            Repr::default(),
            Repr { orientation: [1.1, 0.0, 0.0, 0.0], ..repr() },
            Repr { timestamp: f64::NAN, ..repr() },
            Repr { gyro: [0.0, f64::INFINITY, 0.0], ..repr() },
            Repr { accel: [0.0, 0.0, 1e300], ..repr() },
            Repr { pressure: -1e10, ..repr() },
            Repr { orientation: [f64::NAN; 4], ..repr() },
        ];
        for repr in unlikely {
            assert!(!repr.is_plausible(), "{repr:?}");
        }
    }
}
