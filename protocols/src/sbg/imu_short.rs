//! Class 0, id 44: what gyroscope and accelerometer read, as counts.
//!
//! Its documentation calls the vectors increments; they are rates. Above 32 rad/s the gyroscope is told in larger counts,
//! and [`HIGH_RANGE`] says so.

/// The class on the wire.
pub const CLASS: u8 = super::LOG;

/// The id on the wire.
pub const ID: u8 = 44;

/// Counts of [`Repr::accel`] in 1 m/s².
pub const ACCEL_SCALE: f64 = 1_048_576.0;

/// Counts of [`Repr::gyro`] in 1 rad/s.
pub const GYRO_SCALE: f64 = 67_108_864.0;

/// Counts of [`Repr::gyro`] in 1 rad/s where [`HIGH_RANGE`] is set.
pub const GYRO_SCALE_HIGH: f64 = 12_304_174.0;

/// Counts of [`Repr::temperature`] in 1 °C.
pub const TEMPERATURE_SCALE: f64 = 256.0;

/// The bit of [`Repr::status`] that says which scale the gyroscope has.
pub const HIGH_RANGE: u16 = 0x0400;

/// [`Repr::status`] of a unit whose every sensor works, in the usual range.
pub const GOOD: u16 = 0x03ff;

payload! {
    little, at_least, "the payload of an `imu_short` packet";
    /// Bytes of payload.
    LEN;
    #[derive(Eq)]
    fields {
        /// Since the unit started, µs; it begins again after 71 minutes.
        time_us / set_time_us: u32,
        /// What works: see [`GOOD`] and [`HIGH_RANGE`].
        status / set_status: u16,
        /// Specific force, 1/1048576 m/s²; level at rest is 0, 0, -10282919.
        accel / set_accel: [i32; 3],
        /// Angular rate, 1/67108864 rad/s; or 1/12304174 rad/s: see [`HIGH_RANGE`].
        gyro / set_gyro: [i32; 3],
        /// Of the unit, 1/256 °C.
        temperature / set_temperature: i16,
    }
}

impl Repr {
    /// Counts of [`gyro`](Self::gyro) in 1 rad/s.
    pub const fn gyro_scale(&self) -> f64 {
        if self.status & HIGH_RANGE == 0 { GYRO_SCALE } else { GYRO_SCALE_HIGH }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a packet that ArduPilot's driver took.
    const GOLDEN: [u8; LEN] = [
        0x3f, 0xb3, 0x82, 0x02, 0xff, 0x03, 0x00, 0x00, 0x00, 0x00, 0xcf, 0x4f, 0xff, 0xff, 0x59, 0x18, 0x63,
        0xff, 0x13, 0x92, 0xe0, 0x00, 0x6d, 0x4a, 0x00, 0x00, 0x59, 0x47, 0x42, 0x00, 0x00, 0x19,
    ];

    fn repr() -> Repr {
        Repr {
            time_us: 42_119_999,
            status: GOOD,
            accel: [0, -45_105, -10_282_919],
            gyro: [14_717_459, 19_053, 4_343_641],
            temperature: 6400,
        }
    }

    golden_tests!(GOLDEN, repr());

    #[test]
    fn the_status_says_which_scale_the_gyroscope_has() {
        assert_eq!(repr().gyro_scale(), GYRO_SCALE);
        assert_eq!(Repr { status: GOOD | HIGH_RANGE, ..repr() }.gyro_scale(), GYRO_SCALE_HIGH);
    }
}
