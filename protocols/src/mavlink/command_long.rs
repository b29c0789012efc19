//! `COMMAND_LONG` (76): asks somebody to do something.

message! {
    COMMAND_LONG: id 76, crc_extra 152;
    fields {
        /// What the parameters of the command say.
        params / set_params: [f32; 7],
        /// `MAV_CMD`.
        command / set_command: u16,
        /// Whom it is for: the system id, 0 for any.
        target_system / set_target_system: u8,
        /// Whom it is for: the component id, 0 for any.
        target_component / set_target_component: u8,
        /// 0 the first time, then counted up.
        confirmation / set_confirmation: u8,
    }
}

/// `command`: send message `params[0]` every `params[1]` µs.
pub const SET_MESSAGE_INTERVAL: u16 = 511;

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0x00, 0x00, 0xf8, 0x41, 0x00, 0x40, 0x9c, 0x46, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xbf, 0x00,
        0x00, 0x80, 0x3e, 0x00, 0x00, 0x00, 0x40, 0x00, 0x00, 0x80, 0x3f, 0xff, 0x01, 0x2a, 0x01, 0x03,
    ];

    fn repr() -> Repr {
        Repr {
            params: [31.0, 20000.0, 0.0, -0.5, 0.25, 2.0, 1.0],
            command: 511,
            target_system: 42,
            target_component: 1,
            confirmation: 3,
        }
    }

    golden_tests!(GOLDEN, repr());
}
