//! MPU-6000, MPU-6050, MPU-6500 and MPU-9250, the last with its AK8963.
//!
//! Sources: RM-MPU-6000A-00 r4.2, RM-MPU-6500A-00 r2.1, RM-MPU-9250A-00 r1.6. The DMP is memory that can be written and read
//! back, not a processor; self-tests and low-power cycles change nothing that is measured ([`Chip::lacks`] tells of them).
//! Offsets are 0 at power-on: the factory's trim is not known.
//!
//! ```
//! use ratetable_protocols::chip::{self, Channel, Chip, mpu::Mpu};
//!
//! let mut chip = Mpu::mpu9250(0x68, [128; 3]);
//! let registers = chip.at(0x68).expect("its address");
//! chip::write(registers, 0, &[0x1a, 0x03], false); // CONFIG: DLPF 3
//! chip::write(registers, 0, &[0x19, 0x04], false); // SMPLRT_DIV
//! chip::write(registers, 0, &[0x1b, 0x08], false); // GYRO_CONFIG: ±500 °/s
//! let gyro = chip.setting(Channel::Gyro).expect("it has one");
//! assert_eq!((gyro.rate, gyro.range, gyro.filter), (Some((1000, 5)), 1, Some("DLPF 3")));
//! ```

mod fifo_frame;
mod rates;

use super::ak::{self, Ak};
use super::fifo::add;
use super::master::{External, Slave, single};
use super::{Channel, Chip, Fifo, Latest, Registers, Samples, Setting, Tally, shifted, temperature};
use crate::mpu::registers::Chip as Family;

pub(super) const SMPLRT_DIV: u8 = 0x19;
const CONFIG: u8 = 0x1a;
const GYRO_CONFIG: u8 = 0x1b;
const ACCEL_CONFIG: u8 = 0x1c;
const ACCEL_CONFIG_2: u8 = 0x1d;
const FIFO_EN: u8 = 0x23;
const I2C_SLV0_ADDR: u8 = 0x25;
const I2C_SLV4_ADDR: u8 = 0x31;
const I2C_SLV4_CTRL: u8 = 0x34;
const I2C_SLV4_DI: u8 = 0x35;
const I2C_MST_STATUS: u8 = 0x36;
const INT_PIN_CFG: u8 = 0x37;
const INT_ENABLE: u8 = 0x38;
const INT_STATUS: u8 = 0x3a;
const ACCEL_XOUT_H: u8 = 0x3b;
const TEMP_OUT_H: u8 = 0x41;
const GYRO_XOUT_H: u8 = 0x43;
const EXT_SENS_DATA_00: u8 = 0x49;
const EXT_SENS_DATA_23: u8 = 0x60;
const I2C_SLV0_DO: u8 = 0x63;
const SIGNAL_PATH_RESET: u8 = 0x68;
const USER_CTRL: u8 = 0x6a;
const PWR_MGMT_1: u8 = 0x6b;
const PWR_MGMT_2: u8 = 0x6c;
const DMP_BANK: u8 = 0x6d;
const DMP_ADDRESS: u8 = 0x6e;
const DMP_MEMORY: u8 = 0x6f;
const FIFO_COUNT_H: u8 = 0x72;
const FIFO_COUNT_L: u8 = 0x73;
const FIFO_R_W: u8 = 0x74;
const WHO_AM_I: u8 = 0x75;

const DATA_READY: u8 = 0x01;
const FIFO_OVERFLOW: u8 = 0x10;
const SLV4_DONE: u8 = 0x40;
const SLV4_NACK: u8 = 0x10;
const MST_EN: u8 = 0x20;
const SLEEP: u8 = 0x40;

/// Which of the family.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Model {
    Mpu60x0,
    Mpu6500,
    Mpu9250,
}

/// One of the family at its address.
#[derive(Clone, Debug)]
pub struct Mpu {
    model: Model,
    address: u8,
    pointer: u8,
    registers: [u8; 128],
    gyro: Latest,
    accel: Latest,
    celsius: f64,
    status: u8,
    master_status: u8,
    aux: Option<Ak>,
    external: External,
    /// Whether the accelerometer has taken a sample since the last that entered the FIFO.
    accel_is_new: bool,
    fifo: Fifo<1024>,
    /// The last byte that left the FIFO: what an empty one reads.
    last: u8,
    memory: [u8; 4096],
}

