use super::*;
use crate::geometry::Axes;
use crate::time::NANOS;
use std::collections::BTreeMap;
use std::fs;
use tempfile::TempDir;

fn plan(scene: &str, sets: &[&str]) -> Plan {
    Plan::load(scene, &sets.iter().map(|set| set.to_string()).collect::<Vec<_>>()).unwrap()
}

fn parsed(text: &str) -> Plan {
    Plan::parse(text, "test", "test", &[]).unwrap()
}

fn place() -> (TempDir, PathBuf) {
    let home = tempfile::tempdir().unwrap();
    let out = home.path().join("out");
    (home, out)
}

fn write_to(plan: &Plan, end: SimTime, dir: &Path, force: bool) -> Result<Summary, DatasetError> {
    write(plan, end, dir, Options { force, ..Options::new(&mut |_| {}) })
}

/// Writes a dataset and gives back its files.
fn written(plan: &Plan, end: SimTime, block: usize) -> BTreeMap<String, Vec<u8>> {
    let (_home, out) = place();
    write_in_blocks(plan, end, &out, Options::new(&mut |_| {}), block).unwrap();
    contents(&out)
}

fn contents(dir: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(dir).unwrap().map(|entry| entry.unwrap());
    entries.map(|entry| (entry.file_name().into_string().unwrap(), fs::read(entry.path()).unwrap())).collect()
}

fn tables_of(files: &BTreeMap<String, Vec<u8>>) -> BTreeMap<&String, &Vec<u8>> {
    files.iter().filter(|(name, _)| name.ends_with(".csv")).collect()
}

/// The rows of a CSV file as text, without its header.
fn rows<'a>(files: &'a BTreeMap<String, Vec<u8>>, name: &str) -> Vec<Vec<&'a str>> {
    let text = std::str::from_utf8(&files[name]).unwrap();
    text.lines().skip(1).map(|line| line.split(',').collect()).collect()
}

const SECOND: SimTime = SimTime(NANOS);

const SEVERAL: &str = r#"
axes = "enu-flu"
duration = "0.2 s"
[[motion]]
kind = "circle"
bank = "25 deg"
speed = "15 m/s"
duration = "5 s"
[[force]]
start = "0.03 s"
duration = "0.1 s"
acceleration = "[0, 1.5, 0.3] m/s^2"
[gyro]
rate = "1125 Hz"
sampling = "average"
noise_std = { uniform = ["0.001 rad/s", "0.003 rad/s"] }
bias = { normal = ["0 deg/s", "1 deg/s"] }
bias_random_walk = "20 deg/h/rts"
[accel]
rate = "400/3 Hz"
phase = "1.5 ms"
range = "10 m/s^2"
bias_std = "3 mg"
[mag]
rate = "70 Hz"
noise_density = "0.1 uT/√Hz"
"#;

#[test]
fn files_and_columns_are_exactly_as_specified() {
    let (_home, out) = place();
    let plan = plan("table-1", &[]);
    let estimates = [(SimTime(5), Attitude::IDENTITY)];
    write(&plan, SimTime(NANOS / 10), &out, Options { estimates: &estimates, ..Options::new(&mut |_| {}) })
        .unwrap();
    let files = contents(&out);
    let names: Vec<_> = files.keys().map(String::as_str).collect();
    let expected = [
        "README.md",
        "accel.csv",
        "estimate.csv",
        "gyro.csv",
        "imu.yaml",
        "mag.csv",
        "manifest.json",
        "scene.toml",
        "truth.csv",
    ];
    assert_eq!(names, expected);
    for (name, header) in [
        (
            "truth.csv",
            "t_ns,qw,qx,qy,qz,roll_rad,pitch_rad,yaw_rad,wx_rad_s,wy_rad_s,wz_rad_s,fx_m_s2,fy_m_s2,fz_m_s2,mx_ut,my_ut,mz_ut",
        ),
        (
            "gyro.csv",
            "t_ns,x_rad_s,y_rad_s,z_rad_s,true_x_rad_s,true_y_rad_s,true_z_rad_s,bias_x_rad_s,bias_y_rad_s,bias_z_rad_s",
        ),
        (
            "accel.csv",
            "t_ns,x_m_s2,y_m_s2,z_m_s2,true_x_m_s2,true_y_m_s2,true_z_m_s2,bias_x_m_s2,bias_y_m_s2,bias_z_m_s2",
        ),
        ("mag.csv", "t_ns,x_ut,y_ut,z_ut,true_x_ut,true_y_ut,true_z_ut,bias_x_ut,bias_y_ut,bias_z_ut"),
        ("estimate.csv", "t_ns,qw,qx,qy,qz"),
    ] {
        let text = std::str::from_utf8(&files[name]).unwrap();
        assert_eq!(text.lines().next(), Some(header));
        let width = header.split(',').count();
        assert!(text.ends_with('\n') && text.lines().all(|line| line.split(',').count() == width), "{name}");
    }
    let [w, x, y, z] = rows(&files, "estimate.csv")[0][1..] else { panic!() };
    let north: Vec<f64> = [w, x, y, z].iter().map(|text| text.parse().unwrap()).collect();
    assert!(
        (north[0].abs() - 0.5f64.sqrt()).abs() < 1e-15 && north[0] == north[3],
        "north is yawed 90° in ENU"
    );
}

