//! The kinds of quantity that scenes have: name, dimension, example, units to offer, signs.

use super::kind::{Kind, Sign};
use super::unit::{BITS, Base, Dimension};

const ANGLE: Dimension = Dimension::NONE.with(Base::Angle, 2);
const ANGULAR_RATE: Dimension = ANGLE.with(Base::Time, -2);
const LENGTH: Dimension = Dimension::NONE.with(Base::Length, 2);
const ACCELERATION: Dimension = LENGTH.with(Base::Time, -4);
const FIELD: Dimension = Dimension::NONE.with(Base::Field, 2);
const FREQUENCY: Dimension = Dimension::NONE.with(Base::Time, -2);
const TEMPERATURE: Dimension = Dimension::NONE.with(Base::Temperature, 2);
const GYRO_DENSITY: Dimension = ANGLE.with(Base::Time, -1);
const ACCEL_DENSITY: Dimension = LENGTH.with(Base::Time, -3);
const MAG_DENSITY: Dimension = FIELD.with(Base::Time, 1);
const PRESSURE: Dimension = Dimension::NONE.with(Base::Mass, 2).with(Base::Length, -2).with(Base::Time, -4);

/// Every way to give a step: per count, counts per unit, the step alone, bits.
const GYRO_STEPS: &[Dimension] = &[
    ANGULAR_RATE.with(Base::Count, -2),
    ANGLE.with(Base::Angle, -2).with(Base::Time, 2).with(Base::Count, 2),
    ANGULAR_RATE,
    BITS,
];
const ACCEL_STEPS: &[Dimension] = &[
    ACCELERATION.with(Base::Count, -2),
    LENGTH.with(Base::Length, -2).with(Base::Time, 4).with(Base::Count, 2),
    ACCELERATION,
    BITS,
];
const MAG_STEPS: &[Dimension] =
    &[FIELD.with(Base::Count, -2), FIELD.with(Base::Field, -2).with(Base::Count, 2), FIELD, BITS];
const BARO_STEPS: &[Dimension] = &[
    PRESSURE.with(Base::Count, -2),
    Dimension::NONE.with(Base::Mass, -2).with(Base::Length, 2).with(Base::Time, 4).with(Base::Count, 2),
    PRESSURE,
    BITS,
];
const POSITION_STEPS: &[Dimension] =
    &[LENGTH.with(Base::Count, -2), LENGTH.with(Base::Length, -2).with(Base::Count, 2), LENGTH, BITS];

const fn kind(
    name: &'static str,
    dimensions: &'static [Dimension],
    example: &'static str,
    units: &'static [&'static str],
) -> Kind {
    Kind { name, dimensions, example, units, sign: Sign::Any }
}

