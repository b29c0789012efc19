//! The cases, and the numbers of each.

use super::trials::{DRIFT_STRIDE, Drive, error_deg, norm_error, refusals, relative_error};
use super::{Case, Effort, Limits, Outcome};
use crate::double::Double;
use crate::geometry::exp;
use crate::motion::method::MethodKind;
use crate::study::motions::{Cone, Gaps, Jitter, Path, Sines, Turn};
use glam::{DQuat, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// Every case.
pub static CASES: [Case; 20] = [
    Case {
        name: "angle-near-pi",
        about: "0.98 pi rad a sample about a fixed axis, 100 steps; largest error, deg",
        limits: Limits::ANGLE,
        trial: |method, limits, _| wide(method, limits, 0.98 * PI),
    },
    Case {
        name: "angle-beyond-pi",
        about: "1.25 pi rad a sample about a fixed axis, 100 steps; largest error, deg",
        limits: Limits::ANGLE,
        trial: |method, limits, _| wide(method, limits, 1.25 * PI),
    },
    Case {
        name: "angle-near-2pi",
        about: "1.98 pi rad a sample about a fixed axis, 100 steps; largest error, deg",
        limits: Limits::ANGLE,
        trial: |method, limits, _| wide(method, limits, 1.98 * PI),
    },
    Case {
        name: "angle-beyond-2pi",
        about: "2.25 pi rad a sample about a fixed axis, 100 steps; largest error, deg",
        limits: Limits::ANGLE,
        trial: |method, limits, _| wide(method, limits, 2.25 * PI),
    },
    Case {
        name: "step-zero",
        about: "dt = 0 must be refused; calls accepted",
        limits: Limits::REFUSAL,
        trial: |method, _, _| refusals(method, &[(DQuat::IDENTITY, 0.0, 0.1)]),
    },
    Case {
        name: "step-negative",
        about: "dt = -0.01 s must be refused; calls accepted",
        limits: Limits::REFUSAL,
        trial: |method, _, _| refusals(method, &[(DQuat::IDENTITY, -0.01, 0.1)]),
    },
    Case {
        name: "step-huge",
        about: "a sample every 1e6 s at 1 rad/s about a fixed axis, 10 steps; largest error, deg",
        limits: Limits::ANGLE,
        trial: |method, limits, _| {
            let path = Turn::new(axis());
            Drive::new(&path, 1e-6, 10).follow::<f64>(method, limits, 1, error_deg)
        },
    },
    Case {
        name: "rate-1e-12",
        about: "1e-12 rad/s at 1 kHz from the identity, 1e5 steps; largest error as a part of the turn",
        limits: Limits::RELATIVE,
        trial: |method, limits, _| {
            let path = Turn::new(axis() * 1e-12);
            Drive::new(&path, 1e3, 100_000).follow::<f64>(method, limits, 1, relative_error)
        },
    },
    Case {
        name: "rate-1e6",
        about: "1e6 rad/s at 1 kHz about a fixed axis, 1000 steps; largest error, deg",
        limits: Limits::ANGLE,
        trial: |method, limits, _| {
            let path = Turn::new(axis() * 1e6);
            Drive::new(&path, 1e3, 1000).follow::<f64>(method, limits, 1, error_deg)
        },
    },
    Case {
        name: "sign-flip",
        about: "q and -q are the same attitude: coning at 1 kHz from both, 10 s; largest difference, deg",
        limits: Limits::ANGLE,
        trial: |method, limits, _| {
            let cone = cone_b();
            let drive = Drive::new(&cone, 1e3, 10_000 / method.input.samples() as u64);
            let start = tilted();
            drive.beside::<f64>(&drive, method, limits, 1, [-start, start], error_deg)
        },
    },
    Case {
        name: "pitch-90",
        about: "starts at a pitch of exactly +-90 deg, 100 deg/s about no main axis, 100 Hz, 10 s; difference from a level start, deg",
        limits: Limits::ANGLE,
        trial: |method, limits, _| poles(method, limits, FRAC_PI_2),
    },
    Case {
        name: "pitch-near-90",
        about: "the same from 1e-12 deg short of +-90 deg; difference from a level start, deg",
        limits: Limits::ANGLE,
        trial: |method, limits, _| poles(method, limits, FRAC_PI_2 - 1e-12f64.to_radians()),
    },
    Case {
        name: "norm-24h",
        about: "200 deg/s at 1 kHz for 24 h, extrapolated from the first 1e7 steps (1e6 with --quick); ||q| - 1|",
        limits: Limits::NORM,
        trial: |method, limits, effort| {
            drift(method, limits, effort, 86_400_000 / method.input.samples() as u64)
        },
    },
    Case {
        name: "norm-1e9-steps",
        about: "200 deg/s at 1 kHz for 1e9 steps, extrapolated from the first 1e7 (1e6 with --quick); ||q| - 1|",
        limits: Limits::NORM,
        trial: |method, limits, effort| drift(method, limits, effort, 1_000_000_000),
    },
    Case {
        name: "f32-hour-norm",
        about: "single precision, motion E at 1 kHz for an hour; ||q| - 1|",
        limits: Limits::NORM,
        trial: |method, limits, effort| single(method, limits, effort, norm_error),
    },
    Case {
        name: "f32-hour-angle",
        about: "single precision, motion E at 1 kHz for an hour; largest difference from double precision, deg",
        limits: Limits::ANGLE,
        trial: |method, limits, effort| single(method, limits, effort, error_deg),
    },
    Case {
        name: "jitter",
        about: "coning at 1 kHz, 10 s, samples taken up to 10 % of a period off; difference from good samples, deg",
        limits: Limits::ANGLE,
        trial: |method, limits, _| {
            let cone = cone_b();
            harmed(method, limits, &Jitter { path: &cone, hz: 1e3 })
        },
    },
    Case {
        name: "missing",
        about: "coning at 1 kHz, 10 s, 1 % of samples lost and the last one used again; difference from good samples, deg",
        limits: Limits::ANGLE,
        trial: |method, limits, _| {
            let cone = cone_b();
            harmed(method, limits, &Gaps { path: &cone, hz: 1e3 })
        },
    },
    Case {
        name: "coning-beyond-nyquist",
        about: "coning of 0.1 deg at 800 Hz sampled at 1 kHz, 20 s; largest error, deg",
        limits: Limits::ANGLE,
        trial: |method, limits, _| {
            let path = Cone::new(Double::from(0.1) * Double::PI_OVER_180, Double::from(800.0));
            let steps = 20_000 / method.input.samples() as u64;
            Drive::new(&path, 1e3, steps).follow::<f64>(method, limits, 1, error_deg)
        },
    },
    Case {
        name: "not-finite",
        about: "NaN and infinite input, step and attitude must each be refused; calls accepted",
        limits: Limits::REFUSAL,
        trial: |method, _, _| {
            let (level, nan) = (DQuat::IDENTITY, DQuat::from_xyzw(0.0, f64::NAN, 0.0, 1.0));
            let infinite = DQuat::from_xyzw(0.0, 0.0, f64::INFINITY, 1.0);
            refusals(
                method,
                &[
                    (level, 0.01, f64::NAN),
                    (level, 0.01, f64::INFINITY),
                    (level, 0.01, f64::NEG_INFINITY),
                    (level, f64::NAN, 0.1),
                    (level, f64::INFINITY, 0.1),
                    (nan, 0.01, 0.1),
                    (infinite, 0.01, 0.1),
                ],
            )
        },
    },
];

/// No main axis, length 1.
fn axis() -> DVec3 {
    DVec3::new(1.0, 2.0, 3.0).normalize()
}

fn tilted() -> DQuat {
    exp(DVec3::new(0.3, -1.2, 0.5))
}

/// Motion B: 1° at 10 Hz.
fn cone_b() -> Cone {
    Cone::new(Double::PI_OVER_180, Double::from(10.0))
}

/// 100 steps of `angle` rad a sample.
fn wide(method: &MethodKind, limits: &Limits, angle: f64) -> Outcome {
    let path = Turn::new(axis() * angle);
    Drive::new(&path, 1.0, 100).follow::<f64>(method, limits, 1, error_deg)
}

/// From `pitch` and from `-pitch`, each beside a level start; the worse.
fn poles(method: &MethodKind, limits: &Limits, pitch: f64) -> Outcome {
    let path = Turn::degrees(100.0, DVec3::new(3.0, 2.0, 1.0));
    let drive = Drive::new(&path, 100.0, 1000 / method.input.samples() as u64);
    let beside = |pitch: f64| {
        drive.beside::<f64>(
            &drive,
            method,
            limits,
            1,
            [exp(DVec3::new(0.0, pitch, 0.0)), DQuat::IDENTITY],
            error_deg,
        )
    };
    let (up, down) = (beside(pitch), beside(-pitch));
    if up.figure < down.figure { down } else { up }
}

fn drift(method: &MethodKind, limits: &Limits, effort: Effort, target: u64) -> Outcome {
    let path = Turn::degrees(200.0, axis());
    let drive = Drive::new(&path, 1e3, effort.drift_steps.min(target));
    Drive { repeats: Some(DRIFT_STRIDE), ..drive }.drift(method, limits, target)
}

/// Looked at every 250 steps. The rate of motion E comes back after 10 s, and with a whole number of any method's
/// steps after 30 s.
fn single(method: &MethodKind, limits: &Limits, effort: Effort, figure: fn(DQuat, DQuat) -> f64) -> Outcome {
    let path = Sines::three_axes();
    let steps = |seconds: u64| seconds * 1000 / method.input.samples() as u64;
    let drive = Drive { repeats: Some(steps(30)), ..Drive::new(&path, 1e3, steps(effort.single_s)) };
    drive.beside::<f32>(&drive, method, limits, 250, [DQuat::IDENTITY; 2], figure)
}

fn harmed(method: &MethodKind, limits: &Limits, path: &dyn Path) -> Outcome {
    let cone = cone_b();
    let steps = 10_000 / method.input.samples() as u64;
    let (harmed, twin) = (Drive::new(path, 1e3, steps), Drive::new(&cone, 1e3, steps));
    harmed.beside::<f64>(&twin, method, limits, 1, [tilted(); 2], error_deg)
}
