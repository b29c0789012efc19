//! `[gyro]`, `[accel]`, `[mag]`, `[baro]` and `[gps]`: rates, parts and error terms.

use super::document::{Entry, Node, Table, Value};
use super::kalibr;
use super::section::Section;
use super::suggest;
use crate::geometry::Rotation;
use crate::quantity::Sign;
use crate::sensor::{self, Mount, Sampling, SensorKind, SensorPlan, parts, white_noise};
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
        let part = if kind.is_triad() { part(&mut section, kind) } else { None };
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
    let usual = (kind == SensorKind::Gps).then_some("5 Hz");
    if usual.is_none() && !section.has("rate") && !(kind.is_triad() && kalibr::is_meant(section)) {
        section.lacks(format!("[{kind}] needs a rate, such as rate = \"100 Hz\""));
    }
    let rate = section.rate("rate", usual);
    let phase = section.time("phase", Some("0 s"), Sign::NonNegative).unwrap_or(SimTime::ZERO);
    let average = kind.is_triad() && section.word("sampling", &["point", "average"], "point") == "average";
    let sampling = if average { Sampling::Average } else { Sampling::Point };
    let mount = if kind.is_triad() { mount(section) } else { None };
    let keys = sensor::keys(kind);
    let values = section.values(&keys, true);
    // What a key or part that could not be read would have said is not missed a second time.
    if section.unread(&keys, &values) || (kind.is_triad() && section.has("part") && part.is_none()) {
        return None;
    }
    let any_rate = rate.unwrap_or(Rate::hz(1));
    let faults = Vec::new();
    let mut plan = SensorPlan { kind, rate: any_rate, phase, sampling, mount, part, values, faults };
    section.settle_bias(&mut plan);
    let errors = sensor::check(&plan, seed);
    for error in &errors {
        section.mistake(error.key, &error.message);
    }
    (rate.is_some() && errors.is_empty()).then_some(plan)
}

