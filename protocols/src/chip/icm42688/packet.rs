//! The FIFO of an ICM-42688-P: its packets, its count, and what a full one loses (section 6).

use super::{
    Channel, FIFO_CONFIG, FIFO_CONFIG1, FIFO_CONFIG2, FIFO_CONFIG3, FIFO_FULL, FIFO_THRESHOLD, INTF_CONFIG0,
    Icm42688, PWR_MGMT0, TMST_CONFIG,
};
use crate::chip::fifo::{Frame, Full, add};
use crate::chip::temperature;

/// What a packet has a new sample of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Packet {
    pub gyro: bool,
    pub accel: bool,
}

/// Which samples a packet has room for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shape {
    Accel,
    Gyro,
    Both,
    /// Both with 20 bits.
    Wide,
}

impl Shape {
    const fn has(self, channel: Channel) -> bool {
        match channel {
            Channel::Gyro => !matches!(self, Shape::Accel),
            Channel::Accel => !matches!(self, Shape::Gyro),
            Channel::Mag => false,
        }
    }

    const fn size(self) -> usize {
        match self {
            Shape::Accel | Shape::Gyro => 8,
            Shape::Both => 16,
            Shape::Wide => 20,
        }
    }

    /// Bytes of whole packets, less one packet that is kept free for writing (section 6.3). The read cache, which takes one
    /// or two packets more while the bus is busy, is not there.
    const fn room(self) -> usize {
        (2048 / self.size() - 1) * self.size()
    }
}

impl Icm42688 {
    /// FIFO_CONFIG1: FIFO_HIRES_EN comes first (section 6.4).
    fn shape(&self) -> Option<Shape> {
        match self.of(FIFO_CONFIG1) & 0x13 {
            0x10.. => Some(Shape::Wide),
            3 => Some(Shape::Both),
            2 => Some(Shape::Gyro),
            1 => Some(Shape::Accel),
            _ => None,
        }
    }

    /// What this moment's packet has new, if there is one.
    pub(super) fn packet(&self, gyro: bool, accel: bool) -> Option<Packet> {
        let shape = self.shape().filter(|_| self.of(FIFO_CONFIG) >> 6 != 0)?;
        let packet =
            Packet { gyro: gyro && shape.has(Channel::Gyro), accel: accel && shape.has(Channel::Accel) };
        (packet.gyro || packet.accel).then_some(packet)
    }

    pub(super) fn push(&mut self, t_ns: u64, packet: Packet) {
        let Some(shape) = self.shape() else { return };
        let mut frame = Frame::new();
        frame.add(&[self.header(shape, packet)]);
        if shape.has(Channel::Accel) {
            self.add_words(&mut frame, self.counts(Channel::Accel, packet.accel));
        }
        if shape.has(Channel::Gyro) {
            self.add_words(&mut frame, self.counts(Channel::Gyro, packet.gyro));
        }
        if shape == Shape::Wide {
            self.add_words(&mut frame, [if self.is_cold() { self.invalid() } else { self.temperature() }]);
        } else {
            frame.add(&[self.short_temperature()]);
        }
        if matches!(shape, Shape::Both | Shape::Wide) {
            self.add_words(&mut frame, [self.timestamp(t_ns) as i16]);
        }
        if shape == Shape::Wide {
            frame.add(&[0; 3]); // a count of 16 bits has no finer ones
        }
        frame.is_sample(Channel::Accel, shape.size(), packet.accel);
        frame.is_sample(Channel::Gyro, shape.size(), packet.gyro);
        self.enter(&frame, shape);
    }

    fn enter(&mut self, frame: &Frame, shape: Shape) {
        let full = if self.of(FIFO_CONFIG) & 0x80 != 0 { Full::Stops } else { Full::LosesPackets };
        let before = self.fifo_count();
        if let Some(lost) = self.fifo.put(frame.bytes(), shape.room(), full) {
            self.lost_packets = self.lost_packets.saturating_add(lost.packets as u16);
            self.gyro.tally.overflowed += lost.samples[Channel::Gyro as usize];
            self.accel.tally.overflowed += lost.samples[Channel::Accel as usize];
        }
        if self.fifo.len() + shape.size() > shape.room() {
            self.status |= FIFO_FULL;
        }
        // FIFO_WM fires once, or with FIFO_WM_GT_TH at each packet (sections 14.45 to 14.47).
        let mark = usize::from(self.of(FIFO_CONFIG3) & 0x0f) << 8 | usize::from(self.of(FIFO_CONFIG2));
        let again = self.of(FIFO_CONFIG1) & 0x20 != 0;
        if mark != 0 && self.fifo_count() >= mark && (again || before < mark) {
            self.status |= FIFO_THRESHOLD;
        }
    }

