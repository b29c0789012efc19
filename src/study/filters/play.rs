//! A plan played into memory: what filters read, and the truth beside it.

use crate::filters::Readings;
use crate::geometry::Attitude;
use crate::player::{BLOCK, Player};
use crate::scene::Plan;
use crate::sensor::SensorKind;
use crate::time::SimTime;
use std::convert::Infallible;

/// Readings and the exact attitude at each of the gyro's.
#[derive(Clone, Debug, Default)]
pub struct Played {
    /// What the sensors read.
    pub readings: Readings,
    /// Body to North-East-Down, when the gyro was read.
    pub truth: Vec<(SimTime, Attitude)>,
    /// How far east of true north the field points at the start, rad.
    pub declination: f64,
}

/// Plays all of a plan.
pub fn play(plan: &Plan) -> Played {
    play_by(Player::new(plan, plan.duration, BLOCK), plan)
}

/// What a player of this plan makes.
pub fn play_by(mut player: Player<'_>, plan: &Plan) -> Played {
    let begin = plan.trajectory.at(SimTime::ZERO);
    let field = begin.attitude.apply(begin.field).v;
    let mut played = Played { declination: libm::atan2(field.y, field.x), ..Played::default() };
    let Ok(()) = player.play(|moment| {
        for reading in moment.readings {
            let Some(triad) = reading.body() else { continue };
            let column = match reading.kind {
                SensorKind::Gyro => &mut played.readings.gyro,
                SensorKind::Accel => &mut played.readings.accel,
                SensorKind::Mag => &mut played.readings.mag,
                _ => continue,
            };
            column.push((moment.t, triad.value));
            if reading.kind == SensorKind::Gyro {
                played.truth.push((moment.t, moment.truth.attitude));
            }
        }
        Ok::<(), Infallible>(())
    });
    played
}
