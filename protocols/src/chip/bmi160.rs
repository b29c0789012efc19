//! BMI160.
//!
//! Source: BST-BMI160-DS000, section 2.11 for registers; commands, interrupts, offsets and reset values were checked against
//! its maker's driver, not the sheet (assumed where the driver says nothing). A power mode changes at once. A command that is not known does
//! nothing. No magnetometer is attached to the secondary interface. Motion and step detection are registers that can be
//! written and read back and never fire. Self-test, compensation on the chip and averages change nothing that is measured
//! ([`Chip::lacks`] tells of them).
//!
//! ```
//! use ratetable_protocols::chip::{self, Channel, Chip, bmi160::Bmi160};
//!
//! let mut chip = Bmi160::new(0x69);
//! let registers = chip.at(0x69).expect("its address");
//! chip::write(registers, 0, &[0x7e, 0x15], false); // CMD: gyro to normal mode
//! chip::write(registers, 0, &[0x42, 0x1a], false); // GYR_CONF: 400 Hz, OSR2
//! chip::write(registers, 0, &[0x43, 0x02], false); // GYR_RANGE: ±500 °/s
//! let gyro = chip.setting(Channel::Gyro).expect("it has one");
//! assert_eq!((gyro.rate, gyro.range, gyro.filter), (Some((400, 1)), 2, Some("OSR2")));
//! ```

use super::bosch::{Queue, Sensors, filter, gyro_offsets, gyro_range, rate, sensor_time, setting, shifted};
use super::{Channel, Chip, Registers, Samples, Setting, Tally, taken, temperature};

const CHIP_ID: u8 = 0x00;
const PMU_STATUS: u8 = 0x03;
const DATA_GYR: u8 = 0x0c;
const DATA_ACC: u8 = 0x12;
const SENSORTIME: u8 = 0x18;
const STATUS: u8 = 0x1b;
const INT_STATUS_0: u8 = 0x1c;
const INT_STATUS_1: u8 = 0x1d;
const TEMPERATURE: u8 = 0x20;
const FIFO_LENGTH: u8 = 0x22;
const FIFO_DATA: u8 = 0x24;
/// The first register that can be written.
const ACC_CONF: u8 = 0x40;
const ACC_RANGE: u8 = 0x41;
const GYR_CONF: u8 = 0x42;
const GYR_RANGE: u8 = 0x43;
const FIFO_DOWNS: u8 = 0x45;
const FIFO_CONFIG_0: u8 = 0x46;
const FIFO_CONFIG_1: u8 = 0x47;
const INT_EN_1: u8 = 0x51;
const INT_OUT_CTRL: u8 = 0x53;
const INT_LATCH: u8 = 0x54;
const INT_MAP_1: u8 = 0x56;
const SELF_TEST: u8 = 0x6d;
const OFFSET_ACC: u8 = 0x71;
const OFFSET_GYR: u8 = 0x74;
const OFFSET_CONF: u8 = 0x77;
const CMD: u8 = 0x7e;

/// Bytes of the FIFO (section 2.5).
const FIFO_SIZE: usize = 1024;
const HEADERS: u8 = 0x10;
/// Bits of INT_STATUS_1 and INT_EN_1.
const DRDY_INT: u8 = 0x10;
const FULL_INT: u8 = 0x20;
const WATERMARK_INT: u8 = 0x40;

/// What registers hold after a reset, where not 0 (section 2.11).
const RESET: [(u8, &[u8]); 5] = [
    (ACC_CONF, &[0x28, 0x03, 0x28, 0x00, 0x0b, 0x88, 0x80, 0x10]),
    (0x4b, &[0x20, 0x80, 0x42, 0x4c]),
    (0x5a, &[0x07, 0x30, 0x81, 0x0b, 0xc0]),
    (0x60, &[0x14, 0x14, 0x24, 0x04, 0x0a, 0x18, 0x48, 0x08, 0x11]),
    (0x7a, &[0x15, 0x03]),
];

/// A BMI160 at its address.
#[derive(Clone, Debug)]
pub struct Bmi160 {
    address: u8,
    pointer: u8,
    registers: [u8; 128],
    /// PMU_STATUS: modes of accelerometer (bits 5:4), gyro (3:2) and magnetometer (1:0).
    power: u8,
    sensors: Sensors<FIFO_SIZE>,
    celsius: f64,
    /// Whether the chip was told to compensate its offset.
    has_compensated: bool,
}

impl Bmi160 {
    /// One at 0x68 or 0x69.
    pub fn new(address: u8) -> Bmi160 {
        let mut chip = Bmi160 {
            address,
            pointer: 0,
            registers: [0; 128],
            power: 0,
            sensors: Sensors::new(FIFO_SIZE),
            celsius: 25.0,
            has_compensated: false,
        };
        chip.reset();
        chip
    }

