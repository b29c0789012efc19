//! ArduPilot with an SBG Systems unit as its external AHRS (`AP_ExternalAHRS_SBG`): each packet stamped on arrival.
//!
//! It shares no code with the emulator's codec: packets are taken in byte by byte here, as that driver does (read in
//! ArduPilot 4.7-dev). The driver asks which device it is every five seconds until a firmware's version has come, and
//! tells the unit what its compass and barometer read, ten times a second each. It does not look at a packet's last byte.

use super::hil::Every;
use super::{Firmware, Own, Record, Settings};
use crate::sample::Sample;

/// Bytes of the longest payload that is kept; of a longer packet as many are passed over.
const MAX_PAYLOAD: usize = 100;
const ACCEL_SCALE: f64 = 1_048_576.0;
const GYRO_SCALE: f64 = 67_108_864.0;
const GYRO_SCALE_HIGH: f64 = 12_304_174.0;
/// The bit of IMU_SHORT's status that says which scale the gyroscope has.
const HIGH_RANGE: u16 = 0x0400;
/// The driver takes the field's numbers for milligauss.
const UT_PER_MILLIGAUSS: f64 = 0.1;
/// Which device are you?
const REQUEST: [u8; 9] = [0xff, 0x5a, 0x04, 0x10, 0x00, 0x00, 0x79, 0xf7, 0x33];

/// What the driver waits for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Await {
    Sync1,
    Sync2,
    Header,
    Payload,
    Crc,
    /// So many bytes of a packet that is too long.
    Skip(usize),
}

/// ArduPilot and its driver.
pub struct Sbg {
    awaits: Await,
    /// Id, class, length and payload of the packet under way.
    held: Vec<u8>,
    crc: Vec<u8>,
    /// How the last gyro and accelerometer readings stand in the driver.
    gyro: [f64; 3],
    accel: [f64; 3],
    /// What the accelerometer has added to the velocity since the last IMU_SHORT, and in how long, µs.
    velocity: [f64; 3],
    span_us: u64,
    at_us: Option<u64>,
    firmware: u32,
    ask: Every,
    tell_mag: Every,
    tell_air: Every,
    own: Own,
    record: Record,
}

impl Sbg {
    /// Just booted.
    pub fn new(settings: &Settings) -> Self {
        Self {
            awaits: Await::Sync1,
            held: Vec::new(),
            crc: Vec::new(),
            gyro: [0.0; 3],
            accel: [0.0; 3],
            velocity: [0.0; 3],
            span_us: 0,
            at_us: None,
            firmware: 0,
            ask: Every::new(5_000_000),
            tell_mag: Every::new(100_000),
            tell_air: Every::new(100_000),
            own: Own::new(settings.ahrs, settings.declination_rad),
            record: Record::default(),
        }
    }

    /// Takes a byte in.
    fn take(&mut self, byte: u8, now_us: u64) {
        match self.awaits {
            Await::Sync1 => self.awaits = if byte == 0xff { Await::Sync2 } else { Await::Sync1 },
            Await::Sync2 => {
                self.awaits = if byte == 0x5a { Await::Header } else { Await::Sync1 };
                self.held.clear();
                self.crc.clear();
            }
            Await::Header => {
                self.held.push(byte);
                if let [_, _, low, high] = self.held[..] {
                    self.awaits = match usize::from(u16::from_le_bytes([low, high])) {
                        0 => Await::Crc,
                        len if len > MAX_PAYLOAD => Await::Skip(len),
                        _ => Await::Payload,
                    };
                }
            }
            Await::Payload => {
                self.held.push(byte);
                let len = usize::from(u16::from_le_bytes([self.held[2], self.held[3]]));
                if self.held.len() == 4 + len {
                    self.awaits = Await::Crc;
                }
            }
            Await::Crc => {
                self.crc.push(byte);
                if let [low, high] = self.crc[..] {
                    self.awaits = Await::Sync1;
                    if crc(&self.held) == u16::from_le_bytes([low, high]) {
                        self.handle(now_us);
                    } else {
                        self.record.counts.damaged += 1;
                    }
                }
            }
            Await::Skip(1) => self.awaits = Await::Sync1,
            Await::Skip(left) => self.awaits = Await::Skip(left - 1),
        }
    }

