//! The plan as JSON.

use super::{Checked, budgets, drawn, noise, terms, warnings};
use crate::dataset::Bounds;
use crate::earth;
use crate::effects::effects;
use crate::scene::{Plan, SweptKey};
use crate::sensor::{RANGE, Sampling, lsb};
use serde_json::{Value, json};

pub(super) fn json(checked: &Checked<'_>) -> Value {
    let Checked { plan, runs, reference } = *checked;
    let sensors = plan.sensors.iter().map(|sensor| {
        let noise = noise(sensor);
        json!({
            "name": sensor.kind.name(),
            "rate_hz": sensor.rate.as_hz(),
            "phase_s": sensor.phase.seconds(),
            "sampling": match sensor.sampling { Sampling::Point => "point", Sampling::Average => "average" },
            "mount": sensor.mount.map(|mount| mount.to_string()),
            "part": sensor.part,
            "unit": sensor.kind.unit(),
            "noise_std": noise.as_ref().map_or(0.0, |noise| noise.per_sample),
            "noise_density": noise.as_ref().map_or(0.0, |noise| noise.density),
            "random_walk": noise.as_ref().map_or(0.0, |noise| noise.random_walk),
            "range": sensor.values.get(RANGE),
            "resolution": lsb(&sensor.values, sensor.kind),
            "terms": terms(plan, sensor),
        })
    });
    let links = plan.outputs.iter().zip(budgets(plan)).map(|(output, budget)| {
        json!({
            "to": budget.to.to_string(),
            "packets_per_s": budget.packets_per_s,
            "bytes_per_s": budget.bytes_per_s,
            "capacity_bytes_per_s": budget.capacity,
            "utilisation": budget.share(),
            "fits": budget.fits(),
            "ways_out": budget.ways_out,
            "overload": output.overload.name(),
            "force": output.force,
        })
    });
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "scene": plan.name,
        "seed": plan.seed,
        "duration_s": plan.duration.seconds(),
        "moving_until_s": plan.trajectory.moving_until().min(plan.duration).seconds(),
        "bounds": Bounds::of(plan, plan.duration),
        "axes": plan.axes.to_string(),
        "earth": {
            "gravity_m_s2": plan.trajectory.gravity().length(),
            "field_ut": plan.trajectory.field().length(),
            "declination_deg": earth::declination(plan.trajectory.field()).to_degrees(),
            "latitude_deg": plan.site.map(|site| site.latitude.to_degrees()),
            "longitude_deg": plan.site.map(|site| site.longitude.to_degrees()),
            "altitude_m": plan.site.map(|site| site.altitude),
        },
        "position": position(plan),
        "reference": reference.map(|(reference, choice)| {
            json!({
                "from": reference.from(),
                "method": reference.method(),
                "rate_hz": reference.rate().as_hz(),
                "chosen": choice.map(|choice| json!({
                    "max_error_deg": choice.error_deg,
                    "ns_per_simulated_s": choice.ns_per_simulated_s,
                    "why": choice.to_string(),
                })),
            })
        }),
        "sensors": sensors.collect::<Vec<_>>(),
        "effects": effects(plan),
        "links": links.collect::<Vec<_>>(),
        "faults": plan.faults(),
        "limits": plan.limits.iter().map(|(limit, _)| limit).collect::<Vec<_>>(),
        "drawn": drawn(plan),
        "sweep": {
            "combinations": runs.combinations(),
            "keys": runs.swept().collect::<Vec<SweptKey>>(),
        },
        "warnings": warnings(plan),
    })
}

/// Where the vehicle begins and how fast; null of a scene without a sensor that tells.
fn position(plan: &Plan) -> Value {
    if plan.sensors.iter().all(|sensor| sensor.kind.is_triad()) {
        return Value::Null;
    }
    let origin = plan.origin();
    json!({
        "latitude_deg": origin.latitude.to_degrees(),
        "longitude_deg": origin.longitude.to_degrees(),
        "altitude_m": origin.altitude,
        "velocity_ned_m_s": plan.trajectory.start_velocity().v.to_array(),
    })
}
