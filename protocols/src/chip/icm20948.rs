//! ICM-20948, with its AK09916.
//!
//! Source: DS-000189 rev 1.3, sections 7 (register map) to 13; the pages are those of the registers' descriptions. The DMP
//! is not there, self-tests deflect nothing, and the factory's trim of the accelerometer's offsets is not known: they are 0
//! at power-on ([`Chip::lacks`] tells what a driver has turned on of that). The level of the FIFO's watermark is a variable
//! of the DMP, so FIFO_WM_INT never comes.
//!
//! ```
//! use ratetable_protocols::chip::{self, Channel, Chip, icm20948::Icm20948};
//!
//! let mut chip = Icm20948::new(0x69);
//! let registers = chip.at(0x69).expect("its address");
//! chip::write(registers, 0, &[0x06, 0x01], false); // PWR_MGMT_1: out of sleep
//! chip::write(registers, 0, &[0x7f, 0x20], false); // bank 2
//! chip::write(registers, 0, &[0x00, 0x04, 0x1b], false); // GYRO_SMPLRT_DIV, GYRO_CONFIG_1: DLPF 3, ±500 °/s
//! let gyro = chip.setting(Channel::Gyro).expect("it has one");
//! assert_eq!((gyro.rate, gyro.range, gyro.filter), (Some((1125, 5)), 1, Some("DLPF 3")));
//! ```

mod fifo_frame;
mod rates;

use super::ak::{self, Ak};
use super::fifo::add;
use super::master::{External, Slave, single};
use super::{Channel, Chip, Fifo, Latest, Registers, Samples, Setting, Tally, shifted, temperature};

/// A register: its bank and its address there.
type At = (u8, u8);

const WHO_AM_I: At = (0, 0x00);
const USER_CTRL: At = (0, 0x03);
const LP_CONFIG: At = (0, 0x05);
const PWR_MGMT_1: At = (0, 0x06);
const PWR_MGMT_2: At = (0, 0x07);
const INT_PIN_CFG: At = (0, 0x0f);
const INT_ENABLE: At = (0, 0x10);
const I2C_MST_STATUS: At = (0, 0x17);
const INT_STATUS: u8 = 0x19;
const INT_STATUS_3: u8 = 0x1c;
const ACCEL_XOUT_H: u8 = 0x2d;
const GYRO_XOUT_H: u8 = 0x33;
const TEMP_OUT_H: u8 = 0x39;
const EXT_SLV_SENS_DATA_00: u8 = 0x3b;
const EXT_SLV_SENS_DATA_23: u8 = 0x52;
const FIFO_EN_1: At = (0, 0x66);
const FIFO_EN_2: At = (0, 0x67);
const FIFO_RST: At = (0, 0x68);
const FIFO_MODE: At = (0, 0x69);
const FIFO_COUNTH: At = (0, 0x70);
const FIFO_COUNTL: At = (0, 0x71);
const FIFO_R_W: At = (0, 0x72);
const DATA_RDY_STATUS: At = (0, 0x74);
const XA_OFFS_H: u8 = 0x14;
const GYRO_SMPLRT_DIV: At = (2, 0x00);
const GYRO_CONFIG_1: At = (2, 0x01);
const GYRO_CONFIG_2: At = (2, 0x02);
const XG_OFFS_USRH: u8 = 0x03;
const ACCEL_SMPLRT_DIV_1: At = (2, 0x10);
const ACCEL_SMPLRT_DIV_2: At = (2, 0x11);
const ACCEL_CONFIG: At = (2, 0x14);
const ACCEL_CONFIG_2: At = (2, 0x15);
const I2C_SLV0_ADDR: u8 = 0x03;
const I2C_SLV4_ADDR: u8 = 0x13;
const I2C_SLV4_CTRL: At = (3, 0x15);
const I2C_SLV4_DI: At = (3, 0x17);
const REG_BANK_SEL: u8 = 0x7f;

const MST_EN: u8 = 0x20;
const SLEEP: u8 = 0x40;
/// Bits of I2C_MST_STATUS.
const SLV4_DONE: u8 = 0x40;
const SLV4_NACK: u8 = 0x10;
/// Which of `status` is INT_STATUS, INT_STATUS_1 and INT_STATUS_2.
const MASTER: usize = 0;
const RAW_DATA: usize = 1;
const OVERFLOW: usize = 2;

