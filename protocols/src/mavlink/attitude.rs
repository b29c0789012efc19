//! `ATTITUDE` (30): Euler angles and angular rate of body (FRD) relative to nav (NED).

message! {
    ATTITUDE: id 30, crc_extra 39;
    fields {
        /// Time since boot, ms.
        time_boot_ms / set_time_boot_ms: u32,
        /// Roll, rad.
        roll / set_roll: f32,
        /// Pitch, rad.
        pitch / set_pitch: f32,
        /// Yaw, rad.
        yaw / set_yaw: f32,
        /// Angular rate about body x, y and z, rad/s.
        angular_rate / set_angular_rate: [f32; 3],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0xe8, 0x03, 0x00, 0x00, 0x00, 0x00, 0x00, 0x3f, 0x00, 0x00, 0x80, 0xbe, 0x00, 0x00, 0x40, 0x40, 0x00,
        0x00, 0x00, 0x3e, 0x00, 0x00, 0x80, 0xbf, 0x00, 0x00, 0x00, 0x00,
    ];

    fn repr() -> Repr {
        Repr { time_boot_ms: 1000, roll: 0.5, pitch: -0.25, yaw: 3.0, angular_rate: [0.125, -1.0, 0.0] }
    }

    golden_tests!(GOLDEN, repr());
}
