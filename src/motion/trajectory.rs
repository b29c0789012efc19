//! The whole truth of a scene: a sequence of segments, forces over them, gravity and field.

mod columns;
mod track;
mod turning;

pub use columns::{TruthColumns, Wants};
pub use track::{Course, Misfit, Track};

use super::{Kinematics, Motion, rest};
use crate::double::Double;
use crate::geometry::{Attitude, Body, Nav, Rotation, Vector};
use crate::time::SimTime;

/// The truth at one instant.
#[derive(Clone, Copy, Debug)]
pub struct Truth {
    /// The time.
    pub t: SimTime,
    /// Body to nav.
    pub attitude: Attitude,
    /// Angular rate of body relative to nav, rad/s.
    pub rate: Vector<Body>,
    /// Specific force `C_bn·(a_n − g_n)` plus the scene's external forces, m/s².
    pub force: Vector<Body>,
    /// Magnetic field, µT.
    pub field: Vector<Body>,
}

/// An external acceleration over `[start, end)`: the paper's `A_ex`. Overlapping ones add.
#[derive(Clone, Copy, Debug)]
pub struct Force {
    /// Its start.
    pub start: SimTime,
    /// Its end.
    pub end: SimTime,
    /// The acceleration it adds.
    pub push: Push,
}

/// An acceleration in the frame it is fixed in, m/s².
#[derive(Clone, Copy, Debug)]
pub enum Push {
    /// It turns with the vehicle.
    Body(Vector<Body>),
    /// It keeps its direction over the ground.
    Nav(Vector<Nav>),
}

#[derive(Debug)]
struct Segment {
    start: SimTime,
    end: SimTime,
    attitude: Attitude,
    motion: Box<dyn Motion>,
}

impl Segment {
    /// The times within it where the motion may jump.
    fn seams(&self) -> impl Iterator<Item = SimTime> {
        let next = |t: &SimTime| self.motion.next_seam(*t).filter(|&seam| self.start + seam < self.end);
        std::iter::successors(next(&SimTime::ZERO), next).map(|seam| self.start + seam)
    }
}

/// Attitude, rate, force and field at any time.
#[derive(Debug)]
pub struct Trajectory {
    segments: Vec<Segment>,
    forces: Vec<Force>,
    gravity: Vector<Nav>,
    field: Vector<Nav>,
    /// Of the air over the ground, m/s.
    wind: Vector<Nav>,
    /// At t = 0, if given.
    velocity: Option<Vector<Nav>>,
}

impl Trajectory {
    /// Starts at `attitude` and plays each of `motions` for its time; after the last one the vehicle holds.
    /// `gravity` is the acceleration of free fall (m/s²), `field` the magnetic field (µT).
    pub fn new(
        attitude: Attitude,
        motions: Vec<(SimTime, Box<dyn Motion>)>,
        forces: Vec<Force>,
        gravity: Vector<Nav>,
        field: Vector<Nav>,
    ) -> Trajectory {
        let mut next = (SimTime::ZERO, attitude);
        let mut segments = Vec::with_capacity(motions.len() + 1);
        for (duration, motion) in motions.into_iter().filter(|(duration, _)| *duration > SimTime::ZERO) {
            let (start, attitude) = next;
            next = (start + duration, motion.at(attitude, duration.exact_seconds()).attitude);
            segments.push(Segment { start, end: next.0, attitude, motion });
        }
        let (start, attitude) = next;
        segments.push(Segment { start, end: SimTime::FOREVER, attitude, motion: rest() });
        Trajectory { segments, forces, gravity, field, wind: Vector::ZERO, velocity: None }
    }

    /// The same in air that moves over the ground at `wind`, m/s.
    pub fn in_wind(self, wind: Vector<Nav>) -> Trajectory {
        Trajectory { wind, ..self }
    }

    /// The velocity of the air over the ground, m/s, the same everywhere.
    pub fn wind(&self) -> Vector<Nav> {
        self.wind
    }

    /// The sum of the motions' durations: after it the vehicle holds.
    pub fn moving_until(&self) -> SimTime {
        self.segments.last().map_or(SimTime::ZERO, |last| last.start)
    }

    /// A bound on how fast anything changes in any of the motions, rad/s.
    pub fn fastest(&self) -> f64 {
        self.segments.iter().map(|segment| segment.motion.fastest()).fold(0.0, f64::max)
    }

