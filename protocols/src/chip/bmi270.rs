//! BMI270.
//!
//! Source: BST-BMI270-DS000; meanings of registers were checked against its maker's driver, reset values that no driver
//! names are assumed. The program that a driver uploads is counted, not run: the chip takes
//! any 8192 bytes, or the 328 of the image that gives its memory to the FIFO, and is ready 20 ms after. Until then it
//! measures nothing. Its features (steps, motion, axis remapping, gain) are memory that can be written and read back. No
//! sensor is attached to the auxiliary interface, and power saving does not slow the bus ([`Chip::lacks`] tells of what
//! would change readings).
//!
//! ```
//! use ratetable_protocols::chip::{self, Channel, Chip, bmi270::Bmi270};
//!
//! let mut chip = Bmi270::new(0x68);
//! let registers = chip.at(0x68).expect("its address");
//! chip::write(registers, 0, &[0x59, 0x00], false); // INIT_CTRL: an upload begins
//! chip::write(registers, 0, &[0x5b, 0x00, 0x00], false); // INIT_ADDR
//! chip::write(registers, 0, &[&[0x5e][..], &[0; 8192]].concat(), false); // INIT_DATA, whose address stays
//! chip::write(registers, 0, &[0x59, 0x01], false); // INIT_CTRL: it is complete
//! chip::write(registers, 20_000_000, &[0x7d, 0x06], false); // PWR_CTRL: accelerometer and gyro
//! let gyro = chip.setting(Channel::Gyro).expect("it has one");
//! assert_eq!((gyro.rate, gyro.range, gyro.filter), (Some((200, 1)), 4, Some("normal")));
//! ```

mod upload;

use super::bosch::{Queue, Sensors, filter, gyro_offsets, gyro_range, rate, sensor_time, setting, shifted};
use super::{Channel, Chip, Registers, Samples, Setting, Tally, taken, temperature};
use upload::{Image, Upload};

const CHIP_ID: u8 = 0x00;
const STATUS: u8 = 0x03;
const DATA_ACC: u8 = 0x0c;
const DATA_GYR: u8 = 0x12;
const SENSORTIME: u8 = 0x18;
const EVENT: u8 = 0x1b;
const INT_STATUS_1: u8 = 0x1d;
const INTERNAL_STATUS: u8 = 0x21;
const TEMPERATURE: u8 = 0x22;
const FIFO_LENGTH: u8 = 0x24;
const FIFO_DATA: u8 = 0x26;
/// The first register that can be written.
const FEAT_PAGE: u8 = 0x2f;
const FEATURES: u8 = 0x30;
const ACC_CONF: u8 = 0x40;
const ACC_RANGE: u8 = 0x41;
const GYR_CONF: u8 = 0x42;
const GYR_RANGE: u8 = 0x43;
const FIFO_DOWNS: u8 = 0x45;
const FIFO_WTM_0: u8 = 0x46;
const FIFO_WTM_1: u8 = 0x47;
const FIFO_CONFIG_0: u8 = 0x48;
const FIFO_CONFIG_1: u8 = 0x49;
const INT1_IO_CTRL: u8 = 0x53;
const INT_LATCH: u8 = 0x55;
const INT_MAP_DATA: u8 = 0x58;
const INIT_CTRL: u8 = 0x59;
const INIT_ADDR_0: u8 = 0x5b;
const INIT_ADDR_1: u8 = 0x5c;
const INIT_DATA: u8 = 0x5e;
const ACC_SELF_TEST: u8 = 0x6d;
const NV_CONF: u8 = 0x70;
const OFFSET_ACC: u8 = 0x71;
const OFFSET_GYR: u8 = 0x74;
const OFFSET_CONF: u8 = 0x77;
const PWR_CTRL: u8 = 0x7d;
const CMD: u8 = 0x7e;

/// Bytes of the FIFO: all that its memory has, where no feature needs it.
const FIFO_MOST: usize = 6144;
const FIFO_SIZE: usize = 2048;

