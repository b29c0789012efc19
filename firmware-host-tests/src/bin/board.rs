//! A firmware's receiving side as a program: reads sensor packets from a port, estimates the
//! attitude, answers with it, and says at the end what came.
//!
//! `board PATH [--protocol mpu|mavlink] [--ahrs vqf|fusion] [--declination-deg D]
//! [--answer-ms N] [--baud N]`: exits with 0 when the link closes or falls quiet, with 1 if no
//! data came before it closed, with 2 if it could not run.

use std::process::ExitCode;
use std::sync::atomic::AtomicBool;

use ratetable_firmware_host_tests::driver::Protocol;
use ratetable_firmware_host_tests::quaternion::to_euler;
use ratetable_firmware_host_tests::{Board, Options, Report};

const USAGE: &str = "usage: board PATH [--protocol mpu|mavlink] [--ahrs vqf|fusion] \
                     [--declination-deg D] [--answer-ms N (0: none)] [--baud N]";

/// What was asked for.
struct Arguments {
    path: String,
    protocol: Protocol,
    options: Options,
}

fn main() -> ExitCode {
    let arguments = match parse(std::env::args().skip(1)) {
        Ok(arguments) => arguments,
        Err(why) => {
            eprintln!("board: {why}\n{USAGE}");
            return ExitCode::from(2);
        }
    };
    match run(&arguments) {
        Ok(report) => {
            eprintln!("{}", summary(&report));
            ExitCode::from(u8::from(report.counts.packets == 0))
        }
        Err(error) => {
            eprintln!("board: {}: {error}", arguments.path);
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &Arguments) -> std::io::Result<Report> {
    let mut board = Board::open(&arguments.path, arguments.protocol, arguments.options)?;
    board.run(&AtomicBool::new(false))
}

fn parse(mut words: impl Iterator<Item = String>) -> Result<Arguments, String> {
    let mut path = None;
    let mut protocol = Protocol::default();
    let mut options = Options { answer_every_us: Some(20_000), ..Options::default() };
    while let Some(word) = words.next() {
        if !word.starts_with('-') && path.is_none() {
            path = Some(word);
            continue;
        }
        let value = words.next().ok_or_else(|| format!("{word} needs a value"))?;
        match word.as_str() {
            "--protocol" => protocol = value.parse()?,
            "--ahrs" => options.ahrs = value.parse()?,
            "--declination-deg" => {
                options.declination_rad = number::<f64>(&word, &value)?.to_radians();
            }
            "--answer-ms" => {
                let every_us = number::<u64>(&word, &value)?.saturating_mul(1000);
                options.answer_every_us = (every_us > 0).then_some(every_us);
            }
            "--baud" => options.baud = Some(number(&word, &value)?),
            _ => return Err(format!("unknown option {word}")),
        }
    }
    let path = path.ok_or("no path")?;
    Ok(Arguments { path, protocol, options })
}

fn number<T: std::str::FromStr>(word: &str, value: &str) -> Result<T, String> {
    value.parse().map_err(|_| format!("{word}: `{value}` is not a number that fits"))
}

/// The counts and the last attitude, in words.
fn summary(report: &Report) -> String {
    let c = &report.counts;
    let mut text = format!(
        "board: {} packets, {} damaged, {} lost; readings: gyro {}, accel {}, mag {}, skipped {}; \
         answers: {} sent, {} dropped",
        c.packets,
        c.damaged,
        c.lost,
        c.gyro,
        c.accel,
        c.mag,
        c.skipped,
        report.answers_sent,
        report.answers_dropped,
    );
    if let Some(q) = report.attitude {
        let [roll, pitch, yaw] = to_euler(q).map(f64::to_degrees);
        text += &format!("\nboard: roll {roll:.2} deg, pitch {pitch:.2} deg, yaw {yaw:.2} deg");
    }
    text
}
