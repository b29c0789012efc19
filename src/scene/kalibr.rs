//! `part = "imu.yaml"`: noise as Kalibr's file has it, read as a part.
//!
//! Kalibr's densities are two-sided, in SI: its noise densities are our random walks N (`angle_random_walk`,
//! `velocity_random_walk`: σ = N·√fs) and its random walks our `bias_random_walk` K. Source: Kalibr's wiki, "IMU Noise
//! Model" and "YAML formats".

use super::document::{Table, Value};
use super::section::Section;
use crate::sensor::SensorKind;
use saphyr::{LoadableYamlNode, MarkedYaml};
use std::borrow::Cow;
use std::fs;
use std::path::{Path, PathBuf};

/// A key of the file, ours, its unit, and whether it may be 0.
type Known = (&'static str, &'static str, &'static str, bool);

const RATE: Known = ("update_rate", "rate", "Hz", false);

fn keys(kind: SensorKind) -> Option<[Known; 3]> {
    match kind {
        SensorKind::Gyro => Some([
            RATE,
            ("gyroscope_noise_density", "angle_random_walk", "rad/s/√Hz", true),
            ("gyroscope_random_walk", "bias_random_walk", "rad/s^2/√Hz", true),
        ]),
        SensorKind::Accel => Some([
            RATE,
            ("accelerometer_noise_density", "velocity_random_walk", "m/s^2/√Hz", true),
            ("accelerometer_random_walk", "bias_random_walk", "m/s^3/√Hz", true),
        ]),
        _ => None,
    }
}

/// Whether the section's part is such a file.
pub(super) fn is_meant(section: &Section<'_>) -> bool {
    named(section).is_some_and(|name| {
        let extension = Path::new(name).extension().unwrap_or_default();
        ["yaml", "yml"].iter().any(|known| extension.eq_ignore_ascii_case(known))
    })
}

fn named<'a>(section: &'a Section<'_>) -> Option<&'a str> {
    match &section.entry("part")?.node.value {
        Value::Text(name) => Some(name),
        _ => None,
    }
}

/// What the file says of this sensor, in the shape of a part's own data; its mistakes are told.
pub(super) fn preset(section: &Section<'_>, kind: SensorKind) -> Option<Table> {
    let mistakes = match read(section, kind) {
        Ok(preset) => return Some(preset),
        Err(mistakes) => mistakes,
    };
    mistakes.iter().for_each(|mistake| section.mistake("part", mistake));
    None
}

fn read(section: &Section<'_>, kind: SensorKind) -> Result<Table, Vec<String>> {
    let name = named(section).unwrap_or_default();
    let in_scene = section.place("part").position().is_some();
    let path = if in_scene { section.reader.folder.join(name) } else { PathBuf::from(name) };
    let shown = path.display();
    let one = |message: String| vec![message];
    let keys = keys(kind).ok_or_else(|| one(format!("{shown}: a Kalibr file has no {kind}")))?;
    let text = fs::read_to_string(&path).map_err(|error| one(format!("cannot read {shown}: {error}")))?;
    section.reader.files.borrow_mut().push(path.clone());
    let documents = MarkedYaml::load_from_str(&without_directive(&text))
        .map_err(|error| one(format!("{shown} is not YAML: {error}")))?;
    // The file that Kalibr writes has all of it under `imu0`.
    let top = documents.first().map(|top| top.data.as_mapping_get("imu0").unwrap_or(top));
    let mut mistakes = Vec::new();
    let mut preset = String::new();
    for (theirs, ours, unit, may_be_0) in keys {
        let Some(node) = top.and_then(|top| top.data.as_mapping_get(theirs)) else {
            mistakes
                .push(format!("{shown} has no `{theirs}`, a number in {}", unit.replace("√Hz", "sqrt(Hz)")));
            continue;
        };
        let number = node.data.as_floating_point().or(node.data.as_integer().map(|whole| whole as f64));
        match number.filter(|x| x.is_finite() && (*x > 0.0 || (may_be_0 && *x == 0.0))) {
            Some(x) => preset += &format!("{ours} = {{ value = \"{x} {unit}\", source = \"{theirs}\" }}\n"),
            None => {
                let least = if may_be_0 { "of 0 or more" } else { "above 0" };
                mistakes
                    .push(format!("{shown}:{}: `{theirs}` takes a number {least}", node.span.start.line()));
            }
        }
    }
    if !mistakes.is_empty() {
        return Err(mistakes);
    }
    Table::parse(&preset, name).map_err(|mistake| one(mistake.to_string()))
}

/// The text with OpenCV's directive made a comment: `%YAML:1.0`, which YAML has with a space and a line `---` behind it.
fn without_directive(text: &str) -> Cow<'_, str> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let is_blank = |line: &&str| line.trim().is_empty() || line.trim_start().starts_with('#');
    let directive = text.lines().find(|line| !is_blank(line)).filter(|line| line.starts_with("%YAML:"));
    match directive {
        Some(line) => text.replacen(line, &format!("# {line}"), 1).into(),
        None => text.into(),
    }
}

