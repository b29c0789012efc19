//! A chip of the emulator itself, at the other end of a pty, in real time. The scene is made so that what is sensed does
//! not change, whenever a driver looks: the vehicle turns about the vertical, or stands still with biases.

use std::cell::RefCell;
use std::io::PipeWriter;
use std::os::fd::AsRawFd;
use std::path::Path;
use std::rc::Rc;
use std::sync::{Arc, mpsc};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use ratetable::bus::CHIPS;
use ratetable::scene::{Output, Plan};
use ratetable::sensor::{SensorKind, lsb};
use ratetable::session::{self, Event, Job, Outcome, SessionError};
use ratetable::time::Rate;
use ratetable_firmware_host_tests::board::{Arrival, Device, Port as _};
use ratetable_protocols::bridge::{Client, Port};
use ratetable_protocols::chip::Channel;

use super::bench::{Bench, Part, Sensed, Wanted};
use super::{Verdict, equal};

const G: f64 = 9.80665;

/// The emulator answers within this time on any machine, or never.
const PATIENCE: Duration = Duration::from_secs(30);

/// A chip, and a scene for it.
#[derive(Clone, Debug)]
pub struct Shown {
    chip: &'static str,
    address: Option<u8>,
    motion: String,
    /// More keys of the gyro and of the accelerometer.
    errors: [String; 2],
    sensed: Sensed,
}

impl Shown {
    /// At this address.
    pub fn at(self, address: u8) -> Shown {
        Shown { address: Some(address), ..self }
    }

    /// At this temperature.
    pub fn celsius(mut self, celsius: f64) -> Shown {
        self.sensed.celsius = celsius;
        self
    }

    fn has_mag(&self) -> bool {
        CHIPS.iter().any(|kind| kind.part == self.chip && kind.channels().count() == 3)
    }

    fn scene(&self) -> String {
        let mut scene = self.motion.clone();
        for (sensor, errors) in ["gyro", "accel"].into_iter().zip(&self.errors) {
            scene +=
                &format!("[{sensor}]\nrate = \"1 kHz\"\ntemperature = \"{} degC\"\n", self.sensed.celsius);
            scene += &self.address.map_or(String::new(), |address| format!("address = {address:#x}\n"));
            scene += errors;
        }
        scene + if self.has_mag() { "[mag]\nrate = \"100 Hz\"\n" } else { "" }
    }
}

/// The chip of a vehicle with roll 20° and pitch -15° that turns at 3.2 deg/s about the vertical, in a field of 45 µT
/// straight down, at 30 °C. Few enough counts that a driver's rounding of the sheet's sensitivity stays below one.
pub fn turning(chip: &'static str) -> Shown {
    let (roll, pitch) = (20_f64.to_radians(), -15_f64.to_radians());
    // Down, along forward, right, down of the body: the third row of body-to-north-east-down.
    let down = [-pitch.sin(), roll.sin() * pitch.cos(), roll.cos() * pitch.cos()];
    let [rx, ry, rz] = down.map(|it| 3.2 * it);
    let up = down.map(|it| -it);
    let [mx, my, mz] = flu(down.map(|it| 45.0 * it));
    let mag_ut = match chip {
        // PS-MPU-9250A section 9.1: the magnetometer's x is the gyro's y, and its z points the other way.
        "MPU-9250" => [my, mx, -mz],
        // DS-000189, figures 12 and 13.
        _ => [mx, -my, -mz],
    };
    let motion = format!(
        "[start]\nattitude = \"[20, -15, 40] deg\"\n[earth]\nfield = \"[0, 0, 45] uT\"\n[[motion]]\nkind = \"rotate\"\nangular_rate = \"[{rx}, {ry}, {rz}] deg/s\"\nduration = \"1 h\"\n"
    );
    let sensed = Sensed { gyro_dps: flu([rx, ry, rz]), accel_g: flu(up), mag_ut, celsius: 30.0 };
    Shown { chip, address: None, motion, errors: Default::default(), sensed }
}

/// The chip of a vehicle that stands still and level, whose gyro and accelerometer have biases so that they read this.
pub fn still(chip: &'static str, sensed: Sensed) -> Shown {
    let [x, y, z] = flu(sensed.gyro_dps);
    let gyro = format!("bias = \"[{x}, {y}, {z}] deg/s\"\n");
    let [x, y, z] = flu(sensed.accel_g).map(|it| it * G);
    let accel = format!("bias = \"[{x}, {y}, {}] m/s^2\"\n", z + G);
    Shown { chip, address: None, motion: "duration = \"1 h\"\n".into(), errors: [gyro, accel], sensed }
}

/// Forward, right, down to forward, left, up, and back.
fn flu([x, y, z]: [f64; 3]) -> [f64; 3] {
    [x, -y, -z]
}

/// A run of the emulator, and a driver's end of its pty.
pub struct Run {
    port: Rc<RefCell<Device>>,
    session: JoinHandle<Result<Outcome, SessionError>>,
    /// The run lasts until this is dropped.
    until: PipeWriter,
}

