//! `HIL_STATE_QUATERNION` (115): the true state of an emulated vehicle (body FRD, nav NED).

message! {
    HIL_STATE_QUATERNION: id 115, crc_extra 4;
    fields {
        /// Time of the state, µs.
        time_usec / set_time_usec: u64,
        /// Attitude `w, x, y, z`: takes vectors in body axes (FRD) to nav (NED), unit norm.
        q / set_q: [f32; 4],
        /// Angular rate about body x, y and z, rad/s.
        angular_rate / set_angular_rate: [f32; 3],
        /// Latitude, 10⁻⁷ °.
        lat / set_lat: i32,
        /// Longitude, 10⁻⁷ °.
        lon / set_lon: i32,
        /// Altitude above mean sea level, mm.
        alt / set_alt: i32,
        /// Velocity north, east and down, cm/s.
        velocity / set_velocity: [i16; 3],
        /// Indicated airspeed, cm/s.
        ind_airspeed / set_ind_airspeed: u16,
        /// True airspeed, cm/s.
        true_airspeed / set_true_airspeed: u16,
        /// Specific force along body x, y and z, mg (9.80665 mm/s²).
        accel / set_accel: [i16; 3],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0xd2, 0x02, 0x96, 0x49, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x3f, 0x00, 0x00, 0x00, 0xbf, 0x00,
        0x00, 0x00, 0x3f, 0x00, 0x00, 0x00, 0x3f, 0x00, 0x00, 0x00, 0x3e, 0x00, 0x00, 0x80, 0xbf, 0x00, 0x00,
        0x00, 0x40, 0x98, 0x3f, 0xb9, 0x23, 0x28, 0x3b, 0xeb, 0xed, 0xd4, 0x30, 0x00, 0x00, 0xb0, 0x04, 0x7c,
        0xfc, 0xce, 0xff, 0xaa, 0x05, 0xdc, 0x05, 0x01, 0x00, 0xfe, 0xff, 0x18, 0xfc,
    ];

    fn repr() -> Repr {
        Repr {
            time_usec: 1234567890,
            q: [0.5, -0.5, 0.5, 0.5],
            angular_rate: [0.125, -1.0, 2.0],
            lat: 599343000,
            lon: -303351000,
            alt: 12500,
            velocity: [1200, -900, -50],
            ind_airspeed: 1450,
            true_airspeed: 1500,
            accel: [1, -2, -1000],
        }
    }

    golden_tests!(GOLDEN, repr());
}
