//! What the registers mean: who a chip is, its full scales, its thermometer, its magnetometer.
//!
//! Sources: the register maps of the MPU-6000/6050 (RM-MPU-6000A), the MPU-9250 (RM-MPU-9250A)
//! and the AK8963 (MS1356-E).
//!
//! ```
//! use ratetable_protocols::mpu::registers;
//!
//! let widest = registers::full_scale_bits(3);
//! assert_eq!(registers::gyro_full_scale_dps(widest), 2000.0);
//! assert_eq!(registers::accel_full_scale_g(widest), 16.0);
//! ```

/// `WHO_AM_I` of an MPU-6000 and an MPU-6050.
pub const WHO_MPU60X0: u8 = 0x68;

/// `WHO_AM_I` of an MPU-9250.
pub const WHO_MPU9250: u8 = 0x71;

/// Device id of an AK8963.
pub const WHO_AK8963: u8 = 0x48;

/// Bit of `ST1`: a new measurement is ready.
pub const ST1_DATA_READY: u8 = 0x01;

/// Bit of `ST1`: a measurement was overwritten before it was read.
pub const ST1_OVERRUN: u8 = 0x02;

/// Bit of `ST2`: the sensor overflowed and the measurement is not to be used.
pub const ST2_OVERFLOW: u8 = 0x08;

/// Bit of `ST2`: the output has 16 bits (else 14).
pub const ST2_16_BIT: u8 = 0x10;

/// The largest count of the AK8963 with 16 bits of output.
pub const MAG_MAX_COUNT: i16 = 32760;

/// A family of chips that differ in what their registers mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Chip {
    /// MPU-6000 and MPU-6050.
    Mpu60x0,
    /// MPU-9250.
    Mpu9250,
}

impl Chip {
    /// The family with this `WHO_AM_I`.
    pub const fn from_who_am_i(who_am_i: u8) -> Option<Self> {
        match who_am_i {
            WHO_MPU60X0 => Some(Self::Mpu60x0),
            WHO_MPU9250 => Some(Self::Mpu9250),
            _ => None,
        }
    }

    /// The family's `WHO_AM_I`.
    pub const fn who_am_i(self) -> u8 {
        match self {
            Self::Mpu60x0 => WHO_MPU60X0,
            Self::Mpu9250 => WHO_MPU9250,
        }
    }

    /// Where the thermometer reads 0 (°C), and its counts per °C.
    const fn thermometer(self) -> (f64, f64) {
        match self {
            Self::Mpu60x0 => (36.53, 340.0),
            Self::Mpu9250 => (21.0, 333.87),
        }
    }

    /// The temperature in °C that a raw count stands for.
    pub fn temperature_c(self, raw: i16) -> f64 {
        let (zero_c, counts_per_c) = self.thermometer();
        f64::from(raw) / counts_per_c + zero_c
    }

    /// The raw count nearest to a temperature in °C, clipped to what fits.
    pub fn temperature_raw(self, temperature_c: f64) -> i16 {
        let (zero_c, counts_per_c) = self.thermometer();
        nearest((temperature_c - zero_c) * counts_per_c)
    }
}

impl Chip {
    /// Bandwidths of the gyro's low-pass filter in Hz that `CONFIG` (`DLPF_CFG`, bits 2:0) 0 to 6 select.
    pub const fn gyro_bandwidths_hz(self) -> [f64; 7] {
        match self {
            Self::Mpu60x0 => [256.0, 188.0, 98.0, 42.0, 20.0, 10.0, 5.0],
            Self::Mpu9250 => [250.0, 184.0, 92.0, 41.0, 20.0, 10.0, 5.0],
        }
    }

    /// Samples a second that `CONFIG` and `SMPLRT_DIV` select.
    ///
    /// 8 kHz with `DLPF_CFG` 0 or 7, else 1 kHz, divided by one more than the divider; an MPU-9250 divides the 1 kHz
    /// alone.
    pub fn sample_rate_hz(self, config: u8, smplrt_div: u8) -> f64 {
        let divider = 1.0 + f64::from(smplrt_div);
        match (config & 7, self) {
            (0 | 7, Self::Mpu60x0) => 8000.0 / divider,
            (0 | 7, Self::Mpu9250) => 8000.0,
            _ => 1000.0 / divider,
        }
    }
}

/// Counts per deg/s at the full scale that `GYRO_CONFIG` selects.
///
/// ±250, 500, 1000 and 2000 deg/s; the published figures, which are rounded: 131 rather than
/// 32768/250 = 131.072.
pub const fn gyro_lsb_per_dps(gyro_config: u8) -> f64 {
    match full_scale(gyro_config) {
        0 => 131.0,
        1 => 65.5,
        2 => 32.8,
        _ => 16.4,
    }
}

/// Full scale of the gyro in deg/s that `GYRO_CONFIG` selects.
pub const fn gyro_full_scale_dps(gyro_config: u8) -> f64 {
    match full_scale(gyro_config) {
        0 => 250.0,
        1 => 500.0,
        2 => 1000.0,
        _ => 2000.0,
    }
}

/// Counts per g (9.80665 m/s²) at the full scale that `ACCEL_CONFIG` selects.
pub const fn accel_lsb_per_g(accel_config: u8) -> f64 {
    match full_scale(accel_config) {
        0 => 16384.0,
        1 => 8192.0,
        2 => 4096.0,
        _ => 2048.0,
    }
}

