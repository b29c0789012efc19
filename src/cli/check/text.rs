//! The plan as text.

use super::effects;
use super::{Checked, Noise, budgets, drawn, noise, terms, warnings};
use crate::cli::terminal::Stream;
use crate::earth;
use crate::report::{count, number};
use crate::scene::{Drawn, Plan, Runs};
use crate::sensor::{Claims, RANGE, Sampling, SensorKind, SensorPlan, Shown, lsb};
use crate::time::SimTime;

pub(super) fn text(checked: &Checked<'_>) -> String {
    let Checked { plan, runs, reference } = *checked;
    let mut text = heading(plan);
    if let Some((reference, choice)) = reference {
        let (from, method, rate) = (reference.from(), reference.method(), reference.rate());
        text += &format!("reference.csv: from {from} by {method} at {rate}\n");
        text += &choice.map_or(String::new(), |choice| format!("chosen: {choice}\n"));
    }
    text += &position(plan);
    text += &sweep(runs);
    text += &format!("\n{}", sensors(plan));
    text += "\nOne-sided density (datasheets) = √2 · random walk (Allan deviation at 1 s; Kalibr's noise density).\n";
    text += &format!("\n{}", effects::text(plan));
    if !plan.outputs.is_empty() {
        text += &format!("\n{}", outputs(plan));
    }
    for fault in plan.faults() {
        text += &format!("fault: {fault}\n");
    }
    for (limit, _) in &plan.limits {
        text += &format!("limit: {limit}\n");
    }
    for drawn in drawn(plan) {
        text += &format!("drawn: {} = {}\n", drawn.key, in_its_unit(drawn));
    }
    for warning in warnings(plan) {
        text += &format!("warning: {warning}\n");
    }
    Stream::Out.fold(&text)
}

/// As the scene writes it, shortened: `[0.1339, 0.113, 0.05751] deg/s`.
fn in_its_unit(drawn: &Drawn) -> String {
    let numbers: Vec<_> = drawn.numbers.iter().map(|value| number(*value)).collect();
    match numbers.as_slice() {
        [one] => format!("{one} {}", drawn.unit),
        several => format!("[{}] {}", several.join(", "), drawn.unit),
    }
}

/// What differs from run to run.
fn sweep(runs: &Runs) -> String {
    if runs.keys().next().is_none() {
        return String::new();
    }
    let combinations = count(runs.combinations(), "combination");
    let mut text = format!("sweep: {combinations} for `generate`; what follows is the scene without it\n");
    for swept in runs.swept() {
        text += &match (swept.drawn, swept.values.as_slice()) {
            (true, [low, high]) => format!("  {}: from {low} to {high}, drawn for each run\n", swept.key),
            (_, values) => format!("  {}: {}\n", swept.key, values.join(", ")),
        };
    }
    text
}

fn heading(plan: &Plan) -> String {
    let mut text = format!(
        "{}: {}, seed {}, {} axes\ngravity {} m/s², field {} µT, declination {} deg\n",
        plan.name,
        plan.duration,
        plan.seed,
        plan.axes,
        number(plan.trajectory.gravity().length()),
        number(plan.trajectory.field().length()),
        number(earth::declination(plan.trajectory.field()).to_degrees()),
    );
    if let Some(site) = plan.site {
        let (latitude, longitude) = (site.latitude.to_degrees(), site.longitude.to_degrees());
        let day =
            plan.day.map_or(String::new(), |day| format!(", {}-{:02}-{:02}", day.year, day.month, day.day));
        text += &format!(
            "at {} deg north, {} deg east, {} m{day}\n",
            number(latitude),
            number(longitude),
            number(site.altitude)
        );
    }
    text
}

/// Where the vehicle begins and how fast, of a scene with a sensor that tells.
fn position(plan: &Plan) -> String {
    if plan.sensors.iter().all(|sensor| sensor.kind.is_triad()) {
        return String::new();
    }
    let (origin, velocity) = (plan.origin(), plan.trajectory.start_velocity().v);
    let [north, east, down] = velocity.to_array().map(number);
    format!(
        "position: starts at {} deg north, {} deg east, {} m, with {north} m/s north, {east} east, {down} down\n",
        number(origin.latitude.to_degrees()),
        number(origin.longitude.to_degrees()),
        number(origin.altitude)
    )
}

fn sensors(plan: &Plan) -> String {
    let rows = plan.sensors.iter().map(|sensor| {
        let &Shown { unit, walk_unit, scale, .. } = &sensor.kind.row().shown;
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
    let table = Stream::Out.table(&heading, &rows.collect::<Vec<_>>());
    plan.sensors.iter().fold(table, |text, sensor| text + &manner(sensor))
}

/// How a sensor samples, and what else the scene says of it.
fn manner(sensor: &SensorPlan) -> String {
    let &Shown { unit, scale, .. } = &sensor.kind.row().shown;
    let mut text = format!(
        "{}: {}",
        sensor.kind,
        match sensor.sampling {
            Sampling::Point => "the value at the tick",
            Sampling::Average => "the mean since the tick before",
        }
    );
    if sensor.phase > SimTime::ZERO {
        text += &format!(", from {} on", sensor.phase);
    }
    if sensor.clock() != sensor.rate {
        text += &format!(", by a clock that makes {} Hz of {}", sensor.clock().as_hz(), sensor.rate);
    }
    if let Some(range) = sensor.values.get(RANGE) {
        text += &format!(", within ±{} {unit}", number(range * scale));
    }
    if let Some(mount) = sensor.mount {
        text += &format!(", mounted {mount}");
    }
    for segment in sensor.segments().iter().skip(1) {
        let rate = segment.clock.map_or("off".to_string(), |_| segment.plan.rate.to_string());
        let range = segment.plan.values.get(RANGE);
        let range = range.map_or(String::new(), |range| format!(" within ±{} {unit}", number(range * scale)));
        text += &format!("; from {} on {rate}{range}", segment.from);
    }
    if sensor.kind == SensorKind::Gps {
        let Claims { eph, epv, satellites } = Claims::of(&sensor.values);
        let (eph, epv) = (number(eph), number(epv));
        text += &format!(", claiming {eph} m horizontally, {epv} m vertically, {satellites} satellites");
    }
    text + "\n"
}

fn outputs(plan: &Plan) -> String {
    let rows = budgets(plan).into_iter().map(|budget| {
        let share = budget.share().map_or("-".into(), |share| format!("{:.0} %", 100.0 * share));
        vec![budget.to.to_string(), number(budget.packets_per_s), number(budget.bytes_per_s), share]
    });
    Stream::Out.table(&["output", "packets/s", "bytes/s", "of baud rate"], &rows.collect::<Vec<_>>())
}
