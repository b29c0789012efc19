//! Barometer and GPS receiver: closed forms of the truth, statistics of the readings, and no effect on other
//! sensors.

use super::*;
use crate::earth::{self, Place};
use crate::geometry::Nav;
use crate::time::Rate;

fn plan(scene: &str) -> Plan {
    Plan::parse(scene, "s", "s", &[]).unwrap_or_else(|error| panic!("{error}"))
}

fn play(plan: &Plan, block: usize) -> Vec<(SimTime, Reading)> {
    let mut readings = Vec::new();
    let played: Result<(), ()> = Player::new(plan, plan.duration, block).play(|moment| {
        readings.extend(moment.readings.iter().map(|reading| (moment.t, *reading)));
        Ok(())
    });
    played.unwrap();
    readings
}

fn of(plan: &Plan, kind: SensorKind) -> Vec<(SimTime, Reading)> {
    play(plan, BLOCK).into_iter().filter(|(_, reading)| reading.kind == kind).collect()
}

fn displacement(reading: &Reading) -> Measured<Vector<Nav>> {
    reading.position().unwrap().displacement
}

fn fix(reading: &Reading) -> Fix {
    reading.position().unwrap().fix
}

fn true_fix(reading: &Reading) -> Fix {
    reading.position().unwrap().true_fix
}

const PLACE: &str = "[earth]\nlatitude = \"59.93 deg\"\nlongitude = \"30.31 deg\"\naltitude = \"120 m\"\ndate = \"2026-11-22\"\n";

/// A climb at 5 m/s from 120 m: the standard atmosphere at the altitude reached, in the weather of the day.
#[test]
fn pressure_is_the_standard_atmospheres_at_the_altitude() {
    let scene = format!(
        "axes = \"enu-flu\"\nduration = \"100 s\"\n{PLACE}[start]\nvelocity = \"[3, 0, 5] m/s\"\n[baro]\nrate = \"7 Hz\"\nsea_level_pressure = \"1020 hPa\"\nbias = \"2 hPa\"\n"
    );
    let readings = of(&plan(&scene), SensorKind::Baro);
    assert_eq!(readings.len(), 700);
    for (t, reading) in readings {
        let expected = earth::pressure(120.0 + 5.0 * t.seconds(), 102_000.0);
        let Measured { value, truth, bias } = *reading.pressure().unwrap();
        assert!((truth - expected).abs() < 1e-7, "{t}: {truth} against {expected}");
        assert!((value - expected - 200.0).abs() < 1e-7 && bias == 200.0);
    }
    let at_home = of(&plan("duration = \"1 s\"\n[baro]\nrate = \"1 Hz\"\n"), SensorKind::Baro);
    assert_eq!(at_home[0].1.pressure().unwrap().value, 101_325.0);
}

/// A scene of a still vehicle with every sensor, each with noise.
fn still(aids: &str) -> String {
    format!("seed = 7\nduration = \"2000 s\"\n{PLACE}{aids}")
}