    /// When each motion begins, in order.
    pub fn starts(&self) -> impl Iterator<Item = SimTime> + '_ {
        let moving = self.segments.len() - 1;
        self.segments.iter().take(moving).map(|segment| segment.start)
    }

    /// The acceleration of free fall, m/s².
    pub fn gravity(&self) -> Vector<Nav> {
        self.gravity
    }

    /// The magnetic field, µT.
    pub fn field(&self) -> Vector<Nav> {
        self.field
    }

    /// The times at which something may jump, such as the start or end of a segment or force, in no order.
    pub fn edges(&self) -> impl Iterator<Item = SimTime> + '_ {
        let starts = self.segments.iter().map(|segment| segment.start);
        let within = self.segments.iter().flat_map(Segment::seams);
        starts.chain(within).chain(self.forces.iter().flat_map(|force| [force.start, force.end]))
    }

    /// Attitude, angular rate and the path's acceleration at `t`, without gravity and external forces.
    pub fn kinematics(&self, t: SimTime) -> Kinematics {
        let segment = self.segment(t);
        segment.motion.at(segment.attitude, (t - segment.start).exact_seconds())
    }

    /// The external forces, in the scene's order.
    pub fn forces(&self) -> &[Force] {
        &self.forces
    }

    /// The sum of the external forces' accelerations at `t`, m/s².
    pub fn external(&self, t: SimTime) -> Vector<Body> {
        let to_body = self.kinematics(t).attitude.inverse();
        self.pushes(t, to_body).fold(Vector::ZERO, |sum, push| sum + push)
    }

    /// The greatest speed over the ground in `[0, end)`, m/s.
    pub fn speed(&self, end: SimTime) -> f64 {
        let flown = self.segments.iter().filter(|segment| segment.start < end);
        flown.map(|segment| segment.motion.speed()).fold(0.0, f64::max)
    }

    /// The truth at `t` (at or after 0).
    pub fn at(&self, t: SimTime) -> Truth {
        let segment = self.segment(t);
        self.in_segment(segment, t, (t - segment.start).exact_seconds())
    }

    fn segment(&self, t: SimTime) -> &Segment {
        let index = self.segments.partition_point(|segment| segment.end <= t);
        &self.segments[index.min(self.segments.len() - 1)]
    }

    /// `since` is `t` in seconds from the segment's start, where that is finer than a nanosecond.
    fn in_segment(&self, segment: &Segment, t: SimTime, since: Double) -> Truth {
        self.felt(t, segment.motion.at(segment.attitude, since))
    }

    /// Adds what a vehicle with this motion feels.
    fn felt(&self, t: SimTime, Kinematics { attitude, rate, acceleration }: Kinematics) -> Truth {
        let to_body = attitude.inverse();
        let mut force = to_body.apply(acceleration - self.gravity);
        self.pushes(t, to_body).for_each(|push| force += push);
        Truth { t, attitude, rate, force, field: to_body.apply(self.field) }
    }

    fn pushes(&self, t: SimTime, to_body: Rotation<Nav, Body>) -> impl Iterator<Item = Vector<Body>> {
        self.active(t).map(move |push| match push {
            Push::Body(push) => push,
            Push::Nav(push) => to_body.apply(push),
        })
    }

    /// The external accelerations at `t`.
    fn active(&self, t: SimTime) -> impl Iterator<Item = Push> {
        self.forces.iter().filter(move |force| force.start <= t && t < force.end).map(|force| force.push)
    }

    /// The means of rate, force and field over `[from, to)`, as an integrating sensor measures them; the attitude
    /// is that at `to`. Exact where the rate is constant, elsewhere to rounding: eight-point Gauss-Legendre panels,
    /// none of which spans a seam or more than a radian of the motion's fastest part.
    pub fn mean(&self, from: SimTime, to: SimTime) -> Truth {
        let end = self.at(to);
        let whole = (to - from).0 as f64;
        if whole <= 0.0 {
            return end;
        }
        let (mut rate, mut force, mut field) = (Vector::ZERO, Vector::ZERO, Vector::ZERO);
        let mut edge = from;
        while edge < to {
            let segment = self.segment(edge);
            let next = self.next_edge(segment, edge).min(to);
            let share = (next - edge).0 as f64 / whole;
            let constant = segment.motion.constant_rate();
            self.quadrature(segment, edge, next, |truth, weight| {
                if constant.is_none() {
                    rate += truth.rate * (weight * share);
                }
                force += truth.force * (weight * share);
                field += truth.field * (weight * share);
            });
            if let Some(constant) = constant {
                rate += constant * share;
            }
            edge = next;
        }
        Truth { rate, force, field, ..end }
    }

    /// The first time after `t` at which the segment or a force begins or ends, or the motion is not smooth.
    fn next_edge(&self, segment: &Segment, t: SimTime) -> SimTime {
        let edges = self.forces.iter().flat_map(|force| [force.start, force.end]).filter(|&edge| edge > t);
        let seam = segment.motion.next_seam(t - segment.start).map(|seam| segment.start + seam);
        edges.chain(seam).fold(segment.end, SimTime::min)
    }

    fn quadrature(&self, segment: &Segment, from: SimTime, to: SimTime, mut add: impl FnMut(Truth, f64)) {
        self.nodes(segment, from, to, |since, _, weight| add(self.in_segment(segment, from, since), weight));
    }

    /// The nodes of a mean over `[from, to)`, none beyond a seam: seconds from the segment's start, the fraction of
    /// the interval before the node, and the weight; weights add to 1.
    fn nodes(&self, segment: &Segment, from: SimTime, to: SimTime, mut at: impl FnMut(Double, f64, f64)) {
        let span = (to - from).seconds();
        let panels = (segment.motion.fastest() * span).ceil().max(1.0);
        for panel in 0..panels as u64 {
            let left = span * panel as f64 / panels;
            let width = span / panels;
            for (node, weight) in GAUSS_LEGENDRE_8 {
                for x in [0.5 - 0.5 * node, 0.5 + 0.5 * node] {
                    let since = (from - segment.start).exact_seconds() + Double::from(left + x * width);
                    at(since, (panel as f64 + x) / panels, 0.5 * weight / panels);
                }
            }
        }
    }
}

