use super::super::tests::rate_is_the_derivative_of_attitude;
use super::super::{Force, Motion, Trajectory, cone};
use super::*;
use crate::double::Double;
use crate::geometry::{Body, Vector, angle_between, exp};
use crate::keys::{Text, Value};
use crate::time::{NANOS, Rate, SimTime};
use std::fmt::Write;

fn context() -> Context {
    Context {
        duration: SimTime::FOREVER,
        start: Attitude::IDENTITY,
        anywhere: true,
        seed: 0,
        index: 0,
        gravity: 9.8,
        axes: Axes::NedFrd,
    }
}

fn values(text: &str) -> Values {
    let mut values = Values::default();
    values.insert("file", Value::File(Text { name: "log.csv".into(), contents: text.into() }));
    values
}

fn replay(text: &str) -> Box<dyn Motion> {
    build(&values(text), &context()).unwrap_or_else(|error| panic!("{error:?}"))
}

/// 10° about a cone at 0.37 Hz after a general start: every axis moves, with angular acceleration.
fn truth(t: Double) -> (Attitude, Vector<Body>) {
    let start = Attitude::from_quat(exp(DVec3::new(0.3, -0.7, 1.1)));
    let now = cone::Cone::new(Double::from(10f64.to_radians()), Double::from(0.37), 1.0).at(start, t);
    (now.attitude, now.rate)
}

/// A row for each of these times.
fn attitude_log(times: impl Iterator<Item = SimTime>) -> String {
    let mut text = String::from("t_ns,qw,qx,qy,qz\n");
    for t in times {
        let q = truth(t.exact_seconds()).0.q;
        writeln!(text, "{},{},{},{},{}", t.0, q.w, q.x, q.y, q.z).unwrap();
    }
    text
}

fn rate_log(times: impl Iterator<Item = SimTime>) -> String {
    let mut text = String::from("t_ns,x_rad_s,y_rad_s,z_rad_s\n");
    for t in times {
        let w = truth(t.exact_seconds()).1.v;
        writeln!(text, "{},{},{},{}", t.0, w.x, w.y, w.z).unwrap();
    }
    text
}

fn even(hz: u32, seconds: u64) -> impl Iterator<Item = SimTime> {
    (0..=u64::from(hz) * seconds).map(move |k| Rate::hz(hz).tick(k))
}

/// Even times shifted back and forth by up to a third of the interval.
fn uneven(hz: u32, seconds: u64) -> impl Iterator<Item = SimTime> {
    let third = NANOS / i64::from(hz) / 3;
    even(hz, seconds).zip(0..).map(move |(t, k)| SimTime(t.0 + [0, third, -third / 2][k % 3]))
}

/// The largest errors of attitude (rad) and rate (rad/s) away from the rows.
fn errors(motion: &dyn Motion, seconds: u64) -> (f64, f64) {
    let first = truth(Double::ZERO).0;
    let (mut attitude, mut rate) = (0.0, 0.0);
    for i in 0..2000 {
        // Uneven rows end up to a third of an interval early.
        let t = Double::from((seconds as f64 - 0.1) * (f64::from(i) + 0.4567) / 2000.0);
        let (exact, now) = (truth(t), motion.at(first, t));
        attitude = f64::max(attitude, exact.0.angle_to(now.attitude));
        rate = f64::max(rate, (exact.1 - now.rate).length());
    }
    (attitude, rate)
}

#[test]
fn an_attitude_log_is_met_exactly_at_its_rows() {
    let motion = replay(&attitude_log(uneven(50, 2)));
    for t in uneven(50, 2) {
        let (exact, now) = (truth(t.exact_seconds()), motion.at(Attitude::IDENTITY, t.exact_seconds()));
        assert!(exact.0.angle_to(now.attitude) < 1e-15, "{t}");
    }
}

#[test]
fn the_rate_is_the_derivative_of_the_attitude() {
    for text in [
        attitude_log(even(25, 2)),
        attitude_log(uneven(25, 2)),
        rate_log(even(25, 2)),
        rate_log(uneven(25, 2)),
    ] {
        let start = Attitude::from_quat(exp(DVec3::new(-0.2, 0.5, 0.9)));
        rate_is_the_derivative_of_attitude(&*replay(&text), start, SimTime(2 * NANOS));
    }
}

