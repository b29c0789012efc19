//! The protocols as a table: to add one, its folder, its variant, and its line in `ROWS`.

use super::dialogue::Dialogue;
use super::row::Row;
use super::{
    Controller, Encoder, Now, Options, Packet, Setup, betaflight, mavlink, mip, mpu, msp, text, vectornav,
};
use crate::sensor::{ByKind, Reading, SensorKind, SensorPlan};
use crate::time::SimTime;

/// What the packets look like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Protocol {
    /// Register images of an MPU-6050 or MPU-9250 in COBS frames.
    Mpu,
    /// MAVLink 2 HIL_SENSOR.
    Mavlink,
    /// INAV's simulator message in MSPv2 frames.
    Msp,
    /// Binary outputs of a VN-100, for ArduPilot.
    Vectornav,
    /// MicroStrain inertial packets, for ArduPilot.
    Mip,
    /// The state that Betaflight's SITL takes from a simulator.
    Betaflight,
    /// A line of comma-separated values a reading.
    Csv,
    /// A JSON object a reading.
    Jsonl,
}

/// Every protocol's row, in order.
static ROWS: [&Row; 8] = [
    &mpu::ROW,
    &mavlink::ROW,
    &msp::ROW,
    &vectornav::ROW,
    &mip::ROW,
    &betaflight::ROW,
    &text::CSV,
    &text::JSONL,
];

impl Protocol {
    /// Every protocol.
    pub const ALL: [Protocol; 8] = [
        Protocol::Mpu,
        Protocol::Mavlink,
        Protocol::Msp,
        Protocol::Vectornav,
        Protocol::Mip,
        Protocol::Betaflight,
        Protocol::Csv,
        Protocol::Jsonl,
    ];

    /// All that is known of it.
    pub(super) fn row(self) -> &'static Row {
        ROWS[self as usize]
    }

    /// As `--to` spells it.
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

    /// The conversation, as `controller` wants it led; `None` where the other side says nothing.
    pub fn dialogue(self, controller: Option<Controller>) -> Option<Box<dyn Dialogue>> {
        (self.row().dialogue)(controller)
    }

    /// Bytes that make a sender begin which waits for some: a ground station's heartbeat in MAVLink, and in the others
    /// bytes that mean nothing. `seq` is the sequence number of a heartbeat.
    pub fn greeting(self, seq: u8) -> Vec<u8> {
        (self.row().greeting)(seq)
    }
}

/// The encoder of a protocol; readings that it does not carry do not reach it.
pub fn encoder(protocol: Protocol, setup: &Setup<'_>) -> Box<dyn Encoder> {
    let encoder = (protocol.row().encoder)(setup);
    match setup.sensors.iter().all(|sensor| protocol.carries(sensor.kind)) {
        true => encoder,
        false => Box::new(Picky { protocol, encoder, carried: Vec::new() }),
    }
}

/// Hands on the readings of the kinds that the protocol carries.
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

    fn farewell(&mut self, t: SimTime, out: &mut Vec<Packet>) {
        self.encoder.farewell(t, out);
    }

    fn waiting(&self) -> ByKind<u64> {
        self.encoder.waiting()
    }
}

/// Whether a protocol can carry these sensors.
///
/// # Errors
/// Why not, and what would be right.
pub fn check(protocol: Protocol, options: &Options, sensors: &[SensorPlan]) -> Result<(), String> {
    (protocol.row().check)(options, sensors)
}

/// What a protocol cannot carry of these sensors, for `check` and the report: it does not send a kind that it has no
/// field for, and a sensor faster than the packets that carry it loses samples to newer ones.
pub fn warnings(protocol: Protocol, sensors: &[SensorPlan]) -> Vec<String> {
    let (carried, left): (Vec<_>, Vec<_>) = sensors.iter().partition(|sensor| protocol.carries(sensor.kind));
    let unsent = left.into_iter().map(|sensor| {
        format!("{} has no place for {}: its readings are not sent", protocol.name(), sensor.kind)
    });
    unsent.chain(replaced(protocol, &carried)).collect()
}

/// What is said of sensors faster than the packets that carry them.
fn replaced(protocol: Protocol, sensors: &[&SensorPlan]) -> Vec<String> {
    let shared = sensors.first().and_then(|first| (protocol.row().shared)(first));
    let Some(shared) = shared else { return Vec::new() };
    let faster = sensors.iter().filter(|sensor| shared.kinds.contains(sensor.kind));
    let faster = faster.filter(|sensor| sensor.rate.as_hz() > shared.rate.as_hz());
    let fits = shared.fits.map_or(String::new(), |rate| format!("; a rate of {rate} fits"));
    faster
        .map(|sensor| {
            format!(
                "{} sends {}: samples of {} ({}) between two of them are replaced by newer ones and counted as dropped{fits}",
                protocol.name(), shared.what, sensor.kind, sensor.rate
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
