//! `[baro]` and `[gps]`: what they are told besides error terms, and a receiver's fix.
//!
//! Their truth is a position, which is found beside the truth of a tick and only for a scene that has one of them.
//! A barometer has one component; a GPS receiver's position has three, along nav axes, and so have its error terms.

use super::{Block, SensorKind, Stage, Term, TermKind};
use crate::earth::{Place, SEA_LEVEL_PRESSURE};
use crate::geometry::{Nav, Vector};
use crate::keys::{Key, Takes, Values};
use crate::quantity::{Kind, Sign};
use crate::random::Normals;
use glam::DVec3;

/// The terms of which a barometer's reading has a use.
const BARO_TERMS: [&str; 12] = [
    "temperature",
    "clock_error",
    "delay",
    "filter",
    "bias",
    "bias_instability",
    "flicker",
    "bias_walk",
    "bias_temperature",
    "white_noise",
    "range",
    "resolution",
];
/// The terms of which a receiver's position has a use.
const GPS_TERMS: [&str; 9] = [
    "clock_error",
    "delay",
    "bias",
    "bias_instability",
    "flicker",
    "bias_walk",
    "white_noise",
    "velocity_noise",
    "resolution",
];

/// Whether a sensor of this kind can have the term.
pub(super) fn concerns(kind: SensorKind, term: &str) -> bool {
    match kind {
        SensorKind::Gyro | SensorKind::Accel | SensorKind::Mag => true,
        SensorKind::Baro => BARO_TERMS.contains(&term),
        SensorKind::Gps => GPS_TERMS.contains(&term),
    }
}

/// A term's key as a sensor of this kind takes it: of one component, or along nav axes. A time is no component.
pub(super) fn turned(kind: SensorKind, key: Key) -> Key {
    let takes = match (kind, key.takes) {
        (_, Takes::PerAxis(time)) if time.name() == Kind::TIME.name() => key.takes,
        (SensorKind::Baro, Takes::PerAxis(one) | Takes::BodyVector(one)) => Takes::OneAxis(one),
        (SensorKind::Gps, Takes::PerAxis(three) | Takes::BodyVector(three)) => Takes::NavVector(three),
        _ => key.takes,
    };
    Key { takes, ..key }
}

/// The keys that are no error term's.
pub(super) fn keys(kind: SensorKind) -> Vec<Key> {
    let length = Takes::Scalar(Kind::LENGTH.signed(Sign::NonNegative));
    let key = |name, takes, default, about| Key { name, takes, default: Some(default), about };
    match kind {
        SensorKind::Gyro | SensorKind::Accel | SensorKind::Mag => vec![],
        SensorKind::Baro => vec![key(
            "sea_level_pressure",
            Takes::Scalar(Kind::PRESSURE.signed(Sign::Positive)),
            "101325 Pa",
            "at altitude 0: the day's weather",
        )],
        SensorKind::Gps => vec![
            key("eph", length, "1 m", "horizontal accuracy that it claims"),
            key("epv", length, "1.5 m", "vertical accuracy that it claims"),
            key("satellites", Takes::Whole(0, 254), "12", "how many it claims to use"),
        ],
    }
}

/// The pressure at altitude 0, Pa.
pub fn sea_level_pressure(values: &Values) -> f64 {
    values.scalar("sea_level_pressure").unwrap_or(SEA_LEVEL_PRESSURE)
}

/// What a receiver says of its own fix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Claims {
    /// Horizontal accuracy, m.
    pub eph: f64,
    /// Vertical accuracy, m.
    pub epv: f64,
    /// Satellites used.
    pub satellites: u8,
}

impl Claims {
    /// Of a plan's values.
    pub fn of(values: &Values) -> Claims {
        Claims {
            eph: values.scalar("eph").unwrap_or_default(),
            epv: values.scalar("epv").unwrap_or_default(),
            satellites: values.whole("satellites").unwrap_or_default() as u8,
        }
    }
}

/// A receiver's reading: where, and how fast.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fix {
    /// As read.
    pub position: Place,
    /// As read, m/s.
    pub velocity: Vector<Nav>,
    /// Where it is.
    pub true_position: Place,
    /// How fast it is, m/s.
    pub true_velocity: Vector<Nav>,
}

/// White noise on the velocity of a fix: a fresh normal number each sample and axis.
pub(super) static VELOCITY_NOISE: TermKind = TermKind {
    name: "velocity_noise",
    about: "a fresh normal number each sample on a receiver's velocity",
    stage: Stage::Reading,
    needs: &[],
    keys: |sensor| match sensor {
        SensorKind::Gps => vec![Key {
            name: "velocity_noise_std",
            takes: Takes::PerAxis(Kind::SPEED.signed(Sign::NonNegative)),
            default: Some("0"),
            about: "standard deviation of each sample of the velocity",
        }],
        _ => vec![],
    },
    build: |values, context| {
        let sigma = values.vector("velocity_noise_std").unwrap_or_default();
        Ok((sigma != DVec3::ZERO).then(|| {
            Box::new(VelocityNoise { sigma, normals: context.normals("velocity_noise", sigma) })
                as Box<dyn Term>
        }))
    },
};

struct VelocityNoise {
    sigma: DVec3,
    normals: Normals,
}

impl Term for VelocityNoise {
    #[inline(always)]
    fn apply(&mut self, block: &mut Block) {
        let (sigma, velocity) = (self.sigma.to_array(), block.velocity.each_mut().map(Vec::as_mut_slice));
        self.normals.zip(velocity, |axis, velocity, normal| *velocity += sigma[axis] * normal);
    }

    fn normals(&self) -> usize {
        self.normals.count()
    }
}
