//! Truth as a table of times and attitudes.

use crate::geometry::{Attitude, exp, log};
use crate::time::SimTime;

/// Attitudes at increasing times, on the great circle between neighbours.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    rows: Vec<(SimTime, Attitude)>,
}

/// A table that cannot be a truth.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct TrackError(String);

impl Track {
    /// Of rows in order of time, of unit length.
    ///
    /// # Errors
    /// Fewer than two rows, or one that is not after the row before.
    pub fn new(rows: Vec<(SimTime, Attitude)>) -> Result<Track, TrackError> {
        if rows.len() < 2 {
            return Err(TrackError(format!("has {} rows, but a truth needs two or more", rows.len())));
        }
        match rows.windows(2).position(|pair| pair[1].0 <= pair[0].0) {
            None => Ok(Track { rows }),
            Some(i) => Err(TrackError(format!(
                "row {} is of {}, which is not after {} of the row before",
                i + 2,
                rows[i + 1].0,
                rows[i].0
            ))),
        }
    }

    /// Its first time.
    pub fn first(&self) -> SimTime {
        self.rows[0].0
    }

    /// Its last.
    pub fn last(&self) -> SimTime {
        self.rows[self.rows.len() - 1].0
    }

    /// The rows.
    pub fn rows(&self) -> &[(SimTime, Attitude)] {
        &self.rows
    }

    /// At any time; before the first row and after the last as there.
    pub fn at(&self, t: SimTime) -> Attitude {
        let after = self.rows.partition_point(|(row, _)| *row <= t);
        let (Some(&(t_0, a)), Some(&(t_1, b))) = (self.rows.get(after.wrapping_sub(1)), self.rows.get(after))
        else {
            return if after == 0 { self.rows[0].1 } else { self.rows[self.rows.len() - 1].1 };
        };
        let share = (t - t_0).0 as f64 / (t_1 - t_0).0 as f64;
        Attitude::from_quat(a.q * exp(log(a.q.conjugate() * b.q) * share))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn between_two_rows_it_turns_evenly_and_outside_it_holds() {
        let at = |angle: f64| Attitude::from_quat(exp(DVec3::new(0.0, angle, 0.0)));
        // The sign of a row's quaternion is free.
        let rows = vec![(SimTime(10), at(0.1)), (SimTime(30), Attitude::from_quat(-at(0.5).q))];
        let track = Track::new(rows).unwrap();
        for (t, angle) in [(0, 0.1), (10, 0.1), (15, 0.2), (20, 0.3), (30, 0.5), (99, 0.5)] {
            assert!(track.at(SimTime(t)).angle_to(at(angle)) < 1e-12, "{t}");
        }
        assert_eq!((track.first(), track.last()), (SimTime(10), SimTime(30)));
    }

    #[test]
    fn a_table_out_of_order_is_refused_with_its_row() {
        let rows = |times: &[i64]| times.iter().map(|&t| (SimTime(t), Attitude::IDENTITY)).collect();
        assert!(Track::new(rows(&[5])).unwrap_err().to_string().contains("two or more"));
        assert!(Track::new(rows(&[5, 6, 6])).unwrap_err().to_string().starts_with("row 3"));
    }
}
