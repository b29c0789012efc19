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

#[cfg(test)]
mod tests {
    use super::*;

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
