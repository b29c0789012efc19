//! `[[output]]`: where the scene sends its packets.

use super::section::Section;
use super::suggest;
use super::target::{TARGETS, Target};
use crate::link::{Address, Endpoint};
use crate::sensor::{SensorKind, SensorPlan, parts};
use crate::wire::{
    self, AtEnd, Claim, Controller, Extra, Extras, Layout, MagUnit, Protocol, Release, Thin, Version,
};
use ratetable_protocols::bridge::FIRST_BAUD;
use std::fmt;
use std::str::FromStr;

/// `PROTOCOL@LINK`, or `TARGET@LINK`, or a target alone that has a link of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Destination {
    /// What the packets look like.
    pub protocol: Protocol,
    /// Where they go.
    pub address: Address,
    /// The flight controller that was named in place of a protocol.
    pub target: Option<&'static Target>,
    /// Where its controller answers, if not on the link itself, or tells its attitude besides (a UDP port).
    pub answers: Option<Address>,
    /// Of a bus: the chip that was named in place of the protocol, for sensors without a part.
    pub chip: Option<&'static str>,
}

impl Destination {
    /// A protocol on a link.
    pub fn new(protocol: Protocol, address: Address) -> Destination {
        Destination { protocol, address, target: None, answers: None, chip: None }
    }

    /// Whether somebody at the other end is spoken with: who answers elsewhere is not reached over every link.
    pub fn is_spoken_with(&self) -> bool {
        self.target.is_none_or(|target| target.answers.is_none()) || self.answers.is_some()
    }

    /// Where its controller is spoken with, if not on the link itself.
    pub fn apart(&self) -> Option<&Address> {
        self.answers.as_ref().filter(|address| !matches!(address, Address::UdpIn(_)))
    }

    /// Where its controller tells its attitude besides.
    pub fn overheard(&self) -> Option<&Address> {
        self.answers.as_ref().filter(|address| matches!(address, Address::UdpIn(_)))
    }

    /// The speed at which the packets go out, baud, where there is one: of a serial port that which the controller sets.
    pub fn baud(&self) -> Option<u32> {
        let set = self.target.and_then(|target| target.sets_baud);
        let is_port = matches!(self.address, Address::Serial { .. });
        set.filter(|_| is_port).or(self.address.baud())
    }

    /// The same packets and the same controller, on the link called `link`.
    pub fn at(&self, link: impl fmt::Display) -> String {
        let what = self.target.map_or(self.protocol.name(), |target| target.name);
        match self.chip {
            Some(chip) => format!("{}-{what}@{link}", chip.to_lowercase()),
            None => format!("{what}@{link}"),
        }
    }
}

impl FromStr for Destination {
    type Err = String;

    fn from_str(text: &str) -> Result<Destination, String> {
        let targets = TARGETS.iter().map(|target| target.name);
        let names: Vec<_> = Protocol::ALL.map(Protocol::name).into_iter().chain(targets).collect();
        let alone = |text| Target::from_name(text).and_then(|target| Some((target.name, target.link?)));
        let Some((name, address)) = text.split_once('@').or_else(|| alone(text)) else {
            let example = if Target::from_name(text).is_some() { text } else { "mpu" };
            let link = if example == text { "/dev/ttyACM0" } else { "pty" };
            return Err(format!(
                "`{text}` is not PROTOCOL@LINK: write, for example, {example}@{link} (protocols: {})",
                names.join(", ")
            ));
        };
        let (chip, name) = match name.strip_suffix("-bus") {
            Some(chip) => (Some(chip_called(chip)?), Protocol::Bus.name()),
            None => (None, name),
        };
        let target = Target::from_name(name);
        let Some(protocol) = target.map(|target| target.protocol).or_else(|| Protocol::from_name(name))
        else {
            let near = suggest::did_you_mean(name, names.iter().copied());
            return Err(format!("`{name}` is not a protocol of this version ({}){near}", names.join(", ")));
        };
        let mut address = address.parse::<Address>().map_err(|error| error.to_string())?;
        // A bridge powers on at its own speed.
        let bridge = (protocol == Protocol::Bus).then_some(FIRST_BAUD);
        if let Some(baud) = target.and_then(|target| target.baud).or(bridge) {
            address = address.or_baud(baud);
        }
        let (asked, told) = target.map_or((None, None), |target| (target.answers, target.overheard));
        let answers = match (asked, told, &address) {
            (Some(port), _, Address::UdpOut(place)) => {
                Some(Address::TcpOut(Endpoint::new(&place.host, port)))
            }
            (_, Some(port), _) => Some(Address::UdpIn(Endpoint::new("127.0.0.1", port))),
            _ => None,
        };
        Ok(Destination { protocol, address, target, answers, chip })
    }
}