/// Rate and angular acceleration have no step at a row: one-sided differences agree there.
#[test]
fn rate_and_angular_acceleration_are_continuous_at_the_rows() {
    for text in [attitude_log(uneven(10, 2)), rate_log(uneven(10, 2))] {
        let motion = replay(&text);
        let rate = |ns: i64| motion.at(Attitude::IDENTITY, SimTime(ns).exact_seconds()).rate.v;
        let h = 10_000;
        for t in uneven(10, 2).skip(1).take(18) {
            let slope = |from: i64| {
                let [a, b, c] = [0, 1, 2].map(|k| rate(t.0 + from + k * h));
                let end = if from < 0 { 3.0 * c - 4.0 * b + a } else { 4.0 * b - 3.0 * a - c };
                end / (2.0 * h as f64 * 1e-9)
            };
            assert!((rate(t.0 - 1) - rate(t.0)).length() < 1e-7, "rate at {t}");
            assert!((slope(-2 * h) - slope(0)).length() < 1e-4, "{} and {} at {t}", slope(-2 * h), slope(0));
        }
    }
}

#[test]
fn the_error_between_the_rows_falls_at_the_order_of_the_method() {
    type Make = fn(u32) -> String;
    // (log, order of attitude, order of rate)
    let logs: [(&str, Make, f64, f64); 4] = [
        ("attitude", |hz| attitude_log(even(hz, 10)), 5.0, 4.0),
        ("attitude, uneven", |hz| attitude_log(uneven(hz, 10)), 5.0, 4.0),
        ("rate", |hz| rate_log(even(hz, 10)), 4.0, 4.0),
        ("rate, uneven", |hz| rate_log(uneven(hz, 10)), 4.0, 4.0),
    ];
    for (name, make, attitude, rate) in logs {
        let [coarse, fine] = [20, 80].map(|hz| errors(&*replay(&make(hz)), 10));
        let order = |coarse: f64, fine: f64| (coarse / fine).log2() / 2.0;
        let measured = (order(coarse.0, fine.0), order(coarse.1, fine.1));
        assert!(measured.0 > attitude - 0.2, "{name}: attitude of order {}", measured.0);
        assert!(measured.1 > rate - 0.2, "{name}: rate of order {}", measured.1);
    }
}

#[test]
fn a_thousand_rows_a_second_are_replayed_to_the_last_digits() {
    for (text, enough) in [(attitude_log(even(1000, 10)), 2e-14), (rate_log(even(1000, 10)), 2e-12)] {
        let (attitude, _) = errors(&*replay(&text), 10);
        assert!(attitude < enough, "{attitude} rad");
    }
}

#[test]
fn swapped_columns_are_another_motion() {
    let right = attitude_log(even(100, 2));
    for (from, to) in [("qw,qx,qy,qz", "qw,qy,qx,qz"), ("qw,qx,qy,qz", "qx,qw,qy,qz")] {
        let (attitude, rate) = errors(&*replay(&right.replace(from, to)), 2);
        assert!(attitude > 0.1 && rate > 0.1, "{to}: {attitude} rad, {rate} rad/s");
    }
}

#[test]
fn the_sign_of_a_rows_quaternion_says_nothing() {
    let right = attitude_log(even(100, 2));
    let flip = |(i, line): (usize, &str)| match i % 3 {
        1 => line
            .split(',')
            .enumerate()
            .map(|(j, x)| if j > 0 { format!("{}", -x.parse::<f64>().unwrap()) } else { x.into() })
            .collect::<Vec<_>>()
            .join(","),
        _ => line.into(),
    };
    let mut lines = right.lines();
    let header = lines.next().unwrap().to_string();
    let flipped: Vec<_> = std::iter::once(header).chain(lines.enumerate().map(flip)).collect();
    let (one, two) = (replay(&right), replay(&flipped.join("\n")));
    for i in 0..200 {
        let t = Double::from(0.01 * f64::from(i) + 0.003);
        let (a, b) = (one.at(Attitude::IDENTITY, t), two.at(Attitude::IDENTITY, t));
        assert_eq!((a.attitude, a.rate), (b.attitude, b.rate));
    }
    assert!(two.warnings().is_empty(), "{:?}", two.warnings());
}

#[test]
fn after_the_last_row_it_holds() {
    for text in [attitude_log(even(10, 1)), rate_log(even(10, 1))] {
        let motion = replay(&text);
        let [end, later] = [1.0, 7.0].map(|t| motion.at(Attitude::IDENTITY, Double::from(t)));
        assert_eq!((end.attitude, later.rate, end.rate), (later.attitude, Vector::ZERO, Vector::ZERO));
        assert_eq!((motion.length(), motion.next_seam(SimTime(NANOS))), (Some(SimTime(NANOS)), None));
    }
}