impl Kind {
    /// An angle, in rad.
    pub const ANGLE: Kind = kind("angle", &[ANGLE], "20 deg", &["rad", "deg"]);
    /// A body's angular rate, in rad/s.
    pub const ANGULAR_RATE: Kind = kind("angular rate", &[ANGULAR_RATE], "20 deg/s", &["rad/s", "deg/s"]);
    /// An acceleration, in m/s².
    pub const ACCELERATION: Kind = kind("acceleration", &[ACCELERATION], "9.8 m/s^2", &["m/s^2", "g"]);
    /// A magnetic field, in µT.
    pub const FIELD: Kind = kind("magnetic field", &[FIELD], "50 uT", &["uT", "G"]);
    /// A time, in s. See [`duration_ns`](super::duration_ns) for whole nanoseconds.
    pub const TIME: Kind = kind("time", &[Dimension::NONE.with(Base::Time, 2)], "5 s", &["s", "ms"]);
    /// A sensor's output rate, in Hz. See [`rate`](super::rate) for the exact fraction.
    pub const RATE: Kind = kind("rate", &[FREQUENCY], "100 Hz", &["Hz", "kHz"]).signed(Sign::Positive);
    /// A frequency of anything else, in Hz.
    pub const FREQUENCY: Kind = kind("frequency", &[FREQUENCY], "2 Hz", &["Hz", "kHz"]);
    /// A length, in m.
    pub const LENGTH: Kind = kind("length", &[LENGTH], "0.1 m", &["m", "mm"]);
    /// A speed, in m/s.
    pub const SPEED: Kind = kind("speed", &[LENGTH.with(Base::Time, -2)], "15 m/s", &["m/s", "km/h"]);
    /// A gyro's one-sided noise density, in rad/s/√Hz; 0 or above.
    pub const GYRO_DENSITY: Kind =
        kind("gyro noise density", &[GYRO_DENSITY], "0.01 deg/s/rtHz", &["rad/s/rtHz", "deg/s/rtHz"])
            .signed(Sign::NonNegative);
    /// An accelerometer's one-sided noise density, in m/s²/√Hz; 0 or above.
    pub const ACCEL_DENSITY: Kind =
        kind("accelerometer noise density", &[ACCEL_DENSITY], "300 ug/rtHz", &["m/s^2/rtHz", "ug/rtHz"])
            .signed(Sign::NonNegative);
    /// A magnetometer's one-sided noise density, in µT/√Hz; 0 or above.
    pub const MAG_DENSITY: Kind =
        kind("magnetometer noise density", &[MAG_DENSITY], "0.1 uT/rtHz", &["uT/rtHz", "nT/rtHz"])
            .signed(Sign::NonNegative);
    /// An angle random walk, in rad/√s (the dimension of a gyro's density); 0 or above.
    pub const ANGLE_RANDOM_WALK: Kind =
        kind("angle random walk", &[GYRO_DENSITY], "0.34 deg/rth", &["rad/rts", "deg/rth"])
            .signed(Sign::NonNegative);
    /// A velocity random walk, in m/s/√s (the dimension of a density); 0 or above.
    pub const VELOCITY_RANDOM_WALK: Kind =
        kind("velocity random walk", &[ACCEL_DENSITY], "0.037 m/s/rth", &["m/s/rts", "m/s/rth"])
            .signed(Sign::NonNegative);
    /// A gyro's noise variance per sample, in rad²/s²; 0 or above.
    pub const GYRO_VARIANCE: Kind = kind(
        "gyro noise variance",
        &[ANGLE.with(Base::Angle, 4).with(Base::Time, -4)],
        "3e-6 rad^2/s^2",
        &["rad^2/s^2", "deg^2/s^2"],
    )
    .signed(Sign::NonNegative);
    /// An accelerometer's noise variance per sample, in m²/s⁴; 0 or above.
    pub const ACCEL_VARIANCE: Kind = kind(
        "accelerometer noise variance",
        &[LENGTH.with(Base::Length, 4).with(Base::Time, -8)],
        "1e-4 m^2/s^4",
        &["m^2/s^4", "mg^2"],
    )
    .signed(Sign::NonNegative);
    /// A magnetometer's noise variance per sample, in µT²; 0 or above.
    pub const MAG_VARIANCE: Kind =
        kind("magnetometer noise variance", &[FIELD.with(Base::Field, 4)], "0.04 uT^2", &["uT^2", "mG^2"])
            .signed(Sign::NonNegative);
    /// A random walk of a gyro's bias, in rad/s/√s; 0 or above.
    pub const GYRO_WALK: Kind = kind(
        "gyro bias random walk",
        &[ANGULAR_RATE.with(Base::Time, -3)],
        "0.001 deg/s/rts",
        &["rad/s/rts", "deg/s/rts"],
    )
    .signed(Sign::NonNegative);
    /// A random walk of an accelerometer's bias, in m/s²/√s; 0 or above.
    pub const ACCEL_WALK: Kind = kind(
        "accelerometer bias random walk",
        &[ACCELERATION.with(Base::Time, -5)],
        "0.0001 m/s^2/rts",
        &["m/s^2/rts", "ug/rts"],
    )
    .signed(Sign::NonNegative);
    /// A random walk of a magnetometer's bias, in µT/√s; 0 or above.
    pub const MAG_WALK: Kind = kind(
        "magnetometer bias random walk",
        &[FIELD.with(Base::Time, -1)],
        "0.001 uT/rts",
        &["uT/rts", "nT/rts"],
    )
    .signed(Sign::NonNegative);
    /// A gyro's step, see [`Self::resolution`]: rad/s per count, its inverse, rad/s, or bits.
    pub const GYRO_RESOLUTION: Kind =
        kind("gyro resolution", GYRO_STEPS, "131 LSB/(deg/s)", &["rad/s/LSB", "LSB/(deg/s)", "bit"])
            .signed(Sign::Positive);
    /// An accelerometer's step, see [`Self::resolution`]: m/s² per count, its inverse, m/s², bits.
    pub const ACCEL_RESOLUTION: Kind =
        kind("accelerometer resolution", ACCEL_STEPS, "2048 LSB/g", &["m/s^2/LSB", "LSB/g", "bit"])
            .signed(Sign::Positive);
    /// A magnetometer's step, see [`Self::resolution`]: µT per count, its inverse, µT, or bits.
    pub const MAG_RESOLUTION: Kind =
        kind("magnetometer resolution", MAG_STEPS, "0.15 uT/LSB", &["uT/LSB", "LSB/G", "bit"])
            .signed(Sign::Positive);
    /// A plain number, of which `%` and `ppm` are parts.
    pub const RATIO: Kind = kind("ratio", &[Dimension::NONE], "0.5 %", &["%", "ppm"]);
    /// An absolute temperature, in °C; `K` counts from absolute zero.
    pub const TEMPERATURE: Kind = kind("temperature", &[TEMPERATURE], "25 degC", &["degC", "K"]);
    /// A difference of temperatures, in K; a °C is the same step.
    pub const TEMPERATURE_DIFFERENCE: Kind =
        kind("temperature difference", &[TEMPERATURE], "15 K", &["K", "degC"]);
    /// A gyro bias per kelvin, in rad/s/K.
    pub const GYRO_PER_KELVIN: Kind = kind(
        "gyro bias per kelvin",
        &[ANGULAR_RATE.with(Base::Temperature, -2)],
        "0.005 deg/s/K",
        &["rad/s/K", "deg/s/K"],
    );
    /// An accelerometer bias per kelvin, in m/s²/K.
    pub const ACCEL_PER_KELVIN: Kind = kind(
        "accelerometer bias per kelvin",
        &[ACCELERATION.with(Base::Temperature, -2)],
        "0.15 mg/K",
        &["m/s^2/K", "mg/K"],
    );
    /// A magnetometer bias per kelvin, in µT/K.
    pub const MAG_PER_KELVIN: Kind = kind(
        "magnetometer bias per kelvin",
        &[FIELD.with(Base::Temperature, -2)],
        "0.1 uT/K",
        &["uT/K", "mG/K"],
    );
    /// A change of scale per kelvin, in 1/K.
    pub const RATIO_PER_KELVIN: Kind = kind(
        "ratio per kelvin",
        &[Dimension::NONE.with(Base::Temperature, -2)],
        "100 ppm/K",
        &["ppm/K", "%/K"],
    );
    /// A gyro's sensitivity to acceleration, in rad/s per m/s².
    pub const G_SENSITIVITY: Kind = kind(
        "g-sensitivity",
        &[ANGLE.with(Base::Length, -2).with(Base::Time, 2)],
        "0.1 deg/s/g",
        &["rad/s/(m/s^2)", "deg/s/g"],
    );
    /// A power spectral density of angular rate, in rad²/s²/Hz; 0 or above.
    pub const GYRO_SPECTRUM: Kind = kind(
        "angular rate spectrum",
        &[ANGLE.with(Base::Angle, 4).with(Base::Time, -2)],
        "0.01 deg^2/s^2/Hz",
        &["rad^2/s^2/Hz", "deg^2/s^2/Hz"],
    )
    .signed(Sign::NonNegative);
    /// A power spectral density of acceleration, in m²/s⁴/Hz; 0 or above.
    pub const ACCEL_SPECTRUM: Kind = kind(
        "acceleration spectrum",
        &[LENGTH.with(Base::Length, 4).with(Base::Time, -6)],
        "0.01 g^2/Hz",
        &["m^2/s^4/Hz", "g^2/Hz"],
    )
    .signed(Sign::NonNegative);
    /// A pressure, in Pa.
    pub const PRESSURE: Kind = kind("pressure", &[PRESSURE], "1013 hPa", &["Pa", "hPa"]);
    /// A barometer's one-sided noise density, in Pa/√Hz; 0 or above.
    pub const BARO_DENSITY: Kind =
        kind("pressure noise density", &[PRESSURE.with(Base::Time, -3)], "0.5 Pa/rtHz", &["Pa/rtHz"])
            .signed(Sign::NonNegative);
    /// A barometer's noise variance per sample, in Pa²; 0 or above.
    pub const BARO_VARIANCE: Kind = kind(
        "pressure noise variance",
        &[Dimension::NONE.with(Base::Mass, 4).with(Base::Length, -4).with(Base::Time, -8)],
        "4 Pa^2",
        &["Pa^2"],
    )
    .signed(Sign::NonNegative);
    /// A random walk of a barometer's bias, in Pa/√s; 0 or above.
    pub const BARO_WALK: Kind =
        kind("pressure bias random walk", &[PRESSURE.with(Base::Time, -5)], "0.1 Pa/rts", &["Pa/rts"])
            .signed(Sign::NonNegative);
    /// A barometer's step, see [`Self::resolution`]: Pa per count, its inverse, Pa, or bits.
    pub const BARO_RESOLUTION: Kind =
        kind("pressure resolution", BARO_STEPS, "1.2 Pa", &["Pa", "Pa/LSB", "LSB/Pa"]).signed(Sign::Positive);
    /// A barometer's bias per kelvin, in Pa/K.
    pub const BARO_PER_KELVIN: Kind =
        kind("pressure bias per kelvin", &[PRESSURE.with(Base::Temperature, -2)], "1.5 Pa/K", &["Pa/K"]);
    /// A position's one-sided noise density, in m/√Hz; 0 or above.
    pub const POSITION_DENSITY: Kind =
        kind("position noise density", &[LENGTH.with(Base::Time, 1)], "0.5 m/rtHz", &["m/rtHz"])
            .signed(Sign::NonNegative);
    /// A position's noise variance per sample, in m²; 0 or above.
    pub const POSITION_VARIANCE: Kind =
        kind("position noise variance", &[LENGTH.with(Base::Length, 4)], "4 m^2", &["m^2"])
            .signed(Sign::NonNegative);
    /// A random walk of a position's bias, in m/√s; 0 or above.
    pub const POSITION_WALK: Kind =
        kind("position bias random walk", &[LENGTH.with(Base::Time, -1)], "0.02 m/rts", &["m/rts"])
            .signed(Sign::NonNegative);
    /// A position's step, see [`Self::resolution`]: m per count, its inverse, m, or bits.
    pub const POSITION_RESOLUTION: Kind =
        kind("position resolution", POSITION_STEPS, "0.01 m", &["m", "m/LSB", "LSB/m"])
            .signed(Sign::Positive);

