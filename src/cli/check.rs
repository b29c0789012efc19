//! `ratetable check`: the plan of a scene, before anything runs.

mod effects;
mod json;
mod text;

use super::{Refusal, Verdict, generate, options, say};
use crate::motion::method::Choice;
use crate::scene::{Drawn, Plan, Reference, Runs};
use crate::sensor::{SensorPlan, TERMS, lsb, white_noise};
use crate::session::Budget;
use crate::wire;

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
    let runs = Runs::load(&arguments.scene, &arguments.set)?;
    let plan = Plan::load(&arguments.scene, &arguments.set)?;
    options::limits(&[], &plan)?;
    generate::affordable(&plan, 1)?;
    let settle = |reference: Reference| reference.settled(&plan.trajectory, plan.duration);
    let reference = plan.reference.map(settle).transpose();
    let reference = reference.map_err(|why| Refusal(format!("[reference]: {why}")))?;
    let checked = Checked { plan: &plan, runs: &runs, reference: reference.as_ref() };
    if arguments.json {
        say(&(serde_json::to_string_pretty(&json::json(&checked))? + "\n"))?;
    } else {
        say(&text::text(&checked))?;
    }
    Ok(Verdict::Fine)
}

/// A scene as it was read.
struct Checked<'a> {
    plan: &'a Plan,
    /// The scene as one of many runs.
    runs: &'a Runs,
    /// The attitude beside the truth, and why it is computed so where that was left to us.
    reference: Option<&'a (Reference, Option<Choice>)>,
}

/// The values drawn for this run that one of its terms uses.
fn drawn(plan: &Plan) -> Vec<&Drawn> {
    let is_used = |drawn: &&Drawn| {
        let mut path = drawn.key.split('.');
        let (of, key) = (path.next(), path.next());
        let Some(sensor) = plan.sensors.iter().find(|sensor| Some(sensor.kind.name()) == of) else {
            return true;
        };
        let used = terms(plan, sensor);
        let mut of_key = TERMS
            .iter()
            .filter(|term| (term.keys)(sensor.kind).iter().any(|declared| Some(declared.name) == key));
        let declared = of_key.clone().next().is_some();
        !declared || of_key.any(|term| used.contains(&term.name))
    };
    plan.drawn.iter().filter(is_used).collect()
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

fn terms(plan: &Plan, sensor: &SensorPlan) -> Vec<&'static str> {
    plan.build(sensor).terms().to_vec()
}

/// What each output needs, in real time.
fn budgets(plan: &Plan) -> Vec<Budget> {
    Budget::all(plan, &plan.outputs, 1.0)
}

/// Warnings to consider before running the scene.
fn warnings(plan: &Plan) -> Vec<String> {
    let mut warnings = plan.warnings.clone();
    for sensor in &plan.sensors {
        if !sensor.kind.row().may_repeat
            && noise(sensor).is_none()
            && lsb(&sensor.values, sensor.kind).is_none()
        {
            warnings.push(format!(
                "{} has neither noise nor resolution: while the vehicle is still its readings repeat, and a flight controller treats such a sensor as dead (PX4: 100 equal values in a row)",
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
        warnings.extend(wire::warnings(output.to.protocol, &output.wire, &plan.sensors));
    }
    let over = budgets(plan).into_iter().filter(|budget| !budget.fits());
    warnings.extend(over.map(|budget| budget.to_string()));
    warnings
}