const WATERMARK_INT: u8 = 0x02;
const FULL_INT: u8 = 0x01;
/// INT_MAP_DATA, of INT1.
const DRDY_MAP: u8 = 0x04;
/// EVENT: the chip was reset.
const POWER_ON: u8 = 0x01;

/// What registers hold after a reset, where not 0 (register map; assumed: INIT_CTRL).
const RESET: [(u8, &[u8]); 6] = [
    (ACC_CONF, &[0xa8, 0x02, 0xa9, 0x00, 0x46, 0x88, 0x00, 0x02, 0x02, 0x10]),
    (0x4b, &[0x20, 0x83, 0x42, 0x4c, 0x02]),
    (0x68, &[0x01]),
    (0x6c, &[0xff]),
    (INIT_CTRL, &[0x90]),
    (0x7c, &[0x03]),
];

/// A BMI270 at its address.
#[derive(Clone, Debug)]
pub struct Bmi270 {
    address: u8,
    pointer: u8,
    registers: [u8; 128],
    /// Eight pages of FEATURES.
    features: [u8; 128],
    upload: Upload,
    event: u8,
    sensors: Sensors<FIFO_MOST>,
    celsius: f64,
}

impl Bmi270 {
    /// One at 0x68 or 0x69.
    pub fn new(address: u8) -> Bmi270 {
        let mut chip = Bmi270 {
            address,
            pointer: 0,
            registers: [0; 128],
            features: [0; 128],
            upload: Upload::default(),
            event: POWER_ON,
            sensors: Sensors::new(FIFO_SIZE),
            celsius: 25.0,
        };
        // assumed: -32768 on every axis, which is what its maker's driver takes for the end.
        chip.sensors.frames.empty = [0x00, 0x80];
        chip.reset();
        chip
    }

    fn reset(&mut self) {
        self.registers = [0; 128];
        for (first, values) in RESET {
            let first = usize::from(first);
            self.registers[first..first + values.len()].copy_from_slice(values);
        }
        self.features = [0; 128];
        self.upload = Upload::default();
        self.event = POWER_ON;
        self.sensors.clear();
        self.sensors.frames.resize(FIFO_SIZE);
    }

    const fn of(&self, register: u8) -> u8 {
        self.registers[register as usize & 0x7f]
    }

    /// INIT_CTRL: 0 before an upload, 1 behind it.
    fn control_upload(&mut self, t_ns: u64, value: u8) {
        if value & 1 == 0 {
            self.upload = Upload::default();
        } else {
            let size = match self.upload.end(t_ns) {
                Some(Image::Full) => FIFO_SIZE,
                Some(Image::LargeFifo) => FIFO_MOST,
                None => return,
            };
            self.sensors.flush();
            self.sensors.frames.resize(size);
        }
    }

    fn feature(&mut self, register: u8) -> &mut u8 {
        let page = usize::from(self.of(FEAT_PAGE) & 7);
        &mut self.features[page << 4 | usize::from(register & 0x0f)]
    }

    fn queue(&self) -> Queue {
        let config = self.of(FIFO_CONFIG_1);
        Queue {
            headers: config & 0x10 != 0,
            gyro: config & 0x80 != 0,
            accel: config & 0x40 != 0,
            stops: self.of(FIFO_CONFIG_0) & 0x01 != 0,
            downs: self.of(FIFO_DOWNS),
        }
    }

