//! What has happened since the last look, as data.

use crate::geometry::Attitude;
use crate::motion::Truth;
use crate::time::SimTime;

/// What has happened since the last look.
#[derive(Clone, Debug, Default)]
pub struct Batch {
    /// Each sensor's new readings; a sensor without any may be missing.
    pub readings: Vec<Readings>,
    /// The truth at the same times, or some of them.
    pub truth: Vec<Truth>,
    /// Attitudes that were told.
    pub estimates: Vec<Told>,
}

impl Batch {
    /// Takes in a value that was heard.
    pub(super) fn heard(&mut self, Heard { of, t, values }: Heard) {
        let place = self.readings.iter().position(|it| it.of == of);
        let place = place.unwrap_or_else(|| {
            self.readings.push(Readings {
                of,
                values: vec![Vec::new(); values.len()],
                ..Readings::default()
            });
            self.readings.len() - 1
        });
        let readings = &mut self.readings[place];
        readings.t.push(t);
        readings.values.iter_mut().zip(values).for_each(|(column, value)| column.push(value));
    }
}

/// A value that was heard.
#[derive(Clone, Debug)]
pub(super) struct Heard {
    /// Which of the sensors.
    pub of: usize,
    /// Since the first.
    pub t: SimTime,
    /// In body axes, or a pressure.
    pub values: Vec<f64>,
}

/// An attitude that was told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Told {
    /// Which of the estimators tells it.
    pub of: usize,
    /// When it held, in scene time, as far as known.
    pub t: SimTime,
    /// Body to nav.
    pub attitude: Attitude,
}

/// Readings of one sensor, in order of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Readings {
    /// Which of the sensors.
    pub of: usize,
    /// When each was taken.
    pub t: Vec<SimTime>,
    /// What it says, one column for each value (see [`columns`](super::columns)), in the scene's axes.
    pub values: Vec<Vec<f64>>,
    /// What it would say without errors; no columns where that is not known.
    pub truth: Vec<Vec<f64>>,
}
