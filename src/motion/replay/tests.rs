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

/// 10° about a cone at 0.37 Hz after a general start: every axis moves, angular acceleration too.
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

/// Even but for a third of the interval, forth and back.
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

/// Rate and angular acceleration have no step at a row: one-sided differences meet there.
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
    // 100° a row: two rows on, the shorter way would be backwards.
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

/// The same log in the ways that logs are written.
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
        ("t,qw,qx,qy,qz\n0,1,0,0,0\n", "file", "no column of time|its columns are t, qw, qx, qy, qz"),
        (
            "t_ns,a,b\n0,1,0\n",
            "file",
            "no attitude or angular rate that is recognised|its columns are t_ns, a, b",
        ),
        ("t_ns,qw,qx,qy,qz\n", "file", "log.csv has no row, but a motion needs two"),
        ("t_ns,qw,qx,qy,qz\n0,1,0,0,0\n", "file", "has one row"),
        (
            "t_ns,qw,qx,qy,qz\n0,1,0,0,0\n1,1,nan,0,0\n",
            "file",
            "log.csv:3: `nan` in column `qx` is no finite number",
        ),
        (
            "t_ns,qw,qx,qy,qz\n0,1,0,0,0\n1,1,,0,0\n2,1,x,0,0\n",
            "file",
            "log.csv:3: `` in column `qx` is no finite number (and another row like it)",
        ),
        (
            "t_ns,qw,qx,qy,qz\n0,1,0,0,0\n# note\n\n1,1,0\n",
            "file",
            "log.csv:5: the row has 3 columns, the header 5",
        ),
        ("t_ns,qw,qx,qy,qz\r\n0,1,0,0,0\r\n\r\n# note\r\n1,1,0", "file", "log.csv:5: the row has 3 columns"),
        ("t_ns,qw,qx,qy,qz\n5,1,0,0,0\n5,1,0,0,0\n", "file", "log.csv:3: `5` in column `t_ns` is not after"),
        ("t_ns,qw,qx,qy,qz\n5,1,0,0,0\n4,1,0,0,0\n6,1,0,0,0\n", "file", "log.csv:3: `4`"),
        (
            "t_ns,qw,qx,qy,qz\nzero,1,0,0,0\n4,1,0,0,0\n",
            "file",
            "log.csv:2: `zero` in column `t_ns` is no time",
        ),
        (
            "t_ns,qw,qx,qy,qz\n0,0,0,0,0\n4,1,0,0,0\n",
            "file",
            "log.csv:2: a quaternion of length 0 is no attitude",
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
    // A rate that rises with the same curve jumps alike: 0.5 rad/s.
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
    // Beyond the gap it is as near as ever.
    let now = motion.at(Attitude::IDENTITY, Double::from(2.0123));
    assert!(truth(Double::from(2.0123)).0.angle_to(now.attitude) < 1e-7);
}

#[test]
fn a_log_begins_where_the_vehicle_is_unless_it_is_turned_there() {
    let text = attitude_log(even(10, 1));
    let elsewhere = Context { anywhere: false, ..context() };
    let error = build(&values(&text), &elsewhere).unwrap_err();
    assert!(
        error.message.contains("log.csv:2 begins 7") && error.message.contains("align = \"start\""),
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

/// Over an interval that fits neither rows nor motion, against panels that stop at each row.
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
        // Each interval between rows by itself, in panels of a quarter of it.
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
