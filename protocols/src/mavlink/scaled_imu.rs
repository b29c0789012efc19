//! `SCALED_IMU` (26): an autopilot's first inertial sensor in thousandths of g, rad/s and gauss (body axes, FRD).

message! {
    SCALED_IMU: id 26, crc_extra 170;
    fields {
        /// Time since boot, ms.
        time_boot_ms / set_time_boot_ms: u32,
        /// Specific force along body x, y and z, mg (9.80665 mm/s²).
        accel / set_accel: [i16; 3],
        /// Angular rate about body x, y and z, mrad/s.
        gyro / set_gyro: [i16; 3],
        /// Magnetic field along body x, y and z, mgauss (0.1 µT).
        mag / set_mag: [i16; 3],
    }
    extensions {
        /// Extension: temperature, 0.01 °C; 0 where it is not known.
        temperature / set_temperature: i16,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0xcd, 0x81, 0x01, 0x00, 0x01, 0x00, 0xfe, 0xff, 0x18, 0xfc, 0x2c, 0x01, 0x70, 0xfe, 0x05, 0x00, 0xfa,
        0x00, 0xc2, 0xff, 0xf4, 0x01, 0xd0, 0x09,
    ];

    fn repr() -> Repr {
        Repr {
            time_boot_ms: 98765,
            accel: [1, -2, -1000],
            gyro: [300, -400, 5],
            mag: [250, -62, 500],
            temperature: 2512,
        }
    }

    golden_tests!(GOLDEN, repr());
}
