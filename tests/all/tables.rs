//! Files as people have them, given to the program: `ratetable score` and the motion `replay`.

use assert_cmd::Command;
use serde_json::Value;
use std::fs;
use std::path::Path;

/// What a command says: standard output, standard error, exit code.
struct Said {
    out: String,
    err: String,
    code: i32,
}

fn ratetable(home: &Path, arguments: &[&str]) -> Said {
    let output = Command::cargo_bin("ratetable").unwrap().current_dir(home).args(arguments).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    Said { out: text(output.stdout), err: text(output.stderr), code: output.status.code().unwrap_or(-1) }
}

/// A folder with these files.
fn home(files: &[(&str, &[u8])]) -> tempfile::TempDir {
    let home = tempfile::tempdir().unwrap();
    files.iter().for_each(|(name, bytes)| fs::write(home.path().join(name), bytes).unwrap());
    home
}

/// The figures of one file against another.
fn scored(files: &[(&str, &str)], options: &[&str]) -> (Value, String) {
    let bytes: Vec<_> = files.iter().map(|(name, text)| (*name, text.as_bytes())).collect();
    let home = home(&bytes);
    let arguments = [&["score", files[0].0, files[1].0, "--json"], options].concat();
    let said = ratetable(home.path(), &arguments);
    assert_eq!(said.code, 0, "{files:?}: {}", said.err);
    let report: Value = serde_json::from_str(&said.out).unwrap();
    (report["estimates"][0].clone(), said.err)
}

/// Half a circle about the vertical, faster towards its end, a row every 10 ms.
fn turning(header: &str, rows: i64, row: impl Fn(i64, f64, f64) -> String) -> String {
    let angle = |k: i64| 1e-4 * (k * k) as f64 / rows as f64 * 30.0;
    let row = |k: i64| row(k, libm::cos(angle(k)), libm::sin(angle(k)));
    let rows: Vec<_> = (0..rows).map(row).collect();
    format!("{header}{}\n", rows.join("\n"))
}

fn plain(rows: i64) -> String {
    turning("t_ns,qw,qx,qy,qz\n", rows, |k, w, z| format!("{},{w},0,0,{z}", k * 10_000_000))
}

const EUROC: &str =
    "#timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []\n";

#[test]
fn a_header_says_which_column_comes_first_and_in_what_unit_time_is() {
    let truth = plain(400);
    for (what, estimate) in [
        ("a header of EuRoC", turning(EUROC, 400, |k, w, z| format!("{},0,0,0,{w},0,0,{z}", k * 10_000_000))),
        (
            "one in seconds, with other names",
            turning(
                "#timestamp [s], p_x [m], p_y [m], p_z [m], q_w [], q_x [], q_y [], q_z []\n",
                400,
                |k, w, z| format!("{}.{:02},0,0,0,{w},0,0,{z}", k / 100, k % 100),
            ),
        ),
        (
            "one that names eight columns, w before x",
            turning("# t [s], px, py, pz, qw [], qx [], qy [], qz []\n", 400, |k, w, z| {
                format!("{}.{:02},0,0,0,{w},0,0,{z}", k / 100, k % 100)
            }),
        ),
        (
            "the same without a comment, by semicolons, with a row of units",
            turning("t;px;py;pz;qw;qx;qy;qz\n[s];[m];[m];[m];[];[];[];[]\n", 400, |k, w, z| {
                format!("{}.{:02};0;0;0;{w};0;0;{z}", k / 100, k % 100)
            }),
        ),
        (
            "tabs, a byte order mark, CRLF and a title",
            turning("\u{feff}Flight 5\nTime (ms)\tquatX\tquatY\tquatZ\tquatW\n", 400, |k, w, z| {
                format!("{}\t0\t0\t{z}\t{w}", k * 10)
            })
            .replace('\n', "\r\n"),
        ),
        ("a trajectory", turning("", 400, |k, w, z| format!("{}.{:02} 0 0 0 0 0 {z} {w}", k / 100, k % 100))),
    ] {
        let (figures, said) = scored(&[("truth.csv", &truth), ("estimate.csv", &estimate)], &[]);
        assert!(figures["rms_deg"].as_f64().unwrap() < 1e-6, "{what}: {figures} {said}");
        // A delay of a few ns may take the last out of the truth.
        assert!(figures["samples"].as_u64().unwrap() >= 399, "{what}: {figures}");
    }
    // The other order is another attitude.
    let swapped = turning("# t [s], px, py, pz, qx [], qy [], qz [], qw []\n", 400, |k, w, z| {
        format!("{}.{:02},0,0,0,{w},0,0,{z}", k / 100, k % 100)
    });
    let (figures, _) = scored(&[("truth.csv", &truth), ("estimate.csv", &swapped)], &[]);
    assert!(figures["max_deg"].as_f64().unwrap() > 90.0, "{figures}");
}

