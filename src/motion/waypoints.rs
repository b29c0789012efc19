//! Attitudes at given times, with a smooth turn about one axis from each to the next.
//!
//! Over an interval of length T from q₀ to q₁, with u = t/T and r = log(q₀* ⊗ q₁): `q = q₀ ⊗ exp(s(u)·r)`, `w =
//! s′(u)/T·r`, `s(u) = 10u³ − 15u⁴ + 6u⁵`: the minimum-jerk course from rest to rest (T. Flash and N. Hogan, *The
//! coordination of arm movements*, J. Neuroscience 5(7), 1985). Attitude, rate and angular acceleration are
//! continuous throughout, the last two 0 at each key: it comes to rest there, like a rate table. Each turn goes the
//! shorter way.

use super::{Built, Context, Kinematics, Motion, MotionKind};
use crate::double::Double;
use crate::geometry::{Attitude, Vector, exp, log};
use crate::keys::{KeyError, Name, Values};
use crate::time::SimTime;
use glam::{DQuat, DVec3};

const KEYS: Name<[(SimTime, Attitude)]> = Name::new("keys");

pub(super) static KIND: MotionKind = MotionKind {
    name: "waypoints",
    about: "turns smoothly from attitude to attitude, at rest at each",
    keys: &[KEYS.keyframes("each a time `t` since the motion's start and an `attitude` or a `quaternion`")],
    has_length: false,
    build,
};

/// From the attitude at one key to that at the next.
#[derive(Clone, Copy, Debug)]
struct Leg {
    start: SimTime,
    end: SimTime,
    /// Body to nav at its start.
    from: DQuat,
    /// The rotation vector to its end, rad in body axes.
    turn: DVec3,
}

#[derive(Debug)]
struct Waypoints {
    legs: Vec<Leg>,
}

fn build(values: &Values, context: &Context) -> Built {
    let keys = values.get(KEYS).unwrap_or_default();
    let Some((last, _)) = keys.last() else {
        return Err(KeyError::new(
            "kind",
            "`waypoints` needs `keys`, such as keys = [{ t = \"2 s\", attitude = \"[0, 30, 0] deg\" }]",
        ));
    };
    if *last > context.duration {
        let message = format!("the last is at {last}, but the motion ends at {}", context.duration);
        return Err(KeyError::new(KEYS, message));
    }
    if let Some(pair) = keys.windows(2).find(|pair| pair[1].0 <= pair[0].0) {
        let message = format!("{} comes after {}: write them in time order", pair[1].0, pair[0].0);
        return Err(KeyError::new(KEYS, message));
    }
    if keys[0].0 == SimTime::ZERO && keys[0].1.angle_to(context.start) > AGREE {
        let message = "the one at 0 s is not the vehicle's attitude when the motion starts: leave it out, or add a key for the turn to it";
        return Err(KeyError::new(KEYS, message));
    }
    Ok(Box::new(Waypoints::new(context.start, keys)))
}

/// A first key at 0 s that is closer than this (rad) to the vehicle's attitude counts as equal.
const AGREE: f64 = 1e-9;

impl Waypoints {
    /// A course from `start` at 0 s; a key at 0 s adds nothing.
    fn new(start: Attitude, keys: &[(SimTime, Attitude)]) -> Waypoints {
        let mut legs = Vec::with_capacity(keys.len());
        let mut here = (SimTime::ZERO, start.q);
        for &(end, key) in keys.iter().filter(|(t, _)| *t > SimTime::ZERO) {
            let (start, from) = here;
            legs.push(Leg { start, end, from, turn: log(from.conjugate() * key.q) });
            // Choose the sign of the key that the turn leads to: the sign is continuous in time.
            here = (end, if from.dot(key.q) < 0.0 { -key.q } else { key.q });
        }
        if legs.is_empty() {
            legs.push(Leg { start: SimTime::ZERO, end: SimTime(1), from: start.q, turn: DVec3::ZERO });
        }
        Waypoints { legs }
    }
}

