//! `HIL_GPS` (113): the position fix of an emulated vehicle (WGS 84, NED).

message! {
    HIL_GPS: id 113, crc_extra 124;
    #[derive(Eq)]
    fields {
        /// Time of the fix, µs.
        time_usec / set_time_usec: u64,
        /// Latitude, 10⁻⁷ °.
        lat / set_lat: i32,
        /// Longitude, 10⁻⁷ °.
        lon / set_lon: i32,
        /// Altitude above mean sea level, mm.
        alt / set_alt: i32,
        /// Horizontal dilution of precision × 100.
        eph / set_eph: u16,
        /// Vertical dilution of precision × 100.
        epv / set_epv: u16,
        /// Speed over ground, cm/s.
        vel / set_vel: u16,
        /// Velocity north, east and down, cm/s.
        velocity / set_velocity: [i16; 3],
        /// Course over ground, 0.01 °, 0 to 359.99 °.
        cog / set_cog: u16,
        /// 0 or 1 no fix, 2 two-dimensional, 3 three-dimensional.
        fix_type / set_fix_type: u8,
        /// Satellites in view.
        satellites_visible / set_satellites_visible: u8,
    }
    extensions {
        /// Extension: which of several receivers, from 0.
        id / set_id: u8,
        /// Extension: heading, 0.01 °; 0 where there is none, 36000 for north.
        yaw / set_yaw: u16,
    }
}

/// `eph`, `epv`, `vel` or `cog` that is not known.
pub const UNKNOWN: u16 = u16::MAX;

/// `satellites_visible` that is not known.
pub const SATELLITES_UNKNOWN: u8 = u8::MAX;

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0xd2, 0x02, 0x96, 0x49, 0x00, 0x00, 0x00, 0x00, 0x98, 0x3f, 0xb9, 0x23, 0x28, 0x3b, 0xeb, 0xed, 0xd4,
        0x30, 0x00, 0x00, 0x46, 0x00, 0x78, 0x00, 0xdc, 0x05, 0xb0, 0x04, 0x7c, 0xfc, 0xce, 0xff, 0x39, 0x7e,
        0x03, 0x0e, 0x01, 0xa0, 0x8c,
    ];

    fn repr() -> Repr {
        Repr {
            time_usec: 1234567890,
            lat: 599343000,
            lon: -303351000,
            alt: 12500,
            eph: 70,
            epv: 120,
            vel: 1500,
            velocity: [1200, -900, -50],
            cog: 32313,
            fix_type: 3,
            satellites_visible: 14,
            id: 1,
            yaw: 36000,
        }
    }

    golden_tests!(GOLDEN, repr());
}