impl Mpu {
    /// An MPU-6050 or MPU-6000 at 0x68 or 0x69.
    pub fn mpu6050(address: u8) -> Mpu {
        Mpu::new(Model::Mpu60x0, address, None)
    }

    /// An MPU-6500 at 0x68 or 0x69.
    pub fn mpu6500(address: u8) -> Mpu {
        Mpu::new(Model::Mpu6500, address, None)
    }

    /// An MPU-9250 at 0x68 or 0x69, with an AK8963 of this sensitivity adjustment (ASAX, ASAY, ASAZ).
    pub fn mpu9250(address: u8, asa: [u8; 3]) -> Mpu {
        Mpu::new(Model::Mpu9250, address, Some(Ak::ak8963(asa)))
    }

    fn new(model: Model, address: u8, aux: Option<Ak>) -> Mpu {
        let mut chip = Mpu {
            model,
            address,
            pointer: 0,
            registers: [0; 128],
            gyro: Latest::default(),
            accel: Latest::default(),
            celsius: 25.0,
            status: 0,
            master_status: 0,
            aux,
            external: External::default(),
            accel_is_new: false,
            fifo: Fifo::new(),
            last: 0,
            memory: [0; 4096],
        };
        chip.power_on();
        chip
    }

    /// Every register as the sheet gives its reset value (RM-MPU-6000A p. 9, RM-MPU-6500A p. 6, RM-MPU-9250A p. 7).
    fn power_on(&mut self) {
        self.registers = [0; 128];
        self.registers[usize::from(PWR_MGMT_1)] = if self.model == Model::Mpu9250 { 0x01 } else { SLEEP };
        self.reset_signals();
        self.empty_fifo();
        self.celsius = 25.0;
        (self.status, self.master_status) = (0, 0);
    }

    const fn of(&self, register: u8) -> u8 {
        self.registers[register as usize & 0x7f]
    }

    fn set(&mut self, register: u8, value: u8) {
        self.registers[usize::from(register & 0x7f)] = value;
    }

    const fn family(&self) -> Family {
        if matches!(self.model, Model::Mpu60x0) { Family::Mpu60x0 } else { Family::Mpu9250 }
    }

    fn temperature(&self) -> [u8; 2] {
        let (zero, per_c) = if self.model == Model::Mpu60x0 { (36.53, 340.0) } else { (21.0, 333.87) };
        temperature(self.celsius, zero, per_c).to_be_bytes()
    }

    fn is_asleep(&self) -> bool {
        self.of(PWR_MGMT_1) & SLEEP != 0
    }

    /// Whether the auxiliary bus is joined to the main one.
    fn is_bypassed(&self) -> bool {
        self.of(INT_PIN_CFG) & 0x02 != 0 && self.of(USER_CTRL) & MST_EN == 0
    }

    fn write_user_control(&mut self, t_ns: u64, value: u8) {
        if value & 0x04 != 0 {
            self.empty_fifo();
        }
        if value & 0x02 != 0 {
            self.external.reset();
        }
        if value & 0x01 != 0 {
            self.reset_signals();
        }
        self.set(USER_CTRL, value & !0x07);
        self.run_slave_4(t_ns);
    }

    /// As SIG_COND_RST does: data registers and signal paths.
    fn reset_signals(&mut self) {
        self.gyro.clear();
        self.accel.clear();
        self.accel.tally.missed += u64::from(core::mem::take(&mut self.accel_is_new));
    }

    /// A transfer of slave 4 that waits to be made, as soon as the master runs.
    fn run_slave_4(&mut self, t_ns: u64) {
        let runs = self.of(USER_CTRL) & MST_EN != 0 && !self.is_asleep();
        if !runs || self.of(I2C_SLV4_CTRL) & 0x80 == 0 {
            return;
        }
        let at = |offset| self.of(I2C_SLV4_ADDR + offset);
        let slave = Slave { address: at(0), register: at(1), control: 0, out: at(2) };
        self.master_status |= match single(t_ns, slave, self.aux.as_mut()) {
            Some(byte) if slave.address & 0x80 != 0 => {
                self.set(I2C_SLV4_DI, byte);
                SLV4_DONE
            }
            Some(_) => SLV4_DONE,
            None => SLV4_DONE | SLV4_NACK,
        };
        self.set(I2C_SLV4_CTRL, self.of(I2C_SLV4_CTRL) & 0x7f);
    }

