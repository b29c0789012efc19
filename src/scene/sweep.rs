//! `[sweep]`: keys that differ from run to run of one scene.
//!
//! ```toml
//! [sweep]
//! gyro.noise_std = ["0.001 rad/s", "0.002 rad/s"]            # every combination of the lists in turn
//! earth.gravity = { uniform = ["9.78 m/s^2", "9.83 m/s^2"] }  # drawn for each run
//! ```

use super::document::{Entry, Location, Mistake, Node, Table, Value};
use super::{Plan, SceneError, source};
use crate::random;
use rand::RngExt;

/// What a key of `[sweep]` takes.
#[derive(Clone, Debug)]
enum Takes {
    /// One after another.
    List(Vec<Node>),
    /// Between two ends, both in this unit.
    Uniform { low: f64, high: f64, unit: String },
}

/// A key that differs from run to run.
#[derive(Clone, Debug)]
struct Swept {
    key: String,
    place: Location,
    takes: Takes,
}

/// The value that a run's swept key has, as a scene would write it without quotation marks.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct SweptValue {
    /// Such as `gyro.noise_std`.
    pub key: String,
    /// Such as `0.001 rad/s`.
    pub value: String,
}

/// What a key of `[sweep]` takes from run to run, as written.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct SweptKey {
    /// Such as `gyro.noise_std`.
    pub key: String,
    /// Each value of a list in turn, or the two ends between which each run draws its own.
    pub values: Vec<String>,
    /// Whether it is drawn.
    pub drawn: bool,
}

/// A scene of which many runs are made: run i is the scene with a seed of its own, derived from the scene's seed and
/// i, and with its share of what `[sweep]` says. It depends on nothing else, so that runs may be made in any order,
/// anywhere.
#[derive(Clone, Debug)]
pub struct Runs {
    table: Table,
    source: String,
    name: String,
    seed: u64,
    swept: Vec<Swept>,
}

impl Runs {
    /// Reads a scene as [`Plan::load`] does and checks every value of its `[sweep]`.
    ///
    /// # Errors
    /// No such scene, or every mistake in it.
    pub fn load(scene: &str, sets: &[String]) -> Result<Runs, SceneError> {
        let (text, source, name) = source(scene)?;
        Runs::parse(&text, &source, &name, sets)
    }

    /// Reads a scene's text, as [`Plan::parse`] does.
    ///
    /// # Errors
    /// Every mistake in it.
    pub fn parse(text: &str, source: &str, name: &str, sets: &[String]) -> Result<Runs, SceneError> {
        let one = |mistake| SceneError { mistakes: vec![mistake] };
        let mut table = Table::parse(text, source).map_err(one)?;
        for set in sets {
            table.set(set).map_err(one)?;
        }
        let plan = Plan::of(table.clone(), source, name)?;
        let mut swept = Vec::new();
        if let Some(entry) = table.get("sweep") {
            swept = read(entry).map_err(|mistakes| SceneError { mistakes })?;
            table.entries.retain(|entry| entry.key != "sweep");
        }
        let runs = Runs { table, source: source.into(), name: name.into(), seed: plan.seed, swept };
        runs.check()?;
        Ok(runs)
    }

    /// The keys that differ, in the order written.
    pub fn keys(&self) -> impl Iterator<Item = &str> {
        self.swept.iter().map(|swept| &swept.key[..])
    }

    /// What each key takes, in the order written.
    pub fn swept(&self) -> impl Iterator<Item = SweptKey> {
        self.swept.iter().map(|swept| SweptKey {
            key: swept.key.clone(),
            values: swept.ends().iter().map(|node| text(&node.value)).collect(),
            drawn: matches!(swept.takes, Takes::Uniform { .. }),
        })
    }

    /// How many combinations the lists have; 1 without any.
    pub fn combinations(&self) -> u64 {
        combinations(&self.swept).unwrap_or_else(|| unreachable!("counted when read"))
    }

    /// The seed of run `index`, and the values of its swept keys. Beyond the last combination the lists begin again.
    pub fn settings(&self, index: u64) -> (u64, Vec<SweptValue>) {
        let (seed, nodes) = self.nodes(index);
        let swept = self.swept.iter().zip(nodes);
        (
            seed,
            swept
                .map(|(swept, node)| SweptValue { key: swept.key.clone(), value: text(&node.value) })
                .collect(),
        )
    }

