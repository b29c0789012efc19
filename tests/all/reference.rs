//! The truth against attitudes computed in 50-digit arithmetic by a program that shares no code with this one
//! (`tests/reference/make.py`), in both of the axes a scene may be written in.

use glam::{DQuat, DVec3};
use ratetable::geometry::{Axes, Euler};
use ratetable::motion::Truth;
use ratetable::scene::Plan;
use ratetable::time::SimTime;

/// Bounds of every case: 10⁻⁹ degrees, and 10⁻⁹ of a vector's length.
const DEGREES: f64 = 1e-9;
const RELATIVE: f64 = 1e-9;

struct Case {
    name: &'static str,
    scene: &'static str,
    truth: &'static str,
    /// What the scene's text becomes in `enu-flu`: roll, −pitch, 90° − yaw; body y and z and nav z turned over,
    /// nav x and y changed places. A cone that starts on the other side has a negative half-angle.
    in_enu_flu: &'static [(&'static str, &'static str)],
}

macro_rules! case {
    ($name:literal, $in_enu_flu:expr) => {
        Case {
            name: $name,
            scene: include_str!(concat!("../reference/", $name, ".toml")),
            truth: include_str!(concat!("../reference/", $name, ".csv")),
            in_enu_flu: $in_enu_flu,
        }
    };
}

const CASES: [Case; 4] = [
    case!(
        "segments",
        &[
            ("ned-frd", "enu-flu"),
            ("[12, -35, 170] deg", "[12, 35, -80] deg"),
            ("[15.0, 3.2, 50.3] uT", "[3.2, 15.0, -50.3] uT"),
            ("[0, -45, 0] deg/s", "[0, 45, 0] deg/s"),
            ("[17.5, -8.25, 90] deg/s", "[17.5, 8.25, -90] deg/s"),
        ]
    ),
    case!(
        "cone",
        &[
            ("ned-frd", "enu-flu"),
            ("[5, 10, 30] deg", "[5, -10, 60] deg"),
            ("[20, 0, 45] uT", "[0, 20, -45] uT"),
            ("\"5 deg\"", "\"-5 deg\""),
        ]
    ),
    case!(
        "spin",
        &[
            ("ned-frd", "enu-flu"),
            ("[0, 0, 0] deg", "[0, 0, 90] deg"),
            ("[20, 0, 45] uT", "[0, 20, -45] uT"),
            ("[-1150, -1050, 1250] deg/s", "[-1150, 1050, -1250] deg/s"),
        ]
    ),
    case!(
        "gimbal",
        &[
            ("ned-frd", "enu-flu"),
            ("[0, 0, 60] deg", "[0, 0, 30] deg"),
            ("[20, 0, 45] uT", "[0, 20, -45] uT"),
            ("[0, 45, 0] deg/s", "[0, -45, 0] deg/s"),
        ]
    ),
];

/// One row of the reference.
struct Row {
    t: SimTime,
    q: DQuat,
    euler: [f64; 3],
    rate: DVec3,
    force: DVec3,
    field: DVec3,
}

fn rows(text: &str) -> Vec<Row> {
    text.lines().skip(1).map(row).collect()
}

fn row(line: &str) -> Row {
    let (t, numbers) = line.split_once(',').unwrap();
    let x: Vec<f64> = numbers.split(',').map(|number| number.parse().unwrap()).collect();
    assert_eq!(x.len(), 16, "{line}");
    let vector = |i| DVec3::new(x[i], x[i + 1], x[i + 2]);
    Row {
        t: SimTime(t.parse().unwrap()),
        q: DQuat::from_xyzw(x[1], x[2], x[3], x[0]),
        euler: [x[4], x[5], x[6]],
        rate: vector(7),
        force: vector(10),
        field: vector(13),
    }
}

/// What the program says at a row's time, against the row; the first that differs too much.
fn check(truth: &Truth, row: &Row) -> Result<(), String> {
    let d = row.q.conjugate() * truth.attitude.q;
    let angle = 2.0 * f64::atan2(DVec3::new(d.x, d.y, d.z).length(), d.w.abs());
    within("attitude", row, angle.to_degrees(), DEGREES)?;
    let Euler { roll, pitch, yaw } = Euler::from_quat(truth.attitude.q);
    for (name, ours, theirs) in
        [("roll", roll, row.euler[0]), ("pitch", pitch, row.euler[1]), ("yaw", yaw, row.euler[2])]
    {
        let turns = (ours - theirs) / std::f64::consts::TAU;
        within(name, row, 360.0 * (turns - turns.round()).abs(), DEGREES)?;
    }
    for (name, ours, theirs) in
        [("rate", truth.rate, row.rate), ("force", truth.force, row.force), ("field", truth.field, row.field)]
    {
        within(name, row, (ours.v - theirs).length() / theirs.length().max(1e-300), RELATIVE)?;
    }
    Ok(())
}