/// Full scale of the accelerometer in g that `ACCEL_CONFIG` selects.
pub const fn accel_full_scale_g(accel_config: u8) -> f64 {
    32768.0 / accel_lsb_per_g(accel_config)
}

/// Bits 4:3 of a configuration register.
const fn full_scale(config: u8) -> u8 {
    (config >> 3) & 3
}

/// The bits of `GYRO_CONFIG` or `ACCEL_CONFIG` that select full scale 0 to 3 (the widest is 3).
pub const fn full_scale_bits(scale: u8) -> u8 {
    (scale & 3) << 3
}

/// µT per count of one axis of the AK8963 with this sensitivity adjustment (`ASAX`, …).
///
/// `sixteen_bit` is bit 4 of `CNTL1`, mirrored in [`ST2_16_BIT`].
pub fn mag_ut_per_lsb(asa: u8, sixteen_bit: bool) -> f64 {
    let unadjusted = if sixteen_bit { 0.15 } else { 0.6 };
    unadjusted * ((f64::from(asa) - 128.0) / 256.0 + 1.0)
}

/// The field in µT that a 16-bit count of one axis of the AK8963 stands for.
pub fn mag_ut(raw: i16, asa: u8) -> f64 {
    f64::from(raw) * mag_ut_per_lsb(asa, true)
}

/// The 16-bit count of one axis of the AK8963 nearest to a field in µT, clipped to what it gives.
pub fn mag_raw(field_ut: f64, asa: u8) -> i16 {
    nearest(field_ut / mag_ut_per_lsb(asa, true)).clamp(-MAG_MAX_COUNT, MAG_MAX_COUNT)
}

/// Turns a vector from the MPU-9250's axes to those of the AK8963 within it, or back.
///
/// `x_mag = y_imu`, `y_mag = x_imu`, `z_mag = -z_imu`; the turn is its own inverse.
pub fn swap_mag_axes([x, y, z]: [f64; 3]) -> [f64; 3] {
    [y, x, -z]
}

/// The nearest integer, halves away from zero, clipped to what fits; not-a-number gives 0.
pub fn nearest(value: f64) -> i16 {
    let half = if value < 0.0 { -0.5 } else { 0.5 };
    (value + half) as i16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn full_scales_are_those_of_the_register_map() {
        let scales = [0, 1, 2, 3].map(full_scale_bits);
        assert_eq!(scales, [0x00, 0x08, 0x10, 0x18]);
        assert_eq!(scales.map(gyro_lsb_per_dps), [131.0, 65.5, 32.8, 16.4]);
        assert_eq!(scales.map(accel_lsb_per_g), [16384.0, 8192.0, 4096.0, 2048.0]);
        assert_eq!(scales.map(accel_full_scale_g), [2.0, 4.0, 8.0, 16.0]);
        assert_eq!(scales.map(gyro_full_scale_dps), [250.0, 500.0, 1000.0, 2000.0]);
        assert_eq!(gyro_lsb_per_dps(0xe7), 131.0, "self-test bits do not count");
    }

    #[test]
    fn temperatures_go_both_ways() {
        for chip in [Chip::Mpu60x0, Chip::Mpu9250] {
            assert_eq!(Chip::from_who_am_i(chip.who_am_i()), Some(chip));
            for raw in [-32768, -521, 0, 1, 32767] {
                assert_eq!(chip.temperature_raw(chip.temperature_c(raw)), raw);
            }
            assert_eq!(chip.temperature_raw(1e9), i16::MAX);
            assert_eq!(chip.temperature_raw(f64::NAN), 0);
        }
        assert_eq!(Chip::Mpu60x0.temperature_c(0), 36.53);
        assert_eq!(Chip::Mpu9250.temperature_raw(25.0), 1335);
        assert_eq!(Chip::from_who_am_i(0x12), None);
    }

    #[test]
    fn the_sample_rate_is_that_of_the_register_map() {
        for (chip, config, divider, hz) in [
            (Chip::Mpu60x0, 0, 0, 8000.0),
            (Chip::Mpu60x0, 0, 7, 1000.0),
            (Chip::Mpu60x0, 1, 7, 125.0),
            (Chip::Mpu9250, 0, 7, 8000.0),
            (Chip::Mpu9250, 7, 0, 8000.0),
            (Chip::Mpu9250, 3, 4, 200.0),
            (Chip::Mpu9250, 0x46, 255, 1000.0 / 256.0),
        ] {
            assert_eq!(chip.sample_rate_hz(config, divider), hz, "{chip:?} {config} {divider}");
        }
    }

    #[test]
    fn magnetometer_counts_go_both_ways() {
        assert_eq!(mag_ut(1000, 128), 150.0);
        assert!((mag_ut_per_lsb(255, true) - 0.15 * (1.0 + 127.0 / 256.0)).abs() < 1e-15);
        assert_eq!(mag_ut_per_lsb(128, false), 0.6);
        for raw in [-32760, -1, 0, 1, 333, 32760] {
            for asa in [0, 1, 128, 176, 255] {
                assert_eq!(mag_raw(mag_ut(raw, asa), asa), raw);
            }
        }
        assert_eq!(mag_raw(1e9, 128), MAG_MAX_COUNT);
    }

    #[test]
    fn the_magnetometers_axes_are_turned_and_turned_back() {
        assert_eq!(swap_mag_axes([1.0, 2.0, 3.0]), [2.0, 1.0, -3.0]);
        assert_eq!(swap_mag_axes(swap_mag_axes([1.0, 2.0, 3.0])), [1.0, 2.0, 3.0]);
    }
}
