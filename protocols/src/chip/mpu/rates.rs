//! Which rate, full scale and filter the registers of an MPU ask for.

use super::{ACCEL_CONFIG, ACCEL_CONFIG_2, CONFIG, GYRO_CONFIG, Model, Mpu, PWR_MGMT_2, SMPLRT_DIV};
use crate::chip::Setting;

/// Filters by DLPF_CFG, as the data files name them.
const DLPF: [&str; 8] = ["DLPF 0", "DLPF 1", "DLPF 2", "DLPF 3", "DLPF 4", "DLPF 5", "DLPF 6", "DLPF 7"];

impl Mpu {
    /// SMPLRT_DIV divides 8 kHz or 1 kHz of an MPU-6050 (RM-MPU-6000A p. 11 and 13), of the others 1 kHz alone
    /// (RM-MPU-9250A p. 12 and 13).
    pub(super) fn gyro_setting(&self) -> Setting {
        let divider = 1 + u32::from(self.of(SMPLRT_DIV));
        let dlpf = self.of(CONFIG) & 7;
        let past = if self.model == Model::Mpu60x0 { 0 } else { self.of(GYRO_CONFIG) & 3 };
        let (rate, filter) = match (past, dlpf, self.model) {
            (1 | 3, ..) => ((32_000, 1), "Fchoice x0"),
            (2, ..) => ((32_000, 1), "Fchoice 01"),
            // 7 is reserved on an MPU-6050 and gives 8 kHz; the widest filter is assumed.
            (_, 0 | 7, Model::Mpu60x0) => ((8_000, divider), DLPF[0]),
            (_, 0 | 7, _) => ((8_000, 1), DLPF[usize::from(dlpf)]),
            _ => ((1_000, divider), DLPF[usize::from(dlpf)]),
        };
        self.setting_of(0x07, rate, GYRO_CONFIG, filter)
    }

    /// The accelerometer has 1 kHz at most, or 4 kHz past the filter of an MPU-6500 or MPU-9250 (RM-MPU-9250A p. 15).
    pub(super) fn accel_setting(&self) -> Setting {
        let divider = 1 + u32::from(self.of(SMPLRT_DIV));
        let (rate, filter) = match self.model {
            Model::Mpu60x0 => {
                let dlpf = self.of(CONFIG) & 7;
                let undivided = if matches!(dlpf, 0 | 7) { 8_000 } else { 1_000 };
                // 1 kHz while the gyro is faster: such samples are repeated.
                let rate = if undivided > 1_000 * divider { (1_000, 1) } else { (undivided, divider) };
                (rate, DLPF[usize::from(if dlpf == 7 { 0 } else { dlpf })])
            }
            _ if self.of(ACCEL_CONFIG_2) & 0x08 != 0 => ((4_000, 1), "Fchoice 0"),
            _ => ((1_000, divider), DLPF[usize::from(self.of(ACCEL_CONFIG_2) & 7)]),
        };
        self.setting_of(0x38, rate, ACCEL_CONFIG, filter)
    }

    /// Off while asleep, or with all three axes in standby.
    fn setting_of(&self, standby: u8, rate: (u32, u32), config: u8, filter: &'static str) -> Setting {
        let off = self.is_asleep() || self.of(PWR_MGMT_2) & standby == standby;
        let range = self.of(config) >> 3 & 3;
        Setting { rate: (!off).then_some(rate), range, filter: Some(filter) }
    }
}
