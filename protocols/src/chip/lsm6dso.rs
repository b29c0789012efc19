//! LSM6DSO.
//!
//! Sources: DS12140 and AN5192; meanings and reset values of registers were checked against its maker's driver and those of
//! its sister LSM6DSO32. The pages of embedded functions and of the sensor hub are
//! memory that can be written and read back. Power modes do not change filters, the first samples after a change of rate are
//! as good as the rest, and a read never waits for a block to be whole. Self-tests, high-pass filters, compression and the
//! FIFO modes that wait for an event change nothing ([`Chip::lacks`] tells of them).
//!
//! ```
//! use ratetable_protocols::chip::{self, Channel, Chip, lsm6dso::Lsm6dso};
//!
//! let mut chip = Lsm6dso::new(0x6a);
//! let registers = chip.at(0x6a).expect("its address");
//! chip::write(registers, 0, &[0x11, 0x64], false); // CTRL2_G: 416 Hz, ±500 °/s
//! chip::write(registers, 0, &[0x10, 0x12], false); // CTRL1_XL: 12.5 Hz, ±2 g, LPF2
//! let [gyro, accel] = [Channel::Gyro, Channel::Accel].map(|channel| chip.setting(channel).expect("it has it"));
//! assert_eq!((gyro.rate, gyro.range, gyro.filter), (Some((416, 1)), 2, Some("LPF2")));
//! assert_eq!((accel.rate, accel.range, accel.filter), (Some((25, 2)), 0, Some("LPF2 ODR/4")));
//! ```

mod fifo_words;
mod settings;

use super::{Channel, Chip, Latest, Registers, Samples, Setting, Tally, taken, temperature};
use fifo_words::Words;

const FUNC_CFG_ACCESS: u8 = 0x01;
const PIN_CTRL: u8 = 0x02;
const FIFO_CTRL1: u8 = 0x07;
const FIFO_CTRL2: u8 = 0x08;
const FIFO_CTRL3: u8 = 0x09;
const FIFO_CTRL4: u8 = 0x0a;
const COUNTER_BDR_REG1: u8 = 0x0b;
const COUNTER_BDR_REG2: u8 = 0x0c;
const INT1_CTRL: u8 = 0x0d;
const INT2_CTRL: u8 = 0x0e;
const WHO_AM_I: u8 = 0x0f;
const CTRL1_XL: u8 = 0x10;
const CTRL2_G: u8 = 0x11;
const CTRL3_C: u8 = 0x12;
const CTRL4_C: u8 = 0x13;
const CTRL5_C: u8 = 0x14;
const CTRL6_C: u8 = 0x15;
const CTRL7_G: u8 = 0x16;
const CTRL8_XL: u8 = 0x17;
const CTRL9_XL: u8 = 0x18;
const CTRL10_C: u8 = 0x19;
/// Of what can only be read, the first and the last.
const ALL_INT_SRC: u8 = 0x1a;
const STATUS_REG: u8 = 0x1e;
const OUT_TEMP_L: u8 = 0x20;
const OUTX_L_G: u8 = 0x22;
const OUTX_L_A: u8 = 0x28;
const OUTZ_H_A: u8 = 0x2d;
const FIFO_STATUS1: u8 = 0x3a;
const FIFO_STATUS2: u8 = 0x3b;
const TIMESTAMP0: u8 = 0x40;
const TIMESTAMP2: u8 = 0x42;
const TIMESTAMP3: u8 = 0x43;
const X_OFS_USR: u8 = 0x73;
const FIFO_DATA_OUT_TAG: u8 = 0x78;
const FIFO_DATA_OUT_Z_H: u8 = 0x7e;

/// Bits of STATUS_REG.
const XLDA: u8 = 0x01;
const GDA: u8 = 0x02;
const TDA: u8 = 0x04;
/// Compression at run time (FIFO_CTRL2), and FIFO_COMPR_EN of EMB_FUNC_EN_B on the embedded functions' page.
const COMPRESSES: u8 = 0x40;
const EMB_FUNC_EN_B: u8 = 0x05;

/// An LSM6DSO at its address.
#[derive(Clone, Debug)]
pub struct Lsm6dso {
    address: u8,
    pointer: u8,
    registers: [u8; 128],
    /// The pages of embedded functions and of the sensor hub.
    pages: [[u8; 128]; 2],
    gyro: Latest,
    accel: Latest,
    celsius: f64,
    status: u8,
    words: Words,
    /// When its timestamp was 0, ns.
    zero_ns: u64,
}

