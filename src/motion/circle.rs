//! A coordinated turn: steady angular rate and the bank whose lift makes the centripetal force.
//!
//! At bank φ and speed V the heading turns at `g·tan φ / V`. The bank grows linearly over `entry`, holds, and goes
//! back over the last `entry`. The heading then also has a closed form: `−g·T/(V·φ₀) · ln cos(φ₀·t/T)`. With `entry
//! = "0 s"` nothing rolls: the vehicle already flies the turn, at its present attitude.

use super::{Context, Kinematics, Motion, MotionKind};
use crate::double::Double;
use crate::geometry::{Attitude, Euler, Nav, Vector, exp};
use crate::keys::{KeyError, Name, Values};
use crate::quantity::{Kind, Sign, text_scalar};
use crate::time::SimTime;
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

const BANK: Name<f64> = Name::new("bank");
const SPEED: Name<f64> = Name::new("speed");
const ENTRY: Name<SimTime> = Name::new("entry");

pub(super) static KIND: MotionKind = MotionKind {
    name: "circle",
    about: "a coordinated turn, to the right for a positive bank",
    keys: &[
        BANK.scalar(Kind::ANGLE, "the steady bank, between -90 and 90 deg"),
        SPEED.scalar(Kind::SPEED.signed(Sign::Positive), "along the path"),
        ENTRY.duration("how long it takes to roll in, and to roll out").or("2 s"),
    ],
    has_length: false,
    build,
};

#[derive(Debug)]
struct Circle {
    bank: f64,
    /// m/s.
    speed: f64,
    entry: SimTime,
    duration: SimTime,
    /// m/s².
    gravity: f64,
}

fn build(values: &Values, context: &Context) -> Result<Box<dyn Motion>, KeyError> {
    let (Some(bank), Some(speed)) = (values.get(BANK), values.get(SPEED)) else {
        return Err(KeyError::new(
            "kind",
            "`circle` needs both `bank`, such as \"25 deg\", and `speed`, such as \"15 m/s\"",
        ));
    };
    let entry = values.get(ENTRY).unwrap_or_default();
    if bank.abs() >= FRAC_PI_2 {
        let given = text_scalar(bank, "deg");
        return Err(KeyError::new(
            BANK,
            format!("a coordinated turn has a bank between -90 and 90 deg, not {given}"),
        ));
    }
    if entry + entry > context.duration {
        let message = format!(
            "rolling in and out takes {entry} each, which does not fit in the motion's {}",
            context.duration
        );
        return Err(KeyError::new(ENTRY, message));
    }
    Ok(Box::new(Circle { bank, speed, entry, duration: context.duration, gravity: context.gravity }))
}

impl Circle {
    /// Bank and heading since the start, each with its rate: (bank, bank rate, heading, heading rate), rad and
    /// rad/s; `t` in s.
    fn path(&self, t: f64) -> (f64, f64, f64, f64) {
        let (entry, duration) = (self.entry.seconds(), self.duration.seconds());
        let rate = |bank: f64| self.gravity * libm::tan(bank) / self.speed;
        let (roll_rate, entry_heading) = if entry > 0.0 && self.bank != 0.0 {
            (self.bank / entry, self.rolled_heading(self.bank))
        } else {
            (0.0, 0.0)
        };
        let out = duration - entry;
        if t < entry {
            let bank = roll_rate * t;
            (bank, roll_rate, self.rolled_heading(bank), rate(bank))
        } else if t < out || entry == 0.0 {
            let bank = if entry > 0.0 { self.bank } else { 0.0 };
            (bank, 0.0, entry_heading + rate(self.bank) * (t - entry), rate(self.bank))
        } else {
            let bank = roll_rate * (duration - t);
            let steady = rate(self.bank) * (out - entry);
            let heading = 2.0 * entry_heading + steady - self.rolled_heading(bank);
            (bank, -roll_rate, heading, rate(bank))
        }
    }

    /// The heading change while the bank grows linearly from 0 to `bank`.
    fn rolled_heading(&self, bank: f64) -> f64 {
        if self.bank == 0.0 {
            return 0.0;
        }
        // ln cos x = ½·ln(1 − sin² x), which keeps its precision for a small bank.
        let sine = libm::sin(bank);
        -self.gravity * self.entry.seconds() / (self.speed * self.bank) * 0.5 * libm::log1p(-sine * sine)
    }
}

