//! Written data reads back; an error names its place.

use super::*;
use crate::geometry::{Attitude, Euler};
use crate::score::{HeldAt, Timed};
use crate::time::SimTime;

fn attitude(k: i64) -> Attitude {
    let k = k as f64;
    Attitude::from_quat(Euler { roll: 0.01 * k, pitch: -0.02 * k, yaw: 0.1 * k }.to_quat())
}

fn wrote(text: &str, axes: Axes) -> Result<Recorded, String> {
    table::read("x.csv", text.as_bytes(), &Reading { axes, ..Reading::default() })
        .map_err(|error| error.to_string())
}

/// Ten rows made from their number, under a header.
fn rows(header: &str, row: impl Fn(i64) -> String) -> String {
    let rows: Vec<_> = (0..10).map(row).collect();
    format!("{header}\n{}\n", rows.join("\n"))
}

/// The recorded attitudes, with their times in the likeliest unit.
fn timed(recorded: &Recorded) -> Vec<Timed> {
    let times = recorded.times.in_ns(recorded.times.guess().0).unwrap();
    let one = |(t, q): (i64, &Packed)| Timed {
        arrival: SimTime(t),
        stamp: HeldAt::Arrival,
        attitude: q.attitude(),
    };
    times.into_iter().zip(&recorded.attitudes).map(one).collect()
}

fn same(recorded: &Recorded, step: i64) {
    assert_eq!(timed(recorded).len(), 10);
    for (k, estimate) in timed(recorded).iter().enumerate() {
        let k = k as i64;
        assert_eq!((estimate.arrival.0, estimate.stamp), (k * step, HeldAt::Arrival));
        assert!(estimate.attitude.angle_to(attitude(k)) < 1e-12, "{k}");
    }
}

#[test]
fn tables_are_read_by_the_names_of_their_columns() {
    let q = |k: i64| attitude(k).q;
    let texts = [
        rows("t_ns,qw,qx,qy,qz", |k| {
            format!("{},{},{},{},{}", k * 10_000_000, q(k).w, q(k).x, q(k).y, q(k).z)
        }),
        rows("qz; qy; qx; qw; foo; Time_ms", |k| {
            format!("{};{};{};{};what;{}", q(k).z, q(k).y, q(k).x, q(k).w, k * 10)
        }),
        rows("# a comment\n\nt_s roll_rad pitch_rad yaw_rad", |k| {
            let e = Euler::from_quat(q(k));
            format!("{} {} {} {}", k as f64 * 0.01, e.roll, e.pitch, e.yaw)
        }),
        rows("timestamp\tyaw_deg\tpitch_deg\troll_deg", |k| {
            let e = Euler::from_quat(q(k));
            let [roll, pitch, yaw] = [e.roll, e.pitch, e.yaw].map(f64::to_degrees);
            format!("{}\t{yaw}\t{pitch}\t{roll}", k * 10_000)
        }),
        // A header as numpy.savetxt writes it, and the first bytes of a spreadsheet's file.
        rows("# made by hand\n# t_s,qw,qx,qy,qz", |k| {
            format!("{},{},{},{},{}", k as f64 * 0.01, q(k).w, q(k).x, q(k).y, q(k).z)
        }),
        rows("# t_s qw qx qy qz gx gy gz", |k| {
            format!("{} {} {} {} {} 1 2 3", k as f64 * 0.01, q(k).w, q(k).x, q(k).y, q(k).z)
        }),
        rows("\u{feff}t_ms,qw,qx,qy,qz", |k| {
            format!("{},{},{},{},{}", k * 10, q(k).w, q(k).x, q(k).y, q(k).z)
        }),
        // A TUM trajectory has w last and no header.
        rows("# time x y z qx qy qz qw", |k| {
            format!("{} 1 2 3 {} {} {} {}", k as f64 * 0.01, q(k).x, q(k).y, q(k).z, q(k).w)
        }),
    ];
    for text in texts {
        same(&wrote(&text, Axes::NedFrd).expect(&text), 10_000_000);
    }
}

