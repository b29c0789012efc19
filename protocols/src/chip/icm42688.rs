//! ICM-42688-P.
//!
//! Source: DS-000347 rev 1.8, by section. Its motion functions (APEX) change no reading and are not there; self-tests deflect
//! nothing ([`Chip::lacks`] tells what a driver has turned on that would change a reading). There is no FSYNC pin and no
//! clock input. Assumed: a read of the FIFO goes on where the last one ended, whatever FIFO_RESUME_PARTIAL_RD says.
//!
//! ```
//! use ratetable_protocols::chip::{self, Channel, Chip, icm42688::Icm42688};
//!
//! let mut chip = Icm42688::new(0x68);
//! let registers = chip.at(0x68).expect("its address");
//! chip::write(registers, 0, &[0x4f, 0x4f, 0x68], false); // ±500 °/s at 500 Hz, ±2 g at 100 Hz
//! chip::write(registers, 0, &[0x4e, 0x0f], false); // both in low-noise mode
//! let gyro = chip.setting(Channel::Gyro).expect("it has one");
//! assert_eq!((gyro.rate, gyro.range, gyro.filter), (Some((500, 1)), 5, Some("BW 1")));
//! let accel = chip.setting(Channel::Accel).expect("it has one");
//! assert_eq!((accel.rate, accel.range), (Some((100, 1)), 0));
//! ```

mod packet;
mod rates;

use super::{Channel, Chip, Fifo, Latest, Registers, Samples, Setting, Tally, shifted, taken, temperature};

/// A register: its bank and its address there.
type At = (u8, u8);

const DEVICE_CONFIG: At = (0, 0x11);
const FIFO_CONFIG: At = (0, 0x16);
const TEMP_DATA1: u8 = 0x1d;
const ACCEL_DATA_X1: u8 = 0x1f;
const GYRO_DATA_X1: u8 = 0x25;
const TMST_FSYNCH: u8 = 0x2b;
const INT_STATUS: At = (0, 0x2d);
const FIFO_COUNTH: At = (0, 0x2e);
const FIFO_COUNTL: At = (0, 0x2f);
const FIFO_DATA: At = (0, 0x30);
const INT_STATUS3: u8 = 0x38;
const SIGNAL_PATH_RESET: At = (0, 0x4b);
const INTF_CONFIG0: At = (0, 0x4c);
const INTF_CONFIG1: At = (0, 0x4d);
const PWR_MGMT0: At = (0, 0x4e);
const GYRO_CONFIG0: At = (0, 0x4f);
const ACCEL_CONFIG0: At = (0, 0x50);
const GYRO_CONFIG1: At = (0, 0x51);
const GYRO_ACCEL_CONFIG0: At = (0, 0x52);
const ACCEL_CONFIG1: At = (0, 0x53);
const TMST_CONFIG: At = (0, 0x54);
const FIFO_CONFIG1: At = (0, 0x5f);
const FIFO_CONFIG2: At = (0, 0x60);
const FIFO_CONFIG3: At = (0, 0x61);
const INT_CONFIG0: At = (0, 0x63);
const INT_SOURCE0: At = (0, 0x65);
const FIFO_LOST_PKT0: At = (0, 0x6c);
const FIFO_LOST_PKT1: At = (0, 0x6d);
const SELF_TEST_CONFIG: At = (0, 0x70);
const WHO_AM_I: At = (0, 0x75);
const REG_BANK_SEL: u8 = 0x76;
const SENSOR_CONFIG0: At = (1, 0x03);
const TMSTVAL0: u8 = 0x62;
const OFFSET_USER0: u8 = 0x77;

/// Bits of INT_STATUS.
const RESET_DONE: u8 = 0x10;
const DATA_READY: u8 = 0x08;
const FIFO_THRESHOLD: u8 = 0x04;
const FIFO_FULL: u8 = 0x02;

