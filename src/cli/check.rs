//! `ratetable check`: the plan of a scene, before anything runs.

use super::budget::Budget;
use super::{Refusal, Verdict, options, say};
use crate::report::{number, table};
use crate::scene::Plan;
use crate::sensor::{SensorKind, SensorPlan, lsb, white_noise};
use crate::wire;
use serde_json::{Value, json};

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// A TOML file or the name of a built-in scene
    scene: String,
    /// Override one key of the scene, such as gyro.rate='8 kHz'
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Print the plan as JSON on standard output
    #[arg(long)]
    json: bool,
}

pub fn check(arguments: &Arguments) -> Result<Verdict, Refusal> {
    let plan = Plan::load(&arguments.scene, &arguments.set)?;
    options::limits(&[], &plan)?;
    if arguments.json {
        say(&(serde_json::to_string_pretty(&json(&plan))? + "\n"));
    } else {
        say(&text(&plan));
    }
    Ok(Verdict::Fine)
}

/// A sensor's white noise, said in each of the ways that users meet.
struct Noise {
    per_sample: f64,
    density: f64,
    random_walk: f64,
}

fn noise(sensor: &SensorPlan) -> Option<Noise> {
    let sigma = white_noise::sigma(&sensor.values, sensor.kind, sensor.rate).ok()?;
    let per_sample = sigma.max_element();
    let hz = sensor.rate.as_hz();
    (per_sample > 0.0).then(|| Noise {
        per_sample,
        density: per_sample / libm::sqrt(hz / 2.0),
        random_walk: per_sample / libm::sqrt(hz),
    })
}

/// What a reading and its random walk are shown in: degrees are easier to judge than radians.
fn shown(kind: SensorKind) -> (&'static str, &'static str, f64) {
    match kind {
        SensorKind::Gyro => ("deg/s", "deg/√s", 1f64.to_degrees()),
        SensorKind::Accel => ("m/s²", "m/s/√s", 1.0),
        SensorKind::Mag => ("µT", "µT·√s", 1.0),
    }
}

fn terms(plan: &Plan, sensor: &SensorPlan) -> Vec<&'static str> {
    plan.build(sensor).terms().to_vec()
}

/// What each output needs, in real time.
fn budgets(plan: &Plan) -> Vec<Budget> {
    Budget::all(plan, &plan.outputs, 1.0)
}

/// What a user should think about before running the scene.
fn warnings(plan: &Plan) -> Vec<String> {
    let mut warnings = Vec::new();
    for sensor in &plan.sensors {
        if noise(sensor).is_none() && lsb(&sensor.values, sensor.kind).is_none() {
            warnings.push(format!(
                "{} has neither noise nor resolution: while the vehicle is still its readings repeat, and a flight controller takes such a sensor for dead (PX4: 100 equal values in a row)",
                sensor.kind
            ));
        }
    }
    if plan.duration > plan.trajectory.moving_until() && plan.trajectory.moving_until().0 > 0 {
        warnings.push(format!(
            "after {} the motions are over and the vehicle holds until {}",
            plan.trajectory.moving_until(),
            plan.duration
        ));
    }
    for output in &plan.outputs {
        warnings.extend(wire::warnings(output.to.protocol, &plan.sensors));
    }
    let over = budgets(plan).into_iter().filter(|budget| !budget.fits());
    warnings.extend(over.map(|budget| budget.to_string()));
    warnings
}

fn text(plan: &Plan) -> String {
    let mut text = format!(
        "{}: {}, seed {}, {} axes\ngravity {} m/s², field {} µT, declination {} deg\n\n",
        plan.name,
        plan.duration,
        plan.seed,
        plan.axes,
        number(plan.trajectory.gravity().length()),
        number(plan.trajectory.field().length()),
        number(crate::earth::declination(plan.trajectory.field()).to_degrees()),
    );
    let rows = plan.sensors.iter().map(|sensor| {
        let (unit, walk_unit, scale) = shown(sensor.kind);
        let amount = |value: f64, unit: &str| format!("{} {unit}", number(value * scale));
        let noise = noise(sensor);
        let say = |pick: fn(&Noise) -> f64, unit: &str| {
            noise.as_ref().map_or("-".into(), |noise| amount(pick(noise), unit))
        };
        vec![
            sensor.kind.to_string(),
            sensor.rate.to_string(),
            sensor.part.unwrap_or("-").to_string(),
            say(|noise| noise.per_sample, unit),
            say(|noise| noise.density, &format!("{unit}/√Hz")),
            say(|noise| noise.random_walk, walk_unit),
            lsb(&sensor.values, sensor.kind).map_or("-".into(), |lsb| amount(lsb, unit)),
            terms(plan, sensor).join(" "),
        ]
    });
    let heading = [
        "sensor",
        "rate",
        "part",
        "noise/sample",
        "one-sided density",
        "random walk",
        "count",
        "terms evaluated",
    ];
    text += &table(&heading, &rows.collect::<Vec<_>>());
    text += "\nOne-sided density (datasheets) = √2 · random walk (Allan deviation at 1 s; Kalibr's noise density).\n";
    if !plan.outputs.is_empty() {
        let rows = budgets(plan).into_iter().map(|budget| {
            let share = budget.share().map_or("-".into(), |share| format!("{:.0} %", 100.0 * share));
            vec![budget.to.to_string(), number(budget.packets_per_s), number(budget.bytes_per_s), share]
        });
        text += &format!(
            "\n{}",
            table(&["output", "packets/s", "bytes/s", "of baud rate"], &rows.collect::<Vec<_>>())
        );
    }
    for drawn in &plan.drawn {
        text += &format!("drawn: {} = {}\n", drawn.key, drawn.value);
    }
    for warning in warnings(plan) {
        text += &format!("warning: {warning}\n");
    }
    text
}

fn json(plan: &Plan) -> Value {
    let sensors = plan.sensors.iter().map(|sensor| {
        let noise = noise(sensor);
        json!({
            "name": sensor.kind.name(),
            "rate_hz": sensor.rate.as_hz(),
            "part": sensor.part,
            "unit": sensor.kind.unit(),
            "noise_std": noise.as_ref().map_or(0.0, |noise| noise.per_sample),
            "noise_density": noise.as_ref().map_or(0.0, |noise| noise.density),
            "random_walk": noise.as_ref().map_or(0.0, |noise| noise.random_walk),
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
        "axes": plan.axes.to_string(),
        "sensors": sensors.collect::<Vec<_>>(),
        "links": links.collect::<Vec<_>>(),
        "drawn": plan.drawn,
        "warnings": warnings(plan),
    })
}