#[test]
fn every_tick_has_its_row_and_the_truth_has_their_union() {
    let plan = parsed(SEVERAL);
    let files = written(&plan, plan.duration, player::BLOCK);
    let mut union = std::collections::BTreeSet::new();
    for sensor in &plan.sensors {
        let rows = rows(&files, &format!("{}.csv", sensor.kind));
        assert_eq!(
            rows.len() as u64,
            sensor.rate.ticks_before(sensor.phase, plan.duration),
            "{}",
            sensor.kind
        );
        for (k, row) in rows.iter().enumerate() {
            let t: i64 = row[0].parse().unwrap();
            assert_eq!(SimTime(t), sensor.phase + sensor.rate.tick(k as u64));
            union.insert(t);
        }
    }
    let times: Vec<i64> = rows(&files, "truth.csv").iter().map(|row| row[0].parse().unwrap()).collect();
    assert_eq!(times, union.into_iter().collect::<Vec<_>>());
}

#[test]
fn a_row_holds_the_bits_that_were_played() {
    let plan = parsed(SEVERAL);
    let files = written(&plan, plan.duration, player::BLOCK);
    let mut truths = rows(&files, "truth.csv").into_iter();
    let mut sensors: Vec<_> =
        plan.sensors.iter().map(|sensor| rows(&files, &format!("{}.csv", sensor.kind)).into_iter()).collect();
    let same = |text: &[&str], values: &[f64]| {
        let read: Vec<u64> = text[1..].iter().map(|text| text.parse::<f64>().unwrap().to_bits()).collect();
        assert_eq!(read, values.iter().map(|value| (value + 0.0).to_bits()).collect::<Vec<_>>());
    };
    Player::new(&plan, plan.duration, 3)
        .play(|moment| {
            same(&truths.next().unwrap(), &table::truth(plan.axes, moment.truth));
            for reading in moment.readings {
                same(&sensors[reading.sensor].next().unwrap(), table::reading(plan.axes, reading).values());
            }
            Ok::<(), std::convert::Infallible>(())
        })
        .unwrap();
    assert!(files.values().all(|file| !std::str::from_utf8(file).unwrap().contains(",-0,")));
}

#[test]
fn the_block_size_changes_no_byte() {
    let mut plans =
        vec![parsed(SEVERAL), plan("manoeuvre", &["duration=0.3 s"]), plan("mpu-9250", &["duration=0.3 s"])];
    for plan in &mut plans {
        let whole = written(plan, plan.duration, 256);
        for block in [1, 7] {
            assert!(written(plan, plan.duration, block) == whole, "{}: blocks of {block}", plan.name);
        }
    }
}

#[test]
fn playing_the_written_scene_gives_the_same_bytes() {
    let short = ["duration=0.4 s"];
    let all = crate::scene::builtin::SCENES.map(|(name, _)| plan(name, &short));
    let uniform = plan(
        "table-1",
        &["gyro.noise_variance={ uniform = [\"1e-6 rad^2/s^2\", \"9e-6 rad^2/s^2\"] }", short[0]],
    );
    let mounted = plan(
        "mpu-9250",
        &["gyro.mount='dlf'", "accel.range='2 g'", "mag.noise_density='0.1 uT/rtHz'", short[0]],
    );
    let overridden = plan(
        "mpu-9250",
        &["axes='enu-flu'", "gyro.mount=[0.5, 0.5, 0.5, 0.5]", "start.quaternion=[0.6, 0, 0.8, 0]", short[0]],
    );
    for plan in all.into_iter().chain([uniform, mounted, overridden, parsed(SEVERAL)]) {
        let first = written(&plan, plan.duration, player::BLOCK);
        let again =
            Plan::parse(std::str::from_utf8(&first["scene.toml"]).unwrap(), "scene.toml", "scene", &[]);
        let again = again.unwrap_or_else(|error| panic!("{}: {error}\n{}", plan.name, plan.resolved));
        let second = written(&again, again.duration, player::BLOCK);
        assert!(tables_of(&second) == tables_of(&first), "{}: {}", plan.name, plan.resolved);
        assert_eq!(
            second["scene.toml"], first["scene.toml"],
            "{}: resolving twice is resolving once",
            plan.name
        );
    }
}

#[test]
fn the_written_scene_ends_where_the_run_ended() {
    let plan = plan("table-1", &[]);
    let files = written(&plan, SimTime(NANOS / 8), player::BLOCK);
    let again = parsed(std::str::from_utf8(&files["scene.toml"]).unwrap());
    assert_eq!(again.duration, SimTime(NANOS / 8));
    assert!(tables_of(&written(&again, again.duration, player::BLOCK)) == tables_of(&files));
}

#[test]
fn adding_a_sensor_changes_no_other_sensors_file() {
    let alone = parsed(&SEVERAL[..SEVERAL.find("[accel]").unwrap()]);
    let (few, all) =
        (written(&alone, SECOND, player::BLOCK), written(&parsed(SEVERAL), SECOND, player::BLOCK));
    assert_eq!(few["gyro.csv"], all["gyro.csv"]);
    assert!(!few.contains_key("accel.csv") && all.contains_key("accel.csv"));
}

#[test]
fn the_accelerometer_of_table_1_is_truth_plus_bias_in_every_row() {
    let plan = plan("table-1", &[]);
    let files = written(&plan, SECOND + SECOND + SECOND, player::BLOCK);
    let rows = rows(&files, "accel.csv");
    assert_eq!(rows.len(), 3000);
    for row in rows {
        let x: Vec<f64> = row.iter().map(|text| text.parse().unwrap()).collect();
        for axis in 1..4 {
            assert_eq!(x[axis], x[axis + 3] + x[axis + 6], "{row:?}");
        }
        assert_eq!(&row[7..], ["0.0007", "0.00033", "-0.00404"]);
    }
}

