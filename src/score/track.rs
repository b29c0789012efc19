//! Truth as a table of times and attitudes.

use super::series::Series;
use crate::geometry::{Attitude, exp, log};
use crate::time::SimTime;

/// Attitudes at increasing times, on the great circle between neighbours.
#[derive(Clone, Debug, PartialEq)]
pub struct AttitudeTrack {
    rows: Series,
    /// Rows further apart than this leave a gap, where the truth is unknown, ns.
    gap: i64,
}

/// Why a table cannot be a truth.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct TrackError(String);

impl AttitudeTrack {
    /// A track of rows in time order; the truth is known between any two of them.
    ///
    /// # Errors
    /// There are fewer than two rows, or one is not after the row before.
    pub fn new(rows: impl IntoIterator<Item = (SimTime, Attitude)>) -> Result<AttitudeTrack, TrackError> {
        AttitudeTrack::of(Series::new(rows.into_iter().map(|(t, attitude)| (t.0, attitude))))
    }

    /// A track of a series.
    ///
    /// # Errors
    /// Those of [`AttitudeTrack::new`].
    pub fn of(rows: Series) -> Result<AttitudeTrack, TrackError> {
        if rows.len() < 2 {
            return Err(TrackError(format!("has {} rows, but a truth needs at least two", rows.len())));
        }
        let times = rows.times();
        match times.windows(2).position(|pair| pair[1] <= pair[0]) {
            None => Ok(AttitudeTrack { rows, gap: i64::MAX }),
            Some(i) => Err(TrackError(format!(
                "row {} has time {}, which is not after {} of the previous row",
                i + 2,
                SimTime(times[i + 1]),
                SimTime(times[i])
            ))),
        }
    }

    /// The same as a recording: between rows further apart than a quarter of a second and than five times their
    /// median interval the truth is unknown.
    pub fn with_gaps(self) -> AttitudeTrack {
        let gap = self.rows.median_interval().unwrap_or(0).saturating_mul(5).max(250_000_000);
        AttitudeTrack { gap, ..self }
    }

    /// Its first time.
    pub fn first(&self) -> SimTime {
        SimTime(self.rows.times()[0])
    }

    /// Its last.
    pub fn last(&self) -> SimTime {
        SimTime(self.rows.times()[self.rows.len() - 1])
    }

    /// The number of rows.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Always false: a track has at least two rows.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Every `every`-th row.
    pub fn every(&self, every: usize) -> impl Iterator<Item = (SimTime, Attitude)> + '_ {
        (0..self.len()).step_by(every.max(1)).map(|i| (SimTime(self.rows.times()[i]), self.rows.attitude(i)))
    }

    /// The attitude at any time: before the first row the first, after the last row the last, in a gap `None`.
    pub fn at(&self, t: SimTime) -> Option<Attitude> {
        let times = self.rows.times();
        let after = times.partition_point(|row| *row <= t.0);
        if after == 0 || after == times.len() {
            return Some(self.rows.attitude(after.saturating_sub(1)));
        }
        let (t_0, t_1) = (times[after - 1], times[after]);
        if t_1 - t_0 > self.gap && t.0 > t_0 {
            return None;
        }
        let (a, b) = (self.rows.attitude(after - 1), self.rows.attitude(after));
        let share = (t.0 - t_0) as f64 / (t_1 - t_0) as f64;
        Some(Attitude::from_quat(a.q * exp(log(a.q.conjugate() * b.q) * share)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn between_two_rows_it_turns_evenly_and_outside_it_holds() {
        let at = |angle: f64| Attitude::from_quat(exp(DVec3::new(0.0, angle, 0.0)));
        // The sign of a row's quaternion is arbitrary.
        let rows = vec![(SimTime(10), at(0.1)), (SimTime(30), Attitude::from_quat(-at(0.5).q))];
        let track = AttitudeTrack::new(rows).unwrap();
        for (t, angle) in [(0, 0.1), (10, 0.1), (15, 0.2), (20, 0.3), (30, 0.5), (99, 0.5)] {
            assert!(track.at(SimTime(t)).unwrap().angle_to(at(angle)) < 1e-11, "{t}");
        }
        assert_eq!((track.first(), track.last()), (SimTime(10), SimTime(30)));
    }

    #[test]
    fn in_a_gap_of_a_recording_nothing_is_known() {
        let times = (0..100i64).chain(200..300).map(|k| k * 10_000_000);
        let track = AttitudeTrack::new(times.map(|t| (SimTime(t), Attitude::IDENTITY))).unwrap();
        assert!(track.at(SimTime(1_500_000_000)).is_some());
        let track = track.with_gaps();
        for (ms, known) in [(990, true), (991, false), (1500, false), (2000, true), (2005, true)] {
            assert_eq!(track.at(SimTime(ms * 1_000_000)).is_some(), known, "{ms} ms");
        }
    }

    #[test]
    fn a_table_out_of_order_is_refused_with_its_row() {
        let rows =
            |times: &[i64]| times.iter().map(|&t| (SimTime(t), Attitude::IDENTITY)).collect::<Vec<_>>();
        assert!(AttitudeTrack::new(rows(&[5])).unwrap_err().to_string().contains("at least two"));
        assert!(AttitudeTrack::new(rows(&[5, 6, 6])).unwrap_err().to_string().starts_with("row 3"));
    }
}
