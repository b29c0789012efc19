//! How fast a driver reads a chip over `bus@pty`, and which sensor rate it follows without missing a sample.
//!
//! A run of the emulator in this process, and the client of `protocols` on the other end of its pty, which reads as fast as
//! it gets answers: a burst of 14 bytes of an MPU-9250 (accelerometer, temperature, gyro), with and without the question
//! how the transfer went, or the FIFO. Run on its own (`cargo bench --bench bus`, or with `-- --long` ten times as long for
//! each rate); as a test it only passes through.

use ratetable::report::{Times, number, table};
use ratetable::scene::{Output, Plan};
use ratetable::sensor::SensorKind;
use ratetable::session::{self, Event, Job, Outcome};
use ratetable::time::SimTime;
use ratetable_protocols::bridge::{Client, Message, Port, encode};
use std::fs::{File, OpenOptions};
use std::io::{self, Read, Write};
use std::os::unix::fs::OpenOptionsExt;
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

const MPU: u8 = 0x68;
/// Bytes of a sample in the FIFO: accelerometer and gyro.
const FRAME: usize = 12;
const SCENE: &str = "duration = \"1 h\"\n[gyro]\npart = \"MPU-9250\"\nrate = \"1 kHz\"\n[accel]\npart = \"MPU-9250\"\nrate = \"1 kHz\"\n";

/// A driver's end of a pty.
struct Tty(File);

impl Port for Tty {
    type Error = io::Error;

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.0.write_all(bytes)
    }

    fn receive(&mut self, bytes: &mut [u8]) -> io::Result<()> {
        self.0.read_exact(bytes)
    }
}

/// How a driver reads.
#[derive(Clone, Copy, PartialEq)]
enum Way {
    /// A burst, and how it went.
    Checked,
    /// A burst alone.
    Unchecked,
    /// The FIFO's count, and what is in it, without asking how it went.
    Fifo,
}

impl Way {
    const ALL: [Way; 3] = [Way::Checked, Way::Unchecked, Way::Fifo];

    fn name(self) -> &'static str {
        match self {
            Way::Checked => "14 bytes, status",
            Way::Unchecked => "14 bytes",
            Way::Fifo => "FIFO",
        }
    }
}

/// A driver of the chip.
struct Driver {
    client: Client<Tty>,
    /// The same end again, for what the client does not do.
    bare: Tty,
    /// From the first byte of a question to the last of its answer.
    trips: Times,
}

impl Driver {
    fn open(path: &str) -> io::Result<Driver> {
        let open = || OpenOptions::new().read(true).write(true).custom_flags(libc::O_NOCTTY).open(path);
        Ok(Driver { client: Client::new(Tty(open()?)), bare: Tty(open()?), trips: Times::new() })
    }

    /// Wakes the chip at this rate; false once nobody answers.
    fn start(&mut self, rate: Rate, way: Way) -> bool {
        let fifo: &[[u8; 2]] = if way == Way::Fifo { &[[0x23, 0x78], [0x6a, 0x44]] } else { &[] };
        let registers = [[0x6b, 0x01], [0x1a, rate.dlpf], [0x19, rate.divider], [0x1b, rate.choice]];
        registers.iter().chain(fifo).all(|write| self.client.write(MPU, write).is_ok())
    }

    fn read(&mut self, register: u8, out: &mut [u8], way: Way) -> bool {
        let since = Instant::now();
        let is_read = match way {
            Way::Checked => self.client.write_read(MPU, &[register], out).is_ok(),
            _ => self.unchecked(register, out).is_ok(),
        };
        self.trips.record(since.elapsed().as_nanos() as i64);
        is_read
    }

    fn unchecked(&mut self, register: u8, out: &mut [u8]) -> io::Result<()> {
        let (mut bytes, count) = ([0; 8], out.len() as u8);
        let len = encode(MPU, &[Message::Write(&[register]), Message::Read(count)], &mut bytes);
        let len = len.map_err(|_| io::ErrorKind::InvalidInput)?;
        self.bare.send(&bytes[..len])?;
        self.bare.receive(out)
    }

    /// Reads once what there is; false once nobody answers.
    fn turn(&mut self, way: Way) -> bool {
        if way != Way::Fifo {
            return self.read(0x3b, &mut [0; 14], way);
        }
        let mut count = [0; 2];
        if !self.read(0x72, &mut count, way) {
            return false;
        }
        let mut left = usize::from(u16::from_be_bytes(count)) / FRAME * FRAME;
        let mut bytes = [0; 21 * FRAME];
        while left > 0 {
            let part = left.min(bytes.len());
            if !self.read(0x74, &mut bytes[..part], way) {
                return false;
            }
            left -= part;
        }
        true
    }
}

