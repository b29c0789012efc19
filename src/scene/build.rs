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

    /// Sets a key: of the scene (`seed`), or of one of its tables (`earth.latitude`).
    pub fn set(mut self, key: &str, value: impl Into<Value>) -> Builder {
        let (tables, key) = key.rsplit_once('.').map_or(("", key), |(tables, key)| (tables, key));
        let mut table = &mut self.scene;
        for name in tables.split('.').filter(|name| !name.is_empty()) {
            let entry = table.entry(name).or_insert_with(|| Table::new().into());
            if !entry.is_table() {
                *entry = Table::new().into();
            }
            let Value::Table(inner) = entry else { return self };
            table = inner;
        }
        table.insert(key.to_string(), value.into());
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

    /// Adds a sensor with these keys; a key that is no text goes through [`Builder::set`], as `gyro.flicker`.
    pub fn sensor(self, kind: SensorKind, keys: &[(&str, &str)]) -> Builder {
        let table = |keys: &[(&str, &str)]| -> Table {
            keys.iter().map(|(key, value)| (key.to_string(), Value::from(*value))).collect()
        };
        self.set(kind.name(), table(keys))
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