/// What a register reads after a reset where that is not 0 (sections 14 to 18). Those that are trimmed in the factory are 0.
const RESET_VALUES: [(At, u8); 34] = [
    ((0, 0x13), 0x05), // DRIVE_CONFIG
    ((0, 0x34), 0x04), // APEX_DATA3
    (INTF_CONFIG0, 0x30),
    (INTF_CONFIG1, 0x91),
    (GYRO_CONFIG0, 0x06),
    (ACCEL_CONFIG0, 0x06),
    (GYRO_CONFIG1, 0x16),
    (GYRO_ACCEL_CONFIG0, 0x11),
    (ACCEL_CONFIG1, 0x0d),
    (TMST_CONFIG, 0x23),
    ((0, 0x56), 0x82), // APEX_CONFIG0
    ((0, 0x62), 0x10), // FSYNC_CONFIG
    ((0, 0x64), 0x10), // INT_CONFIG1
    (INT_SOURCE0, 0x10),
    (WHO_AM_I, 0x47),
    (SENSOR_CONFIG0, 0x80),
    (ANTI_ALIAS[0], 0xa0),
    (ANTI_ALIAS[1], 0x0d),
    (ANTI_ALIAS[2], 0xaa),
    (ANTI_ALIAS[3], 0x80),
    ((1, 0x13), 0x11), // GYRO_CONFIG_STATIC10
    ((1, 0x7a), 0x83), // INTF_CONFIG4
    ((1, 0x7c), 0x5f), // INTF_CONFIG6
    (ANTI_ALIAS[4], 0x30),
    (ANTI_ALIAS[5], 0x40),
    (ANTI_ALIAS[6], 0x62),
    ((4, 0x40), 0xa2), // APEX_CONFIG1 to 8
    ((4, 0x41), 0x85),
    ((4, 0x42), 0x51),
    ((4, 0x43), 0xa4),
    ((4, 0x44), 0x8c),
    ((4, 0x45), 0x5c),
    ((4, 0x46), 0x45),
    ((4, 0x47), 0x5b),
];

/// GYRO_CONFIG_STATIC2 to 5 and ACCEL_CONFIG_STATIC2 to 4.
const ANTI_ALIAS: [At; 7] = [(1, 0x0b), (1, 0x0c), (1, 0x0d), (1, 0x0e), (2, 0x03), (2, 0x04), (2, 0x05)];

/// One at its address.
#[derive(Clone, Debug)]
pub struct Icm42688 {
    address: u8,
    pointer: u8,
    bank: u8,
    registers: [[u8; 128]; 5],
    gyro: Latest,
    accel: Latest,
    celsius: f64,
    /// Whether the gyro, and the accelerometer, has had a sample since the reset.
    has: [bool; 2],
    /// INT_STATUS.
    status: u8,
    fifo: Fifo<2048>,
    /// The count as it was when FIFO_COUNTH was read.
    count: usize,
    lost_packets: u16,
    /// GYRO_ODR and ACCEL_ODR of the last packet with either.
    packet_odr: [Option<u8>; 2],
    /// When the last sample was taken.
    last_ns: Option<u64>,
}

impl Icm42688 {
    /// One at 0x68 or 0x69.
    pub fn new(address: u8) -> Icm42688 {
        let mut chip = Icm42688 {
            address,
            pointer: 0,
            bank: 0,
            registers: [[0; 128]; 5],
            gyro: Latest::default(),
            accel: Latest::default(),
            celsius: 25.0,
            has: [false; 2],
            status: 0,
            fifo: Fifo::new(),
            count: 0,
            lost_packets: 0,
            packet_odr: [None; 2],
            last_ns: None,
        };
        chip.power_on();
        chip
    }

    fn power_on(&mut self) {
        self.registers = [[0; 128]; 5];
        RESET_VALUES.into_iter().for_each(|(at, value)| self.set(at, value));
        self.bank = 0;
        self.gyro.clear();
        self.accel.clear();
        self.flush();
        (self.has, self.packet_odr, self.last_ns) = ([false; 2], [None; 2], None);
        (self.count, self.lost_packets) = (0, 0);
        self.status = RESET_DONE; // INT_STATUS resets to 0x10 (section 14.21)
    }

    fn of(&self, (bank, register): At) -> u8 {
        self.registers[usize::from(bank) % 5][usize::from(register & 0x7f)]
    }

    fn set(&mut self, (bank, register): At, value: u8) {
        self.registers[usize::from(bank) % 5][usize::from(register & 0x7f)] = value;
    }

    /// FIFO_HOLD_LAST_DATA_EN: what is invalid reads as the last valid sample and not as −32768 (section 12.8).
    fn holds_last(&self) -> bool {
        self.of(INTF_CONFIG0) & 0x80 != 0
    }

    fn is_big_endian(&self) -> bool {
        self.of(INTF_CONFIG0) & 0x10 != 0
    }

    /// A register before the first sample (section 12.8).
    fn invalid(&self) -> i16 {
        if self.holds_last() { 0 } else { i16::MIN }
    }

