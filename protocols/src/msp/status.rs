//! Command 101, from Betaflight: what its tasks do.

use crate::msp::Direction;

/// The command on the wire.
pub const COMMAND: u16 = 101;

/// Which way it goes.
pub const DIRECTION: Direction = Direction::Reply;

payload! {
    little, at_least, "the payload of a `status` reply";
    /// Bytes that every version sends.
    LEN;
    #[derive(Eq)]
    fields {
        /// Between two runs of the control loop, µs; 0 where it never runs.
        cycle_time / set_cycle_time: u16,
        /// Errors on the I²C bus.
        bus_errors / set_bus_errors: u16,
        /// Sensors that are there, a bit each: accelerometer, barometer, magnetometer, GPS, range finder, gyro.
        sensors / set_sensors: u16,
        /// Flight modes that are on, a bit each.
        modes / set_modes: u32,
        /// The profile in use.
        profile / set_profile: u8,
        /// Share of the processor's time that is used, %.
        load / set_load: u16,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The start of Betaflight's own answer.
    const GOLDEN: [u8; LEN] = [0xe5, 0x03, 0, 0, 0x27, 0, 0, 0, 0, 0, 0, 0, 0];

    fn repr() -> Repr {
        Repr { cycle_time: 997, sensors: 0x27, ..Repr::default() }
    }

    golden_tests!(GOLDEN, repr());
}
