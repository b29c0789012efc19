//! The datasheets' own figures, in SI, as `sheets.toml` has them.

use ratetable::sensor::SensorKind;

/// Standard gravity, m/s².
pub const G: f64 = 9.80665;

/// What the sheet of a part says of one of its sensors.
pub struct Sheet {
    pub kind: SensorKind,
    table: toml::Table,
    /// What every figure is multiplied by: 1, but for the negative control.
    doctored: f64,
}

/// A figure for each axis.
pub type Axes = [f64; 3];

impl Sheet {
    /// Of a part by its first name; `None` for a sensor that its sheet has not.
    pub fn of(part: &str, kind: SensorKind, doctored: f64) -> Option<Sheet> {
        let all: toml::Table = include_str!("sheets.toml").parse().expect("TOML");
        let table = all.get(part)?.get(kind.name())?.as_table()?.clone();
        Some(Sheet { kind, table, doctored })
    }

    /// The unit of a line's figures in SI, and how it is printed.
    pub fn unit(&self, line: &str) -> (f64, &'static str) {
        let dps = 1f64.to_radians();
        match (self.kind, line) {
            (_, "scale" | "scale_temperature" | "cross_axis" | "nonlinearity") => (0.01, "%"),
            (SensorKind::Gyro, "noise") => (dps, "°/s/√Hz"),
            (SensorKind::Accel, "noise") => (1e-6 * G, "µg/√Hz"),
            (SensorKind::Gyro, "g") => (dps / G, "°/s/g"),
            (SensorKind::Gyro, "stability") => (dps / 3600.0, "°/h"),
            (SensorKind::Accel, "stability") => (1e-6 * G, "µg"),
            (SensorKind::Gyro, _) => (dps, "°/s"),
            (SensorKind::Accel, "counts") => (G, "g"),
            (SensorKind::Accel, _) => (1e-3 * G, "mg"),
            _ => (1.0, "µT"),
        }
    }

    /// A line's figure for each axis (per kelvin where it is one of temperature) in SI, and as the sheet has it.
    pub fn figure(&self, line: &str) -> Option<(Axes, String)> {
        let value = self.table.get(line)?;
        let (unit, name) = self.unit(line);
        let axes = |value: &toml::Value| match value.as_array() {
            Some(axes) => [0, 1, 2].map(|axis| number(&axes[axis])),
            None => [number(value); 3],
        };
        let shown = |value: &toml::Value| match value.as_array() {
            Some(axes) => axes.iter().map(|x| number(x).to_string()).collect::<Vec<_>>().join(", "),
            None => number(value).to_string(),
        };
        let (figure, kelvin, text) = if line.ends_with("_temperature") {
            let pair = value.as_array().expect("[change, kelvin]");
            let kelvin = number(&pair[1]);
            let over = if kelvin == 1.0 { "/K".into() } else { format!(" over {kelvin} K") };
            (axes(&pair[0]), kelvin, format!("±{} {name}{over}", shown(&pair[0])))
        } else {
            let sign = if ["noise", "stability"].contains(&line) { "" } else { "±" };
            (axes(value), 1.0, format!("{sign}{} {name}", shown(value)))
        };
        Some((figure.map(|x| self.doctored * x * unit / kelvin), text))
    }

    /// Full scale and size of one count in SI of each range, and as the sheet has it.
    pub fn counts(&self) -> Vec<(f64, f64, String)> {
        let (unit, name) = self.unit("counts");
        let row = |row: &toml::Value| {
            let row = row.as_array().expect("[range, counts]");
            let (range, counts) = (number(&row[0]), number(&row[1]));
            let lsb = self.doctored / counts * unit;
            let counts = (counts * 1000.0).round() / 1000.0;
            (range * unit, lsb, format!("±{range} {name}, {counts} LSB for 1 {name}"))
        };
        self.table["counts"].as_array().expect("rows").iter().map(row).collect()
    }
}

fn number(value: &toml::Value) -> f64 {
    value.as_float().or(value.as_integer().map(|whole| whole as f64)).expect("a number")
}