/// The part that `icm42688-bus` or `mpu-bus` names, however it is spelled.
fn chip_called(name: &str) -> Result<&'static str, String> {
    let plain = |name: &str| name.replace('-', "").to_lowercase();
    let names = || SensorKind::TRIADS.into_iter().flat_map(parts::names);
    // The one of the family that has everything.
    let wanted = if name == "mpu" { plain("MPU-9250") } else { plain(name) };
    let found = names()
        .find(|part| plain(part) == wanted)
        .or_else(|| names().find(|part| plain(part).starts_with(&wanted)));
    found.filter(|_| !wanted.is_empty()).ok_or_else(|| {
        let near = suggest::did_you_mean(name, names());
        format!("`{name}-bus`: `{name}` is not a known part; `ratetable list parts` shows them{near}")
    })
}

impl fmt::Display for Destination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.at(&self.address))
    }
}

/// What to do with a packet that its link does not accept when it is due.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Overload {
    /// It is dropped. Whatever is sent is on time: a flight controller that stamps samples on arrival is never told
    /// the past as the present, and nothing waits in the program.
    #[default]
    DropNewest,
    /// It waits in a short queue until the link takes it; when the queue is full the oldest in it is dropped. After
    /// a stall the other side gets the newest past, late.
    DropOldest,
    /// Scene time stands still, for every output, until the link takes it. Nothing is lost or late.
    Stretch,
}

impl Overload {
    /// As a scene spells them.
    const NAMES: [&str; 3] = ["drop-newest", "drop-oldest", "stretch"];

    /// As a scene spells it.
    pub const fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }

    fn from_name(name: &str) -> Overload {
        let all = [Overload::DropNewest, Overload::DropOldest, Overload::Stretch];
        all.into_iter().find(|policy| policy.name() == name).unwrap_or_default()
    }
}

/// One output.
#[derive(Clone, Debug)]
pub struct Output {
    /// Where to.
    pub to: Destination,
    /// How the protocol lays its packets out.
    pub wire: wire::Options,
    /// What to do with a packet that the link does not accept in time.
    pub overload: Overload,
    /// Whether to start although the baud rate does not carry the packets.
    pub force: bool,
    /// The faults of its packets.
    pub faults: Vec<wire::PacketFault>,
}

impl Output {
    /// An output of the command line: nothing but its destination.
    pub fn to(to: Destination) -> Output {
        let wire = wire::Options {
            controller: to.target.map(|target| target.controller),
            chip: to.chip,
            ..wire::Options::default()
        };
        Output { to, wire, overload: Overload::default(), force: false, faults: Vec::new() }
    }

    /// One on which nothing is sent, for what the other side tells.
    pub fn mute(to: Destination) -> Output {
        let plain = Output::to(to);
        Output { wire: wire::Options { is_mute: true, ..plain.wire }, ..plain }
    }

