//! `[[fault]]`: what a sensor does wrong for a while, or how an output's packets are damaged or lost.

use super::document::Value;
use super::output::{Destination, Output};
use super::section::Section;
use crate::keys::{Key, Values};
use crate::quantity::Sign;
use crate::sensor::{self, SensorKind, SensorPlan};
use crate::time::SimTime;
use crate::wire;
use std::fmt;

/// Whose packets a fault concerns.
#[derive(Clone, Debug, PartialEq)]
enum On {
    /// Every output's.
    All,
    /// Those of one, counted from 0.
    Nth(usize),
    /// Those that go there.
    To(Destination),
}

/// A fault of outputs.
#[derive(Clone, Debug)]
pub struct OutputFault {
    on: On,
    fault: wire::PacketFault,
}

impl OutputFault {
    /// What goes wrong with the packets, and when.
    pub fn fault(&self) -> &wire::PacketFault {
        &self.fault
    }

    /// When it begins.
    pub fn start(&self) -> SimTime {
        self.fault.start
    }

    /// Whether it concerns the output, the `index`-th of a run.
    pub fn concerns(&self, index: usize, output: &Output) -> bool {
        let here = match &self.on {
            On::All => true,
            On::Nth(nth) => *nth == index,
            On::To(to) => *to == output.to,
        };
        // A file and a datagram have no pieces.
        here && (self.fault.kind != wire::PacketFaultKind::Split || output.to.address.is_stream())
    }

    /// Gives each output its faults; returns those that concern none.
    pub fn equip<'f>(faults: &'f [OutputFault], outputs: &mut [Output]) -> Vec<&'f OutputFault> {
        for (i, output) in outputs.iter_mut().enumerate() {
            let mine = faults.iter().filter(|fault| fault.concerns(i, output));
            output.faults = mine.map(|fault| fault.fault.clone()).collect();
        }
        let idle = |fault: &&OutputFault| !outputs.iter().enumerate().any(|(i, it)| fault.concerns(i, it));
        faults.iter().filter(idle).collect()
    }
}

impl fmt::Display for OutputFault {
    /// `drop from 2 s to 3 s of output 1`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.on {
            On::All => write!(f, "{} of every output", self.fault),
            On::Nth(nth) => write!(f, "{} of output {nth}", self.fault),
            On::To(to) => write!(f, "{} of output {to}", self.fault),
        }
    }
}

/// Every `[[fault]]` as resolved, and those of outputs.
#[derive(Default)]
pub(super) struct Faults {
    pub of_outputs: Vec<OutputFault>,
    pub resolved: Vec<toml::Value>,
}

/// Gives each fault to its sensor or its output. A scene without outputs is told at the start where to: its faults may
/// name any.
pub(super) fn faults(top: &Section<'_>, sensors: &mut [SensorPlan], outputs: &mut [Output]) -> Faults {
    let mut all = Faults::default();
    for section in top.tables("fault") {
        read(&section, sensors, outputs, &mut all.of_outputs);
        all.resolved.push(section.finish().into());
    }
    OutputFault::equip(&all.of_outputs, outputs);
    all
}

fn read(section: &Section<'_>, sensors: &mut [SensorPlan], outputs: &[Output], all: &mut Vec<OutputFault>) {
    let of_sensors = sensor::FaultKind::ALL.map(sensor::FaultKind::name);
    let of_outputs = wire::PacketFaultKind::ALL.map(wire::PacketFaultKind::name);
    if !section.has("kind") {
        section.lacks("a fault needs its kind, such as kind = \"stuck\"".into());
        return section.allow_everything();
    }
    let kind = section.word("kind", &[&of_sensors[..], &of_outputs].concat(), "off");
    if let Some(kind) = wire::PacketFaultKind::ALL.into_iter().find(|known| known.name() == kind) {
        if section.has_quietly("sensor") {
            let kind = kind.name();
            section.mistake("sensor", format!("{kind} is a packet fault: name an `output` or leave it out"));
            return section.allow_everything();
        }
        all.extend(of_output(section, kind, outputs));
    } else if let Some(kind) = sensor::FaultKind::ALL.into_iter().find(|known| known.name() == kind) {
        if section.has_quietly("output") {
            let (kind, kinds) = (kind.name(), of_outputs.join(", "));
            section.mistake("output", format!("{kind} is a sensor fault; the packet faults are {kinds}"));
            return section.allow_everything();
        }
        of_sensor(section, kind, sensors);
    }
}

fn of_sensor(section: &Section<'_>, kind: sensor::FaultKind, sensors: &mut [SensorPlan]) {
    if !section.has("sensor") {
        section.lacks("a fault needs its sensor, such as sensor = \"gyro\"".into());
        return section.allow_everything();
    }
    let name = section.word("sensor", &SensorKind::ALL.map(SensorKind::name), "gyro");
    let Some(sensor) = SensorKind::ALL.into_iter().find(|known| known.name() == name) else { return };
    let Some(When { start, end, values }) = when(section, &kind.keys(sensor)) else { return };
    let fault = sensor::Fault { kind, start, end, values };
    match sensors.iter_mut().find(|plan| plan.kind == sensor) {
        Some(plan) => {
            if let Err(error) = fault.check(sensor, plan.values.get(sensor::RANGE)) {
                section.mistake(error.key, &error.message);
            }
            plan.faults.push(fault);
        }
        None => section.mistake("sensor", format!("the scene has no {sensor} for this fault")),
    }
}

fn of_output(section: &Section<'_>, kind: wire::PacketFaultKind, outputs: &[Output]) -> Option<OutputFault> {
    let on = on(section);
    let When { start, end, values } = when(section, &kind.keys())?;
    let fault = OutputFault { on: on?, fault: wire::PacketFault { kind, start, end, values } };
    if let Err(error) = fault.fault.check() {
        section.mistake(error.key, &error.message);
    }
    if !outputs.is_empty() && !outputs.iter().enumerate().any(|(i, output)| fault.concerns(i, output)) {
        let list = outputs.iter().enumerate().map(|(i, output)| format!("{i} \"{}\"", output.to));
        let list = list.collect::<Vec<_>>().join(", ");
        let why = if kind == wire::PacketFaultKind::Split { " that is sent in pieces" } else { "" };
        section.mistake("output", format!("matches none of the scene's outputs{why}, which are {list}"));
    }
    Some(fault)
}

/// Every output, unless one is named.
fn on(section: &Section<'_>) -> Option<On> {
    match section.entry("output").map(|entry| &entry.node.value) {
        None => Some(On::All),
        Some(Value::Integer(_)) => Some(On::Nth(section.whole("output", 0) as usize)),
        Some(Value::Text(_)) => {
            let to = section.text("output", None)?.parse();
            to.map(On::To).map_err(|error: String| section.mistake("output", error)).ok()
        }
        Some(other) => {
            let is = other.what();
            section.mistake("output", format!("is {is}; write its `to`, or its number in the scene, from 0"));
            None
        }
    }
}

/// What every fault has: its times and the values of its kind's keys.
struct When {
    start: SimTime,
    end: SimTime,
    values: Values,
}

fn when(section: &Section<'_>, keys: &[Key]) -> Option<When> {
    let start = section.time("start", Some("0 s"), Sign::NonNegative);
    let duration = section.has("duration").then(|| section.time("duration", None, Sign::Positive));
    let values = section.values(keys, true);
    if section.unread(keys, &values) {
        return None;
    }
    let start = start?;
    let end = match duration {
        Some(duration) => SimTime(start.0.saturating_add(duration?.0)),
        None => SimTime::FOREVER,
    };
    Some(When { start, end, values })
}