/// One at its address.
#[derive(Clone, Debug)]
pub struct Icm20948 {
    address: u8,
    pointer: u8,
    bank: u8,
    registers: [[u8; 128]; 4],
    gyro: Latest,
    accel: Latest,
    celsius: f64,
    /// INT_STATUS, INT_STATUS_1, INT_STATUS_2.
    status: [u8; 3],
    /// DATA_RDY_STATUS.
    ready: u8,
    master_status: u8,
    aux: Ak,
    external: External,
    fifo: Fifo<512>,
    /// The count as it was when FIFO_COUNTH was read.
    count: usize,
}

impl Icm20948 {
    /// One at 0x68 or 0x69.
    pub fn new(address: u8) -> Icm20948 {
        let mut chip = Icm20948 {
            address,
            pointer: 0,
            bank: 0,
            registers: [[0; 128]; 4],
            gyro: Latest::default(),
            accel: Latest::default(),
            celsius: 25.0,
            status: [0; 3],
            ready: 0,
            master_status: 0,
            aux: Ak::ak09916(),
            external: External::default(),
            fifo: Fifo::new(),
            count: 0,
        };
        chip.power_on();
        chip
    }

    /// Every register as the sheet gives its reset value: 0 but for these (sections 8.3, 8.4, 10.2, 10.15).
    fn power_on(&mut self) {
        self.registers = [[0; 128]; 4];
        let values = [(LP_CONFIG, 0x40), (PWR_MGMT_1, 0x41), (GYRO_CONFIG_1, 0x01), (ACCEL_CONFIG, 0x01)];
        values.into_iter().for_each(|(at, value)| self.set(at, value));
        self.bank = 0;
        self.gyro.clear();
        self.accel.clear();
        self.empty_fifo();
        (self.status, self.ready, self.master_status, self.count) = ([0; 3], 0, 0, 0);
    }

    fn of(&self, (bank, register): At) -> u8 {
        self.registers[usize::from(bank & 3)][usize::from(register & 0x7f)]
    }

    fn set(&mut self, (bank, register): At, value: u8) {
        self.registers[usize::from(bank & 3)][usize::from(register & 0x7f)] = value;
    }

    /// (T − 21 °C) · 333.87 (section 3.1, table 3: RoomTemp_Offset is 0).
    fn temperature(&self) -> [u8; 2] {
        temperature(self.celsius, 21.0, 333.87).to_be_bytes()
    }

    /// In sleep mode, or with its clock stopped by CLKSEL 7 (section 8.4).
    fn is_asleep(&self) -> bool {
        self.of(PWR_MGMT_1) & SLEEP != 0 || self.of(PWR_MGMT_1) & 7 == 7
    }

    fn has_master(&self) -> bool {
        self.of(USER_CTRL) & MST_EN != 0 && !self.is_asleep()
    }

    /// Whether the auxiliary bus is joined to the main one (section 8.6, BYPASS_EN).
    fn is_bypassed(&self) -> bool {
        self.of(INT_PIN_CFG) & 0x02 != 0 && self.of(USER_CTRL) & MST_EN == 0
    }

    fn write_user_control(&mut self, t_ns: u64, value: u8) {
        if value & 0x02 != 0 {
            self.external.reset();
        }
        // DMP_RST, SRAM_RST and I2C_MST_RST clear themselves.
        self.set(USER_CTRL, value & !0x0e);
        self.run_alone(t_ns);
    }

    /// What the master does where no sample of the gyro or accelerometer times it: its own rate, I2C_MST_ODR_CONFIG, is
    /// faster than a driver waits, so that it transfers at once.
    fn run_alone(&mut self, t_ns: u64) {
        self.run_slave_4(t_ns);
        if self.gyro_setting().rate.is_none() && self.accel_setting().rate.is_none() {
            self.run_slaves(t_ns);
        }
    }

    /// A transfer of slave 4 that waits to be made, as soon as the master runs.
    fn run_slave_4(&mut self, t_ns: u64) {
        let control = self.of(I2C_SLV4_CTRL);
        if !self.has_master() || control & 0x80 == 0 {
            return;
        }
        let at = |offset| self.of((3, I2C_SLV4_ADDR + offset));
        let slave = Slave { address: at(0), register: at(1), control: 0, out: at(3) };
        self.master_status |= match single(t_ns, slave, Some(&mut self.aux)) {
            Some(byte) if slave.address & 0x80 != 0 => {
                self.set(I2C_SLV4_DI, byte);
                SLV4_DONE
            }
            Some(_) => SLV4_DONE,
            None => SLV4_DONE | SLV4_NACK,
        };
        if control & 0x40 != 0 {
            self.status[MASTER] |= 0x01; // I2C_MST_INT
        }
        self.set(I2C_SLV4_CTRL, control & 0x7f);
    }