    /// Takes a whole packet in, as of now.
    fn handle(&mut self, now_us: u64) {
        self.record.counts.packets += 1;
        let held = std::mem::take(&mut self.held);
        let (header, payload) = held.split_at(4);
        match (header[1], header[0]) {
            (0, 44) if payload.len() >= 32 => {
                let status = u16::from_le_bytes([payload[4], payload[5]]);
                let scale = if status & HIGH_RANGE == 0 { GYRO_SCALE } else { GYRO_SCALE_HIGH };
                self.accel = wholes(&payload[6..18]).map(|count| count / ACCEL_SCALE);
                self.gyro = wholes(&payload[18..30]).map(|count| count / scale);
                self.feel(said_us(payload), None, now_us);
            }
            (0, 4) if payload.len() >= 30 => {
                self.accel = reals(&payload[18..30]);
                let field = reals(&payload[6..18]).map(|milligauss| milligauss * UT_PER_MILLIGAUSS);
                self.feel(said_us(payload), Some(field), now_us);
            }
            (0, 7) => self.record.counts.foreign += 1,
            (16, 4) if payload.len() >= 52 => {
                self.record.counts.answers += 1;
                self.firmware = u32::from_le_bytes([payload[48], payload[49], payload[50], payload[51]]);
            }
            _ => {}
        }
    }

    /// An inertial sample of what the driver holds, for the time since the one before: of MAG too, so that its
    /// accelerometer stands for a part of the time up to the next IMU_SHORT. The estimator is given the mean.
    fn feel(&mut self, said_us: u64, mag: Option<[f64; 3]>, now_us: u64) {
        self.record.counts.samples += 1;
        let dt_us = now_us - self.at_us.replace(now_us).unwrap_or(now_us);
        self.span_us += dt_us;
        self.velocity = std::array::from_fn(|i| self.velocity[i] + self.accel[i] * dt_us as f64);
        let mut sample = Sample { t_us: now_us, mag, ..Sample::default() };
        if mag.is_none() {
            let mean = self.velocity.map(|velocity| velocity / self.span_us as f64);
            sample.gyro = Some(self.gyro);
            sample.accel = Some(if self.span_us == 0 { self.accel } else { mean });
            (self.velocity, self.span_us) = ([0.0; 3], 0);
        }
        self.own.take(&sample, Some(said_us), &mut self.record);
    }
}

impl Firmware for Sbg {
    fn receive(&mut self, bytes: &[u8], now_us: u64, _out: &mut Vec<u8>) {
        bytes.iter().for_each(|&byte| self.take(byte, now_us));
    }

    fn turn(&mut self, now_us: u64, out: &mut Vec<u8>) {
        if self.firmware == 0 && self.ask.is_due(now_us) {
            self.record.counts.asked += 1;
            out.extend_from_slice(&REQUEST);
        }
        if self.tell_mag.is_due(now_us) {
            out.extend(packet(4, &[0; 30]));
        }
        if self.tell_air.is_due(now_us) {
            out.extend(packet(36, &[0; 26]));
        }
    }

    fn record(&self) -> &Record {
        &self.record
    }
}

/// The sender's time, µs.
fn said_us(payload: &[u8]) -> u64 {
    u32::from_le_bytes([payload[0], payload[1], payload[2], payload[3]]).into()
}

/// Three whole numbers.
fn wholes(bytes: &[u8]) -> [f64; 3] {
    std::array::from_fn(|i| {
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| bytes[4 * i + k]);
        i32::from_le_bytes([a, b, c, d]).into()
    })
}

/// Three floats.
fn reals(bytes: &[u8]) -> [f64; 3] {
    std::array::from_fn(|i| {
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| bytes[4 * i + k]);
        f32::from_le_bytes([a, b, c, d]).into()
    })
}

