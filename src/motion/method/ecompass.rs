//! Attitude from gravity and the magnetic field: what an accelerometer and a magnetometer give at rest.

use crate::geometry::{Attitude, Body, Nav, Vector};
use glam::{DMat3, DQuat, DVec3};

/// Below this sine of the angle between gravity and field (10⁻⁶: a fifth of a second of arc) the heading is noise.
const PARALLEL: f64 = 1e-6;

/// Why two vectors give no attitude.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Degenerate {
    /// The force is zero or not finite: up is unknown.
    #[error("the specific force is zero (or not finite): up and down are undefined")]
    NoForce,
    /// The field is zero or not finite: the heading is unknown.
    #[error("the magnetic field is zero (or not finite): heading is undefined")]
    NoField,
    /// Gravity and field are parallel, as at a magnetic pole.
    #[error("the magnetic field is along the specific force, as at a magnetic pole: heading is undefined")]
    Parallel,
}

/// The attitude that maps the body's `force` and `field` to `up` (specific force at rest, −g) and `north` in nav.
///
/// TRIAD aligns the two triads `x = f/|f|`, `y = x×m/|x×m|`, `z = x×y`: force matches exactly, field as closely as
/// the angle between them allows. Only directions count, not scale. Source: H. Black, *A passive system for
/// determining the attitude of a satellite*, AIAA Journal 2 (1964); M. Shuster, S. Oh, *Three-axis attitude
/// determination from vector observations*, J. Guidance and Control 4 (1981).
pub fn ecompass(
    force: Vector<Body>,
    field: Vector<Body>,
    up: Vector<Nav>,
    north: Vector<Nav>,
) -> Result<Attitude, Degenerate> {
    let turn = triad(up.v, north.v)? * triad(force.v, field.v)?.transpose();
    Ok(Attitude::from_quat(DQuat::from_mat3(&turn).normalize()))
}

fn triad(force: DVec3, field: DVec3) -> Result<DMat3, Degenerate> {
    let x = force.try_normalize().ok_or(Degenerate::NoForce)?;
    let m = field.try_normalize().ok_or(Degenerate::NoField)?;
    let across = x.cross(m);
    if across.length() < PARALLEL {
        return Err(Degenerate::Parallel);
    }
    let y = across.normalize();
    Ok(DMat3::from_cols(x, y, x.cross(y)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::exp;

    const UP: Vector<Nav> = Vector::new(0.0, 0.0, -9.80665);
    const NORTH: Vector<Nav> = Vector::new(15.0, 3.2, 50.3);

    #[test]
    fn it_gives_back_any_attitude_and_scale_does_not_matter() {
        for v in [
            [0.0; 3],
            [0.3, -1.2, 0.5],
            [3.1, 0.0, 0.0],
            [0.0, std::f64::consts::FRAC_PI_2, 0.0],
            [2.0, 2.0, -1.0],
        ] {
            let truth = Attitude::from_quat(exp(DVec3::from_array(v)));
            let (force, field) = (truth.inverse().apply(UP), truth.inverse().apply(NORTH));
            let found = ecompass(force * 3.0, field * 1e-3, UP, NORTH).unwrap();
            assert!(found.angle_to(truth) < 1e-14, "{v:?}");
        }
    }

    #[test]
    fn where_no_attitude_can_be_told_it_says_why() {
        let (force, field) = (Vector::new(0.0, 0.0, -9.8), Vector::new(15.0, 3.2, 50.3));
        let nan = Vector::new(f64::NAN, 0.0, 0.0);
        assert_eq!(ecompass(Vector::ZERO, field, UP, NORTH), Err(Degenerate::NoForce));
        assert_eq!(ecompass(nan, field, UP, NORTH), Err(Degenerate::NoForce));
        assert_eq!(ecompass(force, Vector::ZERO, UP, NORTH), Err(Degenerate::NoField));
        assert_eq!(ecompass(force, nan, UP, NORTH), Err(Degenerate::NoField));
        for sign in [1.0, -1.0] {
            let along = Vector::new(0.0, 0.0, sign * 50.0);
            assert_eq!(ecompass(force, along, UP, NORTH), Err(Degenerate::Parallel));
        }
    }
}
