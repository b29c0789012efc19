//! What Bosch's chips share: a FIFO of frames, two sensors that fill it, a clock, offsets.

mod frames;

pub(super) use frames::Frames;

use super::fifo::add;
use super::{Channel, Latest, Setting, Tally};

/// Data ready, in the status register of a BMI088's accelerometer, a BMI160 and a BMI270.
pub(super) const DRDY_ACC: u8 = 0x80;
/// Data ready of the gyro.
pub(super) const DRDY_GYR: u8 = 0x40;

const GYRO: u8 = 1 << Channel::Gyro as u8;
const ACCEL: u8 = 1 << Channel::Accel as u8;

/// What a chip's registers say of its FIFO.
#[derive(Clone, Copy, Debug)]
pub(super) struct Queue {
    /// Whether a frame begins with a header.
    pub headers: bool,
    pub gyro: bool,
    pub accel: bool,
    /// Whether a full one keeps the oldest frames.
    pub stops: bool,
    /// FIFO_DOWNS: every 2^n-th sample enters, bits 2:0 of the gyro, 6:4 of the accelerometer.
    pub downs: u8,
}

impl Queue {
    /// Of the bits of FIFO_INPUT_CONFIG those whose sensor is in the FIFO: 1:0 are the accelerometer's, 3:2 the gyro's.
    pub fn changed(self, bits: u8) -> u8 {
        let accel = if self.accel { bits & 0x03 } else { 0 };
        accel | if self.gyro { bits & 0x0c } else { 0 }
    }

    /// Whether a sensor's samples enter before its filter: FIFO_DOWNS bits 3 and 7 are clear.
    pub fn is_unfiltered(self) -> bool {
        (self.gyro && self.downs & 0x08 == 0) || (self.accel && self.downs & 0x80 == 0)
    }
}

/// The newest sample of both sensors, and the FIFO.
#[derive(Clone, Debug)]
pub(super) struct Sensors<const N: usize> {
    pub gyro: Latest,
    pub accel: Latest,
    /// `DRDY_ACC`, `DRDY_GYR`: not read since it was measured.
    pub ready: u8,
    /// The same, until the interrupt's status is read.
    pub fired: u8,
    pub frames: Frames<N>,
    /// Samples since one entered the FIFO, of gyro and accelerometer.
    turns: [u8; 2],
}

impl<const N: usize> Sensors<N> {
    /// `size` bytes of the FIFO are in use.
    pub fn new(size: usize) -> Self {
        let (gyro, accel) = (Latest::default(), Latest::default());
        Self { gyro, accel, ready: 0, fired: 0, frames: Frames::new(size), turns: [0; 2] }
    }

    /// As a reset does; what was not read is missed.
    pub fn clear(&mut self) {
        self.flush();
        self.gyro.clear();
        self.accel.clear();
        (self.ready, self.fired, self.turns) = (0, 0, [0; 2]);
    }

    /// Empties the FIFO; its samples are missed.
    pub fn flush(&mut self) {
        let gone = self.frames.clear();
        self.gyro.tally.missed += gone[Channel::Gyro as usize];
        self.accel.tally.missed += gone[Channel::Accel as usize];
    }

    /// Takes what was measured at one moment.
    pub fn take(&mut self, gyro: Option<[i16; 3]>, accel: Option<[i16; 3]>, queue: Queue) {
        let enters = [
            gyro.is_some() && queue.gyro && enters(&mut self.turns[0], queue.downs & 7),
            accel.is_some() && queue.accel && enters(&mut self.turns[1], queue.downs >> 4 & 7),
        ];
        if let Some(counts) = gyro {
            self.gyro.put(counts, enters[0]);
            self.ready |= DRDY_GYR;
            self.fired |= DRDY_GYR;
        }
        if let Some(counts) = accel {
            self.accel.put(counts, enters[1]);
            self.ready |= DRDY_ACC;
            self.fired |= DRDY_ACC;
        }
        if enters != [false; 2] {
            self.push(enters, queue);
        }
    }

    /// A frame of those that enter, gyro first. Without headers every frame has both that are enabled.
    fn push(&mut self, [gyro, accel]: [bool; 2], queue: Queue) {
        let (mut frame, mut len) = ([0; 13], 0);
        if queue.headers {
            frame[0] = 0x80 | u8::from(gyro) << 3 | u8::from(accel) << 2;
            len = 1;
        }
        let parts = [(gyro || (!queue.headers && queue.gyro), &self.gyro), {
            (accel || (!queue.headers && queue.accel), &self.accel)
        }];
        for (_, latest) in parts.into_iter().filter(|(is_in, _)| *is_in) {
            for count in latest.counts {
                frame[len..len + 2].copy_from_slice(&count.to_le_bytes());
                len += 2;
            }
        }
        let channels = if gyro { GYRO } else { 0 } | if accel { ACCEL } else { 0 };
        let lost = self.frames.push(&frame[..len], channels, queue.stops);
        self.gyro.tally.overflowed += lost[Channel::Gyro as usize];
        self.accel.tally.overflowed += lost[Channel::Accel as usize];
    }

    /// Bytes in the FIFO, with the frame that tells how many were skipped.
    pub fn fifo_length(&self, headers: bool) -> usize {
        let skip = headers && self.frames.skipped() > 0;
        self.frames.len() + if skip { 2 } else { 0 }
    }

