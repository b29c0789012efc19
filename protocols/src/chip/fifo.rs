//! A FIFO of bytes that knows where samples end.

use super::Channel;

/// A ring of at most `N` bytes.
#[derive(Clone, Debug)]
pub(super) struct Fifo<const N: usize> {
    /// Each byte, and which channels' sample it begins and ends.
    bytes: [(u8, Mark); N],
    first: usize,
    len: usize,
    /// Channels of whose oldest sample the first bytes are lost.
    torn: u8,
}

/// Channels, bit i for channel i, whose sample a byte begins and ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Mark {
    pub begins: u8,
    pub ends: u8,
}

/// What a full FIFO does with new bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Full {
    /// It takes none of them.
    Stops,
    /// Its oldest bytes make room, one by one.
    LosesBytes,
    /// Its oldest packets make room, each whole.
    LosesPackets,
}

/// What a full FIFO lost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Lost {
    /// Of each channel.
    pub samples: [u64; 3],
    pub packets: u64,
}

/// What one moment puts in a FIFO.
pub(super) struct Frame {
    bytes: [(u8, Mark); 40],
    len: usize,
}

impl Frame {
    pub const fn new() -> Frame {
        Frame { bytes: [(0, Mark { begins: 0, ends: 0 }); 40], len: 0 }
    }

    pub fn bytes(&self) -> &[(u8, Mark)] {
        &self.bytes[..self.len]
    }

    /// Adds bytes; those that find no room are left out.
    pub fn add(&mut self, bytes: &[u8]) {
        for (to, byte) in self.bytes[self.len..].iter_mut().zip(bytes) {
            to.0 = *byte;
            self.len += 1;
        }
    }

    /// Its last `len` bytes are a new sample of the channel, if `really`.
    pub fn is_sample(&mut self, channel: Channel, len: usize, really: bool) {
        if let Some(first) = self.len.checked_sub(len).filter(|first| really && *first < self.len) {
            self.bytes[first].1.begins |= 1 << channel as u8;
            self.bytes[self.len - 1].1.ends |= 1 << channel as u8;
        }
    }
}

impl<const N: usize> Fifo<N> {
    pub const fn new() -> Self {
        Self { bytes: [(0, Mark { begins: 0, ends: 0 }); N], first: 0, len: 0, torn: 0 }
    }

    /// Bytes in it.
    pub const fn len(&self) -> usize {
        self.len
    }

    /// Bytes that it has room for.
    pub const fn room(&self) -> usize {
        N - self.len
    }

    /// Adds a byte; nothing where it is full.
    pub fn push(&mut self, byte: u8, mark: Mark) {
        if self.len < N {
            self.bytes[(self.first + self.len) % N] = (byte, mark);
            self.len += 1;
        }
    }

    /// Adds the bytes of one sample of a channel.
    pub fn push_sample(&mut self, bytes: &[u8], channel: Channel) {
        let bit = 1 << channel as u8;
        for (i, byte) in bytes.iter().enumerate() {
            let begins = if i == 0 { bit } else { 0 };
            let ends = if i + 1 == bytes.len() { bit } else { 0 };
            self.push(*byte, Mark { begins, ends });
        }
    }

    /// The byte behind `index` older ones, and what it marks.
    pub fn peek(&self, index: usize) -> Option<(u8, Mark)> {
        (index < self.len).then(|| self.bytes[(self.first + index) % N])
    }

    fn take(&mut self) -> Option<(u8, Mark)> {
        let oldest = *self.bytes.get(self.first).filter(|_| self.len > 0)?;
        self.first = (self.first + 1) % N;
        self.len -= 1;
        Some(oldest)
    }

    /// Reads the oldest byte: itself, and the channels of which a whole sample has now been read.
    pub fn pop(&mut self) -> Option<(u8, u8)> {
        let (byte, Mark { ends, .. }) = self.take()?;
        let whole = ends & !self.torn;
        self.torn &= !ends;
        Some((byte, whole))
    }

    /// Loses the oldest byte: the channels of which a sample is lost by it, and those of which one ends there. A sample that
    /// was read in part is lost with its last byte.
    pub fn lose(&mut self) -> Option<(u8, u8)> {
        let (_, Mark { begins, ends }) = self.take()?;
        let read_in_part = ends & !begins & !self.torn;
        self.torn = (self.torn | begins) & !ends;
        Some((begins | read_in_part, ends))
    }

