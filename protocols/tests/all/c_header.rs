//! `c/ratetable.h`, compiled as C99 and as C++17 with every warning denied and under sanitizers, against this crate:
//! the golden packets, any stream of bytes, and the bytes of a bridge's client.
//!
//! It needs `cc`, and `c++` for the second. What is missing is not tested, which the tests say, unless
//! `RATETABLE_REQUIRE_C` is set, as `.ci/run` does.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::LazyLock;

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use ratetable_protocols::Losses;
use ratetable_protocols::mpu::{self, Packet, Received, attitude, config, registers};

use super::common::{Vector, vectors};

const WARNINGS: [&str; 6] = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror"];

/// Each compiler with its flag for the language standard.
const DIALECTS: [(&str, &[&str]); 2] = [("cc", &["-std=c99"]), ("c++", &["-std=c++17", "-x", "c++"])];

/// The test's program, once for each dialect that has a compiler.
static DRIVERS: LazyLock<Vec<PathBuf>> = LazyLock::new(|| {
    let here = |(compiler, _): &&(&str, &[&str])| {
        let is_here =
            Command::new(compiler).arg("--version").output().is_ok_and(|told| told.status.success());
        let why = format!("there is no `{compiler}` (Debian and Ubuntu: apt install build-essential)");
        assert!(is_here || std::env::var_os("RATETABLE_REQUIRE_C").is_none(), "{why}");
        if !is_here {
            eprintln!("NOT TESTED: c/ratetable.h: {why}");
        }
        is_here
    };
    DIALECTS.iter().filter(here).map(|(compiler, dialect)| compile(compiler, dialect)).collect()
});

fn compile(compiler: &str, dialect: &[&str]) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("ratetable-h-{compiler}"));
    let mut command = Command::new(compiler);
    command.args(dialect).args(WARNINGS).args(["-g", "-O1", "-fsanitize=address,undefined"]);
    command.args(["-fno-sanitize-recover=all", "-I"]).arg(root.join("c"));
    command.arg(root.join("tests/c/driver.c")).arg("-o").arg(&program);
    let told = command.output().expect("the compiler starts");
    assert!(told.status.success(), "{compiler}: {}", String::from_utf8_lossy(&told.stderr));
    program
}

/// What the program says of this input.
fn run(program: &Path, arguments: &[&str], input: &[u8]) -> String {
    let mut command = Command::new(program);
    command.args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the program starts");
    let mut stdin = child.stdin.take().expect("an input");
    let output = std::thread::scope(|scope| {
        // It reads all before it says anything; who has ended early is seen by its status.
        scope.spawn(move || stdin.write_all(input));
        child.wait_with_output().expect("it ends")
    });
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

/// Streams, one after another, as the program takes them.
fn cases<'a>(streams: impl IntoIterator<Item = &'a [u8]>) -> Vec<u8> {
    let framed = |stream: &[u8]| [&(stream.len() as u32).to_le_bytes(), stream].concat();
    streams.into_iter().flat_map(framed).collect()
}

/// The integers of a packet in the order in which the program tells them.
fn told(received: &Received) -> String {
    let Received { seq, t_us, packet } = received;
    let (mut accel, mut temperature, mut gyro) = ([0; 3], 0, [0; 3]);
    let (mut mag, mut config) = (mpu::mag::Repr { st1: 0, field: [0; 3], st2: 0 }, [0; config::LEN]);
    let mut answer = attitude::Repr { clock_us: 0, q: [0.0; 4] };
    match packet {
        Packet::Imu(imu) => (accel, temperature, gyro) = (imu.accel, imu.temperature, imu.gyro),
        Packet::Mag(repr) => mag = *repr,
        Packet::Gyro(repr) => gyro = repr.gyro,
        Packet::Accel(repr) => accel = repr.accel,
        Packet::Config(_) => packet.emit(&mut config).expect("its length"),
        Packet::Attitude(repr) => answer = *repr,
    }
    let integers = |list: &[i16]| list.iter().map(i16::to_string).collect::<Vec<_>>().join(" ");
    let config = config.map(|byte| byte.to_string()).join(" ");
    let q = answer.q.map(|x| format!("{:08x}", x.to_bits())).join(" ");
    format!(
        "{} {seq} {t_us} {} {temperature} {} {} {} {} {config} {} {q}",
        packet.kind(),
        integers(&accel),
        integers(&gyro),
        mag.st1,
        integers(&mag.field),
        mag.st2,
        answer.clock_us,
    )
}

