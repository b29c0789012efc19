//! `mavlink`, versions 1 and 2: HIL_SENSOR from simulators; HIGHRES_IMU, SCALED_IMU, SCALED_IMU2, SCALED_IMU3 and
//! RAW_IMU from autopilots, with readings of their own sensors. Gives one sample for each sensor that a message
//! marks as new.

use super::damage::Stretches;
use crate::earth::STANDARD_GRAVITY;
use crate::sensor::SensorKind;
use crate::time::SimTime;
use crate::wire::mavlink::{MICROTESLA_A_GAUSS, PASCALS_A_HECTOPASCAL};
use crate::wire::samples::{self, Carrier, Counts, Sample, Sensed, Source, log};
use ratetable_protocols::mavlink::{
    Decoder, Header, MAX_LEN, Message, Received, Version, encode, heartbeat, highres_imu, hil_sensor, known,
    scaled_imu,
};
use ratetable_protocols::{Error, Losses};
use std::collections::BTreeMap;

/// The heartbeat of a ground station: MAV_TYPE_GCS, no autopilot, active.
pub(super) fn ground_station(seq: u8) -> Vec<u8> {
    let header = Header { version: Version::V2, seq, system: 255, component: 190 };
    let beat =
        heartbeat::Repr { kind: 6, autopilot: 8, system_status: 4, mavlink_version: 3, ..Default::default() };
    let mut buffer = [0; MAX_LEN];
    let len = encode(&header, &Message::Heartbeat(beat), &mut buffer).unwrap_or(0);
    buffer[..len].to_vec()
}

#[derive(Default)]
pub(super) struct Reader {
    decoder: Decoder,
    senders: Senders,
    /// The start of a recording, until it is known whether it has stamps.
    unjudged: Option<Vec<u8>>,
}

impl Reader {
    /// A reader for a recording, which may be a ground station's log.
    pub(super) fn recorded() -> Reader {
        Reader { unjudged: Some(Vec::new()), ..Reader::default() }
    }

    /// Decides what kind of recording it is, and reads the held bytes accordingly.
    fn judge(&mut self, counts: &mut Counts, each: &mut dyn FnMut(Sample)) {
        let Some(held) = self.unjudged.take() else { return };
        if log::has_stamps(&held) {
            self.decoder = Decoder::stamped();
            counts.stamps = Some(log::Stamps::default());
        }
        self.read(&held, counts, each);
    }

    fn read(&mut self, bytes: &[u8], counts: &mut Counts, each: &mut dyn FnMut(Sample)) {
        let Reader { decoder, senders, .. } = self;
        decoder.feed(bytes, |received| senders.take(received, counts, each));
    }
}

impl samples::Reader for Reader {
    fn feed(&mut self, bytes: &[u8], counts: &mut Counts, each: &mut dyn FnMut(Sample)) {
        match &mut self.unjudged {
            Some(held) => {
                held.extend_from_slice(bytes);
                if held.len() >= log::JUDGED {
                    self.judge(counts, each);
                }
            }
            None => self.read(bytes, counts, each),
        }
    }

    fn finish(&mut self, counts: &mut Counts, each: &mut dyn FnMut(Sample)) {
        self.judge(counts, each);
        let Reader { decoder, senders, .. } = self;
        decoder.finish(|received| {
            if received.is_ok() {
                senders.take(received, counts, each);
            }
        });
    }
}

/// The senders heard, by system and component: several may share a link.
#[derive(Default)]
struct Senders {
    all: BTreeMap<[u8; 2], Sender>,
    stretches: Stretches,
    /// Bytes of the shortest packet; 0 before the first.
    shortest: usize,
}

#[derive(Default)]
struct Sender {
    losses: Losses,
    /// The sequence numbers of unchecked packets since the last checked one.
    unchecked: Vec<u8>,
    /// The number of damaged stretches at its last packet.
    stretches: u64,
}

