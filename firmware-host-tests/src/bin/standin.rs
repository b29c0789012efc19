//! A stand-in for a flight controller as a program: behaves on its link as the firmware was measured to, and says at
//! the end what came.
//!
//! `standin FIRMWARE PATH [--baud N] [--declination-deg D] [--ahrs vqf|fusion] [--param NAME=N] [--unanswered N]
//! [--rate N] [--speed N] [--stops S | --stalls S,S | --restarts S,S] [--dead msp|gyro]`; for `px4-sitl` PATH is `HOST:PORT`, for `betaflight`
//! `HOST:UDP_PORT:TCP_PORT`, where it listens as the firmware does on 9003 and 5761. Exits with 0 when the link closes, with 1 if it used
//! no samples, with 2 if it could not run.

use std::io;
use std::net::TcpStream;
use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use ratetable_firmware_host_tests::board::{Device, Port};
use ratetable_firmware_host_tests::quaternion::to_euler;
use ratetable_firmware_host_tests::standin::{
    Clock, Make, Mishap, Program, Record, Settings, StandIn, Unlucky,
};

const USAGE: &str = "usage: standin px4|px4-sitl|px4-vectornav|px4-ilabs|ardupilot|ardupilot-mip|ardupilot-ilabs|ardupilot-sbg|inav|betaflight PATH (px4-sitl: HOST:PORT, \
                     betaflight: HOST:UDP_PORT:TCP_PORT) [--baud N] [--dead msp|gyro] \
                     [--declination-deg D] [--ahrs vqf|fusion] [--param NAME=N] [--unanswered N] [--rate HZ] \
                     [--speed TIMES] [--stops S | --stalls S,S | --restarts S,S] (after so many seconds, for so long)";

/// How long PX4 as a program tries to connect.
const PATIENCE: Duration = Duration::from_secs(30);

/// What was asked for.
struct Arguments {
    make: Make,
    path: String,
    baud: Option<u32>,
    speed: f64,
    settings: Settings,
    mishap: Option<Mishap>,
}

fn main() -> ExitCode {
    let arguments = match parse(std::env::args().skip(1)) {
        Ok(arguments) => arguments,
        Err(why) => {
            eprintln!("standin: {why}\n{USAGE}");
            return ExitCode::from(2);
        }
    };
    match run(&arguments) {
        Ok(record) => {
            eprintln!("{}", summary(arguments.make, &record));
            ExitCode::from(u8::from(record.counts.samples == 0))
        }
        Err(error) => {
            eprintln!("standin: {}: {error}", arguments.path);
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &Arguments) -> io::Result<Record> {
    let clock = Clock::wall(arguments.speed);
    if arguments.make == Make::Betaflight {
        let mut program =
            Program::open(&arguments.path, arguments.make.firmware(&arguments.settings), clock)?;
        program.run(&AtomicBool::new(false))?;
        return Ok(program.record().clone());
    }
    let port: Box<dyn Port + Send> = match arguments.make {
        Make::Px4Sitl => Box::new(Device::from(connect(&arguments.path)?)),
        _ => Box::new(Device::open(Path::new(&arguments.path), arguments.baud)?),
    };
    let Arguments { make, settings, .. } = arguments;
    let firmware = match arguments.mishap {
        Some(mishap) => Box::new(Unlucky::new(*make, settings, mishap)),
        None => make.firmware(settings),
    };
    let mut standin = StandIn::new(port, firmware, clock);
    standin.run(&AtomicBool::new(false))?;
    Ok(standin.record().clone())
}

/// Tries until the simulator is there, as PX4 does.
fn connect(address: &str) -> io::Result<TcpStream> {
    let since = Instant::now();
    loop {
        match TcpStream::connect(address) {
            Err(error) if error.kind() == io::ErrorKind::ConnectionRefused && since.elapsed() < PATIENCE => {
                std::thread::sleep(Duration::from_millis(100));
            }
            other => return other,
        }
    }
}

fn parse(mut words: impl Iterator<Item = String>) -> Result<Arguments, String> {
    let (mut places, mut baud, mut speed) = (Vec::new(), None, 1.0);
    let (mut settings, mut mishap) = (Settings::default(), None);
    while let Some(word) = words.next() {
        if !word.starts_with('-') {
            places.push(word);
            continue;
        }
        let value = words.next().ok_or_else(|| format!("{word} needs a value"))?;
        match word.as_str() {
            "--baud" => baud = Some(number(&word, &value)?),
            "--speed" => speed = number(&word, &value)?,
            "--ahrs" => settings.ahrs = value.parse()?,
            "--declination-deg" => settings.declination_rad = number::<f64>(&word, &value)?.to_radians(),
            "--unanswered" => settings.unanswered = number(&word, &value)?,
            "--rate" => settings.rate_hz = number(&word, &value)?,
            "--stops" => mishap = Some(Mishap::Stops { at_us: micros(&word, &value)? }),
            "--stalls" | "--restarts" => {
                let (at, span) =
                    value.split_once(',').ok_or_else(|| format!("{word}: `{value}` is not two times"))?;
                let (at_us, for_us) = (micros(&word, at)?, micros(&word, span)?);
                mishap = Some(match word.as_str() {
                    "--stalls" => Mishap::Stalls { at_us, for_us },
                    _ => Mishap::Restarts { at_us, for_us },
                });
            }
            "--dead" => match value.as_str() {
                "msp" => settings.build.msp = false,
                "gyro" => settings.build.gyro = false,
                _ => return Err(format!("{word}: `{value}` is neither msp nor gyro")),
            },
            "--param" => {
                let (name, of) =
                    value.split_once('=').ok_or_else(|| format!("{word}: `{value}` is no NAME=N"))?;
                settings.parameters.insert(name.to_owned(), number(&word, of)?);
            }
            _ => return Err(format!("unknown option {word}")),
        }
    }
    match <[String; 2]>::try_from(places) {
        Ok([make, path]) => Ok(Arguments { make: make.parse()?, path, baud, speed, settings, mishap }),
        Err(_) => Err("a firmware and a path".into()),
    }
}

fn micros(word: &str, seconds: &str) -> Result<u64, String> {
    Ok((number::<f64>(word, seconds)? * 1e6) as u64)
}

fn number<T: std::str::FromStr>(word: &str, value: &str) -> Result<T, String> {
    value.parse().map_err(|_| format!("{word}: `{value}` is not a number that fits"))
}

/// The counts and the last attitude, in words.
fn summary(make: Make, record: &Record) -> String {
    let mut text = format!("standin {make}: {}", record.counts);
    if let Some(newest) = record.history.last() {
        let [roll, pitch, yaw] = to_euler(newest.attitude).map(f64::to_degrees);
        text += &format!("\nstandin {make}: roll {roll:.2} deg, pitch {pitch:.2} deg, yaw {yaw:.2} deg");
    }
    text
}
