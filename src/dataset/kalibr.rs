//! `imu.yaml`: a scene's noise as Kalibr and its kin take it, beside the readings that have it.
//!
//! Densities are two-sided, in SI: noise density N = σ/√(1/fs), of σ a sample's; random walk K, of the bias. Source:
//! Kalibr's wiki, "IMU Noise Model" and "YAML formats".

use crate::keys::Name;
use crate::scene::Plan;
use crate::sensor::{BIAS_RANDOM_WALK, BIAS_STEP_STD, SensorKind, SensorPlan, white_noise};
use glam::DVec3;
use std::fmt::Write;

/// Its name in the folder.
pub(super) const NAME: &str = "imu.yaml";

/// The file of a scene that has a gyroscope and an accelerometer.
pub(super) fn text(plan: &Plan) -> Option<String> {
    let find = |kind| plan.sensors.iter().find(|sensor| sensor.kind == kind);
    let (gyro, accel) = (find(SensorKind::Gyro)?, find(SensorKind::Accel)?);
    let mut text = String::from(
        "# White noise and bias random walk of this dataset, as Kalibr takes them: two-sided densities, the largest axis.\n",
    );
    for (sensor, name, unit) in [(accel, "accelerometer", "m/s^2"), (gyro, "gyroscope", "rad/s")] {
        let [density, walk] = densities(sensor);
        for (key, value, unit) in [
            ("noise_density", density, format!("{unit}/sqrt(Hz)")),
            ("random_walk", walk, format!("{unit}/s/sqrt(Hz)")),
        ] {
            let none =
                if value == 0.0 { "; the scene has none, and Kalibr wants a number above 0" } else { "" };
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{name}_{key}: {value:?}    # {unit}{none}");
        }
    }
    text += "rostopic: /imu/data_raw\n";
    let _ = writeln!(text, "update_rate: {:?}    # Hz, the gyroscope's", gyro.rate.as_hz());
    Some(text)
}

/// N and K of a sensor.
fn densities(sensor: &SensorPlan) -> [f64; 2] {
    let root_rate = libm::sqrt(sensor.rate.as_hz());
    let sigma = white_noise::sigma(&sensor.values, sensor.kind, sensor.rate).unwrap_or_default();
    let walk = |axis: usize| {
        let at = |key: Name<DVec3>| sensor.values.get(key).unwrap_or_default()[axis];
        libm::hypot(at(BIAS_RANDOM_WALK), at(BIAS_STEP_STD) * root_rate)
    };
    [sigma.max_element() / root_rate, (0..3).map(walk).fold(0.0, f64::max)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_reads_back_as_a_part_to_the_same_noise() {
        let scene = "duration = \"1 s\"\n[gyro]\nrate = \"400 Hz\"\nnoise_density = \"0.01 deg/s/√Hz\"\nbias_random_walk = \"20 deg/h/rts\"\n[accel]\nrate = \"400 Hz\"\nnoise_std = \"[1, 2, 1] mm/s^2\"\nbias_step_std = \"1e-6 m/s^2\"\n";
        let plan = Plan::parse(scene, "test", "test", &[]).unwrap();
        let home = tempfile::tempdir().unwrap();
        std::fs::write(home.path().join(NAME), text(&plan).unwrap()).unwrap();
        let source = home.path().join("scene.toml");
        let parts = "duration = \"1 s\"\n[gyro]\npart = \"imu.yaml\"\n[accel]\npart = \"imu.yaml\"\n";
        let again = Plan::parse(parts, source.to_str().unwrap(), "test", &[]).unwrap();
        for (a, b) in plan.sensors.iter().zip(&again.sensors) {
            assert_eq!(a.rate, b.rate);
            for (x, y) in densities(a).into_iter().zip(densities(b)) {
                assert!(x > 0.0 && (x / y - 1.0).abs() < 1e-14, "{x} {y}");
            }
        }
        // By hand: √2 between one-sided and two-sided.
        let gyro = 0.01f64.to_radians() / 2f64.sqrt();
        assert!((densities(&again.sensors[0])[0] / gyro - 1.0).abs() < 1e-12);
        assert!((densities(&again.sensors[1])[0] / (2e-3 / 20.0) - 1.0).abs() < 1e-12);
        assert!((densities(&again.sensors[1])[1] / (1e-6 * 20.0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_scene_without_both_has_none_and_a_noise_of_nothing_is_told() {
        let one = Plan::parse("duration = \"1 s\"\n[gyro]\nrate = \"1 Hz\"\n", "test", "test", &[]).unwrap();
        assert_eq!(text(&one), None);
        let quiet = Plan::parse(
            "duration = \"1 s\"\n[gyro]\nrate = \"1 Hz\"\n[accel]\nrate = \"1 Hz\"\n",
            "t",
            "t",
            &[],
        );
        assert_eq!(text(&quiet.unwrap()).unwrap().matches("the scene has none").count(), 4);
    }
}