    fn run_slaves(&mut self, t_ns: u64) {
        if self.of(USER_CTRL) & MST_EN == 0 {
            return;
        }
        let slave = |i: u8| {
            let at = |offset| self.of(I2C_SLV0_ADDR + 3 * i + offset);
            Slave { address: at(0), register: at(1), control: at(2), out: self.of(I2C_SLV0_DO + i) }
        };
        let slaves = [0, 1, 2, 3].map(slave);
        let queued = if self.fifo_takes(Channel::Mag) { 0x0f } else { 0 };
        self.master_status |= self.external.run(t_ns, &slaves, queued, self.aux.as_mut());
    }

    /// A sample's counts with the driver's offset: `step` counts at the smallest full scale a unit of the register.
    fn with_offset(counts: [i16; 3], offsets: [i16; 3], step: i32, range: u8) -> [i16; 3] {
        shifted(counts, offsets.map(|offset| (i32::from(offset) * step) >> range))
    }

    fn word(&self, register: u8) -> i16 {
        i16::from_be_bytes([self.of(register), self.of(register + 1)])
    }

    /// XG_OFFS_USR: 32.8 counts a deg/s, which is four counts at ±250 °/s (RM-MPU-6500A p. 10).
    fn with_gyro_offset(&self, counts: [i16; 3]) -> [i16; 3] {
        let offsets = [0x13, 0x15, 0x17].map(|register| self.word(register));
        Mpu::with_offset(counts, offsets, 4, self.of(GYRO_CONFIG) >> 3 & 3)
    }

    /// XA_OFFS: 2048 counts a g of an MPU-6050, 1024 of the others, bit 0 reserved (RM-MPU-6500A p. 46).
    fn with_accel_offset(&self, counts: [i16; 3]) -> [i16; 3] {
        let range = self.of(ACCEL_CONFIG) >> 3 & 3;
        match self.model {
            Model::Mpu60x0 => Mpu::with_offset(
                counts,
                [0x06, 0x08, 0x0a].map(|register| self.word(register) & !1),
                8,
                range,
            ),
            _ => Mpu::with_offset(
                counts,
                [0x77, 0x7a, 0x7d].map(|register| self.word(register) >> 1),
                16,
                range,
            ),
        }
    }

    fn dmp_byte(&mut self) -> &mut u8 {
        let at = usize::from(self.of(DMP_BANK) & 0x0f) << 8 | usize::from(self.of(DMP_ADDRESS));
        self.set(DMP_ADDRESS, self.of(DMP_ADDRESS).wrapping_add(1));
        &mut self.memory[at]
    }
}

impl Registers for Mpu {
    fn pointer(&mut self) -> &mut u8 {
        &mut self.pointer
    }

    fn write(&mut self, t_ns: u64, register: u8, value: u8) {
        match register {
            PWR_MGMT_1 if value & 0x80 != 0 => self.power_on(),
            PWR_MGMT_1 => {
                self.set(PWR_MGMT_1, value);
                self.run_slave_4(t_ns);
            }
            USER_CTRL => self.write_user_control(t_ns, value),
            SIGNAL_PATH_RESET if value & 0x07 != 0 => self.reset_signals(),
            I2C_SLV4_CTRL => {
                self.set(register, value);
                self.run_slave_4(t_ns);
            }
            DMP_MEMORY => *self.dmp_byte() = value,
            FIFO_R_W => self.push_free(value),
            // Read only.
            I2C_SLV4_DI | I2C_MST_STATUS | INT_STATUS | ACCEL_XOUT_H..=EXT_SENS_DATA_23 => {}
            FIFO_COUNT_H | FIFO_COUNT_L | WHO_AM_I => {}
            _ => self.set(register, value),
        }
    }