    /// Section 6.2. There is no FSYNC, so a time is that of the sample.
    fn header(&mut self, shape: Shape, packet: Packet) -> u8 {
        let timed = matches!(shape, Shape::Both | Shape::Wide) && self.of(TMST_CONFIG) & 0x01 != 0;
        let bits = [
            (0x40, shape.has(Channel::Accel)),
            (0x20, shape.has(Channel::Gyro)),
            (0x10, shape == Shape::Wide),
            (0x08, timed),
            (0x02, packet.accel && self.is_other_odr(Channel::Accel)),
            (0x01, packet.gyro && self.is_other_odr(Channel::Gyro)),
        ];
        bits.into_iter().filter(|(_, set)| *set).fold(0, |header, (bit, _)| header | bit)
    }

    /// Whether a channel's rate is not that of the packet with it before.
    fn is_other_odr(&mut self, channel: Channel) -> bool {
        let (config, i) =
            if channel == Channel::Gyro { (super::GYRO_CONFIG0, 0) } else { (super::ACCEL_CONFIG0, 1) };
        let odr = self.of(config) & 0x0f;
        self.packet_odr[i].replace(odr).is_some_and(|before| before != odr)
    }

    fn add_words<const N: usize>(&self, frame: &mut Frame, words: [i16; N]) {
        for word in words {
            frame.add(&if self.is_big_endian() { word.to_be_bytes() } else { word.to_le_bytes() });
        }
    }

    /// A channel's counts, or what tells that they are not new (section 14.34). With 20 bits these are the upper 16.
    fn counts(&self, channel: Channel, is_new: bool) -> [i16; 3] {
        match channel {
            _ if !is_new && !self.holds_last() => [i16::MIN; 3],
            Channel::Gyro => self.gyro.counts,
            _ => self.accel.counts,
        }
    }

    fn is_cold(&self) -> bool {
        self.of(PWR_MGMT0) & 0x20 != 0 // TEMP_DIS
    }

    /// (T − 25 °C) · 2.07 in 8 bits (section 14.6). Assumed: −128 with TEMP_DIS, and FIFO_TEMP_EN changes nothing.
    fn short_temperature(&self) -> u8 {
        if self.is_cold() {
            return self.invalid().to_be_bytes()[0];
        }
        temperature(self.celsius, 25.0, 2.07).clamp(-128, 127) as i8 as u8
    }

    /// Its own time: 30/32 of real microseconds, or of 16 of them with TMST_RES (section 12.7).
    pub(super) fn ticks(&self, t_ns: u64) -> u64 {
        let us = u128::from(t_ns) * 30 / 32 / 1000;
        (if self.of(TMST_CONFIG) & 0x08 != 0 { us / 16 } else { us }) as u64
    }

    /// Of the sample, or with TMST_DELTA_EN since the one before; 0 with the timer off.
    fn timestamp(&self, t_ns: u64) -> u16 {
        let config = self.of(TMST_CONFIG);
        let ticks = self.ticks(t_ns);
        match (config & 0x01, config & 0x04) {
            (0, _) => 0,
            (_, 0) => ticks as u16,
            _ => ticks.saturating_sub(self.ticks(self.last_ns.unwrap_or(t_ns))) as u16,
        }
    }

    /// Bytes, or with FIFO_COUNT_REC whole packets (section 14.34).
    pub(super) fn fifo_count(&self) -> usize {
        match self.shape() {
            Some(shape) if self.of(INTF_CONFIG0) & 0x40 != 0 => self.fifo.len() / shape.size(),
            _ => self.fifo.len(),
        }
    }

    /// Byte 0 or 1 of the latched count, high byte first but for FIFO_COUNT_ENDIAN 0.
    pub(super) fn count_byte(&self, i: usize) -> u8 {
        let count = self.count as u16;
        let bytes = if self.of(INTF_CONFIG0) & 0x20 != 0 { count.to_be_bytes() } else { count.to_le_bytes() };
        bytes[i & 1]
    }

    /// The oldest byte; 0xff where there is none (section 14.24), of which bit 7 says in a header that the FIFO is empty.
    pub(super) fn pop(&mut self) -> u8 {
        self.clear_by_data(2, FIFO_THRESHOLD);
        self.clear_by_data(0, FIFO_FULL);
        let Some((byte, ends)) = self.fifo.pop() else { return 0xff };
        let mut read = [0; 3];
        add(&mut read, ends);
        self.gyro.tally.read += read[Channel::Gyro as usize];
        self.accel.tally.read += read[Channel::Accel as usize];
        byte
    }

    /// Empties it; its samples are missed.
    pub(super) fn flush(&mut self) {
        let ended = self.fifo.clear();
        self.gyro.tally.missed += ended[Channel::Gyro as usize];
        self.accel.tally.missed += ended[Channel::Accel as usize];
    }
}