    /// The plan of run `index`.
    ///
    /// # Errors
    /// Every mistake that its values make of the scene together.
    pub fn plan(&self, index: u64) -> Result<Plan, SceneError> {
        let (seed, nodes) = self.nodes(index);
        let mut table = self.table.clone();
        let place = Location::whole(&self.source);
        let seed = ("seed", Node::new(Value::Integer(seed.into()), place));
        for (key, node) in self.keys().zip(nodes).chain([seed]) {
            table.put(key, node).map_err(|mistake| SceneError { mistakes: vec![mistake] })?;
        }
        Plan::of(table, &self.source, &self.name)
    }

    fn nodes(&self, index: u64) -> (u64, Vec<Node>) {
        // A seed is a whole number of TOML, which has 63 bits and a sign.
        let seed = random::stream(self.seed, &format!("run/{index}")).random::<u64>() >> 1;
        let mut rest = index % self.combinations();
        // The last key changes with every run.
        let mut nodes: Vec<_> = self.swept.iter().rev().map(|swept| swept.node(seed, &mut rest)).collect();
        nodes.reverse();
        (seed, nodes)
    }

    /// Each value by itself in the scene, so that a mistake shows before a thousand runs are made.
    fn check(&self) -> Result<(), SceneError> {
        let mut mistakes = Vec::new();
        for swept in &self.swept {
            for node in swept.ends() {
                let mut table = self.table.clone();
                let plan =
                    table.put(&swept.key, node).map_err(|mistake| SceneError { mistakes: vec![mistake] });
                if let Err(error) = plan.and_then(|()| Plan::of(table, &self.source, &self.name)) {
                    mistakes.extend(error.mistakes);
                }
            }
        }
        mistakes.dedup();
        if mistakes.is_empty() { Ok(()) } else { Err(SceneError { mistakes }) }
    }
}

impl Takes {
    fn length(&self) -> u64 {
        match self {
            Takes::List(nodes) => nodes.len() as u64,
            Takes::Uniform { .. } => 1,
        }
    }
}

impl Swept {
    /// The value of a run with this seed; `rest` counts the combinations of this key and those before it.
    fn node(&self, seed: u64, rest: &mut u64) -> Node {
        match &self.takes {
            Takes::List(nodes) => {
                let length = nodes.len() as u64;
                let node = nodes[(*rest % length) as usize].clone();
                *rest /= length;
                node
            }
            Takes::Uniform { low, high, unit } => {
                let u: f64 = random::stream(seed, &format!("sweep/{}", self.key)).random();
                self.quantity(low + (high - low) * u, unit)
            }
        }
    }

    /// Every value that it may have, or the ends of them.
    fn ends(&self) -> Vec<Node> {
        match &self.takes {
            Takes::List(nodes) => nodes.clone(),
            Takes::Uniform { low, high, unit } => {
                [*low, *high].map(|value| self.quantity(value, unit)).into()
            }
        }
    }

    fn quantity(&self, value: f64, unit: &str) -> Node {
        Node::new(Value::Text(format!("{value} {unit}").trim_end().into()), self.place.clone())
    }
}

/// The keys of `[sweep]`.
pub(super) fn check(entry: &Entry) -> Vec<Mistake> {
    read(entry).err().unwrap_or_default()
}

fn read(sweep: &Entry) -> Result<Vec<Swept>, Vec<Mistake>> {
    let Value::Table(table) = &sweep.node.value else {
        let message = format!("`sweep` is {}; write it as one table, [sweep]", sweep.node.value.what());
        return Err(vec![Mistake { place: sweep.node.place.clone(), message }]);
    };
    let (mut swept, mut mistakes) = (Vec::new(), Vec::new());
    for (key, node) in flat("", table) {
        match takes(&key, node) {
            Ok(takes) => swept.push(Swept { key, place: node.place.clone(), takes }),
            Err(message) => mistakes.push(Mistake { place: node.place.clone(), message }),
        }
    }
    if mistakes.is_empty() && combinations(&swept).is_none() {
        let factors: Vec<_> = swept.iter().map(|swept| swept.takes.length().to_string()).collect();
        let message = format!(
            "the lists have {} combinations, more than 64 bits can count: sweep fewer keys, or draw some of them, {{ uniform = [low, high] }}",
            factors.join(" x ")
        );
        mistakes.push(Mistake { place: sweep.node.place.clone(), message });
    }
    if mistakes.is_empty() { Ok(swept) } else { Err(mistakes) }
}

/// How many combinations the lists have; nothing beyond the range of numbers.
fn combinations(swept: &[Swept]) -> Option<u64> {
    swept.iter().try_fold(1, |all: u64, swept| all.checked_mul(swept.takes.length()))
}