    /// Puts bytes there that enter together, so that at most `size` are in it; what was lost where there was no room.
    pub fn put(&mut self, bytes: &[(u8, Mark)], size: usize, full: Full) -> Option<Lost> {
        let room = |fifo: &Self| size.min(N).saturating_sub(fifo.len);
        let mut lost = None::<Lost>;
        while room(self) < bytes.len() {
            let lost = lost.get_or_insert_default();
            if full == Full::Stops || self.len == 0 {
                lost.packets += 1;
                bytes.iter().for_each(|(_, mark)| add(&mut lost.samples, mark.begins));
                return Some(*lost);
            }
            while let Some((channels, ends)) = self.lose() {
                add(&mut lost.samples, channels);
                if full == Full::LosesBytes || ends != 0 {
                    break;
                }
            }
            lost.packets += 1;
        }
        bytes.iter().for_each(|&(byte, mark)| self.push(byte, mark));
        lost
    }

    /// Takes out everything: of each channel, how many samples are gone that were not lost before.
    pub fn clear(&mut self) -> [u64; 3] {
        let mut gone = [0; 3];
        while let Some((_, whole)) = self.pop() {
            add(&mut gone, whole);
        }
        self.torn = 0;
        gone
    }
}

/// Adds one to the count of each channel in this set.
pub(super) fn add(counts: &mut [u64; 3], ends: u8) {
    for (i, count) in counts.iter_mut().enumerate() {
        *count += u64::from(ends >> i & 1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_leave_in_order_and_samples_are_counted_where_they_end() {
        let mut fifo = Fifo::<8>::new();
        fifo.push_sample(&[1, 2, 3], Channel::Gyro);
        fifo.push_sample(&[4, 5], Channel::Mag);
        assert_eq!((fifo.len(), fifo.room()), (5, 3));
        assert_eq!([(); 3].map(|()| fifo.pop()), [Some((1, 0)), Some((2, 0)), Some((3, 1))]);
        fifo.push_sample(&[6, 7, 8, 9, 10, 11, 12], Channel::Accel);
        assert_eq!(fifo.room(), 0);
        assert_eq!(fifo.clear(), [0, 0, 1], "the accelerometer's last byte found no room");
        assert_eq!(fifo.pop(), None);
    }

    #[test]
    fn a_sample_whose_first_byte_is_lost_is_not_read_as_a_whole_one() {
        let mut fifo = Fifo::<8>::new();
        fifo.push_sample(&[1, 2, 3], Channel::Gyro);
        fifo.push_sample(&[4, 5, 6], Channel::Gyro);
        assert_eq!(fifo.lose(), Some((1, 0)), "one sample is lost with its first byte");
        assert_eq!(
            [(); 5].map(|()| fifo.pop()),
            [Some((2, 0)), Some((3, 0)), Some((4, 0)), Some((5, 0)), Some((6, 1))]
        );
    }

    #[test]
    fn a_sample_that_was_read_in_part_is_lost_with_its_last_byte() {
        let mut fifo = Fifo::<8>::new();
        fifo.push_sample(&[1, 2, 3], Channel::Accel);
        assert_eq!(fifo.pop(), Some((1, 0)));
        assert_eq!([(); 2].map(|()| fifo.lose()), [Some((0, 0)), Some((2, 2))]);
    }

    #[test]
    fn a_full_one_stops_or_loses_bytes_or_whole_packets() {
        let rows = [
            (Full::Stops, [0, 1, 0], 1, [1, 2, 3, 4]),
            (Full::LosesBytes, [1, 0, 0], 2, [3, 4, 5, 6]),
            (Full::LosesPackets, [1, 0, 0], 1, [4, 5, 6, 7]),
        ];
        for (full, samples, packets, next) in rows {
            let mut fifo = Fifo::<8>::new();
            fifo.push_sample(&[1, 2, 3], Channel::Gyro);
            fifo.push_sample(&[4], Channel::Gyro);
            let mut frame = Frame::new();
            frame.add(&[5, 6, 7]);
            frame.is_sample(Channel::Accel, 3, true);
            let lost = fifo.put(frame.bytes(), 5, full);
            assert_eq!(lost, Some(Lost { samples, packets }), "{full:?}");
            assert_eq!([(); 4].map(|()| fifo.pop().map_or(0, |(byte, _)| byte)), next, "{full:?}");
        }
    }
}