#[test]
fn a_unit_that_is_not_said_is_told_and_one_that_is_said_is_not() {
    let truth = plain(400);
    let of = |name: &str| {
        turning(&format!("{name},q[0],q[1],q[2],q[3]\n"), 400, |k, w, z| {
            format!("{},{w},0,0,{z}", k * 10_000)
        })
    };
    for (name, says) in
        [("timestamp", true), ("timestamp_us", false), ("timestamp [us]", false), ("TimeUS", false)]
    {
        let (figures, said) = scored(&[("truth.csv", &truth), ("px4.csv", &of(name))], &[]);
        assert!(figures["rms_deg"].as_f64().unwrap() < 1e-6, "{name}: {figures}");
        assert_eq!(said.contains(&format!("its column `{name}` is read as us")), says, "{name}: {said}");
    }
}

#[test]
fn a_few_rows_with_the_header_of_euroc_are_read_as_they_stand() {
    for header in [
        "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []",
        "#timestamp [ns],qw,qx,qy,qz",
        "#timestamp,qw,qx,qy,qz",
        "#timestamp [ns];q_wb_w;q_wb_x;q_wb_y;q_wb_z",
    ] {
        let delimiter = if header.contains(';') { ";" } else { "," };
        let count = header.split(delimiter).count();
        let row = |k: i64| {
            let mut cells = vec![(1_000_000_000_000_000_000 + k * 5_000_000).to_string()];
            cells.extend(vec!["0".into(); count - 5]);
            cells.extend(["1", "0", "0", "0"].map(String::from));
            cells.join(delimiter)
        };
        let text = format!("{header}\n{}\n{}\n{}\n", row(0), row(1), row(2));
        let (figures, said) = scored(&[("a.csv", &text), ("b.csv", &text)], &[]);
        assert_eq!(
            (figures["rms_deg"].as_f64(), figures["samples"].as_u64()),
            (Some(0.0), Some(3)),
            "{header}: {said}"
        );
    }
}

#[test]
fn rows_that_cannot_be_used_are_left_out_and_told_by_score_and_by_replay() {
    let clean = "t_s,qw,qx,qy,qz\n0,1,0,0,0\n0.01,1,0,0,0\n0.02,1,0,0,0\n0.03,1,0,0,0\n";
    let tum = "100.00 0 0 0 0 0 0 1\n100.01 0 0 0 0 0 0 1\n100.01 0 0 0 0 0 0 1\n100.02 0 0 0 0 0 0 1\n";
    for (name, text, left, why) in [
        (
            "dup.tum",
            tum.to_string(),
            3,
            "1 of 4 rows is left out: 1 with the time of the previous row (line 3)",
        ),
        (
            "nan.csv",
            clean.replace("0.01,1,0,0,0", "0.01,nan,nan,nan,nan"),
            3,
            "1 without a finite value (line 3)",
        ),
        (
            "zero.csv",
            clean.replace("0.01,1,0,0,0", "0.01,0,0,0,0"),
            3,
            "1 with a quaternion of zeros (line 3)",
        ),
        ("empty.csv", clean.replace("0.02,1,0,0,0", "0.02,,,,"), 3, "1 without a finite value (line 4)"),
        ("late.csv", clean.replace("0.02,1", "0.005,1"), 3, "1 older than an earlier row (line 4)"),
        (
            "two.csv",
            clean.replace("0.01,1,0,0,0", "0,1,0,0,0\n0.01,inf,0,0,0"),
            3,
            "2 of 5 rows are left out",
        ),
    ] {
        let (figures, said) = scored(&[(name, &text), (name, &text)], &[]);
        assert_eq!(
            (figures["rms_deg"].as_f64(), figures["samples"].as_u64()),
            (Some(0.0), Some(left)),
            "{name}: {said}"
        );
        let told = figures["remarks"].to_string();
        assert!(told.contains(why) && said.contains(why), "{name}: {told} {said}");
        let scene = format!("[gyro]\nrate = \"100 Hz\"\n[[motion]]\nkind = \"replay\"\nfile = \"{name}\"\n");
        let home = home(&[("scene.toml", scene.as_bytes()), (name, text.as_bytes())]);
        let said = ratetable(home.path(), &["check", "scene.toml"]);
        let all = said.out + &said.err;
        assert!(said.code == 0 && all.contains(why), "{name}: {all}");
    }
    let (figures, said) = scored(&[("clean.csv", clean), ("clean.csv", clean)], &[]);
    assert!(!said.contains("left out") && figures["samples"] == 4, "{said}");
}

