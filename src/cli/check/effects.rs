//! The table of effects as text: what the scene models, and what it leaves out.

use super::noise;
use crate::cli::terminal::Stream;
use crate::effects::{Effect, TICKS, Verdict, effects};
use crate::report::number;
use crate::scene::Plan;
use crate::sensor::{SensorPlan, Shown, lsb};

pub(super) fn text(plan: &Plan) -> String {
    let effects = effects(plan);
    let mut rows = Vec::new();
    for sensor in &plan.sensors {
        let own = effects.iter().filter(|effect| effect.sensor == sensor.kind);
        let first = rows.len();
        rows.extend(own.map(row));
        if let Some(row) = rows.get_mut(first) {
            row[0] = sensor.kind.to_string();
        }
    }
    let mut text =
        Stream::Out.table(&["sensor", "effect", "size", "which is", "verdict", "key or note"], &rows);
    text += "\n";
    plan.sensors.iter().for_each(|sensor| text += &shows(sensor));
    text += "An effect shows where it is at least half a count and a tenth of one sample's white noise. A slow one may be\n\
             found below that by averaging. Noise is set against the count alone, rounding against the noise alone.\n";
    if effects.iter().any(|effect| effect.verdict == Verdict::Needless) {
        text += "What is modelled but below could be left out.\n";
    }
    if effects.iter().any(|effect| effect.verdict == Verdict::Missing) {
        text += "What would be seen is worth switching on by its key, or is beyond this version where it has none.\n";
    }
    text + &coverage(plan)
}

/// From which size on a sensor shows an effect.
fn shows(sensor: &SensorPlan) -> String {
    let &Shown { unit, scale, .. } = &sensor.kind.row().shown;
    let amount = |value: f64| number(value * scale);
    let half =
        lsb(&sensor.values, sensor.kind).map(|lsb| format!("half a count is {} {unit}", amount(lsb / 2.0)));
    let tenth =
        noise(sensor).map(|noise| format!("a tenth of the noise {} {unit}", amount(noise.per_sample / 10.0)));
    match half.into_iter().chain(tenth).collect::<Vec<_>>().join(", ") {
        none if none.is_empty() => {
            format!("{}: neither noise nor resolution: an ideal sensor shows everything\n", sensor.kind)
        }
        limits => format!("{}: {limits}\n", sensor.kind),
    }
}

fn row(effect: &Effect) -> Vec<String> {
    let &Shown { unit, scale, .. } = &effect.sensor.row().shown;
    let key = effect.key.clone();
    let by = match (effect.verdict, effect.modelled) {
        (Verdict::Missing, _) => {
            key.map_or("not modelled in this version".into(), |key| format!("consider {key}"))
        }
        (_, true) => key.unwrap_or_default(),
        _ => String::new(),
    };
    let note = effect.note.clone().filter(|note| !note.is_empty());
    let why =
        [Some(by).filter(|by| !by.is_empty()), note].into_iter().flatten().collect::<Vec<_>>().join("; ");
    vec![
        String::new(),
        effect.effect.replace('_', " "),
        format!("{} {unit}", number(effect.size * scale)),
        effect.statistic.to_string(),
        effect.verdict.to_string(),
        why,
    ]
}

/// How a scene was looked at that is too long to be looked at tick by tick.
fn coverage(plan: &Plan) -> String {
    let ticks = |sensor: &SensorPlan| sensor.ticks_before(plan.duration);
    if plan.sensors.iter().all(|sensor| ticks(sensor) <= TICKS) {
        return String::new();
    }
    format!(
        "Largest values are those at some {TICKS} ticks of each sensor: evenly, and at every seam of the motion.\n"
    )
}
