//! Counting lost packets by an eight-bit sequence number.

/// Counts packets that did not arrive, by the eight-bit `seq` of those that did.
///
/// Exact as long as fewer than 255 packets are lost in a row and the link keeps their order. A
/// repeated number counts as nothing lost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Losses {
    last: Option<u8>,
    lost: u64,
}

impl Losses {
    /// Nothing seen yet.
    pub const fn new() -> Self {
        Self { last: None, lost: 0 }
    }

    /// Takes the number of a packet that arrived and returns how many are missing before it.
    pub fn observe(&mut self, seq: u8) -> u8 {
        let step = self.last.map_or(1, |last| seq.wrapping_sub(last));
        let missing = step.saturating_sub(1);
        self.last = Some(seq);
        self.lost += u64::from(missing);
        missing
    }

    /// Packets lost so far, those before the first arrival not counted.
    pub const fn lost(&self) -> u64 {
        self.lost
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
    }
}
