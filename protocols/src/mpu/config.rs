//! Type 05: the registers that say how to read the others.
//!
//! Sent first on a link and once a second after that, so that a receiver that arrives late learns
//! the scales. A part without a magnetometer has 0 in the last five fields.

/// The packet type on the wire.
pub const TYPE: u8 = 0x05;

payload! {
    little, exactly, "the payload of a `config` packet";
    /// Bytes of payload.
    LEN;
    #[derive(Eq)]
    fields {
        /// Register 0x75: which chip this is.
        who_am_i / set_who_am_i: u8,
        /// Register 0x19: sample rate divider; the rate is [`Chip::sample_rate_hz`](super::registers::Chip::sample_rate_hz).
        smplrt_div / set_smplrt_div: u8,
        /// Register 0x1A: low-pass filter.
        config / set_config: u8,
        /// Register 0x1B: full scale of the gyro in bits 4:3.
        gyro_config / set_gyro_config: u8,
        /// Register 0x1C: full scale of the accelerometer in bits 4:3.
        accel_config / set_accel_config: u8,
        /// AK8963 register 0x00: which magnetometer, 0 for none.
        mag_who / set_mag_who: u8,
        /// AK8963 register 0x0A: mode in bits 3:0, 16-bit output in bit 4.
        cntl1 / set_cntl1: u8,
        /// AK8963 registers 0x10 to 0x12: sensitivity adjustment of its x, y and z.
        asa / set_asa: [u8; 3],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [0x71, 0x00, 0x01, 0x18, 0x08, 0x48, 0x16, 0xb0, 0xb2, 0xa8];

    fn repr() -> Repr {
        Repr {
            who_am_i: 113,
            smplrt_div: 0,
            config: 1,
            gyro_config: 24,
            accel_config: 8,
            mag_who: 72,
            cntl1: 22,
            asa: [176, 178, 168],
        }
    }

    golden_tests!(GOLDEN, repr());
}
