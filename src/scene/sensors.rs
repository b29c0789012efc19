//! The tables of sensors, such as `[gyro]`: rates, parts and error terms.

use super::document::Value;
use super::kalibr;
use super::preset;
use super::section::Section;
use crate::geometry::Rotation;
use crate::quantity::Sign;
use crate::sensor::{self, Mount, Sampling, SensorKind, SensorPlan};
use crate::time::{Rate, SimTime};
use glam::DQuat;

pub(super) struct Sensors {
    pub plans: Vec<SensorPlan>,
    pub resolved: Vec<toml::Table>,
    /// Whether every sensor that the scene names could be read.
    pub complete: bool,
}

/// The sensors that the scene has, in order.
pub(super) fn sensors(top: &Section<'_>) -> Sensors {
    let mut sensors = Sensors { plans: Vec::new(), resolved: Vec::new(), complete: true };
    for kind in SensorKind::ALL {
        if !top.has(kind.name()) {
            continue;
        }
        let mut section = top.table(kind.name());
        let part = if kind.is_triad() { preset::part(&mut section, kind) } else { None };
        if let Some(plan) = sensor(&section, kind, part, top.seed()) {
            sensors.plans.push(plan);
            sensors.resolved.push(section.finish());
        } else {
            sensors.complete = false;
            section.finish();
        }
    }
    sensors
}

fn sensor(
    section: &Section<'_>,
    kind: SensorKind,
    part: Option<&'static str>,
    seed: u64,
) -> Option<SensorPlan> {
    // A Kalibr file that could not be read would have had one.
    let usual = kind.row().usual_rate;
    if usual.is_none() && !section.has("rate") && !(kind.is_triad() && kalibr::is_meant(section)) {
        section.lacks(format!("[{kind}] needs a rate, such as rate = \"100 Hz\""));
    }
    let rate = section.rate("rate", usual);
    let phase = section.time("phase", Some("0 s"), Sign::NonNegative).unwrap_or(SimTime::ZERO);
    let average = kind.is_triad() && section.word("sampling", &["point", "average"], "point") == "average";
    let sampling = if average { Sampling::Average } else { Sampling::Point };
    let mount = if kind.is_triad() { mount(section) } else { None };
    let address = if kind.is_triad() { address(section) } else { None };
    let keys = sensor::keys(kind);
    let values = section.values(&keys, true);
    // What a key or part that could not be read would have said is not missed a second time.
    if section.unread(&keys, &values) || (kind.is_triad() && section.has("part") && part.is_none()) {
        return None;
    }
    let any_rate = rate.unwrap_or(Rate::hz(1));
    let (faults, settings) = (Vec::new(), Vec::new());
    let mut plan = SensorPlan {
        kind,
        rate: any_rate,
        phase,
        sampling,
        mount,
        part,
        address,
        values,
        faults,
        settings,
        epoch: 0,
    };
    section.settle_bias(&mut plan);
    let errors = sensor::check(&plan, seed);
    for error in &errors {
        section.mistake(error.key, &error.message);
    }
    (rate.is_some() && errors.is_empty()).then_some(plan)
}

/// Where the sensor's chip answers on a bus.
fn address(section: &Section<'_>) -> Option<u8> {
    let is_number = matches!(section.entry("address")?.node.value, Value::Integer(_));
    let address = section.whole("address", 0);
    // Anything else has been told.
    if !is_number {
        return None;
    }
    let usable = u8::try_from(address).ok().filter(|address| (0x08..=0x77).contains(address));
    if usable.is_none() {
        section.mistake("address", format!("is {address:#x}; an I2C address has 7 bits, from 0x08 to 0x77"));
    }
    usable
}

/// A right-angle mount by name, or a quaternion from body (as the scene writes it) to chip axes.
fn mount(section: &Section<'_>) -> Option<Mount> {
    match &section.entry("mount")?.node.value {
        Value::Text(_) => {
            let name = section.text("mount", None)?;
            let mount = Mount::from_name(&name);
            if mount.is_none() {
                section.mistake("mount", format!("`{name}` is not a right-handed mount: three letters say where the chip's x, y and z point, out of f(orward), b(ack), r(ight), l(eft), u(p) and d(own), such as \"flu\" or \"frd\""));
            }
            mount
        }
        Value::Array(_) => {
            let [w, x, y, z] = section.quaternion("mount")?;
            let sign = section.axes().body_sign();
            // From the scene's body axes: turned over about x when it writes Forward-Left-Up.
            let flip = if sign < 0.0 { DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0) } else { DQuat::IDENTITY };
            Some(Mount::from_rotation(Rotation::from_quat(DQuat::from_xyzw(x, y, z, w) * flip)))
        }
        other => {
            section.mistake(
                "mount",
                format!(
                    "is {}; write three letters, such as \"flu\", or a quaternion [w, x, y, z]",
                    other.what()
                ),
            );
            None
        }
    }
}
