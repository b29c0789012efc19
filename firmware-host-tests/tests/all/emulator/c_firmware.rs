//! The firmware in C of `c/`, built for the host and for a Cortex-M4 in QEMU, behind the emulator.
//!
//! It needs `make` and `cc`; for the second `arm-none-eabi-gcc` and `qemu-system-arm` (Debian and Ubuntu: `gcc-arm-none-eabi
//! libnewlib-arm-none-eabi qemu-system-arm`). Where one is missing the tests say so and pass, unless `RATETABLE_REQUIRE_C`
//! is set, as `.ci/run` does.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use glam::DQuat;
use ratetable::earth::declination;
use ratetable::geometry::Attitude;
use ratetable::scene::{Output, Plan};
use ratetable::score::AttitudeError;
use ratetable::session::{self, Job, Outcome, Speed};
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

    /// The command that runs this firmware with the link `{}`, a pty or, where QEMU may, a TCP port, and its telemetry on
    /// this path, which QEMU takes for a `kind`: a `file`, or a `serial` port.
    fn command(self, built: &Path, firmware: &str, link: &str, kind: &str, telemetry: &Path) -> Vec<String> {
        let telemetry = telemetry.display();
        match self {
            Self::Host => {
                let program = built.join("host").join(firmware).display().to_string();
                vec![program, "{}".into(), telemetry.to_string()]
            }
            Self::CortexM4 => {
                let image = built.join(format!("arm/{firmware}.elf")).display().to_string();
                let qemu = "qemu-system-arm -M mps2-an386 -display none -monitor none -semihosting -serial";
                let mut words: Vec<String> = qemu.split_whitespace().map(str::to_owned).collect();
                if link == "pty" {
                    words.extend(["chardev:link", "-chardev", "serial,id=link,path={}"].map(String::from));
                } else {
                    words.push("tcp:{},nodelay=on".into());
                }
                words.extend(["-serial", "chardev:told", "-chardev"].map(String::from));
                words.extend([format!("{kind},id=told,path={telemetry}"), "-kernel".into(), image]);
                words
            }
        }
    }

    /// Links and speeds to try, scene seconds a second, until a busy machine misses nothing. A pty's bytes wait for a worker
    /// of the kernel, some 10 ms each way where others keep the processors busy; TCP has none.
    fn tries(self) -> &'static [(&'static str, f64)] {
        const TCP: &str = "tcpin:127.0.0.1:0";
        match self {
            Self::Host => &[("pty", 1.0), ("pty", 0.5), ("pty", 0.25), ("pty", 0.125)],
            Self::CortexM4 => &[("pty", 1.0), (TCP, 1.0), (TCP, 0.5), (TCP, 0.25), (TCP, 0.125)],
        }
    }
}

/// What the accelerometer of a scene reads too much, mg in body axes: its `bias`.
fn offset_mg(scene: &str) -> [f64; 3] {
    if scene == "manoeuvre" { [2.0, -3.0, 4.0] } else { [0.5, -0.5, 1.0] }
}

/// Builds the firmware for the place of a scene and for its accelerometer, and returns the folder.
fn build(machine: Machine, name: &str, plan: &Plan) -> PathBuf {
    build_with(machine, declination(plan.trajectory.field()).to_degrees(), offset_mg(name))
}

/// The same for a declination and an offset, with every warning denied.
fn build_with(machine: Machine, declination_deg: f64, offset_mg: [f64; 3]) -> PathBuf {
    static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());
    let _one = ONE_AT_A_TIME.lock();
    let declination_deg = format!("{declination_deg:.3}");
    let offset_mg = offset_mg.map(|offset| format!("{offset:.3}")).join(",");
    // In a link a comma has a meaning.
    let name = format!("firmware-c-{declination_deg}-{}", offset_mg.replace(',', "_"));
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let mut make = Command::new("make");
    make.arg("--directory").arg(concat!(env!("CARGO_MANIFEST_DIR"), "/c"));
    make.arg(format!("OUT={}", folder.display())).arg(format!("DECLINATION_DEG={declination_deg}"));
    make.arg(format!("ACCEL_OFFSET_MG={offset_mg}"));
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
    let output = emulator
        .args(machine.command(built, firmware, "pty", "file", &telemetry))
        .output()
        .expect("it starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    (serde_json::from_slice(&output.stdout).expect("a report"), Told::read(&telemetry))
}

/// The bound of both scenes, deg RMS. The firmware knows what its accelerometer reads too much: the 3.6 mg of `manoeuvre`
/// would tilt by 0.2, and turn the heading by 3.4 times as much.
const BOUND_DEG: f64 = 0.5;

