//! What a sample, a packet and a run cost. `cargo bench --bench emulator` prints time and elements a second; docs/benchmarks.md has the figures.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use ratetable::motion::Truth;
use ratetable::player::{BLOCK, Player};
use ratetable::scene::{Output, Plan};
use ratetable::sensor::Reading;
use ratetable::session::{self, Event, Job, Speed};
use ratetable::wire::{self, Now, Options, Protocol, Setup};
use std::convert::Infallible;
use std::hint::black_box;
use std::io::Read;
use std::os::unix::fs::OpenOptionsExt;
use std::sync::Arc;
use std::time::Duration;

fn plan(scene: &str) -> Plan {
    Plan::load(scene, &[]).expect("a built-in scene")
}

/// Every reading of a scene with the truth when it is due.
fn readings(plan: &Plan) -> Vec<(Truth, Vec<Reading>)> {
    let mut all = Vec::new();
    let _ = Player::new(plan, plan.duration, BLOCK).play(|moment| {
        all.push((*moment.truth, moment.readings.to_vec()));
        Ok::<(), Infallible>(())
    });
    all
}

/// Nanoseconds a sample of one sensor, truth included: an element is a three-axis sample.
fn samples(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("sample");
    for scene in ["table-1", "still", "mpu-9250", "manoeuvre", "coning"] {
        let plan = plan(scene);
        let count: usize = readings(&plan).iter().map(|(_, readings)| readings.len()).sum();
        group.throughput(Throughput::Elements(count as u64));
        group.bench_function(scene, |bencher| {
            bencher.iter(|| {
                let mut sum = 0.0;
                let _ = Player::new(&plan, plan.duration, BLOCK).play(|moment| {
                    sum +=
                        moment.readings.iter().map(|reading| reading.body().unwrap().value.v.x).sum::<f64>();
                    Ok::<(), Infallible>(())
                });
                black_box(sum)
            });
        });
    }
    group.finish();
}

/// Nanoseconds to encode a packet, apart from making its readings: an element is a packet. The readings of one block are
/// encoded again and again, so that they are in the cache, as they are where the player has just made them.
fn packets(criterion: &mut Criterion) {
    let plan = plan("still");
    let readings: Vec<_> = readings(&plan).into_iter().take(BLOCK).collect();
    let setup = Setup {
        sensors: &plan.sensors,
        axes: plan.axes,
        day: plan.day,
        options: Options::default(),
        peer: Default::default(),
    };
    let mut group = criterion.benchmark_group("encode");
    for protocol in Protocol::ALL {
        let mut packets = Vec::new();
        let mut encode = || {
            let (mut encoder, mut count) = (wire::encoder(protocol, &setup), 0);
            for (truth, readings) in &readings {
                packets.clear();
                encoder.encode(&Now { t: truth.t, truth, readings }, &mut packets);
                count += black_box(&packets).len();
            }
            count
        };
        group.throughput(Throughput::Elements(encode() as u64));
        group.bench_function(protocol.name(), |bencher| bencher.iter(|| black_box(encode())));
    }
    group.finish();
}

/// A whole run at full speed, threads and links included: an element is a packet.
fn end_to_end(criterion: &mut Criterion) {
    let plan = Arc::new(plan("still"));
    let mut group = criterion.benchmark_group("end-to-end");
    group.sample_size(10).measurement_time(Duration::from_secs(8));
    for to in ["mpu@file:/dev/null", "mavlink@file:/dev/null", "mpu@pty", "mavlink@pty"] {
        let packets = run(&plan, to);
        group.throughput(Throughput::Elements(packets));
        group.bench_function(BenchmarkId::from_parameter(to), |bencher| bencher.iter(|| run(&plan, to)));
    }
    group.finish();
}

fn run(plan: &Arc<Plan>, to: &str) -> u64 {
    let outputs = vec![Output::to(to.parse().expect("a destination"))];
    let job = Job { speed: Speed::Max, wait: Duration::from_secs(10), ..Job::new(plan.clone(), outputs) };
    let mut reader = None;
    let outcome = session::run(job, &mut |event| {
        if let Event::Ready(name) = event
            && let Some(path) = name
                .split_once('@')
                .map(|(_, path)| path.to_string())
                .filter(|path| path.starts_with("/dev/pts"))
        {
            reader = Some(std::thread::spawn(move || drain(&path)));
        }
    });
    let packets = outcome.expect("a run").links[0].packets;
    if let Some(reader) = reader {
        reader.join().expect("a reader");
    }
    packets
}

/// Reads a pty by its path until it closes.
fn drain(path: &str) {
    let mut pty =
        std::fs::OpenOptions::new().read(true).custom_flags(libc::O_NOCTTY).open(path).expect("the pty");
    let mut buffer = [0; 65536];
    while matches!(pty.read(&mut buffer), Ok(count) if count > 0) {}
}

criterion_group!(benches, samples, packets, end_to_end);
criterion_main!(benches);
