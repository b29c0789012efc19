//! A FIFO of whole frames.
//!
//! What a read leaves of a frame is read again from its beginning by the next one. An overflow loses whole frames, the oldest
//! first, and a frame that tells how many precedes what is read next (BST-BMI088-DS001 section 4.9.3.2, BST-BMI160-DS000
//! section 2.5.1).

use crate::chip::Fifo;
use crate::chip::fifo::{Mark, add};

/// Bit of a [`Mark`]: a frame ends.
const FRAME: u8 = 0x08;
const CHANNELS: u8 = 0x07;

const SKIP: u8 = 0x40;
const SENSOR_TIME: u8 = 0x44;
/// What an empty FIFO reads, in turns: 0x80 is no header.
const EMPTY: [u8; 2] = [0x80, 0x00];

/// Where a burst is.
#[derive(Clone, Copy, Debug)]
enum At {
    Start,
    /// In the frame that tells how many were skipped.
    Skip,
    /// Behind at least one whole frame.
    Frames,
    /// In the frame of the sensor's time, behind so many of its bytes.
    Time(u8),
    /// Behind the end.
    Past(bool),
}

/// At most `N` bytes of frames.
#[derive(Clone, Debug)]
pub(in crate::chip) struct Frames<const N: usize> {
    fifo: Fifo<N>,
    size: usize,
    /// Bytes of the oldest frame that this burst has read.
    read: usize,
    at: At,
    skipped: u8,
    /// Bytes of the newest frame.
    newest: usize,
    /// What an empty one reads without headers, in turns.
    pub empty: [u8; 2],
}

impl<const N: usize> Frames<N> {
    pub fn new(size: usize) -> Self {
        Self {
            fifo: Fifo::new(),
            size: size.min(N),
            read: 0,
            at: At::Start,
            skipped: 0,
            newest: 1,
            empty: EMPTY,
        }
    }

    pub fn len(&self) -> usize {
        self.fifo.len()
    }

    pub fn skipped(&self) -> u8 {
        self.skipped
    }

    /// How many bytes it has room for from now on; it has to be empty.
    pub fn resize(&mut self, size: usize) {
        self.size = size.min(N);
    }

    /// Whether two more frames at most have room, which is what the chips call full (BST-BMI088-DS001 section 4.9.3.3).
    pub fn is_full(&self) -> bool {
        self.room() < 3 * self.newest
    }

    fn room(&self) -> usize {
        self.size - self.fifo.len().min(self.size)
    }

    /// A read begins.
    pub fn begin(&mut self) {
        self.read = 0;
        self.at = At::Start;
    }

    /// Loses the rest of a frame that was read in part: the channels whose sample it was.
    pub fn drop_partial(&mut self) -> u8 {
        if self.read > 0 { self.pop() } else { 0 }
    }

    /// Adds a frame with samples of these channels: how many samples of each are lost by it.
    pub fn push(&mut self, bytes: &[u8], channels: u8, stops: bool) -> [u64; 3] {
        let mut lost = [0; 3];
        if stops && self.room() < bytes.len() {
            self.skipped = self.skipped.saturating_add(1);
            add(&mut lost, channels);
            return lost;
        }
        while self.room() < bytes.len() && self.len() > 0 {
            self.skipped = self.skipped.saturating_add(1);
            add(&mut lost, self.pop());
        }
        for (i, byte) in bytes.iter().enumerate() {
            let begins = if i == 0 { channels } else { 0 };
            let ends = if i + 1 == bytes.len() { channels | FRAME } else { 0 };
            self.fifo.push(*byte, Mark { begins, ends });
        }
        self.newest = bytes.len().max(1);
        lost
    }

    /// Takes out the oldest frame: the channels of its samples.
    fn pop(&mut self) -> u8 {
        self.read = 0;
        while let Some((_, ends)) = self.fifo.pop() {
            if ends & FRAME != 0 {
                return ends & CHANNELS;
            }
        }
        0
    }

    /// The next byte of a burst, and the channels of which it ends a sample.
    pub fn next_byte(&mut self, headers: bool, time: Option<[u8; 3]>) -> (u8, u8) {
        match self.at {
            At::Start if headers && self.skipped > 0 => {
                self.at = At::Skip;
                (SKIP, 0)
            }
            At::Skip => {
                self.at = At::Start;
                (core::mem::take(&mut self.skipped), 0)
            }
            At::Start | At::Frames => self.stored_byte(headers, time),
            At::Time(behind) => {
                self.at = if behind < 2 { At::Time(behind + 1) } else { At::Past(false) };
                (time.unwrap_or_default()[usize::from(behind) % 3], 0)
            }
            At::Past(second) => {
                self.at = At::Past(!second);
                (self.past(headers)[usize::from(second)], 0)
            }
        }
    }

    const fn past(&self, headers: bool) -> [u8; 2] {
        if headers { EMPTY } else { self.empty }
    }

    /// A byte of a frame. Where the burst has emptied the FIFO the sensor's time follows.
    fn stored_byte(&mut self, headers: bool, time: Option<[u8; 3]>) -> (u8, u8) {
        let Some((byte, mark)) = self.fifo.peek(self.read) else {
            let has_read = matches!(self.at, At::Frames);
            let timed = headers && has_read && time.is_some();
            self.at = if timed { At::Time(0) } else { At::Past(true) };
            return (if timed { SENSOR_TIME } else { self.past(headers)[0] }, 0);
        };
        self.read += 1;
        if mark.ends & FRAME == 0 {
            return (byte, 0);
        }
        self.at = At::Frames;
        self.skipped = if headers { self.skipped } else { 0 };
        (byte, self.pop())
    }

    /// Takes out everything: how many samples of each channel.
    pub fn clear(&mut self) -> [u64; 3] {
        (self.read, self.at, self.skipped) = (0, At::Start, 0);
        self.fifo.clear()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn burst<const B: usize>(frames: &mut Frames<20>, time: Option<[u8; 3]>) -> [u8; B] {
        frames.begin();
        [(); B].map(|()| frames.next_byte(true, time).0)
    }

    #[test]
    fn a_frame_that_was_read_in_part_is_repeated() {
        let mut frames = Frames::<20>::new(20);
        frames.push(&[0x84, 1, 2], 2, false);
        assert_eq!(burst(&mut frames, None), [0x84, 1]);
        assert_eq!((frames.len(), burst(&mut frames, None)), (3, [0x84, 1, 2, 0x80, 0, 0x80, 0]));
        assert_eq!(frames.len(), 0);
    }

    #[test]
    fn an_overflow_loses_the_oldest_frames_and_says_how_many() {
        let mut frames = Frames::<20>::new(8);
        for k in 0..4 {
            let lost = frames.push(&[0x84, k, k], 2, false);
            assert_eq!(lost, [0, u64::from(k > 1), 0]);
        }
        assert_eq!(burst(&mut frames, None), [0x40, 2, 0x84, 2, 2, 0x84, 3, 3, 0x80]);
        assert_eq!(burst(&mut frames, None), [0x80]);
    }

    #[test]
    fn the_time_follows_only_where_a_burst_empties_it() {
        let mut frames = Frames::<20>::new(20);
        frames.push(&[0x84, 7], 2, true);
        assert_eq!(burst(&mut frames, Some([1, 2, 3])), [0x84, 7, 0x44, 1, 2, 3, 0x80, 0, 0x80]);
        assert_eq!(burst(&mut frames, Some([1, 2, 3])), [0x80, 0]);
    }
}