#[test]
fn a_word_in_a_row_is_still_a_mistake() {
    let home = home(&[
        ("a.csv", b"t_s,qw,qx,qy,qz\n0,1,0,0,0\n1,one,0,0,0\n2,1,0,0,0\n"),
        ("scene.toml", b"[gyro]\nrate = \"1 Hz\"\n[[motion]]\nkind = \"replay\"\nfile = \"a.csv\"\n"),
    ]);
    for arguments in [&["score", "a.csv", "a.csv"][..], &["check", "scene.toml"]] {
        let said = ratetable(home.path(), arguments);
        assert!(
            said.code == 2 && said.err.contains("a.csv:3: column qw: `one` is not a number"),
            "{}",
            said.err
        );
    }
}

#[test]
fn columns_are_chosen_by_name_by_number_and_with_a_rate() {
    let truth = plain(400);
    let foreign = turning("when,a,b,c,d\n", 400, |k, w, z| format!("{},{w},0,0,{z}", k * 10_000));
    let bare = turning("", 400, |_, w, z| format!("{z} 0 0 {w}"));
    let degrees = turning("T,R,P,Y\n", 400, |k, w, z| {
        format!("{},0,0,{}", k * 10, 2.0 * libm::atan2(z, w).to_degrees())
    });
    for (estimate, options) in [
        (&foreign, &["--time", "when:us", "--quaternion", "a,b,c,d"][..]),
        (&foreign, &["--time", "1", "--quaternion", "2,3,4,5"]),
        (&bare, &["--rate", "100 Hz", "--quaternion", "4,2,3,1"]),
        (&degrees, &["--time", "T:ms", "--euler", "R,P,Y:deg"]),
        (&degrees, &["--time", "1:ms", "--euler", "2,3,4:deg"]),
    ] {
        let (figures, said) = scored(&[("truth.csv", &truth), ("x.csv", estimate)], options);
        assert!(figures["rms_deg"].as_f64().unwrap() < 1e-6, "{options:?}: {figures} {said}");
    }
    let home = home(&[("truth.csv", truth.as_bytes()), ("x.csv", foreign.as_bytes())]);
    for (options, says) in [
        (&[][..], "x.csv:1: has neither time nor attitude"),
        (&["--time", "when", "--quaternion", "a,b,c,e"], "x.csv has no column `e`"),
        (&["--time", "when", "--quaternion", "a,b,c"], "takes 4 columns by name or by number"),
        (&["--rate", "100", "--quaternion", "a,b,c,d"], "100"),
        (&["--time", "when", "--euler", "a,b,c"], "--euler a,b,c:deg"),
    ] {
        let said = ratetable(home.path(), &[&["score", "truth.csv", "x.csv"], options].concat());
        assert!(said.code == 2 && said.err.contains(says), "{options:?}: {}", said.err);
    }
}

/// A scene that replays a log, generated; its truth, and what was said.
fn replayed(name: &str, log: &[u8], keys: &str, more: &str) -> (Vec<Vec<f64>>, String) {
    let scene = format!(
        "[gyro]\nrate = \"100 Hz\"\n{more}[[motion]]\nkind = \"replay\"\nfile = \"{name}\"\n{keys}\n"
    );
    let home = home(&[("scene.toml", scene.as_bytes()), (name, log)]);
    let said = ratetable(home.path(), &["generate", "scene.toml", "--out", "out"]);
    assert_eq!(said.code, 0, "{name}: {}", said.err);
    let text = fs::read_to_string(home.path().join("out/truth.csv")).unwrap();
    let row = |line: &str| line.split(',').map(|cell| cell.parse().unwrap()).collect();
    (text.lines().skip(1).map(row).collect(), said.err)
}