/// Positive nodes on (−1, 1) and their weights (Abramowitz & Stegun, table 25.4).
const GAUSS_LEGENDRE_8: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_2, 0.101_228_536_290_376_26),
];

#[cfg(test)]
mod tests {
    use super::super::rotate::constant;
    use super::*;
    use crate::geometry::{exp, log};
    use crate::time::{NANOS, Rate};

    fn gravity() -> Vector<Nav> {
        Vector::new(0.0, 0.0, 9.80665)
    }

    fn turning() -> Trajectory {
        let motions = vec![
            (SimTime(NANOS), constant([0.5, 0.0, 0.0])),
            (SimTime(3 * NANOS / 2), constant([0.3, -4.0, 30.0])),
            (SimTime::ZERO, constant([9.0, 9.0, 9.0])),
        ];
        Trajectory::new(Attitude::IDENTITY, motions, vec![], gravity(), Vector::new(20.0, 0.0, 45.0))
    }

    #[test]
    fn at_rest_specific_force_is_minus_gravity() {
        let still = Trajectory::new(Attitude::IDENTITY, vec![], vec![], gravity(), Vector::ZERO);
        assert_eq!(still.at(SimTime(NANOS)).force, Vector::new(0.0, 0.0, -9.80665));
    }

    #[test]
    fn segments_cover_their_start_but_not_their_end_and_then_the_vehicle_holds() {
        let path = turning();
        assert_eq!(path.at(SimTime(NANOS - 1)).rate.v.x, 0.5);
        assert_eq!(path.at(SimTime(NANOS)).rate.v.y, -4.0);
        assert_eq!(path.moving_until(), SimTime(5 * NANOS / 2));
        assert_eq!(path.at(path.moving_until()).rate, Vector::ZERO);
        let (a, b) = (path.at(path.moving_until()), path.at(SimTime(100 * NANOS)));
        assert_eq!(a.attitude, b.attitude);
    }

    #[test]
    fn reintegrating_the_mean_rate_gives_back_the_attitude() {
        let (path, rate) = (turning(), Rate::hz(100));
        let mut q = path.at(SimTime::ZERO).attitude.q;
        for k in 1..=300 {
            let (from, to) = (rate.tick(k - 1), rate.tick(k));
            q *= exp(path.mean(from, to).rate.v * (to - from).seconds());
        }
        let error = log(q.conjugate() * path.at(rate.tick(300)).attitude.q).length().to_degrees();
        assert!(error < 1e-9, "{error} deg");
    }

    #[test]
    fn means_are_the_integrals_across_seams_and_forces() {
        let mut path = turning();
        let push = Push::Body(Vector::new(0.0, 2.0, 0.0));
        path.forces.push(Force { start: SimTime(NANOS), end: SimTime(2 * NANOS), push });
        let (from, to) = (SimTime(NANOS / 2), SimTime(2 * NANOS));
        let mean = path.mean(from, to);
        // A midpoint sum, edges on step bounds: accurate to 10⁻⁹.
        let steps = 600_000;
        let (mut force, mut rate) = (Vector::ZERO, Vector::ZERO);
        for i in 0..steps {
            let truth = path.at(SimTime(from.0 + (2 * i + 1) * (to - from).0 / (2 * steps)));
            force += truth.force * (1.0 / steps as f64);
            rate += truth.rate * (1.0 / steps as f64);
        }
        assert!((mean.force - force).length() < 1e-8, "{:?} against {force:?}", mean.force);
        assert!((mean.rate - rate).length() < 1e-9, "{:?} against {rate:?}", mean.rate);
    }

