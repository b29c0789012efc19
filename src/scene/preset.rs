//! `part = "…"`: what a datasheet fills in, which keys beside it win over, and what the part could not do.

use super::document::{Entry, Location, Node, Table, Value};
use super::kalibr;
use super::output_rate;
use super::parts::{File, Filter, Scale, Settings};
use super::section::Section;
use super::suggest;
use crate::quantity::{self, Sign};
use crate::sensor::{SensorKind, parts, white_noise};
use crate::time::Rate;

/// Fills a section from the part it names; keys beside `part` override it.
pub(super) fn part(section: &mut Section<'_>, kind: SensorKind) -> Option<&'static str> {
    if kalibr::is_meant(section) {
        let preset = kalibr::preset(section, kind)?;
        let fill = fill(section, kind, &preset, &[], None);
        section.add(fill);
        section.remove("part");
        return None;
    }
    let name = section.text("part", None)?;
    let Some(part) = parts::find(&name, kind) else {
        let names: Vec<_> = parts::names(kind).collect();
        let near = suggest::did_you_mean(&name, names.iter().copied());
        section.mistake(
            "part",
            format!("`{name}` is not a known part; the parts are {}{near}", names.join(", ")),
        );
        return None;
    };
    let file = match File::of(part) {
        Ok(file) => file,
        Err(mistake) => {
            section.mistake("part", mistake.to_string());
            return None;
        }
    };
    let Some(preset) = super::parts::sensor(&file.table, kind) else {
        let having = parts::all().iter().filter(|part| part.text.contains(&format!("[{kind}]")));
        let names: Vec<_> = having.map(|part| part.names[0]).collect();
        section.mistake("part", format!("`{name}` has no {kind}; parts that have one: {}", names.join(", ")));
        return None;
    };
    let settings = file.settings(kind);
    let fill = fill(section, kind, preset, &settings.scales, file.table.get("mount"));
    section.add(fill);
    let wanted = section.entry("rate").and_then(|entry| match &entry.node.value {
        Value::Text(text) => super::parts::rate(text),
        _ => None,
    });
    let named = named_filter(section, settings, wanted);
    if let Some(wanted) = wanted {
        check_rate(section, part.called(&name, kind), kind, settings, &named, wanted);
    }
    Some(part.called(&name, kind))
}

/// Fills in what a setting of a part leaves open: the counts of its range, and what a filter's name stands for.
pub(super) fn set_up(section: &mut Section<'_>, kind: SensorKind, file: &File, rate: Rate) {
    let settings = file.settings(kind);
    if section.has_quietly("range")
        && !section.has_quietly("resolution")
        && let Some(preset) = super::parts::sensor(&file.table, kind)
        && let Some(resolution) = resolution(section, kind, preset, &settings.scales)
    {
        section.add(vec![resolution]);
    }
    named_filter(section, settings, Some(rate));
}

/// A rate that the part has not, or not with this filter, is told and played.
fn check_rate(
    section: &Section<'_>,
    part: &str,
    kind: SensorKind,
    settings: &Settings,
    named: &[Filter],
    wanted: Rate,
) {
    let rates =
        if named.is_empty() { settings.rates.clone() } else { output_rate::with(named, &settings.rates) };
    if rates.is_empty() || output_rate::has(&rates, wanted) {
        return;
    }
    let nearest: Vec<_> = output_rate::nearest(&rates, wanted).iter().map(Rate::to_string).collect();
    let near = if nearest.len() == 1 { "nearest is" } else { "nearest are" };
    let with = named.first().map_or(String::new(), |filter| format!(" with its filter `{}`", filter.name));
    section.reader.warn(format!(
        "{}: the {part} outputs no {kind} samples at {wanted}{with}: the {near} {}; it plays at {wanted} anyway",
        section.place("rate"),
        nearest.join(" and ")
    ));
}

/// `filter = "DLPF 2"`: a setting of the part by its name, in its place the filter and the delay that it has. Gives
/// back every setting of that name, at whatever rate.
fn named_filter(section: &mut Section<'_>, settings: &Settings, rate: Option<Rate>) -> Vec<Filter> {
    let Some(Entry { node: Node { value: Value::Text(wanted), place, .. }, .. }) =
        section.entry("filter").cloned()
    else {
        return Vec::new();
    };
    let is_named = !wanted.starts_with(|first: char| first.is_ascii_digit()) && wanted != "none";
    if settings.filters.is_empty() || !is_named {
        return Vec::new();
    }
    let is_it = |filter: &&Filter| filter.name.eq_ignore_ascii_case(wanted.trim());
    let mut named: Vec<Filter> = settings.filters.iter().filter(is_it).cloned().collect();
    if named.is_empty() {
        let mut names: Vec<&str> = Vec::new();
        for filter in &settings.filters {
            if !names.contains(&filter.name.as_str()) {
                names.push(&filter.name);
            }
        }
        let names = names.join(", ");
        section.mistake(
            "filter",
            format!("`{wanted}` is not a setting of the part: choose one of {names}, or give a cut-off"),
        );
        // A name that is wrong has been told: what is read in its place does not matter.
        named = settings.filters[..1].to_vec();
    }
    let rate = rate.unwrap_or(Rate::hz(1));
    let Some(setting) = output_rate::setting(named.iter(), &settings.rates, rate) else { return named };
    section.replace("filter", &low_pass(setting, &place));
    if let Some(rest) = setting.rest_of_delay().filter(|_| !section.has_quietly("delay")) {
        let node = Node::new(Value::Text(rest.to_string()), place.clone());
        section.add(vec![Entry { key: "delay".into(), place, node }]);
    }
    named
}

/// The filter as a scene writes it.
fn low_pass(setting: &Filter, place: &Location) -> Node {
    let node = |value| Node::new(value, place.clone());
    let cut_off = Value::Text(quantity::text_scalar(setting.low_pass, "Hz"));
    if setting.order == 1 {
        return node(cut_off);
    }
    let entry = |key: &str, value| Entry { key: key.into(), place: place.clone(), node: node(value) };
    let entries = vec![entry("low_pass", cut_off), entry("order", Value::Integer(setting.order.into()))];
    node(Value::Table(Table { place: place.clone(), entries }))
}

/// The preset's entries that the user's table leaves open.
fn fill(
    section: &Section<'_>,
    kind: SensorKind,
    preset: &Table,
    scales: &[Scale],
    mount: Option<&Entry>,
) -> Vec<Entry> {
    let noise_keys = white_noise::KEYS.map(|key| key.name());
    let noise_given = noise_keys.iter().any(|key| section.has_quietly(key));
    let closed = |key: &str| section.has_quietly(key) || (noise_given && noise_keys.contains(&key));
    let open = |key: &str| !closed(key);
    let mut fill: Vec<Entry> =
        preset.entries.iter().filter(|entry| open(&entry.key)).filter_map(preset_value).collect();
    fill.extend(mount.filter(|_| open("mount")).cloned());
    if open("resolution")
        && let Some(resolution) = resolution(section, kind, preset, scales)
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
fn resolution(section: &Section<'_>, kind: SensorKind, preset: &Table, scales: &[Scale]) -> Option<Entry> {
    let own = preset.get("range").and_then(preset_value);
    let range = section.entry("range").cloned().or(own)?;
    let Value::Text(wanted) = &range.node.value else { return None };
    let measure =
        |text: &str| kind.units().reading.signed(Sign::Any).scalar(text).ok().map(|value| value.to_f64());
    let wanted = measure(wanted)?;
    if scales.is_empty() {
        return None;
    }
    let is_it = |scale: &&Scale| measure(&scale.range).is_some_and(|x| (x / wanted - 1.0).abs() < 1e-9);
    let Some(scale) = scales.iter().find(is_it) else {
        let ranges: Vec<_> = scales.iter().map(|scale| scale.range.as_str()).collect();
        section.mistake(
            "range",
            format!("the part has no such range: choose one of {}, or add a `resolution`", ranges.join(", ")),
        );
        return None;
    };
    let node = Node::new(Value::Text(scale.resolution.clone()), range.node.place.clone());
    Some(Entry { key: "resolution".into(), place: range.place, node })
}
