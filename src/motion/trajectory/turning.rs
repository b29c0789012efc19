//! Angular acceleration, by differences of the exact angular rate, and means of functions of time.

use super::{GAUSS_LEGENDRE_8, Segment, Trajectory};
use crate::geometry::{Body, Vector};
use crate::time::{NANOS, SimTime};

/// Weights of five-point differences of fourth order, and their positions in steps from the point (Abramowitz &
/// Stegun, table 25.2): around it, after it, before it.
const STENCILS: [(i64, [f64; 5]); 3] = [
    (-2, [1.0, -8.0, 0.0, 8.0, -1.0]),
    (0, [-25.0, 48.0, -36.0, 16.0, -3.0]),
    (-4, [3.0, -16.0, 36.0, -48.0, 25.0]),
];

impl Trajectory {
    /// The derivative of the angular rate at `t`, rad/s², from the same side of a seam as the rate. A jump of the
    /// rate itself has no derivative and is left out. Fourth-order differences over 1/500 of the motion's fastest
    /// radian err by 10⁻¹² of the rate for each radian.
    pub fn angular_acceleration(&self, t: SimTime) -> Vector<Body> {
        let segment = self.segment(t);
        if segment.motion.constant_rate().is_some() {
            return Vector::ZERO;
        }
        let fits = (0.002 / segment.motion.fastest().max(1e-9) * NANOS as f64).clamp(200.0, 1e6) as i64;
        // Between two close seams the step is shorter.
        let mut steps = [fits, fits / 8, fits / 64].into_iter().filter(|&h| h > 0);
        let found = steps
            .find_map(|h| Some((h, STENCILS.iter().find(|(first, _)| segment.smooth(t, first * h, 4 * h))?)));
        let Some((h, (first, weights))) = found else { return Vector::ZERO };
        let rate = |i: usize| {
            let since = SimTime((t - segment.start).0 + (first + i as i64) * h);
            segment.motion.at(segment.attitude, since.exact_seconds()).rate
        };
        let sum = (0..5).fold(Vector::ZERO, |sum, i| sum + rate(i) * weights[i]);
        sum * (1.0 / (12.0 * SimTime(h).seconds()))
    }

    /// The mean over `[from, to)` of a function of time, by eight-point Gauss-Legendre panels as in
    /// [`Trajectory::mean`], at whole nanoseconds.
    pub fn mean_of(&self, from: SimTime, to: SimTime, of: impl Fn(SimTime) -> Vector<Body>) -> Vector<Body> {
        if to <= from {
            return of(to);
        }
        let (mut sum, mut edge) = (Vector::ZERO, from);
        while edge < to {
            let segment = self.segment(edge);
            let next = self.next_edge(segment, edge).min(to);
            let span = (next - edge).0 as f64;
            let panels = (segment.motion.fastest() * span / NANOS as f64).ceil().max(1.0);
            for panel in 0..panels as u64 {
                for (node, weight) in GAUSS_LEGENDRE_8 {
                    for x in [0.5 - 0.5 * node, 0.5 + 0.5 * node] {
                        let ns = libm::round(span * (panel as f64 + x) / panels) as i64;
                        sum += of(SimTime(edge.0 + ns).min(SimTime(next.0 - 1)))
                            * (0.5 * weight * span / panels);
                    }
                }
            }
            edge = next;
        }
        sum * (1.0 / (to - from).0 as f64)
    }
}

impl Segment {
    /// Whether nothing jumps from `first` to `first + span` ns after `t`, except at `t` itself for what begins
    /// there.
    fn smooth(&self, t: SimTime, first: i64, span: i64) -> bool {
        let left = SimTime((t - self.start).0 + first);
        let right = SimTime(left.0 + span);
        let inside = self.start + right <= self.end && left >= SimTime::ZERO;
        inside && self.motion.next_seam(left).is_none_or(|seam| seam > right)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Plan;

    fn path(motion: &str) -> Trajectory {
        let text = format!("{motion}\n[gyro]\nrate = \"100 Hz\"\n");
        Plan::parse(&text, "s", "s", &[]).unwrap_or_else(|error| panic!("{error}")).trajectory
    }

    const ROCK: &str =
        "[[motion]]\nkind = \"rock\"\namplitude = \"2 rad/s\"\nfrequency = \"50 Hz\"\nduration = \"1 s\"";
    const W: f64 = 50.0 * std::f64::consts::TAU;

    #[test]
    fn it_is_the_derivative_of_the_rate_at_a_seam_and_away_from_it() {
        let path = path(ROCK);
        for ns in [0, 1, 1000, 12_345_678, 500_000_000, 999_999_000, 999_999_999] {
            let (found, t) = (path.angular_acceleration(SimTime(ns)).v, SimTime(ns).seconds());
            let expected = 2.0 * W * (W * t).cos();
            assert!((found.x - expected).abs() < 1e-8 * 2.0 * W, "{ns}: {} against {expected}", found.x);
            assert_eq!((found.y, found.z), (0.0, 0.0));
        }
        assert_eq!(path.angular_acceleration(SimTime(NANOS)), Vector::ZERO, "holding after the last motion");
    }

    #[test]
    fn a_recorded_log_has_one_between_its_rows() {
        let motion = "[[motion]]\nkind = \"waypoints\"\nduration = \"2 s\"\nkeys = [{ t = \"1 s\", attitude = \"[60, 0, 0] deg\" }, { t = \"2 s\", attitude = \"[0, 0, 0] deg\" }]";
        let path = path(motion);
        // s'' of 10u³ − 15u⁴ + 6u⁵ is 60u − 180u² + 120u³.
        for t in [0.2f64, 0.999_999_9, 1.0, 1.3] {
            let u = t.fract();
            let sign = if t < 1.0 { 1.0 } else { -1.0 };
            let expected = sign * 60f64.to_radians() * (60.0 * u - 180.0 * u * u + 120.0 * u * u * u);
            let found = path.angular_acceleration(SimTime((t * 1e9) as i64)).v.x;
            assert!((found - expected).abs() < 1e-6, "{t}: {found} against {expected}");
        }
    }

    #[test]
    fn means_are_integrals_over_seams_too() {
        let path = path(ROCK);
        let rate = |t| path.at(t).rate;
        for (from, to) in [(0, 3_000_000), (990_000_000, 1_010_000_000), (5, 5)] {
            let (from, to) = (SimTime(from), SimTime(to));
            let (found, mean) = (path.mean_of(from, to, rate), path.mean(from, to).rate);
            let same = if from == to { path.at(to).rate } else { mean };
            // Half a nanosecond of an angular acceleration of 628 rad/s².
            assert!((found - same).length() < 3.2e-7, "{found:?} {same:?}");
        }
    }
}
