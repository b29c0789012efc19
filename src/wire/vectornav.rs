//! `vectornav`: the two binary outputs that a controller asks a VN-100 for.
//!
//! The first goes out at the rate that the controller asked for, or else the gyro's. What they hold depends on whose
//! they are: ArduPilot's IMU packets carry every reading, and its AHRS packets the true attitude, at the first tick of
//! any sensor at or after their time; PX4's inertial packets carry gyro and accelerometer, and its navigation packets
//! the other readings beside the truth, evenly. Neither firmware's own estimator uses the attitude. Axes are forward,
//! right, down; the field is in gauss. A controller that asks again gets what it asks for from the next packet on. The
//! stream ends with a vehicle that has stopped.

mod ardupilot;
mod dialogue;
mod px4;
mod reader;

use super::beat::Beat;
use super::dialogue::Peer;
use super::latest::{CARRIED, Latest, pascals};
use super::newest::Told;
use super::row::{Row, Shared, any};
use super::{Controller, Encoder, Now, Packet, Setup, stopped};
use crate::geometry::Vector;
use crate::motion::Truth;
use crate::schedule::Ticks;
use crate::sensor::{ByKind, Kinds, REFERENCE_TEMPERATURE, SensorKind};
use crate::time::{Rate, SimTime};
use ratetable_protocols::vectornav::{self, MAX_LEN};

pub(super) static ROW: Row = Row {
    name: "vectornav",
    about: "a VN-100 for ArduPilot and PX4: its packets at the gyro's rate or that asked for, an attitude beside them",
    carries: CARRIED,
    encoder: |setup| Box::new(Vectornav::new(setup)),
    reader: |_| Box::new(reader::Reader::default()),
    dialogue: |controller| Some(Box::new(dialogue::Unit::new(controller))),
    shared: |_, first| Some(Shared::at_ticks("a packet", CARRIED, first)),
    keys: &["thin"],
    check: any,
    greeting: |_| b"\n".to_vec(),
    is_numbered: false,
    // What says how long a packet is comes first: the sync byte with up to five of groups and fields, nine of them in
    // a navigation packet.
    inside: |len| (if len == NAVIGATION_LEN { 10 } else { 6.min(len) }..len, None),
};

/// Bytes of a navigation packet, the longest.
const NAVIGATION_LEN: usize = MAX_LEN;
const PASCALS_A_KILOPASCAL: f64 = 1000.0;

/// Whose outputs they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Whose {
    Ardupilot,
    Px4,
}

impl Whose {
    fn of(controller: Option<Controller>) -> Whose {
        match controller {
            Some(Controller::Px4Vectornav) => Whose::Px4,
            _ => Whose::Ardupilot,
        }
    }

    /// What the first output carries.
    fn carried(self) -> Kinds {
        match self {
            Whose::Ardupilot => CARRIED,
            Whose::Px4 => px4::INERTIAL,
        }
    }

    /// How often the second output goes out where nobody asked for a number.
    fn second(self) -> Rate {
        match self {
            Whose::Ardupilot => ardupilot::AHRS,
            Whose::Px4 => px4::USUAL,
        }
    }
}

pub(super) struct Vectornav {
    whose: Whose,
    /// What was asked for so far.
    asked: Peer,
    latest: Latest,
    second: Beat,
    last: Option<Truth>,
    has_mag: bool,
}

impl Vectornav {
    pub(super) fn new(setup: &Setup<'_>) -> Vectornav {
        let whose = Whose::of(setup.peer.controller.or(setup.options.controller));
        let mut latest = Latest::new(setup, |own| setup.peer.rate.unwrap_or(own));
        latest.kinds = whose.carried();
        let second = setup.peer.second.unwrap_or(whose.second());
        Vectornav {
            whose,
            asked: setup.peer,
            latest,
            second: Beat::new(Ticks { rate: second, phase: SimTime::ZERO }),
            last: None,
            has_mag: setup.sensors.iter().any(|sensor| sensor.kind == SensorKind::Mag),
        }
    }

