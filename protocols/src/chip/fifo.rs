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

    /// Loses the oldest byte: the channels of which a sample is lost by it.
    pub fn lose(&mut self) -> Option<u8> {
        let (_, Mark { begins, ends }) = self.take()?;
        self.torn = (self.torn | begins) & !ends;
        Some(begins)
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
        assert_eq!(fifo.lose(), Some(1), "one sample is lost with its first byte");
        assert_eq!(
            [(); 5].map(|()| fifo.pop()),
            [Some((2, 0)), Some((3, 0)), Some((4, 0)), Some((5, 0)), Some((6, 1))]
        );
    }
}