/// A right-angle mount by name, or a quaternion from body (as the scene writes it) to chip axes.
fn mount(section: &Section<'_>) -> Option<Mount> {
    match &section.entry("mount")?.node.value {
        Value::Text(_) => {
            let name = section.text("mount", None)?;
            let mount = Mount::from_name(&name);
            if mount.is_none() {
                section.mistake("mount", format!("`{name}` is no right-handed mount: three letters say where the chip's x, y and z point, out of f(orward), b(ack), r(ight), l(eft), u(p) and d(own), such as \"flu\" or \"frd\""));
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

/// Fills a section from the part it names; keys beside `part` override it.
fn part(section: &mut Section<'_>, kind: SensorKind) -> Option<&'static str> {
    if kalibr::is_meant(section) {
        let preset = kalibr::preset(section, kind)?;
        let fill = fill(section, kind, &preset, None);
        section.add(fill);
        section.remove("part");
        return None;
    }
    let name = section.text("part", None)?;
    let Some(part) = parts::find(&name, kind) else {
        let names: Vec<_> = parts::names(kind).collect();
        let near = suggest::did_you_mean(&name, names.iter().copied());
        section
            .mistake("part", format!("`{name}` is no part known here; there are {}{near}", names.join(", ")));
        return None;
    };
    let table = match Table::parse(part.text, part.file) {
        Ok(table) => table,
        Err(mistake) => {
            section.mistake("part", mistake.to_string());
            return None;
        }
    };
    let Some(Value::Table(preset)) = table.get(kind.name()).map(|entry| &entry.node.value) else {
        let having = parts::all().iter().filter(|part| part.text.contains(&format!("[{kind}]")));
        let names: Vec<_> = having.map(|part| part.names[0]).collect();
        section.mistake("part", format!("`{name}` has no {kind}; parts with one: {}", names.join(", ")));
        return None;
    };
    let fill = fill(section, kind, preset, table.get("mount"));
    section.add(fill);
    named_filter(section, preset);
    Some(part.names[0])
}

/// `filter = "DLPF 2"`: a setting of the part by its name, in its place the filter and the delay that it has.
fn named_filter(section: &mut Section<'_>, preset: &Table) {
    let Some(Value::Array(filters)) = preset.get("filters").map(|entry| &entry.node.value) else { return };
    let Some(Value::Text(wanted)) = section.entry("filter").map(|entry| entry.node.value.clone()) else {
        return;
    };
    if wanted.starts_with(|first: char| first.is_ascii_digit()) {
        return;
    }
    let setting = |node: &Node| match &node.value {
        Value::Table(table) => {
            let Value::Text(name) = &table.get("name")?.node.value else { return None };
            Some((name.clone(), table.get("low_pass")?.node.clone(), table.get("delay").cloned()))
        }
        _ => None,
    };
    let settings: Vec<_> = filters.iter().filter_map(setting).collect();
    let found = settings.iter().find(|(name, ..)| name.eq_ignore_ascii_case(wanted.trim()));
    if found.is_none() {
        let names: Vec<_> = settings.iter().map(|(name, ..)| name.as_str()).collect();
        let names = names.join(", ");
        section.mistake(
            "filter",
            format!("`{wanted}` is no setting of the part: choose one of {names}, or give a cut-off"),
        );
    }
    // A name that is wrong has been told: what is read in its place does not matter.
    let Some((_, low_pass, delay)) = found.or(settings.first()) else { return };
    section.replace("filter", low_pass);
    if !section.has_quietly("delay") {
        section.add(delay.clone().into_iter().collect());
    }
}

/// The preset's entries that the user's table leaves open.
fn fill(section: &Section<'_>, kind: SensorKind, preset: &Table, mount: Option<&Entry>) -> Vec<Entry> {
    let noise_given = white_noise::KEYS.iter().any(|key| section.has_quietly(key));
    let closed = |key: &str| section.has_quietly(key) || (noise_given && white_noise::KEYS.contains(&key));
    let open = |key: &str| !closed(key);
    let mut fill: Vec<Entry> =
        preset.entries.iter().filter(|entry| open(&entry.key)).filter_map(preset_value).collect();
    fill.extend(mount.filter(|_| open("mount")).cloned());
    if open("resolution")
        && let Some(resolution) = resolution(section, kind, preset)
    {
        fill.retain(|entry| entry.key != "resolution");
        fill.push(resolution);
    }
    fill
}

/// `key = { value = …, source = "…" }` without its source.
fn preset_value(entry: &Entry) -> Option<Entry> {
    let Value::Table(table) = &entry.node.value else { return None };
    let value = table.get("value")?;
    Some(Entry { node: value.node.clone(), ..entry.clone() })
}

/// The part's resolution at the range in force: the user's, or its own default.
fn resolution(section: &Section<'_>, kind: SensorKind, preset: &Table) -> Option<Entry> {
    let Some(Value::Array(scales)) = preset.get("scales").map(|entry| &entry.node.value) else { return None };
    let own = preset.get("range").and_then(preset_value);
    let range = match section.entry("range") {
        Some(entry) => entry.node.clone(),
        None => own?.node,
    };
    let measure = |node: &Node| match &node.value {
        Value::Text(text) => kind.units().reading.signed(Sign::Any).scalar(text).ok().map(|x| x.to_f64()),
        _ => None,
    };
    let wanted = measure(&range)?;
    let scale = |node: &Node| match &node.value {
        Value::Table(table) => Some((table.get("range")?.node.clone(), table.get("resolution")?.clone())),
        _ => None,
    };
    let scales: Vec<_> = scales.iter().filter_map(scale).collect();
    let found =
        scales.iter().find(|(range, _)| measure(range).is_some_and(|x| (x / wanted - 1.0).abs() < 1e-9));
    if found.is_none() {
        let ranges: Vec<_> = scales
            .iter()
            .filter_map(|(range, _)| match &range.value {
                Value::Text(text) => Some(text.clone()),
                _ => None,
            })
            .collect();
        section.mistake(
            "range",
            format!(
                "the part has no such range: choose one of {}, or give a `resolution` beside it",
                ranges.join(", ")
            ),
        );
    }
    found.map(|(_, resolution)| resolution.clone())
}
