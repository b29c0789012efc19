//! `PARAM_REQUEST_READ` (20): asks for one parameter, answered by [`PARAM_VALUE`](super::param_value).

message! {
    PARAM_REQUEST_READ: id 20, crc_extra 214;
    #[derive(Eq)]
    fields {
        /// Which one by its index; −1 to go by `param_id`.
        param_index / set_param_index: i16,
        /// Whom it is for: the system id, 0 for any.
        target_system / set_target_system: u8,
        /// Whom it is for: the component id, 0 for any.
        target_component / set_target_component: u8,
        /// Its name, ended by a zero where it is shorter: [`param_id`](super::param_id).
        param_id / set_param_id: [u8; 16],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0xff, 0xff, 0x2a, 0x01, 0x4d, 0x41, 0x56, 0x5f, 0x30, 0x5f, 0x52, 0x41, 0x54, 0x45, 0x00, 0x00, 0x00,
        0x00, 0x00, 0x00,
    ];

    fn repr() -> Repr {
        Repr { param_index: -1, target_system: 42, target_component: 1, param_id: *b"MAV_0_RATE\0\0\0\0\0\0" }
    }

    golden_tests!(GOLDEN, repr());
}
