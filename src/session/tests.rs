use super::account::Account;
use super::feed::{Feed, Made};
use super::lane::Lane;
use super::pace::Pace;
use super::pacer::Pacer;
use super::producer::{self, Task};
use super::*;
use crate::clock::{Clock, VirtualClock};
use crate::link::{self, Far, Sender};
use crate::player::Player;
use crate::report::SensorReport;
use crate::scene::{Output, Overload, Plan};
use crate::wire::{self, Protocol, Setup};
use std::convert::Infallible;
use std::sync::Arc;
use std::time::Duration;

/// 1 kHz gyro and accel, 100 Hz mag, for a second.
pub(super) const SCENE: &str = "duration = \"1 s\"\n[gyro]\nrate = \"1 kHz\"\nnoise_std = \"0.01 rad/s\"\n[accel]\nrate = \"1 kHz\"\n[mag]\nrate = \"100 Hz\"\n";

pub(super) fn plan(text: &str) -> Plan {
    Plan::parse(text, "test", "test", &[]).unwrap_or_else(|error| panic!("{error}"))
}

fn output(text: &str) -> Output {
    Output::to(text.parse().unwrap_or_else(|error| panic!("{error}")))
}

/// The producer's feeds of these outputs.
pub(super) fn feeds(plan: &Plan, outputs: &[Output]) -> Vec<Feed> {
    let feed = |(i, output)| Feed::new(plan, i, output, Default::default());
    outputs.iter().enumerate().map(feed).collect()
}

/// Makes a whole scene's packets, without a rest.
pub(super) fn produce(plan: &Plan, outputs: &[Output], ring: ring::Inlet, shared: &Shared) -> Vec<Made> {
    let task = Task { plan, end: plan.duration, rest: None };
    let feeds = producer::produce(task, feeds(plan, outputs), ring, shared);
    feeds.into_iter().map(Feed::made).collect()
}

/// The ring of a whole scene, made ahead, and the counts of what was made.
pub(super) fn made(plan: &Plan, to: &str, shared: &Shared) -> (ring::Outlet, Made) {
    let (ring, consumer) = ring::ring(1 << 16);
    let made = produce(plan, &[output(to)], ring, shared).remove(0);
    (consumer, made)
}

/// A pacer of one output that drops what its link does not take.
pub(super) fn pacer<C: Clock>(
    clock: C,
    ring: ring::Outlet,
    sender: Sender,
    speed: Speed,
    shared: &Arc<Shared>,
) -> Pacer<C> {
    let lanes = vec![Lane::new(sender, Overload::DropNewest)];
    Pacer::new(Pace::new(clock, speed, shared.clone()), ring, lanes)
}

/// The report of each sensor of a scene that was paced over one output.
pub(super) fn reports(plan: &Plan, pacer: &mut Pacer<impl Clock>, made: Made) -> Vec<SensorReport> {
    let account = pacer.lanes.remove(0).account(made, 0);
    let report = |sensor| Account::sensor(std::slice::from_ref(&account), sensor, true);
    plan.sensors.iter().map(report).collect()
}

pub(super) fn memory(capacity: usize) -> (Sender, Far) {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
    let _inside = runtime.enter();
    let (mut link, far) = link::memory(capacity);
    (link.sender(), far)
}

/// Checks that nothing is missed silently, in samples of every kind.
pub(super) fn accounts_balance(made: &Made, pacer: &mut Pacer<impl Clock>) {
    pacer.give_up();
    let Lane { tally, left, .. } = &pacer.lanes[0];
    for kind in 0..3 {
        let sensor = &tally.sensors[kind];
        let queued = left.samples[kind] + made.waiting[kind];
        assert_eq!(made.samples[kind], sensor.sent + sensor.dropped + queued, "kind {kind}");
    }
    assert_eq!(made.packets, tally.packets + tally.dropped + left.packets, "packets");
}

