//! The table of protocols: to add one, write its folder, its variant, and its line in `ROWS`.

use super::dialogue::{Dialogue, Peer};
use super::row::Row;
use super::{
    Controller, Encoder, Now, Options, Packet, Setup, betaflight, bus, ilabs, mavlink, mip, mpu, msp, sbg,
    text, vectornav,
};
use crate::motion::Truth;
use crate::sensor::{ByKind, Reading, SensorKind, SensorPlan};
use crate::time::SimTime;

/// The format of the packets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Protocol {
    /// Register images of an MPU-6050 or MPU-9250 in COBS frames.
    Mpu,
    /// MAVLink 2 HIL_SENSOR.
    Mavlink,
    /// INAV's simulator message in MSPv2 frames.
    Msp,
    /// Binary outputs of a VN-100, for ArduPilot and PX4.
    Vectornav,
    /// MicroStrain inertial packets, for ArduPilot.
    Mip,
    /// User-defined data of an Inertial Labs unit, for ArduPilot and PX4.
    Ilabs,
    /// sbgECom packets of an SBG Systems unit, for ArduPilot.
    Sbg,
    /// The state that Betaflight's SITL takes from a simulator.
    Betaflight,
    /// A line of comma-separated values for each reading.
    Csv,
    /// A JSON object for each reading.
    Jsonl,
    /// No packets: chips whose registers a driver reads.
    Bus,
}

/// Every protocol's row, in the order of the variants.
static ROWS: [&Row; 11] = [
    &mpu::ROW,
    &mavlink::ROW,
    &msp::ROW,
    &vectornav::ROW,
    &mip::ROW,
    &ilabs::ROW,
    &sbg::ROW,
    &betaflight::ROW,
    &text::CSV,
    &text::JSONL,
    &bus::ROW,
];

impl Protocol {
    /// Every protocol.
    pub const ALL: [Protocol; 11] = [
        Protocol::Mpu,
        Protocol::Mavlink,
        Protocol::Msp,
        Protocol::Vectornav,
        Protocol::Mip,
        Protocol::Ilabs,
        Protocol::Sbg,
        Protocol::Betaflight,
        Protocol::Csv,
        Protocol::Jsonl,
        Protocol::Bus,
    ];

    /// Those that send packets.
    pub const STREAMS: [Protocol; 10] = {
        let [streams @ .., _] = Protocol::ALL;
        streams
    };

    /// Its row.
    pub(super) fn row(self) -> &'static Row {
        ROWS[self as usize]
    }

    /// Its name in `--to`.
    pub fn name(self) -> &'static str {
        self.row().name
    }

    /// The protocol of that name.
    pub fn from_name(name: &str) -> Option<Protocol> {
        Self::ALL.into_iter().find(|protocol| protocol.name() == name)
    }

    /// Whether it carries readings of this kind.
    pub fn carries(self, kind: SensorKind) -> bool {
        self.row().carries.contains(kind)
    }

    /// One line for `list protocols`.
    pub fn about(self) -> &'static str {
        self.row().about
    }

    /// The key of `[[output]]` that belongs to other protocols, if this is one: those that have it.
    pub(crate) fn owners(key: &str) -> impl Iterator<Item = Protocol> {
        Self::ALL.into_iter().filter(move |protocol| protocol.row().keys.contains(&key))
    }

    /// Every key of `[[output]]` that some protocol has for itself.
    pub(crate) fn own_keys() -> impl Iterator<Item = &'static str> {
        Self::ALL.into_iter().flat_map(|protocol| protocol.row().keys.iter().copied())
    }

    /// The dialogue for `controller`; `None` where the other side says nothing.
    pub fn dialogue(self, controller: Option<Controller>) -> Option<Box<dyn Dialogue>> {
        (self.row().dialogue)(controller)
    }

    /// Bytes that start a sender which waits for some: a ground station's heartbeat in MAVLink, bytes without a
    /// meaning in the others. `seq` is the sequence number of a heartbeat.
    pub fn greeting(self, seq: u8) -> Vec<u8> {
        (self.row().greeting)(seq)
    }
}

/// The encoder of a protocol. Readings that it does not carry do not reach it.
pub fn encoder(protocol: Protocol, setup: &Setup<'_>) -> Box<dyn Encoder> {
    if setup.options.is_mute {
        return Box::new(bus::Silent);
    }
    let encoder = (protocol.row().encoder)(setup);
    match setup.sensors.iter().all(|sensor| protocol.carries(sensor.kind)) {
        true => encoder,
        false => Box::new(Picky { protocol, encoder, carried: Vec::new() }),
    }
}

/// Passes on readings only of the kinds that the protocol carries.
struct Picky {
    protocol: Protocol,
    encoder: Box<dyn Encoder>,
    carried: Vec<Reading>,
}

impl Encoder for Picky {
    fn encode(&mut self, now: &Now<'_>, out: &mut Vec<Packet>) {
        self.carried.clear();
        self.carried.extend(now.readings.iter().filter(|reading| self.protocol.carries(reading.kind)));
        self.encoder.encode(&Now { readings: &self.carried, ..*now }, out);
    }

    fn farewell(&mut self, end: &Truth, out: &mut Vec<Packet>) {
        self.encoder.farewell(end, out);
    }

    fn waiting(&self) -> ByKind<u64> {
        self.encoder.waiting()
    }

    fn follows(&self) -> bool {
        self.encoder.follows()
    }

    fn follow(&mut self, peer: &Peer, now: SimTime) {
        self.encoder.follow(peer, now);
    }
}

/// Checks that a protocol can carry these sensors.
///
/// # Errors
/// Why it cannot, and what would be right.
pub fn check(protocol: Protocol, options: &Options, sensors: &[SensorPlan]) -> Result<(), String> {
    (protocol.row().check)(options, sensors)
}

/// What a protocol cannot carry of these sensors, for `check` and the report: it does not send a kind without a
/// field, and a sensor faster than the packets that carry it loses samples to newer ones.
pub fn warnings(protocol: Protocol, options: &Options, sensors: &[SensorPlan]) -> Vec<String> {
    if options.is_mute {
        return Vec::new();
    }
    let (carried, left): (Vec<_>, Vec<_>) = sensors.iter().partition(|sensor| protocol.carries(sensor.kind));
    let unsent = left.into_iter().map(|sensor| {
        format!("{} has no place for {}: its readings are not sent", protocol.name(), sensor.kind)
    });
    unsent.chain(replaced(protocol, options, &carried)).collect()
}

/// The warnings about sensors faster than the packets that carry them.
fn replaced(protocol: Protocol, options: &Options, sensors: &[&SensorPlan]) -> Vec<String> {
    let shared = sensors.first().and_then(|first| (protocol.row().shared)(options, first));
    let Some(shared) = shared else { return Vec::new() };
    let faster = sensors.iter().filter(|sensor| shared.kinds.contains(sensor.kind));
    let faster = faster.filter(|sensor| sensor.rate.as_hz() > shared.rate.as_hz());
    let become_of = match options.means() {
        true => "go out as their mean",
        false => "are replaced by newer ones and counted as dropped",
    };
    let fits = shared.fits.map_or(String::new(), |rate| format!("; a rate of {rate} fits"));
    faster
        .map(|sensor| {
            format!(
                "{} sends {}: samples of {} ({}) between two of them {become_of}{fits}",
                protocol.name(),
                shared.what,
                sensor.kind,
                sensor.rate
            )
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_protocol_has_its_own_row() {
        for protocol in Protocol::ALL {
            assert_eq!(format!("{protocol:?}").to_lowercase(), protocol.name());
        }
    }
}
