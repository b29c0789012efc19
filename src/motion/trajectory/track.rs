//! Velocity and position of the vehicle: the integrals of the acceleration that the accelerometer measures.
//!
//! `v̇ = R·f + g`, `ṗ = v` in nav axes, a level plane that does not turn, for the paths of motions and for external
//! forces. It integrates from one point of a fixed grid to the next, and from the last one to the requested time,
//! with the eight-point Gauss-Legendre panels of a mean. The truth at t is therefore independent of ticks, and
//! errors stay at rounding.

use super::{Push, Segment, Trajectory};
use crate::double::Double;
use crate::geometry::{Euler, Nav, Vector};
use crate::time::SimTime;

/// Step of the grid, ns; seams are points too.
const CELL: i64 = 100_000_000;

/// Velocity (m/s) and displacement from the start (m) at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Course {
    /// Over the ground.
    pub velocity: Vector<Nav>,
    /// From the position at t = 0.
    pub position: Vector<Nav>,
}

impl Course {
    /// The course after `dt` seconds with this mean acceleration, and this mean of acceleration times remaining
    /// time.
    fn after(self, dt: f64, mean: Vector<Nav>, moment: Vector<Nav>) -> Course {
        Course {
            velocity: self.velocity + mean * dt,
            position: self.position + self.velocity * dt + moment * (dt * dt),
        }
    }
}

/// Follows the vehicle: fast for times in order, correct for any.
#[derive(Clone, Copy, Debug)]
pub struct Track {
    edge: SimTime,
    course: Course,
}

/// A motion whose speed differs from the vehicle's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Misfit {
    /// The start of the motion.
    pub start: SimTime,
    /// The velocity that its kind assumes, m/s.
    pub meant: Vector<Nav>,
    /// The vehicle's velocity at its start, m/s.
    pub found: Vector<Nav>,
}

impl Track {
    /// A track from the trajectory's start.
    pub fn new(path: &Trajectory) -> Track {
        Track {
            edge: SimTime::ZERO,
            course: Course { velocity: path.start_velocity(), position: Vector::ZERO },
        }
    }

    /// Velocity and position at `t` (at or after 0).
    pub fn at(&mut self, path: &Trajectory, t: SimTime) -> Course {
        if t < self.edge {
            *self = Track::new(path);
        }
        loop {
            let segment = path.segment(self.edge);
            let cell = SimTime((self.edge.0 / CELL + 1).saturating_mul(CELL));
            let next = path.next_edge(segment, self.edge).min(cell);
            if next > t {
                return path.carried(self.course, segment, self.edge, t);
            }
            self.course = path.carried(self.course, segment, self.edge, next);
            self.edge = next;
        }
    }
}

impl Trajectory {
    /// The same trajectory with this initial velocity over the ground, m/s.
    pub fn begun_at(self, velocity: Vector<Nav>) -> Trajectory {
        Trajectory { velocity: Some(velocity), ..self }
    }

    /// The velocity at t = 0, m/s: the given one, else that of the first motion along the heading; 0 where it turns
    /// on the spot.
    pub fn start_velocity(&self) -> Vector<Nav> {
        let own = || self.segments.first().map_or(Vector::ZERO, Segment::meant_velocity);
        self.velocity.unwrap_or_else(own)
    }

    /// The motions with their own speed at whose start the vehicle's velocity differs by 1 mm/s or more.
    pub fn misfits(&self) -> Vec<Misfit> {
        let mut track = Track::new(self);
        let of = |segment: &Segment| {
            let (start, meant) = (segment.start, segment.meant_velocity());
            let found = track.at(self, start).velocity;
            Some(Misfit { start, meant, found }).filter(|_| (found - meant).length() > 1e-3)
        };
        self.segments.iter().filter(|segment| segment.motion.speed() > 0.0).filter_map(of).collect()
    }

    /// Carries a course from `from` to `to`, between which nothing jumps.
    fn carried(&self, course: Course, segment: &Segment, from: SimTime, to: SimTime) -> Course {
        let (mut mean, mut moment) = (Vector::ZERO, Vector::ZERO);
        if to <= from {
            return course;
        }
        self.nodes(segment, from, to, |since, share, weight| {
            let acceleration = self.acceleration(segment, from, since);
            mean += acceleration * weight;
            moment += acceleration * (weight * (1.0 - share));
        });
        course.after((to - from).seconds(), mean, moment)
    }

