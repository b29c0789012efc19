//! The firmware in C of `c/`, built for the host and for a Cortex-M4 in QEMU, behind the emulator.
//!
//! It needs `make` and `cc`; for the second `arm-none-eabi-gcc` and `qemu-system-arm` (Debian and Ubuntu: `gcc-arm-none-eabi
//! libnewlib-arm-none-eabi qemu-system-arm`). Where one is missing the tests say so and pass, unless `RATETABLE_REQUIRE_C`
//! is set, as `.ci/run` does.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;

use glam::DQuat;
use ratetable::earth::declination;
use ratetable::geometry::Attitude;
use ratetable::scene::Plan;
use ratetable::score::AttitudeError;
use ratetable::time::SimTime;
use ratetable_firmware_host_tests::quaternion::from_euler;
use ratetable_protocols::mavlink::{self, Message};
use serde_json::Value;

use crate::emulator::play::scene;
use crate::emulator::program::RATETABLE;

/// What runs the firmware.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Machine {
    Host,
    CortexM4,
}

impl Machine {
    /// The programs that it needs, each with an argument that it answers.
    fn tools(self) -> &'static [[&'static str; 2]] {
        const ALL: [[&str; 2]; 4] = [
            ["make", "--version"],
            ["cc", "--version"],
            ["arm-none-eabi-gcc", "--version"],
            ["qemu-system-arm", "--version"],
        ];
        match self {
            Self::Host => &ALL[..2],
            Self::CortexM4 => &ALL,
        }
    }

    /// Whether its tools are there; says which is not.
    fn is_here(self) -> bool {
        let answers = |[tool, argument]: &&[&str; 2]| {
            let status =
                Command::new(tool).arg(argument).stdout(Stdio::null()).stderr(Stdio::null()).status();
            status.is_ok_and(|status| status.success())
        };
        let Some([missing, _]) = self.tools().iter().find(|tool| !answers(tool)) else { return true };
        let why = format!(
            "{self:?} needs `{missing}` (Debian and Ubuntu: apt install build-essential gcc-arm-none-eabi \
             libnewlib-arm-none-eabi qemu-system-arm)"
        );
        assert!(env::var_os("RATETABLE_REQUIRE_C").is_none(), "{why}");
        eprintln!("NOT TESTED: the firmware in C: {why}");
        false
    }

    /// The command that runs this firmware with the link `{}` and its telemetry in this file.
    fn command(self, built: &Path, firmware: &str, telemetry: &Path) -> Vec<String> {
        let telemetry = telemetry.display();
        match self {
            Self::Host => {
                let program = built.join("host").join(firmware).display().to_string();
                vec![program, "{}".into(), telemetry.to_string()]
            }
            Self::CortexM4 => {
                let image = built.join(format!("arm/{firmware}.elf")).display().to_string();
                let qemu = "qemu-system-arm -M mps2-an386 -display none -monitor none -semihosting \
                            -chardev serial,id=link,path={} -serial chardev:link";
                let mut words: Vec<String> = qemu.split_whitespace().map(str::to_owned).collect();
                words.extend(["-serial".into(), format!("file:{telemetry}"), "-kernel".into(), image]);
                words
            }
        }
    }
}

/// Builds the firmware for a machine and a declination, with every warning denied, and returns the folder.
fn build(machine: Machine, declination_deg: f64) -> PathBuf {
    static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());
    let _one = ONE_AT_A_TIME.lock();
    let declination_deg = format!("{declination_deg:.3}");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("firmware-c-{declination_deg}"));
    let mut make = Command::new("make");
    make.arg("--directory").arg(concat!(env!("CARGO_MANIFEST_DIR"), "/c"));
    make.arg(format!("OUT={}", folder.display())).arg(format!("DECLINATION_DEG={declination_deg}"));
    make.arg(if machine == Machine::Host { "host" } else { "arm" });
    let told = make.output().expect("make starts");
    assert!(told.status.success(), "{}", String::from_utf8_lossy(&told.stderr));
    folder
}

/// What a firmware told: its heartbeats, and its attitudes with their times in s.
#[derive(Default)]
struct Told {
    beats: usize,
    attitudes: Vec<(f64, Attitude)>,
}

