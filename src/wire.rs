//! Readings to packets: the only room that knows both the sensors and the protocols.
//!
//! Each protocol is one file with an [`Encoder`]; what comes back is the business of `dialogue`. Conversion from the
//! program's axes (Forward-Right-Down, SI, µT) to a protocol's own happens here and nowhere else.
//! To add a protocol: one file in the `protocols` crate, one beside this one, and one line in [`Protocol`].

pub mod dialogue;
mod fault;
mod faults;
mod latest;
mod mavlink;
mod mip;
mod mpu;
mod msp;
mod packet;
pub mod samples;
mod text;
mod vectornav;

pub use fault::{Fault, FaultKind};
pub use faults::{Acts, Faults};
pub use packet::{MAX_PACKET, Packet};

use crate::earth::{Day, Place, STANDARD_GRAVITY, default_field};
use crate::geometry::{Attitude, Axes, Body, Vector};
use crate::motion::Truth;
use crate::schedule::{Schedule, Ticks};
use crate::sensor::{
    ByKind, Fix, Kinds, Measured, Measurement, Position, Reading, SensorKind, SensorPlan, Shape,
};
use crate::time::{NANOS, SimTime};
use dialogue::Peer;

pub use mavlink::{Extra, Extras};
pub use ratetable_protocols::mavlink::Version;

/// What the packets look like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
    /// A line of comma-separated values a reading.
    Csv,
    /// A JSON object a reading.
    Jsonl,
}

impl Protocol {
    /// Every protocol.
    pub const ALL: [Protocol; 7] = [
        Protocol::Mpu,
        Protocol::Mavlink,
        Protocol::Msp,
        Protocol::Vectornav,
        Protocol::Mip,
        Protocol::Csv,
        Protocol::Jsonl,
    ];

    /// As `--to` spells it.
    pub const fn name(self) -> &'static str {
        ["mpu", "mavlink", "msp", "vectornav", "mip", "csv", "jsonl"][self as usize]
    }

    /// The protocol of that name.
    pub fn from_name(name: &str) -> Option<Protocol> {
        Self::ALL.into_iter().find(|protocol| protocol.name() == name)
    }

    /// Whether it has a place for readings of this kind.
    pub const fn carries(self, kind: SensorKind) -> bool {
        match self {
            Protocol::Mpu => kind.is_triad(),
            Protocol::Mavlink => true,
            Protocol::Msp | Protocol::Vectornav | Protocol::Mip => {
                kind.is_triad() || matches!(kind, SensorKind::Baro)
            }
            Protocol::Csv | Protocol::Jsonl => true,
        }
    }

    /// One line for `list protocols`.
    pub const fn about(self) -> &'static str {
        [
            "registers of an MPU-6050 or MPU-9250 in COBS frames with a CRC: imu, gyro, accel, mag, config",
            "MAVLink 2: HIL_SENSOR (gyro, accel, mag, baro) at each gyro tick, HIL_GPS, HEARTBEAT and SYSTEM_TIME once a second",
            "MSPv2 for INAV: its simulator message (0x201F) with all sensors, at most 100 a second",
            "a VN-100 for ArduPilot: IMU packets at the gyro's rate or that asked for, AHRS packets at 50 Hz",
            "a MicroStrain unit for ArduPilot: pressure, mag, accel and gyro at each gyro tick",
            "t_ns,sensor,x,y,z: one line a reading, in the scene's axes (baro: Pa; gps: degrees, altitude, velocity)",
            "the same as one JSON object a line",
        ][self as usize]
    }
}

/// How `mpu` carries gyro and accel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// Each in packets of its own.
    Separate,
    /// Together in `imu` packets at the faster rate, the slower one held: what a burst read of the chip returns.
    Burst,
}

/// A flight controller that wants a protocol spoken its own way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Controller {
    /// PX4 on its board, in HITL: time is arrival.
    Px4,
    /// PX4 as a program, in lockstep.
    Px4Sitl,
    /// ArduPilot with an external AHRS.
    Ardupilot,
    /// INAV with its HITL simulator message.
    Inav,
}

/// How a protocol lays its packets out, and whom it talks to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// For `mpu`; `None` is burst where the rates are equal, else separate.
    pub layout: Option<Layout>,
    /// Whose ways the protocol keeps to.
    pub controller: Option<Controller>,
    /// For `mavlink`: the version of its framing.
    pub version: Version,
    /// For `mavlink`: what is sent beside HIL_SENSOR.
    pub extras: Extras,
}

/// What an encoder needs to know of the scene.
#[derive(Clone, Copy, Debug)]
pub struct Setup<'a> {
    /// The sensors, in order.
    pub sensors: &'a [SensorPlan],
    /// The axes the scene is written in, for text.
    pub axes: Axes,
    /// The scene's date.
    pub day: Option<Day>,
    /// How packets are laid out.
    pub options: Options,
    /// What the conversation has brought to light of the other side.
    pub peer: Peer,
}

