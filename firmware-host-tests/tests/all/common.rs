//! Error-free readings of a body that turns at a constant rate, worked out here in closed form.

use ratetable_firmware_host_tests::Sample;
use ratetable_firmware_host_tests::quaternion::{about, conj, from_euler, mul, rotate};

pub const G: f64 = 9.80665;
pub const DECLINATION_RAD: f64 = 0.2;

/// A field of 50 µT that dips 60° and points `DECLINATION_RAD` east of true north, NED.
pub fn field_ut() -> [f64; 3] {
    let horizontal = 50.0 * 60_f64.to_radians().cos();
    let (s, c) = DECLINATION_RAD.sin_cos();
    [horizontal * c, horizontal * s, 50.0 * 60_f64.to_radians().sin()]
}

/// A body that starts with some attitude and turns at a constant rate about its own axes.
#[derive(Debug, Clone, Copy)]
pub struct Body {
    /// Roll, pitch, yaw at the start, deg.
    pub start_deg: [f64; 3],
    /// Angular rate about body axes, deg/s.
    pub rate_dps: [f64; 3],
}

impl Body {
    /// Body to nav at a time in s.
    pub fn attitude(&self, t: f64) -> [f64; 4] {
        let [roll, pitch, yaw] = self.start_deg.map(f64::to_radians);
        let rate = self.rate();
        let norm = rate.iter().map(|w| w * w).sum::<f64>().sqrt();
        let start = from_euler(roll, pitch, yaw);
        if norm == 0.0 { start } else { mul(start, about(rate.map(|w| w / norm), norm * t)) }
    }

    pub fn rate(&self) -> [f64; 3] {
        self.rate_dps.map(f64::to_radians)
    }

    /// What error-free sensors at `[gyro, accel, mag]` ticks (every so many µs) read at a time.
    pub fn sample(&self, t_us: u64, every_us: [u64; 3]) -> Sample {
        let q = conj(self.attitude(t_us as f64 * 1e-6));
        let due = |sensor: usize| t_us.is_multiple_of(every_us[sensor]);
        Sample {
            t_us,
            gyro: due(0).then(|| self.rate()),
            accel: due(1).then(|| rotate(q, [0.0, 0.0, -G])),
            mag: due(2).then(|| rotate(q, field_ut())),
        }
    }

    /// All samples of so many seconds, one each µs grid point where any sensor ticks.
    pub fn samples(&self, seconds: u64, every_us: [u64; 3]) -> Vec<Sample> {
        (0..seconds * 2000)
            .map(|k| self.sample(k * 500, every_us))
            .filter(|s| s.gyro.is_some() || s.accel.is_some() || s.mag.is_some())
            .collect()
    }
}

pub const LEVEL: Body = Body { start_deg: [0.0; 3], rate_dps: [0.0; 3] };
pub const TILTED: Body = Body { start_deg: [30.0, 10.0, 90.0], rate_dps: [0.0; 3] };
pub const TURNING: Body = Body { start_deg: [30.0, 10.0, 90.0], rate_dps: [3.0, -5.0, 20.0] };
pub const SLOW_TURN: Body = Body { start_deg: [0.0, 0.0, 179.0], rate_dps: [0.0, 0.0, 3.0] };
