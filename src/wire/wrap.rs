//! Clocks on the wire that begin again and again.

use crate::time::{NANOS, SimTime};

/// Of 32 bits that count microseconds, ns: 71 minutes and 35 seconds.
pub(super) const MICROS_32: i64 = (1 << 32) * 1000;

/// Of a GPS week, ns.
pub(super) const WEEK: i64 = 7 * 86_400 * NANOS;

/// The time that is `part` after a beginning of a clock that begins again each `period`, both in ns, and which is nearest
/// to `near`, but not before the first beginning.
pub(super) fn unwrapped(part: i64, period: i64, near: SimTime) -> SimTime {
    let ahead = (part - near.0).rem_euclid(period);
    let nearest = near.0 + if ahead < period / 2 { ahead } else { ahead - period };
    SimTime(if nearest < 0 { nearest + period } else { nearest })
}

/// The first time at or after `t` that a clock of such steps, in ns, can tell: a last packet so close behind the one before
/// that both would have the same time.
pub(super) fn next_step(t: SimTime, step: i64) -> SimTime {
    SimTime((t.0 + step - 1).div_euclid(step) * step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_that_a_clock_cannot_tell_is_the_next_that_it_can() {
        for (t, expected) in [(0, 0), (1, 1000), (999, 1000), (1000, 1000), (1001, 2000)] {
            assert_eq!(next_step(SimTime(t), 1000).0, expected, "{t}");
        }
    }

    #[test]
    fn time_goes_on_where_a_clock_begins_again_and_may_step_back_a_little() {
        for (period, step) in [(MICROS_32, 60 * NANOS), (WEEK, 3600 * NANOS)] {
            let mut t = SimTime::ZERO;
            for k in 0..1000 {
                t = unwrapped(k * step % period, period, t);
                assert_eq!(t.0, k * step, "{period} {k}");
            }
            let back = SimTime(t.0 - NANOS);
            assert_eq!(unwrapped(back.0 % period, period, t), back);
        }
        let before = MICROS_32 - NANOS;
        assert_eq!(unwrapped(before, MICROS_32, SimTime::ZERO).0, before, "nothing is before the beginning");
    }
}