#[test]
fn replay_reads_what_score_reads() {
    let turn = |rows: &[Vec<f64>]| {
        let last = rows.last().unwrap();
        (rows.len(), 2.0 * libm::atan2(last[4], last[1]))
    };
    // Of the last sample before the end, which has no row: 0.3 rad/s.
    let three =
        "0.00 0 0 0 0 0 0 1\n0.01 0 0 0 0 0 0.0015 0.999998875\n0.02 0 0 0 0 0 0.0029999955 0.99999549999\n";
    let (rows, said) = replayed("three.tum", three.as_bytes(), "", "");
    let (count, angle) = turn(&rows);
    assert!(count >= 2 && angle > 0.0029 && angle < 0.0061, "{rows:?}");
    assert!(!said.contains("warning"), "{said}");
    let px4 = turning("timestamp,timestamp_sample,q[0],q[1],q[2],q[3]\n", 100, |k, w, z| {
        format!("{},0,{w},0,0,{z}", 7_000_000 + k * 10_000)
    });
    let euroc = turning(EUROC, 100, |k, w, z| {
        format!("{},0,0,0,{w},0,0,{z}", 1_403_636_579_763_555_584 + k * 10_000_000)
    });
    let bare = turning("", 100, |_, w, z| format!("{w},0,0,{z}"));
    let expected = replayed("plain.csv", plain(100).as_bytes(), "", "").0;
    for (log, keys) in [
        (&px4, ""),
        (&euroc, ""),
        (&bare, "quaternion = [\"1\", \"2\", \"3\", \"4\"]\nrate = \"100 Hz\""),
        (&plain(100), "time = { column = \"1\", unit = \"ns\" }\nquaternion = [\"2\", \"3\", \"4\", \"5\"]"),
    ] {
        let (rows, said) = replayed("log.csv", log.as_bytes(), keys, "");
        assert_eq!(rows.len(), expected.len(), "{said}");
        let off = rows.iter().flatten().zip(expected.iter().flatten()).map(|(a, b)| (a - b).abs());
        assert!(off.fold(0.0, f64::max) < 1e-9, "{keys}: {said}");
    }
}

#[test]
fn the_trajectory_that_generate_writes_plays_again() {
    let home = home(&[(
        "again.toml",
        b"[gyro]\nrate = \"100 Hz\"\n[[motion]]\nkind = \"replay\"\nfile = \"first/truth.tum\"\n",
    )]);
    let first = ratetable(
        home.path(),
        &["generate", "coning", "--set", "duration=\"1 s\"", "--format", "csv,tum", "--out", "first"],
    );
    assert_eq!(first.code, 0, "{}", first.err);
    let second = ratetable(home.path(), &["generate", "again.toml", "--out", "second"]);
    assert_eq!(second.code, 0, "{}", second.err);
    let said =
        ratetable(home.path(), &["score", "first", "second/truth.csv", "--json", "--limit", "rms_deg<1e-4"]);
    assert_eq!(said.code, 0, "{}", said.err);
}

#[test]
fn a_position_of_a_log_that_is_not_used_is_told() {
    let log = |swing: f64, names: &str| {
        let row =
            |k: i64| format!("{},{},0,0,1,0,0,0\n", k * 10_000_000, swing * libm::sin(0.0314 * k as f64));
        format!("t_ns,{names},qw,qx,qy,qz\n{}", (0..100).map(row).collect::<String>())
    };
    let more = "[accel]\nrate = \"100 Hz\"\n";
    for names in ["px_m,py_m,pz_m", "p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m]"] {
        let (_, said) = replayed("log.csv", log(2.0, names).as_bytes(), "", more);
        let says = format!("{} are not used", names.replace(',', ", "));
        assert!(said.contains(&says) && said.contains("the accelerometer does not feel"), "{said}");
        let (_, said) = replayed("log.csv", log(0.0, names).as_bytes(), "", more);
        assert!(!said.contains("not used"), "what stands still changes nothing: {said}");
    }
}

