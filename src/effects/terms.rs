//! Sizes of the error terms that a sensor uses, each from its own values.

use super::{EffectKind, Found, Judge, Survey};
use crate::geometry::Vector;
use crate::keys::{Key, Value, Values};
use crate::sensor::{self, TERMS, bias_step, limits, lsb, matrix, white_noise};
use glam::{DMat3, DVec3};

/// Hard iron: its own size.
pub(super) static HARD_IRON: EffectKind = EffectKind {
    name: "hard_iron",
    judge: Judge::Both,
    find: |survey| used(survey, "hard_iron", survey.sensor.values.get(sensor::HARD_IRON)?.abs(), "constant"),
};

/// Scale error, misalignment and cross-coupling, M together: `(M − 1)·signal`, where that is largest.
pub(super) static MATRIX: EffectKind = EffectKind {
    name: "matrix",
    judge: Judge::Both,
    find: |survey| {
        let off = matrix(&survey.sensor.values) - DMat3::IDENTITY;
        let size = survey.largest(|look| off * survey.error_free(look).v);
        used(survey, "matrix", size, "largest")
    },
};

/// Non-linearity n of full scale R: `n·R·(4u³ − 3u)`, u = signal/R, where that is largest.
pub(super) static NONLINEARITY: EffectKind = EffectKind {
    name: "nonlinearity",
    judge: Judge::Both,
    find: |survey| {
        let values = &survey.sensor.values;
        let (bend, range) = (values.get(sensor::NONLINEARITY)?, values.get(sensor::RANGE)?);
        let size = survey.largest(|look| {
            let u = (survey.error_free(look).v / range).clamp(DVec3::NEG_ONE, DVec3::ONE);
            bend * range * (4.0 * u * u * u - 3.0 * u)
        });
        used(survey, "nonlinearity", size, "largest")
    },
};

/// g-sensitivity G of a gyroscope: `G·f`, f the true specific force, where that is largest.
pub(super) static G_SENSITIVITY: EffectKind = EffectKind {
    name: "g_sensitivity",
    judge: Judge::Both,
    find: |survey| {
        let matrix = survey.sensor.values.get(sensor::G_SENSITIVITY)?;
        let size = survey.largest(|look| matrix * look.truth.force.v);
        used(survey, "g_sensitivity", size, "largest")
    },
};

/// Turn-on bias: its own size.
pub(super) static BIAS: EffectKind = EffectKind {
    name: "bias",
    judge: Judge::Both,
    find: |survey| used(survey, "bias", survey.sensor.values.get(sensor::BIAS)?.abs(), "constant"),
};

/// Bias instability, a first-order Gauss-Markov process: σ throughout, or `σ·√(1 − e^(−2T/τ))` at the scene's end
/// where it starts from zero (Gelb, *Applied Optimal Estimation*, 1974, sec. 2.2).
pub(super) static BIAS_INSTABILITY: EffectKind = EffectKind {
    name: "bias_instability",
    judge: Judge::Both,
    find: |survey| {
        let values = &survey.sensor.values;
        let (sigma, tau) = (values.get(sensor::BIAS_INSTABILITY)?, values.get(sensor::CORRELATION_TIME)?);
        if values.get(sensor::BIAS_INSTABILITY_START) != Some("zero") {
            return used(survey, "bias_instability", sigma, "standard deviation");
        }
        let grown = (survey.span() / tau).to_array().map(|x| libm::sqrt(-libm::expm1(-2.0 * x)));
        used(survey, "bias_instability", sigma * DVec3::from_array(grown), "standard deviation at the end")
    },
};

/// Bias walk: n steps of σ are `σ·√n` wide at the last sample, for a rate random walk `K·√T` (IEEE Std 952-1997,
/// annex C).
pub(super) static BIAS_WALK: EffectKind = EffectKind {
    name: "bias_walk",
    judge: Judge::Both,
    find: |survey| {
        let step = bias_step(&survey.sensor.values, &survey.sensor.context(survey.plan.seed));
        let steps = survey.ticks.saturating_sub(1) as f64;
        used(survey, "bias_walk", step * libm::sqrt(steps), "standard deviation at the end")
    },
};

/// White noise: the standard deviation of one sample. It is set against the count alone: noise below half a count
/// mostly rounds away.
pub(super) static WHITE_NOISE: EffectKind = EffectKind {
    name: "white_noise",
    judge: Judge::Resolution,
    find: |survey| {
        let sensor = survey.sensor;
        let sigma = white_noise::sigma(&sensor.values, sensor.kind, sensor.rate).ok()?;
        used(survey, "white_noise", sigma, "standard deviation")
    },
};

/// Range: how far the error-free reading goes beyond the limits, on the chip's axes and brought to the body's.
pub(super) static RANGE: EffectKind = EffectKind {
    name: "range",
    judge: Judge::Both,
    find: |survey| {
        let sensor = survey.sensor;
        let (low, high) = limits(&sensor.values, sensor.kind).ok()??;
        let mount = sensor.mount.unwrap_or_default();
        let cut = survey.largest(|look| {
            let on_chip = mount.to_chip(survey.error_free(look)).v;
            let beyond = on_chip - on_chip.clamp(DVec3::splat(low), DVec3::splat(high));
            mount.to_body(Vector::from_vec(beyond)).v
        });
        used(survey, "range", cut, "largest part cut off")
    },
};

/// Resolution: rounding moves a reading by half a count at most (and by `count/√12` RMS where readings spread over
/// several counts). It is set against the noise alone.
pub(super) static RESOLUTION: EffectKind = EffectKind {
    name: "resolution",
    judge: Judge::Noise,
    find: |survey| {
        let count = lsb(&survey.sensor.values, survey.sensor.kind)?;
        used(survey, "resolution", DVec3::splat(count / 2.0), "half a count")
    },
};

/// A term that the sensor uses; nothing where it does not.
fn used(survey: &Survey<'_>, term: &str, size: DVec3, statistic: &'static str) -> Option<Found> {
    survey.terms.contains(&term).then(|| Found { key: key(survey, term), ..Found::modelled(size, statistic) })
}

/// The key that switches a term on: the first that says anything.
pub(super) fn key(survey: &Survey<'_>, term: &str) -> Option<String> {
    let sensor = survey.sensor;
    let kind = TERMS.into_iter().find(|kind| kind.name == term)?;
    let keys = (kind.keys)(sensor.kind);
    let key = keys.iter().find(|key| says_something(key, &sensor.values))?;
    Some(format!("{}.{}", sensor.kind, key.name))
}

fn says_something(key: &Key, values: &Values) -> bool {
    match values.held(key) {
        None => false,
        Some(Value::Scalar(number)) => number.to_f64() != 0.0,
        Some(Value::Triple(vector)) => vector.iter().any(|number| number.to_f64() != 0.0),
        Some(Value::Flag(flag)) => *flag,
        Some(_) => key.default.is_none(),
    }
}
