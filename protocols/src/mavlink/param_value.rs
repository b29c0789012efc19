//! `PARAM_VALUE` (22): one parameter of an autopilot.

message! {
    PARAM_VALUE: id 22, crc_extra 220;
    fields {
        /// Its value; PX4 puts the bits of an integer here, ArduPilot its number.
        param_value / set_param_value: f32,
        /// How many parameters there are.
        param_count / set_param_count: u16,
        /// Which of them this is.
        param_index / set_param_index: u16,
        /// Its name, ended by a zero where it is shorter: [`param_name`](super::param_name).
        param_id / set_param_id: [u8; 16],
        /// `MAV_PARAM_TYPE`: [`INT32`], [`REAL32`].
        param_type / set_param_type: u8,
    }
}

/// `param_type` of a 32-bit signed integer.
pub const INT32: u8 = 6;

/// `param_type` of a 32-bit float.
pub const REAL32: u8 = 9;

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0xb0, 0x04, 0x00, 0x00, 0xf5, 0x03, 0x03, 0x02, 0x4d, 0x41, 0x56, 0x5f, 0x30, 0x5f, 0x52, 0x41, 0x54,
        0x45, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x06,
    ];

    fn repr() -> Repr {
        Repr {
            param_value: f32::from_bits(1200),
            param_count: 1013,
            param_index: 515,
            param_id: *b"MAV_0_RATE\0\0\0\0\0\0",
            param_type: 6,
        }
    }

    golden_tests!(GOLDEN, repr());
}
