//! `betaflight`: the state that Betaflight's SITL takes from a simulator, a UDP datagram at each gyro tick.
//!
//! The firmware scales rate and force to counts and drops what is behind the point, so the encoder rounds to counts
//! itself and adds a quarter of one outwards: no reading moves by a count for want of 10⁻¹⁶. The firmware then reads
//! 16.384 counts of rate as 1 deg/s, and scales to 16.4; so the counts sent are those that it reads rightly. The
//! timestamp is constant, for the firmware takes what it gains over the time between arrivals for the speed of its
//! own clock (measured: 1.08 to 1.23 at 1 kHz with true stamps, 1.000 with a constant one). In silence it turns on
//! with the last rate, so the stream ends with a vehicle that has stopped.

mod dialogue;
mod probe;
mod reader;
mod release;

pub use release::Release;

use super::latest::{Latest, pascals};
use super::newest::Told;
use super::row::{Row, Shared, any};
use super::{Encoder, Now, Packet, Setup, stopped};
use crate::earth::STANDARD_GRAVITY;
use crate::geometry::{Attitude, Body, Vector};
use crate::motion::Truth;
use crate::sensor::{ByKind, Kinds, SensorKind};
use ratetable_protocols::betaflight::{self, ACCEL_COUNTS, GYRO_COUNTS, GYRO_COUNTS_READ, MAX_COUNT, state};

pub(super) static ROW: Row = Row {
    name: "betaflight",
    about: "the simulator's state for Betaflight's SITL: gyro, accel and pressure at each gyro tick",
    carries: CARRIED,
    encoder: |setup| Box::new(Betaflight::new(setup)),
    reader: |_| Box::new(reader::Reader::default()),
    dialogue: |controller| Some(Box::new(dialogue::Sitl::new(controller))),
    shared: |_, first| Some(Shared::at_ticks("a packet", CARRIED, first)),
    keys: &["version", "thin"],
    check: any,
    greeting: |_| vec![0],
    is_numbered: false,
    inside: |len| (0..len, None),
};

const CARRIED: Kinds = Kinds::of(&[SensorKind::Gyro, SensorKind::Accel, SensorKind::Baro]);

struct Betaflight {
    latest: Latest,
    release: Release,
}

impl Betaflight {
    fn new(setup: &Setup<'_>) -> Betaflight {
        let release = Release::of(setup.options.controller);
        Betaflight { latest: Latest::new(setup, |own| own), release }
    }
}

impl Encoder for Betaflight {
    fn encode(&mut self, now: &Now<'_>, out: &mut Vec<Packet>) {
        let (release, attitude) = (self.release, now.truth.attitude);
        self.latest.encode(now.t, now.readings, out, |_, newest, buffer| {
            let value = |kind| newest.body(kind).unwrap_or(Vector::ZERO);
            write([value(SensorKind::Gyro), value(SensorKind::Accel)], newest, attitude, release, buffer)
        });
    }

    fn farewell(&mut self, end: &Truth, out: &mut Vec<Packet>) {
        if !self.latest.has_begun() {
            return;
        }
        let [gyro, accel, _] = stopped(end);
        let mut buffer = [0; betaflight::MAX_LEN];
        let len = write([gyro, accel], self.latest.newest(), end.attitude, self.release, &mut buffer);
        out.push(Packet::new(end.t, Kinds::NONE, &buffer[..len]));
    }

    fn waiting(&self) -> ByKind<u64> {
        self.latest.waiting()
    }
}

/// The packet of these readings of gyro and accel.
fn write(
    [gyro, accel]: [Vector<Body>; 2],
    newest: &Told,
    attitude: Attitude,
    release: Release,
    buffer: &mut [u8],
) -> usize {
    let pressure = libm::round(pascals(newest)) + QUARTER;
    let has_baro = newest.has(SensorKind::Baro);
    let altitude = if has_baro { altitude(pressure) } else { 0.0 };
    let state = state::Repr {
        orientation: release.orientation(attitude),
        position: [0.0, 0.0, altitude],
        pressure,
        ..readings(gyro, accel, release)
    };
    // MAX_LEN holds every packet.
    betaflight::encode(&state, buffer).unwrap_or(0)
}

/// The state in which these are read.
fn readings(gyro: Vector<Body>, accel: Vector<Body>, release: Release) -> state::Repr {
    let [p, q, r] = gyro.v.to_array().map(rate);
    let [x, y, z] = accel.v.to_array().map(force);
    state::Repr { gyro: [p, q, release.yaw_sign() * r], accel: [-x, y, z], ..state::Repr::LEVEL }
}

