//! `[[output]]`: where the scene sends its packets.

use super::section::Section;
use super::suggest;
use crate::link::Address;
use crate::sensor::SensorPlan;
use crate::wire::{self, Layout, Protocol};
use std::fmt;
use std::str::FromStr;

/// `PROTOCOL@LINK`.
#[derive(Clone, Debug, PartialEq)]
pub struct Destination {
    /// What the packets look like.
    pub protocol: Protocol,
    /// Where they go.
    pub address: Address,
}

impl FromStr for Destination {
    type Err = String;

    fn from_str(text: &str) -> Result<Destination, String> {
        let names = Protocol::ALL.map(Protocol::name);
        let Some((protocol, address)) = text.split_once('@') else {
            return Err(format!(
                "`{text}` is no PROTOCOL@LINK: write, for example, mpu@pty (protocols: {})",
                names.join(", ")
            ));
        };
        let Some(protocol) = Protocol::from_name(protocol) else {
            let near = suggest::did_you_mean(protocol, names);
            return Err(format!("`{protocol}` is no protocol of this version ({}){near}", names.join(", ")));
        };
        let address = address.parse::<Address>().map_err(|error| error.to_string())?;
        Ok(Destination { protocol, address })
    }
}

impl fmt::Display for Destination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}@{}", self.protocol.name(), self.address)
    }
}

/// One output.
#[derive(Clone, Debug)]
pub struct Output {
    /// Where to.
    pub to: Destination,
    /// How the protocol lays its packets out.
    pub wire: wire::Options,
}

impl Output {
    /// An output of the command line: nothing but its destination.
    pub fn to(to: Destination) -> Output {
        Output { to, wire: wire::Options::default() }
    }
}

pub(super) struct Outputs {
    pub outputs: Vec<Output>,
    pub resolved: Vec<toml::Value>,
}

/// Every `[[output]]`; `None` where the scene's sensors could not all be read, so that nothing is blamed on that.
pub(super) fn outputs(top: &Section<'_>, sensors: Option<&[SensorPlan]>) -> Outputs {
    let mut all = Outputs { outputs: Vec::new(), resolved: Vec::new() };
    for section in top.tables("output") {
        all.outputs.extend(output(&section, sensors));
        all.resolved.push(section.finish().into());
    }
    all
}

fn output(section: &Section<'_>, sensors: Option<&[SensorPlan]>) -> Option<Output> {
    let layout =
        section.has("layout").then(|| match section.word("layout", &["separate", "burst"], "separate") {
            "burst" => Layout::Burst,
            _ => Layout::Separate,
        });
    if !section.has("to") {
        section.lacks("an output needs a destination, such as to = \"mpu@pty\"".into());
    }
    let to = section.text("to", None)?;
    let to: Destination = to.parse().map_err(|error: String| section.mistake("to", error)).ok()?;
    let wire = wire::Options { layout };
    if layout.is_some() && to.protocol != Protocol::Mpu {
        section.mistake("layout", format!("only `mpu` has layouts, not `{}`", to.protocol.name()));
    }
    if let Some(Err(why)) = sensors.map(|sensors| wire::check(to.protocol, &wire, sensors)) {
        section.mistake("layout", why);
    }
    Some(Output { to, wire })
}