/// The stream, played as fast as the firmware reads it, so that nothing depends on how busy the machine is.
fn follows_a_stream(machine: Machine, name: &str) {
    if !machine.is_here() {
        return;
    }
    let plan = scene(name, &[]);
    let built = build(machine, name, &plan);
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
    let built = build_with(Machine::Host, 0.0, offset_mg("manoeuvre"));
    let (_, told) = run(&["manoeuvre", "--to", "mpu@pty", "--speed", "max"], Machine::Host, &built, "stream");
    let off_deg = declination(plan.trajectory.field()).to_degrees();
    assert!((told.rms_deg(&plan, 0.0) - off_deg).abs() < 1.0, "{}", told.rms_deg(&plan, 0.0));
}

/// Plays a scene with an attitude heard on the firmware's second UART, on a link and so many scene seconds a second.
fn live(
    plan: &Arc<Plan>,
    machine: Machine,
    built: &Path,
    firmware: &str,
    (at, speed): (&str, f64),
) -> Outcome {
    let telemetry = built.join(format!("{machine:?}-{firmware}-told"));
    let protocol = if firmware == "bus" { "bus" } else { "mpu" };
    let mut link = Output::to(format!("{protocol}@{at}").parse().expect("a link"));
    link.wire.chip = Some("MPU-9250");
    let heard = Output::mute(format!("mavlink@pty:{}", telemetry.display()).parse().expect("a link"));
    let job = Job {
        speed: Speed::Times(speed),
        wait: Duration::from_secs(30),
        command: machine.command(built, firmware, at, "serial", &telemetry),
        keep_stdout: true,
        ..Job::new(plan.clone(), vec![link, heard])
    };
    session::run(job, &mut |_| {}).expect("a run")
}

/// In real time, scored while it plays: the attitude is that of MAVLink on the second UART. A firmware on a busy machine
/// misses samples, in its own buffers too, where nobody counts them, and then its attitude says nothing: the scene is
/// played slower. That changes nothing for this firmware, whose time is that of the samples. A fault of the firmware or
/// of the emulator is there at every speed.
fn is_scored_live(machine: Machine, name: &str, firmware: &str) {
    /// Two of these at once would take each other's time.
    static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());
    if !machine.is_here() {
        return;
    }
    // At 250 Hz the stream needs 8 kB/s: QEMU takes 20 of them from a UART.
    let plan = scene(name, &["gyro.rate=250 Hz", "accel.rate=250 Hz"]);
    let built = build(machine, name, &plan);
    // After two seconds of rest it tells every 20 ms.
    let expected = 0.9 * (plan.duration.seconds() / 0.02 - 100.0);
    let _one = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    let mut tries = Vec::new();
    for &(at, speed) in machine.tries() {
        let outcome = live(&plan, machine, &built, firmware, (at, speed));
        let figures = outcome.attitude.as_ref();
        let rms_deg = figures.map_or(f64::NAN, |figures| figures.errors.rms_deg);
        let missed: u64 = outcome.sensors.iter().take(2).map(|sensor| sensor.dropped).sum();
        let answers = figures.map_or(0, |figures| figures.samples);
        let tried = format!(
            "{at} at speed {speed}: {rms_deg:.3} deg RMS, {missed} samples missed, {answers} answers, {} played",
            outcome.played
        );
        eprintln!("{name}, {firmware}, {machine:?}, {tried}");
        let is_whole = outcome.played >= plan.duration && missed == 0 && answers as f64 > expected;
        if is_whole && rms_deg < BOUND_DEG {
            return;
        }
        tries.push(tried);
    }
    panic!("within {BOUND_DEG} deg RMS with {expected} answers at no speed: {tries:#?}");
}

#[test]
fn on_the_host_a_chip_on_the_bus_follows_a_manoeuvre() {
    is_scored_live(Machine::Host, "manoeuvre", "bus");
}

#[test]
fn on_the_host_a_chip_on_the_bus_follows_level_then_turn() {
    is_scored_live(Machine::Host, "level-then-turn", "bus");
}

#[test]
fn on_a_cortex_m4_a_chip_on_the_bus_follows_a_manoeuvre() {
    is_scored_live(Machine::CortexM4, "manoeuvre", "bus");
}

#[test]
fn on_a_cortex_m4_a_chip_on_the_bus_follows_level_then_turn() {
    is_scored_live(Machine::CortexM4, "level-then-turn", "bus");
}

#[test]
fn on_the_host_a_stream_is_scored_live() {
    is_scored_live(Machine::Host, "manoeuvre", "stream");
}

#[test]
fn on_a_cortex_m4_a_stream_is_scored_live() {
    is_scored_live(Machine::CortexM4, "level-then-turn", "stream");
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
