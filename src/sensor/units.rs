//! Which units a sensor's keys take.

use crate::keys::Name;
use crate::quantity::Kind;
use glam::DVec3;

/// The Allan deviation of an angle at 1 s, per axis, rad/√s.
pub(super) const ANGLE_RANDOM_WALK: Name<DVec3> = Name::new("angle_random_walk");
/// The Allan deviation of a velocity at 1 s, per axis, m/s/√s.
pub(super) const VELOCITY_RANDOM_WALK: Name<DVec3> = Name::new("velocity_random_walk");

/// The kinds of quantity that one sensor's keys take.
#[derive(Debug)]
pub struct Units {
    /// A reading, its bias and its σ.
    pub reading: Kind,
    /// Its square.
    pub variance: Kind,
    /// A one-sided noise density.
    pub density: Kind,
    /// The key and kind of the random walk of the reading's integral, where the field has a name for it.
    pub random_walk: Option<(Name<DVec3>, Kind)>,
    /// The driving noise of a bias walk.
    pub bias_walk: Kind,
    /// The size of a count, counts a unit, or bits.
    pub resolution: Kind,
    /// A bias per kelvin, where there is such a thing.
    pub per_kelvin: Option<Kind>,
}

pub(super) static GYRO_UNITS: Units = Units {
    reading: Kind::ANGULAR_RATE,
    variance: Kind::GYRO_VARIANCE,
    density: Kind::GYRO_DENSITY,
    random_walk: Some((ANGLE_RANDOM_WALK, Kind::ANGLE_RANDOM_WALK)),
    bias_walk: Kind::GYRO_WALK,
    resolution: Kind::GYRO_RESOLUTION,
    per_kelvin: Some(Kind::GYRO_PER_KELVIN),
};
pub(super) static ACCEL_UNITS: Units = Units {
    reading: Kind::ACCELERATION,
    variance: Kind::ACCEL_VARIANCE,
    density: Kind::ACCEL_DENSITY,
    random_walk: Some((VELOCITY_RANDOM_WALK, Kind::VELOCITY_RANDOM_WALK)),
    bias_walk: Kind::ACCEL_WALK,
    resolution: Kind::ACCEL_RESOLUTION,
    per_kelvin: Some(Kind::ACCEL_PER_KELVIN),
};
pub(super) static MAG_UNITS: Units = Units {
    reading: Kind::FIELD,
    variance: Kind::MAG_VARIANCE,
    density: Kind::MAG_DENSITY,
    random_walk: None,
    bias_walk: Kind::MAG_WALK,
    resolution: Kind::MAG_RESOLUTION,
    per_kelvin: Some(Kind::MAG_PER_KELVIN),
};
pub(super) static PRESSURE_UNITS: Units = Units {
    reading: Kind::PRESSURE,
    variance: Kind::BARO_VARIANCE,
    density: Kind::BARO_DENSITY,
    random_walk: None,
    bias_walk: Kind::BARO_WALK,
    resolution: Kind::BARO_RESOLUTION,
    per_kelvin: Some(Kind::BARO_PER_KELVIN),
};
/// Of the position.
pub(super) static GPS_UNITS: Units = Units {
    reading: Kind::LENGTH,
    variance: Kind::POSITION_VARIANCE,
    density: Kind::POSITION_DENSITY,
    random_walk: None,
    bias_walk: Kind::POSITION_WALK,
    resolution: Kind::POSITION_RESOLUTION,
    per_kelvin: None,
};