    fn slave(&self, i: u8) -> Slave {
        let at = |offset| self.of((3, I2C_SLV0_ADDR + 4 * i + offset));
        Slave { address: at(0), register: at(1), control: at(2), out: at(3) }
    }

    fn run_slaves(&mut self, t_ns: u64) {
        if self.has_master() {
            let slaves = [0, 1, 2, 3].map(|i| self.slave(i));
            let queued = self.fifo_takes_slaves();
            self.master_status |= self.external.run(t_ns, &slaves, queued, Some(&mut self.aux));
        }
    }

    fn words(&self, bank: u8, registers: [u8; 3]) -> [i32; 3] {
        registers.map(|register| {
            i32::from(i16::from_be_bytes([self.of((bank, register)), self.of((bank, register + 1))]))
        })
    }

    /// X_OFFS_USR · 4 / 2^FS_SEL counts (section 10.4).
    fn with_gyro_offset(&self, counts: [i16; 3]) -> [i16; 3] {
        let offsets = self.words(2, [XG_OFFS_USRH, XG_OFFS_USRH + 2, XG_OFFS_USRH + 4]);
        shifted(counts, offsets.map(|offset| (offset * 4) >> (self.of(GYRO_CONFIG_1) >> 1 & 3)))
    }

    /// XA_OFFS: 15 bits above bit 0, which is reserved; 0.98 mg a unit, which is 16 counts at ±2 g (section 9.7).
    fn with_accel_offset(&self, counts: [i16; 3]) -> [i16; 3] {
        let offsets = self.words(1, [XA_OFFS_H, XA_OFFS_H + 3, XA_OFFS_H + 6]);
        shifted(counts, offsets.map(|offset| ((offset >> 1) * 16) >> (self.of(ACCEL_CONFIG) >> 1 & 3)))
    }
}

impl Registers for Icm20948 {
    fn pointer(&mut self) -> &mut u8 {
        &mut self.pointer
    }

    fn write(&mut self, t_ns: u64, register: u8, value: u8) {
        match (self.bank, register) {
            (_, REG_BANK_SEL) => self.bank = value >> 4 & 3,
            PWR_MGMT_1 if value & 0x80 != 0 => self.power_on(),
            PWR_MGMT_1 => {
                self.set(PWR_MGMT_1, value);
                self.run_alone(t_ns);
            }
            USER_CTRL => self.write_user_control(t_ns, value),
            FIFO_R_W => self.push_free(value),
            FIFO_RST => {
                self.set(FIFO_RST, value);
                if self.is_fifo_held() {
                    self.empty_fifo();
                }
            }
            // Read only.
            WHO_AM_I | I2C_MST_STATUS | FIFO_COUNTH | FIFO_COUNTL | DATA_RDY_STATUS | I2C_SLV4_DI => {}
            (0, INT_STATUS..=INT_STATUS_3 | ACCEL_XOUT_H..=EXT_SLV_SENS_DATA_23) => {}
            (3, _) => {
                self.set((3, register), value);
                self.run_alone(t_ns);
            }
            at => self.set(at, value),
        }
    }