impl Run {
    /// Plays a scene whose chips are on a bus, those of sensors without a part `chip`. The scene begins at once.
    pub fn start(plan: Arc<Plan>, chip: Option<&'static str>) -> Run {
        let mut output = Output::to("bus@pty".parse().expect("a destination"));
        output.wire.chip = chip;
        // A run lasts as long as the program that it starts: one that reads a pipe until nobody can write to it.
        let (end, until) = std::io::pipe().expect("a pipe");
        let pipe = format!("/proc/{}/fd/{}", std::process::id(), end.as_raw_fd());
        let (ready, opened) = mpsc::channel();
        let session = thread::spawn(move || {
            let command = vec!["cat".into(), pipe];
            let job = Job { command, wait: Duration::ZERO, ..Job::new(plan, vec![output]) };
            let outcome = session::run(job, &mut |event| {
                if let Event::Ready(name) = event {
                    let path = name.split_once('@').expect("PROTOCOL@LINK").1;
                    ready.send(path.to_owned()).expect("somebody waits for it");
                }
            });
            drop(end);
            outcome
        });
        let path = opened.recv_timeout(PATIENCE).expect("a pty");
        let device = Device::open(Path::new(&path), None).expect("a port");
        Run { port: Rc::new(RefCell::new(device)), session, until }
    }

    /// The bus.
    pub fn bus(&self) -> Client<Tty> {
        Client::new(Tty(self.port.clone()))
    }

    /// Ends it.
    pub fn end(self) -> Outcome {
        drop(self.until);
        self.session.join().expect("the emulator does not panic").expect("a run")
    }
}

/// The chip of a run.
pub struct Emulated {
    run: Run,
    part: &'static Part,
    sensed: Sensed,
    wanted: RefCell<Vec<Wanted>>,
}

/// What a check says of a chip of the emulator, and what the record of the run says of the check: the driver has set its
/// sensors as it wanted, in this order, and every sample is accounted for.
pub fn judge(part: &'static Part, shown: Shown, check: impl FnOnce(&Emulated) -> Verdict) -> Verdict {
    let scene = shown.scene();
    let plan =
        Plan::parse(&scene, "driver", "driver", &[]).unwrap_or_else(|error| panic!("{error}\n{scene}"));
    let run = Run::start(Arc::new(plan), Some(shown.chip));
    let bench = Emulated { run, part, sensed: shown.sensed, wanted: RefCell::default() };
    let verdict = check(&bench);
    let Emulated { run, wanted, .. } = bench;
    let outcome = run.end();
    verdict?;
    accounts(&outcome)?;
    is_recorded(part, &outcome, &wanted.into_inner())
}

fn is_recorded(part: &Part, outcome: &Outcome, wanted: &[Wanted]) -> Verdict {
    for channel in Channel::ALL {
        let kind = SensorKind::TRIADS[channel as usize];
        let mut changes = outcome.settings.iter().filter(|change| change.kind == kind);
        for wanted in wanted.iter().filter(|wanted| wanted.channel == channel) {
            let per_unit = match channel {
                Channel::Gyro => part.gyro[wanted.range],
                Channel::Accel => part.accel[wanted.range],
                Channel::Mag => part.mag,
            };
            let unit = match channel {
                Channel::Gyro => 1_f64.to_radians(),
                Channel::Accel => G,
                Channel::Mag => 1e-6,
            };
            let rate = wanted.rate.and_then(|(hz, by)| Rate::new(hz.into(), by.into()));
            let found = changes.any(|change| {
                let count = lsb(&change.setting.values, kind).unwrap_or(0.0);
                let is_range = (count * per_unit / unit - 1.0).abs() < 1e-3;
                is_range && (rate.is_none() || rate == change.setting.rate)
            });
            if !found {
                let all: Vec<_> = outcome.settings.iter().map(ToString::to_string).collect();
                return Err(format!("not recorded: {wanted:?}, {per_unit} counts a unit; {all:#?}"));
            }
        }
    }
    Ok(())
}

/// That every sample is accounted for, and that the bridge understood everything.
pub fn accounts(outcome: &Outcome) -> Verdict {
    for sensor in &outcome.sensors {
        let read = sensor.read.ok_or("not read from")?;
        equal(&sensor.name, read.samples + read.missed + read.overflowed + sensor.queued, sensor.made)?;
    }
    let bus = outcome.links[0].bus.as_ref().ok_or("no bus")?;
    equal("strange bytes", bus.strange, 0)?;
    equal("transfers not acknowledged", bus.refused, 0)
}

/// A driver's end of a pty.
pub struct Tty(Rc<RefCell<Device>>);

impl Port for Tty {
    type Error = String;

    fn send(&mut self, bytes: &[u8]) -> Result<(), String> {
        let (mut port, mut sent) = (self.0.borrow_mut(), 0);
        while sent < bytes.len() {
            sent += port.write(&bytes[sent..]).map_err(|error| error.to_string())?;
        }
        Ok(())
    }

    fn receive(&mut self, bytes: &mut [u8]) -> Result<(), String> {
        let (mut port, mut got) = (self.0.borrow_mut(), 0);
        while got < bytes.len() {
            match port.read(&mut bytes[got..], PATIENCE).map_err(|error| error.to_string())? {
                Arrival::Bytes(count) => got += count,
                other => return Err(format!("{other:?}")),
            }
        }
        Ok(())
    }
}

impl Bench for Emulated {
    type Bus = Client<Tty>;

    const STANDS_STILL: bool = false;

    fn bus(&self) -> Client<Tty> {
        self.run.bus()
    }

    fn wait(&self, ns: u64) {
        thread::sleep(Duration::from_nanos(ns));
    }

    fn show(&self, _: Sensed) -> Sensed {
        self.sensed
    }

    fn is_set_as(&self, wanted: Wanted) -> Verdict {
        debug_assert!(wanted.range < self.part.gyro.len().max(self.part.accel.len()));
        self.wanted.borrow_mut().push(wanted);
        Ok(())
    }
}
