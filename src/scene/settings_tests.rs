use super::*;
use crate::sensor::{RANGE, lsb};

const SCENE: &str = "duration = \"10 s\"\n[gyro]\nrate = \"1 kHz\"\npart = \"MPU-9250\"\n[accel]\nrate = \"1 kHz\"\nrange = \"4 g\"\n";

fn plan(more: &str) -> Result<Plan, String> {
    Plan::parse(&format!("{SCENE}{more}"), "test", "test", &[]).map_err(|error| error.to_string())
}

#[test]
fn a_part_fills_in_what_a_setting_leaves_open() {
    let set = "[[setting]]\nsensor = \"gyro\"\nstart = \"2 s\"\nrate = \"200 Hz\"\nrange = \"500 deg/s\"\nfilter = \"DLPF 3\"\n";
    let plan = plan(set).unwrap();
    let setting = &plan.sensors[0].settings[0];
    assert_eq!((setting.start, setting.rate), (SimTime(2_000_000_000), Some(Rate::hz(200))));
    assert_eq!(setting.values.get(RANGE), Some(500f64.to_radians()));
    let count = lsb(&setting.values, SensorKind::Gyro).unwrap();
    assert!((count - 1f64.to_radians() / 65.5).abs() < 1e-15, "{count}");
    let low_pass = setting.values.get(FILTER).and_then(|filter| filter.get(sensor::LOW_PASS));
    assert_eq!(low_pass, Some(41.0));
    let again = Plan::parse(&plan.resolved, "resolved", "test", &[]).unwrap();
    assert_eq!(again.resolved, plan.resolved, "the scene as resolved says the same");
}

#[test]
fn what_a_setting_does_not_name_stays() {
    let plan = plan("[[setting]]\nsensor = \"accel\"\nrate = \"off\"\n[[setting]]\nsensor = \"accel\"\nrate = \"100 Hz\"\nstart = \"1 s\"\n").unwrap();
    let settings = &plan.sensors[1].settings;
    assert_eq!(settings.iter().map(|it| it.rate).collect::<Vec<_>>(), [None, Some(Rate::hz(100))]);
    assert!(settings.iter().all(|it| it.values.get(RANGE) == Some(4.0 * 9.80665)));
}

#[test]
fn each_mistake_is_told_with_what_would_be_right() {
    for (set, says) in [
        ("rate = \"100 Hz\"", "a setting needs its sensor"),
        ("sensor = \"mag\"", "`sensor` is `mag`; the scene has gyro, accel"),
        ("sensor = \"gyro\"\nrate = \"fast\"", "rate"),
        ("sensor = \"gyro\"\nrange = \"300 deg/s\"", "the part has no such range"),
        ("sensor = \"gyro\"\nfilter = \"DLPF 9\"", "`DLPF 9` is not a setting of the part"),
        ("sensor = \"gyro\"\nnoise_std = \"1 rad/s\"", "`noise_std` is not a key of [[setting]]"),
        (
            "sensor = \"accel\"\nstart = \"2 s\"\n[[setting]]\nsensor = \"accel\"\nstart = \"1 s\"",
            "write them in order",
        ),
    ] {
        let error = plan(&format!("[[setting]]\n{set}\n")).expect_err(set);
        assert!(error.contains(says), "{set}: {error}");
    }
}

#[test]
fn what_a_chip_is_asked_is_written_as_a_scene_would_say_it() {
    let mut live = plan("").unwrap();
    let asked = Asked { part: "MPU-9250", rate: Rate::new(1000, 5), range: 1, filter: Some("DLPF 3") };
    let start = SimTime(1_234_567_890);
    let settings = [(SensorKind::Gyro, asked), (SensorKind::Accel, Asked { rate: None, ..asked })].map(
        |(kind, asked)| {
            let (setting, table) = live.asked(kind, start, &asked).unwrap();
            (kind, setting, table)
        },
    );
    live.set(settings);
    let again = Plan::parse(&live.resolved, "resolved", "test", &[]).unwrap();
    for (live, again) in live.sensors.iter().zip(&again.sensors) {
        let [a, b] = [live, again].map(|sensor| &sensor.settings[0]);
        assert_eq!((a.start, a.rate), (b.start, b.rate));
        assert_eq!(a.values.get(RANGE), b.values.get(RANGE));
        assert_eq!(lsb(&a.values, live.kind), lsb(&b.values, live.kind));
        let cut_off = |setting: &Setting| setting.values.get(FILTER)?.get(sensor::LOW_PASS);
        assert_eq!((cut_off(a), sensor::delay(&a.values)), (cut_off(b), sensor::delay(&b.values)));
    }
    assert_eq!(live.sensors[0].settings[0].start, start);
    assert!(live.asked(SensorKind::Mag, start, &asked).is_err(), "the scene has none");
}
