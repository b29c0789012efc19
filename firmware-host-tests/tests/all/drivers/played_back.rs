//! What a driver reads of a part with noise over a pty: the samples of the scene with the settings that the driver chose,
//! as the run wrote them down, to the bit and in order.

use std::convert::Infallible;
use std::sync::Arc;
use std::thread;
use std::time::Duration;

use ::mpu6050_dmp::accel::AccelFullScale;
use ::mpu6050_dmp::address::Address;
use ::mpu6050_dmp::config::DigitalLowPassFilter;
use ::mpu6050_dmp::gyro::GyroFullScale;
use ::mpu6050_dmp::sensor::Mpu6050;
use ratetable::bus::Change;
use ratetable::player::{BLOCK, Player};
use ratetable::scene::Plan;
use ratetable::sensor::SensorKind;

use super::emulated::{Run, accounts};
use super::hal::Hal;
use super::{ACCEL, GYRO};

const SCENE: &str = "seed = 11\nduration = \"1 h\"\n[[motion]]\nkind = \"rock\"\namplitude = \"200 deg/s\"\nfrequency = \"1 Hz\"\nduration = \"1 h\"\n[gyro]\npart = \"MPU-6050\"\nrate = \"1 kHz\"\n[accel]\npart = \"MPU-6050\"\nrate = \"1 kHz\"\n";

/// Gyro and accelerometer at one moment, in counts.
type Counts = [[i16; 3]; 2];

fn plan(text: &str) -> Plan {
    Plan::parse(text, "noisy", "noisy", &[]).unwrap_or_else(|error| panic!("{error}"))
}

/// So many samples, each once, read by the driver at 100 Hz, ±500 deg/s and ±4 g with DLPF 3.
fn read(run: &Run, count: usize) -> Vec<Counts> {
    let mut mpu = Mpu6050::new(Hal(run.bus()), Address::default()).expect("a start");
    mpu.set_digital_lowpass_filter(DigitalLowPassFilter::Filter3).expect("a filter");
    mpu.set_sample_rate_divider(9).expect("a rate");
    mpu.set_gyro_full_scale(GyroFullScale::Deg500).expect("a range");
    mpu.set_accel_full_scale(AccelFullScale::G4).expect("a range");
    // What was measured before is gone after two periods.
    thread::sleep(Duration::from_millis(30));
    let mut read = Vec::new();
    while read.len() < count {
        thread::sleep(Duration::from_millis(2));
        if mpu.interrupt_read_clear().expect("a status") & 1 == 0 {
            continue;
        }
        let (accel, gyro) = mpu.motion6().expect("a sample");
        let counts = [[gyro.x(), gyro.y(), gyro.z()], [accel.x(), accel.y(), accel.z()]];
        if read.last() != Some(&counts) {
            read.push(counts);
        }
    }
    read
}

/// What the scene gives with these settings, in the counts of ±500 deg/s and ±4 g.
fn played(settings: &[Change], seconds: f64) -> Vec<Counts> {
    let mut plan = plan(SCENE);
    plan.set(settings.iter().map(|it| (it.kind, it.setting.clone(), it.written.clone())));
    let again = Plan::parse(&plan.resolved, "resolved", "again", &[]).expect("what was written down");
    let mut all = Vec::new();
    let Ok(()) =
        Player::new(&again, ratetable::time::SimTime((seconds * 1e9) as i64), BLOCK).play(|moment| {
            let of = |kind: SensorKind, per_unit: f64| {
                let reading = moment.readings.iter().find(|it| it.kind == kind)?;
                let [x, y, z] = reading.body()?.value.v.to_array();
                Some([x, -y, -z].map(|it| (it * per_unit).round() as i16))
            };
            let gyro = of(SensorKind::Gyro, GYRO[1].to_degrees());
            all.extend(
                gyro.zip(of(SensorKind::Accel, ACCEL[1] / 9.80665)).map(|(gyro, accel)| [gyro, accel]),
            );
            Ok::<(), Infallible>(())
        });
    all
}

/// How many of these samples are in the others, in this order.
fn found(read: &[Counts], all: &[Counts]) -> usize {
    let mut rest = all.iter();
    read.iter().take_while(|counts| rest.any(|it| it == *counts)).count()
}

#[test]
fn what_a_driver_reads_of_a_noisy_part_is_the_scene_with_its_settings_to_the_bit() {
    let run = Run::start(Arc::new(plan(SCENE)), None);
    let read = read(&run, 100);
    let outcome = run.end();
    accounts(&outcome).expect("a record");
    let all = played(&outcome.settings, outcome.played.seconds());
    assert_eq!(
        found(&read, &all),
        read.len(),
        "{:?}",
        outcome.settings.iter().map(ToString::to_string).collect::<Vec<_>>()
    );
    // Other noise than this is noticed, and so is a sample that changes places with the next.
    let mut swapped = read.clone();
    swapped.swap(50, 51);
    assert!(found(&swapped, &all) < read.len());
    let near: Vec<_> = read.iter().map(|[[x, y, z], accel]| [[x + 1, *y, *z], *accel]).collect();
    assert!(found(&near, &all) < read.len());
}