/// A packet of class 0.
fn packet(id: u8, payload: &[u8]) -> Vec<u8> {
    let mut inside = vec![id, 0];
    inside.extend((payload.len() as u16).to_le_bytes());
    inside.extend_from_slice(payload);
    let crc = crc(&inside).to_le_bytes();
    [&[0xff, 0x5a][..], &inside, &crc, &[0x33]].concat()
}

/// CRC-16/KERMIT, bit by bit.
fn crc(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0, |crc, &byte| {
        (0..8).fold(crc ^ u16::from(byte), |crc, _| if crc & 1 == 0 { crc >> 1 } else { crc >> 1 ^ 0x8408 })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const IMU: &str = "ff5a2c0020003fb38202ff0300000000cf4fffff591863ff1392e0006d4a0000594742000019e9b233";
    const MAG: &str = "ff5a04001e003fb38202ff01bea42f43289602c3d949d74300000000083130bda7e71cc10b3133";

    fn bytes(hex: &str) -> Vec<u8> {
        (0..hex.len()).step_by(2).map(|i| u8::from_str_radix(&hex[i..i + 2], 16).unwrap()).collect()
    }

    #[test]
    fn the_checksum_has_its_check_value_and_makes_the_request() {
        assert_eq!(crc(b"123456789"), 0x2189);
        assert_eq!(crc(&REQUEST[2..6]).to_le_bytes(), REQUEST[6..8]);
    }

    #[test]
    fn golden_packets_say_what_they_were_made_of() {
        let mut firmware = Sbg::new(&Settings::default());
        firmware.receive(&[&[1, 0xff, 2][..], &bytes(IMU), &bytes(MAG)].concat(), 7, &mut Vec::new());
        let near = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6);
        assert!(near(firmware.gyro, [0.219307, 0.000284, 0.064725]), "{:?}", firmware.gyro);
        assert!(near(firmware.accel, [0.0, -0.0430155, -9.806556]), "{:?}", firmware.accel);
        let counts = firmware.record().counts;
        assert_eq!((counts.packets, counts.samples, counts.damaged), (2, 2, 0));
        // The same status with the bit of the larger range.
        let mut fast = bytes(IMU);
        fast[11] |= 0x04;
        let crc = crc(&fast[2..38]).to_le_bytes();
        fast[38..40].copy_from_slice(&crc);
        firmware.receive(&fast, 8, &mut Vec::new());
        let scale = GYRO_SCALE / GYRO_SCALE_HIGH;
        assert!(near(firmware.gyro, [0.219_307_23 * scale, 0.000_283_9 * scale, 0.064_725_3 * scale]));
    }

    #[test]
    fn it_asks_every_five_seconds_until_a_firmware_has_answered() {
        let mut firmware = Sbg::new(&Settings::default());
        let mut out = Vec::new();
        (0..12_000_000).step_by(10_000).for_each(|now_us| firmware.turn(now_us, &mut out));
        assert_eq!(firmware.record().counts.asked, 3);
        let told = (out.len() - 3 * REQUEST.len()) / (39 + 35);
        assert!((119..=121).contains(&told), "{told} of compass and barometer each");
        let mut answer = vec![4, 16, 52, 0];
        answer.extend([0; 48]);
        answer.extend([0, 0, 1, 0]);
        let crc = crc(&answer).to_le_bytes();
        firmware.receive(&[&[0xff, 0x5a][..], &answer, &crc, &[0x33]].concat(), 12_000_000, &mut Vec::new());
        (12_000_000..30_000_000).step_by(10_000).for_each(|now_us| firmware.turn(now_us, &mut out));
        assert_eq!((firmware.record().counts.asked, firmware.record().counts.answers), (3, 1));
    }

    #[test]
    fn a_packet_that_is_too_long_is_passed_over() {
        let long = packet(200, &[0x11; 300]);
        let mut firmware = Sbg::new(&Settings::default());
        firmware.receive(&[long, bytes(IMU)].concat(), 0, &mut Vec::new());
        assert_eq!(firmware.record().counts.samples, 1);
    }
}
