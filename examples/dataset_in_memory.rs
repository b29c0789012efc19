//! A dataset in memory: a scene built in Rust, played into columns, and a filter's error from its exact truth.
//!
//! `cargo run --example dataset_in_memory`

#![expect(clippy::print_stdout, reason = "an example says what it found")]

use ratetable::motion::Wants;
use ratetable::player::{BLOCK, Player};
use ratetable::scene::Builder;
use ratetable::sensor::SensorKind;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let plan = Builder::new("turning")
        .set("seed", 7)
        .motion("rotate", &[("yaw", "20 deg/s"), ("duration", "10 s")])
        .sensor(SensorKind::Gyro, &[("rate", "100 Hz"), ("noise_std", "0.1 deg/s")])
        .build()?;

    let (mut rate, mut truth) = (Vec::new(), Vec::new());
    let mut player = Player::new(&plan, plan.duration, BLOCK);
    while let Some(columns) = player.play_columns(Wants { attitude: true, ..Wants::NONE }) {
        // One column an axis: z of the gyroscope, rad/s.
        rate.extend_from_slice(&columns.sensor(0).reading[2]);
        truth.extend((0..columns.truth.len()).map(|i| (columns.truth.t[i], columns.truth.attitude(i))));
    }

    // The simplest of filters: add up the angular rate.
    let yaw: f64 = rate.iter().map(|rate| rate / 100.0).sum();
    let (t, last) = truth.last().ok_or("no samples")?;
    let heading = 2.0 * last.q.z.atan2(last.q.w).to_degrees();
    println!(
        "{} samples up to {t}; heading {heading:.3} deg, integrated {:.3} deg",
        rate.len(),
        yaw.to_degrees()
    );
    assert_eq!(rate.len(), 1000);
    // 1000 samples of 0.1 deg/s add up to 0.03 deg (1 sigma), and the last tick is one before the end.
    assert!((yaw.to_degrees() - 200.0).abs() < 0.2);
    Ok(())
}