impl Lsm6dso {
    /// One at 0x6A or 0x6B.
    pub fn new(address: u8) -> Lsm6dso {
        let mut chip = Lsm6dso {
            address,
            pointer: 0,
            registers: [0; 128],
            pages: [[0; 128]; 2],
            gyro: Latest::default(),
            accel: Latest::default(),
            celsius: 25.0,
            status: 0,
            words: Words::new(),
            zero_ns: 0,
        };
        chip.reset();
        chip
    }

    /// Every register as the sheet's map gives it: both sensors off, addresses count up.
    fn reset(&mut self) {
        self.registers = [0; 128];
        self.pages = [[0; 128]; 2];
        for (register, value) in [(PIN_CTRL, 0x3f), (CTRL3_C, 0x04), (CTRL9_XL, 0xe0)] {
            self.set(register, value);
        }
        self.empty_fifo();
        self.gyro.clear();
        self.accel.clear();
        self.status = 0;
    }

    const fn of(&self, register: u8) -> u8 {
        self.registers[register as usize & 0x7f]
    }

    fn set(&mut self, register: u8, value: u8) {
        self.registers[usize::from(register & 0x7f)] = value;
    }

    /// Which other page is open: FUNC_CFG_ACCESS, which is on every page.
    const fn page(&self, register: u8) -> Option<usize> {
        match self.of(FUNC_CFG_ACCESS) & 0xc0 {
            _ if register == FUNC_CFG_ACCESS => None,
            0x80 => Some(0),
            0x40 => Some(1),
            _ => None,
        }
    }

    /// 25 µs a unit while TIMESTAMP_EN is set (register 0x40).
    fn timestamp(&self, t_ns: u64) -> [u8; 4] {
        let is_on = self.of(CTRL10_C) & 0x20 != 0;
        let units = t_ns.saturating_sub(self.zero_ns) / 25_000;
        (if is_on { units as u32 } else { 0 }).to_le_bytes()
    }

    /// 256 a °C, 0 is 25 °C (DS12140, temperature sensor characteristics).
    fn thermometer(&self) -> [u8; 2] {
        temperature(self.celsius, 25.0, 256.0).to_le_bytes()
    }

    /// CTRL3_C: BOOT and SW_RESET clear themselves.
    fn control(&mut self, value: u8) {
        if value & 0x01 != 0 {
            self.reset();
        } else {
            self.set(CTRL3_C, value & 0x7e);
        }
    }

    fn write_main(&mut self, t_ns: u64, register: u8, value: u8) {
        match register {
            CTRL3_C => self.control(value),
            FIFO_CTRL4 => {
                self.set(register, value);
                if !self.fifo_runs() {
                    self.empty_fifo();
                }
            }
            COUNTER_BDR_REG1 => {
                if value & 0x40 != 0 {
                    self.words.batches = 0;
                }
                self.set(register, value & !0x40);
            }
            CTRL10_C => {
                if value & 0x20 != 0 && self.of(CTRL10_C) & 0x20 == 0 {
                    self.zero_ns = t_ns;
                }
                self.set(register, value);
            }
            TIMESTAMP2 if value == 0xaa => self.zero_ns = t_ns,
            // Read only.
            WHO_AM_I | ALL_INT_SRC..=TIMESTAMP3 | FIFO_DATA_OUT_TAG..=u8::MAX => {}
            _ => self.set(register, value),
        }
    }

    fn read_main(&mut self, t_ns: u64, register: u8) -> u8 {
        match register {
            WHO_AM_I => 0x6c,
            STATUS_REG => self.status,
            OUT_TEMP_L..OUTX_L_G => {
                self.clear_on_high(register, TDA);
                self.thermometer()[usize::from(register - OUT_TEMP_L)]
            }
            OUTX_L_G..OUTX_L_A => {
                self.clear_on_high(register, GDA);
                self.gyro.low_first(register - OUTX_L_G)
            }
            OUTX_L_A..=OUTZ_H_A => {
                self.clear_on_high(register, XLDA);
                self.accel.low_first(register - OUTX_L_A)
            }
            FIFO_STATUS1 => self.words.len() as u8,
            FIFO_STATUS2 => {
                let status = self.fifo_status();
                self.words.overrun_latched = false;
                status
            }
            COUNTER_BDR_REG1 | COUNTER_BDR_REG2 => {
                self.words.counter_reached = false;
                self.of(register)
            }
            TIMESTAMP0..=TIMESTAMP3 => self.timestamp(t_ns)[usize::from(register - TIMESTAMP0)],
            FIFO_DATA_OUT_TAG..=FIFO_DATA_OUT_Z_H => self.read_word(register - FIFO_DATA_OUT_TAG),
            _ => self.of(register),
        }
    }