    /// (T − 25 °C) · 132.48 (section 14.6).
    fn temperature(&self) -> i16 {
        if self.has == [false; 2] { self.invalid() } else { temperature(self.celsius, 25.0, 132.48) }
    }

    /// Byte `i` of a channel's sample as its registers read it.
    fn data(&mut self, channel: Channel, i: u8) -> u8 {
        let i = if self.is_big_endian() { i } else { i ^ 1 };
        let invalid = self.invalid().to_be_bytes()[usize::from(i & 1)];
        match channel {
            Channel::Gyro if self.has[0] => self.gyro.high_first(i),
            Channel::Accel if self.has[1] => self.accel.high_first(i),
            _ => invalid,
        }
    }

    /// What a read of a sensor's register, or of the FIFO, clears: option 2 or 3 of INT_CONFIG0 (section 14.49).
    fn clear_by_data(&mut self, shift: u8, bits: u8) {
        if self.of(INT_CONFIG0) >> shift & 2 != 0 {
            self.status &= !bits;
        }
    }

    fn read_status(&mut self) -> u8 {
        let now = self.status;
        // Option 2 is cleared by the data alone. Assumed: of option 3 either read will do.
        let kept = [(4, DATA_READY), (2, FIFO_THRESHOLD), (0, FIFO_FULL)]
            .into_iter()
            .filter(|(shift, _)| self.of(INT_CONFIG0) >> shift & 3 == 2)
            .fold(0, |kept, (_, bit)| kept | bit);
        self.status &= kept;
        now
    }

    fn reset_signals(&mut self, t_ns: u64, value: u8) {
        if value & 0x02 != 0 {
            self.flush();
        }
        if value & 0x04 != 0 && self.of(TMST_CONFIG) & 0x11 == 0x11 {
            let ticks = self.ticks(t_ns).to_le_bytes();
            let values = [ticks[0], ticks[1], ticks[2] & 0x0f];
            (TMSTVAL0..).zip(values).for_each(|(register, value)| self.set((1, register), value));
        }
    }

    /// Two signed numbers of 12 bits a pair of three bytes: OFFSET_USER0 to 8 (sections 18.18 to 18.26).
    fn offsets(&self) -> [i32; 6] {
        let at = |i: u8| i32::from(self.of((4, OFFSET_USER0 + i)));
        let signed = |high: i32, low: i32| ((high & 0x0f) << 28 | low << 20) >> 20;
        [
            signed(at(1), at(0)),
            signed(at(1) >> 4, at(2)),
            signed(at(4), at(3)),
            signed(at(4) >> 4, at(5)),
            signed(at(7), at(6)),
            signed(at(7) >> 4, at(8)),
        ]
    }

    /// 1/32 deg/s a unit, at the sensitivity of section 3.1. Assumed: an offset is added.
    fn with_gyro_offset(&self, counts: [i16; 3]) -> [i16; 3] {
        let tenths = [20972, 10486, 5243, 2620, 1310, 655, 328, 164];
        let [x, y, z, ..] = self.offsets();
        let per_unit = tenths[usize::from(self.gyro_setting().range & 7)];
        self.valid(shifted(counts, [x, y, z].map(|offset| divided(offset * per_unit, 320))))
    }

    /// 0.5 mg a unit.
    fn with_accel_offset(&self, counts: [i16; 3]) -> [i16; 3] {
        let [.., x, y, z] = self.offsets();
        let per_2g = 16384 >> self.accel_setting().range;
        self.valid(shifted(counts, [x, y, z].map(|offset| divided(offset * per_2g, 2000))))
    }

    /// −32768 and −32767 become −32766 where they would tell an invalid sample (section 14.34).
    fn valid(&self, counts: [i16; 3]) -> [i16; 3] {
        if self.holds_last() { counts } else { counts.map(|count| count.max(-32766)) }
    }
}

/// The nearest whole quotient, halves away from 0.
fn divided(n: i32, by: i32) -> i32 {
    (n + n.signum() * (by / 2)) / by
}

impl Registers for Icm42688 {
    fn pointer(&mut self) -> &mut u8 {
        &mut self.pointer
    }

