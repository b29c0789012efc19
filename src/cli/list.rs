//! `ratetable list`: everything available, or one entry in full.

mod fields;
pub(super) mod formats;
mod keys;
mod logs;
mod parts;

use super::terminal::Stream;
use super::{Refusal, Verdict, say};
use crate::link;
use crate::motion::method::{METHODS, MethodKind};
use crate::scene::{TARGETS, Target, builtin, nearest};
use crate::wire::Protocol;
use clap::ValueEnum;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Which list (default: all)
    what: Option<What>,
    /// One entry in full, such as `list parts MPU-9250` or `list keys gyro.bias`
    #[arg(requires = "what")]
    name: Option<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum What {
    /// Built-in scenes; with a name, the scene's file, to copy
    Scenes,
    /// Sensors with datasheet values; with a name, each value with its unit and source
    Parts,
    /// Kinds of motion and their keys
    Motions,
    /// Attitude integration methods, for `[reference]` and `study`
    Methods,
    /// Every key of a scene file: its values, unit, range and default
    Keys,
    /// Packet protocols
    Protocols,
    /// Flight controllers by name, with the settings of each
    Targets,
    /// Where packets go
    Links,
    /// Dataset formats, including those not in this build
    Formats,
    /// Report fields that `--limit` accepts for each command, with units
    Fields,
    /// Kinds of file that `score` and the motion `replay` read
    Logs,
    /// Serial ports of this machine
    Ports,
}

/// One thing of a list.
pub struct Item {
    /// Its names; the first is the main one.
    names: Vec<String>,
    /// Its text in the whole list.
    brief: Brief,
    /// Its text alone.
    whole: String,
}

/// A thing's text in a list.
pub enum Brief {
    /// A row of the list's table.
    Row(Vec<String>),
    /// Lines of its own.
    Lines(String),
}

/// A list: the heading of its table, if it has one, its things, and what stands below.
pub struct List {
    heading: Vec<&'static str>,
    items: Vec<Item>,
    below: String,
}

