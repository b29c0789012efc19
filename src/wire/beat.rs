//! When packets that have a rate of their own are due: evenly, and evenly again where that rate changes.

use crate::schedule::Ticks;
use crate::time::{Rate, SimTime};

/// The times of one kind of packet.
#[derive(Debug)]
pub(super) struct Beat {
    ticks: Ticks,
    next: u64,
}

impl Beat {
    pub fn new(ticks: Ticks) -> Beat {
        Beat { ticks, next: 0 }
    }

    /// How many there are a second.
    pub fn rate(&self) -> Rate {
        self.ticks.rate
    }

    /// When the next packet is due.
    pub fn due(&self) -> SimTime {
        self.ticks.phase + self.ticks.rate.tick(self.next)
    }

    /// The next one is made, or left out.
    pub fn step(&mut self) {
        self.next += 1;
    }

    /// Another rate from the packet before on: the next one is due a whole number of new periods after it, and not
    /// before `now`.
    pub fn change(&mut self, rate: Rate, now: SimTime) {
        let Some(before) = self.next.checked_sub(1) else {
            self.ticks.rate = rate;
            return;
        };
        let phase = self.ticks.phase + self.ticks.rate.tick(before);
        *self = Beat { ticks: Ticks { rate, phase }, next: rate.ticks_before(phase, now).max(1) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: i64 = 1_000_000;

    fn at(hz: u32, packets: u64) -> Beat {
        let mut beat = Beat::new(Ticks { rate: Rate::hz(hz), phase: SimTime(3 * MS) });
        (0..packets).for_each(|_| beat.step());
        beat
    }

    fn times(mut beat: Beat) -> Vec<i64> {
        let mut due = || {
            let due = beat.due();
            beat.step();
            due.0
        };
        (0..3).map(|_| due()).collect()
    }

    #[test]
    fn another_rate_goes_on_from_the_packet_before() {
        // The last packet at 100 Hz was due at 33 ms.
        for (rate, now, expected) in [
            (400, 33 * MS, [35_500_000, 38_000_000, 40_500_000]),
            (400, 34 * MS, [35_500_000, 38_000_000, 40_500_000]),
            (50, 34 * MS, [53 * MS, 73 * MS, 93 * MS]),
        ] {
            let mut beat = at(100, 4);
            beat.change(Rate::hz(rate), SimTime(now));
            assert_eq!(times(beat), expected, "{rate} Hz");
        }
    }

    #[test]
    fn a_faster_rate_makes_no_packets_for_the_past() {
        // The last packet at 1 Hz was due at 1003 ms, and 900 ms have gone by since.
        let mut beat = at(1, 2);
        beat.change(Rate::hz(100), SimTime(1903 * MS));
        assert_eq!(times(beat), [1903 * MS, 1913 * MS, 1923 * MS]);
        let mut beat = at(1, 2);
        beat.change(Rate::hz(100), SimTime(1903 * MS + 1));
        assert_eq!(times(beat)[0], 1913 * MS);
    }

    #[test]
    fn before_the_first_packet_another_rate_moves_nothing() {
        let mut beat = at(100, 0);
        beat.change(Rate::hz(200), SimTime(MS));
        assert_eq!(times(beat), [3 * MS, 8 * MS, 13 * MS]);
    }
}
