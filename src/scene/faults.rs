//! `[[fault]]`: what a sensor does wrong for a while.

use super::section::Section;
use crate::quantity::Sign;
use crate::sensor::{Fault, FaultKind, SensorKind, SensorPlan};
use crate::time::SimTime;

/// Gives each fault to its sensor; returns them as resolved.
pub(super) fn faults(top: &Section<'_>, sensors: &mut [SensorPlan]) -> Vec<toml::Value> {
    let mut resolved = Vec::new();
    for section in top.tables("fault") {
        if let Some((kind, fault)) = fault(&section) {
            match sensors.iter_mut().find(|sensor| sensor.kind == kind) {
                Some(sensor) => {
                    if let Err(error) = fault.check(kind, sensor.values.scalar("range")) {
                        section.mistake(error.key, &error.message);
                    }
                    sensor.faults.push(fault);
                }
                None => section.mistake("sensor", format!("the scene has no {kind} to have a fault")),
            }
        }
        resolved.push(section.finish().into());
    }
    resolved
}

fn fault(section: &Section<'_>) -> Option<(SensorKind, Fault)> {
    let (sensors, kinds) = (SensorKind::ALL.map(SensorKind::name), FaultKind::ALL.map(FaultKind::name));
    for (key, example) in [("sensor", "gyro"), ("kind", "stuck")] {
        if !section.has(key) {
            section.lacks(format!("a fault needs its {key}, such as {key} = \"{example}\""));
            section.allow_everything();
            return None;
        }
    }
    let sensor = section.word("sensor", &sensors, "gyro");
    let kind = section.word("kind", &kinds, "off");
    let sensor = SensorKind::ALL.into_iter().find(|known| known.name() == sensor)?;
    let kind = FaultKind::ALL.into_iter().find(|known| known.name() == kind)?;
    let start = section.time("start", Some("0 s"), Sign::NonNegative);
    let duration = section.has("duration").then(|| section.time("duration", None, Sign::Positive));
    let keys = kind.keys(sensor);
    let values = section.values(&keys, true);
    if section.unread(&keys, &values) {
        return None;
    }
    let start = start?;
    let end = match duration {
        Some(duration) => start + duration?,
        None => SimTime::FOREVER,
    };
    Some((sensor, Fault { kind, start, end, values }))
}
