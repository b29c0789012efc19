//! `RAW_IMU` (27): an autopilot's first inertial sensor in counts, whose unit the message does not say.

message! {
    RAW_IMU: id 27, crc_extra 144;
    fields {
        /// Time of the sample, µs since boot or since 1970.
        time_usec / set_time_usec: u64,
        /// Specific force, raw counts.
        accel / set_accel: [i16; 3],
        /// Angular rate, raw counts.
        gyro / set_gyro: [i16; 3],
        /// Magnetic field, raw counts.
        mag / set_mag: [i16; 3],
    }
    extensions {
        /// Extension: which of several sensors, from 0.
        id / set_id: u8,
        /// Extension: temperature, 0.01 °C; 0 where it is not known.
        temperature / set_temperature: i16,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0xd2, 0x02, 0x96, 0x49, 0x00, 0x00, 0x00, 0x00, 0x01, 0x00, 0xfe, 0xff, 0x18, 0xfc, 0x2c, 0x01, 0x70,
        0xfe, 0x05, 0x00, 0xfa, 0x00, 0xc2, 0xff, 0xf4, 0x01, 0x01, 0xd0, 0x09,
    ];

    fn repr() -> Repr {
        Repr {
            time_usec: 1234567890,
            accel: [1, -2, -1000],
            gyro: [300, -400, 5],
            mag: [250, -62, 500],
            id: 1,
            temperature: 2512,
        }
    }

    golden_tests!(GOLDEN, repr());
}