    fn write(&mut self, t_ns: u64, register: u8, value: u8) {
        match (self.bank, register) {
            // Banks 5 to 7 are reserved; assumed: the selection stays.
            (_, REG_BANK_SEL) if value & 7 < 5 => self.bank = value & 7,
            (_, REG_BANK_SEL) => {}
            DEVICE_CONFIG if value & 0x01 != 0 => self.power_on(),
            SIGNAL_PATH_RESET => self.reset_signals(t_ns, value), // its bits clear themselves
            // Read only.
            (0, TEMP_DATA1..=INT_STATUS3) | FIFO_LOST_PKT0 | FIFO_LOST_PKT1 | WHO_AM_I => {}
            (1, TMSTVAL0..=0x64) => {}
            at => self.set(at, value),
        }
    }

    fn read(&mut self, _t_ns: u64, register: u8) -> u8 {
        match (self.bank, register) {
            (_, REG_BANK_SEL) => self.bank,
            INT_STATUS => self.read_status(),
            FIFO_COUNTH => {
                self.count = self.fifo_count();
                self.count_byte(0)
            }
            FIFO_COUNTL => self.count_byte(1),
            FIFO_DATA => self.pop(),
            FIFO_LOST_PKT0 => self.lost_packets as u8,
            FIFO_LOST_PKT1 => (self.lost_packets >> 8) as u8,
            (0, TEMP_DATA1..TMST_FSYNCH) => {
                self.clear_by_data(4, DATA_READY);
                match register {
                    TEMP_DATA1..ACCEL_DATA_X1 => {
                        let [high, low] = self.temperature().to_be_bytes();
                        if (register == TEMP_DATA1) == self.is_big_endian() { high } else { low }
                    }
                    ACCEL_DATA_X1..GYRO_DATA_X1 => self.data(Channel::Accel, register - ACCEL_DATA_X1),
                    _ => self.data(Channel::Gyro, register - GYRO_DATA_X1),
                }
            }
            at => self.of(at),
        }
    }

    fn after(&self, register: u8) -> u8 {
        if (self.bank, register) == FIFO_DATA { register } else { register.wrapping_add(1) & 0x7f }
    }
}

impl Chip for Icm42688 {
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
        let [gyro, accel] = taken(self, samples);
        if self.of(PWR_MGMT0) & 0x20 == 0 {
            self.celsius = samples.temperature_c.unwrap_or(self.celsius); // not TEMP_DIS
        }
        if gyro.is_none() && accel.is_none() {
            return;
        }
        let packet = self.packet(gyro.is_some(), accel.is_some());
        if let Some(counts) = gyro {
            self.gyro.put(self.with_gyro_offset(counts), packet.is_some_and(|packet| packet.gyro));
            self.has[0] = true;
        }
        if let Some(counts) = accel {
            self.accel.put(self.with_accel_offset(counts), packet.is_some_and(|packet| packet.accel));
            self.has[1] = true;
        }
        if let Some(packet) = packet {
            self.push(t_ns, packet);
        }
        self.status |= DATA_READY;
        self.last_ns = Some(t_ns);
    }

    fn tally(&self, channel: Channel) -> Tally {
        match channel {
            Channel::Gyro => self.gyro.tally,
            Channel::Accel => self.accel.tally,
            Channel::Mag => Tally::default(),
        }
    }

    fn interrupt(&self) -> bool {
        self.status & self.of(INT_SOURCE0) & 0x7f != 0
    }

    fn lacks(&self) -> Option<&'static str> {
        let is_reset_value =
            |at: &At| RESET_VALUES.iter().any(|(other, value)| other == at && self.of(*at) == *value);
        let orders = (self.of(GYRO_CONFIG1) >> 2 & 3, self.of(ACCEL_CONFIG1) >> 3 & 3);
        if self.of(SELF_TEST_CONFIG) & 0x7f != 0 {
            Some("self-test (SELF_TEST_CONFIG): nothing deflects the readings")
        } else if self.of(SENSOR_CONFIG0) & 0x3f != 0 {
            Some("single axes turned off (SENSOR_CONFIG0): all of them measure")
        } else if self.accel_setting().rate.is_some() && self.of(PWR_MGMT0) & 3 == 2 {
            Some("the accelerometer's low-power mode (PWR_MGMT0): nothing is averaged")
        } else if orders != (1, 1) {
            Some("a UI filter of first or third order (GYRO_CONFIG1, ACCEL_CONFIG1): it is of second order")
        } else if !ANTI_ALIAS.iter().all(is_reset_value) {
            Some("the anti-alias and notch filters (GYRO_CONFIG_STATIC2 to 5, ACCEL_CONFIG_STATIC2 to 4)")
        } else if self.of(INTF_CONFIG0) & 3 == 3 {
            Some("the I²C interface turned off (INTF_CONFIG0): it still answers")
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests;
