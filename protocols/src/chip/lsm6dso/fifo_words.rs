//! The FIFO of an LSM6DSO: 512 words of a tag and six bytes (DS12140 section 6.5; AN5192).

use super::{
    COUNTER_BDR_REG1, COUNTER_BDR_REG2, CTRL1_XL, CTRL2_G, FIFO_CTRL1, FIFO_CTRL2, FIFO_CTRL3, FIFO_CTRL4,
    Lsm6dso,
};
use crate::chip::fifo::{Mark, add};
use crate::chip::{Channel, Fifo};

const WORDS: usize = 512;
const WORD: usize = 7;

/// TAG_SENSOR (DS12140, register 0x78).
const TAG_GYRO: u8 = 0x01;
const TAG_ACCEL: u8 = 0x02;
const TAG_TEMPERATURE: u8 = 0x03;
const TAG_TIMESTAMP: u8 = 0x04;

/// The FIFO and what it counts.
#[derive(Clone, Debug)]
pub(super) struct Words {
    fifo: Fifo<{ WORDS * WORD }>,
    /// Samples since one was batched, of gyro and accelerometer.
    turns: [u16; 2],
    /// Time slots, of which the tags have two bits, and words of the newest one.
    slots: u8,
    newest: usize,
    /// When the next temperature is due, ns.
    temperature_ns: u64,
    /// Batched samples of the sensor that COUNTER_BDR_REG1 chooses.
    pub batches: u16,
    pub counter_reached: bool,
    pub overrun_latched: bool,
}

impl Words {
    pub const fn new() -> Words {
        Words {
            fifo: Fifo::new(),
            turns: [0; 2],
            slots: 0,
            newest: 0,
            temperature_ns: 0,
            batches: 0,
            counter_reached: false,
            overrun_latched: false,
        }
    }

    pub const fn len(&self) -> usize {
        self.fifo.len() / WORD
    }

    fn pop(&mut self) -> u8 {
        (0..WORD).filter_map(|_| self.fifo.pop()).fold(0, |whole, (_, ends)| whole | ends)
    }

    /// TAG_SENSOR, TAG_CNT, and the parity that makes the number of ones even.
    fn tag(&self, sensor: u8) -> u8 {
        let tag = sensor << 3 | (self.slots & 3) << 1;
        tag | (tag.count_ones() & 1) as u8
    }
}

/// Whether this sample is one of every 2^`log`.
fn is_batched(turn: &mut u16, log: u8) -> bool {
    let is_batched = *turn == 0;
    *turn = (*turn + 1) & ((1 << log) - 1);
    is_batched
}

impl Lsm6dso {
    /// Whether words enter: in FIFO mode, in continuous mode, and in mode 3 before its event.
    pub(super) fn fifo_runs(&self) -> bool {
        matches!(self.of(FIFO_CTRL4) & 7, 1 | 3 | 6)
    }

    /// Words that it has room for in all: STOP_ON_WTM limits them.
    fn depth(&self) -> usize {
        let mark = self.watermark();
        if self.of(FIFO_CTRL2) & 0x80 != 0 && mark > 0 { mark } else { WORDS }
    }

    fn watermark(&self) -> usize {
        usize::from(self.of(FIFO_CTRL2) & 1) << 8 | usize::from(self.of(FIFO_CTRL1))
    }

    /// BDR_GY: rates are halves of each other, and never above the gyro's own; 11 is 6.5 Hz.
    pub(super) fn batches_gyro(&mut self) -> bool {
        let (batch, odr) = (self.of(FIFO_CTRL3) >> 4, self.of(CTRL2_G) >> 4);
        let log = if batch == 11 { odr } else { odr.saturating_sub(batch) };
        let runs = self.fifo_runs() && (1..=11).contains(&batch);
        runs && is_batched(&mut self.words.turns[0], log)
    }

    /// BDR_XL: 11 is 1.6 Hz, an eighth of 12.5 Hz (assumed: its maker's driver names it 6.5 Hz).
    pub(super) fn batches_accel(&mut self) -> bool {
        let (batch, odr) = (self.of(FIFO_CTRL3) & 0x0f, self.of(CTRL1_XL) >> 4);
        let log = match (batch, odr) {
            (_, 11) => 0,
            (11, _) => odr + 2,
            _ => odr.saturating_sub(batch),
        };
        let runs = self.fifo_runs() && (1..=11).contains(&batch);
        runs && is_batched(&mut self.words.turns[1], log)
    }

    /// One time slot: the words of what is batched at this moment (assumed: time, which Linux's driver takes for that of the
    /// samples behind it, then gyro, accelerometer and temperature).
    pub(super) fn batch(&mut self, t_ns: u64, [gyro, accel]: [bool; 2]) {
        if !self.fifo_runs() {
            return;
        }
        let before = self.words.slots;
        self.words.slots = before.wrapping_add(1);
        self.words.newest = 0;
        if gyro || accel {
            self.batch_time(t_ns);
            self.count_batch([gyro, accel]);
        }
        if gyro {
            self.push_sample(TAG_GYRO, self.gyro.counts, Channel::Gyro);
        }
        if accel {
            self.push_sample(TAG_ACCEL, self.accel.counts, Channel::Accel);
        }
        self.batch_temperature(t_ns);
        if self.words.newest == 0 {
            self.words.slots = before;
        }
    }