#[test]
fn a_time_without_a_unit_that_could_be_two_is_asked_for() {
    let log = |step: i64| turning("time,qw,qx,qy,qz\n", 50, |k, w, z| format!("{},{w},0,0,{z}", k * step));
    let scene = b"[gyro]\nrate = \"10 Hz\"\n[[motion]]\nkind = \"replay\"\nfile = \"log.csv\"\n";
    // 10 Hz in ms, or 10 kHz in us.
    let said = {
        let home = home(&[("scene.toml", scene), ("log.csv", log(100).as_bytes())]);
        ratetable(home.path(), &["check", "scene.toml"])
    };
    assert!(said.code == 2 && said.err.contains("add time = { column = \"time\", unit = "), "{}", said.err);
    let (_, said) = replayed("log.csv", log(10).as_bytes(), "", "");
    assert!(said.contains("its column `time` has no unit and is read as ms"), "{said}");
}

#[test]
fn a_clock_that_begins_anew_is_named_with_its_line() {
    let rows: String =
        (0..40).map(|k| format!("{},1,0,0,0\n", if k < 20 { 500 + 10 * k } else { 10 * k - 200 })).collect();
    let log = format!("t_ms,qw,qx,qy,qz\n{rows}");
    let home = home(&[
        ("scene.toml", b"[gyro]\nrate = \"10 Hz\"\n[[motion]]\nkind = \"replay\"\nfile = \"log.csv\"\n"),
        ("log.csv", log.as_bytes()),
    ]);
    let said = ratetable(home.path(), &["check", "scene.toml"]);
    assert!(said.code == 2 && said.err.contains("log.csv:22: its clock steps back"), "{}", said.err);
}

#[test]
fn a_file_of_another_kind_is_named_wherever_it_is_given() {
    let stamp = 1_700_000_000_000_000u64.to_be_bytes();
    let tlog = [&stamp[..], &[0xfe, 9, 0, 1, 1, 0], &[0; 11]].concat();
    let kitti = "1 0 0 0 0 1 0 0 0 0 1 0\n".repeat(4);
    for (name, bytes, says) in [
        ("x.bin", &b"\xa3\x95\x80\x80\x59FMT\0"[..], "an ArduPilot DataFlash log (.BIN)"),
        ("x.tlog", &tlog, "a MAVLink log with times (.tlog)"),
        ("x.txt", kitti.as_bytes(), "a file of KITTI poses"),
        ("x.parquet", b"PAR1\x15\x00", "a Parquet file"),
    ] {
        let scene = format!("[gyro]\nrate = \"1 Hz\"\n[[motion]]\nkind = \"replay\"\nfile = \"{name}\"\n");
        let home = home(&[("scene.toml", scene.as_bytes()), (name, bytes)]);
        for arguments in [&["score", name, name][..], &["check", "scene.toml"]] {
            let said = ratetable(home.path(), arguments);
            let message = format!("{name} is {says} (recognised by its ");
            assert!(said.code == 2 && said.err.contains(&message), "{arguments:?}: {}", said.err);
        }
    }
}

#[test]
fn a_kalibr_file_with_the_directive_of_opencv_is_read() {
    let yaml = "%YAML:1.0\nimu0:\n  accelerometer_noise_density: 0.002\n  accelerometer_random_walk: 0.0003\n  gyroscope_noise_density: 0.0002\n  gyroscope_random_walk: 0.00002\n  update_rate: 200\n";
    for text in [yaml.to_string(), yaml.replace("%YAML:1.0\n", "%YAML:1.0\n---\n")] {
        let home = home(&[
            ("imu.yaml", text.as_bytes()),
            ("scene.toml", b"duration = \"1 s\"\n[gyro]\npart = \"imu.yaml\"\n"),
        ]);
        let said = ratetable(home.path(), &["check", "scene.toml", "--json"]);
        assert_eq!(said.code, 0, "{text}: {}", said.err);
        let generated = ratetable(home.path(), &["generate", "scene.toml", "--out", "out"]);
        assert_eq!(generated.code, 0, "{}", generated.err);
        let gyro = fs::read_to_string(home.path().join("out/gyro.csv")).unwrap();
        let times: Vec<i64> =
            gyro.lines().skip(1).map(|line| line.split(',').next().unwrap().parse().unwrap()).collect();
        assert_eq!((times.len(), times[1] - times[0]), (200, 5_000_000), "200 Hz");
    }
}