#[test]
fn lateness_is_what_the_clock_did_and_everything_is_sent() {
    let (plan, shared) = (plan(SCENE), Arc::<Shared>::default());
    let (ring, made) = made(&plan, "mpu@pty", &shared);
    let (sender, mut far) = memory(1 << 20);
    // Every fourth wake-up is 30 µs late.
    let clock = VirtualClock::waking_late([0, 0, 0, 30_000]);
    let mut pacer = pacer(clock, ring, sender, Speed::Times(1.0), &shared);
    pacer.run(1_000_000);
    accounts_balance(&made, &mut pacer);
    assert_eq!(made.samples, [1000, 1000, 100, 0, 0, 0]);
    let reports = reports(&plan, &mut pacer, made);
    let late = reports[0].late_us.unwrap();
    assert_eq!((late.min, late.p50), (0.0, 0.0));
    assert!((late.max - 30.0).abs() < 0.03 && (late.p99 - 30.0).abs() < 0.03, "{late:?}");
    assert!((reports[0].sent_hz.unwrap() - 1000.0).abs() < 0.1);
    assert!((reports[2].sent_hz.unwrap() - 100.0).abs() < 0.01);
    assert_eq!(
        far.take().iter().filter(|&&byte| byte == 0).count(),
        1000 + 100 + 1,
        "imu, mag and config packets"
    );
}

#[test]
fn scene_time_goes_as_fast_as_asked() {
    for times in [0.5, 1.0, 4.0] {
        let (plan, shared) = (plan(SCENE), Arc::<Shared>::default());
        let (ring, _) = made(&plan, "mpu@pty", &shared);
        let (sender, _far) = memory(1 << 20);
        let mut pacer = pacer(VirtualClock::default(), ring, sender, Speed::Times(times), &shared);
        pacer.run(0);
        let report = &reports(&plan, &mut pacer, Made::default())[0];
        assert!((report.sent_hz.unwrap() / 1000.0 - times).abs() < 1e-6 * times, "{times}");
        assert_eq!(report.late_us.unwrap().max, 0.0, "a virtual clock is never late");
    }
}

#[test]
fn a_reader_that_stops_and_resumes_costs_exactly_what_is_counted() {
    let (plan, shared) = (plan(SCENE), Arc::<Shared>::default());
    let (ring, made) = made(&plan, "mpu@pty", &shared);
    let (sender, mut far) = memory(4096);
    let mut pacer = pacer(VirtualClock::default(), ring, sender, Speed::Times(1.0), &shared);
    pacer.run(0);
    accounts_balance(&made, &mut pacer);
    let tally = &pacer.lanes[0].tally;
    assert!(tally.dropped > 0 && tally.packets > 100, "{} dropped of {}", tally.dropped, tally.packets);
    let there = far.take().len() + pacer.lanes[0].sender.kept();
    assert_eq!(there as u64, tally.bytes, "what was counted as sent is there");
    assert_eq!(shared.dropped.get(), tally.sensors.iter().map(|sensor| sensor.dropped).sum::<u64>());
}

#[test]
fn a_link_that_goes_away_ends_the_run_and_the_rest_counts_as_queued() {
    let (plan, shared) = (plan(SCENE), Arc::<Shared>::default());
    let (ring, made) = made(&plan, "mpu@pty", &shared);
    let (sender, mut far) = memory(1 << 20);
    far.leave();
    let mut pacer = pacer(VirtualClock::default(), ring, sender, Speed::Times(1.0), &shared);
    pacer.run(0);
    assert!(pacer.lanes[0].end.is_some());
    pacer.give_up();
    let Lane { sender, left, .. } = pacer.lanes.remove(0);
    assert!(left.samples[0] > 0, "the rest is left");
    let (ring, made_again) = self::made(&plan, "mpu@pty", &shared);
    assert_eq!(made, made_again);
    pacer.ring = ring;
    pacer.lanes.push(Lane::new(sender, Overload::DropNewest));
    pacer.run(0);
    accounts_balance(&made, &mut pacer);
}

