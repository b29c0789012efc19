//! Which rows are in time order, and where a clock restarts.
//!
//! A row with the time of the newest before it is a duplicate. One that is older, while within a few rows time goes on
//! from the newest, was overtaken on its way. One to three rows that are later than all rows after them are ahead. Any
//! other step back is a clock that was set or restarted. A 32-bit counter that wraps continues.

use super::TimeUnit;
use super::times::TICKS;

/// The fate of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fate {
    Kept,
    /// A new clock begins with it.
    Break,
    Duplicate,
    Overtaken,
    Ahead,
}

/// As many rows may be overtaken before time goes on.
const FEW: usize = 8;
/// As many rows may be later than all rows after it.
const AHEAD: usize = 3;
/// Where a 32-bit counter wraps.
const TURN: i128 = (1 << 32) * TICKS;

/// Undoes the wraps of a counter of 32 bits, of whole ms, µs or ns; the rows after which it wrapped.
pub(super) fn unwrap(ticks: &mut [i128], unit: Option<TimeUnit>) -> Vec<usize> {
    let is_counter = |t: &i128| (0..TURN).contains(t) && t % TICKS == 0;
    if unit == Some(TimeUnit::S) || !ticks.iter().all(is_counter) {
        return Vec::new();
    }
    let (top, bottom) = (TURN - TURN / 16, TURN / 16);
    let (mut wraps, mut offset, mut newest) = (Vec::new(), 0, ticks.first().copied().unwrap_or(0));
    for (i, t) in ticks.iter_mut().enumerate() {
        let raw = *t;
        if newest >= top && raw < bottom {
            wraps.push(i);
            offset += TURN;
            newest = raw;
        } else if offset > 0 && newest < bottom && raw >= top {
            // It was overtaken by the wrap.
            *t = raw + offset - TURN;
            continue;
        }
        newest = newest.max(raw);
        *t = raw + offset;
    }
    wraps
}

/// The fate of each row.
pub(super) fn fates(ticks: &[i128]) -> Vec<Fate> {
    let mut fates = vec![Fate::Kept; ticks.len()];
    // Of the clock that runs.
    let mut kept: Vec<usize> = Vec::new();
    let mut i = 0;
    while i < ticks.len() {
        let t = ticks[i];
        let newest = kept.last().map(|last| ticks[*last]);
        match newest {
            Some(newest) if t == newest => fates[i] = Fate::Duplicate,
            Some(newest) if t < newest => {
                let ahead = ahead(ticks, &kept, i);
                if let Some(end) = (i + 1..ticks.len().min(i + FEW + 1)).find(|&j| ticks[j] > newest) {
                    let fate = |j: usize| if ticks[j] == newest { Fate::Duplicate } else { Fate::Overtaken };
                    (i..end).for_each(|j| fates[j] = fate(j));
                    i = end;
                    continue;
                } else if let Some(count) = ahead {
                    let gone = kept.split_off(kept.len() - count);
                    let begins = gone.iter().any(|row| fates[*row] == Fate::Break);
                    gone.iter().for_each(|row| fates[*row] = Fate::Ahead);
                    fates[i] = if begins { Fate::Break } else { Fate::Kept };
                    kept.push(i);
                } else if ticks.len() - i <= FEW && 4 * (ticks.len() - i) <= kept.len() {
                    (i..ticks.len()).for_each(|j| fates[j] = Fate::Overtaken);
                    break;
                } else {
                    fates[i] = Fate::Break;
                    kept.clear();
                    kept.push(i);
                }
            }
            _ => kept.push(i),
        }
        i += 1;
    }
    fates
}

/// How many of the last rows have to go so that row `i` is in order, if they are few.
fn ahead(ticks: &[i128], kept: &[usize], i: usize) -> Option<usize> {
    // With nothing before them, what follows has to be in order itself.
    let goes_on = || ticks.get(i..=i + FEW).is_some_and(|next| next.windows(2).all(|pair| pair[0] < pair[1]));
    let is_first = |count: usize| count == kept.len() && goes_on();
    let is_after = |count: usize| count < kept.len() && ticks[kept[kept.len() - 1 - count]] < ticks[i];
    (1..=AHEAD.min(kept.len())).find(|&count| is_after(count) || is_first(count))
}

