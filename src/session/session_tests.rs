//! Half an hour of every protocol on a virtual clock: nothing lost, nothing out of order.

use super::producer::{self, Task};
use super::tests::{feeds, memory, pacer, plan};
use super::*;
use crate::clock::Clock;
use crate::link::Far;
use crate::player::{BLOCK, Player};
use crate::scene::{Output, Plan};
use crate::sensor::SensorKind;
use crate::time::SimTime;
use crate::wire::samples::Samples;
use crate::wire::{self, Now, Protocol, Setup};
use std::convert::Infallible;
use std::sync::Arc;
use std::thread;

/// The scene of half an hour.
const SCENE: &str = "seed = 7\nduration = \"1800 s\"\n[[motion]]\nkind = \"rock\"\namplitude = \"40 deg/s\"\nfrequency = \"0.3 Hz\"\naxis = \"pitch\"\nduration = \"1800 s\"\n[gyro]\nrate = \"50 Hz\"\nnoise_std = \"0.01 rad/s\"\n[accel]\nrate = \"50 Hz\"\nnoise_std = \"0.02 m/s^2\"\n[mag]\nrate = \"25 Hz\"\nnoise_std = \"0.2 uT\"\n";

/// A virtual clock whose sleeps end up to a millisecond late, and on which the other side reads what has arrived.
struct Reading {
    now: i64,
    far: Far,
    bytes: Vec<u8>,
}

impl Clock for Reading {
    fn now(&self) -> i64 {
        self.now
    }

    fn sleep_until(&mut self, t: i64) {
        if t > self.now {
            self.bytes.extend(self.far.take());
            self.now = t + (t / 1000 * 7919) % 1_000_000;
        }
    }
}

/// The bytes of the same scene, encoded without a session.
fn encoded(plan: &Plan, protocol: Protocol) -> Vec<u8> {
    let setup = Setup {
        sensors: &plan.sensors,
        axes: plan.axes,
        day: plan.day,
        options: wire::Options::default(),
        peer: Default::default(),
    };
    let mut encoder = wire::encoder(protocol, &setup);
    let (mut packets, mut bytes) = (Vec::new(), Vec::new());
    let played = Player::new(plan, plan.duration, BLOCK).play(|moment| {
        packets.clear();
        encoder.encode(&Now { t: moment.t, truth: moment.truth, readings: moment.readings }, &mut packets);
        packets.iter().for_each(|packet| bytes.extend_from_slice(packet.bytes()));
        Ok::<(), Infallible>(())
    });
    assert!(played.is_ok());
    bytes
}

fn half_an_hour(plan: &Plan, protocol: Protocol) {
    let name = protocol.name();
    let shared = Arc::<Shared>::default();
    let outputs = [Output::to(format!("{name}@pty").parse().unwrap())];
    let (ring, consumer) = ring::ring(8192);
    // The capacity of a pty: bytes that the other side does not read in time would be lost.
    let (sender, far) = memory(20_000);
    let (made, mut pacer) = thread::scope(|scope| {
        let task = Task { plan, end: plan.duration, rest: None };
        let feeds = feeds(plan, &outputs);
        let shared = &shared;
        let producer = scope.spawn(move || producer::produce(task, feeds, ring, shared).remove(0).made());
        let clock = Reading { now: 0, far, bytes: Vec::new() };
        let mut pacer = pacer(clock, consumer, sender, Speed::Times(1.0), shared);
        pacer.run(0);
        (producer.join().unwrap(), pacer)
    });
    pacer.pace.clock.bytes.extend(pacer.pace.clock.far.take());
    let (tally, bytes) = (&pacer.lanes[0].tally, &pacer.pace.clock.bytes);
    assert_eq!((tally.packets, tally.dropped), (made.packets, 0), "{name}");
    let fields = if protocol.carries(SensorKind::Mag) { 45_000 } else { 0 };
    assert_eq!(made.samples[..3], [90_000, 90_000, fields], "{name}");
    assert!(
        tally.sensors[0].latest_ns() > 500_000,
        "{name}: the clock was late, {}",
        tally.sensors[0].latest_ns()
    );
    assert!(*bytes == encoded(plan, protocol), "{name}: the very bytes, each packet once and in order");
    // A decoder that knows nothing of the scene agrees.
    let mut samples = Samples::new(protocol);
    let (mut counts, mut last, mut backwards) = ([0; SensorKind::COUNT], [SimTime(-1); SensorKind::COUNT], 0);
    let mut each = |sample: wire::samples::Sample| {
        let kind = sample.kind as usize;
        counts[kind] += 1;
        if let Some(t) = sample.t {
            backwards += u64::from(t < last[kind]);
            last[kind] = t;
        }
    };
    samples.feed(bytes, &mut each);
    samples.finish(&mut each);
    let heard = samples.counts();
    assert_eq!((heard.lost, heard.damaged, heard.duplicates, heard.out_of_order), (0, 0, 0, 0), "{name}");
    assert_eq!((heard.packets, backwards), (tally.packets, 0), "{name}");
    assert_eq!(counts[..2], [90_000, 90_000], "{name}");
    // A field that every packet carries is read a second time.
    assert!([fields, 2 * fields].contains(&counts[2]), "{name}: {}", counts[2]);
}

#[test]
fn half_an_hour_of_any_protocol_arrives_whole_and_in_order() {
    let plan = plan(SCENE);
    thread::scope(|scope| {
        for protocol in Protocol::STREAMS {
            let plan = &plan;
            scope.spawn(move || half_an_hour(plan, protocol));
        }
    });
}