#[test]
fn axes_are_those_it_is_said_to_be_written_in() {
    let written = |k: i64| Axes::EnuFlu.attitude_out(attitude(k));
    let text = rows("t_us,q0,q1,q2,q3", |k| {
        let q = written(k);
        format!("{},{},{},{},{}", k * 1000, q.w, q.x, q.y, q.z)
    });
    same(&wrote(&text, Axes::EnuFlu).unwrap(), 1_000_000);
    let other = wrote(&text, Axes::NedFrd).unwrap().attitudes[0].attitude();
    assert!(other.angle_to(attitude(0)) > 1.0, "and not any others");
}

#[test]
fn a_time_without_a_unit_is_in_none_and_the_likeliest_is_known() {
    for (times, step) in [
        (["0.0", "0.01", "0.02"], 10_000_000),
        (["0", "10", "20"], 10_000_000),
        (["0", "10000", "20000"], 10_000_000),
        (["0", "10000000", "20000000"], 10_000_000),
        (["7", "8", "9"], 1_000_000_000),
    ] {
        let text = format!("time,w,x,y,z\n{},1,0,0,0\n{},1,0,0,0\n{},1,0,0,0", times[0], times[1], times[2]);
        let recorded = wrote(&text, Axes::NedFrd).unwrap();
        let [a, b] = [0, 1].map(|i| timed(&recorded)[i].arrival.0);
        assert_eq!((b - a, recorded.times.unit), (step, None), "{times:?}");
        assert_eq!(recorded.time_name, "time");
    }
}

#[test]
fn angles_in_rad_can_be_read_as_degrees() {
    let text = rows("t_s,roll_rad,pitch_rad,yaw_rad", |k| format!("{k},{},{},{}", 3 * k, -2 * k, 7 * k));
    let recorded = wrote(&text, Axes::NedFrd).unwrap();
    let (name, attitudes) = &recorded.others[0];
    let [roll, pitch, yaw] = [12f64, -8.0, 28.0].map(f64::to_radians);
    assert!(
        attitudes[4].attitude().angle_to(Attitude::from_quat(Euler { roll, pitch, yaw }.to_quat())) < 1e-12
    );
    assert!(name.contains("degrees"));
}

#[test]
fn every_mistake_has_its_place_and_what_would_be_right() {
    for (text, says) in [
        ("", "x.csv is empty"),
        ("t_s,qw,qx,qy,qz\n", "no rows"),
        ("# hello\na,b\n1,2", "x.csv:2: has neither time nor attitude"),
        ("1,1,0,0,0\n2,1,0,0,0", "x.csv:1: is a row of numbers, not the header"),
        ("# foo bar\n1,1,0,0,0", "x.csv:2: is a row of numbers"),
        ("t_s,a\n1,2", "x.csv:1: has no attitude: qw, qx"),
        ("qw,qx,qy,qz\n1,0,0,0", "has no time: t_ns"),
        ("t_s,roll,pitch,yaw\n1,2,3,4", "no unit: call them roll_deg"),
        ("t_s,qw,qx,qy,qz\n0,1,0,0,0\n1,1,0,zero,0", "x.csv:3: column qy: `zero` is not a number"),
        ("t_s,qw,qx,qy,qz\n0,1,0,0\n", "x.csv:2: the row has 4 columns, the header 5"),
        ("t_s,qw,qx,qy,qz\n0,1,0,0,0\n1,2,0,0,0", "x.csv:3: a quaternion of length 2"),
        ("t_s,qw,qx,qy,qz\n0,nan,0,0,0\n1,0,0,0,0", "no usable row: 2 of 2 rows are left out"),
        ("t_s,qw,qx,qy,qz\n0,nan\n", "x.csv:2: the row has 2 columns, the header 5"),
        ("0 0 0 0 0 0 0 1\n1 0 0 0 0 0 x 1", "x.csv:2: column 7: `x`"),
    ] {
        let message = wrote(text, Axes::NedFrd).expect_err(text);
        assert!(message.contains(says), "{text}: {message}");
    }
    let two = wrote("t_s,qw,qx,qy,qz\n0,a,0,0,0\n1,b,0,0,0", Axes::NedFrd).unwrap_err();
    assert_eq!(two.lines().count(), 2, "{two}");
}