impl Motion for Waypoints {
    fn at(&self, _: Attitude, t: Double) -> Kinematics {
        let after = self.legs.partition_point(|leg| leg.start.seconds() <= t.to_f64());
        let leg = self.legs[after.saturating_sub(1)];
        let length = (leg.end - leg.start).seconds();
        let u = ((t - leg.start.exact_seconds()).to_f64() / length).clamp(0.0, 1.0);
        let share = u * u * u * (10.0 + u * (6.0 * u - 15.0));
        let speed = 30.0 * u * u * (1.0 - u) * (1.0 - u) / length;
        Kinematics {
            attitude: Attitude::from_quat(leg.from * exp(leg.turn * share)),
            rate: Vector::from_vec(leg.turn * speed),
            acceleration: Vector::ZERO,
        }
    }

    fn fastest(&self) -> f64 {
        // s′ is at most 15/8; it changes over a fraction of the leg.
        let of = |leg: &Leg| (1.875 * leg.turn.length() + 6.0) / (leg.end - leg.start).seconds();
        self.legs.iter().map(of).fold(0.0, f64::max)
    }

    fn next_seam(&self, t: SimTime) -> Option<SimTime> {
        let next = self.legs.partition_point(|leg| leg.end <= t);
        self.legs.get(next).map(|leg| leg.end)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::tests::rate_is_the_derivative_of_attitude;
    use super::*;
    use crate::time::NANOS;

    fn keys() -> Vec<(SimTime, Attitude)> {
        let at = |ms: i64, v: [f64; 3]| {
            (SimTime(ms * NANOS / 1000), Attitude::from_quat(exp(DVec3::from_array(v))))
        };
        // One key is more than half a turn after the previous one, and one returns to an earlier attitude.
        vec![
            at(500, [0.3, 0.0, 0.0]),
            at(1700, [0.3, -0.7, 2.5]),
            at(2000, [-0.2, 0.1, -1.5]),
            at(3000, [-0.2, 0.1, -1.5]),
        ]
    }

    /// A motion, the times of its seams, and its length.
    pub(in crate::motion) fn example() -> (Box<dyn Motion>, Vec<SimTime>, SimTime) {
        let seams = keys().iter().map(|(t, _)| *t).collect();
        (Box::new(Waypoints::new(Attitude::IDENTITY, &keys())), seams, SimTime(4 * NANOS))
    }

    #[test]
    fn its_rate_is_the_derivative_of_its_attitude() {
        let start = Attitude::from_quat(exp(DVec3::new(0.3, -0.7, 1.1)));
        let motion = Waypoints::new(start, &keys());
        rate_is_the_derivative_of_attitude(&motion, start, SimTime(4 * NANOS));
    }

    #[test]
    fn it_is_at_each_key_in_time_at_rest_and_holds_after_the_last() {
        let start = Attitude::from_quat(exp(DVec3::new(0.3, -0.7, 1.1)));
        let motion = Waypoints::new(start, &keys());
        assert_eq!(motion.at(start, Double::ZERO).attitude, start);
        for (t, key) in keys() {
            for (ns, near) in [(t.0 - 1, 1e-12), (t.0, 1e-12), (t.0 + 1, 1e-12)] {
                let now = motion.at(start, SimTime(ns).exact_seconds());
                assert!(now.attitude.angle_to(key) < near, "at {ns} ns");
                assert!(now.rate.length() < 1e-12, "at {ns} ns: {:?}", now.rate);
            }
        }
        let end = motion.at(start, Double::from(100.0));
        assert!(end.attitude.angle_to(keys()[3].1) < 1e-15 && end.rate.length() == 0.0);
    }

    #[test]
    fn its_sign_is_continuous_in_time() {
        let motion = Waypoints::new(Attitude::IDENTITY, &keys());
        let mut last = DQuat::IDENTITY;
        for ms in 0..4000 {
            let q = motion.at(Attitude::IDENTITY, SimTime(ms * NANOS / 1000).exact_seconds()).attitude.q;
            assert!((q - last).length() < 0.02, "at {ms} ms");
            last = q;
        }
    }

    #[test]
    fn one_key_at_the_start_is_standing_still() {
        let motion = Waypoints::new(Attitude::IDENTITY, &[(SimTime::ZERO, Attitude::IDENTITY)]);
        let later = motion.at(Attitude::IDENTITY, Double::from(3.0));
        assert_eq!((later.attitude, later.rate), (Attitude::IDENTITY, Vector::ZERO));
    }
}
