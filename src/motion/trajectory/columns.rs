//! The truth at many instants, one column a component: only what is asked for is computed.

use super::super::stepped::{Scratch, Stepped};
use super::{Segment, Trajectory, Truth};
use crate::geometry::{Attitude, Vector};
use crate::time::SimTime;
use glam::DQuat;
use std::ops::{BitOr, Range};

/// Which components of the truth somebody reads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wants {
    /// The attitude.
    pub attitude: bool,
    /// The angular rate.
    pub rate: bool,
    /// The specific force.
    pub force: bool,
    /// The magnetic field.
    pub field: bool,
}

impl Wants {
    /// None of them.
    pub const NONE: Wants = Wants { attitude: false, rate: false, force: false, field: false };
    /// All of them.
    pub const ALL: Wants = Wants { attitude: true, rate: true, force: true, field: true };
}

impl BitOr for Wants {
    type Output = Wants;
    fn bitor(self, other: Wants) -> Wants {
        Wants {
            attitude: self.attitude | other.attitude,
            rate: self.rate | other.rate,
            force: self.force | other.force,
            field: self.field | other.field,
        }
    }
}

/// The truth at times in order. A component that was not asked for has no values.
#[derive(Clone, Debug, Default)]
pub struct TruthColumns {
    /// The times.
    pub t: Vec<SimTime>,
    /// Body to nav: the quaternion's x, y, z and w.
    pub attitude: [Vec<f64>; 4],
    /// Angular rate of body relative to nav, rad/s in body axes.
    pub rate: [Vec<f64>; 3],
    /// Specific force, m/s² in body axes.
    pub force: [Vec<f64>; 3],
    /// Magnetic field, µT in body axes.
    pub field: [Vec<f64>; 3],
    scratch: Scratch,
    since: Vec<SimTime>,
}

impl TruthColumns {
    /// How many instants.
    pub fn len(&self) -> usize {
        self.t.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.t.is_empty()
    }

    /// The attitude at one of them.
    ///
    /// # Panics
    /// It was not asked for, or there are fewer instants.
    pub fn attitude(&self, i: usize) -> Attitude {
        let [x, y, z, w] = &self.attitude;
        Attitude::from_quat(DQuat::from_xyzw(x[i], y[i], z[i], w[i]))
    }

    /// The whole truth at one of them.
    ///
    /// # Panics
    /// Some of it was not asked for, or there are fewer instants.
    pub fn truth(&self, i: usize) -> Truth {
        fn at<F>(columns: &[Vec<f64>; 3], i: usize) -> Vector<F> {
            Vector::new(columns[0][i], columns[1][i], columns[2][i])
        }
        Truth {
            t: self.t[i],
            attitude: self.attitude(i),
            rate: at(&self.rate, i),
            force: at(&self.force, i),
            field: at(&self.field, i),
        }
    }

    /// Forgets the instants and keeps the memory.
    pub fn clear(&mut self) {
        self.t.clear();
        self.attitude.iter_mut().for_each(Vec::clear);
        for columns in [&mut self.rate, &mut self.force, &mut self.field] {
            columns.iter_mut().for_each(Vec::clear);
        }
    }

    fn push(&mut self, truth: &Truth, wants: Wants) {
        if wants.attitude {
            self.attitude.iter_mut().zip(truth.attitude.q.to_array()).for_each(|(column, x)| column.push(x));
        }
        for (wanted, columns, v) in [
            (wants.rate, &mut self.rate, truth.rate.v),
            (wants.force, &mut self.force, truth.force.v),
            (wants.field, &mut self.field, truth.field.v),
        ] {
            if wanted {
                columns.iter_mut().zip(v.to_array()).for_each(|(column, x)| column.push(x));
            }
        }
    }
}

impl Trajectory {
    /// Replaces what `columns` holds beside its times, which are in order, by the truth at them.
    pub fn fill(&self, columns: &mut TruthColumns, wants: Wants) {
        // A push of the nav frame is turned into the body's.
        let wants = wants | Wants { attitude: wants.force && !self.forces.is_empty(), ..Wants::NONE };
        let times = std::mem::take(&mut columns.t);
        columns.clear();
        let mut done = 0;
        while let Some(&first) = times.get(done) {
            let segment = self.segment(first);
            let count = times[done..].partition_point(|&t| t < segment.end).max(1);
            let within = &times[done..done + count];
            match segment.motion.constant_rate() {
                Some(_) => self.fill_turning(segment, within, wants, columns),
                None => within.iter().for_each(|&t| {
                    columns.push(&self.in_segment(segment, t, (t - segment.start).exact_seconds()), wants);
                }),
            }
            done += count;
        }
        columns.t = times;
    }

    fn fill_turning(&self, segment: &Segment, times: &[SimTime], wants: Wants, columns: &mut TruthColumns) {
        let Some(rate) = segment.motion.constant_rate() else { return };
        let first = columns.force[0].len();
        let TruthColumns { attitude, force, field, scratch, since, .. } = columns;
        since.clear();
        since.extend(times.iter().map(|&t| SimTime(t.0 - segment.start.0)));
        if wants.attitude || wants.force || wants.field {
            let stepped = Stepped::new(&*segment.motion, rate, segment.attitude);
            stepped.cells(since, scratch, |cell| {
                if wants.attitude {
                    cell.attitudes(attitude);
                }
                if wants.force {
                    cell.seen(-self.gravity, force);
                }
                if wants.field {
                    cell.seen(self.field, field);
                }
            });
        }
        if wants.rate {
            columns.rate.iter_mut().zip(rate.v.to_array()).for_each(|(column, w)| {
                column.resize(column.len() + times.len(), w);
            });
        }
        if wants.force {
            self.push_on(times, first..first + times.len(), columns);
        }
    }

    /// Adds the external forces at `times`, which are the instants `at` of the columns.
    fn push_on(&self, times: &[SimTime], at: Range<usize>, columns: &mut TruthColumns) {
        if self.forces.is_empty() {
            return;
        }
        for (&t, i) in times.iter().zip(at) {
            let to_body = columns.attitude(i).inverse();
            for push in self.pushes(t, to_body) {
                columns.force.iter_mut().zip(push.v.to_array()).for_each(|(column, x)| column[i] += x);
            }
        }
    }
}
