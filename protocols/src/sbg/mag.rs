//! Class 0, id 4: what the magnetometer reads, and the accelerometer again.
//!
//! The unit of the field is not of the protocol: ArduPilot's driver takes it for milligauss, PX4's for gauss.

/// The class on the wire.
pub const CLASS: u8 = super::LOG;

/// The id on the wire.
pub const ID: u8 = 4;

/// [`Repr::status`] of a unit whose every axis works and is in range.
pub const GOOD: u16 = 0x01ff;

payload! {
    little, at_least, "the payload of a `mag` packet";
    /// Bytes of payload.
    LEN;
    fields {
        /// Since the unit started, µs; it begins again after 71 minutes.
        time_us / set_time_us: u32,
        /// What works: see [`GOOD`].
        status / set_status: u16,
        /// Magnetic field, in the receiver's unit.
        field / set_field: [f32; 3],
        /// Specific force, m/s²: level at rest is 0, 0, -9.8.
        accel / set_accel: [f32; 3],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a packet that ArduPilot's driver took.
    const GOLDEN: [u8; LEN] = [
        0x3f, 0xb3, 0x82, 0x02, 0xff, 0x01, 0xbe, 0xa4, 0x2f, 0x43, 0x28, 0x96, 0x02, 0xc3, 0xd9, 0x49, 0xd7,
        0x43, 0x00, 0x00, 0x00, 0x00, 0x08, 0x31, 0x30, 0xbd, 0xa7, 0xe7, 0x1c, 0xc1,
    ];

    fn repr() -> Repr {
        Repr {
            time_us: 42_119_999,
            status: GOOD,
            field: [175.64352, -130.58655, 430.57693],
            accel: [0.0, -0.04301551, -9.806556],
        }
    }

    golden_tests!(GOLDEN, repr());
}