#[test]
fn turns_of_more_than_half_a_turn_in_five_rows_are_followed() {
    // 100° a row: across two rows, the shorter way would be backwards.
    let mut text = String::from("t_s qw qx qy qz\n");
    for k in 0..20 {
        let q = exp(DVec3::new(0.6, 0.0, 0.8) * (f64::from(k) * 100f64.to_radians()));
        writeln!(text, "{k} {} {} {} {}", q.w, q.x, q.y, q.z).unwrap();
    }
    let motion = replay(&text);
    for i in 0..95 {
        let now = motion.at(Attitude::IDENTITY, Double::from(0.2 * f64::from(i)));
        let expected = DVec3::new(0.6, 0.0, 0.8) * 100f64.to_radians();
        assert!((now.rate.v - expected).length() < 1e-12, "{:?}", now.rate);
    }
}

/// The same log in the various formats that logs use.
#[test]
fn headers_separators_and_units_are_understood() {
    let rows = [(0.0, 0.0, 1.0, 2.0), (0.1, 3.0, 4.0, 5.0), (0.2, 6.0, 7.0, 8.0)];
    let table = |header: &str, separator: &str, time: f64| {
        let row =
            |&(t, x, y, z): &(f64, f64, f64, f64)| [t * time, x, y, z].map(|x| x.to_string()).join(separator);
        format!("{header}\n{}\n", rows.iter().map(row).collect::<Vec<_>>().join("\n"))
    };
    let columns = |values: &mut Values, time: &str, unit: f64| {
        values.insert("time", Value::Columns(vec![time.into()], unit));
        let names = ["wx", "wy", "wz"].map(String::from).to_vec();
        values.insert("angular_rate", Value::Columns(names, 1f64.to_radians()));
    };
    for (text, time, unit) in [
        (table("us,wx,wy,wz", ",", 1e6), "us", 1e-6),
        (table("wz0;wy0;wx0\n".trim(), ";", 1.0).replace("wz0;wy0;wx0", "t;wx;wy;wz"), "t", 1.0),
        (table("# made by hand\n\n\"t [ms]\"\t\"wx\"\twy\twz", "\t", 1e3), "t [ms]", 1e-3),
        (table("#t   wx wy  wz", "   ", 1.0), "t", 1.0),
        (table("\u{feff}# two\n# t, wx, wy, wz", ", ", 1.0).replace('\n', "\r\n"), "t", 1.0),
    ] {
        let mut values = values(&text);
        columns(&mut values, time, unit);
        let motion = build(&values, &context()).unwrap_or_else(|error| panic!("{text}: {error:?}"));
        assert_eq!(motion.length(), Some(SimTime(NANOS / 5)), "{text}");
        let rate = motion.at(Attitude::IDENTITY, Double::from(0.1)).rate.v;
        assert!((rate - DVec3::new(3.0, 4.0, 5.0) * 1f64.to_radians()).length() < 1e-15, "{text}: {rate}");
    }
}