    /// `R·f + g`, without the parts that cancel: the path's acceleration and the external forces at time `t`.
    /// `since` is the time of evaluation in seconds from the segment's start.
    fn acceleration(&self, segment: &Segment, t: SimTime, since: Double) -> Vector<Nav> {
        let now = segment.motion.at(segment.attitude, since);
        self.active(t).fold(now.acceleration, |sum, push| {
            sum + match push {
                Push::Body(push) => now.attitude.apply(push),
                Push::Nav(push) => push,
            }
        })
    }
}

impl Segment {
    /// The velocity over the ground that its motion assumes at its start, m/s: its speed, along the heading.
    fn meant_velocity(&self) -> Vector<Nav> {
        let (speed, heading) = (self.motion.speed(), Euler::from_quat(self.attitude.q).yaw);
        Vector::new(libm::cos(heading), libm::sin(heading), 0.0) * speed
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Plan;
    use crate::time::NANOS;
    use std::f64::consts::TAU;

    fn path(scene: &str) -> Trajectory {
        let text = format!("duration = \"600 s\"\n{scene}\n[gyro]\nrate = \"100 Hz\"\n");
        Plan::parse(&text, "s", "s", &[]).unwrap_or_else(|error| panic!("{error}")).trajectory
    }

    fn at(path: &Trajectory, seconds: f64) -> Course {
        Track::new(path).at(path, SimTime((seconds * 1e9) as i64))
    }

    #[test]
    fn at_rest_it_stays_where_it_is_and_a_given_velocity_lasts() {
        let tilted = path("[start]\nattitude = \"[10, 20, 30] deg\"");
        assert_eq!(at(&tilted, 600.0), Course::default());
        let gliding = path("axes = \"enu-flu\"\n[start]\nvelocity = \"[1, 2, 3] m/s\"");
        let found = at(&gliding, 500.0).position - Vector::new(1000.0, 500.0, -1500.0);
        assert!(found.length() < 1e-9, "{found:?}");
    }

    #[test]
    fn a_steady_force_is_half_a_t_squared() {
        let scene = "[start]\nvelocity = \"[3, 0, 0] m/s\"\n[[force]]\nstart = \"1.23456789 s\"\nduration = \"200 s\"\nacceleration = \"[0, 1.5, -0.25] m/s^2\"\nframe = \"nav\"";
        let path = path(scene);
        for t in [0.5, 1.3, 77.7, 201.0, 201.5, 590.0f64] {
            let (begin, long) = (1.234_567_89, 200.0);
            let (during, after) = ((t - begin).clamp(0.0, long), (t - begin - long).max(0.0));
            let share = 0.5 * during * during + during * after;
            let expected = Vector::new(3.0 * t, 1.5 * share, -0.25 * share);
            let found = at(&path, t);
            assert!((found.position - expected).length() < 1e-8 * (1.0 + share), "{t}: {found:?}");
            assert!((found.velocity - Vector::new(3.0, 1.5 * during, -0.25 * during)).length() < 1e-10);
        }
    }

    /// A force fixed in a body that turns at w about the vertical: v = a/w·(sin wt, 1 − cos wt),
    /// p = a/w²·(1 − cos wt, wt − sin wt).
    #[test]
    fn a_force_that_turns_with_the_body_has_its_closed_form() {
        let scene = "[[motion]]\nkind = \"rotate\"\nyaw = \"40 deg/s\"\nduration = \"300 s\"\n[[force]]\nduration = \"300 s\"\nacceleration = \"[2, 0, 0] m/s^2\"";
        let path = path(scene);
        let w = 40f64.to_radians();
        let mut track = Track::new(&path);
        for i in 0..3000 {
            let t = SimTime(i * 99_999_999 + 12_345);
            let (found, wt) = (track.at(&path, t), w * t.seconds());
            let (s, c) = wt.sin_cos();
            let expected = Vector::new(1.0 - c, wt - s, 0.0) * (2.0 / (w * w));
            assert!((found.position - expected).length() < 1e-8, "{t}: {found:?} against {expected:?}");
            assert!((found.velocity - Vector::new(s, 1.0 - c, 0.0) * (2.0 / w)).length() < 1e-10);
        }
    }

    const CIRCLE: &str = "[start]\nattitude = \"[0, 0, 70] deg\"\n[[motion]]\nkind = \"circle\"\nbank = \"25 deg\"\nspeed = \"15 m/s\"\nduration = \"400 s\"\n";

    #[test]
    fn a_circle_returns_to_where_it_was_after_each_turn() {
        let path = path(CIRCLE);
        let turn = TAU * 15.0 / (9.80665 * 25f64.to_radians().tan());
        let radius = 15.0 * turn / TAU;
        let mut track = Track::new(&path);
        let start = track.at(&path, SimTime(10 * NANOS));
        assert!((start.velocity.length() - 15.0).abs() < 1e-12);
        for k in 1..=18 {
            let half = track.at(&path, SimTime(((10.0 + (f64::from(k) - 0.5) * turn) * 1e9).round() as i64));
            let across = (half.position - start.position).length();
            assert!((across - 2.0 * radius).abs() < 1e-6, "turn {k}: {across}");
            let t = SimTime(((10.0 + f64::from(k) * turn) * 1e9).round() as i64);
            // Half a nanosecond of 15 m/s is the rounding of t.
            let (now, late) = (track.at(&path, t), t.seconds() - 10.0 - f64::from(k) * turn);
            let off = (now.position - start.position - start.velocity * late).length();
            assert!(off < 1e-6, "turn {k}: {off} m");
        }
    }

    #[test]
    fn it_is_the_integral_of_what_the_accelerometer_feels() {
        let scene = format!(
            "{CIRCLE}[[motion]]\nkind = \"rock\"\naxis = \"yaw\"\namplitude = \"2 rad/s\"\nfrequency = \"3 Hz\"\nduration = \"5 s\"\n[[force]]\nstart = \"399.5 s\"\nduration = \"3 s\"\nacceleration = \"[1, 2, 3] m/s^2\"\n"
        );
        let path = path(&scene);
        let gravity = path.gravity();
        let (from, to) = (SimTime(398 * NANOS), SimTime(404 * NANOS));
        let mut track = Track::new(&path);
        let (before, after) = (track.at(&path, from), track.at(&path, to));
        // Midpoint sums of R·f + g, seams on step bounds.
        let (mut course, steps) = (before, 600_000);
        let dt = (to - from).seconds() / f64::from(steps);
        for i in 0..steps {
            let truth =
                path.at(SimTime(from.0 + (2 * i64::from(i) + 1) * (to - from).0 / (2 * i64::from(steps))));
            let acceleration = truth.attitude.apply(truth.force) + gravity;
            course = course.after(dt, acceleration, acceleration * 0.5);
        }
        assert!((after.velocity - course.velocity).length() < 1e-7, "{after:?} against {course:?}");
        assert!((after.position - course.position).length() < 1e-6, "{after:?} against {course:?}");
    }

    #[test]
    fn any_order_and_any_ticks_give_the_same_bits() {
        let path = path(CIRCLE);
        let mut track = Track::new(&path);
        let asked: Vec<_> = (0..200).map(|i| SimTime(i * 33_333_333)).collect();
        let forward: Vec<_> = asked.iter().map(|&t| track.at(&path, t)).collect();
        let backward: Vec<_> = asked.iter().rev().map(|&t| track.at(&path, t)).collect();
        assert!(forward.iter().eq(backward.iter().rev()));
        let alone: Vec<_> = asked.iter().map(|&t| Track::new(&path).at(&path, t)).collect();
        assert_eq!(forward, alone);
    }

    #[test]
    fn a_turn_that_is_come_to_at_another_speed_is_found() {
        assert_eq!(path(CIRCLE).misfits(), []);
        let late = format!("[[motion]]\nkind = \"hold\"\nduration = \"5 s\"\n{}", &CIRCLE[36..]);
        let [misfit] = path(&late).misfits()[..] else { panic!("one turn") };
        assert_eq!((misfit.start, misfit.found), (SimTime(5 * NANOS), Vector::ZERO));
        assert!((misfit.meant.length() - 15.0).abs() < 1e-12);
        let given = format!("[start]\nvelocity = \"[15, 0, 0] m/s\"\n{late}");
        assert_eq!(path(&given).misfits(), []);
    }
}