#[test]
fn noise_has_the_spread_asked_for_on_the_axis_asked_for() {
    let gps = "[gps]\nrate = \"10 Hz\"\nnoise_std = \"[1, 2, 4] m\"\nvelocity_noise_std = \"[0.1, 0.2, 0.4] m/s\"\n";
    let baro = "[baro]\nrate = \"10 Hz\"\nnoise_density = \"3 Pa/√Hz\"\n";
    for (axes, order) in [("ned-frd", [1.0, 2.0, 4.0]), ("enu-flu", [2.0, 1.0, 4.0])] {
        let plan = plan(&format!("axes = \"{axes}\"\n{}", still(&format!("{gps}{baro}"))));
        let readings = of(&plan, SensorKind::Gps);
        let n = readings.len() as f64;
        let spread = |of: &dyn Fn(&Reading) -> f64| {
            libm::sqrt(readings.iter().map(|(_, reading)| of(reading).powi(2)).sum::<f64>() / n)
        };
        // The relative standard error of a standard deviation from n values is 1/√(2n).
        let near = |found: f64, expected: f64| (found / expected - 1.0).abs() < 5.0 / libm::sqrt(2.0 * n);
        for (axis, expected) in order.into_iter().enumerate() {
            let position = spread(&|reading| {
                let at = displacement(reading);
                (at.value - at.truth).v[axis]
            });
            assert!(near(position, expected), "{axes} {axis}: {position}");
            assert!(!near(1.1 * position, expected), "a tenth more would be seen");
            let velocity = spread(&|reading| fix(reading).velocity.v[axis]);
            assert!(near(velocity, expected / 10.0), "{axes} {axis}: {velocity}");
        }
        let north = spread(&|reading| {
            (fix(reading).position.latitude - true_fix(reading).position.latitude) * 6.385e6
        });
        assert!((north / order[0] - 1.0).abs() < 0.05, "degrees of latitude: {north} m");
        let baro = of(&plan, SensorKind::Baro);
        let pressure: f64 =
            baro.iter().map(|(_, it)| it.pressure().unwrap()).map(|it| (it.value - it.truth).powi(2)).sum();
        let pressure = libm::sqrt(pressure / n);
        assert!(near(pressure, 3.0 * libm::sqrt(5.0)), "{pressure}");
    }
}

const MOVING: &str = "seed = 3\n[start]\nattitude = \"[0, 0, 40] deg\"\n[[motion]]\nkind = \"circle\"\nbank = \"30 deg\"\nspeed = \"20 m/s\"\nduration = \"30 s\"\n[[force]]\nstart = \"3.3 s\"\nduration = \"2 s\"\nacceleration = \"[0, 0, -1] m/s^2\"\nframe = \"nav\"\n";
const INERTIAL: &str = "[gyro]\nrate = \"200 Hz\"\nnoise_std = \"1 deg/s\"\n[accel]\nrate = \"130 Hz\"\nnoise_std = \"0.1 m/s^2\"\nbias_random_walk = \"0.01 m/s^2/rts\"\n[mag]\nrate = \"50 Hz\"\nnoise_std = \"1 uT\"\n";
const BARO: &str = "[baro]\nrate = \"25 Hz\"\nnoise_std = \"2 Pa\"\nbias_instability = \"10 Pa\"\ncorrelation_time = \"5 s\"\n";
const GPS: &str = "[gps]\nnoise_std = \"1 m\"\nbias_instability = \"[1, 1, 2] m\"\ncorrelation_time = \"60 s\"\nvelocity_noise_std = \"0.1 m/s\"\ndelay = \"120 ms\"\n";

/// Readings of one kind, written with every digit, so that equal text means equal bits.
fn bits(plan: &Plan, kind: SensorKind, block: usize) -> Vec<(i64, String)> {
    let readings = play(plan, block).into_iter().filter(|(_, reading)| reading.kind == kind);
    readings.map(|(t, reading)| (t.0, format!("{:?}", reading.measurement))).collect()
}

#[test]
fn a_sensor_that_is_added_changes_no_other_reading() {
    let scenes = [INERTIAL.to_string(), format!("{INERTIAL}{BARO}"), format!("{INERTIAL}{GPS}{BARO}")];
    let [without, with_baro, with_both] = scenes.map(|sensors| plan(&format!("{MOVING}{sensors}")));
    for kind in SensorKind::TRIADS {
        let alone = bits(&without, kind, BLOCK);
        assert!(!alone.is_empty());
        assert!(alone == bits(&with_baro, kind, BLOCK) && alone == bits(&with_both, kind, BLOCK), "{kind}");
    }
    let baro = bits(&with_baro, SensorKind::Baro, BLOCK);
    assert!(baro.len() == 750 && baro == bits(&with_both, SensorKind::Baro, BLOCK));
    // The negative control: another seed changes them.
    let other = plan(&format!("{}{INERTIAL}{BARO}", MOVING.replace("seed = 3", "seed = 4")));
    assert_ne!(baro, bits(&other, SensorKind::Baro, BLOCK));
}

