//! What is done to good readings.

use super::trials::Trial;
use crate::filters::{Column, Readings};
use crate::geometry::{Body, Vector};
use glam::DVec3;

/// One reading in so many is harmed.
const ONE_IN: usize = 10;

/// Changes the readings of a column from `begin` to `end` seconds.
pub(super) fn between(column: &mut Column, begin: f64, end: f64, change: impl Fn(DVec3) -> DVec3) {
    for (t, v) in column {
        if (begin..end).contains(&t.seconds()) {
            *v = Vector::from_vec(change(v.v));
        }
    }
}

/// One reading at 10 s is no number on any axis.
pub(super) fn no_number(column: &mut Column) {
    if let Some((_, v)) = column.iter_mut().find(|(t, _)| t.seconds() >= 10.0) {
        *v = Vector::from_vec(DVec3::NAN);
    }
}

/// Every component within `limit` of 0.
pub(super) fn clipped(v: DVec3, limit: f64) -> DVec3 {
    v.clamp(DVec3::splat(-limit), DVec3::splat(limit))
}

/// One in ten is lost.
pub(super) fn lost(column: &mut Column) {
    let mut k = 0;
    column.retain(|_| {
        k += 1;
        k % ONE_IN != 0
    });
}

/// One in ten has the value of the one before it.
pub(super) fn repeated(column: &mut Column) {
    for k in (ONE_IN..column.len()).step_by(ONE_IN) {
        column[k].1 = column[k - 1].1;
    }
}

/// One in ten comes twice, at the same time.
pub(super) fn twice(column: &mut Column) {
    let again = |(k, reading): (usize, &(_, Vector<Body>))| {
        std::iter::repeat_n(*reading, if k % ONE_IN == ONE_IN - 1 { 2 } else { 1 })
    };
    *column = column.iter().enumerate().flat_map(again).collect();
}

/// One in ten comes after the one that follows it.
pub(super) fn swapped(column: &mut Column) {
    for k in (ONE_IN..column.len()).step_by(ONE_IN) {
        column.swap(k - 1, k);
    }
}

/// From 10 s on only every second reading of each sensor comes; the gyro's is the mean of the two.
pub(super) fn at_half_the_rate(readings: &mut Readings) {
    let gyro = &mut readings.gyro;
    for k in (1..gyro.len()).step_by(2) {
        if gyro[k].0.seconds() >= 10.0 {
            gyro[k].1 = (gyro[k - 1].1 + gyro[k].1) * 0.5;
        }
    }
    for column in [&mut readings.gyro, &mut readings.accel, &mut readings.mag] {
        let mut k = 0;
        column.retain(|(t, _)| {
            k += 1;
            t.seconds() < 10.0 || k % 2 == 0
        });
    }
}

/// The trial with its readings changed.
pub(super) fn harmed(mut trial: Trial, harm: impl FnOnce(&mut Readings)) -> Trial {
    harm(&mut trial.readings);
    trial
}
