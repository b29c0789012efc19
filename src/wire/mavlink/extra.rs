//! Optional messages beside HIL_SENSOR.
//!
//! They repeat the newest readings or give the truth, 50 times a second of scene time: each goes out at the first
//! tick of any sensor at or after its due time. To add one: its variant, name and line of help, and its arm in
//! `Sender::message`.

use super::{MICROTESLA_A_GAUSS, Readings};
use crate::earth::STANDARD_GRAVITY;
use crate::motion::Truth;
use crate::sensor::{Kinds, SensorKind};
use crate::time::{NANOS, SimTime};
use ratetable_protocols::mavlink::{
    Message, attitude_quaternion, highres_imu, hil_state_quaternion, raw_imu, scaled_imu2,
};

/// How often each is sent.
const RATE_HZ: i64 = 50;

/// An optional message of `mavlink`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extra {
    /// The true attitude, angular rate and specific force.
    HilStateQuaternion,
    /// The true attitude and angular rate, in the message an autopilot uses for its own.
    AttitudeQuaternion,
    /// The readings, in the message an autopilot uses for its own sensors.
    HighresImu,
    /// The readings in counts.
    RawImu,
    /// The readings in thousandths of g, rad/s and gauss.
    ScaledImu2,
}

impl Extra {
    /// Every extra message.
    pub const ALL: [Extra; 5] = [
        Extra::HilStateQuaternion,
        Extra::AttitudeQuaternion,
        Extra::HighresImu,
        Extra::RawImu,
        Extra::ScaledImu2,
    ];

    /// Its name in MAVLink's definitions and in a scene.
    pub const fn name(self) -> &'static str {
        ["HIL_STATE_QUATERNION", "ATTITUDE_QUATERNION", "HIGHRES_IMU", "RAW_IMU", "SCALED_IMU2"]
            [self as usize]
    }

    /// The message of that name.
    pub fn from_name(name: &str) -> Option<Extra> {
        Self::ALL.into_iter().find(|extra| extra.name() == name)
    }

    /// Whether it carries the truth, which must not reach a controller that estimates it.
    pub const fn is_truth(self) -> bool {
        matches!(self, Extra::HilStateQuaternion | Extra::AttitudeQuaternion)
    }
}

/// A set of [`Extra`] messages.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Extras(u8);

impl Extras {
    /// This set with one more.
    #[must_use]
    pub const fn with(self, extra: Extra) -> Extras {
        Extras(self.0 | 1 << extra as u8)
    }

    /// The messages in it.
    pub fn iter(self) -> impl Iterator<Item = Extra> {
        Extra::ALL.into_iter().filter(move |extra| self.0 >> *extra as u8 & 1 == 1)
    }
}

/// Sends one of them.
#[derive(Debug)]
pub(super) struct Sender {
    pub extra: Extra,
    next: SimTime,
    /// The sensor kinds that ticked since the previous message.
    fresh: Kinds,
}

impl Sender {
    pub(super) fn new(extra: Extra) -> Sender {
        Sender { extra, next: SimTime::ZERO, fresh: Kinds::NONE }
    }

    /// Records which sensors ticked, and says whether the message is due.
    pub(super) fn is_due(&mut self, t: SimTime, ticked: Kinds) -> bool {
        let every = NANOS / RATE_HZ;
        self.fresh |= ticked;
        let due = t >= self.next;
        if due {
            self.next = SimTime((t.0.div_euclid(every) + 1) * every);
        }
        due
    }

    /// Its present content.
    pub(super) fn message(&mut self, truth: &Truth, readings: &Readings<'_>) -> Message {
        let time_usec = truth.t.0 as u64 / 1000;
        let time_boot_ms = (time_usec / 1000) as u32;
        let q = truth.attitude.q;
        let q = [q.w, q.x, q.y, q.z].map(|x| x as f32);
        let angular_rate = truth.rate.v.to_array().map(|x| x as f32);
        let fresh = std::mem::take(&mut self.fresh);
        let of = |kind, unit: f64| readings.over(kind, unit).map(|x| x as f32);
        let milli = |kind, unit: f64| readings.over(kind, unit * 1e-3).map(nearest);
        let count = |kind: SensorKind| readings.over(kind, readings.counts[kind as usize]).map(nearest);
        let celsius = readings.temperature().unwrap_or(0.0);
        match self.extra {
            Extra::HilStateQuaternion => Message::HilStateQuaternion(hil_state_quaternion::Repr {
                time_usec,
                q,
                angular_rate,
                accel: (truth.force.v / (1e-3 * STANDARD_GRAVITY)).to_array().map(nearest),
                ..Default::default()
            }),
            Extra::AttitudeQuaternion => Message::AttitudeQuaternion(attitude_quaternion::Repr {
                time_boot_ms,
                q,
                angular_rate,
                ..Default::default()
            }),
            Extra::HighresImu => Message::HighresImu(highres_imu::Repr {
                time_usec,
                accel: of(SensorKind::Accel, 1.0),
                gyro: of(SensorKind::Gyro, 1.0),
                mag: of(SensorKind::Mag, MICROTESLA_A_GAUSS),
                temperature: celsius as f32,
                fields_updated: fields(fresh, readings.temperature().is_some()),
                ..Default::default()
            }),
            Extra::RawImu => Message::RawImu(raw_imu::Repr {
                time_usec,
                accel: count(SensorKind::Accel),
                gyro: count(SensorKind::Gyro),
                mag: count(SensorKind::Mag),
                temperature: nearest(celsius * 100.0),
                ..Default::default()
            }),
            Extra::ScaledImu2 => Message::ScaledImu2(scaled_imu2::Repr {
                time_boot_ms,
                accel: milli(SensorKind::Accel, STANDARD_GRAVITY),
                gyro: milli(SensorKind::Gyro, 1.0),
                mag: milli(SensorKind::Mag, MICROTESLA_A_GAUSS),
                temperature: nearest(celsius * 100.0),
            }),
        }
    }
}

/// The bits of HIGHRES_IMU's `fields_updated`.
fn fields(fresh: Kinds, temperature: bool) -> u16 {
    let masks = [
        (SensorKind::Gyro, highres_imu::GYRO),
        (SensorKind::Accel, highres_imu::ACCEL),
        (SensorKind::Mag, highres_imu::MAG),
    ];
    let ticked = masks.into_iter().filter(|(kind, _)| fresh.contains(*kind)).map(|(_, mask)| mask);
    ticked.chain(temperature.then_some(TEMPERATURE)).fold(0, |all, bits| all | bits)
}

/// `HIGHRES_IMU_UPDATED_TEMPERATURE`.
const TEMPERATURE: u16 = 1 << 12;

/// Rounds to 16 bits and clips what is out of range.
fn nearest(x: f64) -> i16 {
    libm::round(x) as i16
}
