//! Methods that step attitude from samples of angular rate or from its integrals: one file for each.
//!
//! A method is a formula over plain numbers: the attitude before the step, the step's length, and the inputs it
//! declares ([`Input`]). It has no clock, no memory and no I/O. [`MethodKind::run`] surrounds every formula with
//! the same checks: it rejects, with the reason, a step that is not positive and finite, a non-finite input or
//! attitude, and a result beyond the range of the precision, so that no NaN ever spreads.
//!
//! Rates and increments are in body axes, rad/s and rad; `q` takes body to nav, so a turn multiplies from the
//! right. No method makes our truth; they exist to be compared with it, see [`study`](crate::study). To add one: a
//! file beside these and a line in [`METHODS`].

mod algebra;
mod choice;
mod coning_2;
mod coning_3;
mod coning_4;
mod crouch_grossman_3;
mod ecompass;
mod euler;
mod exp_average;
mod exp_midpoint;
mod increment_1;
mod legendre;
mod magnus_4;
mod paper;
mod paper_normalised;
mod polynomial_fit;
mod polynomial_fit_4;
mod real;
mod reference;
mod rk4;
mod rkmk_4;

pub use algebra::{Quaternion, Triple};
pub use choice::{Choice, Missed, ToleranceError, choose};
pub use coning_2::Coning2;
pub use coning_3::Coning3;
pub use coning_4::Coning4;
pub use crouch_grossman_3::CrouchGrossman3;
pub use ecompass::{Degenerate, ecompass};
pub use euler::Euler;
pub use exp_average::ExpAverage;
pub use exp_midpoint::ExpMidpoint;
pub use increment_1::Increment1;
pub use magnus_4::Magnus4;
pub use paper::Paper;
pub use paper_normalised::PaperNormalised;
pub use polynomial_fit::PolynomialFit;
pub use polynomial_fit_4::PolynomialFit4;
pub use real::Real;
pub use reference::{ReferenceError, Step, from_accel_mag, integrated, reference};
pub use rk4::Rk4;
pub use rkmk_4::Rkmk4;

use std::fmt;

/// Every method: first those with samples of rate, then those with exact increments, each group by order.
pub static METHODS: [&MethodKind; 15] = [
    &euler::KIND,
    &paper::KIND,
    &paper_normalised::KIND,
    &exp_average::KIND,
    &exp_midpoint::KIND,
    &crouch_grossman_3::KIND,
    &rk4::KIND,
    &rkmk_4::KIND,
    &magnus_4::KIND,
    &increment_1::KIND,
    &coning_2::KIND,
    &coning_3::KIND,
    &coning_4::KIND,
    &polynomial_fit_4::KIND,
    &polynomial_fit::KIND,
];

/// The method with this name.
pub fn find(name: &str) -> Option<&'static MethodKind> {
    METHODS.into_iter().find(|method| method.name == name)
}

/// A formula that advances attitude over one step from `N` inputs.
pub trait Method<const N: usize> {
    /// The attitude after a step of `h` seconds from `q`. All inputs are finite, and `h` is positive.
    fn turn<R: Real>(q: Quaternion<R>, h: R, inputs: &[Triple<R>; N]) -> Quaternion<R>;
}

/// The inputs of one step, in this order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Input {
    /// The angular rate (rad/s) at these fractions of the step, which spans one sample interval.
    Rate(&'static [f64]),
    /// Integrals of the angular rate (rad) over this many sample intervals, which together make one step.
    Increments(usize),
}

impl Input {
    /// The number of vectors that one step reads.
    pub const fn count(self) -> usize {
        match self {
            Input::Rate(fractions) => fractions.len(),
            Input::Increments(count) => count,
        }
    }

    /// The number of a sensor's samples that one step spans.
    pub const fn samples(self) -> usize {
        match self {
            Input::Rate(_) => 1,
            Input::Increments(count) => count,
        }
    }
}

impl fmt::Display for Input {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Input::Rate([at]) => write!(f, "rate at {at} of it"),
            Input::Rate(fractions) => {
                let fractions: Vec<_> =
                    fractions.iter().map(|at| format!("{}", (at * 1e3).round() / 1e3)).collect();
                write!(f, "rates at {} of it", fractions.join(", "))
            }
            Input::Increments(1) => f.write_str("1 increment"),
            Input::Increments(count) => write!(f, "{count} increments"),
        }
    }
}

/// The number type of the computation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// Double, `f64`.
    Double,
    /// Single, `f32`: what a small flight controller has.
    Single,
}

