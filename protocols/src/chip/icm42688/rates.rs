//! Which rate, full scale and filter the registers of an ICM-42688-P ask for.

use super::{
    ACCEL_CONFIG0, FIFO_CONFIG1, GYRO_ACCEL_CONFIG0, GYRO_CONFIG0, INTF_CONFIG1, Icm42688, PWR_MGMT0,
};
use crate::chip::Setting;

/// Filters by GYRO_UI_FILT_BW and ACCEL_UI_FILT_BW, as the data file names them; 8 to 13 are reserved.
const BW: [Option<&str>; 16] = [
    Some("BW 0"),
    Some("BW 1"),
    Some("BW 2"),
    Some("BW 3"),
    Some("BW 4"),
    Some("BW 5"),
    Some("BW 6"),
    Some("BW 7"),
    None,
    None,
    None,
    None,
    None,
    None,
    Some("BW 14"),
    Some("BW 15"),
];

/// Samples a second by GYRO_ODR and ACCEL_ODR (section 5.6).
const fn rate(odr: u8) -> Option<(u32, u32)> {
    match odr {
        1..=6 => Some((64_000 >> odr, 1)),
        7 => Some((200, 1)),
        8 => Some((100, 1)),
        9 => Some((50, 1)),
        10 => Some((25, 1)),
        11..=14 => Some((25, 1 << (odr - 10))),
        15 => Some((500, 1)),
        _ => None,
    }
}

impl Icm42688 {
    /// The gyro samples in low-noise mode alone (section 14.36). A reserved rate gives none.
    pub(super) fn gyro_setting(&self) -> Setting {
        let config = self.of(GYRO_CONFIG0);
        let odr = config & 0x0f;
        let on = self.has_clock() && self.of(PWR_MGMT0) >> 2 & 3 == 3 && !matches!(odr, 12..=14);
        let range = if self.is_wide() { 7 } else { 7 - (config >> 5) };
        let filter = filter(odr, self.of(GYRO_ACCEL_CONFIG0) & 0x0f);
        Setting { rate: rate(odr).filter(|_| on), range, filter }
    }

    /// Low-noise mode has 12.5 Hz and more, low-power mode 500 Hz and less and no filter to choose but an average
    /// (sections 14.36, 14.38, 14.40). Assumed: a rate that the mode has not gives none, a reserved range ±2 g.
    pub(super) fn accel_setting(&self) -> Setting {
        let config = self.of(ACCEL_CONFIG0);
        let odr = config & 0x0f;
        let (on, filter) = match self.of(PWR_MGMT0) & 3 {
            3 => (!matches!(odr, 12..=14), filter(odr, self.of(GYRO_ACCEL_CONFIG0) >> 4)),
            2 => (odr >= 7, None),
            _ => (false, filter(odr, self.of(GYRO_ACCEL_CONFIG0) >> 4)),
        };
        let range = if self.is_wide() { 3 } else { 3 - (config >> 5).min(3) };
        Setting { rate: rate(odr).filter(|_| on && self.has_clock()), range, filter }
    }

    /// CLKSEL 3 stops every clock (section 14.35).
    fn has_clock(&self) -> bool {
        self.of(INTF_CONFIG1) & 3 != 3
    }

    /// With packets of 20 bits the full scales are ±2000 deg/s and ±16 g, whatever is selected (section 6.1).
    fn is_wide(&self) -> bool {
        self.of(FIFO_CONFIG1) & 0x10 != 0
    }
}

/// From 2 kHz on there is one filter for each rate (section 5.5).
const fn filter(odr: u8, bandwidth: u8) -> Option<&'static str> {
    if matches!(odr, 1..=5) { Some("fixed") } else { BW[bandwidth as usize & 0x0f] }
}
