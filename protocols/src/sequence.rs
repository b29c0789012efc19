//! Counting lost packets by an eight-bit sequence number.

/// Counts packets that did not arrive, that came twice and that were overtaken, by the eight-bit
/// `seq` of those that did arrive.
///
/// A number of the last sixteen that was missing and comes after all is a packet out of order, and
/// no longer lost. The number before once more is a duplicate. Exact as long as fewer than 239
/// packets are lost in a row and nothing is overtaken by more than sixteen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Losses {
    last: Option<u8>,
    /// Bit i: the number `last − 1 − i` has not come yet.
    missing: u16,
    lost: u64,
    duplicates: u64,
    out_of_order: u64,
}

impl Losses {
    /// Nothing seen yet.
    pub const fn new() -> Self {
        Self { last: None, missing: 0, lost: 0, duplicates: 0, out_of_order: 0 }
    }

    /// Takes the number of a packet that arrived and returns how many are missing before it.
    pub fn observe(&mut self, seq: u8) -> u8 {
        let Some(last) = self.last else {
            self.last = Some(seq);
            return 0;
        };
        let behind = u32::from(last.wrapping_sub(seq));
        if behind == 0 {
            self.duplicates += 1;
            return 0;
        }
        let place = 1u16.checked_shl(behind - 1).unwrap_or(0);
        if self.missing & place != 0 {
            self.missing &= !place;
            self.lost -= 1;
            self.out_of_order += 1;
            return 0;
        }
        let step = seq.wrapping_sub(last);
        let gap = step - 1;
        // The last one has come; each in the gap has not.
        let come = u32::from(self.missing) << 1;
        let gone = (1u32 << u32::from(gap).min(16)) - 1;
        self.missing = (come.checked_shl(u32::from(gap)).unwrap_or(0) | gone) as u16;
        self.last = Some(seq);
        self.lost += u64::from(gap);
        gap
    }

    /// The newest number that came.
    pub const fn last(&self) -> Option<u8> {
        self.last
    }

    /// Packets lost so far, those before the first arrival not counted.
    pub const fn lost(&self) -> u64 {
        self.lost
    }

    /// Packets that came a second time, right after the first.
    pub const fn duplicates(&self) -> u64 {
        self.duplicates
    }

    /// Packets that came after one that was sent later.
    pub const fn out_of_order(&self) -> u64 {
        self.out_of_order
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn losses_are_counted_across_the_wrap() {
        let mut losses = Losses::new();
        let missing = [250, 251, 254, 255, 0, 3, 3].map(|seq| losses.observe(seq));
        assert_eq!(missing, [0, 0, 2, 0, 0, 2, 0]);
        assert_eq!(losses.lost(), 4);
        assert_eq!((losses.duplicates(), losses.out_of_order()), (1, 0));
    }

    #[test]
    fn who_comes_late_is_not_lost() {
        for late_by in 1..=16u8 {
            let mut losses = Losses::new();
            let first = 250u8;
            losses.observe(first);
            let overtaken = first.wrapping_add(1);
            for k in 1..=late_by {
                losses.observe(overtaken.wrapping_add(k));
            }
            assert_eq!((losses.lost(), losses.out_of_order()), (1, 0), "late by {late_by}");
            losses.observe(overtaken);
            assert_eq!((losses.lost(), losses.out_of_order()), (0, 1), "late by {late_by}");
            losses.observe(overtaken.wrapping_add(late_by + 1));
            assert_eq!((losses.lost(), losses.duplicates()), (0, 0), "late by {late_by}");
        }
    }

    #[test]
    fn a_long_gap_is_no_step_back() {
        for gap in [15, 16, 17, 100, 200, 238u8] {
            let mut losses = Losses::new();
            (0..100).for_each(|seq| _ = losses.observe(seq));
            assert_eq!(losses.observe(100u8.wrapping_add(gap)), gap);
            losses.observe(101u8.wrapping_add(gap));
            assert_eq!((losses.lost(), losses.out_of_order()), (u64::from(gap), 0));
        }
    }
}
