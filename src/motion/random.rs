//! Random angular rate within a band: each axis is a sum of sines with random frequencies and phases.
//!
//! `w_i(t) = σ·√(2/N)·Σ sin(2π·f_k·t + p_k)`, k = 1 … N: the band [0, B] is cut into N equal slices, f_k is uniform
//! in the k-th slice and p_k in a turn (S. O. Rice, *Mathematical analysis of random noise*, 1944, sec. 1.7; the
//! slices after M. Shinozuka and C.-M. Jan, *Digital simulation of random processes*, 1972). The root mean square
//! is σ, nothing is above B, and the distribution is nearly normal. The attitude has no closed form.

use super::integrated::{BodyRate, Integrated};
use super::{Built, Context, MotionKind};
use crate::keys::{KeyError, Name, Values};
use crate::quantity::{Kind, Sign};
use crate::random::{self, Stream};
use crate::time::SimTime;
use glam::DVec3;
use rand::RngExt;
use std::f64::consts::TAU;

const AMPLITUDE: Name<DVec3> = Name::new("amplitude");
const BANDWIDTH: Name<f64> = Name::new("bandwidth");

pub(super) static KIND: MotionKind = MotionKind {
    name: "random",
    about: "a random angular rate within a band, repeatable by seed",
    keys: &[
        AMPLITUDE
            .per_axis(Kind::ANGULAR_RATE.signed(Sign::NonNegative), "root mean square of the angular rate"),
        BANDWIDTH.scalar(Kind::FREQUENCY.signed(Sign::Positive), "the highest frequency in it"),
    ],
    has_length: false,
    build,
};

/// Sines on each axis.
const SINES: usize = 24;

#[derive(Debug)]
struct Sum {
    /// Amplitude of one sine on each axis, rad/s.
    amplitude: [f64; 3],
    /// (angular frequency in rad/s, phase in rad) on each axis.
    sines: [[(f64, f64); SINES]; 3],
}

fn build(values: &Values, context: &Context) -> Built {
    let (Some(amplitude), Some(bandwidth)) = (values.get(AMPLITUDE), values.get(BANDWIDTH)) else {
        return Err(KeyError::new(
            "kind",
            "`random` needs both `amplitude`, such as \"20 deg/s\", and `bandwidth`, such as \"2 Hz\"",
        ));
    };
    let name = format!("motion/{}/random", context.index);
    let sum = Sum::new(amplitude, bandwidth, random::axes(context.seed, &name));
    // A missing duration is a separate error, so check only the keys.
    let known = Some(context.duration).filter(|&duration| duration < SimTime::FOREVER);
    match Integrated::new(sum, &[0.0, known.unwrap_or_default().seconds()]) {
        Some(motion) => Ok(Box::new(motion)),
        None => Err(KeyError::new(
            BANDWIDTH,
            "with this duration it is too high to solve exactly: shorten the motion or lower the bandwidth",
        )),
    }
}

impl Sum {
    /// A sum with this root mean square (rad/s) up to `bandwidth` (Hz).
    fn new(rms: DVec3, bandwidth: f64, streams: [Stream; 3]) -> Sum {
        let slice = TAU * bandwidth / SINES as f64;
        let sines = streams.map(|mut stream| {
            std::array::from_fn(|k| {
                (slice * (k as f64 + stream.random::<f64>()), TAU * stream.random::<f64>())
            })
        });
        Sum { amplitude: (rms * libm::sqrt(2.0 / SINES as f64)).to_array(), sines }
    }
}

impl BodyRate for Sum {
    fn at(&self, t: f64) -> DVec3 {
        let axis = |i: usize| {
            let sum: f64 = self.sines[i].iter().map(|(w, phase)| libm::sin(w * t + phase)).sum();
            self.amplitude[i] * sum
        };
        DVec3::new(axis(0), axis(1), axis(2))
    }

    fn fastest(&self) -> f64 {
        let highest = self.sines.iter().flatten().fold(0.0, |fastest: f64, (w, _)| fastest.max(*w));
        // It rarely turns faster than four times its root mean square.
        let rms = DVec3::from_array(self.amplitude).length() * libm::sqrt(SINES as f64 / 2.0);
        highest.max(4.0 * rms)
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::rate_is_the_derivative_of_attitude;
    use super::*;
    use crate::geometry::{Attitude, exp};
    use crate::time::NANOS;

    fn sum(seed: u64, name: &str) -> Sum {
        Sum::new(DVec3::new(0.5, 0.3, 1.0), 2.0, random::axes(seed, name))
    }

    #[test]
    fn its_rate_is_the_derivative_of_its_attitude() {
        let motion = Integrated::new(sum(1, "motion/0/random"), &[0.0, 10.0]).expect("it is smooth");
        let start = Attitude::from_quat(exp(DVec3::new(0.3, -0.7, 1.1)));
        rate_is_the_derivative_of_attitude(&motion, start, SimTime(10 * NANOS));
    }

    #[test]
    fn over_many_seeds_the_mean_is_zero_and_the_rms_the_amplitude() {
        let rms = [0.5, 0.3, 1.0];
        let n = 4000;
        let (mut mean, mut square) = ([0.0; 3], [0.0; 3]);
        for seed in 0..n {
            let w = sum(seed, "motion/0/random").at(0.7);
            for i in 0..3 {
                mean[i] += w[i] / rms[i] / n as f64;
                square[i] += w[i] * w[i] / (rms[i] * rms[i]) / n as f64;
            }
        }
        // Four standard errors of a mean and of a mean square of n nearly normal numbers.
        let error = 1.0 / (n as f64).sqrt();
        for i in 0..3 {
            assert!(mean[i].abs() < 4.0 * error, "mean {}", mean[i]);
            assert!((square[i] - 1.0).abs() < 4.0 * error * 2f64.sqrt(), "mean square {}", square[i]);
        }
    }

    #[test]
    fn no_sine_is_above_the_bandwidth_and_each_slice_has_one() {
        for axis in sum(3, "motion/0/random").sines {
            for (k, (w, _)) in axis.iter().enumerate() {
                let slice = w / TAU / 2.0 * SINES as f64;
                assert!((k as f64..k as f64 + 1.0).contains(&slice), "{slice} is not in slice {k}");
            }
        }
    }

    #[test]
    fn the_same_seed_and_segment_repeat_and_others_do_not() {
        let at = |seed, name| sum(seed, name).at(1.0);
        assert_eq!(at(1, "motion/0/random"), at(1, "motion/0/random"));
        assert_ne!(at(1, "motion/0/random"), at(2, "motion/0/random"));
        assert_ne!(at(1, "motion/0/random"), at(1, "motion/1/random"));
    }
}