impl Told {
    fn read(path: &Path) -> Self {
        let bytes = fs::read(path).expect("telemetry");
        let mut told = Self::default();
        mavlink::Decoder::new().feed(&bytes, |received| match received.expect("a whole message").message {
            Some(Message::Heartbeat(_)) => told.beats += 1,
            Some(Message::Attitude(repr)) => {
                let [roll, pitch, yaw] = [repr.roll, repr.pitch, repr.yaw].map(f64::from);
                let [w, x, y, z] = from_euler(roll, pitch, yaw);
                let attitude = Attitude::from_quat(DQuat::from_xyzw(x, y, z, w));
                told.attitudes.push((f64::from(repr.time_boot_ms) * 1e-3, attitude));
            }
            other => panic!("{other:?}"),
        });
        told
    }

    /// Their error against the truth, deg RMS, where the firmware's clock is so far ahead of the scene's.
    fn rms_deg(&self, plan: &Plan, ahead_s: f64) -> f64 {
        let errors = self.attitudes.iter().filter_map(|&(t_s, attitude)| {
            let t = SimTime(((t_s - ahead_s) * 1e9).round() as i64);
            (t.0 >= 0 && t <= plan.duration).then(|| {
                let error = AttitudeError::between(plan.trajectory.at(t).attitude, attitude);
                (error.inclination.powi(2) + error.heading.powi(2)).to_degrees().to_degrees()
            })
        });
        let (sum, count) = errors.fold((0.0, 0), |(sum, count), square| (sum + square, count + 1));
        (sum / f64::from(count.max(1))).sqrt()
    }
}