impl Motion for Circle {
    fn at(&self, start: Attitude, t: Double) -> Kinematics {
        let (bank, bank_rate, heading, heading_rate) = self.path(t.to_f64());
        let course = Euler::from_quat(start.q).yaw;
        let (sine, cosine) = (libm::sin(course + heading), libm::cos(course + heading));
        // In nav axes: roll about the initial course, then turn about the vertical.
        let rolled = exp(DVec3::new(libm::cos(course), libm::sin(course), 0.0) * bank);
        let attitude = Attitude::from_quat(exp(DVec3::Z * heading) * rolled * start.q);
        let turning = Vector::<Nav>::new(bank_rate * cosine, bank_rate * sine, heading_rate);
        Kinematics {
            attitude,
            rate: attitude.inverse().apply(turning),
            acceleration: Vector::new(-sine, cosine, 0.0) * (self.speed * heading_rate),
        }
    }

    fn fastest(&self) -> f64 {
        let entry = self.entry.seconds();
        let (_, _, _, turning) = self.path(entry);
        let rolling = if entry > 0.0 { self.bank / entry } else { 0.0 };
        turning.abs().max(rolling.abs())
    }

    fn next_seam(&self, t: SimTime) -> Option<SimTime> {
        [self.entry, self.duration - self.entry].into_iter().find(|&seam| seam > t)
    }

    fn speed(&self) -> f64 {
        self.speed
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::tests::rate_is_the_derivative_of_attitude;
    use super::*;
    use crate::time::NANOS;

    /// A motion, the times of its seams, and its length.
    pub(in crate::motion) fn example() -> (Box<dyn Motion>, Vec<SimTime>, SimTime) {
        let seams = vec![SimTime(2 * NANOS), SimTime(18 * NANOS)];
        (Box::new(circle(25.0, 2.0)), seams, SimTime(20 * NANOS))
    }

    fn circle(bank_deg: f64, entry: f64) -> Circle {
        let (entry, duration) = (SimTime((entry * NANOS as f64) as i64), SimTime(20 * NANOS));
        Circle { bank: bank_deg.to_radians(), speed: 15.0, entry, duration, gravity: 9.80665 }
    }

    #[test]
    fn its_rate_is_the_derivative_of_its_attitude() {
        for start in [DVec3::ZERO, DVec3::new(0.3, -0.7, 1.1)] {
            let start = Attitude::from_quat(exp(start));
            for motion in [circle(25.0, 2.0), circle(-60.0, 10.0), circle(25.0, 0.0), circle(0.0, 2.0)] {
                rate_is_the_derivative_of_attitude(&motion, start, SimTime(20 * NANOS));
            }
        }
    }

    #[test]
    fn lift_alone_carries_the_turn() {
        let motion = circle(25.0, 2.0);
        let start = Attitude::from_quat(Euler { roll: 0.0, pitch: 0.0, yaw: 0.8 }.to_quat());
        for ms in (0..20_000).step_by(97) {
            let now = motion.at(start, SimTime(ms * 1_000_000).exact_seconds());
            let force = now.attitude.inverse().apply(now.acceleration - Vector::new(0.0, 0.0, 9.80665));
            let bank = Euler::from_quat(now.attitude.q).roll;
            assert!(
                force.v.x.abs() < 1e-12 && force.v.y.abs() < 1e-12,
                "no side force at {ms} ms: {force:?}"
            );
            assert!((force.v.z + 9.80665 / libm::cos(bank)).abs() < 1e-12);
        }
    }

    #[test]
    fn a_positive_bank_turns_right_at_g_tan_bank_over_speed() {
        let motion = circle(25.0, 2.0);
        let (mid, later) = (Double::from(10.0), Double::from(11.0));
        let yaw = |t| Euler::from_quat(motion.at(Attitude::IDENTITY, t).attitude.q).yaw;
        let expected = 9.80665 * libm::tan(25f64.to_radians()) / 15.0;
        assert!((yaw(later) - yaw(mid) - expected).abs() < 1e-12);
        let end = motion.at(Attitude::IDENTITY, Double::from(20.0));
        assert!(Euler::from_quat(end.attitude.q).roll.abs() < 1e-12, "it has rolled out level");
    }
}