#[test]
fn at_rest_the_accelerometer_reads_what_the_readme_says() {
    for (axes, says) in [(Axes::NedFrd, "[0, 0, -9.80665]"), (Axes::EnuFlu, "[0, 0, 9.80665]")] {
        let plan = parsed(&format!("axes = \"{axes}\"\nduration = \"10 ms\"\n[accel]\nrate = \"1 kHz\"\n"));
        let files = written(&plan, plan.duration, player::BLOCK);
        let readme = String::from_utf8(files["README.md"].clone()).unwrap();
        assert!(readme.contains(&format!("the accelerometer reads `{says}`")), "{readme}");
        for row in rows(&files, "accel.csv") {
            assert_eq!(format!("[{}]", row[1..4].join(", ")), says);
        }
        let first = &rows(&files, "truth.csv")[0];
        assert_eq!(first[1..8], ["1", "0", "0", "0", "0", "0", "0"], "{axes}: level, facing the first axis");
        assert!(!files.contains_key("gyro.csv"));
    }
}

#[test]
fn checksums_rows_and_columns_are_those_of_the_files() {
    let (_home, out) = place();
    let plan = parsed(SEVERAL);
    let summary = write_to(&plan, plan.duration, &out, false).unwrap();
    let json: serde_json::Value =
        serde_json::from_slice(&fs::read(out.join("manifest.json")).unwrap()).unwrap();
    assert_eq!(
        (&json["complete"], &json["axes"], &json["seed"]),
        (&true.into(), &"enu-flu".into(), &0.into())
    );
    let mut rows = 0;
    for file in json["files"].as_array().unwrap() {
        let bytes = fs::read(out.join(file["name"].as_str().unwrap())).unwrap();
        let text = std::str::from_utf8(&bytes).unwrap();
        let columns: Vec<_> =
            file["columns"].as_array().unwrap().iter().map(|c| c["name"].as_str().unwrap()).collect();
        assert_eq!(text.lines().next().unwrap(), columns.join(","));
        assert_eq!(text.lines().count() as u64 - 1, file["rows"].as_u64().unwrap());
        assert_eq!(sha256(&bytes), file["sha256"].as_str().unwrap());
        rows += file["rows"].as_u64().unwrap();
    }
    assert_eq!(rows, summary.rows);
    for file in json["other_files"].as_array().unwrap() {
        assert_eq!(
            sha256(&fs::read(out.join(file["name"].as_str().unwrap())).unwrap()),
            file["sha256"].as_str().unwrap()
        );
    }
    let drawn: Vec<_> =
        json["drawn"].as_array().unwrap().iter().map(|drawn| drawn["key"].as_str().unwrap()).collect();
    assert_eq!(drawn, ["gyro.bias", "gyro.noise_std", "accel.bias"]);
    assert_eq!(json["sensors"][0]["sampling"], "average");
    // On a turn of 25° of bank specific force grows to 10.8 m/s², beyond the range; at first it does not.
    let clipped = json["sensors"][1]["clipped"].as_u64().unwrap();
    assert_eq!(summary.clipped, [0, clipped, 0]);
}

