//! A scene built in Rust.

use super::{Plan, SceneError};
use crate::sensor::SensorKind;
use toml::{Table, Value};

/// Builds a scene without a file: the same keys, values and checks as in TOML, and the same mistakes.
///
/// ```
/// use ratetable::scene::Builder;
/// use ratetable::sensor::SensorKind;
///
/// let plan = Builder::new("turning")
///     .set("seed", 7)
///     .motion("rotate", &[("yaw", "20 deg/s"), ("duration", "5 s")])
///     .sensor(SensorKind::Gyro, &[("part", "MPU-9250"), ("rate", "1 kHz")])
///     .sensor(SensorKind::Accel, &[("rate", "500 Hz"), ("noise_std", "0.02 m/s^2")])
///     .build()?;
/// assert_eq!(plan.sensors.len(), 2);
///
/// let mistake = Builder::new("wrong").sensor(SensorKind::Gyro, &[("rate", "1 km")]).build().unwrap_err();
/// assert!(mistake.to_string().contains("rate"));
/// # Ok::<(), ratetable::scene::SceneError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Builder {
    name: String,
    scene: Table,
}

impl Builder {
    /// An empty scene of this name, which stands for the file in messages.
    pub fn new(name: impl Into<String>) -> Builder {
        Builder { name: name.into(), scene: Table::new() }
    }

    /// Sets a key: of the scene (`seed`), or of one of its tables (`earth.latitude`). The last value of a key counts.
    pub fn set(mut self, key: &str, value: impl Into<Value>) -> Builder {
        let (tables, last) = key.rsplit_once('.').unwrap_or(("", key));
        let mut table = &mut self.scene;
        for name in tables.split('.').filter(|name| !name.is_empty()) {
            let entry = table.entry(name).or_insert_with(|| Table::new().into());
            if !entry.is_table() {
                // A key below one that is no table is a mistake that `build` reports by its whole name.
                self.scene.insert(key.to_string(), value.into());
                return self;
            }
            let Value::Table(inner) = entry else { return self };
            table = inner;
        }
        table.insert(last.to_string(), value.into());
        self
    }

    /// Appends a motion of this kind with these keys: [`motion::KINDS`](crate::motion::KINDS).
    pub fn motion(self, kind: &str, keys: &[(&str, &str)]) -> Builder {
        self.append("motion", [("kind", kind)].iter().chain(keys))
    }

    /// Appends a fault of a sensor or an output.
    pub fn fault(self, keys: &[(&str, &str)]) -> Builder {
        self.append("fault", keys.iter())
    }

    /// Appends an output, such as `mpu@pty`.
    pub fn output(self, to: &str) -> Builder {
        self.append("output", [("to", to)].iter())
    }

    /// Adds a sensor with these keys to those that it has; a key that is no text goes through [`Builder::set`], as
    /// `gyro.flicker`.
    pub fn sensor(mut self, kind: SensorKind, keys: &[(&str, &str)]) -> Builder {
        self.scene.entry(kind.name()).or_insert_with(|| Table::new().into());
        keys.iter().fold(self, |scene, (key, value)| scene.set(&format!("{kind}.{key}"), *value))
    }

    fn append<'k>(mut self, list: &str, keys: impl Iterator<Item = &'k (&'k str, &'k str)>) -> Builder {
        let table: Table = keys.map(|(key, value)| (key.to_string(), Value::from(*value))).collect();
        let entry = self.scene.entry(list).or_insert_with(|| Value::Array(Vec::new()));
        if let Value::Array(tables) = entry {
            tables.push(table.into());
        }
        self
    }

    /// The scene as TOML: lines and columns of mistakes are of this text.
    pub fn toml(&self) -> String {
        self.scene.to_string()
    }

    /// Checks it.
    ///
    /// # Errors
    /// Every mistake in it.
    pub fn build(&self) -> Result<Plan, SceneError> {
        Plan::parse(&self.toml(), &self.name, &self.name, &[])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_in_which_keys_are_given_loses_none() {
        let keys = [("rate", "100 Hz"), ("bias_instability", "0.01 deg/s")];
        let scene = || Builder::new("s").set("duration", "1 s");
        let before = scene().set("gyro.flicker", true).sensor(SensorKind::Gyro, &keys);
        let after = scene().sensor(SensorKind::Gyro, &keys).set("gyro.flicker", true);
        for scene in [before, after] {
            let plan = scene.build().unwrap_or_else(|error| panic!("{error}"));
            assert!(plan.build(&plan.sensors[0]).terms().contains(&"flicker"), "{}", scene.toml());
        }
    }

    #[test]
    fn a_key_below_one_that_is_no_table_is_a_mistake() {
        let scene = Builder::new("s").set("duration", "1 s").sensor(SensorKind::Gyro, &[("rate", "1 Hz")]);
        let mistake = scene.set("seed", 1).set("seed.more", 2).build().unwrap_err().to_string();
        assert!(mistake.contains("seed.more"), "{mistake}");
    }
}