/// The units that the registers' module gives to a packet, in the chip's axes.
fn units(packet: &Packet, config: Option<&config::Repr>) -> Vec<(&'static str, Vec<f64>)> {
    let Some(config) = config.filter(|config| config.who_am_i != 0) else { return Vec::new() };
    let rate = |counts: [i16; 3]| {
        let lsb = registers::gyro_lsb_per_dps(config.gyro_config);
        ("rate", counts.map(|count| (f64::from(count) / lsb).to_radians()).to_vec())
    };
    let force = |counts: [i16; 3]| {
        let lsb = registers::accel_lsb_per_g(config.accel_config);
        ("force", counts.map(|count| f64::from(count) / lsb * 9.80665).to_vec())
    };
    match packet {
        Packet::Imu(imu) => {
            let mut all = vec![rate(imu.gyro), force(imu.accel)];
            let chip = registers::Chip::from_who_am_i(config.who_am_i);
            all.extend(chip.map(|chip| ("degc", vec![chip.temperature_c(imu.temperature)])));
            all
        }
        Packet::Gyro(repr) => vec![rate(repr.gyro)],
        Packet::Accel(repr) => vec![force(repr.accel)],
        Packet::Mag(mag) => {
            let fresh = mag.st1 & registers::ST1_DATA_READY != 0 && mag.st2 & registers::ST2_OVERFLOW == 0;
            if config.mag_who != registers::WHO_AK8963 || !fresh {
                return Vec::new();
            }
            let sixteen = mag.st2 & registers::ST2_16_BIT != 0;
            let own: [f64; 3] = std::array::from_fn(|i| {
                f64::from(mag.field[i]) * registers::mag_ut_per_lsb(config.asa[i], sixteen)
            });
            vec![("field", registers::swap_mag_axes(own).to_vec())]
        }
        Packet::Config(_) | Packet::Attitude(_) => Vec::new(),
    }
}

/// A line of the program is this packet, with these units to single precision.
fn check_line(line: &str, received: &Received, config: Option<&config::Repr>) {
    let integers = told(received);
    let rest = line.strip_prefix(&integers).unwrap_or_else(|| panic!("{line}\nis not\n{integers}"));
    let mut words = rest.split_whitespace();
    for (name, values) in units(&received.packet, config) {
        assert_eq!(words.next(), Some(name), "{line}");
        for value in values {
            let got: f64 = words.next().and_then(|word| word.parse().ok()).expect("a number");
            assert!((got - value).abs() <= 1e-6 * value.abs().max(1.0), "{line}: {got} for {value}");
        }
    }
    assert_eq!(words.next(), None, "{line}");
}

/// What the header makes of each stream is what this crate makes of it.
fn check_streams(program: &Path, streams: &[Vec<u8>]) {
    let said = run(program, &["decode"], &cases(streams.iter().map(Vec::as_slice)));
    let mut lines = said.lines();
    for stream in streams {
        let (mut losses, mut packets, mut damaged, mut config) = (Losses::new(), 0, 0, None);
        mpu::Decoder::new().feed(stream, |received| match received {
            Ok(received) => {
                packets += 1;
                losses.observe(received.seq);
                if let Packet::Config(repr) = received.packet {
                    config = Some(repr);
                }
                check_line(lines.next().expect("a line"), &received, config.as_ref());
            }
            Err(_) => damaged += 1,
        });
        let [lost, twice, late] = [losses.lost(), losses.duplicates(), losses.out_of_order()];
        let counts = format!("= {packets} {damaged} {lost} {twice} {late}");
        assert_eq!(lines.next(), Some(counts.as_str()), "{stream:02x?}");
    }
    assert_eq!(lines.next(), None);
}

fn golden() -> Vec<Vec<u8>> {
    vectors("mpu").into_iter().map(|Vector { bytes, .. }| bytes).collect()
}

#[test]
fn golden_packets_are_the_same_packets_and_units_in_c() {
    let golden = golden();
    // Each alone, before it has a scale; and behind each config, which gives it one.
    let configs = vectors("mpu").into_iter().filter(|vector| vector.json["type"] == "config");
    let scaled = configs.flat_map(|config| {
        golden.iter().map(move |packet| [&config.bytes[..], packet].concat()).collect::<Vec<_>>()
    });
    let streams: Vec<Vec<u8>> = golden.iter().cloned().chain(scaled).chain([golden.concat()]).collect();
    assert!(streams.len() > 2 * golden.len(), "there are configs");
    for program in DRIVERS.iter() {
        check_streams(program, &streams);
    }
}

