//! What the columns of a dataset mean.

use crate::geometry::{Attitude, Axes};
use crate::scene::Plan;
use std::collections::BTreeMap;

/// What the columns mean, by subject; in the manifest as well.
pub(super) fn conventions(plan: &Plan) -> BTreeMap<&'static str, String> {
    let (nav, body, euler) = match plan.axes {
        Axes::NedFrd => (
            "North-East-Down",
            "Forward-Right-Down",
            "yaw 0 faces north and grows clockwise seen from above; positive pitch is nose up; positive roll is right side down",
        ),
        Axes::EnuFlu => (
            "East-North-Up",
            "Forward-Left-Up",
            "yaw 0 faces east and grows counter-clockwise seen from above, so the compass heading is 90° - yaw; positive pitch is nose DOWN; positive roll is right side down",
        ),
    };
    let at_rest = at_rest(plan);
    let own = plan.sensors.iter().filter_map(|sensor| sensor.kind.row().table.convention);
    let own = own.map(|(subject, what)| (subject, what.to_string()));
    let common = BTreeMap::from([
        ("nav_frame", format!("{nav}, local level")),
        ("body_frame", body.to_string()),
        (
            "quaternion",
            "Hamilton, scalar first, unit norm; takes body vectors to nav: v_nav = q * v_body * conj(q); its sign is continuous in time".to_string(),
        ),
        (
            "euler",
            format!("of that quaternion, Rz(yaw) Ry(pitch) Rx(roll), rad; roll and yaw in (-pi, pi], pitch in [-pi/2, pi/2]; at pitch = ±pi/2 roll is 0 and yaw carries the rest; {euler}"),
        ),
        ("angular_rate", "of body relative to nav, in body axes, rad/s".to_string()),
        (
            "specific_force",
            format!("acceleration minus gravity, in body axes, m/s^2; level at rest the accelerometer reads {at_rest}"),
        ),
        ("magnetic_field", "in body axes, uT".to_string()),
        ("time", "t_ns: whole nanoseconds from the scene's start".to_string()),
    ]);
    common.into_iter().chain(own).collect()
}

/// What an error-free accelerometer reads level (roll and pitch 0) and at rest, as the scene's axes write it.
pub(super) fn at_rest(plan: &Plan) -> String {
    let level = Attitude::IDENTITY;
    triple(plan.axes.body_out(level.inverse().apply(-plan.trajectory.gravity())))
}

pub(super) fn triple(v: glam::DVec3) -> String {
    format!("[{}, {}, {}]", v.x + 0.0, v.y + 0.0, v.z + 0.0)
}