impl List {
    /// A table of which a row says all there is.
    fn of_rows(heading: &[&'static str], rows: Vec<Vec<String>>) -> List {
        let item = |row: Vec<String>| Item {
            names: row.first().cloned().into_iter().collect(),
            whole: whole(heading, &row),
            brief: Brief::Row(row),
        };
        List { heading: heading.to_vec(), items: rows.into_iter().map(item).collect(), below: String::new() }
    }

    /// Things of several lines, the same alone as among others.
    fn of_lines(items: impl IntoIterator<Item = (Vec<String>, String)>) -> List {
        let item = |(names, lines): (Vec<String>, String)| Item {
            names,
            brief: Brief::Lines(lines.clone()),
            whole: lines,
        };
        List { heading: Vec::new(), items: items.into_iter().map(item).collect(), below: String::new() }
    }

    /// Everything.
    fn text(&self) -> String {
        let mut text = String::new();
        let rows = self.items.iter().filter_map(|item| match &item.brief {
            Brief::Row(row) => Some(row.clone()),
            Brief::Lines(_) => None,
        });
        let rows: Vec<_> = rows.collect();
        if !rows.is_empty() {
            text += &Stream::Out.table(&self.heading, &rows);
        }
        for item in &self.items {
            if let Brief::Lines(lines) = &item.brief {
                text += &Stream::Out.fold(lines);
            }
        }
        text + &Stream::Out.fold(&self.below)
    }
}

/// A row alone: a line a column.
fn whole(heading: &[&str], row: &[String]) -> String {
    heading.iter().zip(row).map(|(heading, cell)| format!("{heading}: {cell}\n")).collect()
}

pub fn list(arguments: &Arguments) -> Result<Verdict, Refusal> {
    match (arguments.what, &arguments.name) {
        (None, _) => {
            for what in What::value_variants() {
                let body: String = list_of(*what)?.text().lines().map(|line| indented(line) + "\n").collect();
                say(&format!("{}\n{body}", name_of(*what)))?;
            }
        }
        (Some(what), None) => say(&list_of(what)?.text())?,
        (Some(what), Some(name)) => say(&one(what, name)?)?,
    }
    Ok(Verdict::Fine)
}

fn indented(line: &str) -> String {
    format!("  {line}").trim_end().to_string()
}

fn name_of(what: What) -> String {
    what.to_possible_value().map_or(String::new(), |value| value.get_name().to_string())
}

/// Everything known of one thing; names ignore case.
fn one(what: What, name: &str) -> Result<String, Refusal> {
    let list = list_of(what)?;
    let named = |item: &&Item| item.names.iter().any(|known| known.eq_ignore_ascii_case(name));
    if let Some(item) = list.items.iter().find(named) {
        // A scene is a file, which is to be copied as it is.
        return Ok(if what == What::Scenes { item.whole.clone() } else { Stream::Out.fold(&item.whole) });
    }
    let names = || list.items.iter().flat_map(|item| item.names.iter().map(String::as_str));
    let near = nearest(name, names()).map_or(String::new(), |near| format!("; did you mean `{near}`?"));
    let mut firsts: Vec<_> = list.items.iter().filter_map(|item| item.names.first()).cloned().collect();
    firsts.dedup();
    let there = match firsts.len() {
        0 => "there are none".to_string(),
        n if n > MOST_NAMES => format!("`ratetable list {}` shows them", name_of(what)),
        _ => format!("there are {}", firsts.join(", ")),
    };
    Err(Refusal(format!("`{name}` is not one of the {}: {there}{near}", name_of(what))))
}

/// A message lists at most this many names.
const MOST_NAMES: usize = 40;

fn list_of(what: What) -> Result<List, Refusal> {
    Ok(match what {
        What::Scenes => scenes(),
        What::Parts => parts::list()?,
        What::Motions => keys::motions(),
        What::Methods => methods(),
        What::Keys => keys::list(),
        What::Protocols => {
            let row = |protocol: Protocol| vec![protocol.name().into(), protocol.about().into()];
            List::of_rows(&["name", "about"], Protocol::ALL.map(row).to_vec())
        }
        What::Targets => targets(),
        What::Links => {
            let row = |scheme: &link::Scheme| vec![scheme.spelling.into(), scheme.about.into()];
            let mut list =
                List::of_rows(&["spelled", "about"], link::SCHEMES.iter().map(row).collect::<Vec<_>>());
            for (item, scheme) in list.items.iter_mut().zip(link::SCHEMES.iter()) {
                item.names.push(scheme.name.to_string());
            }
            list
        }
        What::Formats => formats::list(),
        What::Fields => fields::list()?,
        What::Logs => logs::list(),
        What::Ports => ports(),
    })
}

fn scenes() -> List {
    let item = |(name, text): (&str, &str)| Item {
        names: vec![name.to_string()],
        brief: Brief::Row(vec![name.into(), builtin::about(text).into()]),
        whole: text.to_string(),
    };
    let items = builtin::SCENES.map(item).into();
    List {
        heading: vec!["name", "about"],
        items,
        below: "a scene's file, to copy: ratetable list scenes NAME\n".into(),
    }
}

/// Flight controllers, each with what its name sets.
fn targets() -> List {
    List::of_lines(TARGETS.iter().map(|target: &Target| {
        let mut lines = format!("{}: {}\n", target.name, target.about);
        target.expansion().iter().for_each(|line| lines += &format!("  {line}\n"));
        (vec![target.name.to_string()], lines)
    }))
}

fn methods() -> List {
    let row = |method: &MethodKind| {
        let precisions: Vec<_> = method.precisions.iter().map(|precision| precision.name()).collect();
        vec![
            method.name.into(),
            method.order.to_string(),
            method.input.to_string(),
            precisions.join(", "),
            method.ns_per_step.to_string(),
            method.about.into(),
        ]
    };
    let heading = ["name", "order", "input a step", "studied in", "ns a step", "about"];
    List::of_rows(&heading, METHODS.iter().map(|method| row(method)).collect())
}

fn ports() -> List {
    let ports = link::ports();
    let known = |text: Option<String>| text.unwrap_or_else(|| "-".into());
    let rows = ports.into_iter().map(|port| {
        vec![port.path.display().to_string(), known(port.product), known(port.manufacturer), port.command]
    });
    let mut list = List::of_rows(&["port", "product", "manufacturer", "try"], rows.collect());
    if list.items.is_empty() {
        list.below =
            "no serial port found; a pty needs no hardware: ratetable run SCENE --to mpu@pty\n".to_string();
    }
    list
}
