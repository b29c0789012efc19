//! Negative controls: on the same bytes, a driver with one thing wrong must fail the check that the right one passes.
//!
//! A wrong scale of all three axes of accelerometer or magnetometer is no such thing: an attitude is told from their
//! directions alone. So for these two it is one axis whose scale is wrong.

use std::io::Cursor;
use std::sync::atomic::AtomicBool;

use ratetable::scene::Plan;
use ratetable_firmware_host_tests::board::Source;
use ratetable_firmware_host_tests::driver::{Counts, Driver, Mount, MpuDriver};
use ratetable_firmware_host_tests::{Board, Protocol, Sample};

use crate::emulator::accuracy::Errors;
use crate::emulator::play::{scene, stream};
use crate::emulator::scenes::{CASES, Case, options};

type Vector = [f64; 3];
type Change = fn(Vector) -> Vector;

/// What a wrong driver makes of the right readings.
struct Wrong {
    what: &'static str,
    gyro: Change,
    accel: Change,
    mag: Change,
}

const SAME: Change = |v| v;
const SWAPPED: Change = |[x, y, z]| [y, x, z];
const FLIPPED: Change = |[x, y, z]| [x, -y, z];
const SCALED: Change = |v| v.map(|component| 1.1 * component);
const ONE_SCALED: Change = |[x, y, z]| [x, 1.3 * y, z];
const NEGATED: Change = |v| v.map(|component| -component);

const RIGHT: Wrong = Wrong { what: "nothing wrong", gyro: SAME, accel: SAME, mag: SAME };

const WRONG: [Wrong; 10] = [
    Wrong { what: "gyro x and y swapped", gyro: SWAPPED, ..RIGHT },
    Wrong { what: "gyro y flipped", gyro: FLIPPED, ..RIGHT },
    Wrong { what: "gyro 10 % too large", gyro: SCALED, ..RIGHT },
    Wrong { what: "accelerometer x and y swapped", accel: SWAPPED, ..RIGHT },
    Wrong { what: "accelerometer y flipped", accel: FLIPPED, ..RIGHT },
    Wrong { what: UNSEEN_IF_LEVEL, accel: ONE_SCALED, ..RIGHT },
    Wrong { what: "gravity instead of specific force", accel: NEGATED, ..RIGHT },
    Wrong { what: "magnetometer x and y swapped", mag: SWAPPED, ..RIGHT },
    Wrong { what: "magnetometer y flipped", mag: FLIPPED, ..RIGHT },
    Wrong { what: "magnetometer y 30 % too large", mag: ONE_SCALED, ..RIGHT },
];

/// The accelerometer of a vehicle that stays within a few degrees of level, as in `manoeuvre`, has next to nothing on
/// its y axis whose scale could be wrong.
const UNSEEN_IF_LEVEL: &str = "accelerometer y 30 % too large";

/// A right driver whose samples are then spoilt.
struct Spoiling {
    driver: Box<dyn Driver + Send>,
    wrong: &'static Wrong,
}

impl Driver for Spoiling {
    fn feed(&mut self, bytes: &[u8], on: &mut dyn FnMut(Sample)) {
        let Wrong { gyro, accel, mag, .. } = self.wrong;
        self.driver.feed(bytes, &mut |sample| {
            on(Sample {
                t_us: sample.t_us,
                gyro: sample.gyro.map(gyro),
                accel: sample.accel.map(accel),
                mag: sample.mag.map(mag),
            });
        });
    }

    fn counts(&self) -> Counts {
        self.driver.counts()
    }
}

/// The check of a scene on recorded bytes, read by this driver.
fn check(
    plan: &Plan,
    case: &Case,
    bytes: &[u8],
    protocol: Protocol,
    driver: Box<dyn Driver + Send>,
) -> Result<(), String> {
    let port = Box::new(Source(Cursor::new(bytes.to_vec())));
    let mut board = Board::over(port, protocol, options(plan, case.ahrs)).with_driver(driver);
    board.run(&AtomicBool::new(false)).expect("a link");
    Errors::of(board.history(), plan, case.settled_s)?.check(&case.bound)
}

fn moving() -> impl Iterator<Item = &'static Case> {
    CASES.iter().filter(|case| ["table-1", "manoeuvre"].contains(&case.scene))
}

#[test]
fn a_swapped_axis_a_flipped_sign_and_a_wrong_scale_each_fail() {
    let protocol = Protocol::Mavlink;
    for case in moving() {
        let plan = scene(case.scene, &[]);
        let (_, bytes) = stream(&plan, protocol);
        let with = |wrong| {
            check(&plan, case, &bytes, protocol, Box::new(Spoiling { driver: protocol.driver(), wrong }))
        };
        assert_eq!(with(&RIGHT), Ok(()), "{} with {}", case.scene, case.ahrs);
        for wrong in WRONG.iter().filter(|wrong| case.scene == "table-1" || wrong.what != UNSEEN_IF_LEVEL) {
            let what = format!("{} with {}, {}", case.scene, case.ahrs, wrong.what);
            assert!(with(wrong).is_err(), "{what}: passed");
        }
    }
}

#[test]
fn a_chip_mounted_otherwise_than_the_driver_believes_fails() {
    let right = [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]];
    let turned_a_quarter = [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]];
    let upside_down = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mirrored = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]];
    for case in moving() {
        let plan = scene(case.scene, &[]);
        let (_, bytes) = stream(&plan, Protocol::Mpu);
        let with = |rows| {
            check(&plan, case, &bytes, Protocol::Mpu, Box::new(MpuDriver::new(Mount::from_rows(rows))))
        };
        assert_eq!(with(right), Ok(()), "{} with {}", case.scene, case.ahrs);
        for rows in [turned_a_quarter, upside_down, mirrored] {
            assert!(with(rows).is_err(), "{} with {}, rows {rows:?}: passed", case.scene, case.ahrs);
        }
    }
}

#[test]
fn without_its_declination_a_board_fails() {
    for case in moving() {
        let plan = scene(case.scene, &[]);
        let (_, bytes) = stream(&plan, Protocol::Mavlink);
        let port = Box::new(Source(Cursor::new(bytes)));
        let told =
            ratetable_firmware_host_tests::Options { declination_rad: 0.0, ..options(&plan, case.ahrs) };
        let mut board = Board::over(port, Protocol::Mavlink, told);
        board.run(&AtomicBool::new(false)).expect("a link");
        let errors = Errors::of(board.history(), &plan, case.settled_s).expect("estimates");
        assert!(errors.check(&case.bound).is_err(), "{} with {}: {errors}", case.scene, case.ahrs);
    }
}
