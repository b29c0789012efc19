//! The FIFO of an ICM-20948: which bytes a sample puts there, and what a full one loses.

use super::{Channel, FIFO_EN_1, FIFO_EN_2, FIFO_MODE, FIFO_RST, Icm20948, OVERFLOW, Tally, USER_CTRL, add};
use crate::chip::fifo::{Frame, Full, Mark};

/// Bits of FIFO_EN_2.
const TEMP: u8 = 0x01;
const GYRO: u8 = 0x0e;
const ACCEL: u8 = 0x10;

/// Bytes. The sheet's FIFO_COUNT has 13 bits; without a DMP the FIFO has 512 bytes (assumed: section 4.16 was not at hand;
/// PX4's driver and icm20948-rs take 512).
const SIZE: usize = 512;

impl Icm20948 {
    fn fifo_is_on(&self) -> bool {
        self.of(USER_CTRL) & 0x40 != 0 && !self.is_fifo_held()
    }

    /// Whether FIFO_RST holds it empty. Assumed: bit 0 alone, of five, is its only FIFO's.
    pub(super) fn is_fifo_held(&self) -> bool {
        self.of(FIFO_RST) & 0x01 != 0
    }

    /// Whether the FIFO takes whole samples of the channel.
    pub(super) fn fifo_takes(&self, channel: Channel) -> bool {
        let bits = match channel {
            Channel::Gyro => GYRO,
            Channel::Accel => ACCEL,
            Channel::Mag => return false,
        };
        self.fifo_is_on() && self.of(FIFO_EN_2) & bits == bits
    }

    /// Bit i is whether it takes what slave i reads.
    pub(super) fn fifo_takes_slaves(&self) -> u8 {
        if self.fifo_is_on() { self.of(FIFO_EN_1) & 0x0f } else { 0 }
    }

    /// Puts what FIFO_EN_1 and FIFO_EN_2 select of the newest sample there, in the order of the registers. `gyro` and `accel`
    /// are whether the channel's sample is new: a slower one is repeated.
    pub(super) fn push_frame(&mut self, gyro: bool, accel: bool) {
        if !self.fifo_is_on() {
            return;
        }
        let enabled = self.of(FIFO_EN_2);
        let mut frame = Frame::new();
        if enabled & ACCEL != 0 {
            self.accel.counts.iter().for_each(|count| frame.add(&count.to_be_bytes()));
            frame.is_sample(Channel::Accel, 6, accel);
        }
        for (axis, count) in self.gyro.counts.iter().enumerate() {
            if enabled & (0x02 << axis) != 0 {
                frame.add(&count.to_be_bytes());
            }
        }
        frame.is_sample(Channel::Gyro, 6, gyro && enabled & GYRO == GYRO);
        if enabled & TEMP != 0 {
            frame.add(&self.temperature());
        }
        self.add_slaves(&mut frame);
        self.push_whole(frame.bytes());
    }

    /// What slave i read, for bit i of FIFO_EN_1: slaves lie one behind the other in the external sensor data.
    fn add_slaves(&self, frame: &mut Frame) {
        let mut from = 0;
        for i in 0..4 {
            let slave = self.slave(i);
            if slave.control & 0x80 == 0 || slave.address & 0x80 == 0 {
                continue;
            }
            let to = (from + usize::from(slave.control & 0x0f)).min(self.external.bytes.len());
            if self.of(FIFO_EN_1) & (1 << i) != 0 {
                self.external.add_to(frame, from..to);
            }
            from = to;
        }
    }

    /// Bytes that enter together. Where there is no room the oldest bytes go, one by one, or with FIFO_MODE 1, snapshot, the
    /// new ones.
    fn push_whole(&mut self, bytes: &[(u8, Mark)]) {
        let full = if self.of(FIFO_MODE) & 0x01 != 0 { Full::Stops } else { Full::LosesBytes };
        if let Some(lost) = self.fifo.put(bytes, SIZE, full) {
            self.status[OVERFLOW] |= 0x01;
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
        if !self.is_fifo_held() {
            self.push_whole(&[(byte, Mark::default())]);
        }
    }

    /// Empties it; its samples are missed.
    pub(super) fn empty_fifo(&mut self) {
        let ended = self.fifo.clear();
        self.count(ended, |tally| &mut tally.missed);
    }

    /// The oldest byte. Assumed: an empty one reads 0xff, as that of the ICM-20690 (DS-000178 p. 68).
    pub(super) fn pop(&mut self) -> u8 {
        let Some((byte, ends)) = self.fifo.pop() else { return 0xff };
        let mut read = [0; 3];
        add(&mut read, ends);
        self.count(read, |tally| &mut tally.read);
        byte
    }
}
