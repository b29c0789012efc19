use super::*;
use crate::scene::Plan;

fn gyro(settings: &str) -> SensorPlan {
    let text = format!("duration = \"1 s\"\n[gyro]\nrate = \"100 Hz\"\n{settings}");
    Plan::parse(&text, "test", "test", &[]).unwrap_or_else(|error| panic!("{error}")).sensors.remove(0)
}

fn set(start: &str, rate: &str) -> String {
    format!("[[setting]]\nstart = \"{start}\"\nsensor = \"gyro\"\nrate = \"{rate}\"\n")
}

/// Every tick before 100 ms, ms.
fn ticks(plan: &SensorPlan) -> Vec<i64> {
    let end = SimTime(100_000_000);
    let ticks: Vec<_> = (0..plan.ticks_before(end)).map(|k| plan.tick(k)).collect();
    for (k, t) in ticks.iter().enumerate() {
        assert_eq!(plan.ticks_before(*t), k as u64, "{t:?}");
        assert_eq!(plan.ticks_before(*t + SimTime(1)), k as u64 + 1);
    }
    ticks.into_iter().map(|t| t.0 / 1_000_000).collect()
}

#[test]
fn a_setting_holds_from_its_start_on_and_ticks_are_counted_from_the_sensors_phase() {
    assert_eq!(ticks(&gyro("")), [0, 10, 20, 30, 40, 50, 60, 70, 80, 90]);
    assert_eq!(ticks(&gyro(&set("25 ms", "40 Hz"))), [0, 10, 20, 25, 50, 75]);
    assert_eq!(ticks(&gyro(&set("30 ms", "40 Hz"))), [0, 10, 20, 50, 75]);
    assert_eq!(ticks(&gyro(&set("0 s", "40 Hz"))), [0, 25, 50, 75]);
}

#[test]
fn of_two_settings_before_one_tick_the_second_holds() {
    let twice = set("21 ms", "10 Hz") + &set("25 ms", "40 Hz");
    assert_eq!(ticks(&gyro(&twice)), [0, 10, 20, 25, 50, 75]);
    let at_once = set("25 ms", "10 Hz") + &set("25 ms", "40 Hz");
    assert_eq!(gyro(&at_once).segments().len(), 2);
}

#[test]
fn off_ends_the_ticks_and_on_goes_on_with_them() {
    assert_eq!(ticks(&gyro(&set("25 ms", "off"))), [0, 10, 20]);
    assert_eq!(ticks(&gyro(&(set("25 ms", "off") + &set("61 ms", "50 Hz")))), [0, 10, 20, 80]);
    assert_eq!(ticks(&gyro(&(set("0 s", "off") + &set("61 ms", "50 Hz")))), [80]);
}

#[test]
fn noise_is_new_after_a_tick_and_not_before_the_first() {
    let epochs = |plan: SensorPlan| plan.segments().iter().map(|it| it.plan.epoch).collect::<Vec<_>>();
    assert_eq!(epochs(gyro(&set("0 s", "40 Hz"))), [0]);
    assert_eq!(epochs(gyro(&(set("25 ms", "off") + &set("61 ms", "50 Hz")))), [0, 1, 1]);
    assert_eq!(epochs(gyro(&(set("25 ms", "40 Hz") + &set("61 ms", "50 Hz")))), [0, 1, 2]);
}

#[test]
fn sensors_tick_together_only_if_they_are_set_together() {
    assert!(gyro(&set("21 ms", "40 Hz")).ticks_with(&gyro(&set("24 ms", "40 Hz"))));
    assert!(!gyro(&set("25 ms", "40 Hz")).ticks_with(&gyro(&set("30 ms", "40 Hz"))));
    assert!(!gyro(&set("25 ms", "40 Hz")).ticks_with(&gyro("")));
}