#[test]
fn mistakes_of_a_log_are_placed() {
    for (text, key, says) in [
        ("", "file", "log.csv is empty"),
        ("# only a comment\n", "file", "is empty"),
        ("0,1,0,0,0\n1,1,0,0,0\n", "file", "log.csv:1 holds numbers, but the line before"),
        (
            "tick,qw,qx,qy,qz\n0,1,0,0,0\n",
            "file",
            "no recognised time column|its columns are tick, qw, qx, qy, qz",
        ),
        ("t_ns,a,b\n0,1,0\n", "file", "no recognised attitude or angular rate|its columns are t_ns, a, b"),
        (
            "t_s,roll,pitch,yaw\n0,1,0,0\n",
            "file",
            "roll, pitch, yaw have no unit: add euler = { columns = [\"roll\"",
        ),
        (
            "t_s,wx,wy,wz\n0,1,0,0\n",
            "file",
            "wx, wy, wz have no unit: add angular_rate = { columns = [\"wx\"",
        ),
        ("t_ns,qw,qx,qy,qz\n", "file", "log.csv has no row, but a motion needs two"),
        ("t_ns,qw,qx,qy,qz\n0,1,0,0,0\n", "file", "has one row"),
        (
            "t_ns,qw,qx,qy,qz\n0,1,0,0,0\n1,1,nan,0,0\n",
            "file",
            "log.csv has one row, but a motion needs two (1 of 2 rows is left out: 1 without a finite value (line 3))",
        ),
        (
            "t_ns,qw,qx,qy,qz\n0,1,0,0,0\n1,1,y,0,0\n2,1,x,0,0\n",
            "file",
            "log.csv:3: column qx: `y` is not a number (and another row like it)",
        ),
        (
            "t_ns,qw,qx,qy,qz\n0,1,0,0,0\n# note\n\n1,1,0\n",
            "file",
            "log.csv:5: the row has 3 columns, the header 5",
        ),
        (
            "t_ns,qw,qx,qy,qz\r\n0,1,0,0,0\r\n\r\n# note\r\n1,1,0\r\n",
            "file",
            "log.csv:5: the row has 3 columns",
        ),
        (
            "t_ns,qw,qx,qy,qz\n5,1,0,0,0\n6,1,0,0,0\n0,1,0,0,0\n1,1,0,0,0\n2,1,0,0,0\n",
            "file",
            "log.csv:4: its clock steps back from the previous row",
        ),
        (
            "t_ns,qw,qx,qy,qz\nzero,1,0,0,0\n4,1,0,0,0\n",
            "file",
            "log.csv:2: column t_ns: `zero` is not a time",
        ),
        (
            "t_ns,qw,qx,qy,qz\n0,1e-7,0,0,0\n4,1,0,0,0\n",
            "file",
            "log.csv:2: a quaternion of length 0.0000001 is not an attitude",
        ),
        (
            "time,qw,qx,qy,qz\n0,1,0,0,0\n100,1,0,0,0\n",
            "file",
            "`time` has no unit, and \"ms\" and \"us\" fit its rows: add time = { column = \"time\", unit = \"us\" }",
        ),
        (
            &"1 0 0 0 0 1 0 0 0 0 1 0\n".repeat(3),
            "file",
            "log.csv is a file of KITTI poses|`replay` does not read",
        ),
    ] {
        let error = build(&values(text), &context()).expect_err(text);
        assert_eq!(error.key, key, "{text}: {}", error.message);
        assert!(says.split('|').all(|part| error.message.contains(part)), "{text}: {}", error.message);
    }
}

#[test]
fn gaps_and_jumps_are_told_with_their_line_and_nothing_is_told_of_a_clean_log() {
    for text in [attitude_log(uneven(100, 5)), rate_log(uneven(100, 5))] {
        assert!(replay(&text).warnings().is_empty(), "{:?}", replay(&text).warnings());
        let lines: Vec<_> = text.lines().collect();
        let without = [&lines[..101], &lines[140..]].concat().join("\n");
        let warnings = replay(&without).warnings().to_vec();
        assert!(warnings.len() == 1 && warnings[0].starts_with("log.csv:102: a gap of 0.4"), "{warnings:?}");
    }
    let jumping = |k: i64, size: f64| if k > 60 { size } else { 0.0 };
    let log = |size: f64| {
        let mut text = String::from("t_ns,roll_rad,pitch_rad,yaw_rad\n");
        for k in 0..100 {
            let t = k as f64 * 0.01;
            let yaw = 0.5 * t * t + jumping(k, size);
            writeln!(text, "{},{},{},{yaw}", k * 10_000_000, 0.2 * t, 0.3 * (2.0 * t).sin()).unwrap();
        }
        text
    };
    assert!(replay(&log(0.0)).warnings().is_empty());
    let warnings = replay(&log(0.1)).warnings().to_vec();
    assert!(warnings.len() == 1 && warnings[0].starts_with("log.csv:63: jumps by 6."), "{warnings:?}");
    // A rate that rises with the same curve has the same jumps: 0.5 rad/s.
    let rates = log(0.5).replace("roll_rad,pitch_rad,yaw_rad", "x_rad_s,y_rad_s,z_rad_s");
    let warnings = replay(&rates).warnings().to_vec();
    assert!(warnings.len() == 1 && warnings[0].starts_with("log.csv:63: jumps by 2"), "{warnings:?}");
}