/// Keys by their dotted paths: `"gyro.rate" = […]` and `gyro.rate = […]`, which TOML takes for a table, are one thing.
fn flat<'a>(path: &str, table: &'a Table) -> Vec<(String, &'a Node)> {
    let below = |entry: &'a Entry| {
        let path = format!("{path}{}", entry.key);
        match &entry.node.value {
            Value::Table(table) if !DISTRIBUTIONS.iter().any(|shape| table.get(shape).is_some()) => {
                flat(&format!("{path}."), table)
            }
            _ => vec![(path, &entry.node)],
        }
    };
    table.entries.iter().flat_map(below).collect()
}

/// What scenes draw from elsewhere; here only the first.
const DISTRIBUTIONS: [&str; 2] = ["uniform", "normal"];

fn takes(key: &str, node: &Node) -> Result<Takes, String> {
    if key == "seed" || key.starts_with("sweep") {
        return Err(format!("`{key}` cannot be swept: each run has its own seed"));
    }
    let plain = "write a list, [\"1 kHz\", \"2 kHz\"], or { uniform = [low, high] }";
    match &node.value {
        Value::Array(nodes) if !nodes.is_empty() => Ok(Takes::List(nodes.clone())),
        Value::Array(_) => Err(format!("`{key}` has no values: {plain}")),
        Value::Table(table) => uniform(table).ok_or_else(|| {
            format!("`{key}` takes {{ uniform = [low, high] }}: two numbers with the same unit, the lower first, such as {{ uniform = [\"1 deg/s\", \"2 deg/s\"] }}")
        }),
        other => Err(format!("`{key}` is {}: {plain}", other.what())),
    }
}

fn uniform(table: &Table) -> Option<Takes> {
    let [Entry { key: shape, node: Node { value: Value::Array(ends), .. }, .. }] = &table.entries[..] else {
        return None;
    };
    let [low, high] = &ends[..] else { return None };
    let ((low, unit), (high, other)) = (number(low)?, number(high)?);
    let right = shape == DISTRIBUTIONS[0] && unit == other && low <= high;
    right.then_some(Takes::Uniform { low, high, unit })
}

/// A number and what stands behind it.
fn number(node: &Node) -> Option<(f64, String)> {
    let Value::Text(text) = &node.value else { return None };
    let ends = text.char_indices().map(|(i, _)| i).chain([text.len()]).rev();
    let split = |at: usize| Some((text[..at].trim().parse::<f64>().ok()?, text[at..].trim().to_string()));
    ends.into_iter().find_map(split).filter(|(value, _)| value.is_finite())
}

