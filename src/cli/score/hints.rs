//! What explains an estimate's error, or would help.

use crate::report::number;
use crate::score::{Aligned, Judged};

/// What is known of where an estimate comes from.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Known {
    /// How far east of true north the scene's field points, deg.
    pub declination_deg: Option<f64>,
    /// Whether its estimator had no magnetometer.
    pub without_mag: bool,
}

/// A heading that is as near to the declination is that, deg.
const NEAR: f64 = 0.5;
/// A rotation below this is none, deg.
const NONE: f64 = 0.05;

/// The hints for an estimate, none for one that is good.
pub(super) fn of(judged: &Judged, known: Known) -> Vec<String> {
    let mut hints = Vec::new();
    let heading = &judged.figures.errors;
    if let Some((turned, rms)) = judged.turned {
        hints.push(rotation(turned, rms, known));
    } else if known.without_mag && heading.heading_rms_deg > 10.0 && heading.inclination_rms_deg < 5.0 {
        hints.push(
            "without a magnetometer its heading is arbitrary: --align heading removes a constant heading"
                .into(),
        );
    }
    hints
}

/// What a constant rotation that explains an error may come from.
fn rotation(turned: Aligned, rms: f64, known: Known) -> String {
    let Aligned { world_deg, body_deg, heading_deg } = turned;
    let rest = format!("{} deg RMS without it", number(rms));
    let is_heading = body_deg < NONE && (world_deg - heading_deg.abs()).abs() < NONE;
    if !is_heading {
        let body = if body_deg < NONE {
            String::new()
        } else {
            format!(", and one of the body of {} deg", angle(body_deg))
        };
        let (world, option) = (angle(world_deg), if body_deg < NONE { "world" } else { "frames" });
        return format!(
            "a constant rotation of the world of {world} deg ({} deg of it heading){body} explains the error ({rest}): --align {option} removes it",
            angle(heading_deg)
        );
    }
    let heading = angle(heading_deg);
    match known.declination_deg {
        Some(declination) if declination.abs() > NEAR && (heading_deg + declination).abs() < NEAR => format!(
            "its heading is off by {heading} deg: the scene's declination is {} deg, which the estimator does not account for ({rest}); --align heading removes it",
            angle(declination)
        ),
        _ if known.without_mag => format!(
            "its heading is off by {heading} deg, and without a magnetometer it is arbitrary ({rest}): --align heading removes it"
        ),
        _ => format!(
            "a constant heading of {heading} deg explains the error ({rest}): --align heading removes it"
        ),
    }
}

/// An angle of a frame, to a thousandth of a degree.
pub(super) fn angle(deg: f64) -> String {
    number(libm::round(deg * 1000.0) / 1000.0 + 0.0)
}