/// What is added to a count so that it is still that one when its fraction is dropped.
const QUARTER: f64 = 0.25;

/// An angular rate, rad/s, as that which the firmware reads nearest to it.
fn rate(value: f64) -> f64 {
    (outwards(value.to_degrees() * GYRO_COUNTS_READ) / GYRO_COUNTS).to_radians()
}

/// A specific force, m/s², as that which the firmware reads nearest to it.
fn force(value: f64) -> f64 {
    outwards(value / STANDARD_GRAVITY * ACCEL_COUNTS) / ACCEL_COUNTS * STANDARD_GRAVITY
}

/// The nearest count, a quarter further from 0; clipped as the firmware clips it.
fn outwards(counts: f64) -> f64 {
    match libm::round(counts).clamp(-MAX_COUNT, MAX_COUNT) {
        0.0 => 0.0,
        count => count + QUARTER.copysign(count),
    }
}

/// Where the firmware finds that pressure, Pa, by its own formula of the standard atmosphere, m.
fn altitude(pressure: f64) -> f64 {
    (1.0 - libm::pow(pressure / 101_325.0, 1.0 / 5.255_88)) / 2.255_77e-5
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::{NANOS, SimTime};
    use crate::wire::tests::{plan, play, setup};
    use crate::wire::{Controller, Protocol, encoder};
    use ratetable_protocols::betaflight::Decoder;

    /// Made by a script that shares no code.
    const VECTORS: &str = include_str!("../../protocols/vectors/betaflight.json");
    const SENSORS: &str = "[gyro]\nrate = \"100 Hz\"\n[accel]\nrate = \"100 Hz\"\n";
    const TURN: &str = "[start]\nattitude = \"[30, 10, 90] deg\"\n[[motion]]\nkind = \"rotate\"\n\
                        angular_rate = \"[1, 2, 3] deg/s\"\nduration = \"1 s\"\n";

    fn states(packets: &[Packet]) -> Vec<state::Repr> {
        let mut all = Vec::new();
        let mut decoder = Decoder::new();
        packets
            .iter()
            .for_each(|packet| decoder.feed(packet.bytes(), |received| all.push(received.unwrap())));
        all
    }

    /// The first packet of a scene, played to a release.
    fn first(scene: &str, release: Release) -> state::Repr {
        let plan = plan(scene);
        let mut setup = setup(&plan, None);
        setup.options.controller = Some(Controller::Betaflight(release));
        let (mut encoder, mut packets) = (encoder(Protocol::Betaflight, &setup), Vec::new());
        let _ = crate::player::Player::new(&plan, plan.duration, 1).play(|moment| {
            encoder
                .encode(&Now { t: moment.t, truth: moment.truth, readings: moment.readings }, &mut packets);
            Err(())
        });
        states(&packets)[0]
    }

    /// The golden packet whose name begins so.
    fn golden(name: &str) -> state::Repr {
        let file: serde_json::Value = serde_json::from_str(VECTORS).unwrap();
        let named = |packet: &&serde_json::Value| packet["name"].as_str().unwrap().starts_with(name);
        let hex = file["packets"].as_array().unwrap().iter().find(named).unwrap()["hex"].as_str().unwrap();
        let bytes: Vec<u8> =
            (0..hex.len()).step_by(2).map(|at| u8::from_str_radix(&hex[at..at + 2], 16).unwrap()).collect();
        state::Repr::parse(&state::Payload::new_checked(&bytes).unwrap())
    }

    /// The same to a part in 10¹⁴: where an attitude is in it, another implementation rounds its last bit otherwise.
    fn same(seen: &state::Repr, expected: &state::Repr) -> bool {
        let values = |it: &state::Repr| {
            let mut bytes = [0; state::LEN];
            it.emit(&mut state::Payload::new_checked(&mut bytes).unwrap());
            bytes.chunks(8).map(|bytes| f64::from_le_bytes(bytes.try_into().unwrap())).collect::<Vec<_>>()
        };
        let near = |(a, b): (f64, f64)| (a - b).abs() <= 1e-14 * b.abs().max(1.0);
        values(seen).into_iter().zip(values(expected)).all(near)
    }

    #[test]
    fn a_scene_is_the_golden_packets_of_each_release() {
        let level = format!("duration = \"1 s\"\n{SENSORS}");
        let turn = format!("{TURN}{SENSORS}");
        let [still, new, old] = ["level and still", "at roll 30", "the same for 2025.12"].map(golden);
        assert_eq!(first(&level, Release::Y2026M6), still);
        assert_eq!(first(&turn, Release::Y2026M6), new);
        for release in [Release::Y2025M12, Release::V4M5] {
            assert!(same(&first(&turn, release), &old), "{release}");
        }
        assert_eq!(first(&turn, Release::Y2026M6Legacy), state::Repr { gyro: old.gyro, ..new });
        // Negative controls: a mistake in sign or release is not golden.
        assert!(!same(&first(&turn, Release::Y2025M12), &new));
        assert_ne!(first(&turn.replace("[30, 10", "[-30, 10"), Release::Y2026M6), new);
    }

    /// What the firmware makes of what is sent: scaled, and its fraction dropped.
    #[test]
    fn the_firmware_reads_the_count_nearest_to_a_reading() {
        for k in -1000..1000 {
            let (dps, g) = (f64::from(k) * 0.731, f64::from(k) * 0.0031);
            let read = (rate(dps.to_radians()).to_degrees() * GYRO_COUNTS).trunc() / GYRO_COUNTS_READ;
            assert!((read - dps).abs() <= 0.5 / GYRO_COUNTS_READ + 1e-9, "{read} of {dps} deg/s");
            let read = (force(g * STANDARD_GRAVITY) / STANDARD_GRAVITY * ACCEL_COUNTS).trunc() / ACCEL_COUNTS;
            assert!((read - g).abs() <= 0.5 / ACCEL_COUNTS + 1e-9, "{read} of {g} g");
        }
        // Negative control: sent as it is, a rate reads a part in a thousand too high.
        let plain = (1000.0 * GYRO_COUNTS).trunc() / GYRO_COUNTS_READ;
        assert!(plain - 1000.0 > 0.9, "{plain}");
        let read = (rate(1e6) * 1f64.to_degrees() * GYRO_COUNTS).trunc();
        assert_eq!(read, MAX_COUNT, "clipped");
    }

    #[test]
    fn a_barometer_is_the_pressure_and_the_altitude_that_the_firmware_finds_it_at() {
        let scene = format!(
            "[earth]\nlatitude = \"50 deg\"\nlongitude = \"10 deg\"\naltitude = \"500 m\"\nfield = \"[20, 0, 45] uT\"\n[[motion]]\nkind = \"hold\"\nduration = \"1 s\"\n{SENSORS}[baro]\nrate = \"100 Hz\"\n"
        );
        let state = first(&scene, Release::Y2026M6);
        // Read in the firmware: an `int` of this.
        let pressure = 101_325.0 * (1.0 - 2.25577e-5 * state.position[2]).powf(5.25588);
        assert!((pressure - state.pressure).abs() < 0.01, "{pressure} {state:?}");
        assert!((state.position[2] - 500.0).abs() < 1.0, "{state:?}");
        assert_eq!(first(&format!("duration = \"1 s\"\n{SENSORS}"), Release::Y2026M6).position, [0.0; 3]);
    }

    #[test]
    fn the_timestamp_stands_and_the_last_packet_is_that_of_a_vehicle_that_has_stopped() {
        let scene = plan(&format!("{TURN}{SENSORS}"));
        let mut encoder = encoder(Protocol::Betaflight, &setup(&scene, None));
        let mut packets = Vec::new();
        encoder.farewell(&Truth { t: SimTime(NANOS), ..scene.trajectory.at(scene.duration) }, &mut packets);
        assert!(packets.is_empty(), "nothing was sent, so nothing turns");
        let played = crate::player::Player::new(&scene, scene.duration, 10).play(|moment| {
            encoder
                .encode(&Now { t: moment.t, truth: moment.truth, readings: moment.readings }, &mut packets);
            Ok::<(), std::convert::Infallible>(())
        });
        played.unwrap();
        encoder.farewell(&Truth { t: SimTime(NANOS), ..scene.trajectory.at(scene.duration) }, &mut packets);
        let all = states(&packets);
        assert_eq!((all.len(), packets.len()), (101, 101));
        assert!(all.iter().all(|state| state.timestamp == all[0].timestamp));
        let [before, last] = [all[99], all[100]];
        assert!(before.gyro.iter().all(|rate| *rate != 0.0), "{before:?}");
        assert_eq!(last.gyro, [0.0; 3]);
        assert!(
            last.accel.iter().zip(before.accel).all(|(last, before)| (last - before).abs() < 0.05),
            "{last:?}"
        );
        assert_eq!(play(&scene, Protocol::Betaflight, None).0.len(), 100);
    }
}
