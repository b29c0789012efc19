//! Which rate, full scale and filter the registers of an ICM-20948 ask for.

use super::{
    ACCEL_CONFIG, ACCEL_SMPLRT_DIV_1, ACCEL_SMPLRT_DIV_2, At, GYRO_CONFIG_1, GYRO_SMPLRT_DIV, Icm20948,
    PWR_MGMT_2,
};
use crate::chip::Setting;

/// Filters by DLPFCFG, as the data file names them.
const DLPF: [&str; 8] = ["DLPF 0", "DLPF 1", "DLPF 2", "DLPF 3", "DLPF 4", "DLPF 5", "DLPF 6", "DLPF 7"];

impl Icm20948 {
    /// 1.125 kHz divided by 1 to 256, or 9 kHz past the filter (section 10.2, table 16). The note of section 10.1, that the
    /// divider works with DLPFCFG 1 to 6 alone, contradicts that table.
    pub(super) fn gyro_setting(&self) -> Setting {
        let divider = 1 + u32::from(self.of(GYRO_SMPLRT_DIV));
        self.setting_of(0x07, GYRO_CONFIG_1, divider, 9_000)
    }

    /// 1.125 kHz divided by 1 to 4096, or 4.5 kHz past the filter (section 10.15, table 18).
    pub(super) fn accel_setting(&self) -> Setting {
        let divider = u16::from_be_bytes([self.of(ACCEL_SMPLRT_DIV_1) & 0x0f, self.of(ACCEL_SMPLRT_DIV_2)]);
        self.setting_of(0x38, ACCEL_CONFIG, 1 + u32::from(divider), 4_500)
    }

    /// Off while asleep, or with all three axes disabled; the filter is on with FCHOICE, bit 0.
    fn setting_of(&self, disable: u8, config: At, divider: u32, past_hz: u32) -> Setting {
        let off = self.is_asleep() || self.of(PWR_MGMT_2) & disable == disable;
        let config = self.of(config);
        let (rate, filter) = if config & 1 == 0 {
            ((past_hz, 1), "bypass")
        } else {
            ((1_125, divider), DLPF[usize::from(config >> 3 & 7)])
        };
        Setting { rate: (!off).then_some(rate), range: config >> 1 & 3, filter: Some(filter) }
    }
}