#[test]
fn every_bit_flipped_and_every_cut_of_every_golden_packet_is_judged_alike() {
    let golden = golden();
    let mut streams = Vec::new();
    for packet in &golden {
        for bit in 0..packet.len() * 8 {
            let mut hurt = packet.clone();
            hurt[bit / 8] ^= 1 << (bit % 8);
            streams.push([&hurt[..], &golden[2]].concat());
        }
        streams.extend((0..packet.len()).map(|cut| [&packet[..cut], &golden[2]].concat()));
        streams.extend((0..packet.len()).map(|cut| [&packet[cut..], &golden[2]].concat()));
    }
    for program in DRIVERS.iter() {
        check_streams(program, &streams);
    }
}

#[test]
fn any_bytes_are_judged_alike() {
    let golden = golden();
    let piece = prop_oneof![
        vec(any::<u8>(), 0..100),
        vec(prop_oneof![Just(0u8), Just(1), any::<u8>()], 0..40),
        (0..golden.len()).prop_map({
            let golden = golden.clone();
            move |i| golden[i].clone()
        }),
        // Packets with any number, so that losses, repeats and disorder are counted.
        (any::<u8>(), any::<[i16; 3]>()).prop_map(|(seq, gyro)| {
            let mut bytes = [0; mpu::MAX_LEN];
            let packet = Packet::Gyro(mpu::gyro::Repr { gyro });
            let len = mpu::encode(seq % 24, 0, &packet, &mut bytes).expect("room");
            bytes[..len].to_vec()
        }),
    ];
    let stream = vec(piece, 0..30).prop_map(|pieces| pieces.concat());
    // Few runs of the program, each over many streams.
    let mut runner = TestRunner::new(Config { cases: 8, max_shrink_iters: 64, ..Config::default() });
    for program in DRIVERS.iter() {
        let judged = runner.run(&vec(stream.clone(), 100), |streams| {
            check_streams(program, &streams);
            Ok(())
        });
        judged.unwrap_or_else(|error| panic!("{error}"));
    }
}