impl Precision {
    /// Its name in `accuracy.csv`.
    pub const fn name(self) -> &'static str {
        match self {
            Precision::Double => f64::NAME,
            Precision::Single => f32::NAME,
        }
    }
}

/// Compared only in double precision.
const DOUBLE: &[Precision] = &[Precision::Double];
/// Also compared in single precision: cheap enough for a processor without doubles.
const BOTH: &[Precision] = &[Precision::Double, Precision::Single];

/// Many steps in one call: attitude, step length, the inputs of consecutive steps.
pub type Run<R> = fn(Quaternion<R>, R, &[Triple<R>]) -> Result<Quaternion<R>, Refused>;

/// A method: its name, its inputs and how to run it.
#[derive(Debug)]
pub struct MethodKind {
    /// Its name in `method = "…"`.
    pub name: &'static str,
    /// One line for `list methods`.
    pub about: &'static str,
    /// The power of the step length with which its error at a fixed time falls, on smooth motion.
    pub order: u32,
    /// The inputs of one step.
    pub input: Input,
    /// The precisions that the accuracy study compares. It runs in either.
    pub precisions: &'static [Precision],
    /// Nanoseconds for a step in double precision, checks included. [`choose`] compares this constant, so that its
    /// choice is the same on every machine. Measured by `study accuracy` for docs/accuracy.md.
    pub ns_per_step: u32,
    double: Run<f64>,
    single: Run<f32>,
}

impl MethodKind {
    const fn of<M: Method<N>, const N: usize>(
        name: &'static str,
        about: &'static str,
        order: u32,
        input: Input,
        precisions: &'static [Precision],
        ns_per_step: u32,
    ) -> MethodKind {
        assert!(input.count() == N);
        MethodKind {
            name,
            about,
            order,
            input,
            precisions,
            ns_per_step,
            double: run::<M, f64, N>,
            single: run::<M, f32, N>,
        }
    }

    /// Steps `q` by `h` seconds repeatedly, each time with the next [`count`](Input::count) of `inputs`. An error
    /// says which step failed, and why.
    pub fn run<R: Real>(
        &self,
        q: Quaternion<R>,
        h: R,
        inputs: &[Triple<R>],
    ) -> Result<Quaternion<R>, Refused> {
        R::runner(self)(q, h, inputs)
    }
}

fn run<M: Method<N>, R: Real, const N: usize>(
    start: Quaternion<R>,
    h: R,
    inputs: &[Triple<R>],
) -> Result<Quaternion<R>, Refused> {
    let (steps, rest) = inputs.as_chunks::<N>();
    let refuse = |step: usize, why| Err(Refused { step: step as u64, why });
    match () {
        () if !rest.is_empty() || steps.is_empty() => return refuse(steps.len(), Why::InputMissing),
        () if !h.is_finite() => return refuse(0, Why::StepNotFinite),
        () if h <= R::of(0.0) => return refuse(0, Why::StepNotPositive),
        () if !start.is_finite() => return refuse(0, Why::AttitudeNotFinite),
        () if start.is_null() => return refuse(0, Why::AttitudeZero),
        () => {}
    }
    let mut q = start;
    for (step, inputs) in steps.iter().enumerate() {
        if !inputs.iter().all(|input| input.is_finite()) {
            return refuse(step, Why::InputNotFinite);
        }
        q = M::turn(q, h, inputs);
        // Renormalising a value whose norm overflows gives a null quaternion.
        if !q.is_finite() || q.is_null() {
            return refuse(step, Why::Overflow);
        }
    }
    Ok(q)
}

/// A failed step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("step {step} refused: {why}")]
pub struct Refused {
    /// The index of the step, from 0; those before it succeeded.
    pub step: u64,
    /// The reason.
    pub why: Why,
}

/// Why a step fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Why {
    /// Zero or negative.
    #[error("the step's length is not above zero")]
    StepNotPositive,
    /// Infinite or NaN.
    #[error("the step's length is not a finite number")]
    StepNotFinite,
    /// A rate or an increment is infinite or NaN.
    #[error("an input is not a finite number")]
    InputNotFinite,
    /// No input, or not a multiple of a step's inputs.
    #[error("the inputs do not make a whole number of steps")]
    InputMissing,
    /// The initial attitude is infinite or NaN.
    #[error("the attitude is not finite")]
    AttitudeNotFinite,
    /// The initial attitude is the null quaternion.
    #[error("the attitude is zero")]
    AttitudeZero,
    /// The inputs are valid, but the result exceeds the largest number of the precision.
    #[error("the result overflows")]
    Overflow,
}

#[cfg(test)]
mod tests;