    fn encode_for_ardupilot(&mut self, now: &Now<'_>, out: &mut Vec<Packet>) {
        self.latest.encode(now.t, now.readings, out, |t, newest, buffer| {
            encoded(&ardupilot::readings(t, newest), buffer)
        });
        if self.second.due() <= now.t {
            while self.second.due() <= now.t {
                self.second.step();
            }
            let attitude = ardupilot::attitude(now.truth);
            Packet::append(out, now.t, Kinds::NONE, |bytes| encoded(&attitude, bytes));
        }
    }

    /// `before` is the truth at the tick before: what a packet holds that is due between the two.
    fn encode_for_px4(&mut self, now: &Now<'_>, before: Option<Truth>, out: &mut Vec<Packet>) {
        let begun = out.len();
        while self.second.due() < now.t {
            self.push_rest(before.as_ref(), out);
        }
        self.latest
            .encode(now.t, now.readings, out, |t, newest, buffer| encoded(&px4::readings(t, newest), buffer));
        if self.second.due() == now.t {
            self.push_rest(Some(now.truth), out);
        }
        out[begun..].sort_by_key(|packet| packet.due);
    }

    /// The navigation packet that is due next; left out as long as there is nothing to say.
    fn push_rest(&mut self, truth: Option<&Truth>, out: &mut Vec<Packet>) {
        let due = self.second.due();
        self.second.step();
        let Some(truth) = truth.filter(|_| self.latest.has_begun()) else { return };
        self.latest.append(out, due, px4::NAVIGATION, |newest, bytes| {
            encoded(&px4::rest(due, newest, truth), bytes)
        });
    }
}

impl Encoder for Vectornav {
    fn encode(&mut self, now: &Now<'_>, out: &mut Vec<Packet>) {
        let before = self.last.replace(*now.truth);
        match self.whose {
            Whose::Ardupilot => self.encode_for_ardupilot(now, out),
            Whose::Px4 => self.encode_for_px4(now, before, out),
        }
    }

    fn farewell(&mut self, end: &Truth, out: &mut Vec<Packet>) {
        if !self.latest.has_begun() {
            return;
        }
        let mut still = *self.latest.newest();
        for (kind, value) in
            [SensorKind::Gyro, SensorKind::Accel, SensorKind::Mag].into_iter().zip(stopped(end))
        {
            let value = if kind == SensorKind::Mag && !self.has_mag { Vector::ZERO } else { value };
            still.put(kind, Some(value));
        }
        let last = match self.whose {
            Whose::Ardupilot => ardupilot::readings(end.t, &still),
            Whose::Px4 => px4::readings(end.t, &still),
        };
        let mut buffer = [0; MAX_LEN];
        let len = encoded(&last, &mut buffer);
        out.push(Packet::new(end.t, Kinds::NONE, &buffer[..len]));
    }

    fn waiting(&self) -> ByKind<u64> {
        self.latest.waiting()
    }

    fn follows(&self) -> bool {
        true
    }

    fn follow(&mut self, peer: &Peer, now: SimTime) {
        if peer.controller.is_some() {
            self.whose = Whose::of(peer.controller);
            self.latest.kinds = self.whose.carried();
        }
        if let Some(rate) = peer.rate.filter(|_| peer.rate != self.asked.rate) {
            self.latest.change(rate, now);
        }
        let second = peer.second.unwrap_or(self.whose.second());
        if second != self.second.rate() {
            self.second.change(second, now);
        }
        self.asked = *peer;
    }
}

/// Of the gyro, or the accelerometer, or as it is where neither says, °C.
fn temperature(newest: &Told) -> f32 {
    let warm = [SensorKind::Gyro, SensorKind::Accel].into_iter().find_map(|kind| newest.temperature(kind));
    warm.unwrap_or(REFERENCE_TEMPERATURE) as f32
}

fn kilopascals(newest: &Told) -> f32 {
    (pascals(newest) / PASCALS_A_KILOPASCAL) as f32
}

/// MAX_LEN holds every packet.
fn encoded(packet: &vectornav::Packet, buffer: &mut [u8]) -> usize {
    vectornav::encode(packet, buffer).unwrap_or(0)
}
