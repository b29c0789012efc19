//! The leaner scene: without everything that may go, shown to score the same, and written as a scene.

use super::paired::Finding;
use super::parts::{self, Part, What};
use super::scores::Trials;
use super::variant::{Base, Variant};
use super::verdicts::{FilterChange, filter_changes};
use crate::parallel::Progress;
use crate::scene::{Plan, SceneError};
use crate::sensor::{SensorKind, TERMS};
use toml::{Table, Value};

/// Something that may go: what it is, the largest change that it may make to a filter, in margins, and why it may.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// What it is.
    pub part: Part,
    /// In margins; 0 where no filter reads it.
    pub margins: f64,
    /// Its verdict, as text.
    pub why: String,
}

/// What was found.
pub struct Lean {
    /// What plays.
    pub variant: Variant,
    /// What it has.
    pub kept: Vec<Part>,
    /// What it leaves out, with why.
    pub left_out: Vec<(Part, String)>,
    /// What could have gone alone, but not with all of these, and why.
    pub put_back: Vec<(Part, &'static str)>,
    /// Its filters against the whole scene's; each is the same.
    pub filters: Vec<FilterChange>,
}

/// Leaves out as many of `candidates` as go together. Where the filters' scores over the seeds of `trials` are not shown
/// to be the same, that with the largest effect is put back, and so on; with none left out they are the same.
///
/// # Errors
/// A scene that its own keys cannot make.
pub fn search(
    base: &Base,
    candidates: &[Candidate],
    trials: &Trials<'_>,
    progress: Progress,
) -> Result<Lean, SceneError> {
    let whole = base.whole();
    let mut out = candidates.to_vec();
    out.sort_by(|a, b| a.margins.total_cmp(&b.margins));
    let mut put_back = Vec::new();
    let untested = trials.runs.is_empty();
    let scores = if untested || out.is_empty() { None } else { trials.of(&[&whole], progress)?.pop() };
    loop {
        if let Some((index, why)) = blocked(base, &out) {
            put_back.push((out.remove(index).part, why));
            continue;
        }
        let variant = base.without_all(&parts_of(&out));
        let mut filters = Vec::new();
        if let Some(scores) = scores.as_ref().filter(|_| !out.is_empty()) {
            let lean = trials.of(&[&variant], progress)?;
            filters = filter_changes(trials.runs, None, scores, &lean[0]);
        }
        if filters.iter().all(|filter| filter.finding == Finding::Same) {
            let kept = parts::parts(&variant.plan(0)?);
            let left_out = left_out_of(&whole, &kept, &out)?;
            return Ok(Lean { variant, kept, left_out, put_back, filters });
        }
        put_back.extend(out.pop().map(|candidate| (candidate.part, "not with all of the others")));
    }
}

fn parts_of(out: &[Candidate]) -> Vec<Part> {
    out.iter().map(|candidate| candidate.part).collect()
}

/// What cannot go because the rest is no scene without it, and why: first what no scene can lose alone, if another key
/// still needs its key.
fn blocked(base: &Base, out: &[Candidate]) -> Option<(usize, &'static str)> {
    if base.is_scene_without(&parts_of(out)) {
        return None;
    }
    let held = |part: Part| !base.is_scene_without(&[part]);
    let (held, free): (Vec<_>, Vec<_>) = parts_of(out).into_iter().partition(|part| held(*part));
    let needed = held.into_iter().find(|part| !base.is_scene_without(&[&free[..], &[*part]].concat()));
    let index = out.iter().position(|candidate| Some(candidate.part) == needed);
    Some((index.unwrap_or(out.len() - 1), "another key needs its key"))
}

/// Everything that the lean scene has not, in the order of the whole one.
fn left_out_of(whole: &Variant, kept: &[Part], out: &[Candidate]) -> Result<Vec<(Part, String)>, SceneError> {
    let forces = out.iter().filter(|candidate| matches!(candidate.part.what, What::Force(_)));
    let forces: Vec<Part> = forces.map(|candidate| candidate.part).collect();
    let gone = |part: &Part| match part.what {
        // The forces that stay are counted anew.
        What::Force(_) => forces.contains(part),
        _ => !kept.contains(part),
    };
    let why = |part: Part| {
        let candidate = out.iter().find(|candidate| candidate.part == part);
        candidate.map_or("nothing without the temperature".into(), |candidate| candidate.why.clone())
    };
    let parts = parts::parts(&whole.plan(0)?).into_iter().filter(gone);
    Ok(parts.map(|part| (part, why(part))).collect())
}

/// The lean scene as a file: the scene as resolved without what is left out, with comments that say so.
pub fn text(plan: &Plan, lean: &Lean, headline: &str) -> String {
    let resolved: Table = plan.resolved.parse().unwrap_or_default();
    let left_out: Vec<Part> = lean.left_out.iter().map(|(part, _)| *part).collect();
    let mut scene = parts::without(&resolved, &left_out);
    if !left_out.is_empty() {
        scene.insert("name".into(), format!("{}-lean", plan.name).into());
    }
    for sensor in &plan.sensors {
        let Some(Value::Table(table)) = scene.get_mut(sensor.kind.name()) else { continue };
        if left_out.iter().any(|part| part.sensor == Some(sensor.kind)) {
            let kept = lean.kept.iter().filter(|part| part.sensor == Some(sensor.kind));
            prune(table, sensor.kind, &kept.copied().collect::<Vec<_>>());
        }
    }
    let mut text: String = headline.lines().map(|line| format!("# {line}\n")).collect();
    let own = comments(lean, None);
    text += &own.iter().map(|line| format!("# {line}\n")).collect::<String>();
    let body = scene.to_string();
    for line in body.lines() {
        text += &format!("{line}\n");
        let of = plan.sensors.iter().find(|sensor| line == format!("[{}]", sensor.kind));
        let Some(sensor) = of else { continue };
        for comment in comments(lean, Some(sensor.kind)) {
            text += &format!("# {comment}\n");
        }
        if let Some(part) = sensor.part.filter(|_| !comments(lean, Some(sensor.kind)).is_empty()) {
            text += &format!("# the values of the {part}: `part` itself would bring back what is left out\n");
        }
    }
    text
}

/// A line for each reason.
fn comments(lean: &Lean, owner: Option<SensorKind>) -> Vec<String> {
    let mut lines: Vec<(String, Vec<String>)> = Vec::new();
    for (part, why) in lean.left_out.iter().filter(|(part, _)| part.sensor == owner) {
        match lines.iter_mut().find(|(known, _)| known == why) {
            Some((_, names)) => names.push(part.name()),
            None => lines.push((why.clone(), vec![part.name()])),
        }
    }
    lines.into_iter().map(|(why, names)| format!("left out, {why}: {}", names.join(", "))).collect()
}

/// Takes out the keys of a sensor that switch nothing on, so that what acts can be read.
fn prune(table: &mut Table, kind: SensorKind, kept: &[Part]) {
    let has = |name: &str| kept.iter().any(|part| part.is_term(name));
    let used = |name: &str| has(name) || (name == "bias_instability" && has("flicker"));
    for term in TERMS.into_iter().filter(|term| term.serves.contains(kind)) {
        for key in (term.keys)(kind) {
            let zero = key.default == Some("0") && zero(table, key.name);
            if !used(term.name) || zero {
                table.remove(key.name);
            }
        }
    }
    for (key, idle) in [("sampling", "point"), ("phase", "0 s")] {
        if table.get(key).and_then(Value::as_str) == Some(idle) {
            table.remove(key);
        }
    }
}

/// Whether a key says `0`, of whatever unit, as it does without being given.
fn zero(table: &Table, key: &str) -> bool {
    table.get(key).and_then(Value::as_str).is_some_and(|text| text.split_whitespace().next() == Some("0"))
}