#[test]
fn samples_that_newer_ones_replace_are_counted_as_dropped() {
    let (plan, shared) = (
        plan(
            "duration = \"1 s\"\n[gyro]\nrate = \"100 Hz\"\n[accel]\nrate = \"1 kHz\"\n[mag]\nrate = \"7 Hz\"\n",
        ),
        Arc::<Shared>::default(),
    );
    let (ring, made) = made(&plan, "mavlink@pty", &shared);
    let (sender, _far) = memory(1 << 20);
    let mut pacer = pacer(VirtualClock::default(), ring, sender, Speed::Max, &shared);
    pacer.run(0);
    let accel = &pacer.lanes[0].tally.sensors[1];
    // Message k carries the newest of ten; the nine samples after the last message wait for one that never comes.
    assert_eq!((accel.sent, accel.dropped, made.waiting[1]), (100, 9 * 99, 9));
    accounts_balance(&made, &mut pacer);
}

#[test]
fn the_pacing_thread_allocates_nothing() {
    for (to, speed) in
        [("mpu@pty", Speed::Times(1.0)), ("mavlink@pty", Speed::Max), ("csv@pty", Speed::Times(2.0))]
    {
        let (plan, shared) = (plan(SCENE), Arc::<Shared>::default());
        let (ring, made) = made(&plan, to, &shared);
        let file = tempfile::NamedTempFile::new().unwrap();
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
        let address = format!("file:{}", file.path().display()).parse().unwrap();
        let mut link = runtime.block_on(link::Link::open(&address)).unwrap();
        let clock = VirtualClock::waking_late([0, 5_000]);
        let mut pacer = pacer(clock, ring, link.sender(), speed, &shared);
        let counted = allocation_counter::measure(|| pacer.run(0));
        assert!(pacer.lanes[0].tally.packets > 1000);
        assert_eq!(counted.count_total, 0, "{to}");
        accounts_balance(&made, &mut pacer);
        assert_eq!(made.packets, shared.packets.get(), "{to}");
        pacer.lanes[0].finish();
        assert_eq!(file.as_file().metadata().unwrap().len(), pacer.lanes[0].tally.bytes, "{to}");
    }
}

#[test]
fn a_run_at_full_speed_sends_the_bytes_that_encoding_offline_gives() {
    for protocol in ["mpu", "mavlink", "csv", "jsonl"] {
        let plan = Arc::new(plan(SCENE));
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("packets");
        let outputs = vec![output(&format!("{protocol}@file:{}", path.display()))];
        let job = Job { speed: Speed::Max, wait: Duration::from_secs(1), ..Job::new(plan.clone(), outputs) };
        let outcome = run(job, &mut |_| {}).unwrap();
        assert_eq!(outcome.played, plan.duration);
        for block in [1, 7, 4096] {
            assert_eq!(
                std::fs::read(&path).unwrap(),
                encoded(&plan, protocol, block),
                "{protocol}, blocks of {block}"
            );
        }
    }
}

fn encoded(plan: &Plan, protocol: &str, block: usize) -> Vec<u8> {
    let setup = Setup {
        sensors: &plan.sensors,
        axes: plan.axes,
        day: plan.day,
        options: wire::Options::default(),
        peer: Default::default(),
    };
    let mut encoder = wire::encoder(Protocol::from_name(protocol).unwrap(), &setup);
    let mut packets = Vec::new();
    let played = Player::new(plan, plan.duration, block).play(|moment| {
        let now = wire::Now { t: moment.t, truth: moment.truth, readings: moment.readings };
        encoder.encode(&now, &mut packets);
        Ok::<(), Infallible>(())
    });
    assert!(played.is_ok());
    packets.iter().flat_map(|packet| packet.bytes().to_vec()).collect()
}