/// What an encoder is told of one moment of the scene.
#[derive(Clone, Copy, Debug)]
pub struct Now<'a> {
    /// When.
    pub t: SimTime,
    /// What is true then, for packets that carry truth.
    pub truth: &'a Truth,
    /// The readings due then, in the order of sensors.
    pub readings: &'a [Reading],
}

/// Turns readings into packets, in order of time.
pub trait Encoder: Send {
    /// Appends the packets of the readings due now, and whatever the protocol sends besides.
    fn encode(&mut self, now: &Now<'_>, out: &mut Vec<Packet>);

    /// What the other side is left with, at the very end: appends the packets of a vehicle that has stopped at `t`.
    fn farewell(&mut self, _t: SimTime, _out: &mut Vec<Packet>) {}

    /// Samples of each kind taken in that no packet has carried yet.
    fn waiting(&self) -> ByKind<u64> {
        ByKind::default()
    }
}

/// The encoder of a protocol; readings that it has no place for do not reach it.
pub fn encoder(protocol: Protocol, setup: &Setup<'_>) -> Box<dyn Encoder> {
    let encoder: Box<dyn Encoder> = match protocol {
        Protocol::Mpu => Box::new(mpu::Mpu::new(setup)),
        Protocol::Mavlink => Box::new(mavlink::Mavlink::new(setup)),
        Protocol::Msp => Box::new(msp::Msp::new(setup)),
        Protocol::Vectornav => Box::new(vectornav::Vectornav::new(setup)),
        Protocol::Mip => Box::new(mip::Mip::new(setup)),
        Protocol::Csv => Box::new(text::Text::csv(setup)),
        Protocol::Jsonl => Box::new(text::Text::jsonl(setup)),
    };
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
    let has = |kind| sensors.iter().any(|sensor| sensor.kind == kind);
    if protocol == Protocol::Mpu
        && options.layout == Some(Layout::Burst)
        && !(has(SensorKind::Gyro) && has(SensorKind::Accel))
    {
        return Err("`layout = \"burst\"` needs both [gyro] and [accel]".into());
    }
    let px4 = matches!(options.controller, Some(Controller::Px4 | Controller::Px4Sitl));
    let truth = options.extras.iter().find(|extra| px4 && extra.is_truth());
    truth.map_or(Ok(()), |truth| {
        Err(format!(
            "{} tells the truth, and PX4 is to find it out itself: in HITL it fights the estimator; leave it out, the score needs it not",
            truth.name()
        ))
    })
}

/// What a protocol cannot carry of these sensors, for `check` and the report: one that it has no place for is not
/// sent, and one faster than the packets that carry it loses samples to newer ones.
pub fn warnings(protocol: Protocol, sensors: &[SensorPlan]) -> Vec<String> {
    let (carried, left): (Vec<_>, Vec<_>) = sensors.iter().partition(|sensor| protocol.carries(sensor.kind));
    let unsent = left.into_iter().map(|sensor| {
        format!("{} has no place for {}: its readings are not sent", protocol.name(), sensor.kind)
    });
    unsent.chain(replaced(protocol, &carried)).collect()
}

/// What is said of sensors faster than the packets that carry them.
fn replaced(protocol: Protocol, sensors: &[&SensorPlan]) -> Vec<String> {
    let Some(carrier) = sensors.first() else { return Vec::new() };
    let tick = format!("at each {} tick ({})", carrier.kind, carrier.rate);
    let (rate, packets, fits) = match protocol {
        Protocol::Mavlink => (carrier.rate, format!("HIL_SENSOR {tick}"), String::new()),
        Protocol::Vectornav | Protocol::Mip => (carrier.rate, format!("a packet {tick}"), String::new()),
        Protocol::Msp if carrier.rate.as_hz() > msp::FASTEST.as_hz() => (
            msp::FASTEST,
            format!("{} packets a second, as many as an INAV board takes", msp::FASTEST.as_hz()),
            format!("; a rate of {} fits", msp::FASTEST),
        ),
        Protocol::Msp => (carrier.rate, format!("a packet {tick}"), String::new()),
        Protocol::Mpu | Protocol::Csv | Protocol::Jsonl => return Vec::new(),
    };
    // A fix has a message of its own.
    let shared = sensors.iter().filter(|sensor| sensor.kind != SensorKind::Gps);
    let faster = shared.filter(|sensor| sensor.rate.as_hz() > rate.as_hz());
    faster
        .map(|sensor| {
            format!(
                "{} sends {packets}: samples of {} ({}) between two of them are replaced by newer ones and counted as dropped{fits}",
                protocol.name(), sensor.kind, sensor.rate
            )
        })
        .collect()
}

/// Bytes and packets a second, found by encoding ten seconds of the scene's own ticks. Text is as long as its
/// numbers: these have as many digits as noise has.
pub fn load(protocol: Protocol, setup: &Setup<'_>) -> (f64, f64) {
    const DIGITS: f64 = -0.012_345_678_901_234_568;
    let value = Vector::new(DIGITS, DIGITS, DIGITS);
    let position = Place { latitude: DIGITS, longitude: DIGITS, altitude: DIGITS };
    let velocity = Vector::new(DIGITS, DIGITS, DIGITS);
    let fix = Fix { position, velocity };
    let seconds = 10;
    let ticks = setup.sensors.iter().map(|sensor| Ticks { rate: sensor.clock(), phase: sensor.phase });
    let mut encoder = encoder(protocol, setup);
    let (mut packets, mut bytes, mut count) = (Vec::new(), 0, 0);
    let mut readings = Vec::new();
    for due in Schedule::new(ticks, SimTime(seconds * NANOS)) {
        readings.clear();
        let sensors = setup.sensors.iter().enumerate().filter(|(i, _)| due.sensors >> i & 1 == 1);
        readings.extend(sensors.map(|(i, plan)| Reading {
            measurement: match plan.kind.shape() {
                Shape::Triad => Measurement::Triad(Measured { value, ..Measured::default() }),
                Shape::Pressure => Measurement::Pressure(Measured { value: DIGITS, ..Measured::default() }),
                Shape::Position => {
                    Measurement::Position(Position { displacement: Measured::default(), fix, true_fix: fix })
                }
            },
            ..Reading::zero(i, plan.kind)
        }));
        packets.clear();
        encoder.encode(&Now { t: due.t, truth: &at_rest(due.t), readings: &readings }, &mut packets);
        count += packets.len();
        bytes += packets.iter().map(|packet| packet.bytes().len()).sum::<usize>();
    }
    (bytes as f64 / seconds as f64, count as f64 / seconds as f64)
}

/// A vehicle that stands level, facing north, where nothing else is known of the scene.
fn at_rest(t: SimTime) -> Truth {
    Truth {
        t,
        attitude: Attitude::IDENTITY,
        rate: Vector::ZERO,
        force: Vector::new(0.0, 0.0, -STANDARD_GRAVITY),
        field: Vector::from_vec(default_field().v),
    }
}

/// What gyro, accel and mag of a vehicle read that has stopped as it is.
fn stopped(truth: &Truth) -> [Vector<Body>; 3] {
    let up = Vector::new(0.0, 0.0, -STANDARD_GRAVITY);
    [Vector::ZERO, truth.attitude.inverse().apply(up), truth.field]
}

/// Something sent once a second from t = 0, in scene time.
#[derive(Debug, Default)]
struct EverySecond {
    next: SimTime,
}

impl EverySecond {
    /// Every whole second up to `t` that has not been given yet.
    fn due(&mut self, t: SimTime) -> impl Iterator<Item = SimTime> + use<> {
        let first = self.next;
        let count = if t >= first { (t - first).0 / NANOS + 1 } else { 0 };
        self.next = SimTime(first.0 + count * NANOS);
        (0..count).map(move |i| SimTime(first.0 + i * NANOS))
    }
}

/// What a sensor of this kind read last, in body axes.
fn body(newest: &ByKind<Option<Reading>>, kind: SensorKind) -> Option<Vector<Body>> {
    newest[kind as usize].as_ref()?.body().map(|body| body.value)
}

/// The pressure that a sensor of this kind read last, Pa.
fn pressure(newest: &ByKind<Option<Reading>>, kind: SensorKind) -> Option<f64> {
    newest[kind as usize].as_ref()?.pressure().map(|pressure| pressure.value)
}

/// The newest sample of each sensor, for packets that carry several.
#[derive(Debug, Default)]
struct Newest {
    values: ByKind<Option<Reading>>,
    fresh: Kinds,
    replaced: ByKind<u32>,
}

impl Newest {
    fn take_in(&mut self, readings: &[Reading]) {
        for reading in readings {
            let i = reading.kind as usize;
            if self.fresh.contains(reading.kind) {
                self.replaced[i] = self.replaced[i].saturating_add(1);
            }
            self.fresh.insert(reading.kind);
            self.values[i] = Some(*reading);
        }
    }

    fn waiting(&self) -> ByKind<u64> {
        SensorKind::ALL
            .map(|kind| u64::from(self.fresh.contains(kind)) + u64::from(self.replaced[kind as usize]))
    }

    /// A packet of these bytes that carries the fresh samples among `kinds`.
    fn packet(&mut self, due: SimTime, kinds: Kinds, bytes: &[u8]) -> Packet {
        let mut packet = Packet::new(due, self.fresh & kinds, bytes);
        for kind in kinds.iter() {
            packet.replaced[kind as usize] = std::mem::take(&mut self.replaced[kind as usize]);
        }
        self.fresh.remove(kinds);
        packet
    }
}

#[cfg(test)]
mod controller_tests;
#[cfg(test)]
mod tests;
