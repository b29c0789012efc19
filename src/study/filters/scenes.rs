//! The scenes that filters are judged on, and the rates of their sensors.

use super::START_UP;
use crate::scene::{Plan, SceneError};
use crate::sensor::{SensorKind, SensorPlan};
use crate::time::SimTime;

/// Gyro rates, Hz.
pub const RATES: [u32; 9] = [25, 50, 100, 200, 500, 1000, 2000, 4000, 8000];
/// The same, quick.
pub const QUICK_RATES: [u32; 2] = [100, 1000];
/// The accelerometer follows the gyro up to this rate: that of an MPU-9250 behind its low-pass, Hz.
const ACCEL_HZ: f64 = 1000.0;
/// And the magnetometer up to this one, Hz.
const MAG_HZ: f64 = 100.0;
/// A user's scene is played no longer than this: at 8 kHz it is held in memory.
const LONGEST: SimTime = SimTime(60_000_000_000);

/// A scene that filters are judged on.
#[derive(Clone, Debug)]
pub struct Scene {
    /// As in the table.
    pub name: String,
    /// What is in it, in a few words.
    pub about: &'static str,
    /// The rates of its gyro, Hz.
    pub rates: Vec<u32>,
    /// A built-in scene or a file.
    source: String,
    seed: u64,
    duration: SimTime,
    /// The highest rates of accelerometer and magnetometer, Hz; none where it has no such sensor.
    accel_hz: f64,
    mag_hz: Option<f64>,
}

/// Built-in scenes: by name, and what is in them.
const BUILT_IN: [(&str, &str); 7] = [
    ("still", "at rest"),
    ("level-then-turn", "turns about each axis"),
    ("coning-mems", "coning of 5 deg at 2 Hz"),
    ("manoeuvre", "banked turn, pushes, fast turns"),
    ("vibration", "87 Hz of almost 1 g"),
    ("magnetic-disturbance", "iron comes near and goes"),
    ("pirouette", "1800 deg/s about the vertical"),
];
/// Those of a quick study.
const QUICK: [&str; 3] = ["still", "level-then-turn", "magnetic-disturbance"];

/// Every built-in scene at every rate; with `quick`, three scenes at two rates.
///
/// # Errors
/// A build without a feature that a scene needs.
pub fn built_in(quick: bool) -> Result<Vec<Scene>, SceneError> {
    let rates = if quick { QUICK_RATES.to_vec() } else { RATES.to_vec() };
    let kept = BUILT_IN.iter().filter(|(name, _)| !quick || QUICK.contains(name));
    let scene = |(name, about): &(&str, &'static str)| {
        let plan = Plan::load(name, &[])?;
        Ok(Scene { about, accel_hz: ACCEL_HZ, mag_hz: Some(MAG_HZ), ..Scene::of(name, &plan, rates.clone()) })
    };
    kept.map(scene).collect()
}

impl Scene {
    /// A user's scene, read from `source`, at `rates`: accelerometer and magnetometer keep their own rates where the
    /// gyro's is higher.
    ///
    /// # Errors
    /// It has no gyro or no accelerometer, or is over before errors count.
    pub fn given(source: &str, plan: &Plan, rates: &[u32]) -> Result<Scene, String> {
        for kind in [SensorKind::Gyro, SensorKind::Accel] {
            if sensor(plan, kind).is_none() {
                let name = &plan.name;
                return Err(format!("the scene `{name}` has no [{kind}], and every filter needs one"));
            }
        }
        if plan.duration <= START_UP {
            let (name, duration) = (&plan.name, plan.duration);
            return Err(format!(
                "the scene `{name}` lasts {duration}, and a filter's errors count from {START_UP} on: give it a longer duration"
            ));
        }
        Ok(Scene::of(source, plan, rates.to_vec()))
    }

    fn of(source: &str, plan: &Plan, rates: Vec<u32>) -> Scene {
        let hz = |kind| sensor(plan, kind).map(|sensor| sensor.rate.as_hz());
        Scene {
            name: plan.name.clone(),
            about: "the scene given",
            rates,
            source: source.to_string(),
            seed: plan.seed,
            duration: plan.duration.min(LONGEST),
            accel_hz: hz(SensorKind::Accel).unwrap_or_default(),
            mag_hz: hz(SensorKind::Mag),
        }
    }

    /// How long it is played, s.
    pub fn seconds(&self) -> f64 {
        self.duration.seconds()
    }

    /// Whether it has a magnetometer.
    pub fn has_mag(&self) -> bool {
        self.mag_hz.is_some()
    }

    /// The plan with the gyro at `rate_hz`, and the seed of its `run`-th run, from 0.
    ///
    /// # Errors
    /// What the scene says against such a rate.
    pub fn plan(&self, rate_hz: u32, run: u64) -> Result<Plan, SceneError> {
        let slower = |own: f64| own.min(f64::from(rate_hz));
        let mut sets = vec![
            format!("duration={}", self.duration),
            format!("seed={}", self.seed.wrapping_add(run) & (i64::MAX as u64)),
            format!("gyro.rate={rate_hz} Hz"),
            format!("accel.rate={} Hz", slower(self.accel_hz)),
        ];
        sets.extend(self.mag_hz.map(|own| format!("mag.rate={} Hz", slower(own))));
        Plan::load(&self.source, &sets)
    }
}

fn sensor(plan: &Plan, kind: SensorKind) -> Option<&SensorPlan> {
    plan.sensors.iter().find(|sensor| sensor.kind == kind)
}