fn within(what: &str, row: &Row, error: f64, bound: f64) -> Result<(), String> {
    // Written so that a NaN fails.
    if error <= bound {
        Ok(())
    } else {
        Err(format!("{what} at {}: off by {error:e}, bound {bound:e}", row.t))
    }
}

fn check_all(scene: &str, truth: &str) -> Result<(), String> {
    let plan = Plan::parse(scene, "reference", "reference", &[]).map_err(|error| error.to_string())?;
    let rows = rows(truth);
    assert!(rows.len() > 5);
    rows.iter().try_for_each(|row| check(&plan.trajectory.at(row.t), row))
}

fn rewritten(case: &Case) -> String {
    case.in_enu_flu.iter().fold(case.scene.to_string(), |text, (from, to)| {
        assert!(text.contains(from), "{}: {from}", case.name);
        text.replace(from, to)
    })
}

#[test]
fn the_truth_is_that_of_50_digit_arithmetic() {
    for case in &CASES {
        check_all(case.scene, case.truth).unwrap_or_else(|why| panic!("{}: {why}", case.name));
    }
}

#[test]
fn the_same_scene_written_in_enu_flu_is_the_same_truth() {
    for case in &CASES {
        let scene = rewritten(case);
        check_all(&scene, case.truth).unwrap_or_else(|why| panic!("{} in enu-flu: {why}", case.name));
    }
}

#[test]
fn what_a_dataset_writes_in_enu_flu_is_the_truth_turned_over() {
    let axes = Axes::EnuFlu;
    for case in &CASES {
        let plan = Plan::parse(&rewritten(case), case.name, case.name, &[]).unwrap();
        for row in rows(case.truth) {
            let truth = plan.trajectory.at(row.t);
            let (rate, force, field) =
                (axes.body_out(truth.rate), axes.body_out(truth.force), axes.body_out(truth.field));
            for (ours, theirs) in [(rate, row.rate), (force, row.force), (field, row.field)] {
                let turned = DVec3::new(theirs.x, -theirs.y, -theirs.z);
                assert!((ours - turned).length() <= RELATIVE * turned.length(), "{} at {}", case.name, row.t);
            }
            // Forward, left and up of the body, each as East, North, Up: from the reference by hand.
            let q = axes.attitude_out(truth.attitude);
            for (flu, frd) in [(DVec3::X, DVec3::X), (DVec3::Y, -DVec3::Y), (DVec3::Z, -DVec3::Z)] {
                let ned = row.q * frd;
                let enu = DVec3::new(ned.y, ned.x, -ned.z);
                assert!((q * flu - enu).length() < DEGREES.to_radians(), "{} at {}", case.name, row.t);
            }
        }
    }
}

#[test]
fn a_swapped_axis_fails_the_check() {
    for case in &CASES {
        let plan = Plan::parse(case.scene, case.name, case.name, &[]).unwrap();
        let swapped = |row: &Row| {
            let mut truth = plan.trajectory.at(row.t);
            let q = truth.attitude.q;
            truth.attitude.q = DQuat::from_xyzw(q.y, q.x, q.z, q.w);
            check(&truth, row)
        };
        assert!(rows(case.truth).iter().any(|row| swapped(row).is_err()), "{}", case.name);
    }
    for (from, to) in [("[30, 0, 0]", "[0, 30, 0]"), ("[15.0, 3.2, 50.3]", "[3.2, 15.0, 50.3]")] {
        let scene = CASES[0].scene.replace(from, to);
        assert_ne!(scene, CASES[0].scene);
        assert!(check_all(&scene, CASES[0].truth).is_err(), "{to}");
    }
    let unturned = CASES[0].scene.replace("ned-frd", "enu-flu");
    assert!(check_all(&unturned, CASES[0].truth).is_err(), "the axes alone are not a conversion");
}
