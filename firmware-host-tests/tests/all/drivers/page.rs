//! The program of `docs/howto/driver.md`: the page has it as it is, and it reads a scene.

use std::sync::Arc;
use std::thread;
use std::time::Duration;

use ratetable::scene::{Output, Plan};
use ratetable::session::{self, Event, Job};

use super::emulated::accounts;

#[path = "../../../examples/driver.rs"]
#[allow(dead_code, reason = "its main is not run here")]
mod example;

#[test]
fn the_program_of_the_page_is_the_example() {
    let page = include_str!("../../../../docs/howto/driver.md");
    assert!(page.contains(include_str!("../../../examples/driver.rs").trim_end()));
}

#[test]
fn the_example_reads_every_sample_that_its_driver_waits_for() {
    let scene = "duration = \"1 s\"\n[gyro]\npart = \"BMI160\"\nrate = \"100 Hz\"\n[accel]\npart = \"BMI160\"\nrate = \"100 Hz\"\n";
    let plan = Plan::parse(scene, "example", "example", &[]).expect("a scene");
    let output = Output::to("bus@pty".parse().expect("a destination"));
    let job = Job { wait: Duration::from_secs(30), ..Job::new(Arc::new(plan), vec![output]) };
    let mut running = None;
    let outcome = session::run(job, &mut |event| {
        if let Event::Ready(name) = event {
            let path = name.split_once('@').expect("PROTOCOL@LINK").1.to_owned();
            running = Some(thread::spawn(move || example::read(&path).map_err(|error| error.to_string())));
        }
    });
    let read =
        running.expect("the link was ready").join().expect("the example does not panic").expect("samples");
    let outcome = outcome.expect("a run");
    accounts(&outcome).expect("a record");
    // The first began the scene, and what was read as it ended may not have arrived.
    let gyro = outcome.sensors[0].read.expect("read from").samples;
    assert!(gyro > 0 && read.abs_diff(gyro) <= 2, "{read} of {gyro}");
}
