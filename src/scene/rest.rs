//! The same vehicle before the scene begins: at rest, so that an estimator on the other side can settle.

use super::Plan;
use crate::motion::Trajectory;
use crate::random;
use crate::sensor::{SensorPlan, VIBRATION};
use crate::time::SimTime;
use rand::RngExt;

impl Plan {
    /// The vehicle held for ever in the attitude in which the scene starts, at the same place and read by the same
    /// sensors. Their noise is their own, from a seed that follows from the scene's, so that the scene's readings
    /// are the same with a rest before them and without; no force pushes it, nothing vibrates and no sensor has a fault.
    /// (ArduPilot does not finish its calibration while anything vibrates; measured.)
    pub fn at_rest(&self) -> Plan {
        let start = self.trajectory.at(SimTime::ZERO).attitude;
        let (gravity, field) = (self.trajectory.gravity(), self.trajectory.field());
        let still = |sensor: &SensorPlan| {
            let mut still = SensorPlan { faults: Vec::new(), settings: Vec::new(), ..sensor.clone() };
            still.values.remove(VIBRATION);
            still
        };
        Plan {
            name: self.name.clone(),
            seed: random::stream(self.seed, "rest").random(),
            duration: SimTime::FOREVER,
            axes: self.axes,
            site: self.site,
            day: self.day,
            limits: Vec::new(),
            trajectory: Trajectory::new(start, Vec::new(), Vec::new(), gravity, field)
                .in_wind(self.trajectory.wind()),
            sensors: self.sensors.iter().map(still).collect(),
            reference: None,
            outputs: Vec::new(),
            output_faults: Vec::new(),
            drawn: self.drawn.clone(),
            attached: Vec::new(),
            files: Vec::new(),
            warnings: Vec::new(),
            resolved: String::new(),
        }
    }

    /// The stream times at which the scene may begin after a rest: multiples of so many whole seconds that every
    /// sensor's ticks go on as if there were no seam. Where no ten seconds do that, as with an oscillator that is off
    /// by some ppm, each whole second, at which one interval is shorter or longer.
    pub fn seam(&self) -> SimTime {
        let even =
            |seconds: &u64| self.sensors.iter().all(|sensor| sensor.clock().whole_ticks(*seconds).is_some());
        let seconds = (1..=10).find(even).unwrap_or(1);
        SimTime(seconds as i64 * crate::time::NANOS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::player::{BLOCK, Player};
    use crate::sensor::SensorKind;
    use std::convert::Infallible;

    fn plan(text: &str) -> Plan {
        Plan::parse(text, "test", "test", &[]).unwrap_or_else(|error| panic!("{error}"))
    }

    const TURNING: &str = "seed = 5\n[start]\nattitude = \"[10, -20, 30] deg\"\n[[motion]]\nkind = \"rotate\"\nyaw = \"50 deg/s\"\nduration = \"2 s\"\n[[force]]\nduration = \"1 s\"\nacceleration = \"[5, 0, 0] m/s^2\"\n[gyro]\nrate = \"100 Hz\"\nnoise_std = \"0.01 rad/s\"\n[accel]\nrate = \"100 Hz\"\n[[fault]]\nsensor = \"accel\"\nkind = \"off\"\n";

    #[test]
    fn at_rest_nothing_moves_pushes_or_fails_and_the_noise_is_another() {
        let (scene, rest) = (plan(TURNING), plan(TURNING).at_rest());
        let gyro = |plan: &Plan| {
            let mut values = Vec::new();
            let played = Player::new(plan, SimTime(10_000_000_000), BLOCK).play(|moment| {
                values.extend(moment.readings.iter().map(|reading| {
                    (reading.kind, reading.body().unwrap().value.v - reading.body().unwrap().truth.v)
                }));
                assert!(plan.duration != SimTime::FOREVER || moment.truth.rate.v.length() == 0.0);
                Ok::<(), Infallible>(())
            });
            assert!(played.is_ok());
            values
        };
        let start = scene.trajectory.at(SimTime::ZERO).attitude;
        for t in [0, 1, 3_600_000_000_000] {
            let truth = rest.trajectory.at(SimTime(t));
            assert_eq!(truth.attitude, start);
            assert!((truth.force.v.length() - 9.80665).abs() < 1e-12, "gravity alone");
        }
        let (moving, still) = (gyro(&scene), gyro(&rest));
        assert_eq!(still.iter().filter(|(kind, _)| *kind == SensorKind::Accel).count(), 1000, "no fault");
        assert_eq!(moving.len(), 1000, "the fault leaves the gyro alone");
        let noise = |values: &[(SensorKind, glam::DVec3)]| {
            let gyro = values.iter().filter(|(kind, _)| *kind == SensorKind::Gyro);
            gyro.map(|(_, noise)| noise.x).collect::<Vec<_>>()
        };
        let (a, b) = (noise(&moving), noise(&still));
        let n = a.len() as f64;
        let correlation = a.iter().zip(&b).map(|(a, b)| a * b).sum::<f64>() / (1e-4 * n);
        assert!(correlation.abs() < 4.0 / n.sqrt(), "{correlation}");
        let variance = b.iter().map(|b| b * b).sum::<f64>() / (1e-4 * n);
        assert!((variance - 1.0).abs() < 4.0 * (2.0 / n).sqrt(), "{variance}");
    }

    #[test]
    fn at_rest_nothing_vibrates() {
        let scene = plan(
            "duration = \"1 s\"\n[gyro]\nrate = \"100 Hz\"\nvibration = [{ frequency = \"33 Hz\", amplitude = \"5 deg/s\" }]\n",
        );
        let most = |plan: &Plan| {
            let mut most = 0.0_f64;
            let played = Player::new(plan, SimTime(1_000_000_000), BLOCK).play(|moment| {
                let read = |body: f64| most = most.max(body);
                moment.readings.iter().map(|it| it.body().unwrap().value.v.length()).for_each(read);
                Ok::<(), Infallible>(())
            });
            assert!(played.is_ok());
            most
        };
        assert_eq!(most(&scene.at_rest()), 0.0);
        assert!(most(&scene) > 0.05, "in the scene it does");
    }

    #[test]
    fn a_scene_may_begin_where_every_sensor_goes_on_ticking_evenly() {
        for (gyro, mag, seconds) in [
            ("1 kHz", "100 Hz", 1),
            ("400/3 Hz", "0.5 Hz", 6),
            ("250 Hz", "0.09 Hz", 1),
            ("1 Hz", "0.1 Hz", 10),
        ] {
            let plan =
                plan(&format!("duration = \"1 s\"\n[gyro]\nrate = \"{gyro}\"\n[mag]\nrate = \"{mag}\"\n"));
            assert_eq!(plan.seam(), SimTime(seconds * 1_000_000_000), "{gyro}, {mag}");
        }
    }
}