    fn read(&mut self, _t_ns: u64, register: u8) -> u8 {
        if self.of(INT_PIN_CFG) & 0x10 != 0 && register != INT_STATUS {
            self.status = 0; // INT_ANYRD_2CLEAR
        }
        match register {
            WHO_AM_I => match self.model {
                Model::Mpu6500 => 0x70,
                _ => self.family().who_am_i(),
            },
            INT_STATUS => core::mem::take(&mut self.status),
            I2C_MST_STATUS => core::mem::take(&mut self.master_status),
            ACCEL_XOUT_H..TEMP_OUT_H => self.accel.high_first(register - ACCEL_XOUT_H),
            TEMP_OUT_H..GYRO_XOUT_H => self.temperature()[usize::from(register - TEMP_OUT_H)],
            GYRO_XOUT_H..EXT_SENS_DATA_00 => self.gyro.high_first(register - GYRO_XOUT_H),
            EXT_SENS_DATA_00..=EXT_SENS_DATA_23 => {
                self.external.read(usize::from(register - EXT_SENS_DATA_00))
            }
            FIFO_COUNT_H => (self.fifo.len() >> 8) as u8,
            FIFO_COUNT_L => self.fifo.len() as u8,
            FIFO_R_W => self.pop(),
            DMP_MEMORY => *self.dmp_byte(),
            _ => self.of(register),
        }
    }

    fn after(&self, register: u8) -> u8 {
        match register {
            FIFO_R_W | DMP_MEMORY => register,
            _ => register.wrapping_add(1) & 0x7f,
        }
    }
}

impl Chip for Mpu {
    fn at(&mut self, address: u8) -> Option<&mut dyn Registers> {
        if address == self.address {
            return Some(self);
        }
        let is_open = self.is_bypassed() && address == ak::ADDRESS;
        self.aux.as_mut().filter(|_| is_open).map(|aux| aux as &mut dyn Registers)
    }

    fn setting(&self, channel: Channel) -> Option<Setting> {
        match channel {
            Channel::Gyro => Some(self.gyro_setting()),
            Channel::Accel => Some(self.accel_setting()),
            Channel::Mag => self.aux.as_ref()?.setting(channel),
        }
    }

    fn sample(&mut self, t_ns: u64, samples: &Samples) {
        self.celsius = samples.temperature_c.unwrap_or(self.celsius);
        if let Some(aux) = &mut self.aux {
            aux.sample(t_ns, samples);
        }
        let [gyro_on, accel_on] = [self.gyro_setting(), self.accel_setting()].map(|it| it.rate.is_some());
        let (gyro, accel) = (samples.gyro.filter(|_| gyro_on), samples.accel.filter(|_| accel_on));
        let is_frame = gyro.is_some() || (accel.is_some() && !gyro_on);
        if let Some(counts) = gyro {
            self.gyro.put(self.with_gyro_offset(counts), self.fifo_takes(Channel::Gyro));
        }
        if let Some(counts) = accel {
            let queued = self.fifo_takes(Channel::Accel);
            // One that a newer one replaces before the gyro's next sample enters no FIFO.
            self.accel.tally.missed += u64::from(self.accel_is_new);
            self.accel.put(self.with_accel_offset(counts), queued);
            self.accel_is_new = queued;
        }
        if is_frame {
            self.run_slaves(t_ns);
            let with_accel = core::mem::take(&mut self.accel_is_new);
            self.push_frame(gyro.is_some(), with_accel);
            self.status |= DATA_READY;
        }
    }

    fn tally(&self, channel: Channel) -> Tally {
        match channel {
            Channel::Gyro => self.gyro.tally,
            Channel::Accel => self.accel.tally,
            Channel::Mag => {
                self.external.tally(self.aux.as_ref().map_or(Tally::default(), |aux| aux.tally(channel)))
            }
        }
    }

    fn interrupt(&self) -> bool {
        self.status & self.of(INT_ENABLE) != 0
    }

    fn lacks(&self) -> Option<&'static str> {
        let tests = self.of(GYRO_CONFIG) & 0xe0 | self.of(ACCEL_CONFIG) & 0xe0;
        if self.of(USER_CTRL) & 0x80 != 0 {
            Some(
                "the DMP (USER_CTRL bit 7): its memory can be written and read back, but it computes nothing",
            )
        } else if tests != 0 {
            Some("self-test (bits 7:5 of GYRO_CONFIG and ACCEL_CONFIG): nothing deflects the readings")
        } else if self.of(PWR_MGMT_1) & 0x20 != 0 {
            Some("low-power cycles (PWR_MGMT_1 bit 5): it samples at its full rate")
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests;
