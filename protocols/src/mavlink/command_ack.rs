//! `COMMAND_ACK` (77): what became of a command.

message! {
    COMMAND_ACK: id 77, crc_extra 143;
    #[derive(Eq)]
    fields {
        /// `MAV_CMD` of the command.
        command / set_command: u16,
        /// `MAV_RESULT`: [`ACCEPTED`], [`TEMPORARILY_REJECTED`], 2 denied, 3 unsupported, 4 failed, [`IN_PROGRESS`].
        result / set_result: u8,
    }
    extensions {
        /// Extension: how far it is, percent.
        progress / set_progress: u8,
        /// Extension: more about the result.
        result_param2 / set_result_param2: i32,
        /// Extension: whom it is for: the system id, 0 for any.
        target_system / set_target_system: u8,
        /// Extension: whom it is for: the component id, 0 for any.
        target_component / set_target_component: u8,
    }
}

/// `result`: done.
pub const ACCEPTED: u8 = 0;

/// `result`: not now, ask again.
pub const TEMPORARILY_REJECTED: u8 = 1;

/// `result`: being done.
pub const IN_PROGRESS: u8 = 5;

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [0xff, 0x01, 0x03, 0x4d, 0x90, 0xee, 0xfe, 0xff, 0x2a, 0x01];

    fn repr() -> Repr {
        Repr {
            command: 511,
            result: 3,
            progress: 77,
            result_param2: -70000,
            target_system: 42,
            target_component: 1,
        }
    }

    golden_tests!(GOLDEN, repr());
}