    fn read(&mut self, _t_ns: u64, register: u8) -> u8 {
        // INT_ANYRD_2CLEAR clears INT_STATUS alone (section 8.6).
        if self.of(INT_PIN_CFG) & 0x10 != 0 && (self.bank, register) != (0, INT_STATUS) {
            self.status[MASTER] = 0;
        }
        match (self.bank, register) {
            (_, REG_BANK_SEL) => self.bank << 4,
            WHO_AM_I => 0xea,
            I2C_MST_STATUS => core::mem::take(&mut self.master_status),
            (0, INT_STATUS..INT_STATUS_3) => {
                core::mem::take(&mut self.status[usize::from(register - INT_STATUS)])
            }
            (0, INT_STATUS_3) => 0,
            (0, ACCEL_XOUT_H..GYRO_XOUT_H) => self.accel.high_first(register - ACCEL_XOUT_H),
            (0, GYRO_XOUT_H..TEMP_OUT_H) => self.gyro.high_first(register - GYRO_XOUT_H),
            (0, TEMP_OUT_H..EXT_SLV_SENS_DATA_00) => self.temperature()[usize::from(register - TEMP_OUT_H)],
            (0, EXT_SLV_SENS_DATA_00..=EXT_SLV_SENS_DATA_23) => {
                self.external.read(usize::from(register - EXT_SLV_SENS_DATA_00))
            }
            FIFO_COUNTH => {
                self.count = self.fifo.len();
                (self.count >> 8) as u8
            }
            FIFO_COUNTL => self.count as u8,
            FIFO_R_W => self.pop(),
            DATA_RDY_STATUS => core::mem::take(&mut self.ready),
            at => self.of(at),
        }
    }

    fn after(&self, register: u8) -> u8 {
        if (self.bank, register) == FIFO_R_W { register } else { register.wrapping_add(1) & 0x7f }
    }
}

impl Chip for Icm20948 {
    fn at(&mut self, address: u8) -> Option<&mut dyn Registers> {
        match address {
            _ if address == self.address => Some(self),
            ak::ADDRESS if self.is_bypassed() => Some(&mut self.aux),
            _ => None,
        }
    }

    fn setting(&self, channel: Channel) -> Option<Setting> {
        match channel {
            Channel::Gyro => Some(self.gyro_setting()),
            Channel::Accel => Some(self.accel_setting()),
            Channel::Mag => self.aux.setting(channel),
        }
    }

    /// A moment has a frame in the FIFO and is told as ready where the gyro has a sample, or the accelerometer alone is on.
    fn sample(&mut self, t_ns: u64, samples: &Samples) {
        if self.of(PWR_MGMT_1) & 0x08 == 0 {
            self.celsius = samples.temperature_c.unwrap_or(self.celsius); // not TEMP_DIS
        }
        self.aux.sample(t_ns, samples);
        let [gyro_on, accel_on] = [self.gyro_setting(), self.accel_setting()].map(|it| it.rate.is_some());
        let (gyro, accel) = (samples.gyro.filter(|_| gyro_on), samples.accel.filter(|_| accel_on));
        let is_frame = gyro.is_some() || (accel.is_some() && !gyro_on);
        if let Some(counts) = gyro {
            self.gyro.put(self.with_gyro_offset(counts), self.fifo_takes(Channel::Gyro));
        }
        if let Some(counts) = accel {
            self.accel.put(self.with_accel_offset(counts), is_frame && self.fifo_takes(Channel::Accel));
        }
        if is_frame {
            self.run_slaves(t_ns);
            self.push_frame(gyro.is_some(), accel.is_some());
            self.status[RAW_DATA] |= 0x01; // RAW_DATA_0_RDY_INT
            self.ready |= 0x01;
        } else if !gyro_on && !accel_on && samples.mag.is_some() {
            self.run_slaves(t_ns);
        }
    }

    fn tally(&self, channel: Channel) -> Tally {
        match channel {
            Channel::Gyro => self.gyro.tally,
            Channel::Accel => self.accel.tally,
            Channel::Mag => self.external.tally(self.aux.tally(channel)),
        }
    }

    fn interrupt(&self) -> bool {
        let (bank, enable) = INT_ENABLE;
        (enable..).zip(self.status).any(|(register, status)| self.of((bank, register)) & status != 0)
    }

    fn lacks(&self) -> Option<&'static str> {
        if self.of(USER_CTRL) & 0x80 != 0 {
            Some("the DMP (USER_CTRL bit 7): there is neither its memory nor what it computes")
        } else if self.of(GYRO_CONFIG_2) & 0x38 != 0 || self.of(ACCEL_CONFIG_2) & 0x1c != 0 {
            Some("self-test (GYRO_CONFIG_2 bits 5:3, ACCEL_CONFIG_2 bits 4:2): nothing deflects the readings")
        } else if self.of(LP_CONFIG) & 0x30 != 0 {
            Some("duty cycles (LP_CONFIG bits 5:4): its filters are those of low-noise mode")
        } else if self.of(USER_CTRL) & 0x10 != 0 {
            Some("the I²C interface turned off (USER_CTRL bit 4): it still answers")
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests;
