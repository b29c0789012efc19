//! `HEARTBEAT` (0): who is there, once a second.

message! {
    HEARTBEAT: id 0, crc_extra 50;
    #[derive(Eq)]
    fields {
        /// Mode bits of the autopilot's own.
        custom_mode / set_custom_mode: u32,
        /// `MAV_TYPE` (the field `type`): 0 generic, 2 quadrotor.
        kind / set_kind: u8,
        /// `MAV_AUTOPILOT`: 8 not an autopilot, 12 PX4, 3 ArduPilot.
        autopilot / set_autopilot: u8,
        /// `MAV_MODE_FLAG`: bit 5 (0x20) is hardware in the loop.
        base_mode / set_base_mode: u8,
        /// `MAV_STATE`: 4 is active.
        system_status / set_system_status: u8,
        /// Always 3.
        mavlink_version / set_mavlink_version: u8,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [0x04, 0x03, 0x02, 0x01, 0x02, 0x0c, 0x20, 0x04, 0x03];

    fn repr() -> Repr {
        Repr {
            custom_mode: 16909060,
            kind: 2,
            autopilot: 12,
            base_mode: 32,
            system_status: 4,
            mavlink_version: 3,
        }
    }

    golden_tests!(GOLDEN, repr());
}
