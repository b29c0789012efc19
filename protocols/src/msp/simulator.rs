//! Command 0x201F, to the firmware: what the emulated vehicle's sensors read.
//!
//! INAV takes it in place of its own sensors while bit 0 of `flags` is set, and has no time-out: what
//! comes last stays. Axes are forward, left, up.

use crate::msp::Direction;

/// The command on the wire.
pub const COMMAND: u16 = 0x201f;

/// Which way it goes.
pub const DIRECTION: Direction = Direction::Request;

/// The layout that this file describes.
pub const VERSION: u8 = 2;

/// Bit of `flags`: take these readings in place of the sensors' own.
pub const ENABLE: u8 = 1 << 0;

/// Bit of `flags`: pretend a full battery.
pub const BATTERY: u8 = 1 << 1;

/// Bit of `flags`: keep the beeper quiet.
pub const MUTE: u8 = 1 << 2;

/// Bit of `flags`: estimate the attitude from these readings; without it `attitude` is taken.
pub const OWN_ESTIMATE: u8 = 1 << 3;

/// Bit of `flags`: the position is new.
pub const NEW_POSITION: u8 = 1 << 4;

/// `pressure` where there is no barometer: the standard atmosphere at sea level, Pa.
pub const SEA_LEVEL: i32 = 101_325;

payload! {
    little, exactly, "the payload of a `simulator` request";
    /// Bytes of payload.
    LEN;
    #[derive(Eq)]
    fields {
        /// Of the layout: [`VERSION`].
        version / set_version: u8,
        /// What the firmware is to do, [`ENABLE`] and so on.
        flags / set_flags: u8,
        /// Of the satellite receiver: 0 none, 1 in the plane, 2 in space.
        fix / set_fix: u8,
        /// Satellites in use.
        satellites / set_satellites: u8,
        /// Latitude, 10⁻⁷ degrees, north positive.
        latitude / set_latitude: i32,
        /// Longitude, 10⁻⁷ degrees, east positive.
        longitude / set_longitude: i32,
        /// Altitude above the sea, cm.
        altitude / set_altitude: i32,
        /// Speed over ground, cm/s.
        ground_speed / set_ground_speed: u16,
        /// Course over ground, 0.1 degrees, clockwise from true north.
        course / set_course: u16,
        /// Velocity north, east and down, cm/s.
        velocity / set_velocity: [i16; 3],
        /// Roll, pitch (nose down positive) and yaw, 0.1 degrees; used only without [`OWN_ESTIMATE`].
        attitude / set_attitude: [i16; 3],
        /// Specific force forward, left and up, mg: level at rest is 0, 0, 1000.
        accel / set_accel: [i16; 3],
        /// Angular rate about forward, left and up, 1/16 deg/s.
        gyro / set_gyro: [i16; 3],
        /// Barometer, Pa.
        pressure / set_pressure: i32,
        /// Magnetic field forward, left and up. Only its direction counts: INAV wants a length near 20480, and
        /// no declination.
        mag / set_mag: [i16; 3],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0x02, 0x1f, 0x02, 0x0c, 0xa0, 0x97, 0xb8, 0x23, 0xa0, 0x0f, 0xef, 0xed, 0x39, 0x30, 0x00, 0x00, 0xdc,
        0x05, 0x8c, 0x0a, 0x00, 0x00, 0x24, 0xfa, 0x19, 0x00, 0x2c, 0x01, 0x9c, 0xff, 0x84, 0x03, 0xae, 0x00,
        0xec, 0x01, 0x55, 0x03, 0x10, 0x00, 0xe0, 0xff, 0xd0, 0xff, 0xcd, 0x8b, 0x01, 0x00, 0xf8, 0xf8, 0xf3,
        0x86, 0xe9, 0xb0,
    ];

    fn repr() -> Repr {
        Repr {
            version: 2,
            flags: 31,
            fix: 2,
            satellites: 12,
            latitude: 599300000,
            longitude: -303100000,
            altitude: 12345,
            ground_speed: 1500,
            course: 2700,
            velocity: [0, -1500, 25],
            attitude: [300, -100, 900],
            accel: [174, 492, 853],
            gyro: [16, -32, -48],
            pressure: 101325,
            mag: [-1800, -30989, -20247],
        }
    }

    golden_tests!(GOLDEN, repr());
}