#[test]
fn across_a_gap_it_turns_the_shorter_way_at_one_rate() {
    let times = || even(100, 3).filter(|t| t.0 <= NANOS || t.0 >= 2 * NANOS);
    let motion = replay(&attitude_log(times()));
    let ends = [1.0, 2.0].map(|t| truth(Double::from(t)).0.q);
    let turn = crate::geometry::log(ends[0].conjugate() * ends[1]);
    for i in 1..100 {
        let t = 1.0 + 0.01 * f64::from(i);
        let now = motion.at(Attitude::IDENTITY, Double::from(t));
        assert!((now.rate.v - turn).length() < 1e-12, "{:?} against {turn}", now.rate);
    }
    // Beyond the gap it is as accurate as before.
    let now = motion.at(Attitude::IDENTITY, Double::from(2.0123));
    assert!(truth(Double::from(2.0123)).0.angle_to(now.attitude) < 1e-7);
}

#[test]
fn a_log_begins_where_the_vehicle_is_unless_it_is_turned_there() {
    let text = attitude_log(even(10, 1));
    let elsewhere = Context { anywhere: false, ..context() };
    let error = build(&values(&text), &elsewhere).unwrap_err();
    assert!(
        error.message.contains("log.csv:2 starts 7") && error.message.contains("align = \"start\""),
        "{error:?}"
    );
    let mut turned = values(&text);
    turned.insert("align", Value::Word("start"));
    let start = Attitude::from_quat(exp(DVec3::new(-0.2, 0.5, 0.9)));
    let motion = build(&turned, &Context { start, ..elsewhere }).unwrap();
    assert!(motion.begins().is_none());
    for t in [0.0, 0.33, 0.9] {
        let now = motion.at(start, Double::from(t));
        let as_logged = replay(&text).at(start, Double::from(t));
        let turn = truth(Double::ZERO).0.inverse() * as_logged.attitude;
        assert!(angle_between((start.q * turn.q).normalize(), now.attitude.q) < 1e-14, "at {t} s");
        assert!((now.rate - as_logged.rate).length() < 1e-12, "at {t} s");
    }
}

/// Over an interval that matches neither rows nor motion, against panels that stop at each row.
#[test]
fn the_mean_rate_is_the_integral_of_the_rate_across_rows() {
    for text in [attitude_log(uneven(70, 2)), rate_log(uneven(70, 2))] {
        let motion = replay(&text);
        let path = Trajectory::new(
            Attitude::IDENTITY,
            vec![(SimTime(2 * NANOS), motion)],
            Vec::<Force>::new(),
            Vector::ZERO,
            Vector::ZERO,
        );
        let (from, to) = (SimTime(123_456_789), SimTime(789_123_456));
        let mean = path.mean(from, to).rate;
        // Each interval between rows separately, in panels of a quarter of it.
        let mut sum = DVec3::ZERO;
        let mut edges: Vec<_> = uneven(70, 2).filter(|t| from < *t && *t < to).collect();
        edges.extend([from, to]);
        edges.sort();
        for pair in edges.windows(2) {
            let width = (pair[1] - pair[0]).0 / 4;
            for k in 0..4 {
                let a = SimTime(pair[0].0 + k * width);
                let b = if k == 3 { pair[1] } else { SimTime(a.0 + width) };
                sum += path.mean(a, b).rate.v * ((b - a).seconds() / (to - from).seconds());
            }
        }
        assert!((mean.v - sum).length() < 1e-14, "{mean:?} against {sum}");
    }
}

/// The attitude and the warnings of a log, at a time.
fn played(text: &str, t: f64) -> (DQuat, Vec<String>) {
    let motion = replay(text);
    (motion.at(Attitude::IDENTITY, Double::from(t)).attitude.q, motion.warnings().to_vec())
}

#[test]
fn rows_that_cannot_be_used_are_left_out_and_told() {
    let row = |t: f64, w: f64, z: f64| format!("{t},{w},0,0,{z}\n");
    let turned = |t: f64| row(t, (0.005 * t).cos(), (0.005 * t).sin());
    let clean = format!("t_s,qw,qx,qy,qz\n{}", (0..6).map(|k| turned(f64::from(k))).collect::<String>());
    assert_eq!(played(&clean, 1.0).1, Vec::<String>::new());
    let second = turned(1.0);
    for (bad, says) in [
        (
            row(1.0, 1.0, 0.0),
            "log.csv: 1 of 7 rows is left out: 1 with the time of the previous row (line 4)",
        ),
        (row(0.5, 1.0, 0.0), "1 older than an earlier row (line 4)"),
        ("1.5,nan,nan,nan,nan\n".into(), "1 without a finite value (line 4)"),
        ("1.5,,,,\n".into(), "1 without a finite value (line 4)"),
        (row(1.5, 0.0, 0.0), "1 with a quaternion of zeros (line 4)"),
    ] {
        let (q, warnings) = played(&clean.replacen(&second, &format!("{second}{bad}"), 1), 1.0);
        assert!(angle_between(q, DQuat::from_rotation_z(0.01)) < 1e-9, "{bad}: {q}");
        assert!(warnings.len() == 1 && warnings[0].contains(says), "{bad}: {warnings:?}");
    }
    // An angular rate of zeros is valid.
    let still = replay("t_s,wx_rad_s,wy_rad_s,wz_rad_s\n0,0,0,0\n1,0,0,0\n2,0,0,0\n");
    assert_eq!((still.length(), still.warnings().len()), (Some(SimTime(2 * NANOS)), 0));
}