impl Senders {
    fn take(&mut self, received: Result<Received, Error>, counts: &mut Counts, each: &mut dyn FnMut(Sample)) {
        let Ok(received) = received else {
            let before = counts.damaged;
            counts.refuse();
            if counts.damaged > before {
                self.stretches.begin();
            }
            return;
        };
        counts.packets += 1;
        let carrier = Carrier { arrived: received.stamp_us.and_then(log::time), lost: None };
        counts.stamps.as_mut().zip(carrier.arrived).into_iter().for_each(|(stamps, t)| stamps.take(t));
        let lost = self.number(&received, counts);
        let Received { header: Header { system, component, .. }, id, message, .. } = received;
        let carrier = Carrier { lost: Some(lost), ..carrier };
        match message.and_then(|message| Inertial::of(&message, [system, component])) {
            Some(inertial) if inertial.is_fresh() => inertial.hand_on(carrier, each),
            _ => match known(id) {
                Some(known) => counts.foreign(known.name),
                None => counts.foreign(&format!("message {id}")),
            },
        }
    }

    /// Records a packet's sequence number; returns how many of its sender's packets are lost so far.
    fn number(&mut self, received: &Received, counts: &mut Counts) -> u64 {
        let Received { header: Header { seq, system, component, .. }, len, skipped, checked, .. } = *received;
        self.stretches.end(skipped, if self.shortest == 0 { len } else { self.shortest });
        self.shortest = if self.shortest == 0 { len } else { self.shortest.min(len) };
        let sender = self.all.entry([system, component]).or_default();
        if checked {
            let before = counts.lost;
            sender.number(seq, counts);
            let missing = counts.lost.saturating_sub(before);
            counts.damaged += self.stretches.claim(sender.stretches, missing);
            sender.stretches = self.stretches.begun();
        } else {
            counts.unchecked += 1;
            if sender.unchecked.len() < 256 {
                sender.unchecked.push(seq);
            }
        }
        sender.losses.lost()
    }
}

impl Sender {
    /// A longer gap more likely means that a packet was overtaken.
    const LONGEST_GAP: u8 = 239;

    /// Records the number of a checked packet. Unchecked packets between it and the last checked one fill the gap;
    /// a wrong number among them opens no gap.
    fn number(&mut self, seq: u8, counts: &mut Counts) {
        let gap = self.last().map_or(0, |last| seq.wrapping_sub(last).wrapping_sub(1));
        if gap < Sender::LONGEST_GAP
            && let Some(last) = self.last()
        {
            let mut between: Vec<u8> = self
                .unchecked
                .iter()
                .map(|other| other.wrapping_sub(last))
                .filter(|k| (1..=gap).contains(k))
                .collect();
            between.sort_unstable();
            between.dedup();
            between.into_iter().for_each(|k| counts.number(&mut self.losses, last.wrapping_add(k)));
        }
        self.unchecked.clear();
        counts.number(&mut self.losses, seq);
    }

    fn last(&self) -> Option<u8> {
        self.losses.last()
    }
}

/// The barometer's bits in HIL_SENSOR; the temperature may be that of another sensor.
const ABSOLUTE: u32 = hil_sensor::PRESSURE & !hil_sensor::TEMPERATURE;

/// The content of a message with readings.
struct Inertial {
    source: Source,
    t: Option<SimTime>,
    /// Each new reading, with its value where the message gives the unit.
    fresh: [Option<(SensorKind, Option<Sensed>)>; 5],
}