/// As a scene writes it, a string without its quotation marks.
fn text(value: &Value) -> String {
    let list = |nodes: &[Node]| nodes.iter().map(|node| text(&node.value)).collect::<Vec<_>>().join(", ");
    match value {
        Value::Text(text) | Value::Float(text) | Value::Date(text) => text.clone(),
        Value::Integer(number) => number.to_string(),
        Value::Boolean(flag) => flag.to_string(),
        Value::Array(nodes) => format!("[{}]", list(nodes)),
        Value::Table(table) => {
            let entry = |entry: &Entry| format!("{} = {}", entry.key, text(&entry.node.value));
            format!("{{ {} }}", table.entries.iter().map(entry).collect::<Vec<_>>().join(", "))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    fn runs(sweep: &str) -> Result<Runs, SceneError> {
        let scene = format!("seed = 5\nduration = \"1 s\"\n[gyro]\nrate = \"100 Hz\"\n[sweep]\n{sweep}");
        Runs::parse(&scene, "test", "test", &[])
    }

    #[test]
    fn lists_give_every_combination_once_and_then_begin_again() {
        let runs = runs("\"gyro.noise_std\" = [\"1 mrad/s\", \"2 mrad/s\"]\n\"gyro.rate\" = [\"50 Hz\", \"60 Hz\", \"70 Hz\"]\n").unwrap();
        assert_eq!(runs.combinations(), 6);
        let values = |index| runs.settings(index).1.into_iter().map(|it| it.value).collect::<Vec<_>>();
        assert_eq!((0..6).map(values).collect::<BTreeSet<_>>().len(), 6);
        assert_eq!(values(1), ["1 mrad/s", "60 Hz"]);
        assert_eq!(values(7), values(1));
        assert_ne!(runs.settings(7).0, runs.settings(1).0);
        let plan = runs.plan(5).unwrap();
        assert_eq!(plan.sensors[0].rate.as_hz(), 70.0);
        assert!(plan.resolved.contains("2 mrad/s") && !plan.resolved.contains("sweep"), "{}", plan.resolved);
        assert_eq!(plan.seed, runs.settings(5).0);
        let dotted = Runs::parse(
            "duration = \"1 s\"\nseed = 5\n[gyro]\nrate = \"1 Hz\"\n[sweep]\ngyro.noise_std = [\"1 mrad/s\", \"2 mrad/s\"]\ngyro.rate = [\"50 Hz\", \"60 Hz\", \"70 Hz\"]\n",
            "test",
            "test",
            &[],
        );
        assert_eq!(dotted.unwrap().settings(5), runs.settings(5));
    }

    #[test]
    fn drawn_values_fill_their_interval_evenly_and_belong_to_their_run() {
        let drawn = "\"gyro.noise_std\" = { uniform = [\"1 deg/s\", \"3 deg/s\"] }\n";
        let (one, two) =
            (runs(drawn).unwrap(), runs(&format!("\"gyro.phase\" = [\"0 s\", \"1 ms\"]\n{drawn}")).unwrap());
        let n = 4000;
        let draw = |runs: &Runs, i| -> f64 {
            let value = runs.settings(i).1.pop().unwrap().value;
            value.strip_suffix(" deg/s").unwrap().parse().unwrap()
        };
        let values: Vec<f64> = (0..n).map(|i| draw(&one, i)).collect();
        assert!(values.iter().all(|x| (1.0..=3.0).contains(x)));
        // Mean and variance of a uniform distribution, within 4 standard errors.
        let mean = values.iter().sum::<f64>() / n as f64;
        let variance = values.iter().map(|x| (x - 2.0).powi(2)).sum::<f64>() / n as f64;
        assert!((mean - 2.0).abs() < 4.0 * (1.0 / 3.0f64 / n as f64).sqrt(), "{mean}");
        assert!(
            (variance - 1.0 / 3.0).abs() < 4.0 * ((1.0 / 5.0 - 1.0 / 9.0) / n as f64).sqrt(),
            "{variance}"
        );
        let neighbours =
            values.windows(2).map(|pair| (pair[0] - 2.0) * (pair[1] - 2.0)).sum::<f64>() / n as f64;
        assert!(neighbours.abs() < 4.0 / 3.0 / (n as f64).sqrt(), "{neighbours}");
        assert!((0..20).all(|i| draw(&one, i) == draw(&two, i)), "another key changes no drawn value");
    }

    /// So many lists of so many values.
    fn too_many(lists: usize, length: usize) -> String {
        let values = vec!["\"1 deg/s\""; length].join(", ");
        (0..lists).map(|i| format!("\"gyro.key_{i}\" = [{values}]\n")).collect()
    }

    #[test]
    fn as_many_combinations_as_can_be_counted_are_read() {
        let lists = too_many(63, 2);
        let document = format!("[sweep]\n{lists}");
        let table = Table::parse(&document, "test").unwrap();
        let swept = read(table.get("sweep").unwrap()).unwrap();
        assert_eq!(combinations(&swept), Some(1 << 63));
    }

    #[test]
    fn every_mistake_says_where_and_what_would_be_right() {
        for (sweep, place, says) in [
            ("\"gyro.noise_std\" = \"1 deg/s\"\n", "test:6:20", "write a list"),
            ("\"gyro.noise_std\" = []\n", "test:6:20", "no values"),
            ("\"gyro.noise_std\" = { uniform = [\"1 deg/s\", \"2 rad/s\"] }\n", "test:6:20", "the same unit"),
            ("\"gyro.noise_std\" = [\"1 deg/s\", \"2 m/s\"]\n", "test:6:35", "2 m/s"),
            ("\"gyro.nois_std\" = [\"1 deg/s\"]\n", "test:6:20", "noise_std"),
            ("gyro.noise_std = { normal = [\"1 deg/s\", \"2 deg/s\"] }\n", "test:6:18", "uniform"),
            ("seed = [1, 2]\n", "test:6:8", "cannot be swept"),
            (&too_many(64, 2), "test:5:1", "2 x 2 x"),
            (&too_many(16, 16), "test:5:1", "64 bits"),
        ] {
            let said = runs(sweep).unwrap_err().to_string();
            assert!(said.contains(says) && said.contains(&place[..6]), "{sweep}{said}");
            if says != "noise_std" && says != "2 m/s" {
                assert!(said.starts_with(place), "{sweep}{said}");
            }
        }
        let two = runs("\"gyro.rate\" = [\"fast\"]\n\"gyro.range\" = [\"1 m\"]\n").unwrap_err();
        assert_eq!(two.mistakes.len(), 2, "{two}");
    }
}
