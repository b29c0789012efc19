//! White noise: a new normal random number each sample.
//!
//! Its size may be given per sample (`noise_std`, `noise_variance`: the paper), as a one-sided density N
//! (`noise_density`, what part datasheets print: σ = N·√(fs/2)), or as the Allan deviation at 1 s
//! (`angle_random_walk`, `velocity_random_walk`, what Kalibr calls a noise density: σ = N·√fs).
//! `noise_density = √2 · random walk`: a factor that users often miss.

use super::{Block, Kinds, SensorKind, Stage, Term, TermKind};
use crate::keys::{Key, KeyError, Takes, Values};
use crate::quantity::{Kind, Sign};
use crate::random::Normals;
use crate::time::Rate;
use glam::DVec3;

pub(super) static KIND: TermKind = TermKind {
    name: "white_noise",
    about: "a new normal random number each sample",
    serves: Kinds::ALL,
    stage: Stage::Reading,
    needs: &[],
    keys: |sensor| {
        let units = sensor.units();
        let mut keys = vec![
            key(
                "noise_std",
                units.reading.signed(Sign::NonNegative),
                "standard deviation of each sample, at any rate",
            ),
            key("noise_variance", units.variance, "variance of each sample, at any rate (the paper's)"),
            key("noise_density", units.density, "one-sided density, as datasheets print it: σ = N·√(rate/2)"),
        ];
        if let Some((name, kind)) = units.random_walk {
            keys.push(key(name, kind, "Allan deviation at 1 s, Kalibr's noise density: σ = N·√rate"));
        }
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
pub const KEYS: [&str; 5] =
    ["noise_std", "noise_variance", "noise_density", "angle_random_walk", "velocity_random_walk"];

fn key(name: &'static str, kind: Kind, about: &'static str) -> Key {
    Key { name, takes: Takes::PerAxis(kind), default: None, about }
}

/// The standard deviation of one sample at the given rate, per axis, in the reading's unit.
///
/// # Errors
/// Two keys for one axis.
pub fn sigma(values: &Values, sensor: SensorKind, rate: Rate) -> Result<DVec3, KeyError> {
    let mut sigma = DVec3::ZERO;
    let mut before: Vec<(&str, DVec3)> = Vec::new();
    for key in KEYS {
        let Some(given) = values.vector(key) else { continue };
        // One that is zero throughout says as much of every axis as any other.
        let clash = |other: DVec3| {
            other == DVec3::ZERO || given == DVec3::ZERO || (other * given).abs().max_element() > 0.0
        };
        if let Some((other, _)) = before.iter().find(|(_, other)| clash(*other)) {
            return Err(KeyError::new(
                key,
                format!("the {sensor}'s white noise is already given by `{other}`: keep only one"),
            ));
        }
        before.push((key, given));
        sigma += per_sample(key, given, rate);
    }
    Ok(sigma)
}

fn per_sample(key: &str, given: DVec3, rate: Rate) -> DVec3 {
    match key {
        "noise_std" => given,
        "noise_variance" => DVec3::from_array(given.to_array().map(libm::sqrt)),
        "noise_density" => given * libm::sqrt(rate.as_hz() / 2.0),
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
