//! The newest sample of a channel, and what became of those before it.

/// What became of a channel's samples: `made = read + missed + overflowed`, and those that wait to be read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Samples that the chip took.
    pub made: u64,
    /// Samples that were read, each counted once.
    pub read: u64,
    /// Reads of a sample that was read before, or that the FIFO holds as well.
    pub again: u64,
    /// Samples that a newer one replaced before anybody read them.
    pub missed: u64,
    /// Samples that the FIFO lost.
    pub overflowed: u64,
}

/// The newest sample of a channel in its registers.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Latest {
    /// On x, y, z.
    pub counts: [i16; 3],
    /// Which of its six bytes were read.
    seen: u8,
    state: State,
    pub tally: Tally,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum State {
    /// None yet, or read at least in part.
    #[default]
    Known,
    /// Nobody has read it, and only the registers hold it.
    Unread,
    /// The FIFO holds it as well, and counts it.
    Queued,
}

impl Latest {
    /// Replaces it by the next sample; `queued` is whether the FIFO holds that one as well.
    pub fn put(&mut self, counts: [i16; 3], queued: bool) {
        self.tally.made += 1;
        self.tally.missed += u64::from(self.state == State::Unread);
        self.state = if queued { State::Queued } else { State::Unread };
        self.counts = counts;
        self.seen = 0;
    }

    /// Forgets the sample, as a reset does; one that was not read is missed.
    pub fn clear(&mut self) {
        self.tally.missed += u64::from(self.state == State::Unread);
        *self = Latest { tally: self.tally, ..Latest::default() };
    }

    /// Byte 0 to 5 of the sample, high byte of x first.
    pub fn high_first(&mut self, byte: u8) -> u8 {
        let [high, low] = self.counts[usize::from(byte / 2) % 3].to_be_bytes();
        self.see(byte);
        if byte.is_multiple_of(2) { high } else { low }
    }

    /// Byte 0 to 5 of the sample, low byte of x first.
    pub fn low_first(&mut self, byte: u8) -> u8 {
        self.high_first(byte ^ 1)
    }

    fn see(&mut self, byte: u8) {
        if self.tally.made == 0 {
            return;
        }
        let bit = 1 << byte;
        if self.state == State::Queued {
            self.tally.again += u64::from(self.seen == 0 || self.seen & bit != 0);
        } else if self.seen & bit != 0 {
            self.tally.again += 1;
        } else if self.state == State::Unread {
            self.tally.read += 1;
            self.state = State::Known;
        }
        self.seen = if self.seen & bit == 0 { self.seen | bit } else { bit };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn burst(latest: &mut Latest) -> [u8; 6] {
        [0, 1, 2, 3, 4, 5].map(|byte| latest.high_first(byte))
    }

    #[test]
    fn a_sample_counts_once_however_its_bytes_are_read() {
        let mut latest = Latest::default();
        latest.put([1, 2, 3], false);
        assert_eq!(burst(&mut latest), [0, 1, 0, 2, 0, 3]);
        assert_eq!(latest.tally, Tally { made: 1, read: 1, ..Tally::default() });
        burst(&mut latest);
        assert_eq!(latest.tally.again, 1, "the whole burst again is one read again");
        latest.put([4, 5, 6], false);
        latest.put([7, 8, 9], false);
        assert_eq!([0, 1].map(|byte| latest.low_first(byte)), [7, 0]);
        assert_eq!(latest.tally, Tally { made: 3, read: 2, again: 1, missed: 1, overflowed: 0 });
    }

    #[test]
    fn what_the_fifo_holds_is_not_missed_in_the_registers() {
        let mut latest = Latest::default();
        latest.put([1; 3], true);
        latest.put([2; 3], true);
        burst(&mut latest);
        assert_eq!(latest.tally, Tally { made: 2, again: 1, ..Tally::default() });
        latest.put([3; 3], false);
        latest.clear();
        assert_eq!(latest.tally.missed, 1, "nobody can read it any more");
        assert_eq!(latest.counts, [0; 3]);
    }
}