    /// ODR_T_BATCH: 1.6, 12.5 or 52 Hz.
    fn batch_temperature(&mut self, t_ns: u64) {
        let period_ns = match self.of(FIFO_CTRL4) >> 4 & 3 {
            0 => return,
            1 => 625_000_000,
            2 => 80_000_000,
            _ => 19_230_769,
        };
        if t_ns >= self.words.temperature_ns {
            self.words.temperature_ns = t_ns.saturating_add(period_ns);
            let [low, high] = self.thermometer();
            self.push_word(TAG_TEMPERATURE, [low, high, 0, 0, 0, 0], None);
        }
    }

    /// DEC_TS_BATCH: with every slot, every 8th or every 32nd (assumed: the last two bytes are 0).
    fn batch_time(&mut self, t_ns: u64) {
        let every = match self.of(FIFO_CTRL4) >> 6 {
            0 => return,
            1 => 1,
            2 => 8,
            _ => 32,
        };
        if self.words.slots.is_multiple_of(every) {
            let [a, b, c, d] = self.timestamp(t_ns);
            self.push_word(TAG_TIMESTAMP, [a, b, c, d, 0, 0], None);
        }
    }

    /// COUNTER_BDR_REG1: bit 5 chooses the gyro's batches.
    fn count_batch(&mut self, [gyro, accel]: [bool; 2]) {
        let control = self.of(COUNTER_BDR_REG1);
        let threshold = u16::from(control & 7) << 8 | u16::from(self.of(COUNTER_BDR_REG2));
        self.words.batches += u16::from(if control & 0x20 != 0 { gyro } else { accel });
        if threshold > 0 && self.words.batches >= threshold {
            self.words.batches = 0;
            self.words.counter_reached = true;
        }
        self.words.batches %= 2048;
    }

    fn push_sample(&mut self, tag: u8, counts: [i16; 3], channel: Channel) {
        let [x, y, z] = counts.map(i16::to_le_bytes);
        self.push_word(tag, [x[0], x[1], y[0], y[1], z[0], z[1]], Some(channel));
    }

    /// A full FIFO loses its oldest word, or in FIFO mode and with STOP_ON_WTM the new one.
    fn push_word(&mut self, tag: u8, data: [u8; 6], channel: Option<Channel>) {
        self.words.newest += 1;
        let stops = self.of(FIFO_CTRL4) & 7 == 1 || self.of(FIFO_CTRL2) & 0x80 != 0;
        if self.words.len() >= self.depth() {
            self.words.overrun_latched = true;
            if stops {
                return self.count_lost(channel.map_or(0, |channel| 1 << channel as u8));
            }
        }
        while self.words.fifo.room() < WORD || self.words.len() >= self.depth() {
            let lost = self.words.pop();
            self.count_lost(lost);
        }
        let [a, b, c, d, e, f] = data;
        let word = [self.words.tag(tag), a, b, c, d, e, f];
        match channel {
            Some(channel) => self.words.fifo.push_sample(&word, channel),
            None => word.iter().for_each(|byte| self.words.fifo.push(*byte, Mark::default())),
        }
    }

    fn count_lost(&mut self, channels: u8) {
        let mut lost = [0; 3];
        add(&mut lost, channels);
        self.gyro.tally.overflowed += lost[Channel::Gyro as usize];
        self.accel.tally.overflowed += lost[Channel::Accel as usize];
    }

    /// Empties it, as bypass mode does; its samples are missed.
    pub(super) fn empty_fifo(&mut self) {
        let gone = self.words.fifo.clear();
        self.gyro.tally.missed += gone[Channel::Gyro as usize];
        self.accel.tally.missed += gone[Channel::Accel as usize];
        self.words = Words::new();
    }

    /// FIFO_STATUS2: watermark reached, filled, filled by the next slot, counter, overrun; and two bits of the level.
    pub(super) fn fifo_status(&self) -> u8 {
        let (len, mark) = (self.words.len(), self.watermark());
        let is_past = mark > 0 && len >= mark;
        let is_full = len >= self.depth();
        let is_nearly_full = len > 0 && len + self.words.newest.max(1) >= self.depth();
        u8::from(is_past) << 7
            | u8::from(is_full) << 6
            | u8::from(is_nearly_full) << 5
            | u8::from(self.words.counter_reached) << 4
            | u8::from(self.words.overrun_latched) << 3
            | (len >> 8) as u8 & 3
    }

    /// A byte of the oldest word, which leaves when its last byte is read; 0 where there is none (assumed).
    pub(super) fn read_word(&mut self, byte: u8) -> u8 {
        let Some((value, _)) = self.words.fifo.peek(usize::from(byte)) else {
            return 0;
        };
        if usize::from(byte) + 1 == WORD {
            let mut read = [0; 3];
            add(&mut read, self.words.pop());
            self.gyro.tally.read += read[Channel::Gyro as usize];
            self.accel.tally.read += read[Channel::Accel as usize];
        }
        value
    }
}