/// A record of a ULog: size, type, payload.
fn record(kind: u8, payload: &[u8]) -> Vec<u8> {
    let size = (payload.len() as u16).to_le_bytes();
    [&size[..], &[kind], payload].concat()
}

/// A log after docs.px4.io, "ULog File Format": another topic, a second instance, a field before the quaternion.
fn log(first: i64, topic: &str) -> Vec<u8> {
    let mut log = [MAGIC_AND_VERSION, &[0; 8]].concat();
    log.extend(record(b'B', &[0; 40]));
    log.extend(record(b'F', b"other:uint64_t timestamp;float[3] v;"));
    let format =
        format!("{topic}:uint64_t timestamp;uint64_t timestamp_sample;float[4] q;uint8_t[4] _padding0;");
    log.extend(record(b'F', format.as_bytes()));
    for (multi, id, name) in [(0_u8, 0_u16, "other"), (0, 1, topic), (1, 2, topic)] {
        log.extend(record(b'A', &[&[multi][..], &id.to_le_bytes(), name.as_bytes()].concat()));
    }
    for k in 0..10 {
        let t = (first + k * 10_000) as u64;
        log.extend(record(b'D', &[&0_u16.to_le_bytes()[..], &t.to_le_bytes(), &[0; 12]].concat()));
        for (id, attitude) in [(1_u16, attitude(k)), (2, Attitude::IDENTITY)] {
            let q = attitude.q;
            let q: Vec<u8> = [q.w, q.x, q.y, q.z].iter().flat_map(|c| (*c as f32).to_le_bytes()).collect();
            let payload = [&id.to_le_bytes()[..], &(t + 700).to_le_bytes(), &t.to_le_bytes(), &q].concat();
            log.extend(record(b'D', &payload));
        }
    }
    log
}

const MAGIC_AND_VERSION: &[u8] = b"ULog\x01\x12\x35\x01";

fn read_log(bytes: &[u8]) -> Result<Recorded, String> {
    let home = tempfile::tempdir().unwrap();
    let path = home.path().join("flight.ulg");
    std::fs::write(&path, bytes).unwrap();
    read(&path, Axes::EnuFlu).map_err(|error| error.to_string())
}

#[test]
fn a_ulog_gives_its_first_vehicle_attitude_at_the_samples_time() {
    let recorded = read_log(&log(412_000_000, "vehicle_attitude")).unwrap();
    assert_eq!((recorded.attitudes.len(), recorded.axes), (10, Axes::NedFrd));
    for (k, estimate) in timed(&recorded).iter().enumerate() {
        assert_eq!(estimate.arrival.0, 412_000_000_000 + k as i64 * 10_000_000);
        // Single precision.
        assert!(estimate.attitude.angle_to(attitude(k as i64)) < 1e-6);
    }
    assert_eq!(recorded.remarks, Vec::<String>::new());
}

#[test]
fn a_ulog_that_breaks_off_is_read_as_far_as_it_goes_and_no_bytes_panic() {
    let whole = log(5, "vehicle_attitude");
    let cut = read_log(&whole[..whole.len() - 30]).unwrap();
    assert!(cut.attitudes.len() == 9 || cut.attitudes.len() == 10);
    assert!(cut.remarks[0].contains("is truncated"), "{:?}", cut.remarks);
    let other = read_log(&log(5, "vehicle_attitude_setpoint")).unwrap_err();
    assert!(
        other.contains("no topic vehicle_attitude") && other.contains("other, vehicle_attitude_setpoint")
    );
    for i in (0..whole.len()).step_by(7) {
        let mut bytes = whole.clone();
        bytes[i] ^= 0x55;
        let _ = read_log(&bytes);
        let _ = read_log(&whole[..i]);
    }
}

#[test]
fn bytes_that_are_nothing_are_told() {
    assert!(read_log(&[0xff; 99]).unwrap_err().contains("neither text nor a ULog"));
    let missing = read(Path::new("/nowhere/x.csv"), Axes::NedFrd).unwrap_err().to_string();
    assert!(missing.contains("/nowhere/x.csv") && missing.contains("cannot read"));
}