    /// Puts a frame there which says what changed (FIFO_INPUT_CONFIG).
    pub fn push_config(&mut self, frame: &[u8], stops: bool) {
        let lost = self.frames.push(frame, 0, stops);
        self.gyro.tally.overflowed += lost[Channel::Gyro as usize];
        self.accel.tally.overflowed += lost[Channel::Accel as usize];
    }

    /// The next byte of the FIFO; `time` is the frame of the sensor's time, where one is wanted.
    pub fn next_byte(&mut self, headers: bool, time: Option<[u8; 3]>) -> u8 {
        let (byte, whole) = self.frames.next_byte(headers, time);
        let mut read = [0; 3];
        add(&mut read, whole);
        self.gyro.tally.read += read[Channel::Gyro as usize];
        self.accel.tally.read += read[Channel::Accel as usize];
        byte
    }

    /// A byte of the gyro's newest sample, low byte of x first.
    pub fn gyro_byte(&mut self, byte: u8) -> u8 {
        self.ready &= !DRDY_GYR;
        self.gyro.low_first(byte)
    }

    /// A byte of the accelerometer's newest sample, low byte of x first.
    pub fn accel_byte(&mut self, byte: u8) -> u8 {
        self.ready &= !DRDY_ACC;
        self.accel.low_first(byte)
    }

    pub fn tally(&self, channel: Channel) -> Tally {
        match channel {
            Channel::Gyro => self.gyro.tally,
            Channel::Accel => self.accel.tally,
            Channel::Mag => Tally::default(),
        }
    }
}

/// Whether this sample is one of every 2^`downs`.
fn enters(turn: &mut u8, downs: u8) -> bool {
    let enters = *turn == 0;
    *turn = (*turn + 1) & ((1 << downs) - 1);
    enters
}

/// Ticks of 39.0625 µs in 24 bits, low byte first (BST-BMI088-DS001 section 5.3.5, BST-BMI160-DS000 section 2.3.1).
pub(super) fn sensor_time(t_ns: u64) -> [u8; 3] {
    let ticks = t_ns / 78_125 * 2 + t_ns % 78_125 * 2 / 78_125;
    let [low, middle, high, ..] = ticks.to_le_bytes();
    [low, middle, high]
}

/// 100 Hz · 2^(code − 8), as ODR fields name rates; none for 0.
pub(super) fn rate(code: u8) -> Option<(u32, u32)> {
    match code {
        1..6 => Some((25, 1 << (6 - code))),
        6..=15 => Some((25 << (code - 6), 1)),
        _ => None,
    }
}

/// Filters by their field: 0 oversamples fourfold, 1 twofold, 2 does not.
pub(super) fn filter(code: u8) -> Option<&'static str> {
    ["OSR4", "OSR2", "normal"].get(usize::from(code)).copied()
}

/// Full scale of a gyro, whose codes run from ±2000 °/s down to ±125 °/s; reserved codes are taken for the last.
pub(super) fn gyro_range(code: u8) -> u8 {
    4 - code.min(4)
}

/// A channel that is off has no rate.
pub(super) fn setting(
    is_on: bool,
    rate: Option<(u32, u32)>,
    range: u8,
    filter: Option<&'static str>,
) -> Setting {
    Setting { rate: rate.filter(|_| is_on), range, filter }
}

/// Counts with a driver's offsets: `step` counts at the smallest full scale for each unit.
pub(super) fn shifted(counts: [i16; 3], offsets: [i16; 3], step: i32, range: u8) -> [i16; 3] {
    let mut shifted = counts;
    for (count, offset) in shifted.iter_mut().zip(offsets) {
        let moved = i32::from(*count) + ((i32::from(offset) * step) >> range);
        *count = moved.clamp(i32::from(i16::MIN), i32::from(i16::MAX)) as i16;
    }
    shifted
}

/// Offsets of the gyro, ten bits: three low bytes, then two high bits of each, x lowest.
pub(super) fn gyro_offsets([x, y, z, high]: [u8; 4]) -> [i16; 3] {
    let mut offsets = [0; 3];
    for (axis, low) in [x, y, z].into_iter().enumerate() {
        let word = u16::from(high >> (2 * axis) & 3) << 14 | u16::from(low) << 6;
        offsets[axis] = word as i16 >> 6;
    }
    offsets
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sensors_time_overflows_after_655_36_s() {
        assert_eq!(sensor_time(39_062), [0, 0, 0]);
        assert_eq!(sensor_time(39_063), [1, 0, 0]);
        assert_eq!(sensor_time(10_000_000), [0, 1, 0]);
        assert_eq!(sensor_time(655_360_000_000), [0, 0, 0]);
        assert_eq!(sensor_time(655_359_999_999), [0xff; 3]);
        sensor_time(u64::MAX);
    }

    #[test]
    fn rates_are_exact_fractions() {
        let rates =
            [(0, None), (1, Some((25, 32))), (5, Some((25, 2))), (6, Some((25, 1))), (8, Some((100, 1)))];
        for (code, expected) in rates.into_iter().chain([(12, Some((1600, 1))), (13, Some((3200, 1)))]) {
            assert_eq!(rate(code), expected, "{code}");
        }
    }

    #[test]
    fn a_gyros_offsets_have_ten_bits() {
        assert_eq!(gyro_offsets([1, 0xff, 0, 0b10_11_00]), [1, -1, -512]);
        assert_eq!(gyro_offsets([0xff, 0, 0, 0b01]), [511, 0, 0]);
    }
}
