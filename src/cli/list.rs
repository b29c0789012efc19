//! `ratetable list`: what there is.

use super::{Refusal, Verdict, say};
use crate::keys::{Key, Takes};
use crate::motion::method::{METHODS, MethodKind};
use crate::report::table;
use crate::scene::parts::{Filter, OutputRate, Scale, Settings};
use crate::scene::{self, builtin};
use crate::sensor::{self, SensorKind, parts};
use crate::wire::Protocol;
use crate::{link, motion};
use clap::ValueEnum;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Which list; all of them without it
    what: Option<What>,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum What {
    /// Built-in scenes
    Scenes,
    /// Sensors known by their datasheet, each value with its source
    Parts,
    /// Kinds of motion and their keys
    Motions,
    /// Ways to step attitude, for `[reference]` and `study`
    Methods,
    /// Every key of a scene file
    Keys,
    /// What packets look like
    Protocols,
    /// Where packets go
    Links,
    /// Serial ports of this machine
    Ports,
}

pub fn list(arguments: &Arguments) -> Result<Verdict, Refusal> {
    for what in What::value_variants() {
        if arguments.what.is_none_or(|asked| asked == *what) {
            let name = what.to_possible_value().map_or(String::new(), |value| value.get_name().to_string());
            let heading = if arguments.what.is_none() { format!("{name}\n") } else { String::new() };
            let indent = if arguments.what.is_none() { "  " } else { "" };
            let body = body(*what)?;
            let lines: String =
                body.lines().map(|line| format!("{}\n", format!("{indent}{line}").trim_end())).collect();
            say(&format!("{heading}{lines}"))?;
        }
    }
    Ok(Verdict::Fine)
}

fn body(what: What) -> Result<String, Refusal> {
    Ok(match what {
        What::Scenes => table(
            &["name", "about"],
            &builtin::SCENES.map(|(name, text)| vec![name.into(), builtin::about(text).into()]),
        ),
        What::Parts => parts()?,
        What::Motions => motions(),
        What::Methods => methods(),
        What::Keys => keys(),
        What::Protocols => {
            let row = |protocol: Protocol| vec![protocol.name().into(), protocol.about().into()];
            table(&["name", "about"], &Protocol::ALL.map(row)) + "\n" + &targets()
        }
        What::Links => {
            let row = |scheme: &link::Scheme| vec![scheme.spelling.into(), scheme.about.into()];
            table(&["spelled", "about"], &link::SCHEMES.iter().map(row).collect::<Vec<_>>())
        }
        What::Ports => ports(),
    })
}

/// Flight controllers, each with what its name stands for.
fn targets() -> String {
    let mut text = "targets: a flight controller's name in place of a protocol\n".to_string();
    for target in &scene::TARGETS {
        text += &format!("{}: {}\n", target.name, target.about);
        target.expansion().iter().for_each(|line| text += &format!("  {line}\n"));
    }
    text
}

fn parts() -> Result<String, Refusal> {
    let mut text = String::new();
    for part in parts::all() {
        text += &format!("{}: {}\n", part.names.join(", "), part.about);
        for value in scene::parts::sources(part).map_err(|mistake| Refusal(mistake.to_string()))? {
            text += &format!("  {} {} = {}\n      {}\n", value.sensor, value.key, value.value, value.source);
        }
        for kind in SensorKind::ALL {
            let settings =
                scene::parts::settings(part, kind).map_err(|mistake| Refusal(mistake.to_string()))?;
            text += &choices(kind, &settings);
        }
    }
    Ok(text)
}

/// What a sensor of a part can be set to.
fn choices(kind: SensorKind, settings: &Settings) -> String {
    let mut text = String::new();
    for (name, source) in &settings.sources {
        let choices = match *name {
            "scales" => settings.scales.iter().map(Scale::to_string).collect(),
            "rates" => settings.rates.iter().map(OutputRate::to_string).collect(),
            _ => settings.filters.iter().map(Filter::to_string).collect::<Vec<_>>(),
        };
        text += &format!("  {kind} {name}: {}\n      {source}\n", choices.join("; "));
    }
    text
}

/// Every table and key of a scene.
fn keys() -> String {
    let mut text = String::new();
    let mut table = None;
    for (of, key, about) in scene::FIXED_KEYS {
        if table != Some(of) {
            let name = if of.is_empty() { "(the scene itself)".to_string() } else { format!("[{of}]") };
            text += &format!("{name}\n");
            table = Some(of);
        }
        text += &format!("  {key}: {about}\n");
    }
    for sensor in SensorKind::ALL {
        text += &format!("[{sensor}]\n");
        for (key, about) in scene::SENSOR_KEYS.iter().filter(|(key, _)| scene::takes(sensor, key)) {
            text += &format!("  {key}: {about}\n");
        }
        sensor::keys(sensor).iter().for_each(|key| text += &declared(key));
    }
    text
}

/// A declared key with what it takes.
fn declared(key: &Key) -> String {
    let takes = match key.takes {
        Takes::Scalar(kind)
        | Takes::PerAxis(kind)
        | Takes::BodyVector(kind)
        | Takes::NavVector(kind)
        | Takes::OneAxis(kind)
        | Takes::Resolution(kind) => {
            format!("{}, such as \"{}\"", kind.name(), kind.example())
        }
        Takes::Duration => "time, such as \"2 s\"".into(),
        Takes::Word(words) => words.join(" or "),
        Takes::Keyframes => "an array, such as [{ t = \"2 s\", attitude = \"[0, 30, 0] deg\" }]".into(),
        Takes::File => "a path, relative to the scene's folder".into(),
        Takes::Matrix(kind) => {
            format!(
                "{}, one number, a vector (the diagonal) or three rows, such as \"{}\"",
                kind.name(),
                kind.example()
            )
        }
        Takes::Flag => "true or false".into(),
        Takes::Whole(least, most) => format!("a whole number from {least} to {most}"),
        Takes::Table(nested) => {
            format!("a table{}, such as {}", if nested.many { " or several" } else { "" }, nested.example)
        }
        Takes::Columns(columns) => format!("columns, such as {}", columns.example()),
    };
    let default = key.default.map_or(String::new(), |default| format!(" (default {default})"));
    format!("  {}: {}; {takes}{default}\n", key.name, key.about)
}

fn motions() -> String {
    let mut text = String::new();
    for kind in motion::KINDS {
        text += &format!("{}: {}\n", kind.name, kind.about);
        kind.keys.iter().for_each(|key| text += &declared(key));
    }
    text
}

fn methods() -> String {
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
    table(&["name", "order", "input a step", "studied in", "ns a step", "about"], &METHODS.map(row))
}

fn ports() -> String {
    let ports = link::ports();
    if ports.is_empty() {
        return "no serial port was found; a pty needs none: ratetable run SCENE --to mpu@pty\n".into();
    }
    let known = |text: Option<String>| text.unwrap_or_else(|| "-".into());
    let rows = ports.into_iter().map(|port| {
        vec![port.path.display().to_string(), known(port.product), known(port.manufacturer), port.command]
    });
    table(&["port", "product", "manufacturer", "try"], &rows.collect::<Vec<_>>())
}