    /// A change of what FIFO samples mean goes there as a frame of its own: a bit for each register and the time, four bytes
    /// (its length is that which its maker's driver skips; assumed: the order of bits).
    fn configure(&mut self, t_ns: u64, register: u8, value: u8) {
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
            let [low, middle, high] = sensor_time(t_ns);
            self.sensors.push_config(&[0x48, what, low, middle, high], queue.stops);
        }
    }

    /// Bytes in the FIFO, with the frame that tells how many were skipped (assumed: as in BST-BMI160-DS000 section 2.11.9).
    fn fifo_length(&self) -> usize {
        self.sensors.fifo_length(self.queue().headers)
    }

    /// FIFO bits of INT_STATUS_1, which last as long as their cause.
    fn fifo_interrupts(&self) -> u8 {
        let mark = usize::from(self.of(FIFO_WTM_1) & 0x1f) << 8 | usize::from(self.of(FIFO_WTM_0));
        let is_past = mark > 0 && self.sensors.frames.len() >= mark;
        let watermark = if is_past { WATERMARK_INT } else { 0 };
        watermark | if self.sensors.frames.is_full() { FULL_INT } else { 0 }
    }

    fn is_on(&self, bit: u8) -> bool {
        self.upload.is_complete() && self.of(PWR_CTRL) & bit != 0
    }

    /// ACC_CONF: up to 1600 Hz; below 12.5 Hz, and averages in place of a filter, with acc_filter_perf 0 alone.
    fn accel_setting(&self) -> Setting {
        let conf = self.of(ACC_CONF);
        let lowest = if self.averages() { 1 } else { 5 };
        let rate = rate(conf & 0x0f).filter(|_| (lowest..=12).contains(&(conf & 0x0f)));
        let filter = filter(conf >> 4 & 7).filter(|_| !self.averages());
        setting(self.is_on(0x04), rate, self.of(ACC_RANGE) & 3, filter)
    }

    fn averages(&self) -> bool {
        self.of(ACC_CONF) & 0x80 == 0
    }

    /// GYR_CONF: 25 Hz to 3200 Hz.
    fn gyro_setting(&self) -> Setting {
        let conf = self.of(GYR_CONF);
        let rate = rate(conf & 0x0f).filter(|_| (6..=13).contains(&(conf & 0x0f)));
        setting(self.is_on(0x02), rate, gyro_range(self.of(GYR_RANGE) & 7), filter(conf >> 4 & 3))
    }

    /// EVENT.error_code: what ACC_CONF (1), GYR_CONF (2) or both (3) ask for is not possible.
    fn configuration_error(&self) -> u8 {
        let is_wrong = |bit, setting: Setting| self.is_on(bit) && setting.rate.is_none();
        u8::from(is_wrong(0x04, self.accel_setting())) | u8::from(is_wrong(0x02, self.gyro_setting())) << 1
    }

    /// 3.9 mg, which is 64 counts at ±2 g, a unit (registers 0x70 to 0x73).
    fn with_accel_offset(&self, counts: [i16; 3]) -> [i16; 3] {
        if self.of(NV_CONF) & 0x08 == 0 {
            return counts;
        }
        let offsets = [0, 1, 2].map(|axis| i16::from(self.of(OFFSET_ACC + axis) as i8));
        shifted(counts, offsets, 64, self.of(ACC_RANGE) & 3)
    }

    /// 0.061 °/s, which is 16 counts at ±125 °/s, a unit (registers 0x74 to 0x77).
    fn with_gyro_offset(&self, counts: [i16; 3]) -> [i16; 3] {
        if self.of(OFFSET_CONF) & 0x40 == 0 {
            return counts;
        }
        let offsets = gyro_offsets([0, 1, 2, 3].map(|byte| self.of(OFFSET_GYR + byte)));
        shifted(counts, offsets, 16, gyro_range(self.of(GYR_RANGE) & 7))
    }

    /// 0 is 23 °C, a unit 1/2^9 K; 0x8000 where the thermometer is off (assumed: the gyro turns it on as temp_en does).
    fn thermometer(&self) -> [u8; 2] {
        let is_on = self.is_on(0x0a);
        let counts = if is_on { temperature(self.celsius, 23.0, 512.0) } else { i16::MIN };
        counts.to_le_bytes()
    }
}

impl Registers for Bmi270 {
    fn pointer(&mut self) -> &mut u8 {
        &mut self.pointer
    }