    /// The roll rate of a turn jumps where the roll ends: a mean over 4 ms that contains 1 ms of it is a quarter.
    #[test]
    fn a_mean_over_a_jump_within_a_motion_is_exact() {
        #[derive(Debug)]
        struct Jumps;
        impl Motion for Jumps {
            fn at(&self, start: Attitude, t: Double) -> Kinematics {
                let rate = if t.to_f64() < 0.5 { Vector::new(2.0, 0.0, 0.0) } else { Vector::ZERO };
                Kinematics { attitude: start, rate, acceleration: Vector::ZERO }
            }
            fn fastest(&self) -> f64 {
                2.0
            }
            fn next_seam(&self, t: SimTime) -> Option<SimTime> {
                Some(SimTime(NANOS / 2)).filter(|&seam| seam > t)
            }
        }
        let motions: Vec<(SimTime, Box<dyn Motion>)> =
            vec![(SimTime(NANOS), rest()), (SimTime(NANOS), Box::new(Jumps))];
        let path = Trajectory::new(Attitude::IDENTITY, motions, vec![], gravity(), Vector::ZERO);
        let mean = path.mean(SimTime(1_499_000_000), SimTime(1_503_000_000));
        assert!((mean.rate.v.x - 0.5).abs() < 1e-15, "{}", mean.rate.v.x);
        assert!(path.edges().any(|edge| edge == SimTime(1_500_000_000)));
    }

    /// A mean over an interval that spans several keys, or rolling in and out, against panels that stop at them.
    #[test]
    fn means_are_the_integrals_across_the_seams_of_a_motion() {
        for (name, make) in [
            ("waypoints", super::super::waypoints::tests::example as fn() -> _),
            ("circle", super::super::circle::tests::example),
        ] {
            let (motion, seams, length): (Box<dyn Motion>, Vec<SimTime>, SimTime) = make();
            let path =
                Trajectory::new(Attitude::IDENTITY, vec![(length, motion)], vec![], gravity(), Vector::ZERO);
            let (from, to) = (SimTime(123_456_789), SimTime(length.0 - 123_456_789));
            let mean = path.mean(from, to);
            let mut edges = seams;
            edges.extend([from, to]);
            edges.sort();
            let (mut rate, mut force) = (Vector::ZERO, Vector::ZERO);
            for pair in edges.windows(2) {
                let count = 400;
                let edge = |k: i64| SimTime(pair[0].0 + (pair[1] - pair[0]).0 * k / count);
                for k in 0..count {
                    let (share, part) = (
                        (edge(k + 1) - edge(k)).0 as f64 / (to - from).0 as f64,
                        path.mean(edge(k), edge(k + 1)),
                    );
                    rate += part.rate * share;
                    force += part.force * share;
                }
            }
            let off = ((mean.rate - rate).length(), (mean.force - force).length());
            assert!(off.0 < 1e-13 && off.1 < 1e-12, "{name}: off by {off:?}");
        }
    }

    /// An error-free averaged gyro at 70 Hz, which matches no key, reproduces the attitude of a motion that turns
    /// about one axis from key to key.
    #[test]
    fn reintegrating_the_mean_rate_of_waypoints_gives_back_the_attitude() {
        let (motion, seams, length) = super::super::waypoints::tests::example();
        let path =
            Trajectory::new(Attitude::IDENTITY, vec![(length, motion)], vec![], gravity(), Vector::ZERO);
        let rate = Rate::hz(70);
        let mut edges: Vec<_> =
            (0..rate.ticks_before(SimTime::ZERO, length)).map(|k| rate.tick(k)).chain(seams).collect();
        edges.sort();
        let mut q = path.at(SimTime::ZERO).attitude.q;
        for pair in edges.windows(2) {
            q *= exp(path.mean(pair[0], pair[1]).rate.v * (pair[1] - pair[0]).seconds());
        }
        let error = log(q.conjugate() * path.at(edges[edges.len() - 1]).attitude.q).length().to_degrees();
        assert!(error < 1e-9, "{error} deg");
    }

    #[test]
    fn a_nav_force_keeps_its_direction_while_the_body_turns() {
        let mut path = turning();
        let quiet = path.at(SimTime(2 * NANOS));
        let push = Vector::new(1.5, 0.0, 0.0);
        path.forces.push(Force { start: SimTime::ZERO, end: SimTime(9 * NANOS), push: Push::Nav(push) });
        let pushed = path.at(SimTime(2 * NANOS));
        let seen = pushed.attitude.apply(pushed.force - quiet.force);
        assert!((seen - push).length() < 1e-14);
    }
}