    /// Whether packets are sent on it at their time.
    pub fn sends(&self) -> bool {
        !self.wire.is_mute && self.to.protocol != Protocol::Bus
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
    let overload = Overload::from_name(section.word("overload", &Overload::NAMES, Overload::NAMES[0]));
    let force = section.flag("force").unwrap_or(false);
    let pace = section.flag("pace");
    let (claim, mag) = unit(section);
    let word = |key, names: &[&'static str]| section.has(key).then(|| section.word(key, names, names[0]));
    let thin = word("thin", &Thin::NAMES).map(Thin::from_name);
    let at_end = word("at_end", &AtEnd::NAMES).map_or(AtEnd::default(), AtEnd::from_name);
    let (is_mute, chip) = (section.flag("send") == Some(false), chip(section));
    let to = destination(section);
    // `version` is a number in MAVLink and a release of Betaflight.
    let is_betaflight = to.as_ref().is_some_and(|to| to.protocol == Protocol::Betaflight);
    let (version, extras) = if is_betaflight { Default::default() } else { mavlink(section) };
    let Some(mut to) = to else {
        // What else is wrong is told all the same.
        if section.has("answers") {
            section.text("answers", None);
        }
        return None;
    };
    let mut controller = to.target.map(|target| target.controller);
    if let Some(Controller::Betaflight(release)) = &mut controller {
        *release = betaflight(section);
    }
    let wire = wire::Options {
        layout,
        version,
        extras,
        controller,
        at_end,
        thin,
        claim,
        mag,
        is_mute,
        chip: chip.or(to.chip),
    };
    for key in Protocol::own_keys().filter(|key| section.has(key)) {
        let owners: Vec<_> = Protocol::owners(key).map(|it| format!("`{}`", it.name())).collect();
        if !Protocol::owners(key).any(|it| it == to.protocol) {
            let owners = owners.join(" and ");
            section.mistake(key, format!("is for {owners}, not for `{}`", to.protocol.name()));
        }
    }
    if let Some(Err(why)) = sensors.map(|sensors| wire::check(to.protocol, &wire, sensors)) {
        section.mistake(if extras == Extras::default() { "layout" } else { "messages" }, why);
    }
    if section.has("answers") {
        to.answers = answers(section, &to);
    }
    match pace {
        Some(true) => paced(section, &to),
        Some(false) => to.address = to.address.unpaced(),
        None => {}
    }
    Some(Output { to, wire, overload, force, faults: Vec::new() })
}

/// Where to.
fn destination(section: &Section<'_>) -> Option<Destination> {
    if !section.has("to") {
        section.lacks("an output needs a destination, such as to = \"mpu@pty\"".into());
    }
    let to = section.text("to", None)?;
    to.parse().map_err(|error: String| section.mistake("to", error)).ok()
}

/// The part whose chip stands for sensors without one.
fn chip(section: &Section<'_>) -> Option<&'static str> {
    section.entry("chip")?;
    let name = section.text("chip", None)?;
    let found =
        SensorKind::TRIADS.into_iter().find_map(|kind| Some(parts::find(&name, kind)?.called(&name, kind)));
    if found.is_none() {
        let names: Vec<_> = SensorKind::TRIADS.into_iter().flat_map(parts::names).collect();
        let near = suggest::did_you_mean(&name, names.iter().copied());
        section.mistake(
            "chip",
            format!("`{name}` is not a known part; `ratetable list parts` shows them{near}"),
        );
    }
    found
}

/// `version` and `messages` of `mavlink`.
fn mavlink(section: &Section<'_>) -> (Version, Extras) {
    let version = match section.has("version").then(|| section.whole("version", 2)) {
        Some(1) => Version::V1,
        Some(2) | None => Version::V2,
        Some(other) => {
            section.mistake("version", format!("is {other}; MAVLink has 1 and 2 (default)"));
            Version::V2
        }
    };
    let mut extras = Extras::default();
    for (name, place) in if section.has("messages") { section.texts("messages") } else { Vec::new() } {
        match Extra::from_name(&name) {
            Some(extra) => extras = extras.with(extra),
            None => {
                let names = Extra::ALL.map(Extra::name);
                let near = suggest::did_you_mean(&name, names);
                section.note(&place, format!("`{name}` is none of {}{near}", names.join(", ")));
            }
        }
    }
    (version, extras)
}

/// `attitude` and `mag_unit`, which only some units have.
fn unit(section: &Section<'_>) -> (Claim, Option<MagUnit>) {
    let word = |key, words: &[&'static str; 2]| section.has(key).then(|| section.word(key, words, words[0]));
    let claim = word("attitude", &Claim::NAMES).map_or(Claim::default(), Claim::from_name);
    (claim, word("mag_unit", &MagUnit::NAMES).map(MagUnit::from_name))
}

/// `version` of a target `betaflight`: its release.
fn betaflight(section: &Section<'_>) -> Release {
    let names = Release::ALL.map(Release::name);
    let version = section.has("version").then(|| section.word("version", &names, names[0]));
    version.and_then(Release::from_name).unwrap_or_default()
}

/// Where a controller answers that does so on a connection of its own.
fn answers(section: &Section<'_>, to: &Destination) -> Option<Address> {
    let address = section.text("answers", None)?.parse::<Address>();
    let (asked, told) = to.target.map_or((None, None), |target| (target.answers, target.overheard));
    let right = match (asked, told) {
        (Some(_), _) => "tcpout:ADDR:PORT",
        (_, Some(_)) => "udpin:ADDR:PORT",
        _ => {
            let name = to.target.map_or(to.protocol.name(), |target| target.name);
            section.mistake("answers", format!("is for `betaflight` and `px4-sitl`, not for `{name}`"));
            return None;
        }
    };
    match address {
        Ok(address @ Address::TcpOut(_)) if asked.is_some() => return Some(address),
        Ok(address @ Address::UdpIn(_)) if told.is_some() => return Some(address),
        Ok(address) => section.mistake("answers", format!("takes {right}, not `{address}`")),
        Err(error) => section.mistake("answers", error.to_string()),
    }
    None
}

/// `pace = true` needs a pty with a speed: a serial port has its own time, and no other link has any.
fn paced(section: &Section<'_>, to: &Destination) {
    let example = || to.at(to.address.clone().at_baud(115_200));
    match to.address {
        Address::Pty { baud: Some(_), .. } => {}
        Address::Pty { .. } => {
            section.mistake("pace", format!("needs a baud rate: write to = \"{}\"", example()))
        }
        Address::Serial { .. } => {
            section.mistake("pace", "is only for a pty: a serial port has its own timing; leave it out")
        }
        _ => section.mistake("pace", format!("is for a pty with a baud rate, not for `{}`", to.address)),
    }
}
