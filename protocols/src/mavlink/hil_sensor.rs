//! `HIL_SENSOR` (107): the readings of an emulated vehicle, in body axes (FRD).

message! {
    HIL_SENSOR: id 107, crc_extra 108;
    fields {
        /// Time of the sample, µs.
        time_usec / set_time_usec: u64,
        /// Specific force along body x, y and z, m/s²; level at rest is `[0, 0, -9.8]`.
        accel / set_accel: [f32; 3],
        /// Angular rate about body x, y and z, rad/s.
        gyro / set_gyro: [f32; 3],
        /// Magnetic field along body x, y and z, gauss (1 gauss = 100 µT).
        mag / set_mag: [f32; 3],
        /// Static pressure, hPa.
        abs_pressure / set_abs_pressure: f32,
        /// Dynamic pressure, hPa.
        diff_pressure / set_diff_pressure: f32,
        /// Pressure altitude, m.
        pressure_alt / set_pressure_alt: f32,
        /// Temperature, °C.
        temperature / set_temperature: f32,
        /// Which fields are new: an or of [`ACCEL`], [`GYRO`], [`MAG`] and [`PRESSURE`].
        fields_updated / set_fields_updated: u32,
    }
    extensions {
        /// Extension: which of several sensors, from 0.
        id / set_id: u8,
    }
}

/// Bits of `fields_updated`: the three axes of the accelerometer.
pub const ACCEL: u32 = 0x7;

/// Bits of `fields_updated`: the three axes of the gyro.
pub const GYRO: u32 = 0x38;

/// Bits of `fields_updated`: the three axes of the magnetometer.
pub const MAG: u32 = 0x1C0;

/// Bits of `fields_updated`: static pressure, pressure altitude and temperature.
pub const PRESSURE: u32 = 0x1A00;

/// Bit of `fields_updated`: temperature alone.
pub const TEMPERATURE: u32 = 0x1000;

/// Bit of `fields_updated`: dynamic pressure.
pub const DIFF_PRESSURE: u32 = 0x400;

/// Bit of `fields_updated`: the simulated state was reset.
pub const RESET: u32 = 1 << 31;

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0xd2, 0x02, 0x96, 0x49, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x3e, 0x00, 0x00, 0x80, 0xbe, 0x00,
        0x00, 0x1c, 0xc1, 0x00, 0x00, 0x00, 0x3f, 0x00, 0x00, 0x80, 0xbe, 0x00, 0x00, 0x00, 0x3e, 0x00, 0x00,
        0x80, 0x3e, 0x00, 0x00, 0x80, 0x3d, 0x00, 0x00, 0x00, 0xbf, 0x00, 0x50, 0x7d, 0x44, 0x00, 0x00, 0x00,
        0x3f, 0x00, 0x00, 0x48, 0xc1, 0x00, 0x00, 0xc8, 0x41, 0xff, 0x1b, 0x00, 0x00, 0x01,
    ];

    fn repr() -> Repr {
        Repr {
            time_usec: 1234567890,
            accel: [0.125, -0.25, -9.75],
            gyro: [0.5, -0.25, 0.125],
            mag: [0.25, 0.0625, -0.5],
            abs_pressure: 1013.25,
            diff_pressure: 0.5,
            pressure_alt: -12.5,
            temperature: 25.0,
            fields_updated: 7167,
            id: 1,
        }
    }

    golden_tests!(GOLDEN, repr());
}