/// A rate of the chip's gyro, and the registers that give it.
#[derive(Clone, Copy)]
struct Rate {
    hz: f64,
    dlpf: u8,
    divider: u8,
    /// FCHOICE_B, 1 past the filter.
    choice: u8,
}

/// From the fastest that this chip has.
fn rates() -> Vec<Rate> {
    let divided = [1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20].map(|by: u8| Rate {
        hz: 1000.0 / f64::from(by),
        dlpf: 1,
        divider: by - 1,
        choice: 0,
    });
    let undivided = |hz, choice| Rate { hz, dlpf: 0, divider: 0, choice };
    [vec![undivided(32_000.0, 1), undivided(8000.0, 0)], divided.to_vec()].concat()
}

/// Reads one rate for so long: what came of it, and the driver's round trips.
fn measure(link: &str, rate: Rate, way: Way, span: SimTime) -> (Outcome, Times) {
    let plan = Arc::new(Plan::parse(SCENE, "bench", "bench", &[]).expect("a scene"));
    let output = Output::to(format!("bus@{link}").parse().expect("a link"));
    let wait = Duration::from_secs(30);
    let job = Job { end: span, wait, rest: Some(SimTime(200_000_000)), ..Job::new(plan, vec![output]) };
    let mut running = None;
    let outcome = session::run(job, &mut |event| {
        if let Event::Ready(name) = event {
            let path = name.split_once('@').map_or(name, |(_, path)| path).to_owned();
            running = Some(thread::spawn(move || {
                let mut driver = Driver::open(&path).expect("a pty");
                let mut runs = driver.start(rate, way);
                while runs {
                    runs = driver.turn(way);
                }
                driver.trips
            }));
        }
    });
    let trips = running.expect("the link was open").join().expect("the driver ends well");
    (outcome.expect("a run"), trips)
}

/// Of the gyro's samples, those that the driver did not get, and all.
fn lost(outcome: &Outcome) -> (u64, u64) {
    let gyro = outcome.sensors.iter().find(|it| it.name == SensorKind::Gyro.name()).expect("a gyro");
    (gyro.dropped, gyro.made)
}

fn row(link: &str, way: Way, span: SimTime, most: usize) -> Vec<String> {
    let (mut refused, mut found, mut first) = (String::new(), None, None);
    for rate in rates().into_iter().take(most) {
        let (outcome, trips) = measure(link, rate, way, span);
        let (missed, made) = lost(&outcome);
        if missed == 0 && made > 0 {
            found = Some(rate.hz);
        } else {
            refused = format!("{} Hz: {missed} of {made}", number(rate.hz));
        }
        first.get_or_insert((outcome, trips));
        if found.is_some() {
            break;
        }
    }
    let (outcome, trips) = first.expect("a rate");
    let bus = outcome.links[0].bus.as_ref().expect("a bus");
    let p = |times: Option<(f64, f64)>| times.map_or(["-"; 2].map(String::from), |(a, b)| [a, b].map(number));
    let trip = p(trips.late().map(|late| (late.p50, late.p99)));
    let answer = p(bus.answer_us.map(|spread| (spread.p50, spread.p99)));
    let follows = found.map_or("none of these".into(), |hz| format!("{} Hz", number(hz)));
    let start = [link.into(), way.name().into(), number(bus.transfers_per_s.unwrap_or_default())];
    [start.to_vec(), trip.to_vec(), answer.to_vec(), vec![follows, refused]].concat()
}

fn main() {
    let given = |name: &str| std::env::args().any(|argument| argument == name);
    let (span, most) = match (given("--bench"), given("--long")) {
        (true, false) => (SimTime(5_000_000_000), usize::MAX),
        (true, true) => (SimTime(50_000_000_000), usize::MAX),
        _ => (SimTime(50_000_000), 1),
    };
    let mut rows = Vec::new();
    for link in ["pty", "pty,921600", "pty,115200"] {
        rows.extend(Way::ALL.map(|way| row(link, way, span, most)));
    }
    let heading = [
        "link",
        "read",
        "transfers/s",
        "trip p50 µs",
        "p99",
        "answer p50 µs",
        "p99",
        "follows",
        "missed at the next",
    ];
    eprintln!("{}", table(&heading, &rows));
}