    fn write(&mut self, t_ns: u64, register: u8, value: u8) {
        match register {
            CMD if value == 0xb6 => self.reset(),
            CMD if value == 0xb0 => self.sensors.flush(),
            CMD..=u8::MAX => {}
            FEATURES..ACC_CONF => *self.feature(register) = value,
            INIT_DATA => self.upload.take(),
            FEAT_PAGE..CMD => {
                self.configure(t_ns, register, value);
                match register {
                    INIT_CTRL => self.control_upload(t_ns, value),
                    INIT_ADDR_0 | INIT_ADDR_1 => {
                        self.upload.seek([self.of(INIT_ADDR_0), self.of(INIT_ADDR_1)]);
                    }
                    _ => {}
                }
            }
            _ => {}
        }
    }

    fn read(&mut self, t_ns: u64, register: u8) -> u8 {
        match register {
            CHIP_ID => 0x24,
            STATUS => self.sensors.ready | 0x10,
            DATA_ACC..DATA_GYR => self.sensors.accel_byte(register - DATA_ACC),
            DATA_GYR..SENSORTIME => self.sensors.gyro_byte(register - DATA_GYR),
            SENSORTIME..EVENT => sensor_time(t_ns)[usize::from(register - SENSORTIME)],
            EVENT => core::mem::take(&mut self.event) | self.configuration_error() << 2,
            INT_STATUS_1 => core::mem::take(&mut self.sensors.fired) | self.fifo_interrupts(),
            INTERNAL_STATUS => self.upload.message(t_ns),
            TEMPERATURE..FIFO_LENGTH => self.thermometer()[usize::from(register - TEMPERATURE)],
            FIFO_LENGTH..FIFO_DATA => {
                (self.fifo_length() as u16).to_le_bytes()[usize::from(register - FIFO_LENGTH)]
            }
            FIFO_DATA => {
                let time = (self.of(FIFO_CONFIG_0) & 0x02 != 0).then(|| sensor_time(t_ns));
                self.sensors.next_byte(self.queue().headers, time)
            }
            FEATURES..ACC_CONF => *self.feature(register),
            _ => self.of(register),
        }
    }

    fn begin_read(&mut self) {
        self.sensors.frames.begin();
    }

    fn after(&self, register: u8) -> u8 {
        match register {
            FIFO_DATA | INIT_DATA => register,
            _ => register.wrapping_add(1) & 0x7f,
        }
    }
}

impl Chip for Bmi270 {
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

    /// INT1, where it is an output (INT1_IO_CTRL bit 3). Data ready lasts until it is read, or with INT_LATCH until
    /// INT_STATUS_1 is.
    fn interrupt(&self) -> bool {
        let map = self.of(INT_MAP_DATA);
        let latched = self.of(INT_LATCH) & 1 != 0;
        let drdy = if latched { self.sensors.fired } else { self.sensors.ready };
        let fires = (map & DRDY_MAP != 0 && drdy != 0) || self.fifo_interrupts() & map != 0;
        self.of(INT1_IO_CTRL) & 0x08 != 0 && fires
    }

    fn lacks(&self) -> Option<&'static str> {
        if self.of(ACC_SELF_TEST) & 0x01 != 0 {
            Some("self-test (ACC_SELF_TEST): nothing deflects the readings")
        } else if self.of(OFFSET_CONF) & 0x80 != 0 {
            Some("gain compensation (register 77 bit 7): the gyro's readings are not scaled")
        } else if self.is_on(0x04) && self.averages() {
            Some("averages (ACC_CONF bit 7 clear): the accelerometer takes single samples")
        } else if self.queue().is_unfiltered() {
            Some("unfiltered data in the FIFO (FIFO_DOWNS bits 3 and 7): it holds what the registers hold")
        } else if self.of(PWR_CTRL) & 0x01 != 0 {
            Some("the auxiliary interface: no sensor is attached")
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests;
