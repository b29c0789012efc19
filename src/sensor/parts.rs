//! Parts as data files: what a datasheet says of a sensor, each value with its source.

use super::SensorKind;

/// A part's data file.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    /// Its name, then others for the same data.
    pub names: &'static [&'static str],
    /// Names of the parts inside it, each for one sensor alone.
    pub inside: &'static [(&'static str, SensorKind)],
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

static PARTS: [Part; 11] = [
    Part {
        names: &["MPU-6050", "MPU-6000"],
        inside: &[],
        about: "six axes, TDK InvenSense",
        file: "parts/mpu-6050.toml",
        text: include_str!("parts/mpu-6050.toml"),
    },
    Part {
        names: &["MPU-6500"],
        inside: &[],
        about: "six axes, TDK InvenSense",
        file: "parts/mpu-6500.toml",
        text: include_str!("parts/mpu-6500.toml"),
    },
    Part {
        names: &["MPU-9250"],
        inside: &[("AK8963", SensorKind::Mag)],
        about: "nine axes, TDK InvenSense, with AKM's AK8963 magnetometer inside",
        file: "parts/mpu-9250.toml",
        text: include_str!("parts/mpu-9250.toml"),
    },
    Part {
        names: &["ICM-20948"],
        inside: &[("AK09916", SensorKind::Mag)],
        about: "nine axes, TDK InvenSense, with AKM's AK09916 magnetometer inside",
        file: "parts/icm-20948.toml",
        text: include_str!("parts/icm-20948.toml"),
    },
    Part {
        names: &["ICM-42688-P"],
        inside: &[],
        about: "six axes, TDK InvenSense",
        file: "parts/icm-42688-p.toml",
        text: include_str!("parts/icm-42688-p.toml"),
    },
    Part {
        names: &["BMI088"],
        inside: &[],
        about: "six axes for high vibration, Bosch Sensortec",
        file: "parts/bmi088.toml",
        text: include_str!("parts/bmi088.toml"),
    },
    Part {
        names: &["BMI160"],
        inside: &[],
        about: "six axes, Bosch Sensortec",
        file: "parts/bmi160.toml",
        text: include_str!("parts/bmi160.toml"),
    },
    Part {
        names: &["BMI270"],
        inside: &[],
        about: "six axes, Bosch Sensortec",
        file: "parts/bmi270.toml",
        text: include_str!("parts/bmi270.toml"),
    },
    Part {
        names: &["LSM6DSO"],
        inside: &[],
        about: "six axes, STMicroelectronics",
        file: "parts/lsm6dso.toml",
        text: include_str!("parts/lsm6dso.toml"),
    },
    Part {
        names: &["LSM9DS1"],
        inside: &[],
        about: "nine axes, STMicroelectronics",
        file: "parts/lsm9ds1.toml",
        text: include_str!("parts/lsm9ds1.toml"),
    },
    Part {
        names: &["ADIS16470"],
        inside: &[],
        about: "six axes, calibrated, Analog Devices",
        file: "parts/adis16470.toml",
        text: include_str!("parts/adis16470.toml"),
    },
];

/// Every part.
pub fn all() -> &'static [Part] {
    &PARTS
}

/// The part of that name for a sensor of this kind, whatever the name's case.
pub fn find(name: &str, sensor: SensorKind) -> Option<&'static Part> {
    let is = |known: &str| known.eq_ignore_ascii_case(name);
    let inside = |part: &Part| part.inside.iter().any(|(known, kind)| *kind == sensor && is(known));
    PARTS.iter().find(|part| part.names.iter().any(|known| is(known)) || inside(part))
}

impl Part {
    /// What a sensor of this kind is called whose user asked for `name`: a chip inside by its own name, else the part.
    pub fn called(&self, name: &str, sensor: SensorKind) -> &'static str {
        let mut inside = self.inside.iter().filter(|(_, kind)| *kind == sensor);
        inside.find(|(known, _)| known.eq_ignore_ascii_case(name)).map_or(self.names[0], |(known, _)| known)
    }
}

/// Every name by which a sensor of this kind may ask for a part.
pub fn names(sensor: SensorKind) -> impl Iterator<Item = &'static str> {
    let inside = move |part: &'static Part| part.inside.iter().filter(move |(_, kind)| *kind == sensor);
    PARTS.iter().flat_map(move |part| part.names.iter().copied().chain(inside(part).map(|(name, _)| *name)))
}
