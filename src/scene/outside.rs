//! What a scene asks for and never plays, because it ends before: told, as a slip of a digit is its usual reason.

use super::{OutputFault, Plan};
use crate::sensor::SensorPlan;

/// Motions, forces, faults and sensors of which nothing is within the scene.
pub(super) fn warnings(plan: &Plan) -> Vec<String> {
    let end = plan.duration;
    let after = |what: String| format!("{what}, but the scene ends at {end}: it never plays");
    let path = &plan.trajectory;
    let motions = path.starts().filter(|start| *start >= end);
    let mut all: Vec<_> = motions.map(|start| after(format!("a motion begins at {start}"))).collect();
    let forces = path.forces().iter().filter(|force| force.start >= end);
    all.extend(forces.map(|force| after(format!("a force begins at {}", force.start))));
    all.extend(plan.sensors.iter().flat_map(|sensor| of_sensor(plan, sensor)));
    let faults = plan.output_faults.iter().filter(|fault| fault.start() >= end);
    all.extend(
        faults.map(|fault: &OutputFault| after(format!("the fault {fault} begins at {}", fault.start()))),
    );
    if !plan.sensors.is_empty() && plan.sensors.iter().all(|sensor| ticks(plan, sensor) == 0) {
        all.push(format!("no sensor samples before the scene ends at {end}: there is nothing to play"));
    }
    all
}

fn of_sensor(plan: &Plan, sensor: &SensorPlan) -> Vec<String> {
    let (kind, end) = (sensor.kind, plan.duration);
    if ticks(plan, sensor) == 0 {
        let phase = sensor.phase;
        return vec![format!("{kind} never samples: its phase is {phase}, but the scene ends at {end}")];
    }
    let before = |t| sensor.ticks_before(t);
    let idle = sensor.faults.iter().filter(|fault| before(fault.start) >= before(fault.end.min(end)));
    idle.map(|fault| {
        let why = if fault.start >= end {
            format!("the scene ends at {end}")
        } else {
            "no sample is due then".into()
        };
        format!("the fault {kind} {fault} has no effect: {why}")
    })
    .collect()
}

fn ticks(plan: &Plan, sensor: &SensorPlan) -> u64 {
    sensor.ticks_before(plan.duration)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn warned(scene: &str) -> String {
        let text = format!("duration = \"2 s\"\n{scene}");
        Plan::parse(&text, "test", "test", &[]).unwrap_or_else(|error| panic!("{error}")).warnings.join("\n")
    }

    const GYRO: &str = "[gyro]\nrate = \"100 Hz\"\n";

    #[test]
    fn what_is_never_played_is_told_and_what_is_played_is_not() {
        let motion = |first: &str, second: &str| {
            let one = |length| {
                format!("[[motion]]\nkind = \"rotate\"\nyaw = \"1 deg/s\"\nduration = \"{length}\"\n")
            };
            one(first) + &one(second)
        };
        let force = |start: &str| {
            format!(
                "[[force]]\nstart = \"{start}\"\nduration = \"1 s\"\nacceleration = \"[1, 0, 0] m/s^2\"\n"
            )
        };
        let fault = |kind: &str, start: &str, more: &str| {
            format!("[[fault]]\nkind = \"{kind}\"\nstart = \"{start}\"\n{more}\n")
        };
        let of_gyro = "sensor = \"gyro\"\nduration = \"1 s\"";
        let brief = "sensor = \"gyro\"\nduration = \"1 ms\"";
        for (outside, inside, says) in [
            (motion("2 s", "1 s"), motion("1.9 s", "1 s"), "a motion begins at 2 s"),
            (force("2 s"), force("1999 ms"), "a force begins at 2 s"),
            (fault("stuck", "2 s", of_gyro), fault("stuck", "1.9 s", of_gyro), "the scene ends at 2 s"),
            (fault("stuck", "1.9901 s", brief), fault("stuck", "1.99 s", brief), "no sample is due"),
            (fault("drop", "5 s", ""), fault("drop", "1 s", ""), "the fault drop from 5 s"),
        ] {
            let (told, silent) = (warned(&format!("{outside}{GYRO}")), warned(&format!("{inside}{GYRO}")));
            assert!(told.contains(says), "{outside}: {told}");
            assert_eq!(silent, "", "{inside}");
        }
    }

    #[test]
    fn a_sensor_whose_phase_is_beyond_the_end_and_a_scene_without_a_tick_are_told() {
        let mag = |phase: &str| format!("[mag]\nrate = \"10 Hz\"\nphase = \"{phase}\"\n");
        let both = warned(&format!("{GYRO}{}", mag("2 s")));
        assert!(both.contains("mag never samples") && !both.contains("nothing to play"), "{both}");
        let alone = warned(&mag("2 s"));
        assert!(alone.contains("mag never samples") && alone.contains("nothing to play"), "{alone}");
        assert_eq!(warned(&mag("1.9 s")), "");
    }

    #[test]
    fn an_angle_that_means_another_one_is_told() {
        let cone = |angle: &str| {
            warned(&format!(
                "[[motion]]\nkind = \"cone\"\nhalf_angle = \"{angle}\"\nfrequency = \"1 Hz\"\nduration = \"2 s\"\n{GYRO}"
            ))
        };
        let told = cone("200 deg");
        assert!(told.contains("half_angle of 200 deg equals one of 160 deg"), "{told}");
        assert!(cone("365 deg").contains("equals one of 5 deg"));
        for plain in ["180 deg", "120 deg", "-5 deg"] {
            assert_eq!(cone(plain), "", "{plain}");
        }
    }
}
