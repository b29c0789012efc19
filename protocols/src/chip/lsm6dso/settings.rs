//! Which rate, full scale and filter the registers of an LSM6DSO ask for.

use super::{CTRL1_XL, CTRL2_G, CTRL4_C, CTRL6_C, CTRL7_G, CTRL8_XL, Lsm6dso, X_OFS_USR};
use crate::chip::Setting;

/// Rates by ODR_XL and ODR_G, nominal (DS12140 section 4.1, table 2).
const RATES: [(u32, u32); 10] =
    [(25, 2), (26, 1), (52, 1), (104, 1), (208, 1), (416, 1), (833, 1), (1666, 1), (3332, 1), (6664, 1)];

/// The accelerometer's second filter by HPCF_XL (DS12140 table 65).
const LPF2: [&str; 8] = [
    "LPF2 ODR/4",
    "LPF2 ODR/10",
    "LPF2 ODR/20",
    "LPF2 ODR/45",
    "LPF2 ODR/100",
    "LPF2 ODR/200",
    "LPF2 ODR/400",
    "LPF2 ODR/800",
];

/// The gyro's first filter by FTYPE.
const FTYPE: [&str; 8] = [
    "LPF1 FTYPE 0",
    "LPF1 FTYPE 1",
    "LPF1 FTYPE 2",
    "LPF1 FTYPE 3",
    "LPF1 FTYPE 4",
    "LPF1 FTYPE 5",
    "LPF1 FTYPE 6",
    "LPF1 FTYPE 7",
];

fn rate(code: u8) -> Option<(u32, u32)> {
    RATES.get(usize::from(code).checked_sub(1)?).copied()
}

impl Lsm6dso {
    /// Code 11 is 1.6 Hz in low-power mode, else 12.5 Hz (DS12140, CTRL1_XL).
    pub(super) fn accel_setting(&self) -> Setting {
        let code = self.of(CTRL1_XL) >> 4;
        let is_slow = code == 11 && self.of(CTRL6_C) & 0x10 != 0;
        let rate = match code {
            11 if is_slow => Some((8, 5)),
            11 => rate(1),
            _ => rate(code),
        };
        let filter = match (self.of(CTRL1_XL) & 0x02 != 0, self.of(CTRL8_XL) & 0x04 != 0) {
            _ if is_slow => None,
            (false, _) => Some("LPF1 ODR/2"),
            (true, false) => Some(LPF2[usize::from(self.of(CTRL8_XL) >> 5)]),
            (true, true) => None,
        };
        Setting { rate, range: self.accel_range(), filter }
    }

    /// ±2, ±16, ±4, ±8 g by code; with XL_FS_MODE the second is ±2 g too (CTRL1_XL, CTRL8_XL).
    fn accel_range(&self) -> u8 {
        match self.of(CTRL1_XL) >> 2 & 3 {
            1 if self.of(CTRL8_XL) & 0x02 != 0 => 0,
            1 => 3,
            2 => 1,
            3 => 2,
            _ => 0,
        }
    }

    /// Asleep with SLEEP_G (CTRL4_C); LPF1 with LPF1_SEL_G in high-performance mode alone.
    pub(super) fn gyro_setting(&self) -> Setting {
        let is_asleep = self.of(CTRL4_C) & 0x40 != 0;
        let first = self.of(CTRL4_C) & 0x02 != 0 && self.of(CTRL7_G) & 0x80 == 0;
        let filter = if first { FTYPE[usize::from(self.of(CTRL6_C) & 7)] } else { "LPF2" };
        // FS_125 goes before FS_G.
        let control = self.of(CTRL2_G);
        let range = if control & 0x02 != 0 { 0 } else { 1 + (control >> 2 & 3) };
        Setting { rate: rate(control >> 4).filter(|_| !is_asleep), range, filter: Some(filter) }
    }

    /// With USR_OFF_ON_OUT the user's offsets are subtracted, of 2^-10 g a unit or 2^-6 g with USR_OFF_W (registers 0x73 to
    /// 0x75).
    pub(super) fn with_offset(&self, counts: [i16; 3]) -> [i16; 3] {
        if self.of(CTRL7_G) & 0x02 == 0 {
            return counts;
        }
        let unit = if self.of(CTRL6_C) & 0x08 != 0 { 256 } else { 16 };
        let mut shifted = counts;
        for (axis, count) in (0..).zip(&mut shifted) {
            let offset = i32::from(self.of(X_OFS_USR + axis) as i8) * unit;
            let moved = i32::from(*count) - (offset >> self.accel_range());
            *count = moved.clamp(i32::from(i16::MIN), i32::from(i16::MAX)) as i16;
        }
        shifted
    }
}