    /// All in suspend mode, all registers as the sheet gives them.
    fn reset(&mut self) {
        self.registers = [0; 128];
        for (first, values) in RESET {
            let first = usize::from(first);
            self.registers[first..first + values.len()].copy_from_slice(values);
        }
        self.power = 0;
        self.has_compensated = false;
        self.sensors.clear();
    }

    const fn of(&self, register: u8) -> u8 {
        self.registers[register as usize & 0x7f]
    }

    /// CMD: the codes of register 0x7E.
    fn command(&mut self, command: u8) {
        match command {
            0x03 => self.has_compensated = true,
            0x10..=0x12 => self.power = self.power & !0x30 | (command & 3) << 4,
            0x14 | 0x15 | 0x17 => self.power = self.power & !0x0c | (command & 3) << 2,
            0x18..=0x1a => self.power = self.power & !0x03 | (command & 3),
            0xb0 => self.sensors.flush(),
            0xb1 => self.sensors.fired = 0,
            0xb6 => self.reset(),
            _ => {}
        }
    }

    fn queue(&self) -> Queue {
        let config = self.of(FIFO_CONFIG_1);
        Queue {
            headers: config & HEADERS != 0,
            gyro: config & 0x80 != 0,
            accel: config & 0x40 != 0,
            stops: false,
            downs: self.of(FIFO_DOWNS),
        }
    }

    /// A change of what FIFO samples mean goes there as a frame of its own, with a bit for each register (section 2.5.1.4;
    /// assumed: the order of bits).
    fn configure(&mut self, register: u8, value: u8) {
        let is_new = self.of(register) != value;
        self.registers[usize::from(register & 0x7f)] = value;
        let queue = self.queue();
        let what = queue.changed(match register {
            ACC_CONF => 0x01,
            ACC_RANGE => 0x02,
            GYR_CONF => 0x04,
            GYR_RANGE => 0x08,
            FIFO_DOWNS => 0x05,
            _ => 0,
        });
        if is_new && queue.headers && what != 0 {
            self.sensors.push_config(&[0x48, what], false);
        }
    }

    /// Bytes in the FIFO, with the frame that tells how many were skipped (section 2.11.9).
    fn fifo_length(&self) -> usize {
        self.sensors.fifo_length(self.queue().headers)
    }

    /// FIFO interrupts last as long as their cause; data ready until it is read, or with INT_LATCH until its status is.
    fn interrupts(&self) -> u8 {
        let latched = self.of(INT_LATCH) & 0x0f == 0x0f;
        let drdy = if latched { self.sensors.fired } else { self.sensors.ready };
        let mark = usize::from(self.of(FIFO_CONFIG_0)) * 4;
        let mut interrupts = if drdy != 0 { DRDY_INT } else { 0 };
        if mark > 0 && self.sensors.frames.len() >= mark {
            interrupts |= WATERMARK_INT;
        }
        if self.sensors.frames.is_full() {
            interrupts |= FULL_INT;
        }
        interrupts & self.of(INT_EN_1)
    }

    fn status(&self) -> u8 {
        let compensated = if self.has_compensated { 0x08 } else { 0 };
        self.sensors.ready | 0x10 | compensated
    }

    /// ACC_RANGE has four codes (register 0x41); another is taken for ±2 g.
    fn accel_range(&self) -> u8 {
        match self.of(ACC_RANGE) & 0x0f {
            0x05 => 1,
            0x08 => 2,
            0x0c => 3,
            _ => 0,
        }
    }

    fn undersamples(&self) -> bool {
        self.of(ACC_CONF) & 0x80 != 0
    }

    /// ACC_CONF: up to 1600 Hz, below 12.5 Hz with undersampling alone (section 2.11.11).
    fn accel_setting(&self) -> Setting {
        let conf = self.of(ACC_CONF);
        let lowest = if self.undersamples() { 1 } else { 5 };
        let rate = rate(conf & 0x0f).filter(|_| (lowest..=12).contains(&(conf & 0x0f)));
        let filter = filter(conf >> 4 & 7).filter(|_| !self.undersamples());
        setting(matches!(self.power >> 4 & 3, 1 | 2), rate, self.accel_range(), filter)
    }

    /// GYR_CONF: 25 Hz to 3200 Hz (section 2.11.13); fast start-up measures nothing.
    fn gyro_setting(&self) -> Setting {
        let conf = self.of(GYR_CONF);
        let rate = rate(conf & 0x0f).filter(|_| (6..=13).contains(&(conf & 0x0f)));
        let range = gyro_range(self.of(GYR_RANGE) & 7);
        setting(self.power >> 2 & 3 == 1, rate, range, filter(conf >> 4 & 3))
    }

