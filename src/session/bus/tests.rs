use super::super::Judging;
use super::*;
use crate::player::{BLOCK, Player};
use crate::scene::Plan;
use crate::sensor::SensorKind;
use crate::time::{NANOS, SimTime};
use ratetable_protocols::bridge::{Client, Port, Status, Trouble};
use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;
use std::sync::Arc;
use std::thread;

const SCENE: &str = "seed = 4\nduration = \"1 s\"\n[[motion]]\nkind = \"rock\"\naxis = \"roll\"\namplitude = \"200 deg/s\"\nfrequency = \"1 Hz\"\nduration = \"10 s\"\n[gyro]\npart = \"MPU-9250\"\nrate = \"1 kHz\"\n[accel]\npart = \"MPU-9250\"\nrate = \"1 kHz\"\n";

/// A driver's end of a pty.
struct Tty(File);

impl Tty {
    fn open(path: &Path) -> Tty {
        Tty(OpenOptions::new().read(true).write(true).custom_flags(libc::O_NOCTTY).open(path).unwrap())
    }
}

impl Port for Tty {
    type Error = std::io::Error;

    fn send(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        self.0.write_all(bytes)
    }

    fn receive(&mut self, bytes: &mut [u8]) -> std::io::Result<()> {
        self.0.read_exact(bytes)
    }
}

/// What a driver sees of a burst: accel, temperature, gyro.
fn burst(client: &mut Client<Tty>) -> Option<[i16; 7]> {
    let mut bytes = [0; 14];
    client.write_read(0x68, &[0x3b], &mut bytes).ok()?;
    Some([0, 1, 2, 3, 4, 5, 6].map(|i| i16::from_be_bytes([bytes[2 * i], bytes[2 * i + 1]])))
}

/// Plays a job while `driver` speaks to its bus; what it says in the end, and the notices.
fn played<T: Send + 'static>(
    job: Job,
    path: &Path,
    driver: impl FnOnce(Client<Tty>) -> T + Send + 'static,
) -> (Result<Outcome, SessionError>, T, Vec<String>) {
    let (mut driver, mut running, mut notices) = (Some(driver), None, Vec::new());
    let outcome = super::super::run(job, &mut |event| match event {
        Event::Ready(_) => {
            let (path, driver) = (path.to_owned(), driver.take().unwrap());
            running = Some(thread::spawn(move || driver(Client::new(Tty::open(&path)))));
        }
        Event::Notice(notice) => notices.push(notice),
        _ => {}
    });
    let said = running.unwrap().join();
    let said = said.unwrap_or_else(|_| panic!("the driver failed: {outcome:?}, {notices:?}"));
    (outcome, said, notices)
}

fn job(scene: &str, path: &Path) -> Job {
    let plan = Arc::new(Plan::parse(scene, "test", "test", &[]).unwrap());
    let output = Output::to(format!("bus@pty:{}", path.display()).parse().unwrap());
    Job { wait: Duration::from_secs(20), judging: Judging::default(), ..Job::new(plan, vec![output]) }
}

#[test]
fn a_driver_on_a_pty_reads_the_scene_and_the_scene_with_its_settings_gives_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("i2c");
    let (outcome, read, notices) = played(job(SCENE, &path), &path, |mut client| {
        for write in [[0x1b, 0x08], [0x1a, 0x03], [0x1d, 0x03], [0x19, 0x04]] {
            client.write(0x68, &write).unwrap();
        }
        assert!(matches!(client.write(0x10, &[0]), Err(Trouble::Refused(Status::NoAddress))));
        let mut read = Vec::new();
        while let Some(seen) = burst(&mut client) {
            if read.last() != Some(&seen) {
                read.push(seen);
            }
            if read.len() == 60 {
                client.write(0x68, &[0x1b, 0x10]).unwrap();
            }
            thread::sleep(Duration::from_millis(1));
        }
        read
    });
    let outcome = outcome.unwrap();
    assert_eq!(outcome.played, SimTime(NANOS));
    let settings: Vec<_> = outcome.settings.iter().map(ToString::to_string).collect();
    assert_eq!(settings[0], "gyro: 200 Hz, ±500 deg/s, low-pass 41 Hz", "{notices:?}");
    assert!(settings.len() == 3 && settings[2].contains("±1000"), "{settings:?}");
    assert!(notices.iter().any(|it| it.contains("nobody answers at 0x10")), "{notices:?}");
    assert!(notices.iter().any(|it| it.starts_with("the driver sets gyro: 200 Hz, ±1000")), "{notices:?}");
    let gyro = &outcome.sensors[0];
    let seen = gyro.read.unwrap();
    assert_eq!((gyro.made, gyro.made), (200, seen.samples + seen.missed + gyro.queued));
    let bus = outcome.links[0].bus.as_ref().unwrap();
    assert!(bus.transfers >= seen.samples && bus.answer_us.is_some() && bus.strange == 0, "{bus:?}");
    // Played again from what was written down: every sample that was read is there, in order.
    let mut plan = Plan::parse(SCENE, "test", "test", &[]).unwrap();
    plan.set(outcome.settings.iter().map(|it| (it.kind, it.setting.clone(), it.written.clone())));
    let again = Plan::parse(&plan.resolved, "resolved", "again", &[]).unwrap();
    let mut counts = Vec::new();
    let Ok(()) = Player::new(&again, again.duration, BLOCK).play(|moment| {
        let gyro = moment.readings.iter().find(|it| it.kind == SensorKind::Gyro);
        let body = gyro.map(|it| it.body().unwrap().value.v.to_array().map(f64::to_degrees));
        counts.extend(body.map(|[x, y, z]| {
            let lsb = if moment.t < again.sensors[0].segments()[1].from { 65.5 } else { 32.8 };
            [x * lsb, -y * lsb, -z * lsb].map(|count| count.round() as i16)
        }));
        Ok::<(), std::convert::Infallible>(())
    });
    // The first was read at rest, and began the scene.
    let (mut k, mut found) = (0, 0);
    for [.., x, y, z] in &read[1..] {
        if let Some(ahead) = counts[k..].iter().position(|counts| counts == &[*x, *y, *z]) {
            (k, found) = (k + ahead + 1, found + 1);
        }
    }
    assert!(found + 2 >= read.len() - 1, "{found} of {}", read.len());
}

#[test]
fn a_driver_that_reads_no_sample_ends_the_wait_with_what_came() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("i2c");
    let job = Job { wait: Duration::from_millis(700), ..job(SCENE, &path) };
    let (outcome, (), _) = played(job, &path, |mut client| {
        let mut who = [0];
        client.write_read(0x68, &[0x75], &mut who).unwrap();
        assert_eq!(who, [0x71]);
        // Keeps the pty open until the other side ends.
        let _ = client.write_read(0x68, &[0x75], &mut who);
        thread::sleep(Duration::from_millis(1500));
    });
    let error = outcome.unwrap_err().to_string();
    assert!(error.contains("no sample was read") && error.contains("2 transfers came"), "{error}");
}
