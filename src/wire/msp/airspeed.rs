//! The airspeed at the end of a simulator message, which INAV wants as one that an instrument shows.

use crate::earth::{dynamic_pressure, indicated_airspeed};
use ratetable_protocols::msp::{simulator, simulator_air};

/// Centimetres a metre.
const CENTI: f64 = 100.0;

/// The message with the airspeed of a pitot tube that reads so many Pa. One in air from behind shows 0.
pub(super) fn with(mut readings: simulator::Repr, pressure: f64) -> simulator_air::Repr {
    readings.flags |= simulator_air::EXTERNAL_VOLTAGE | simulator_air::AIRSPEED | simulator_air::MORE_FLAGS;
    let airspeed = libm::round(indicated_airspeed(pressure) * CENTI) as u16;
    let tail = simulator_air::tail::Repr { voltage: simulator_air::FULL, airspeed, more_flags: 0 };
    simulator_air::Repr { readings, tail }
}

/// What the pitot tube reads of a message, Pa.
pub(super) fn pressure(message: &simulator_air::Repr) -> f64 {
    dynamic_pressure(f64::from(message.tail.airspeed) / CENTI)
}