fn sha256(bytes: &[u8]) -> String {
    use sha2::Digest;
    sha2::Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

#[test]
fn clipped_samples_are_counted() {
    let plan = parsed("duration = \"1 s\"\n[accel]\nrate = \"50 Hz\"\nrange = \"5 m/s^2\"\n");
    let (_home, out) = place();
    assert_eq!(write_to(&plan, plan.duration, &out, false).unwrap().clipped, [50]);
}

#[test]
fn a_folder_that_holds_something_is_refused_and_force_replaces_its_dataset_alone() {
    let (_home, out) = place();
    let (long, short) = (parsed(SEVERAL), parsed("duration = \"10 ms\"\n[mag]\nrate = \"1 kHz\"\n"));
    fs::create_dir(&out).unwrap();
    may_write(&out, false, Holds::Dataset, &[]).unwrap();
    let extra = [("gyro.svg".to_string(), b"<svg/>".to_vec())];
    write(&long, long.duration, &out, Options { extra: &extra, ..Options::new(&mut |_| {}) }).unwrap();
    assert_eq!(fs::read(out.join("gyro.svg")).unwrap(), b"<svg/>");
    let before = contents(&out);
    let refusal = write_to(&short, short.duration, &out, false).unwrap_err().to_string();
    assert_eq!(may_write(&out, false, Holds::Dataset, &[]).unwrap_err().to_string(), refusal);
    assert!(refusal.contains("already holds files") && refusal.contains("--force"), "{refusal}");
    assert!(contents(&out) == before);

    fs::write(out.join("notes.txt"), "mine").unwrap();
    write_to(&short, short.duration, &out, true).unwrap();
    let names: Vec<_> = contents(&out).into_keys().collect();
    assert_eq!(names, ["README.md", "mag.csv", "manifest.json", "notes.txt", "scene.toml", "truth.csv"]);
}

#[test]
fn a_run_that_stops_leaves_what_was_there() {
    let (home, out) = place();
    let plan = plan("table-1", &[]);
    let stop = AtomicBool::new(false);
    let mut progress = |_| stop.store(true, Ordering::Relaxed);
    let stopped =
        write(&plan, plan.duration, &out, Options { stop: Some(&stop), ..Options::new(&mut progress) });
    assert!(matches!(stopped, Err(DatasetError::Stopped)));
    assert_eq!(fs::read_dir(home.path()).unwrap().count(), 0, "not even a hidden folder");

    write_to(&plan, SimTime(NANOS / 100), &out, false).unwrap();
    let before = contents(&out);
    let stopped = write(
        &plan,
        plan.duration,
        &out,
        Options { force: true, stop: Some(&stop), ..Options::new(&mut |_| {}) },
    );
    assert!(stopped.is_err() && contents(&out) == before);
}

#[test]
fn while_it_is_written_nothing_stands_under_the_name() {
    let (_home, out) = place();
    let plan = plan("table-1", &[]);
    let (mut seen, mut last) = (0, SimTime::ZERO);
    let mut progress = |t| {
        assert!(!out.exists() && t > last);
        (seen, last) = (seen + 1, t);
    };
    write(&plan, SECOND, &out, Options::new(&mut progress)).unwrap();
    assert!(out.join("manifest.json").exists() && seen > 1 && last < SECOND);
}

#[test]
fn errors_name_the_path_and_the_reason() {
    let (home, out) = place();
    let plan = plan("table-1", &[]);
    fs::write(&out, "a file").unwrap();
    for (dir, says) in [
        (out.clone(), "is not a folder"),
        (out.join("deeper"), "ot a directory"),
        ("/proc/here".into(), "cannot create"),
    ] {
        let message = write_to(&plan, SECOND, &dir, true).unwrap_err().to_string();
        assert!(message.contains(says) && message.contains(&*dir.to_string_lossy()), "{message}");
    }
    let endless = write_to(&plan, SimTime::FOREVER, &home.path().join("new"), false).unwrap_err();
    assert!(matches!(endless, DatasetError::Endless));
}

#[test]
fn the_quaternions_sign_is_continuous_and_starts_as_given() {
    for (name, _) in crate::scene::builtin::SCENES {
        let plan = plan(name, &[]);
        let at = |ms: i64| {
            let [w, x, y, z, ..] = table::truth(plan.axes, &plan.trajectory.at(SimTime(ms * NANOS / 1000)));
            glam::DQuat::from_xyzw(x, y, z, w)
        };
        let mut last = at(0);
        for ms in 1..plan.duration.0 * 1000 / NANOS {
            let next = at(ms);
            assert!(last.dot(next) > 0.99 && (next.length() - 1.0).abs() < 1e-14, "{name} at {ms} ms");
            last = next;
        }
    }
    for sign in [1.0, -1.0] {
        for axes in Axes::NAMES {
            let start = [0.5, -0.5, 0.1, 0.7].map(|x: f64| x * sign);
            let plan = parsed(&format!(
                "axes = \"{axes}\"\nduration = \"1 s\"\n[start]\nquaternion = {start:?}\n[mag]\nrate = \"1 Hz\"\n"
            ));
            let row = table::truth(plan.axes, &plan.trajectory.at(SimTime::ZERO));
            assert!(
                row.iter().zip(start).all(|(ours, given)| (ours - given).abs() < 1e-15),
                "{axes}: {row:?}"
            );
        }
    }
}

#[test]
fn a_dataset_reads_back_as_it_was_true() {
    for axes in Axes::NAMES {
        let (_home, out) = place();
        let plan = parsed(&SEVERAL.replace("enu-flu", axes));
        write_to(&plan, plan.duration, &out, false).unwrap();
        for path in [out.clone(), out.join("truth.csv")] {
            let recorded = read::truth(&path).unwrap();
            assert_eq!(recorded.axes, plan.axes);
            for (t, attitude) in &recorded.attitudes {
                assert!(attitude.angle_to(plan.trajectory.at(*t).attitude) < 1e-15);
            }
        }
        let mut readings = read::readings(&out, crate::sensor::SensorKind::Accel).unwrap().into_iter();
        Player::new(&plan, plan.duration, 5)
            .play(|moment| {
                for reading in moment.readings.iter().filter(|reading| reading.sensor == 1) {
                    assert_eq!(readings.next(), Some((moment.t, reading.body().unwrap().value)));
                }
                Ok::<(), std::convert::Infallible>(())
            })
            .unwrap();
        assert_eq!(readings.next(), None);
    }
}

#[test]
fn what_cannot_be_read_is_placed() {
    let (home, out) = place();
    let plan = plan("table-1", &[]);
    write_to(&plan, SimTime(NANOS / 100), &out, false).unwrap();
    let file = out.join("truth.csv");
    let text = fs::read_to_string(&file).unwrap();
    let third = text.lines().nth(2).unwrap();
    for (bad, says) in [
        (text.replacen("qx", "other", 1), "truth.csv:1: has no column `qx`"),
        (
            text.replacen(third, &third.replacen("1000000,1,", "1000000,one,", 1), 1),
            "truth.csv:3, column qw: `one` is not a number",
        ),
        (
            text.replacen(third, &third.replacen("1000000,1,", "1000000,2,", 1), 1),
            "truth.csv:3, column qw..qz",
        ),
        (
            text.replacen(third, &third.replacen("1000000,", "0,", 1), 1),
            "truth.csv:3, column t_ns: 0 is not after 0",
        ),
        (text.replacen(third, &third.replacen("1000000,", "1.5,", 1), 1), "`1.5` is not a whole number"),
        (text.replacen(third, "5,5", 1), "truth.csv:3: the row has 2 columns, the header 17"),
    ] {
        fs::write(&file, bad).unwrap();
        let message = read::truth(&out).unwrap_err().to_string();
        assert!(message.contains(says), "{message}\nshould say {says}");
    }
    fs::write(&file, &text).unwrap();
    fs::remove_file(out.join("manifest.json")).unwrap();
    let message = read::truth(&file).unwrap_err().to_string();
    assert!(message.contains("axes") && message.contains("manifest.json"), "{message}");
    assert!(read::truth(&home.path().join("none.csv")).unwrap_err().to_string().contains("none.csv"));
}

fn figures_of(plan: &Plan, end: SimTime) -> Vec<Figure> {
    let mut figures = Figures::new(plan, end);
    let Ok(()) = Player::new(plan, end, 64).play(|moment| {
        figures.add(&moment);
        Ok::<(), std::convert::Infallible>(())
    });
    figures.done()
}

/// A hundred thousand samples are more points than a picture has: what is left has the same outline.
#[test]
fn a_figure_of_a_long_scene_keeps_what_shows_and_no_more() {
    let plan = parsed("seed = 2\nduration = \"50 s\"\n[gyro]\nrate = \"2 kHz\"\nnoise_std = \"1 deg/s\"\n");
    let line = |end| figures_of(&plan, end)[0].series[0].points.clone();
    let mut all = Vec::new();
    let Ok(()) = Player::new(&plan, plan.duration, 256).play(|moment| {
        let gyro =
            moment.readings.iter().map(|it| (moment.t.seconds(), it.body().unwrap().value.v.x.to_degrees()));
        all.extend(gyro);
        Ok::<(), std::convert::Infallible>(())
    });
    let kept = line(plan.duration);
    assert_eq!(all.len(), 100_000);
    assert!((2000..=8000).contains(&kept.len()), "{}", kept.len());
    assert!(kept.is_sorted_by(|a, b| a.0 < b.0));
    // Of each hundredth of the time, the least and the greatest of all are there.
    for part in 0..100 {
        let within = |point: &&(f64, f64)| (point.0 / 0.5) as usize == part;
        let ends = |points: &[(f64, f64)]| {
            let values = || points.iter().filter(within).map(|point| point.1);
            (values().fold(f64::MAX, f64::min), values().fold(f64::MIN, f64::max))
        };
        assert_eq!(ends(&kept), ends(&all), "{part}");
    }
    // A scene with fewer samples than that keeps each.
    assert_eq!(line(SimTime(4 * NANOS)), all[..8000]);
}

#[test]
fn force_replaces_what_a_manifest_lists_and_refuses_the_rest_by_name() {
    let plan = parsed("duration = \"10 ms\"\n[mag]\nrate = \"1 kHz\"\n");
    let (_home, out) = place();
    fs::create_dir(&out).unwrap();
    for name in ["scene.toml", "README.md", "notes.txt"] {
        fs::write(out.join(name), "mine").unwrap();
    }
    let before = contents(&out);
    let refused = write_to(&plan, plan.duration, &out, true).unwrap_err();
    let DatasetError::NotOurs { names, .. } = &refused else { panic!("{refused}") };
    assert_eq!(names, &["README.md", "scene.toml"]);
    assert!(contents(&out) == before);
    // A manifest of somebody else's lists nothing of ours, whatever it says.
    let other =
        r#"{"program": "else", "files": [{"name": "scene.toml"}], "other_files": [{"name": "README.md"}]}"#;
    fs::write(out.join("manifest.json"), other).unwrap();
    let refused = write_to(&plan, plan.duration, &out, true).unwrap_err();
    let DatasetError::NotOurs { names, .. } = &refused else { panic!("{refused}") };
    assert_eq!(names, &["README.md", "manifest.json", "scene.toml"]);
    // Out of the way, the rest is nobody's business.
    for name in ["scene.toml", "README.md", "manifest.json"] {
        fs::remove_file(out.join(name)).unwrap();
    }
    for _ in 0..2 {
        write_to(&plan, plan.duration, &out, true).unwrap();
        assert_eq!(fs::read(out.join("notes.txt")).unwrap(), b"mine");
    }
    // What comes into the way while the files are made is seen as well.
    let later = Folder::open(&out, true, Holds::Dataset).unwrap();
    later.put("notes.txt", b"ours").unwrap();
    assert!(matches!(later.commit(), Err(DatasetError::NotOurs { .. })));
    assert_eq!(fs::read(out.join("notes.txt")).unwrap(), b"mine");
    assert!(out.join("manifest.json").exists() && out.join("mag.csv").exists());
}

#[test]
fn results_of_one_kind_never_take_the_place_of_anothers() {
    let plan = parsed("duration = \"10 ms\"\n[mag]\nrate = \"1 kHz\"\n");
    let (home, out) = place();
    write_to(&plan, plan.duration, &out, false).unwrap();
    let before = contents(&out);
    let files = [("report.json", b"{}".to_vec())];
    let refused = put_all(&out, true, Holds::Score, &files).unwrap_err().to_string();
    assert!(refused.contains("holds a dataset") && contents(&out) == before, "{refused}");
    // A study adds to an earlier one, and what it adds is its own.
    let study = home.path().join("study");
    put_all(&study, false, Holds::Study, &[("cost.csv", b"1".to_vec())]).unwrap();
    assert!(put_all(&study, false, Holds::Study, &[("cost.csv", b"2".to_vec())]).is_err());
    put_all(&study, true, Holds::Study, &[("allan.csv", b"3".to_vec())]).unwrap();
    put_all(&study, true, Holds::Study, &[("cost.csv", b"4".to_vec())]).unwrap();
    let now = contents(&study);
    assert_eq!(now.keys().collect::<Vec<_>>(), ["allan.csv", "cost.csv", "manifest.json"]);
    assert_eq!((&now["allan.csv"][..], &now["cost.csv"][..]), (&b"3"[..], &b"4"[..]));
    let manifest: serde_json::Value = serde_json::from_slice(&now["manifest.json"]).unwrap();
    assert_eq!(manifest["holds"], "study");
    assert_eq!(manifest["other_files"][1]["sha256"], sha256(b"4"));
    assert!(write_to(&plan, plan.duration, &study, true).is_err());
}

#[test]
fn of_two_that_write_one_folder_one_is_refused() {
    let (home, out) = place();
    let first = Folder::open(&out, false, Holds::Dataset).unwrap();
    first.put("a", b"first").unwrap();
    let busy = Folder::open(&out, true, Holds::Dataset).err().map(|error| error.to_string());
    assert!(busy.is_some_and(|why| why.contains("another process")));
    // One beside it is another folder.
    Folder::open(&home.path().join("beside"), false, Holds::Dataset).unwrap();
    first.commit().unwrap();
    assert_eq!(fs::read(out.join("a")).unwrap(), b"first");
    // One that another has made meanwhile is left as it is.
    let other = home.path().join("other");
    let late = Folder::open(&other, false, Holds::Dataset).unwrap();
    late.put("a", b"late").unwrap();
    fs::create_dir(&other).unwrap();
    fs::write(other.join("a"), "there").unwrap();
    assert!(matches!(late.commit(), Err(DatasetError::Appeared { .. })));
    assert_eq!(fs::read(other.join("a")).unwrap(), b"there");
    let mut left: Vec<_> = fs::read_dir(home.path()).unwrap().map(|it| it.unwrap().file_name()).collect();
    left.sort();
    assert_eq!(left, ["other", out.file_name().unwrap().to_str().unwrap()].map(std::ffi::OsString::from));
}

#[test]
fn the_figures_are_the_papers_four() {
    let plan = plan("table-1", &[]);
    let figures = figures_of(&plan, SimTime(3 * NANOS));
    let stems: Vec<_> =
        figures.iter().map(|figure| (figure.file_stem, figure.series.len(), figure.wraps)).collect();
    assert_eq!(stems, [("gyro", 6, false), ("accel", 6, false), ("mag", 6, false), ("angles", 3, true)]);
    let (t, rate) = figures[0].series[3].points[2500];
    assert!(
        (t - 2.5).abs() < 1e-12 && (rate - 20.0).abs() < 1e-12,
        "case 2 rolls at 20 deg/s from 2 s on: {rate}"
    );
    let (t, roll) = *figures[3].series[0].points.last().unwrap();
    assert!((t - 2.999).abs() < 1e-12 && (roll - 20.0 * 0.999).abs() < 1e-9, "{roll}");
    assert!(figures[0].series[3].is_truth && !figures[0].series[0].is_truth);
    assert_eq!(figures[2].series[0].points.len(), 300);
    assert!((figures[1].series[5].points[0].1 - 9.80665).abs() < 1e-12);
}

#[test]
fn the_readme_tells_what_a_reader_would_ask() {
    let plan = plan("mpu-9250", &[]);
    let readme = String::from_utf8(written(&plan, SimTime(NANOS / 100), 16)["README.md"].clone()).unwrap();
    for said in [
        "Hamilton",
        "declination",
        "numpy",
        "```matlab",
        "ahrs",
        "imuSensor",
        "Drawn once",
        "gyro.bias",
        "point",
        "MPU-9250",
        "nose up",
    ] {
        assert!(readme.contains(said), "{said} is missing from\n{readme}");
    }
}

/// About a fixed axis at 2000 deg/s, 1000 steps of 10 ms and the last row after them.
const FAST: &str = r#"
duration = "10.01 s"
[[motion]]
kind = "rotate"
angular_rate = "[2000, 0, 0] deg/s"
duration = "11 s"
[gyro]
rate = "100 Hz"
noise_std = "0.1 rad/s"
[accel]
rate = "200 Hz"
[mag]
rate = "50 Hz"
[[force]]
duration = "5 s"
acceleration = "[0, 1.5, 0.3] m/s^2"
[reference]
"#;

/// The manifest's entry and the rows of `reference.csv`.
fn reference_of(keys: &str) -> (serde_json::Value, usize, String) {
    let plan = parsed(&format!("{FAST}{keys}"));
    let files = written(&plan, plan.duration, player::BLOCK);
    let manifest: serde_json::Value = serde_json::from_slice(&files["manifest.json"]).unwrap();
    let listed = manifest["files"].as_array().unwrap().iter().any(|file| file["name"] == "reference.csv");
    assert!(listed);
    let header = "t_ns,qw,qx,qy,qz,roll_rad,pitch_rad,yaw_rad\n0,1,0,0,0,0,0,0\n";
    assert!(files["reference.csv"].starts_with(header.as_bytes()));
    let readme = String::from_utf8(files["README.md"].clone()).unwrap();
    (manifest["reference"].clone(), rows(&files, "reference.csv").len(), readme)
}

#[test]
fn the_papers_reference_fails_at_high_rates_as_it_is_known_to() {
    let (entry, rows, readme) = reference_of("");
    assert_eq!((entry["from"].as_str(), entry["method"].as_str(), rows), (Some("gyro"), Some("paper"), 1001));
    let [norm, last] = [&entry["norm_error"], &entry["error_deg"]["final"]].map(|x| x.as_f64().unwrap());
    assert!((norm - 0.166).abs() < 5e-4, "{norm}");
    assert!((last - 99.8).abs() < 0.1, "{last}");
    assert!(
        readme.contains("integrated by the method `paper`") && readme.contains("**`truth.csv` is exact**")
    );
}

#[test]
fn a_good_reference_is_the_truth() {
    for (keys, rows) in [
        ("method = \"magnus-4\"", 1001),
        ("method = \"coning-4\"", 251),
        ("from = \"accel-mag\"", 2002),
        ("from = \"accel-mag\"\nmethod = \"paper\"", 2002),
    ] {
        let (entry, found, readme) = reference_of(keys);
        assert_eq!(found, rows, "{keys}");
        for field in ["rms", "max", "final"] {
            let error = entry["error_deg"][field].as_f64().unwrap();
            assert!(error < 1e-9, "{keys}: {field} {error} deg");
        }
        assert!(entry["norm_error"].as_f64().unwrap().abs() < 1e-12);
        assert!(readme.contains("## Reference"));
    }
}

#[test]
fn a_chosen_reference_says_why_and_its_scene_plays_to_the_same_bytes() {
    let plan = parsed(&format!("{FAST}method = \"auto\"\ntolerance = \"1e-4 deg\"\n"));
    let files = written(&plan, plan.duration, player::BLOCK);
    let manifest: serde_json::Value = serde_json::from_slice(&files["manifest.json"]).unwrap();
    let entry = &manifest["reference"];
    assert!(entry["error_deg"]["max"].as_f64().unwrap() <= 1e-4, "{entry}");
    let chosen = entry["chosen"].as_str().unwrap();
    assert!(chosen.starts_with(entry["method"].as_str().unwrap()) && chosen.contains("cheaper"), "{chosen}");
    assert!(entry["rate_hz"].as_f64().unwrap() < 100.0, "{entry}");
    let resolved = String::from_utf8(files["scene.toml"].clone()).unwrap();
    assert!(!resolved.contains("auto") && !resolved.contains("tolerance"), "{resolved}");
    let again = parsed(&resolved);
    assert_eq!(written(&again, again.duration, player::BLOCK)["reference.csv"], files["reference.csv"]);
    let strict = parsed(&format!("{FAST}method = \"auto\"\ntolerance = \"1e-20 deg\"\n"));
    let (_home, out) = place();
    let refused = write_to(&strict, strict.duration, &out, false).unwrap_err().to_string();
    assert!(refused.contains("no method at any rate up to 1600 Hz stays within"), "{refused}");
}

#[test]
fn a_scene_without_a_reference_has_none_and_one_beyond_numbers_says_why() {
    let (_home, out) = place();
    let plain = plan("still", &["duration=1 s"]);
    write_to(&plain, plain.duration, &out, false).unwrap();
    let files = contents(&out);
    assert!(!files.contains_key("reference.csv"));
    assert!(!String::from_utf8_lossy(&files["manifest.json"]).contains("\"reference\""));
    let text = "[[motion]]\nkind = \"rotate\"\nroll = \"1e6 deg/s\"\nduration = \"100 s\"\n[gyro]\nrate = \"1 Hz\"\n[reference]\nmethod = \"paper\"\n";
    let (wild, (_home, out)) = (parsed(text), place());
    let refused = write_to(&wild, wild.duration, &out, false).unwrap_err().to_string();
    assert!(refused.contains("reference.csv cannot be computed: `paper` at"), "{refused}");
    assert!(!out.exists());
}

/// A dataset whose scene replays a log has the log beside it, and plays again to the same bytes, log and all.
#[test]
fn a_replayed_log_goes_with_the_dataset_which_plays_again_to_the_same_bytes() {
    let home = tempfile::tempdir().unwrap();
    let first = home.path().join("first");
    write_to(&parsed(SEVERAL), SECOND, &first, false).unwrap();
    let scene = "axes = \"enu-flu\"\n[[motion]]\nkind = \"hold\"\nduration = \"0.1 s\"\n[[motion]]\nkind = \"replay\"\nfile = \"first/truth.csv\"\nalign = \"start\"\n[gyro]\nrate = \"300 Hz\"\nsampling = \"average\"\n[accel]\nrate = \"100 Hz\"\nnoise_std = \"0.1 m/s^2\"\n";
    let file = home.path().join("scene.toml");
    fs::write(&file, scene).unwrap();
    let load = |path: &Path| Plan::load(&path.display().to_string(), &[]).unwrap();
    let (second, third) = (home.path().join("second"), home.path().join("third"));
    let plan = load(&file);
    write_to(&plan, plan.duration, &second, false).unwrap();
    let again = load(&second.join("scene.toml"));
    write_to(&again, again.duration, &third, false).unwrap();
    let (second, third) = (contents(&second), contents(&third));
    assert_eq!(second["motion-1.csv"], contents(&first)["truth.csv"]);
    for (name, bytes) in &second {
        let [before, after] = [bytes, &third[name]].map(|bytes| String::from_utf8_lossy(bytes));
        assert!(before == after, "{name}: {before}\n{after}");
    }
    let manifest = String::from_utf8(second["manifest.json"].clone()).unwrap();
    assert!(manifest.contains("\"name\": \"motion-1.csv\""), "{manifest}");
    assert!(String::from_utf8(second["README.md"].clone()).unwrap().contains("`motion-1.csv`: a log"));
}

#[test]
fn a_log_that_changed_since_it_was_read_is_not_copied() {
    let home = tempfile::tempdir().unwrap();
    let (scene, log) = (home.path().join("s.toml"), home.path().join("log.csv"));
    fs::write(&scene, "[[motion]]\nkind = \"replay\"\nfile = \"log.csv\"\n[gyro]\nrate = \"10 Hz\"\n")
        .unwrap();
    fs::write(&log, "t_s,qw,qx,qy,qz\n0,1,0,0,0\n1,1,0,0,0\n").unwrap();
    let plan = Plan::load(&scene.display().to_string(), &[]).unwrap();
    fs::write(&log, "t_s,qw,qx,qy,qz\n0,1,0,0,0\n2,1,0,0,0\n5,1,0,0,0\n").unwrap();
    let error = write_to(&plan, plan.duration, &home.path().join("out"), false).unwrap_err().to_string();
    assert!(error.starts_with("cannot copy ") && error.contains("log.csv: it has changed since"), "{error}");
    assert!(!home.path().join("out").exists());
}

/// Without half a second of samples at 100 Hz, the rows say what there is and the manifest what went wrong.
#[test]
fn a_fault_is_told_and_its_missing_samples_are_not_counted() {
    let text = "duration = \"2 s\"\n[gyro]\nrate = \"100 Hz\"\n[accel]\nrate = \"50 Hz\"\n[[fault]]\nsensor = \"gyro\"\nkind = \"off\"\nstart = \"1 s\"\nduration = \"0.5 s\"\n[[fault]]\nsensor = \"accel\"\nkind = \"wrong\"\nstart = \"9 s\"\n";
    let plan = Plan::parse(text, "s", "s", &[]).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    write_to(&plan, plan.duration, &out, false).unwrap();
    let json: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(out.join("manifest.json")).unwrap()).unwrap();
    assert_eq!(json["faults"], serde_json::json!(["gyro off from 1 s to 1.5 s"]), "the other had not begun");
    assert_eq!((&json["sensors"][0]["samples"], &json["sensors"][1]["samples"]), (&150.into(), &100.into()));
    let rows = fs::read_to_string(out.join("gyro.csv")).unwrap().lines().count();
    assert_eq!(rows, 151);
}