    /// Every kind; of those with the same dimension, the first names it in messages.
    pub const ALL: &[Kind] = &[
        Self::ANGLE,
        Self::ANGULAR_RATE,
        Self::ACCELERATION,
        Self::FIELD,
        Self::TIME,
        Self::FREQUENCY,
        Self::RATE,
        Self::LENGTH,
        Self::SPEED,
        Self::GYRO_DENSITY,
        Self::ANGLE_RANDOM_WALK,
        Self::ACCEL_DENSITY,
        Self::VELOCITY_RANDOM_WALK,
        Self::MAG_DENSITY,
        Self::GYRO_VARIANCE,
        Self::ACCEL_VARIANCE,
        Self::MAG_VARIANCE,
        Self::GYRO_WALK,
        Self::ACCEL_WALK,
        Self::MAG_WALK,
        Self::RATIO,
        Self::TEMPERATURE,
        Self::TEMPERATURE_DIFFERENCE,
        Self::GYRO_PER_KELVIN,
        Self::ACCEL_PER_KELVIN,
        Self::MAG_PER_KELVIN,
        Self::RATIO_PER_KELVIN,
        Self::G_SENSITIVITY,
        Self::GYRO_SPECTRUM,
        Self::ACCEL_SPECTRUM,
        Self::PRESSURE,
        Self::BARO_DENSITY,
        Self::BARO_VARIANCE,
        Self::BARO_WALK,
        Self::BARO_PER_KELVIN,
        Self::POSITION_DENSITY,
        Self::POSITION_VARIANCE,
        Self::POSITION_WALK,
        Self::GYRO_RESOLUTION,
        Self::ACCEL_RESOLUTION,
        Self::MAG_RESOLUTION,
        Self::BARO_RESOLUTION,
        Self::POSITION_RESOLUTION,
    ];
}
