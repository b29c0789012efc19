//! Drivers: a stream of bytes becomes readings in body axes.

mod mavlink;
mod mpu;

use std::fmt;
use std::str::FromStr;

pub use mavlink::MavlinkDriver;
pub(crate) use mavlink::readings;
pub use mpu::{Mount, MpuDriver};

use crate::sample::Sample;

/// What a board speaks on its link.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Protocol {
    /// Register images of an MPU.
    #[default]
    Mpu,
    /// MAVLink's `HIL_SENSOR`.
    Mavlink,
}

impl Protocol {
    /// The driver for it, with its default settings.
    pub fn driver(self) -> Box<dyn Driver + Send> {
        match self {
            Self::Mpu => Box::new(MpuDriver::new(Mount::FLU)),
            Self::Mavlink => Box::new(MavlinkDriver::new()),
        }
    }
}

impl FromStr for Protocol {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        match name {
            "mpu" => Ok(Self::Mpu),
            "mavlink" => Ok(Self::Mavlink),
            other => Err(format!("no protocol `{other}`: mpu or mavlink")),
        }
    }
}

impl fmt::Display for Protocol {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Mpu => "mpu",
            Self::Mavlink => "mavlink",
        })
    }
}

/// What has arrived so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// Whole packets of any kind.
    pub packets: u64,
    /// Stretches of bytes that were no packet, or one with a wrong checksum.
    pub damaged: u64,
    /// Packets missing by their sequence numbers.
    pub lost: u64,
    /// Gyro readings taken.
    pub gyro: u64,
    /// Accelerometer readings taken.
    pub accel: u64,
    /// Magnetometer readings taken.
    pub mag: u64,
    /// Readings left: before the first configuration, overflowed, or not new.
    pub skipped: u64,
}

impl Counts {
    /// Counts the readings of a sample.
    fn take(&mut self, sample: &Sample) {
        self.gyro += u64::from(sample.gyro.is_some());
        self.accel += u64::from(sample.accel.is_some());
        self.mag += u64::from(sample.mag.is_some());
    }
}

/// Turns a stream of bytes into readings.
pub trait Driver {
    /// Takes more bytes and calls `on` with each sample that they complete.
    fn feed(&mut self, bytes: &[u8], on: &mut dyn FnMut(Sample));

    /// What has arrived so far.
    fn counts(&self) -> Counts;
}