#[test]
fn an_aids_tables_have_what_it_reads_beside_what_is_true() {
    let aids = "[baro]\nrate = \"10 Hz\"\nbias = \"50 Pa\"\n[gps]\nnoise_std = \"1 m\"\nvelocity_noise_std = \"0.1 m/s\"\n";
    let plan = parsed(&format!(
        "duration = \"20 s\"\n[earth]\nlatitude = \"50 deg\"\nlongitude = \"8 deg\"\naltitude = \"100 m\"\ndate = \"2026-11-22\"\n[start]\nvelocity = \"[0, 10, -1] m/s\"\n[gyro]\nrate = \"10 Hz\"\n{aids}"
    ));
    let files = written(&plan, plan.duration, player::BLOCK);
    let header = |name: &str| std::str::from_utf8(&files[name]).unwrap().lines().next().unwrap().to_string();
    assert_eq!(
        header("baro.csv"),
        "t_ns,pressure_pa,true_pressure_pa,bias_pa,pressure_altitude_m,temperature_degc"
    );
    assert_eq!(
        header("gps.csv"),
        "t_ns,lat_deg,lon_deg,alt_m,vn_m_s,ve_m_s,vd_m_s,true_lat_deg,true_lon_deg,true_alt_m,true_vn_m_s,true_ve_m_s,true_vd_m_s"
    );
    let numbers = |name: &str| -> Vec<Vec<f64>> {
        rows(&files, name).iter().map(|row| row.iter().map(|cell| cell.parse().unwrap()).collect()).collect()
    };
    let (baro, gps) = (numbers("baro.csv"), numbers("gps.csv"));
    assert_eq!((baro.len(), gps.len()), (200, 100));
    for row in &baro {
        let expected = crate::earth::pressure(100.0 + row[0] * 1e-9, 101_325.0);
        assert!((row[2] - expected).abs() < 1e-6 && (row[1] - row[2] - 50.0).abs() < 1e-9 && row[3] == 50.0);
        assert_eq!((row[4], row[5]), (crate::earth::pressure_altitude(row[1]), 25.0));
    }
    for row in &gps {
        let t = row[0] * 1e-9;
        let there = plan.origin().moved(crate::geometry::Vector::new(0.0, 10.0 * t, -t));
        let expected =
            [there.latitude.to_degrees(), there.longitude.to_degrees(), there.altitude, 0.0, 10.0, -1.0];
        for (found, expected) in row[7..].iter().zip(expected) {
            assert!((found - expected).abs() < 1e-9, "{row:?}");
        }
        assert!((row[1] - row[7]).abs() < 1e-4 && row[1] != row[7] && (row[5] - row[11]).abs() < 1.0);
    }
    let manifest: serde_json::Value = serde_json::from_slice(&files["manifest.json"]).unwrap();
    assert_eq!(manifest["sensors"][2]["name"], "gps");
    assert_eq!(manifest["sensors"][1]["samples"], 200);
    let figures = figures_of(&plan, plan.duration);
    let lines: Vec<_> = figures.iter().map(|figure| (figure.file_stem, figure.series.len())).collect();
    assert_eq!(lines, [("gyro", 6), ("baro", 2), ("gps", 6), ("angles", 3)]);
}

#[test]
fn a_figure_breaks_where_samples_are_missing() {
    let scene = "duration = \"10 s\"\n[gyro]\nrate = \"50 Hz\"\n[baro]\nrate = \"20 Hz\"\n\
        [[fault]]\nkind = \"off\"\nsensor = \"baro\"\nstart = \"3 s\"\nduration = \"3 s\"\n";
    let plan = Plan::parse(scene, "s", "s", &[]).unwrap();
    let mut figures = Figures::new(&plan, plan.duration);
    let Ok(()) = Player::new(&plan, plan.duration, player::BLOCK).play(|moment| {
        figures.add(&moment);
        Ok::<(), std::convert::Infallible>(())
    });
    for figure in figures.done() {
        for series in &figure.series {
            let breaks: Vec<f64> =
                series.points.iter().filter(|(_, value)| value.is_nan()).map(|(t, _)| *t).collect();
            let expected = if figure.file_stem == "baro" { vec![6.0] } else { Vec::new() };
            assert_eq!(breaks, expected, "{} {}", figure.file_stem, series.label);
        }
    }
}