#[test]
fn blocks_of_any_size_give_the_same_bits() {
    let plan = plan(&format!("{MOVING}{INERTIAL}{GPS}{BARO}"));
    let whole = play(&plan, 1 << 20);
    for block in [1, 7, 256] {
        assert!(play(&plan, block) == whole, "{block}");
    }
}

/// A receiver whose velocity is the derivative of its position, delayed.
#[test]
fn a_fix_is_where_the_vehicle_was_a_delay_ago() {
    let quiet = "[gps]\nrate = \"100 Hz\"\ndelay = \"120 ms\"\n";
    let plan = plan(&format!("{MOVING}{PLACE}{quiet}"));
    let readings: Vec<_> = of(&plan, SensorKind::Gps);
    let (origin, mut moved) = (plan.origin(), 0.0f64);
    for pair in readings.windows(13) {
        let ((_, before), (_, now)) = (&pair[0], &pair[12]);
        assert_eq!(displacement(now).value, displacement(before).truth, "12 ticks of 10 ms");
        assert_eq!(fix(now), true_fix(before));
        let by = displacement(now).truth;
        assert_eq!(true_fix(now).position, origin.moved(by));
        moved = moved.max(by.length());
    }
    assert!(moved > 60.0, "{moved} m");
    for pair in readings.windows(3) {
        let [(_, a), (_, b), (_, c)] = pair else { panic!("three") };
        let slope = (displacement(c).truth - displacement(a).truth).v / 0.02;
        let velocity = true_fix(b).velocity.v;
        // h²/6·v″: 10⁻⁴/6 · 20 m/s · (0.28 rad/s)², and half of a force's jump times h.
        assert!((slope - velocity).length() < 6e-3, "{slope} against {velocity}");
    }
    assert!(readings.iter().all(|(_, reading)| true_fix(reading).velocity.v.z.abs() < 2.001));
}

#[test]
fn a_stuck_receiver_stands_still_and_one_that_is_off_says_nothing() {
    let scene = |fault: &str| {
        plan(&format!(
            "{MOVING}[gps]\nrate = \"10 Hz\"\n[[fault]]\nsensor = \"gps\"\nstart = \"2 s\"\nduration = \"3 s\"\n{fault}"
        ))
    };
    let stuck = of(&scene("kind = \"stuck\"\n"), SensorKind::Gps);
    let held = &stuck[19].1;
    for (t, reading) in &stuck[20..50] {
        assert_eq!(fix(reading), fix(held), "{t}");
        assert_ne!(true_fix(reading).position, true_fix(held).position);
    }
    assert_ne!(fix(&stuck[50].1).position, fix(held).position);
    assert_eq!(of(&scene("kind = \"off\"\n"), SensorKind::Gps).len(), 300 - 30);
    let step = of(&scene("kind = \"step\"\nsize = \"[30, -40, 5] m\"\n"), SensorKind::Gps);
    let (_, jumped) = step[30];
    let jumped = displacement(&jumped);
    assert!(((jumped.value - jumped.truth).v - glam::DVec3::new(30.0, -40.0, 5.0)).length() < 1e-9);
}

#[test]
fn a_receiver_ticks_five_times_a_second_unless_told_otherwise() {
    let plan = plan("duration = \"1 s\"\n[gps]\n");
    assert_eq!(plan.sensors[0].rate, Rate::hz(5));
    let here = fix(&of(&plan, SensorKind::Gps)[4].1);
    assert_eq!((here.position, here.velocity), (Place::ORIGIN, Vector::ZERO));
}

