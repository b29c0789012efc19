//! Parts as data files: what a datasheet says of a sensor, each value with its source.

use super::SensorKind;

/// A part's data file.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    /// Its name, then others for the same data.
    pub names: &'static [&'static str],
    /// One line about it.
    pub about: &'static str,
    /// What messages call the file.
    pub file: &'static str,
    /// The file itself.
    pub text: &'static str,
}

/// One value of a part and where it comes from.
#[derive(Clone, Debug)]
pub struct Sourced {
    /// Of which sensor.
    pub sensor: SensorKind,
    /// Which key.
    pub key: String,
    /// As written.
    pub value: String,
    /// Datasheet and page, or `assumed: …`.
    pub source: String,
}

static PARTS: [Part; 2] = [
    Part {
        names: &["MPU-6050", "MPU-6000"],
        about: "six axes, TDK InvenSense",
        file: "parts/mpu-6050.toml",
        text: include_str!("parts/mpu-6050.toml"),
    },
    Part {
        names: &["MPU-9250", "AK8963"],
        about: "nine axes, TDK InvenSense, with AKM's AK8963 magnetometer inside",
        file: "parts/mpu-9250.toml",
        text: include_str!("parts/mpu-9250.toml"),
    },
];

/// Every part.
pub fn all() -> &'static [Part] {
    &PARTS
}

/// The part of that name, whatever its case.
pub fn find(name: &str) -> Option<&'static Part> {
    PARTS.iter().find(|part| part.names.iter().any(|known| known.eq_ignore_ascii_case(name)))
}