#[test]
fn one_record_of_a_ulog_that_is_not_finite_is_left_out_and_told() {
    let whole = log(412_000_000, "vehicle_attitude");
    let clean = read_log(&whole).unwrap();
    // The quaternion of the fourth attitude of the first instance: its w follows two stamps.
    let stamp = (412_030_000_u64).to_le_bytes();
    let place = whole.windows(8).position(|bytes| bytes == (412_030_700_u64).to_le_bytes()).unwrap();
    assert_eq!(whole[place + 8..place + 16], stamp);
    for (bad, left) in [(f32::NAN, 1), (f32::INFINITY, 1)] {
        let mut bytes = whole.clone();
        bytes[place + 16..place + 20].copy_from_slice(&bad.to_le_bytes());
        let recorded = read_log(&bytes).unwrap();
        assert_eq!((recorded.rows.read, recorded.rows.left_out.not_finite), (10, left));
        assert_eq!(recorded.attitudes.len(), clean.attitudes.len() - 1);
        assert!(!timed(&recorded).iter().any(|estimate| estimate.arrival.0 == 412_030_000_000));
        assert!(recorded.remarks[0].starts_with("1 of 10 rows is left out"), "{:?}", recorded.remarks);
    }
    let mut bytes = whole;
    bytes[place + 16..place + 20].copy_from_slice(&7f32.to_le_bytes());
    assert!(
        read_log(&bytes).unwrap_err().contains("a quaternion of length 7"),
        "what is no rotation is a mistake"
    );
}

#[test]
fn chosen_columns_are_read_and_leave_a_table_that_names_its_own_alone() {
    let own = rows("t_s,qw,qx,qy,qz", |k| {
        let q = attitude(k).q;
        format!("{},{},{},{},{}", k as f64 * 0.01, q.w, q.x, q.y, q.z)
    });
    let foreign = own.replace("t_s,qw,qx,qy,qz", "when,a,b,c,d");
    let unnamed = own.replace("t_s,qw,qx,qy,qz\n", "");
    let reading = |time: &str, quaternion: [&str; 4]| Reading {
        columns: Choice {
            time: Some(time.into()),
            quaternion: Some(quaternion.map(String::from)),
            ..Choice::default()
        },
        ..Reading::default()
    };
    let by_number = reading("1", ["2", "3", "4", "5"]);
    for (text, reading) in [
        (&own, Reading::default()),
        (&own, reading("7", ["9", "9", "9", "9"])),
        (&foreign, reading("when", ["a", "b", "c", "d"])),
        (&foreign, by_number.clone()),
        (&unnamed, by_number),
    ] {
        same(&table::read("x.csv", text.as_bytes(), &reading).unwrap(), 10_000_000);
    }
    let error = table::read("x.csv", foreign.as_bytes(), &reading("when", ["a", "b", "c", "e"])).unwrap_err();
    assert!(error.to_string().contains("has no column `e`; its columns are when, a"), "{error}");
}

#[test]
fn a_file_of_another_kind_is_named_with_what_would_help() {
    let kitti: String = (0..5).map(|k| format!("1 0 0 {k} 0 1 0 0 0 0 1 0\n")).collect();
    for (bytes, says) in [
        (
            &b"\xa3\x95\x80\x80FMT"[..],
            "an ArduPilot DataFlash log (.BIN) (recognised by its first bytes), which `score` does not read|mavlogdump",
        ),
        (
            &[&1_700_000_000_000_000u64.to_be_bytes()[..], &[0xfd, 9, 0, 0, 0, 1, 1, 0, 0, 0]].concat(),
            "a MAVLink log with times (.tlog)|--types ATTITUDE",
        ),
        (b"PAR1\x15\x04", "a Parquet file|to_csv"),
        (kitti.as_bytes(), "KITTI poses (recognised by its twelve numbers a row|it has no times"),
    ] {
        let message = read_log(bytes).unwrap_err();
        assert!(says.split('|').all(|says| message.contains(says)), "{message}");
        assert!(
            message.contains("it reads tables with a header, TUM trajectories and PX4 ULogs"),
            "{message}"
        );
    }
}
