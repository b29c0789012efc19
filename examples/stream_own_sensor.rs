//! A sensor model of your own, streamed in real time over a pseudo-terminal as `mpu` packets, and read at its other end.
//!
//! `cargo run --example stream_own_sensor`

#![expect(clippy::print_stdout, reason = "an example says what it found")]

use ratetable::clock::{Clock, Policy, Precise, WallClock};
use ratetable::geometry::Vector;
use ratetable::link::{Address, Link, Sent};
use ratetable::player::{BLOCK, Player};
use ratetable::scene::Builder;
use ratetable::sensor::SensorKind;
use ratetable::wire::samples::{Samples, Sensed};
use ratetable::wire::{self, Now, Options, Protocol, Setup, dialogue::Peer};
use std::fs::File;
use std::io::Read;
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

/// The model: a gyroscope whose z axis sticks below 2 deg/s, as cheap ones with a dead band do.
fn dead_band(rate: Vector<ratetable::geometry::Body>) -> Vector<ratetable::geometry::Body> {
    let [x, y, z] = rate.v.to_array();
    Vector::new(x, y, if z.abs() < 2f64.to_radians() { 0.0 } else { z })
}

#[tokio::main(flavor = "current_thread")]
async fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Truth and times come from a scene without errors.
    let plan = Builder::new("rocking")
        .motion(
            "rock",
            &[("axis", "yaw"), ("amplitude", "30 deg/s"), ("frequency", "0.5 Hz"), ("duration", "1 s")],
        )
        .sensor(SensorKind::Gyro, &[("rate", "200 Hz"), ("resolution", "16.4 LSB/(deg/s)")])
        .build()?;

    let address: Address = "pty".parse()?;
    let mut link = Link::open(&address).await?;
    println!("streaming to {}", link.name());
    let received = listen(link.name().to_string());
    link.peer().await?;

    let setup = Setup {
        sensors: &plan.sensors,
        axes: plan.axes,
        day: None,
        options: Options::default(),
        peer: Peer::default(),
    };
    let mut encoder = wire::encoder(Protocol::Mpu, &setup);
    let mut sender = link.sender();
    let mut clock = Precise::new(WallClock::start(), Policy::Adaptive);
    let (start, mut packets, mut sent) = (clock.now() + 1_000_000, Vec::new(), 0);
    Player::new(&plan, plan.duration, BLOCK).play(|moment| {
        let own = moment.readings.iter().map(|reading| match reading.body() {
            Some(gyro) => reading.with_body(dead_band(gyro.value)),
            None => *reading,
        });
        let readings: Vec<_> = own.collect();
        packets.clear();
        encoder.encode(&Now { t: moment.t, truth: moment.truth, readings: &readings }, &mut packets);
        for packet in &packets {
            clock.wait_until(start + packet.due.0);
            sent += u32::from(sender.send(packet.bytes()) == Sent::Done);
        }
        Ok::<(), std::convert::Infallible>(())
    })?;

    // The reader counts until nothing comes for a while.
    let (samples, stuck) = received.recv_timeout(Duration::from_secs(5))?;
    println!("{sent} packets sent, {samples} gyroscope samples received, {stuck} in the dead band");
    assert!(samples >= 190 && stuck > 5, "200 samples, some of them about where the rocking turns round");
    Ok(())
}

/// Reads the other end as a firmware would: samples received, and those that are exactly zero.
fn listen(path: String) -> mpsc::Receiver<(u32, u32)> {
    let (tell, told) = mpsc::channel();
    thread::spawn(move || {
        let Ok(mut port) = File::open(path) else { return };
        let (mut reader, mut count, mut stuck, mut buffer) = (Samples::new(Protocol::Mpu), 0, 0, [0; 4096]);
        while count < 200 {
            let Ok(n @ 1..) = port.read(&mut buffer) else { break };
            reader.feed(&buffer[..n], |sample| {
                count += 1;
                stuck += u32::from(matches!(sample.value, Some(Sensed::Body(rate)) if rate.v.z == 0.0));
            });
        }
        let _ = tell.send((count, stuck));
    });
    told
}