/// A run of the emulator with a firmware behind it: its report, and what the firmware told.
fn run(arguments: &[&str], machine: Machine, built: &Path, firmware: &str) -> (Value, Told) {
    let telemetry = built.join(format!("{machine:?}-{firmware}-{}.bin", arguments[0]));
    let _ = fs::remove_file(&telemetry);
    let mut emulator = Command::new(&*RATETABLE);
    emulator.arg("run").args(arguments).args(["--json", "--"]);
    let output = emulator.args(machine.command(built, firmware, &telemetry)).output().expect("it starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    (serde_json::from_slice(&output.stdout).expect("a report"), Told::read(&telemetry))
}

/// The bound of both scenes, deg RMS. Of `manoeuvre` the accelerometer's bias of 3 and 2 mg tilts by 0.2 at the start,
/// which turns the heading by 3.4 times as much; the circle takes a part of it out again.
const BOUND_DEG: f64 = 0.5;

/// The stream, played as fast as the firmware reads it, so that nothing depends on how busy the machine is.
fn follows_a_stream(machine: Machine, name: &str) {
    if !machine.is_here() {
        return;
    }
    let plan = scene(name, &[]);
    let built = build(machine, declination(plan.trajectory.field()).to_degrees());
    let (report, told) = run(&[name, "--to", "mpu@pty", "--speed", "max"], machine, &built, "stream");
    let live_deg = report["attitude"]["rms_deg"].as_f64().expect("answers that are scored");
    let told_deg = told.rms_deg(&plan, 0.0);
    eprintln!("{name}, {machine:?}: answers {live_deg:.3} deg RMS, telemetry {told_deg:.3} deg RMS");
    assert!(live_deg < BOUND_DEG && told_deg < BOUND_DEG, "{live_deg} {told_deg}");

    // It begins after 2 s of rest and tells every 20 ms of samples from then to the end, but for what it has not read 2 s
    // after the last byte, when the emulator ends it: on a busy machine some 20 kB in the pty and 4 kB in the firmware's
    // own buffer, which is 3.1 s of the slower scene.
    let seconds = plan.duration.0 as f64 * 1e-9;
    let expected = ((seconds - 2.0) / 0.02) as usize;
    let count = told.attitudes.len();
    assert!((expected - 160..=expected + 2).contains(&count), "{count} of {expected}");
    assert!(told.beats >= 1);
    assert!(told.attitudes.windows(2).all(|pair| (pair[1].0 - pair[0].0 - 0.02).abs() < 1e-9));

    // A clock that is off by a tenth of a second does not pass: the comparison can fail.
    assert!(told.rms_deg(&plan, 0.1) > BOUND_DEG);
}

#[test]
fn on_the_host_it_follows_a_manoeuvre() {
    follows_a_stream(Machine::Host, "manoeuvre");
}

#[test]
fn on_the_host_it_follows_level_then_turn() {
    follows_a_stream(Machine::Host, "level-then-turn");
}

#[test]
fn on_a_cortex_m4_it_follows_a_manoeuvre() {
    follows_a_stream(Machine::CortexM4, "manoeuvre");
}

#[test]
fn on_a_cortex_m4_it_follows_level_then_turn() {
    follows_a_stream(Machine::CortexM4, "level-then-turn");
}

/// The wrong declination is a heading error of as much: the bound means something.
#[test]
fn a_firmware_with_the_wrong_declination_does_not_pass() {
    if !Machine::Host.is_here() {
        return;
    }
    let plan = scene("manoeuvre", &[]);
    let built = build(Machine::Host, 0.0);
    let (_, told) = run(&["manoeuvre", "--to", "mpu@pty", "--speed", "max"], Machine::Host, &built, "stream");
    let off_deg = declination(plan.trajectory.field()).to_degrees();
    assert!((told.rms_deg(&plan, 0.0) - off_deg).abs() < 1.0, "{}", told.rms_deg(&plan, 0.0));
}

/// The chip behind the bridge, in real time. The firmware's clock is its own, so that its offset is found first, by the
/// motion. A machine that is busy for long keeps the firmware from reading: it has three tries.
fn follows_a_bus(machine: Machine) {
    if !machine.is_here() {
        return;
    }
    let plan = scene("level-then-turn", &[]);
    let built = build(machine, 0.0);
    let rms_deg = |_| {
        let (_, told) = run(&["level-then-turn", "--to", "bus@pty"], machine, &built, "bus");
        assert!(told.attitudes.len() > 500, "{} attitudes", told.attitudes.len());
        let offsets = (-400..=400).map(|step| f64::from(step) * 0.005);
        offsets.map(|ahead_s| told.rms_deg(&plan, ahead_s)).fold(f64::INFINITY, f64::min)
    };
    let tries: Vec<f64> = (0..3).map(rms_deg).take_while(|rms_deg| *rms_deg >= BOUND_DEG).collect();
    assert!(tries.len() < 3, "{tries:?} deg RMS");
}

/// A folder with a driver takes the place of this one.
#[test]
fn a_driver_of_ones_own_is_built_in_place_of_the_firmwares() {
    if !Machine::Host.is_here() {
        return;
    }
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("firmware-c-driver");
    fs::create_dir_all(&folder).expect("a folder");
    // An unused parameter: a warning in a driver is its own affair.
    let driver = "#include \"imu.h\"\n#include \"chip.h\"\nint imu_start(rt_bus *bus) { return chip_start(); }\n\
                  int imu_read(rt_bus *bus, struct imu_sample *out) { return 0; }\n";
    let files = [
        ("glue.c", driver),
        ("chip.h", "int chip_start(void);\n"),
        ("chip.c", "#include \"chip.h\"\nint chip_start(void) { return 0; }\n"),
    ];
    for (name, text) in files {
        fs::write(folder.join(name), text).expect("a file");
    }
    let mut make = Command::new("make");
    make.arg("--directory").arg(concat!(env!("CARGO_MANIFEST_DIR"), "/c")).arg("host");
    make.arg(format!("OUT={}", folder.join("built").display()));
    make.arg(format!("RATETABLE_C_DRIVER={}", folder.display()));
    let told = make.output().expect("make starts");
    assert!(told.status.success(), "{}", String::from_utf8_lossy(&told.stderr));
    let object = |name: &str| folder.join("built/host").join(name).exists();
    assert!(object("driver/glue.o") && object("driver/chip.o") && !object("imu_mpu9250.o"));
}

#[test]
#[ignore = "needs the link bus@pty, which the emulator does not have yet"]
fn on_the_host_it_follows_a_chip_on_the_bus() {
    follows_a_bus(Machine::Host);
}

#[test]
#[ignore = "needs the link bus@pty, which the emulator does not have yet"]
fn on_a_cortex_m4_it_follows_a_chip_on_the_bus() {
    follows_a_bus(Machine::CortexM4);
}