impl Inertial {
    /// `None` for messages without readings.
    fn of(message: &Message, [system, component]: [u8; 2]) -> Option<Inertial> {
        let source = |set| Source { message: message.name(), set: [system, component, set] };
        let (id, ns, fresh) = match message {
            Message::HilSensor(seen) => {
                let new = |mask| seen.fields_updated & mask != 0;
                let fresh = [
                    new(hil_sensor::GYRO).then(|| triad(SensorKind::Gyro, seen.gyro, 1.0)),
                    new(hil_sensor::ACCEL).then(|| triad(SensorKind::Accel, seen.accel, 1.0)),
                    new(hil_sensor::MAG).then(|| triad(SensorKind::Mag, seen.mag, MICROTESLA_A_GAUSS)),
                    new(ABSOLUTE).then(|| pressure(SensorKind::Baro, seen.abs_pressure)),
                    new(hil_sensor::DIFF_PRESSURE)
                        .then(|| pressure(SensorKind::Airspeed, seen.diff_pressure)),
                ];
                (seen.id, micros(seen.time_usec), fresh)
            }
            Message::HighresImu(seen) => {
                let new = |mask| seen.fields_updated & mask != 0;
                let fresh = [
                    new(highres_imu::GYRO).then(|| triad(SensorKind::Gyro, seen.gyro, 1.0)),
                    new(highres_imu::ACCEL).then(|| triad(SensorKind::Accel, seen.accel, 1.0)),
                    new(highres_imu::MAG).then(|| triad(SensorKind::Mag, seen.mag, MICROTESLA_A_GAUSS)),
                    new(highres_imu::ABS_PRESSURE).then(|| pressure(SensorKind::Baro, seen.abs_pressure)),
                    None,
                ];
                (seen.id, micros(seen.time_usec), fresh)
            }
            Message::ScaledImu(seen) | Message::ScaledImu2(seen) | Message::ScaledImu3(seen) => {
                let scaled_imu::Repr { time_boot_ms, accel, gyro, mag, .. } = seen;
                let milli = Some([1e-3, 1e-3 * STANDARD_GRAVITY, 1e-3 * MICROTESLA_A_GAUSS]);
                let ns = Some(i64::from(*time_boot_ms) * 1_000_000);
                (0, ns, counts([*gyro, *accel, *mag], milli))
            }
            Message::RawImu(seen) => {
                (seen.id, micros(seen.time_usec), counts([seen.gyro, seen.accel, seen.mag], None))
            }
            _ => return None,
        };
        Some(Inertial { source: source(id), t: ns.map(SimTime), fresh })
    }

    fn is_fresh(&self) -> bool {
        self.fresh.iter().any(Option::is_some)
    }

    fn hand_on(&self, packet: Carrier, each: &mut dyn FnMut(Sample)) {
        let Inertial { source, t, fresh } = *self;
        for (kind, value) in fresh.into_iter().flatten() {
            each(Sample { kind, source, t, value, packet });
        }
    }
}

/// Body axes, from units of `unit`.
fn triad(kind: SensorKind, values: [f32; 3], unit: f64) -> (SensorKind, Option<Sensed>) {
    (kind, Sensed::triad(values, unit))
}

fn pressure(kind: SensorKind, hectopascals: f32) -> (SensorKind, Option<Sensed>) {
    (kind, Sensed::Pressure(f64::from(hectopascals) * PASCALS_A_HECTOPASCAL).known())
}

/// Gyro, accel and mag of a message in counts; `units` is the size of a count of each. Without a mask the message
/// has the first two, and a field of exactly zero means that there is no magnetometer.
fn counts(values: [[i16; 3]; 3], units: Option<[f64; 3]>) -> [Option<(SensorKind, Option<Sensed>)>; 5] {
    let present = |kind: SensorKind| kind != SensorKind::Mag || values[2] != [0; 3];
    let reading = |kind: SensorKind| {
        let i = kind as usize;
        (kind, units.and_then(|units| Sensed::triad(values[i], units[i])))
    };
    let [gyro, accel, mag] = SensorKind::TRIADS.map(|kind| present(kind).then(|| reading(kind)));
    [gyro, accel, mag, None, None]
}

/// µs to ns; `None` if it does not fit.
fn micros(us: u64) -> Option<i64> {
    i64::try_from(us).ok()?.checked_mul(1000)
}