#[test]
fn logs_of_other_programs_are_read_by_the_names_of_their_columns() {
    let z = |angle: f64| ((0.5 * angle).cos(), (0.5 * angle).sin());
    let rows = |row: &dyn Fn(i64, f64, f64) -> String| -> String {
        (0..5).map(|k| row(k, z(0.1 * k as f64).0, z(0.1 * k as f64).1) + "\n").collect()
    };
    let euroc = "#timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []\n";
    let euroc = euroc.to_string()
        + &rows(&|k, w, z| format!("{},0,0,0,{w},0,0,{z}", 1_403_636_579_763_555_584 + k * 10_000_000));
    let tum = rows(&|k, w, z| format!("{} 0 0 0 0 0 {z} {w}", 0.01 * k as f64));
    let px4 = "timestamp,timestamp_sample,q[0],q[1],q[2],q[3]\n".to_string()
        + &rows(&|k, w, z| format!("{},0,{w},0,0,{z}", 5_000_000 + k * 10_000));
    for (text, says) in
        [(&euroc, None), (&tum, None), (&px4, Some("`timestamp` has no unit and is read as us"))]
    {
        let (q, warnings) = played(text, 0.03);
        assert!(angle_between(q, DQuat::from_rotation_z(0.3)) < 1e-9, "{text}: {q}");
        let told: Vec<_> = says.into_iter().collect();
        assert_eq!(warnings.len(), told.len(), "{warnings:?}");
        assert!(told.iter().all(|says| warnings[0].contains(says)), "{warnings:?}");
    }
    // The first of the eight columns is the time, and the columns after it are named.
    let imu = "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n0,0,0,0.5,0,0,9.8\n1000000000,0,0,0.5,0,0,9.8\n";
    assert!(angle_between(played(imu, 0.6).0, DQuat::from_rotation_z(0.3)) < 1e-9);
}

#[test]
fn columns_by_number_and_a_rate_make_a_log_of_bare_numbers() {
    let text = "1 0 0 0\n0.5 0 0 0.8660254037844386\n0.5 0 0 0.8660254037844386\n";
    let mut by_number = values(text);
    let numbers = ["1", "2", "3", "4"].map(String::from).to_vec();
    by_number.insert("quaternion", Value::Columns(numbers, 1.0));
    assert!(build(&by_number, &context()).unwrap_err().message.contains("or a rate"));
    by_number.insert("rate", Value::Scalar(Double::from(4.0)));
    let motion = build(&by_number, &context()).unwrap();
    assert_eq!(motion.length(), Some(SimTime(NANOS / 2)));
    let q = motion.at(Attitude::IDENTITY, Double::from(0.25)).attitude.q;
    assert!(angle_between(q, DQuat::from_xyzw(0.0, 0.0, 0.75f64.sqrt(), 0.5)) < 1e-9);
    by_number.insert("time", Value::Columns(vec!["1".into()], 1.0));
    assert!(build(&by_number, &context()).unwrap_err().message.contains("is given with `time`"));
}

#[test]
fn a_position_that_moves_is_told_not_to_be_used() {
    let log = |x: f64| format!("t_s,px_m,py_m,pz_m,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n1,{x},0,0,1,0,0,0\n");
    let warnings = played(&log(0.5), 0.0).1;
    assert!(
        warnings.len() == 1
            && warnings[0].starts_with("log.csv: px_m, py_m, pz_m are not used: ")
            && warnings[0].contains("the accelerometer does not feel"),
        "{warnings:?}"
    );
    assert_eq!(played(&log(0.0), 0.0).1, Vec::<String>::new(), "one that stands still changes nothing");
    let tum = "0 0 0 0 0 0 0 1\n1 0 0 2.5 0 0 0 1\n";
    assert!(played(tum, 0.0).1[0].contains("2, 3, 4 are not used"));
}
