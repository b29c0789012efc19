//! What a user may have meant: the nearest known name, or ours for a name from another tool.

pub use crate::keys::{did_you_mean, nearest};

use crate::sensor::SensorKind;

/// What a key known from another tool, or from another table, is called in the table `path` (empty: the scene).
pub fn elsewhere(path: &str, key: &str) -> Option<&'static str> {
    if !path.is_empty() && SensorKind::from_name(path).is_none() {
        return None;
    }
    let answer = match key {
        "angle_random_walk" if path == "accel" => {
            "belongs to a gyro; an accelerometer has `velocity_random_walk`"
        }
        "velocity_random_walk" if path == "gyro" => {
            "belongs to an accelerometer; a gyro has `angle_random_walk`"
        }
        "angle_random_walk" | "velocity_random_walk" if path == "mag" => {
            "does not apply to a magnetometer: give `noise_density`, which is √2 times the Allan deviation at 1 s"
        }
        "gyroscope_noise_density" => {
            "is Kalibr's name; here it is `angle_random_walk` in [gyro] (Kalibr's densities are two-sided)"
        }
        "accelerometer_noise_density" => {
            "is Kalibr's name; here it is `velocity_random_walk` in [accel] (Kalibr's densities are two-sided)"
        }
        "gyroscope_random_walk" | "accelerometer_random_walk" => {
            "is Kalibr's name; here it is `bias_random_walk` in [gyro] or [accel]"
        }
        "update_rate" => "is Kalibr's name; here it is `rate`",
        "NoiseDensity" => {
            "is MATLAB's name; here it is `noise_density` (its single-sided NoiseType) or `angle_random_walk` (its double-sided one)"
        }
        "MeasurementRange" => "is MATLAB's name; here it is `range`",
        "Resolution" => "is MATLAB's name; here it is `resolution`",
        "ConstantBias" => "is MATLAB's name; here it is `bias`",
        "BiasInstability" => "is MATLAB's name; here it is `bias_instability` with a `correlation_time`",
        "RandomWalk" => "is MATLAB's name; here it is `bias_random_walk`",
        "SampleRate" | "odr" | "ODR" | "frequency" => "is spelled `rate` here",
        "sigma" | "std" | "stddev" | "noise" => "is spelled `noise_std` here",
        "variance" => "is spelled `noise_variance` here",
        "bias_stability" => "is spelled `bias_instability` here, with a `correlation_time`",
        "arw" | "ARW" => "is spelled `angle_random_walk` here",
        "vrw" | "VRW" => "is spelled `velocity_random_walk` here",
        "AxesMisalignment" => "is MATLAB's name; here it is `misalignment` (angles) or `matrix` (a full 3x3)",
        "TemperatureBias" => "is MATLAB's name; here it is `bias_temperature`",
        "TemperatureScaleFactor" => "is MATLAB's name; here it is `scale_temperature`",
        "AccelerationBias" => "is MATLAB's name; here it is `g_sensitivity`",
        "hard_iron" | "soft_iron" if path != "mag" => "belongs to a magnetometer",
        "g_sensitivity" if path != "gyro" => "belongs to a gyro",
        "lever_arm" if path != "accel" => "belongs to an accelerometer",
        "wind" => "belongs to [earth]: every sensor of the air feels it",
        "vibration" => "belongs to a gyro or an accelerometer",
        _ => return None,
    };
    Some(answer)
}

/// What would say what a refused value meant: something to end the refusal with, or nothing.
pub fn instead(key: &str, text: &str) -> &'static str {
    let endless = text.to_lowercase().contains("inf") || text.contains('∞');
    if key == "correlation_time" && endless {
        ": for a bias without bound use `bias_random_walk`"
    } else {
        ""
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_finds_its_key_and_nonsense_finds_none() {
        let known = ["rate", "noise_density", "noise_std", "bias", "part"];
        assert_eq!(nearest("noise_densty", known), Some("noise_density"));
        assert_eq!(nearest("Rate", known), Some("rate"));
        assert_eq!(nearest("xyzzy", known), None);
    }
}
