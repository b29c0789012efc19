//! The FIFO of an MPU: which bytes a sample puts there, and what a full one loses.

use super::{CONFIG, Channel, FIFO_EN, FIFO_OVERFLOW, Model, Mpu, USER_CTRL, add};
use crate::chip::fifo::Mark;

/// Bits of FIFO_EN.
const TEMP: u8 = 0x80;
const GYRO: u8 = 0x70;
const ACCEL: u8 = 0x08;
const SLAVES: u8 = 0x07;

impl Mpu {
    fn fifo_is_on(&self) -> bool {
        self.of(USER_CTRL) & 0x40 != 0
    }

    /// Whether the FIFO takes whole samples of the channel.
    pub(super) fn fifo_takes(&self, channel: Channel) -> bool {
        let bits = match channel {
            Channel::Gyro => GYRO,
            Channel::Accel => ACCEL,
            Channel::Mag => return false,
        };
        self.fifo_is_on() && self.of(FIFO_EN) & bits == bits
    }

    /// 1024 bytes of an MPU-6050 (PS-MPU-6000A), 512 of the others (PS-MPU-9250A).
    fn room(&self) -> usize {
        let size = if self.model == Model::Mpu60x0 { 1024 } else { 512 };
        size - self.fifo.len().min(size)
    }

    /// Puts what FIFO_EN selects of the newest sample there, in the order of the registers. `with_accel` is whether the
    /// accelerometer's sample is new: at a faster gyro it is repeated.
    pub(super) fn push_frame(&mut self, with_accel: bool) {
        if !self.fifo_is_on() {
            return;
        }
        let enabled = self.of(FIFO_EN);
        let mut frame = Frame::default();
        if enabled & ACCEL != 0 {
            let [x, y, z] = self.accel.counts.map(i16::to_be_bytes);
            frame.add(&[x[0], x[1], y[0], y[1], z[0], z[1]]);
            frame.is_sample(Channel::Accel, 6, with_accel);
        }
        if enabled & TEMP != 0 {
            frame.add(&self.temperature());
        }
        for (axis, count) in self.gyro.counts.iter().enumerate() {
            if enabled & (0x40 >> axis) != 0 {
                frame.add(&count.to_be_bytes());
            }
        }
        frame.is_sample(Channel::Gyro, 6, enabled & GYRO == GYRO);
        if enabled & SLAVES != 0 {
            frame.add(&self.external.bytes[..self.external.len]);
        }
        self.push_whole(&frame.bytes[..frame.len]);
    }

    /// Bytes that enter together. Where there is no room the oldest bytes go, one by one, or with FIFO_MODE (CONFIG bit 6 of
    /// an MPU-6500 or MPU-9250) the new ones.
    fn push_whole(&mut self, bytes: &[(u8, Mark)]) {
        let stops = self.model != Model::Mpu60x0 && self.of(CONFIG) & 0x40 != 0;
        if self.room() < bytes.len() {
            self.status |= FIFO_OVERFLOW;
            if stops {
                return bytes.iter().for_each(|(_, mark)| self.count_lost(mark.begins));
            }
        }
        while self.room() < bytes.len() {
            match self.fifo.lose() {
                Some(lost) => self.count_lost(lost),
                None => break,
            }
        }
        bytes.iter().for_each(|&(byte, mark)| self.fifo.push(byte, mark));
    }

    fn count_lost(&mut self, channels: u8) {
        let mut lost = [0; 3];
        add(&mut lost, channels);
        self.gyro.tally.overflowed += lost[Channel::Gyro as usize];
        self.accel.tally.overflowed += lost[Channel::Accel as usize];
    }

    /// A byte that a driver writes there.
    pub(super) fn push_free(&mut self, byte: u8) {
        self.push_whole(&[(byte, Mark::default())]);
    }

    /// Empties it; its samples are missed.
    pub(super) fn empty_fifo(&mut self) {
        let ended = self.fifo.clear();
        self.gyro.tally.missed += ended[Channel::Gyro as usize];
        self.accel.tally.missed += ended[Channel::Accel as usize];
    }

    /// The oldest byte; the last one again where it is empty (RM-MPU-6000A p. 44).
    pub(super) fn pop(&mut self) -> u8 {
        if let Some((byte, ends)) = self.fifo.pop() {
            let mut read = [0; 3];
            add(&mut read, ends);
            self.gyro.tally.read += read[Channel::Gyro as usize];
            self.accel.tally.read += read[Channel::Accel as usize];
            self.last = byte;
        }
        self.last
    }
}

/// What one sample puts in the FIFO.
struct Frame {
    bytes: [(u8, Mark); 40],
    len: usize,
}

impl Default for Frame {
    fn default() -> Frame {
        Frame { bytes: [(0, Mark::default()); 40], len: 0 }
    }
}

impl Frame {
    fn add(&mut self, bytes: &[u8]) {
        for (to, byte) in self.bytes[self.len..].iter_mut().zip(bytes) {
            to.0 = *byte;
            self.len += 1;
        }
    }

    /// Its last `len` bytes are a new sample of the channel, if `really`.
    fn is_sample(&mut self, channel: Channel, len: usize, really: bool) {
        if let Some(first) = self.len.checked_sub(len).filter(|_| really) {
            self.bytes[first].1.begins |= 1 << channel as u8;
            self.bytes[self.len - 1].1.ends |= 1 << channel as u8;
        }
    }
}
