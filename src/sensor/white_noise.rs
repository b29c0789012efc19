//! White noise: a new normal random number each sample.
//!
//! Its size may be given per sample (`noise_std`, `noise_variance`: the paper), as a one-sided density N
//! (`noise_density`, what part datasheets print: σ = N·√(fs/2)), or as the Allan deviation at 1 s
//! (`angle_random_walk`, `velocity_random_walk`, what Kalibr calls a noise density: σ = N·√fs).
//! `noise_density = √2 · random walk`: a factor that users often miss.

use super::units::{ANGLE_RANDOM_WALK, VELOCITY_RANDOM_WALK};
use super::{Block, Kinds, SensorKind, Stage, Term, TermKind};
use crate::keys::{KeyError, Name, Values};
use crate::quantity::Sign;
use crate::random::Normals;
use crate::time::Rate;
use glam::DVec3;

/// The standard deviation of a sample, per axis, in the reading's unit.
pub const NOISE_STD: Name<DVec3> = Name::new("noise_std");
const NOISE_VARIANCE: Name<DVec3> = Name::new("noise_variance");
/// The one-sided density, per axis, in the reading's unit a √Hz.
pub const NOISE_DENSITY: Name<DVec3> = Name::new("noise_density");

pub(super) static KIND: TermKind = TermKind {
    name: "white_noise",
    about: "a new normal random number each sample",
    serves: Kinds::ALL,
    stage: Stage::Reading,
    needs: &[],
    keys: |sensor| {
        let units = sensor.units();
        let mut keys = vec![
            NOISE_STD.per_axis(
                units.reading.signed(Sign::NonNegative),
                "standard deviation of each sample, at any rate",
            ),
            NOISE_VARIANCE.per_axis(units.variance, "variance of each sample, at any rate (the paper's)"),
            NOISE_DENSITY
                .per_axis(units.density, "one-sided density, as datasheets print it: σ = N·√(rate/2)"),
        ];
        keys.extend(units.random_walk.map(|(name, kind)| {
            name.per_axis(kind, "Allan deviation at 1 s, Kalibr's noise density: σ = N·√rate")
        }));
        keys
    },
    build: |values, context| {
        let sigma = sigma(values, context.sensor, context.rate)?;
        Ok((sigma != DVec3::ZERO).then(|| {
            Box::new(WhiteNoise { sigma, normals: context.normals("white_noise", sigma) }) as Box<dyn Term>
        }))
    },
};

/// The keys of which at most one may be given for an axis.
pub const KEYS: [Name<DVec3>; 5] =
    [NOISE_STD, NOISE_VARIANCE, NOISE_DENSITY, ANGLE_RANDOM_WALK, VELOCITY_RANDOM_WALK];

/// The standard deviation of one sample at the given rate, per axis, in the reading's unit.
///
/// # Errors
/// Two keys for one axis.
pub fn sigma(values: &Values, sensor: SensorKind, rate: Rate) -> Result<DVec3, KeyError> {
    let mut sigma = DVec3::ZERO;
    let mut before: Vec<(Name<DVec3>, DVec3)> = Vec::new();
    for key in KEYS {
        let Some(given) = values.get(key) else { continue };
        // One that is zero throughout says as much of every axis as any other.
        let clash = |other: DVec3| {
            other == DVec3::ZERO || given == DVec3::ZERO || (other * given).abs().max_element() > 0.0
        };
        if let Some((other, _)) = before.iter().find(|(_, other)| clash(*other)) {
            return Err(KeyError::new(
                key,
                format!("the {sensor}'s white noise is already given by `{}`: keep only one", other.name()),
            ));
        }
        before.push((key, given));
        sigma += per_sample(key, given, rate);
    }
    Ok(sigma)
}

fn per_sample(key: Name<DVec3>, given: DVec3, rate: Rate) -> DVec3 {
    match key {
        NOISE_STD => given,
        NOISE_VARIANCE => DVec3::from_array(given.to_array().map(libm::sqrt)),
        NOISE_DENSITY => given * libm::sqrt(rate.as_hz() / 2.0),
        _ => given * libm::sqrt(rate.as_hz()),
    }
}

struct WhiteNoise {
    sigma: DVec3,
    normals: Normals,
}

impl Term for WhiteNoise {
    #[inline(always)]
    fn apply(&mut self, block: &mut Block) {
        let (sigma, readings) = (self.sigma.to_array(), block.reading.each_mut().map(Vec::as_mut_slice));
        self.normals.zip(readings, |axis, reading, normal| *reading += sigma[axis] * normal);
    }

    fn normals(&self) -> usize {
        self.normals.count()
    }
}
