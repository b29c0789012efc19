//! One call for a whole run.

use super::control::Control;
use super::outside::Outside;
use super::{Event, Job, Outcome, SessionError, bus};
use std::time::Duration;

/// At full speed nothing moves without a reader. A reader that is away this long has left for good.
const ABSENCE: Duration = Duration::from_secs(5);

/// Runs a job until it ends, the user presses Ctrl-C or the command ends; reports events to `on` meanwhile.
///
/// # Errors
/// A link does not open, nobody connects in time, or a command does not start.
pub fn run(job: Job, on: &mut dyn FnMut(Event<'_>)) -> Result<Outcome, SessionError> {
    run_with(job, ABSENCE, on)
}

fn run_with(job: Job, absence: Duration, on: &mut dyn FnMut(Event<'_>)) -> Result<Outcome, SessionError> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let runtime =
        runtime.map_err(|source| SessionError::System { doing: "start the control loop", source })?;
    tokio::task::LocalSet::new().block_on(&runtime, go(job, absence, on))
}

async fn go(job: Job, absence: Duration, on: &mut dyn FnMut(Event<'_>)) -> Result<Outcome, SessionError> {
    let mut outside = Outside::new(on)?;
    let bus = bus::of(&job).cloned();
    let mut control = Control::ready(job, absence, &mut outside).await?;
    match bus {
        Some(bus) => {
            control.listen();
            bus::run(control, bus, outside).await
        }
        None => control.go(outside).await,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Output, Plan};
    use crate::session::Speed;
    use crate::time::SimTime;
    use std::fs::OpenOptions;
    use std::io::Read;
    use std::os::unix::fs::OpenOptionsExt;
    use std::sync::Arc;
    use std::thread;

    #[test]
    fn at_full_speed_a_reader_that_leaves_for_good_ends_the_run() {
        let scene = "duration = \"1000 s\"\n[gyro]\nrate = \"8 kHz\"\n";
        let plan = Arc::new(Plan::parse(scene, "test", "test", &[]).unwrap());
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("imu");
        let outputs = vec![Output::to(format!("mpu@pty:{}", path.display()).parse().unwrap())];
        let job = Job { speed: Speed::Max, wait: Duration::from_secs(60), ..Job::new(plan, outputs) };
        let read_a_while = move || {
            // A reader that is away for less than the limit may come back.
            for _ in 0..2 {
                let mut port =
                    OpenOptions::new().read(true).custom_flags(libc::O_NOCTTY).open(&path).unwrap();
                port.read_exact(&mut vec![0; 100_000]).unwrap();
                drop(port);
                thread::sleep(Duration::from_millis(150));
            }
        };
        let mut reader = None;
        let outcome = run_with(job, Duration::from_secs(2), &mut |event| {
            if let Event::Ready(_) = event {
                reader = Some(thread::spawn(read_a_while.clone()));
            }
        });
        reader.unwrap().join().unwrap();
        let outcome = outcome.unwrap();
        let link = &outcome.links[0];
        assert_eq!(link.broken.as_deref(), Some("the reader left"));
        assert!(link.bytes >= 200_000, "{link:?}");
        assert!(outcome.played < SimTime(1_000_000_000_000));
        assert!(!outcome.interrupted);
    }
}