    /// 3.9 mg, which is 64 counts at ±2 g, a unit (registers 0x71 to 0x77).
    fn with_accel_offset(&self, counts: [i16; 3]) -> [i16; 3] {
        if self.of(OFFSET_CONF) & 0x40 == 0 {
            return counts;
        }
        let offsets = [0, 1, 2].map(|axis| i16::from(self.of(OFFSET_ACC + axis) as i8));
        shifted(counts, offsets, 64, self.accel_range())
    }

    /// 0.061 °/s, which is 16 counts at ±125 °/s, a unit (registers 0x71 to 0x77).
    fn with_gyro_offset(&self, counts: [i16; 3]) -> [i16; 3] {
        if self.of(OFFSET_CONF) & 0x80 == 0 {
            return counts;
        }
        let offsets = gyro_offsets([0, 1, 2, 3].map(|byte| self.of(OFFSET_GYR + byte)));
        shifted(counts, offsets, 16, gyro_range(self.of(GYR_RANGE) & 7))
    }
}

impl Registers for Bmi160 {
    fn pointer(&mut self) -> &mut u8 {
        &mut self.pointer
    }

    fn write(&mut self, _t_ns: u64, register: u8, value: u8) {
        match register {
            CMD => self.command(value),
            ACC_CONF..CMD => self.configure(register, value),
            _ => {}
        }
    }

    fn read(&mut self, t_ns: u64, register: u8) -> u8 {
        match register {
            CHIP_ID => 0xd1,
            PMU_STATUS => self.power,
            DATA_GYR..DATA_ACC => self.sensors.gyro_byte(register - DATA_GYR),
            DATA_ACC..SENSORTIME => self.sensors.accel_byte(register - DATA_ACC),
            SENSORTIME..STATUS => sensor_time(t_ns)[usize::from(register - SENSORTIME)],
            STATUS => self.status(),
            INT_STATUS_0 => 0,
            INT_STATUS_1 => {
                let interrupts = self.interrupts();
                self.sensors.fired = 0;
                interrupts
            }
            // 0 is 23 °C, a unit 1/2^9 K (section 2.11.8).
            TEMPERATURE..FIFO_LENGTH => {
                temperature(self.celsius, 23.0, 512.0).to_le_bytes()[usize::from(register - TEMPERATURE)]
            }
            FIFO_LENGTH..FIFO_DATA => {
                (self.fifo_length() as u16).to_le_bytes()[usize::from(register - FIFO_LENGTH)]
            }
            FIFO_DATA => {
                let time = (self.of(FIFO_CONFIG_1) & 0x02 != 0).then(|| sensor_time(t_ns));
                self.sensors.next_byte(self.queue().headers, time)
            }
            _ => self.of(register),
        }
    }

    fn begin_read(&mut self) {
        self.sensors.frames.begin();
    }

    fn after(&self, register: u8) -> u8 {
        if register == FIFO_DATA { register } else { register.wrapping_add(1) & 0x7f }
    }
}

impl Chip for Bmi160 {
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

    fn sample(&mut self, _t_ns: u64, samples: &Samples) {
        self.celsius = samples.temperature_c.unwrap_or(self.celsius);
        let [gyro, accel] = taken(self, samples);
        let gyro = gyro.map(|counts| self.with_gyro_offset(counts));
        let accel = accel.map(|counts| self.with_accel_offset(counts));
        self.sensors.take(gyro, accel, self.queue());
    }

    fn tally(&self, channel: Channel) -> Tally {
        self.sensors.tally(channel)
    }

    /// INT1, where it is an output (INT_OUT_CTRL bit 3).
    fn interrupt(&self) -> bool {
        let map = self.of(INT_MAP_1);
        let mapped = [(0x80, DRDY_INT), (0x40, WATERMARK_INT), (0x20, FULL_INT)]
            .into_iter()
            .filter(|(bit, _)| map & bit != 0)
            .fold(0, |mapped, (_, interrupt)| mapped | interrupt);
        self.of(INT_OUT_CTRL) & 0x08 != 0 && self.interrupts() & mapped != 0
    }

    fn lacks(&self) -> Option<&'static str> {
        if self.of(SELF_TEST) != 0 {
            Some("self-test (SELF_TEST): nothing deflects the readings")
        } else if self.has_compensated {
            Some("fast offset compensation (command 03): it ends at once and changes no offset")
        } else if self.undersamples() {
            Some("undersampling (ACC_CONF bit 7): it takes single samples, not their average")
        } else if self.queue().is_unfiltered() {
            Some("unfiltered data in the FIFO (FIFO_DOWNS bits 3 and 7): it holds what the registers hold")
        } else if self.power & 0x03 != 0 {
            Some("the secondary interface: no magnetometer is attached")
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests;