/// 20 m/s at sea level is 245 Pa, ½·1.225·20²; the air gets thinner with altitude, and the wind counts.
#[test]
fn a_pitot_tube_reads_half_rho_v_squared_along_body_x() {
    let read = |scene: &str| {
        let readings = of(
            &plan(&format!("duration = \"1 s\"\n{scene}[airspeed]\nrate = \"10 Hz\"\n")),
            SensorKind::Airspeed,
        );
        *readings[0].1.pressure().unwrap()
    };
    let level = "[start]\nvelocity = \"[20, 0, 0] m/s\"\n";
    assert!((read(level).value - 245.0).abs() < 0.01, "{:?}", read(level));
    // Crosswind, tailwind, and at rest.
    let heading =
        |deg: f64| format!("[start]\nattitude = \"[0, 0, {deg}] deg\"\nvelocity = \"[20, 0, 0] m/s\"\n");
    assert!(read(&heading(90.0)).value.abs() < 1e-9);
    assert!((read(&heading(180.0)).value + 245.0).abs() < 0.01);
    assert!((read(&heading(60.0)).value - 245.0 / 4.0).abs() < 0.01, "v along x is a half");
    assert_eq!(read("").value, 0.0);
    // Density: 0.7361 kg/m³ at 5000 m (U.S. Standard Atmosphere, 1976, table I), in proportion to the day's
    // pressure.
    let high = format!(
        "[earth]\nlatitude = \"0 deg\"\nlongitude = \"0 deg\"\naltitude = \"5000 m\"\ndate = \"2026-11-22\"\n{level}"
    );
    assert!((read(&high).value - 0.5 * 0.73643 * 400.0).abs() < 0.01, "{:?}", read(&high));
}

/// The wind is the air's own velocity: with 8 m/s of headwind, 20 m/s over the ground are 28 through the air.
#[test]
fn wind_is_the_velocity_of_the_air_in_the_scenes_nav_axes() {
    for (axes, start, wind) in [
        ("ned-frd", "[20, 0, 0]", "[-8, 5, 0]"),
        ("enu-flu", "[20, 0, 0]", "[-8, -5, 0]"),
        ("ned-frd", "[12, 0, 0]", "[-16, 0, 3]"),
    ] {
        let scene = format!(
            "duration = \"1 s\"\naxes = \"{axes}\"\n[earth]\nwind = \"{wind} m/s\"\n[start]\nvelocity = \"{start} m/s\"\n[airspeed]\nrate = \"10 Hz\"\n"
        );
        let (_, reading) = of(&plan(&scene), SensorKind::Airspeed)[0];
        let expected = 0.5 * 1.225 * 28.0 * 28.0;
        let q = reading.pressure().unwrap().value;
        assert!((q - expected).abs() < 0.02, "{axes}: {q} against {expected}");
    }
}

/// It has the error terms of a single number.
#[test]
fn a_pitot_tube_has_bias_noise_range_resolution_and_faults() {
    let scene = |keys: &str| {
        plan(&format!(
            "seed = 5\nduration = \"200 s\"\n[start]\nvelocity = \"[20, 0, 0] m/s\"\n[airspeed]\nrate = \"50 Hz\"\n{keys}"
        ))
    };
    let readings = |keys: &str| of(&scene(keys), SensorKind::Airspeed);
    let noisy = readings("noise_std = \"3 Pa\"\nbias = \"10 Pa\"\n");
    let n = noisy.len() as f64;
    let off = noisy.iter().map(|(_, it)| it.pressure().unwrap()).map(|it| it.value - it.truth - it.bias);
    let (sum, squares) = off.fold((0.0, 0.0), |(sum, squares), off| (sum + off, squares + off * off));
    assert!((sum / n).abs() < 5.0 * 3.0 / n.sqrt());
    assert!((libm::sqrt(squares / n) / 3.0 - 1.0).abs() < 5.0 / libm::sqrt(2.0 * n));
    assert!(noisy.iter().all(|(_, it)| it.pressure().unwrap().bias == 10.0));
    let clipped = readings("range = \"200 Pa\"\n");
    assert!(clipped.iter().all(|(_, it)| it.clipped && it.pressure().unwrap().value == 200.0));
    let counted = readings("resolution = \"7 Pa\"\n");
    assert!(counted.iter().all(|(_, it)| it.pressure().unwrap().value == 245.0), "35 counts");
    let blocked = readings("[[fault]]\nsensor = \"airspeed\"\nkind = \"off\"\nstart = \"1 s\"\n");
    assert_eq!(blocked.len(), 50);
}
