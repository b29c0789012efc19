use super::*;
use crate::sensor::SensorKind;
use std::convert::Infallible;

fn plan(text: &str) -> Plan {
    Plan::parse(text, "test", "test", &[]).unwrap_or_else(|error| panic!("{error}"))
}

/// Time, kind, number and value of every reading.
type Read = (i64, SensorKind, u64, glam::DVec3);

fn note(moment: Moment<'_>, to: &mut Vec<Read>) -> Result<(), Infallible> {
    to.extend(moment.readings.iter().map(|it| (moment.t.0, it.kind, it.k, it.body().unwrap().value.v)));
    Ok(())
}

fn played(plan: &Plan, block: usize) -> Vec<Read> {
    let mut all = Vec::new();
    let Ok(()) = Player::new(plan, plan.duration, block).play(|moment| note(moment, &mut all));
    all
}

const SCENE: &str = "seed = 3\nduration = \"2 s\"\n[[motion]]\nkind = \"rock\"\naxis = \"pitch\"\namplitude = \"100 deg/s\"\nfrequency = \"1 Hz\"\nduration = \"2 s\"\n[gyro]\nrate = \"1 kHz\"\nnoise_std = \"0.1 deg/s\"\nrange = \"250 deg/s\"\nresolution = \"131 LSB/(deg/s)\"\nbias_instability = \"1 deg/s\"\ncorrelation_time = \"100 s\"\n[accel]\nrate = \"400/3 Hz\"\nsampling = \"average\"\ndelay = \"3 ms\"\n";
const SETTINGS: &str = "[[setting]]\nsensor = \"gyro\"\nstart = \"500.5 ms\"\nrate = \"200 Hz\"\nrange = \"2000 deg/s\"\nresolution = \"1 LSB/(deg/s)\"\n[[setting]]\nsensor = \"accel\"\nstart = \"1 s\"\nrate = \"off\"\n[[setting]]\nsensor = \"accel\"\nstart = \"1.5 s\"\nrate = \"250 Hz\"\ndelay = \"0 s\"\n[[setting]]\nsensor = \"gyro\"\nstart = \"1.9 s\"\nfilter = \"20 Hz\"\n";

#[test]
fn where_blocks_begin_changes_nothing_of_a_sensor_that_is_set() {
    let plan = plan(&format!("{SCENE}{SETTINGS}"));
    let whole = played(&plan, 10_000);
    for block in [1, 7, 256] {
        assert_eq!(played(&plan, block), whole, "{block}");
    }
    for sensor in &plan.sensors {
        let mine: Vec<_> = whole.iter().filter(|it| it.1 == sensor.kind).collect();
        assert_eq!(mine.len() as u64, sensor.ticks_before(plan.duration));
        assert!(mine.iter().enumerate().all(|(k, it)| it.2 == k as u64 && it.0 == sensor.tick(k as u64).0));
    }
}

#[test]
fn readings_before_a_setting_are_those_without_it_and_counts_after_it_are_the_new_ones() {
    let (with, without) = (played(&plan(&format!("{SCENE}{SETTINGS}")), 256), played(&plan(SCENE), 256));
    let gyro = |all: &[Read], from: i64, to: i64| {
        let within = all.iter().filter(|it| it.1 == SensorKind::Gyro && (from..to).contains(&it.0));
        within.map(|it| it.3).collect::<Vec<_>>()
    };
    assert_eq!(gyro(&with, 0, 501_000_000), gyro(&without, 0, 501_000_000));
    let after = gyro(&with, 501_000_000, 1_900_000_000);
    assert_eq!(after.len(), 279, "from 505 ms on");
    for value in after {
        let counts = value * 1f64.to_degrees();
        assert!((counts - counts.round()).abs().max_element() < 1e-9, "{counts}");
    }
}

#[test]
fn noise_after_a_setting_is_new_and_the_bias_goes_on() {
    let still = SCENE.replace("100 deg/s", "0 deg/s").replace("resolution = \"131 LSB/(deg/s)\"\n", "");
    let set = "[[setting]]\nsensor = \"gyro\"\nstart = \"1 s\"\nrange = \"2000 deg/s\"\n";
    let quiet = still.replace("noise_std = \"0.1 deg/s\"\n", "");
    let biases = played(&plan(&format!("{quiet}{set}")), 256);
    let biases: Vec<_> = biases.iter().filter(|it| it.1 == SensorKind::Gyro).map(|it| it.3).collect();
    let step = |k: usize| (biases[k] - biases[k - 1]).length();
    // One step has a standard deviation of σ·√(2·dt/τ) on each axis.
    let bound = 6.0 * 1f64.to_radians() * (2.0 * 1e-3 / 100.0f64).sqrt() * 3f64.sqrt();
    assert!((1..biases.len()).all(|k| step(k) < bound), "{}", step(1000));
    assert!(step(1000) > 0.0 && biases[1000].length() > 0.0);
    let noise = played(&plan(&format!("{still}{set}")), 256);
    let noise: Vec<_> = noise.iter().filter(|it| it.1 == SensorKind::Gyro).map(|it| it.3.x).collect();
    let (before, after) = noise.split_at(1000);
    let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
    let (a, b) = (mean(before), mean(after));
    let n = 1000.0;
    let covariance = before.iter().zip(after).map(|(x, y)| (x - a) * (y - b)).sum::<f64>() / n;
    let correlation = covariance / 0.1f64.to_radians().powi(2);
    assert!(correlation.abs() < 5.0 / f64::sqrt(n), "{correlation}");
}

#[test]
fn a_sensor_that_is_set_while_it_plays_reads_what_a_scene_that_says_so_reads() {
    let scene = plan(&format!("{SCENE}{SETTINGS}"));
    let bare = plan(SCENE);
    let mut settings: Vec<_> = scene
        .sensors
        .iter()
        .enumerate()
        .flat_map(|(i, sensor)| sensor.settings.iter().map(move |setting| (i, setting)))
        .collect();
    settings.sort_by_key(|(_, setting)| setting.start);
    let (mut all, mut player) = (Vec::new(), Player::new(&bare, bare.duration, 4));
    for (sensor, setting) in settings {
        while player.play_block_before(setting.start, |moment| note(moment, &mut all)).unwrap() {}
        player.set(sensor, setting).unwrap();
    }
    let Ok(()) = player.play(|moment| note(moment, &mut all));
    assert_eq!(all, played(&scene, 256));
}
