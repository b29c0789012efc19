//! The number of packets that damage cost, where packets have sequence numbers: one unreadable stretch of bytes may
//! hide several.

use std::collections::VecDeque;

/// The number of stretches to remember for a sender that is seldom heard.
const KEPT: usize = 256;

/// The stretches of damaged bytes in a stream. Each counts as one packet until sequence numbers show more.
#[derive(Default)]
pub(super) struct Stretches {
    recent: VecDeque<Stretch>,
    /// How many there have been.
    begun: u64,
}

struct Stretch {
    /// The number of packets that its bytes may have held; 0 until it ends.
    room: u64,
    /// Missing packets, by sequence number, that are attributed to it.
    hidden: u64,
}

impl Stretches {
    /// Begins a stretch, counted as one packet.
    pub fn begin(&mut self) {
        if self.recent.len() == KEPT {
            self.recent.pop_front();
        }
        self.recent.push_back(Stretch { room: 0, hidden: 0 });
        self.begun += 1;
    }

    /// Ends the newest stretch, if it has not ended: its length in bytes, and that of the stream's shortest packet.
    pub fn end(&mut self, bytes: usize, shortest: usize) {
        if let Some(stretch) = self.recent.back_mut().filter(|stretch| stretch.room == 0) {
            stretch.room = (bytes / shortest.max(1)).max(1) as u64;
        }
    }

    /// How many there have been.
    pub fn begun(&self) -> u64 {
        self.begun
    }

    /// Attributes `missing` packets to the stretches after the first `since`: one to each, then as many as each may
    /// have held. Returns how many more are damaged than were counted.
    pub fn claim(&mut self, since: u64, missing: u64) -> u64 {
        let forgotten = self.begun - self.recent.len() as u64;
        let first = since.saturating_sub(forgotten) as usize;
        let (mut left, mut more) = (missing, 0);
        for most in [1, u64::MAX] {
            for stretch in self.recent.iter_mut().skip(first) {
                let took = left.min(stretch.room.saturating_sub(stretch.hidden)).min(most);
                more += (stretch.hidden + took).max(1) - stretch.hidden.max(1);
                stretch.hidden += took;
                left -= took;
            }
        }
        more
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stretch_hides_what_is_missing_and_no_more_than_fits_into_it() {
        for (bytes, missing, damaged) in [(77, 1, 1), (154, 2, 2), (154, 9, 2), (3, 5, 1), (500, 0, 1)] {
            let mut stretches = Stretches::default();
            stretches.begin();
            stretches.end(bytes, 77);
            assert_eq!(1 + stretches.claim(0, missing), damaged, "{bytes} bytes, {missing} missing");
        }
    }

    #[test]
    fn every_stretch_has_one_before_any_has_two_and_what_came_before_has_none() {
        let mut stretches = Stretches::default();
        for bytes in [300, 300, 100] {
            stretches.begin();
            stretches.end(bytes, 100);
        }
        assert_eq!(stretches.claim(3, 5), 0, "missing after all of them");
        assert_eq!(stretches.claim(1, 2), 0, "one in each of two");
        assert_eq!(stretches.claim(1, 2), 2, "another sender's, in the one that has room");
        assert_eq!(stretches.claim(0, 2), 1, "the first counted one already");
    }
}
