//! Converts the other side's clock to ours.

/// A clock that goes back by more than this was restarted, ns.
const SET_BACK: i64 = 1_000_000_000;

/// [`onto_ours`] for each run of a clock that restarts: each run has its own offset. A run that does not agree with our
/// clock keeps its arrival times.
pub(super) fn runs_onto_ours(own: &[i64], arrival: &[i64]) -> Vec<i64> {
    let mut ours = Vec::with_capacity(own.len());
    for run in own.chunk_by(|a, b| a.saturating_sub(*b) < SET_BACK) {
        let arrived = &arrival[ours.len()..][..run.len()];
        ours.extend(onto_ours(run, arrived).unwrap_or_else(|| arrived.to_vec()));
    }
    ours
}

/// Converts times of another clock to ours, ns: a straight line through (own, arrival). It removes offset and drift
/// and leaves the mean transmission time in.
///
/// `None` if the two do not agree: a clock that stood still, jumped or was set.
pub(super) fn onto_ours(own: &[i64], arrival: &[i64]) -> Option<Vec<i64>> {
    let (&own_0, &arrival_0) = (own.first()?, arrival.first()?);
    let x: Vec<f64> = own.iter().map(|t| t.wrapping_sub(own_0) as f64 * 1e-9).collect();
    let y: Vec<f64> = arrival.iter().map(|t| t.wrapping_sub(arrival_0) as f64 * 1e-9).collect();
    let mut within = vec![true; x.len()];
    let (mut offset, mut slope) = line(&x, &y, &within)?;
    // Messages that a stall delayed lie far above the line of all others.
    for _ in 0..3 {
        let off = |i: usize| (y[i] - offset - slope * x[i]).abs();
        let mut sizes: Vec<f64> = (0..x.len()).map(off).collect();
        sizes.sort_unstable_by(f64::total_cmp);
        let bound = 4.0 * sizes[sizes.len() / 2] + 1e-6;
        (0..x.len()).for_each(|i| within[i] = off(i) <= bound);
        (offset, slope) = line(&x, &y, &within)?;
    }
    let steady = within.iter().filter(|&&within| within).count() * 4 > 3 * x.len();
    let spread = (0..x.len()).filter(|&i| within[i]).map(|i| (y[i] - offset - slope * x[i]).abs());
    if !steady || spread.fold(0.0, f64::max) > 0.5 || !(0.01..100.0).contains(&slope) {
        return None;
    }
    let ours = x.iter().map(|x| arrival_0 + libm::round((offset + slope * x) * 1e9) as i64);
    Some(ours.collect())
}

/// Least squares of `y = offset + slope·x` over what is `within`.
fn line(x: &[f64], y: &[f64], within: &[bool]) -> Option<(f64, f64)> {
    let used = || x.iter().zip(y).zip(within).filter(|(_, within)| **within).map(|(xy, _)| xy);
    let n = used().count() as f64;
    let (mx, my) = used().fold((0.0, 0.0), |(sx, sy), (x, y)| (sx + x / n, sy + y / n));
    let (xx, xy) =
        used().fold((0.0, 0.0), |(xx, xy), (x, y)| (xx + (x - mx) * (x - mx), xy + (x - mx) * (y - my)));
    (xx > 0.0).then(|| (my - xy / xx * mx, xy / xx))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offset_and_drift_of_a_clock_are_taken_out_in_spite_of_a_stall() {
        // 40 ppm fast, 5000 s ahead; transmission takes 3 to 8 ms, and half a second of messages arrived all at
        // once.
        let held: Vec<i64> = (0..3000).map(|k| k * 20_000_000).collect();
        let own: Vec<i64> = held.iter().map(|t| 5_000_000_000_000 + t + t / 25_000).collect();
        let way = |k: usize| 3_000_000 + (k as i64 * 7919 % 11) * 500_000;
        let stall = |t: i64| if (30_000_000_000..30_500_000_000).contains(&t) { 30_500_000_000 } else { t };
        let arrival: Vec<i64> = held.iter().enumerate().map(|(k, &t)| stall(t) + way(k)).collect();
        let ours = onto_ours(&own, &arrival).unwrap();
        for (ours, held) in ours.iter().zip(&held) {
            // The mean transmission time is 5.5 ms.
            assert!((ours - held - 5_500_000).abs() < 300_000, "{} at {held}", ours - held);
        }
    }

    #[test]
    fn a_clock_that_was_restarted_has_an_offset_of_its_own_in_each_run() {
        let held: Vec<i64> = (0..2000).map(|k| k * 20_000_000).collect();
        let own: Vec<i64> = held
            .iter()
            .map(|t| if *t < 17_000_000_000 { t + 90_000_000_000 } else { t - 16_000_000_000 })
            .collect();
        let arrival: Vec<i64> =
            held.iter().enumerate().map(|(k, t)| t + 3_000_000 + (k as i64 * 7919 % 11) * 500_000).collect();
        assert_eq!(onto_ours(&own, &arrival), None, "one line does not fit both");
        for (ours, held) in runs_onto_ours(&own, &arrival).iter().zip(&held) {
            assert!((ours - held - 5_500_000).abs() < 400_000, "{} at {held}", ours - held);
        }
        // Two estimates are no run to fit a line to: they keep their arrivals.
        assert_eq!(runs_onto_ours(&[5_000_000_000, 0], &[1, 2]), [1, 2]);
        assert!(runs_onto_ours(&[], &[]).is_empty());
    }

    #[test]
    fn a_clock_that_was_set_is_not_trusted() {
        let arrival: Vec<i64> = (0..200).map(|k| k * 10_000_000).collect();
        let set = |t: &i64| if *t < 1_000_000_000 { *t } else { t + 3_600_000_000_000 };
        assert_eq!(onto_ours(&arrival.iter().map(set).collect::<Vec<_>>(), &arrival), None);
        assert_eq!(onto_ours(&vec![7; 200], &arrival), None);
        assert_eq!(onto_ours(&[], &[]), None);
    }
}
