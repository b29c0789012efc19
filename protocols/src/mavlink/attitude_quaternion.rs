//! `ATTITUDE_QUATERNION` (31): attitude and angular rate of body (FRD) relative to nav (NED).

message! {
    ATTITUDE_QUATERNION: id 31, crc_extra 246;
    fields {
        /// Time since boot, ms.
        time_boot_ms / set_time_boot_ms: u32,
        /// Attitude `w, x, y, z`: takes vectors in body axes (FRD) to nav (NED), unit norm.
        q / set_q: [f32; 4],
        /// Angular rate about body x, y and z, rad/s.
        angular_rate / set_angular_rate: [f32; 3],
    }
    extensions {
        /// Extension: rotation to apply before showing the attitude; all 0 means none.
        repr_offset_q / set_repr_offset_q: [f32; 4],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0xc4, 0x09, 0x00, 0x00, 0x00, 0x00, 0x00, 0x3f, 0x00, 0x00, 0x00, 0xbf, 0x00, 0x00, 0x00, 0x3f, 0x00,
        0x00, 0x00, 0x3f, 0x00, 0x00, 0x00, 0x3e, 0x00, 0x00, 0x80, 0xbf, 0x00, 0x00, 0x00, 0x40, 0x00, 0x00,
        0x80, 0x3f, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
    ];

    fn repr() -> Repr {
        Repr {
            time_boot_ms: 2500,
            q: [0.5, -0.5, 0.5, 0.5],
            angular_rate: [0.125, -1.0, 2.0],
            repr_offset_q: [1.0, 0.0, 0.0, 0.0],
        }
    }

    golden_tests!(GOLDEN, repr());
}
