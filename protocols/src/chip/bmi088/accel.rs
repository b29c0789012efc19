//! The accelerometer of a BMI088 (BST-BMI088-DS001, sections 5.2 and 5.3).

use crate::chip::bosch::{DRDY_ACC, Queue, Sensors, rate, sensor_time, setting};
use crate::chip::{Channel, Registers, Samples, Setting, Tally, temperature};

const ACC_CHIP_ID: u8 = 0x00;
const ACC_ERR_REG: u8 = 0x02;
const ACC_STATUS: u8 = 0x03;
const ACC_X_LSB: u8 = 0x12;
const SENSORTIME_0: u8 = 0x18;
const SENSORTIME_2: u8 = 0x1a;
const ACC_INT_STAT_1: u8 = 0x1d;
const TEMP_MSB: u8 = 0x22;
const TEMP_LSB: u8 = 0x23;
const FIFO_LENGTH_0: u8 = 0x24;
const FIFO_LENGTH_1: u8 = 0x25;
const FIFO_DATA: u8 = 0x26;
/// The first register that can be written.
const ACC_CONF: u8 = 0x40;
const ACC_RANGE: u8 = 0x41;
const FIFO_DOWNS: u8 = 0x45;
const FIFO_WTM_0: u8 = 0x46;
const FIFO_WTM_1: u8 = 0x47;
const FIFO_CONFIG_0: u8 = 0x48;
const FIFO_CONFIG_1: u8 = 0x49;
const INT1_IO_CTRL: u8 = 0x53;
const INT_MAP_DATA: u8 = 0x58;
/// Not in the sheet, but in its maker's driver: a program that synchronizes both sensors.
const INIT_CTRL: u8 = 0x59;
const FEATURE_CFG: u8 = 0x5e;
const ACC_SELF_TEST: u8 = 0x6d;
const ACC_PWR_CONF: u8 = 0x7c;
const ACC_PWR_CTRL: u8 = 0x7d;
const ACC_SOFTRESET: u8 = 0x7e;

const FIFO_SIZE: usize = 1024;
/// What FIFO_LENGTH says of an empty one (section 5.3.8): no bit of the counter is set.
const EMPTY: u16 = 0x8000;

/// What registers hold after a reset, where not 0 (section 5.2).
const RESET: [(u8, u8); 8] = [
    (ACC_CONF, 0xa8),
    (ACC_RANGE, 0x01),
    (FIFO_DOWNS, 0x80),
    (FIFO_WTM_1, 0x02),
    (FIFO_CONFIG_0, 0x02),
    (FIFO_CONFIG_1, 0x10),
    (ACC_PWR_CONF, 0x03),
    (ACC_PWR_CTRL, 0x00),
];

#[derive(Clone, Debug)]
pub(super) struct Accel {
    pointer: u8,
    registers: [u8; 128],
    /// By ACC_PWR_CONF. After a reset ACC_PWR_CTRL alone turns it on (chapter 3), though ACC_PWR_CONF reads 0x03 then; a
    /// later 0x03 stops it (section 5.3.20).
    is_suspended: bool,
    sensors: Sensors<FIFO_SIZE>,
    celsius: f64,
}

impl Accel {
    pub fn new() -> Accel {
        let sensors = Sensors::new(FIFO_SIZE);
        let mut accel =
            Accel { pointer: 0, registers: [0; 128], is_suspended: false, sensors, celsius: 25.0 };
        accel.reset();
        accel
    }

    fn reset(&mut self) {
        self.registers = [0; 128];
        for (register, value) in RESET {
            self.registers[usize::from(register)] = value;
        }
        self.is_suspended = false;
        self.sensors.clear();
    }

    const fn of(&self, register: u8) -> u8 {
        self.registers[register as usize & 0x7f]
    }

    const fn is_on(&self) -> bool {
        self.of(ACC_PWR_CTRL) & 0x04 != 0 && !self.is_suspended
    }

    fn queue(&self) -> Queue {
        Queue {
            headers: true,
            gyro: false,
            accel: self.of(FIFO_CONFIG_1) & 0x40 != 0,
            stops: self.of(FIFO_CONFIG_0) & 0x01 != 0,
            downs: self.of(FIFO_DOWNS) & 0x70,
        }
    }

    /// A change of what samples mean goes to the FIFO as a frame of its own (section 4.9.3.2.4).
    fn configure(&mut self, register: u8, value: u8) {
        let is_new = self.of(register) != value;
        self.registers[usize::from(register & 0x7f)] = value;
        let what = match register {
            ACC_CONF | FIFO_DOWNS => 0x01,
            ACC_RANGE => 0x02,
            _ => return,
        };
        if is_new && self.queue().accel {
            self.sensors.push_config(&[0x48, what], self.queue().stops);
        }
    }