#[cfg(test)]
mod tests {
    use super::*;
    use Fate::{Ahead, Break, Duplicate, Kept, Overtaken};

    fn of(times: &[i128]) -> Vec<(usize, Fate)> {
        let fates = fates(&times.iter().map(|t| t * TICKS).collect::<Vec<_>>());
        fates.into_iter().enumerate().filter(|(_, fate)| *fate != Kept).collect()
    }

    fn even(from: i128, count: i128) -> Vec<i128> {
        (from..from + count).collect()
    }

    #[test]
    fn each_row_out_of_order_is_called_what_it_is() {
        assert_eq!(of(&even(0, 50)), []);
        assert_eq!(of(&[0, 1, 1, 2]), [(2, Duplicate)]);
        assert_eq!(of(&[0, 1, 3, 2, 4, 5]), [(3, Overtaken)]);
        assert_eq!(of(&[0, 1, 5, 2, 3, 5, 6]), [(3, Overtaken), (4, Overtaken), (5, Duplicate)]);
        let ahead = [even(0, 20), vec![900_000], even(20, 20)].concat();
        assert_eq!(of(&ahead), [(20, Ahead)]);
        assert_eq!(of(&[vec![900_000], even(0, 20)].concat()), [(0, Ahead)]);
        assert_eq!(of(&[even(0, 20), vec![3]].concat()), [(20, Overtaken)], "the last of all");
    }

    #[test]
    fn a_clock_that_begins_anew_is_a_break_and_not_overtaken() {
        assert_eq!(of(&[even(1000, 20), even(0, 20)].concat()), [(20, Break)]);
        assert_eq!(of(&[even(100, 4), even(0, 4)].concat()), [(4, Break)]);
        assert_eq!(of(&[9, 8, 7, 6, 5, 4, 3, 2, 1, 0, -1, -2]).len(), 11, "a table that runs backwards");
        // Set back by more than a few rows.
        assert_eq!(of(&[even(0, 40), even(20, 40)].concat()), [(40, Break)]);
        assert_eq!(of(&[even(1000, 20), even(500, 20), even(0, 20)].concat()), [(20, Break), (40, Break)]);
    }

    #[test]
    fn a_counter_that_wraps_goes_on() {
        let turn = 1i128 << 32;
        let raw = [turn - 20, turn - 10, 0, turn - 5, 10, 20];
        let mut ticks: Vec<_> = raw.iter().map(|t| t * TICKS).collect();
        assert_eq!(unwrap(&mut ticks, Some(TimeUnit::Ms)), [2]);
        let expected = [turn - 20, turn - 10, turn, turn - 5, turn + 10, turn + 20];
        assert_eq!(ticks, expected.map(|t| t * TICKS));
        // A restart is no wrap, nor are seconds, nor a time that is beyond the counter.
        for (raw, unit) in [
            ([turn / 2, turn / 2 + 10, 0], Some(TimeUnit::Ms)),
            ([turn - 20, turn - 10, 0], Some(TimeUnit::S)),
            ([turn + 20, turn - 10, 0], Some(TimeUnit::Ms)),
        ] {
            let mut ticks: Vec<_> = raw.iter().map(|t| t * TICKS).collect();
            assert_eq!(unwrap(&mut ticks, unit), Vec::<usize>::new(), "{raw:?}");
        }
    }

    proptest::proptest! {
        /// What is kept of one clock is in order, whatever the times were.
        #[test]
        fn what_is_kept_is_in_order(times in proptest::collection::vec(0i128..40, 0..80)) {
            let fates = fates(&times);
            let mut last = None;
            for (t, fate) in times.iter().zip(&fates) {
                match fate {
                    Kept => {
                        proptest::prop_assert!(last.is_none_or(|last| t > last), "{times:?} {fates:?}");
                        last = Some(t);
                    }
                    Break => last = Some(t),
                    _ => {}
                }
            }
        }
    }
}
