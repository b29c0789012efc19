//! The scene played again, up to where the run is: the same readings, made only where somebody looks.

use super::batch::{Batch, Readings};
use crate::geometry::{Axes, Vector};
use crate::motion::Truth;
use crate::player::{Moment, Player};
use crate::scene::Plan;
use crate::sensor::{Fix, Measured, Measurement, Reading, Setting};
use crate::time::{NANOS, SimTime};
use std::convert::Infallible;
use std::time::{Duration, Instant};

/// Ticks to play between two looks at the time.
const BLOCK: usize = 256;
/// Between two truths, at the least, ns.
const TRUTH: i64 = NANOS / 100;

/// A scene that is played again.
pub(super) struct Reel<'a> {
    plan: &'a Plan,
    end: SimTime,
    player: Player<'a>,
    settings: Vec<(usize, Setting)>,
    /// Everything before this is played.
    pub played: SimTime,
}

impl<'a> Reel<'a> {
    /// A plan that is played up to `end`, with the settings that a driver has made so far.
    pub(super) fn new(plan: &'a Plan, end: SimTime, settings: Vec<(usize, Setting)>) -> Reel<'a> {
        let mut reel =
            Reel { plan, end, player: Player::new(plan, end, BLOCK), settings, played: SimTime::ZERO };
        for (sensor, setting) in &reel.settings {
            // The driver's run has built the same.
            let _ = reel.player.set(*sensor, setting);
        }
        reel
    }

    /// A driver has set a sensor: what was played from then on is played again. Returns whether that was anything.
    pub(super) fn set(&mut self, sensor: usize, setting: Setting) -> bool {
        let again = setting.start < self.played;
        let settings = std::mem::take(&mut self.settings);
        let settings = settings.into_iter().chain([(sensor, setting)]).collect();
        *self = Reel::new(self.plan, self.end, settings);
        again
    }

    /// Plays up to `until`, for at most about `budget`; readings to `each`.
    pub(super) fn play(&mut self, until: SimTime, budget: Duration, each: &mut impl FnMut(Moment<'_>)) {
        let begun = Instant::now();
        while begun.elapsed() < budget {
            let mut last = None;
            let played = self.player.play_block_before(until, |moment| {
                last = Some(moment.t);
                each(moment);
                Ok::<_, Infallible>(())
            });
            self.played = last.map_or(self.played, |last| self.played.max(last + SimTime(1)));
            if !matches!(played, Ok(true)) {
                self.played = self.played.max(until.min(self.end));
                return;
            }
        }
    }
}

/// Puts a moment's readings into a batch, and its truth at most a hundred times a second.
pub(super) fn gather(batch: &mut Batch, axes: Axes, moment: &Moment<'_>) {
    if batch.truth.last().is_none_or(|last: &Truth| moment.t.0 - last.t.0 >= TRUTH) {
        batch.truth.push(*moment.truth);
    }
    for reading in moment.readings {
        let (values, truth) = values(axes, reading);
        let place = batch.readings.iter().position(|it| it.of == reading.sensor);
        let place = place.unwrap_or_else(|| {
            let columns = || vec![Vec::new(); values.len()];
            batch.readings.push(Readings {
                of: reading.sensor,
                t: Vec::new(),
                values: columns(),
                truth: columns(),
            });
            batch.readings.len() - 1
        });
        let readings = &mut batch.readings[place];
        readings.t.push(moment.t);
        readings.values.iter_mut().zip(values.get()).for_each(|(column, value)| column.push(*value));
        readings.truth.iter_mut().zip(truth.get()).for_each(|(column, value)| column.push(*value));
    }
}

/// Up to six numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    values: [f64; 6],
    len: usize,
}

impl Row {
    fn of(numbers: &[f64]) -> Row {
        let mut values = [0.0; 6];
        values[..numbers.len()].copy_from_slice(numbers);
        Row { values, len: numbers.len() }
    }

    /// How many.
    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// The numbers.
    pub(super) fn get(&self) -> &[f64] {
        &self.values[..self.len]
    }
}

/// What a reading says, and what it would say without errors, in the scene's axes.
pub(super) fn values(axes: Axes, reading: &Reading) -> (Row, Row) {
    match &reading.measurement {
        Measurement::Triad(Measured { value, truth, .. }) => {
            let row = |v: Vector<_>| Row::of(&axes.body_out(v).to_array());
            (row(*value), row(*truth))
        }
        Measurement::Pressure(pressure) => (Row::of(&[pressure.value]), Row::of(&[pressure.truth])),
        Measurement::Position(position) => (fix(&position.fix), fix(&position.true_fix)),
    }
}

fn fix(Fix { position, velocity }: &Fix) -> Row {
    let [vn, ve, vd] = velocity.v.to_array();
    Row::of(&[position.latitude.to_degrees(), position.longitude.to_degrees(), position.altitude, vn, ve, vd])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn played(plan: &Plan, steps: &[i64]) -> Vec<(SimTime, Vec<f64>)> {
        let mut reel = Reel::new(plan, plan.duration, Vec::new());
        let mut rows = Vec::new();
        for step in steps {
            reel.play(SimTime(*step), Duration::from_secs(60), &mut |moment| {
                for reading in moment.readings {
                    rows.push((moment.t, values(plan.axes, reading).0.get().to_vec()));
                }
            });
        }
        rows
    }

    #[test]
    fn where_it_pauses_changes_nothing() {
        let plan = Plan::load("table-1", &["duration=2 s".into()]).unwrap();
        let whole = played(&plan, &[plan.duration.0]);
        assert_eq!(whole.len(), 2000 + 2000 + 200);
        let pieces: Vec<i64> = (1..=40).map(|k| k * 50_000_001).collect();
        assert_eq!(played(&plan, &pieces), whole);
        let mut batch = Batch::default();
        let mut reel = Reel::new(&plan, plan.duration, Vec::new());
        reel.play(plan.duration, Duration::from_secs(60), &mut |moment| {
            gather(&mut batch, plan.axes, &moment)
        });
        assert_eq!((batch.truth.len(), reel.played), (200, plan.duration));
        let gyro = batch.readings.iter().find(|it| it.of == 0).unwrap();
        let first: Vec<f64> = gyro.values.iter().map(|column| column[1]).collect();
        let same = whole.iter().find(|(t, _)| *t == gyro.t[1]).unwrap();
        assert_eq!(first, same.1);
    }
}