#[cfg(test)]
mod tests {
    use crate::scene::{Plan, SceneError};
    use crate::sensor::{BIAS_RANDOM_WALK, white_noise};
    use std::fs;

    const YAML: &str = "# from a calibration\nimu0:\n  T_i_b:\n  - [1.0, 0.0]\n  accelerometer_noise_density: 0.0123\n  accelerometer_random_walk: 2.5e-4\n  gyroscope_noise_density: 3.4e-4\n  gyroscope_random_walk: 0\n  rostopic: /imu0\n  update_rate: 200\n";

    fn plan(yaml: &str, gyro: &str) -> Result<Plan, SceneError> {
        let home = tempfile::tempdir().unwrap();
        fs::write(home.path().join("imu.yaml"), yaml).unwrap();
        let scene = home.path().join("scene.toml");
        fs::write(
            &scene,
            format!("duration = \"1 s\"\n[gyro]\npart = \"imu.yaml\"\n{gyro}[accel]\npart = \"imu.yaml\"\n"),
        )
        .unwrap();
        Plan::load(scene.to_str().unwrap(), &[])
    }

    #[test]
    fn its_densities_are_two_sided_and_keys_beside_it_win() {
        let top = YAML.replace("imu0:\n", "").replace("\n  ", "\n");
        for yaml in [YAML, &top] {
            let plan = plan(yaml, "").unwrap();
            for (sensor, density, walk) in
                [(&plan.sensors[0], 3.4e-4, 0.0), (&plan.sensors[1], 0.0123, 2.5e-4)]
            {
                assert_eq!(sensor.rate.as_hz(), 200.0);
                let sigma = white_noise::sigma(&sensor.values, sensor.kind, sensor.rate).unwrap();
                assert!((sigma.x / (density * 200f64.sqrt()) - 1.0).abs() < 1e-14, "{sigma}");
                assert_eq!(sensor.values.get(BIAS_RANDOM_WALK).unwrap().z, walk);
            }
            assert!(
                !plan.resolved.contains("imu.yaml"),
                "the scene as resolved stands by itself: {}",
                plan.resolved
            );
            assert!(Plan::parse(&plan.resolved, "again", "again", &[]).is_ok());
        }
        let own = plan(YAML, "rate = \"50 Hz\"\nnoise_std = \"1 deg/s\"\n").unwrap();
        assert_eq!(own.sensors[0].rate.as_hz(), 50.0);
        let sigma =
            white_noise::sigma(&own.sensors[0].values, own.sensors[0].kind, own.sensors[0].rate).unwrap();
        assert!((sigma.x - 1f64.to_radians()).abs() < 1e-15);
    }

    #[test]
    fn a_file_with_the_directive_of_opencv_is_read() {
        for head in [
            "%YAML:1.0\n",
            "\u{feff}%YAML:1.0\r\n\n",
            "# by hand\n%YAML:1.0\n---\n",
            "%YAML 1.2\n---\n",
            "---\n",
        ] {
            let plan = plan(&format!("{head}{YAML}"), "").unwrap_or_else(|error| panic!("{head}: {error}"));
            assert_eq!(plan.sensors[0].rate.as_hz(), 200.0, "{head}");
        }
        // The lines of mistakes are those of the file.
        let bad = format!("%YAML:1.0\n{}", YAML.replace("3.4e-4", "-1"));
        let said = plan(&bad, "").unwrap_err().to_string();
        assert!(said.contains("imu.yaml:8: `gyroscope_noise_density` takes"), "{said}");
    }

    #[test]
    fn every_mistake_names_file_line_and_key() {
        let bad = YAML
            .replace("3.4e-4", "-1")
            .replace("update_rate: 200", "update_rate: 0")
            .replace("gyroscope_random", "gyro_random");
        let said = plan(&bad, "").unwrap_err().to_string();
        for says in [
            "imu.yaml:7: `gyroscope_noise_density` takes",
            "imu.yaml:10: `update_rate` takes a number above 0",
            "has no `gyroscope_random_walk`",
        ] {
            assert!(said.contains(says), "{says} is missing from {said}");
        }
        assert!(plan(": [", "").unwrap_err().to_string().contains("is not YAML"));
        let mag =
            Plan::parse("duration = \"1 s\"\n[mag]\npart = \"imu.yaml\"\n", "s.toml", "s", &[]).unwrap_err();
        assert!(mag.to_string().contains("has no mag"), "{mag}");
        let none = Plan::parse("duration = \"1 s\"\n[gyro]\npart = \"none.yaml\"\n", "s.toml", "s", &[])
            .unwrap_err();
        assert!(
            none.to_string().starts_with("s.toml:3:8") && none.to_string().contains("cannot read none.yaml"),
            "{none}"
        );
    }
}
