//! The FIFO of an MPU: which bytes a sample puts there, and what a full one loses.

use super::{CONFIG, Channel, FIFO_EN, FIFO_OVERFLOW, Model, Mpu, Tally, USER_CTRL, add};
use crate::chip::fifo::{Frame, Full, Mark};

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
            // Assumed: all that the slaves read enters with any of their bits.
            Channel::Mag => return self.fifo_is_on() && self.of(FIFO_EN) & SLAVES != 0,
        };
        self.fifo_is_on() && self.of(FIFO_EN) & bits == bits
    }

    /// Puts what FIFO_EN selects of the newest sample there, in the order of the registers. `with_gyro` and
    /// `with_accel` are whether theirs are new: that of a slower one, or of one that is off, is repeated.
    pub(super) fn push_frame(&mut self, with_gyro: bool, with_accel: bool) {
        let enabled = if self.fifo_is_on() { self.of(FIFO_EN) } else { 0 };
        // The driver has turned it off since that sample was taken.
        self.accel.tally.missed += u64::from(with_accel && enabled & ACCEL == 0);
        let mut frame = Frame::new();
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
        frame.is_sample(Channel::Gyro, 6, with_gyro && enabled & GYRO == GYRO);
        if enabled & SLAVES != 0 {
            self.external.add_to(&mut frame, 0..self.external.len);
        }
        self.push_whole(frame.bytes());
    }

    /// Bytes that enter together: 1024 are in that of an MPU-6050 at most (PS-MPU-6000A), 512 in the others (PS-MPU-9250A).
    /// Where there is no room the oldest bytes go, one by one, or with FIFO_MODE (CONFIG bit 6 of an MPU-6500 or MPU-9250)
    /// the new ones.
    fn push_whole(&mut self, bytes: &[(u8, Mark)]) {
        let is_first = self.model == Model::Mpu60x0;
        let full = if !is_first && self.of(CONFIG) & 0x40 != 0 { Full::Stops } else { Full::LosesBytes };
        if let Some(lost) = self.fifo.put(bytes, if is_first { 1024 } else { 512 }, full) {
            self.status |= FIFO_OVERFLOW;
            self.count(lost.samples, |tally| &mut tally.overflowed);
        }
    }

    /// Adds samples of gyro, accelerometer and magnetometer to one of their counts.
    fn count(&mut self, samples: [u64; 3], of: fn(&mut Tally) -> &mut u64) {
        let tallies = [&mut self.gyro.tally, &mut self.accel.tally, self.external.tally_of_fifo()];
        tallies.into_iter().zip(samples).for_each(|(tally, samples)| *of(tally) += samples);
    }

    /// A byte that a driver writes there.
    pub(super) fn push_free(&mut self, byte: u8) {
        self.push_whole(&[(byte, Mark::default())]);
    }

    /// Empties it; its samples are missed.
    pub(super) fn empty_fifo(&mut self) {
        let ended = self.fifo.clear();
        self.count(ended, |tally| &mut tally.missed);
    }

    /// The oldest byte; the last one again where it is empty (RM-MPU-6000A p. 44).
    pub(super) fn pop(&mut self) -> u8 {
        if let Some((byte, ends)) = self.fifo.pop() {
            let mut read = [0; 3];
            add(&mut read, ends);
            self.count(read, |tally| &mut tally.read);
            self.last = byte;
        }
        self.last
    }
}