    /// Data is no longer new when one of its high bytes, at odd addresses, is read (AN5192, using the status register).
    fn clear_on_high(&mut self, register: u8, bit: u8) {
        if register & 1 == 1 {
            self.status &= !bit;
        }
    }

    /// What INT1_CTRL and INT2_CTRL can route, bit by bit.
    fn sources(&self) -> u8 {
        let fifo = self.fifo_status();
        let drdy = self.status & (XLDA | GDA);
        drdy | fifo >> 4 & 0x08 | fifo >> 2 & 0x10 | fifo & 0x20 | fifo << 2 & 0x40
    }
}

impl Registers for Lsm6dso {
    fn pointer(&mut self) -> &mut u8 {
        &mut self.pointer
    }

    fn write(&mut self, t_ns: u64, register: u8, value: u8) {
        match self.page(register) {
            Some(page) => self.pages[page][usize::from(register & 0x7f)] = value,
            None => self.write_main(t_ns, register, value),
        }
    }

    fn read(&mut self, t_ns: u64, register: u8) -> u8 {
        match self.page(register) {
            Some(page) => self.pages[page][usize::from(register & 0x7f)],
            None => self.read_main(t_ns, register),
        }
    }

    /// IF_INC counts up; the FIFO's word goes round (section 6.5.7), and so do outputs with ROUNDING (CTRL5_C).
    fn after(&self, register: u8) -> u8 {
        if self.of(CTRL3_C) & 0x04 == 0 {
            return register;
        }
        let next = register.wrapping_add(1) & 0x7f;
        if self.page(register).is_some() {
            return next;
        }
        match (register, self.of(CTRL5_C) >> 5 & 3) {
            (FIFO_DATA_OUT_Z_H, _) => FIFO_DATA_OUT_TAG,
            (OUTZ_H_A, 1) => OUTX_L_A,
            (0x27, 2) | (OUTZ_H_A, 3) => OUTX_L_G,
            _ => next,
        }
    }
}

impl Chip for Lsm6dso {
    fn at(&mut self, address: u8) -> Option<&mut dyn Registers> {
        (address == self.address).then_some(self as &mut dyn Registers)
    }

    fn setting(&self, channel: Channel) -> Option<Setting> {
        match channel {
            Channel::Gyro => Some(self.gyro_setting()),
            Channel::Accel => Some(self.accel_setting()),
            Channel::Mag => None,
        }
    }

    fn sample(&mut self, t_ns: u64, samples: &Samples) {
        self.celsius = samples.temperature_c.unwrap_or(self.celsius);
        let [gyro, accel] = taken(self, samples);
        let accel = accel.map(|counts| self.with_offset(counts));
        if gyro.is_none() && accel.is_none() {
            return;
        }
        let batched = [gyro.is_some() && self.batches_gyro(), accel.is_some() && self.batches_accel()];
        if let Some(counts) = gyro {
            self.gyro.put(counts, batched[0]);
            self.status |= GDA;
        }
        if let Some(counts) = accel {
            self.accel.put(counts, batched[1]);
            self.status |= XLDA;
        }
        self.status |= TDA;
        self.batch(t_ns, batched);
    }

    fn tally(&self, channel: Channel) -> Tally {
        match channel {
            Channel::Gyro => self.gyro.tally,
            Channel::Accel => self.accel.tally,
            Channel::Mag => Tally::default(),
        }
    }

    /// INT1; with INT2_on_INT1 (CTRL4_C bit 5) what is routed to INT2 as well.
    fn interrupt(&self) -> bool {
        let second = if self.of(CTRL4_C) & 0x20 != 0 { self.of(INT2_CTRL) & 0x7b } else { 0 };
        (self.of(INT1_CTRL) & 0x7b | second) & self.sources() != 0
    }

    fn lacks(&self) -> Option<&'static str> {
        let compresses = self.of(FIFO_CTRL2) & COMPRESSES != 0;
        if self.of(CTRL5_C) & 0x0f != 0 {
            Some("self-test (CTRL5_C bits 3:0): nothing deflects the readings")
        } else if self.of(CTRL7_G) & 0x40 != 0 || self.of(CTRL8_XL) & 0x04 != 0 {
            Some("high-pass filters (HP_EN_G, HP_SLOPE_XL_EN): readings keep what does not change")
        } else if compresses && self.pages[0][usize::from(EMB_FUNC_EN_B)] & 0x08 != 0 {
            Some("compression (FIFO_COMPR_EN): the FIFO's words are whole samples")
        } else if matches!(self.of(FIFO_CTRL4) & 7, 3 | 4 | 7) {
            Some("FIFO modes 3, 4 and 7 (FIFO_CTRL4), which wait for an event: none comes")
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests;