#[test]
fn an_answer_from_c_is_the_bytes_of_this_crate() {
    let mut runner = TestRunner::new(Config { cases: 4, ..Config::default() });
    let zeros = prop_oneof![Just(0u32), any::<u32>(), Just(0x3f80_0000)];
    let answer =
        (any::<u8>(), zeros.clone(), zeros.clone(), [zeros.clone(), zeros.clone(), zeros.clone(), zeros]);
    for program in DRIVERS.iter() {
        let encoded = runner.run(&vec(answer.clone(), 200), |answers| {
            let words = |q: &[u32; 4]| q.iter().flat_map(|bits| bits.to_le_bytes()).collect::<Vec<_>>();
            let inputs: Vec<Vec<u8>> = answers
                .iter()
                .map(|(seq, t, clock, q)| {
                    [&[*seq][..], &t.to_le_bytes(), &clock.to_le_bytes(), &words(q)].concat()
                })
                .collect();
            let said = run(program, &["encode"], &cases(inputs.iter().map(Vec::as_slice)));
            for (line, (seq, t_us, clock_us, q)) in said.lines().zip(&answers) {
                let q = q.map(f32::from_bits);
                let packet = Packet::Attitude(attitude::Repr { clock_us: *clock_us, q });
                let mut bytes = [0; mpu::MAX_LEN];
                let len = mpu::encode(*seq, *t_us, &packet, &mut bytes).expect("room");
                prop_assert_eq!(line, hex(&bytes[..len]));
            }
            prop_assert_eq!(said.lines().count(), answers.len());
            Ok(())
        });
        encoded.unwrap_or_else(|error| panic!("{error}"));
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn unhex(hex: &str) -> Vec<u8> {
    let digits: Vec<u8> = hex.bytes().filter(|digit| *digit != b' ').collect();
    let byte = |pair: &[u8]| u8::from_str_radix(std::str::from_utf8(pair).expect("ASCII"), 16).expect("hex");
    digits.chunks(2).map(byte).collect()
}

/// How Zephyr's driver of this bridge (`i2c_sc18im704`) and its driver of an MPU-9250 speak, captured on `native_sim`:
/// an operation of ours, what goes out, what comes in. The status is asked for behind each.
const ZEPHYR: [(&str, &str, &str); 6] = [
    ("x 68 75 1", "53 d0 01 75 53 d1 01 50", "71"),
    ("x 68 6b 1", "53 d0 01 6b 53 d1 01 50", "40"),
    ("w 68 6b00", "53 d0 02 6b 00 50", ""),
    ("w 68 1a06", "53 d0 02 1a 06 50", ""),
    ("x 68 3b 14", "53 d0 01 3b 53 d1 0e 50", "20 00 c0 00 40 00 0d 0c 05 1e fa e2 7f ff"),
    // A probe.
    ("w 68 -", "53 d0 00 50", ""),
];

#[test]
fn the_bridges_client_speaks_as_zephyrs_does() {
    for program in DRIVERS.iter() {
        for (operation, sent, received) in ZEPHYR {
            let words: Vec<&str> = ["bus"].into_iter().chain(operation.split(' ')).collect();
            let said = run(program, &words, &[unhex(received), vec![0xf0]].concat());
            let expected = format!("{}520a50 0 {}\n", sent.replace(' ', ""), received.replace(' ', ""));
            assert_eq!(said, expected, "{operation}");

            let unchecked: Vec<&str> = ["bus", "unchecked"].into_iter().chain(operation.split(' ')).collect();
            let said = run(program, &unchecked, &unhex(received));
            assert_eq!(said, expected.replacen("520a50 ", " ", 1), "{operation}");
        }
        assert_eq!(run(program, &["bus", "baud", "115200"], &[]), "570030010050 0 \n");
        assert_eq!(
            run(program, &["bus", "baud", "9600"], &[]),
            "5700f0010250 0 \n",
            "the bridge's own after reset"
        );
        assert_eq!(run(program, &["bus", "baud", "0"], &[]), " -1 \n");
        assert_eq!(run(program, &["bus", "baud", "921600"], &[]), " -1 \n", "more than its clock gives");
    }
}

#[test]
fn a_write_of_more_than_255_bytes_is_messages_of_one_transfer() {
    let data: Vec<u8> = (0..600u32).map(|i| (i * 7) as u8).collect();
    let messages: Vec<String> =
        data.chunks(255).map(|part| format!("53d2{:02x}{}", part.len(), hex(part))).collect();
    for program in DRIVERS.iter() {
        let said = run(program, &["bus", "w", "69", &hex(&data)], &[0xf0]);
        assert_eq!(said, format!("{}50520a50 0 \n", messages.concat()));
        let exact = hex(&data[..255]);
        let said = run(program, &["bus", "w", "69", &exact], &[0xf0]);
        assert_eq!(said, format!("53d2ff{exact}50520a50 0 \n"), "no empty message behind a full one");
    }
}

#[test]
fn the_bridges_status_and_silence_are_told_apart() {
    for program in DRIVERS.iter() {
        let result = |operation: &str, answer: &[u8]| {
            let words: Vec<&str> = ["bus"].into_iter().chain(operation.split(' ')).collect();
            let said = run(program, &words, answer);
            let results = said.lines().map(|line| line.split_whitespace().nth(1).map(str::to_owned));
            results.map(|result| result.expect("a result")).collect::<Vec<_>>()
        };
        for (status, code) in [(0xf0, "0"), (0xf1, "-4"), (0xf2, "-5"), (0xf8, "-6"), (0x00, "-6")] {
            assert_eq!(result("w 68 6b00", &[status]), [code]);
            assert_eq!(result("x 68 75 1", &[0xff, status]), [code]);
        }
        assert_eq!(result("w 68 6b00", &[]), ["-3"]);
        assert_eq!(result("r 68 4", &[1, 2]), ["-3"]);
        // What is read has to fit the bridge's length, and be something.
        let said = run(program, &["bus", "r", "68", "0", "x", "68", "75", "256"], &[]);
        assert_eq!(said, " -1 \n -1 \n", "nothing is sent");
        // What is no status is the rest of another answer.
        let said = run(program, &["bus", "w", "68", "6b00", "r", "68", "1"], &[0x3c, 7, 8]);
        assert_eq!(said, "53d0026b0050520a50 -6 \n(drained)(drained)(drained)53d10150520a50 -3 \n");
        // Behind a silence, what comes late is thrown away before the next transfer.
        let said = run(program, &["bus", "r", "68", "2", "w", "68", "6b00"], &[]);
        assert!(said.lines().nth(1).is_some_and(|line| line.starts_with("(drained)53d0026b0050")), "{said}");
    }
}

#[test]
fn any_answers_of_a_bridge_are_survived() {
    let words = [
        "bus", "w", "68", "6b00", "x", "68", "3b", "14", "r", "68", "255", "x", "68", "75", "1", "w", "0c",
        "-",
    ];
    let mut runner = TestRunner::new(Config { cases: 40, ..Config::default() });
    for program in DRIVERS.iter() {
        let survived = runner.run(&vec(any::<u8>(), 0..600), |answers| {
            prop_assert_eq!(run(program, &words, &answers).lines().count(), 5);
            Ok(())
        });
        survived.unwrap_or_else(|error| panic!("{error}"));
    }
}