    /// Table 8: 12.5 Hz to 1600 Hz by acc_odr 5 to 12.
    pub fn setting(&self) -> Setting {
        let conf = self.of(ACC_CONF);
        let rate = rate(conf & 0x0f).filter(|_| (5..=12).contains(&(conf & 0x0f)));
        let filter = match conf >> 4 {
            0x08 => Some("OSR4"),
            0x09 => Some("OSR2"),
            0x0a => Some("Normal"),
            _ => None,
        };
        setting(self.is_on(), rate, self.of(ACC_RANGE) & 3, filter)
    }

    pub fn sample(&mut self, samples: &Samples) {
        self.celsius = samples.temperature_c.unwrap_or(self.celsius);
        let counts = samples.accel.filter(|_| self.setting().rate.is_some());
        self.sensors.take(None, counts, self.queue());
    }

    pub fn tally(&self) -> Tally {
        self.sensors.tally(Channel::Accel)
    }

    /// Eleven bits, 0.125 °C a unit, 0 is 23 °C; 0x80 is invalid (section 5.3.7).
    fn thermometer(&self) -> [u8; 2] {
        if self.of(ACC_PWR_CTRL) & 0x04 == 0 {
            return [0x80, 0];
        }
        let counts = temperature(self.celsius, 23.0, 8.0).clamp(-1023, 1023);
        (counts << 5).to_be_bytes()
    }

    fn fifo_length(&self) -> u16 {
        match self.sensors.frames.len() {
            0 => EMPTY,
            len => len as u16,
        }
    }

    /// INT1, where it is an output: data ready until it is read, a FIFO's interrupt as long as its cause (section 4.9.3.3).
    pub fn interrupt(&self) -> bool {
        let map = self.of(INT_MAP_DATA);
        let mark = usize::from(self.of(FIFO_WTM_1) & 0x1f) << 8 | usize::from(self.of(FIFO_WTM_0));
        let is_past = mark > 0 && self.sensors.frames.len() >= mark;
        let fires = (map & 0x04 != 0 && self.sensors.ready != 0)
            || (map & 0x02 != 0 && is_past)
            || (map & 0x01 != 0 && self.sensors.frames.is_full());
        self.of(INT1_IO_CTRL) & 0x08 != 0 && fires
    }

    pub fn lacks(&self) -> Option<&'static str> {
        if self.of(ACC_SELF_TEST) != 0 {
            Some("self-test of the accelerometer (ACC_SELF_TEST): nothing deflects the readings")
        } else if self.of(INIT_CTRL) & 1 != 0 {
            Some("the program that synchronizes both sensors (INIT_CTRL): it does not start")
        } else {
            None
        }
    }
}

impl Registers for Accel {
    fn pointer(&mut self) -> &mut u8 {
        &mut self.pointer
    }

    fn write(&mut self, _t_ns: u64, register: u8, value: u8) {
        match register {
            ACC_SOFTRESET if value == 0xb6 => self.reset(),
            ACC_SOFTRESET if value == 0xb0 => self.sensors.flush(),
            ACC_CONF..ACC_SOFTRESET => {
                self.configure(register, value);
                match register {
                    ACC_PWR_CONF => self.is_suspended = value & 0x03 == 0x03,
                    ACC_PWR_CTRL => self.is_suspended = false,
                    _ => {}
                }
            }
            _ => {}
        }
    }

    fn read(&mut self, t_ns: u64, register: u8) -> u8 {
        match register {
            ACC_CHIP_ID => 0x1e,
            ACC_ERR_REG => u8::from(self.is_on() && self.setting().rate.is_none()) << 2,
            ACC_STATUS => self.sensors.ready & DRDY_ACC | 0x10,
            ACC_X_LSB..SENSORTIME_0 => self.sensors.accel_byte(register - ACC_X_LSB),
            SENSORTIME_0..=SENSORTIME_2 => sensor_time(t_ns)[usize::from(register - SENSORTIME_0)],
            ACC_INT_STAT_1 => core::mem::take(&mut self.sensors.fired),
            TEMP_MSB | TEMP_LSB => self.thermometer()[usize::from(register - TEMP_MSB)],
            FIFO_LENGTH_0 => self.fifo_length() as u8,
            FIFO_LENGTH_1 => (self.fifo_length() >> 8) as u8,
            FIFO_DATA => {
                // assumed: bit 1, which "must always be 1", asks for the time as in this FIFO's other chips.
                let time = (self.of(FIFO_CONFIG_0) & 0x02 != 0).then(|| sensor_time(t_ns));
                self.sensors.next_byte(true, time)
            }
            _ => self.of(register),
        }
    }

    fn begin_read(&mut self) {
        self.sensors.frames.begin();
    }

    fn after(&self, register: u8) -> u8 {
        match register {
            FIFO_DATA | FEATURE_CFG => register,
            _ => register.wrapping_add(1) & 0x7f,
        }
    }
}
