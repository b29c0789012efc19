//! Faults of outputs: a receiver counts exactly what was injected, and the account balances.

use super::feed::Made;
use super::tests::{accounts_balance, memory, pacer, plan, produce};
use super::*;
use crate::clock::{Clock, VirtualClock};
use crate::link::Far;
use crate::time::SimTime;
use crate::wire::Protocol;
use crate::wire::samples::{Counts, Samples};
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex};

const MS: i64 = 1_000_000;
/// 1 kHz gyro and accel, 100 Hz mag, for a second, to one output.
fn scene(protocol: &str, faults: &str) -> String {
    format!(
        "seed = 3\nduration = \"1 s\"\n[gyro]\nrate = \"1 kHz\"\nnoise_std = \"0.01 rad/s\"\n[accel]\nrate = \"1 kHz\"\n[mag]\nrate = \"100 Hz\"\n[[output]]\nto = \"{protocol}@pty\"\n{faults}"
    )
}

fn fault(kind: &str, more: &str) -> String {
    format!("[[fault]]\nkind = \"{kind}\"\nstart = \"200 ms\"\nduration = \"500 ms\"\n{more}\n")
}

/// Bytes, each block with its arrival time.
type Arrivals = Vec<(i64, Vec<u8>)>;

/// A virtual clock that records what has arrived whenever it advances.
struct Noting {
    now: i64,
    far: Far,
    seen: Arc<Mutex<Arrivals>>,
    /// When to stop everything.
    stop: Option<(i64, Arc<Shared>)>,
}

impl Clock for Noting {
    fn now(&self) -> i64 {
        self.now
    }

    fn sleep_until(&mut self, t: i64) {
        let bytes = self.far.take();
        if !bytes.is_empty() {
            self.seen.lock().unwrap().push((self.now, bytes));
        }
        self.now = self.now.max(t);
        if let Some((_, shared)) = self.stop.as_ref().filter(|(stop, _)| self.now >= *stop) {
            shared.stop.store(true, Ordering::Relaxed);
        }
    }
}

/// A finished run of the first output alone.
struct Ran {
    made: Made,
    sent: u64,
    /// What arrived, and when.
    seen: Arrivals,
}

impl Ran {
    fn bytes(&self) -> Vec<u8> {
        self.seen.iter().flat_map(|(_, bytes)| bytes.clone()).collect()
    }

    /// Packets that the only fault acted on.
    fn acted(&self) -> u64 {
        self.made.faults[0].packets
    }

    fn received(&self, protocol: Protocol) -> (Counts, [u64; 3]) {
        let (mut samples, mut received) = (Samples::new(protocol), [0; 3]);
        samples.feed(&self.bytes(), |sample| received[sample.kind as usize] += 1);
        samples.finish(|sample| received[sample.kind as usize] += 1);
        (samples.counts().clone(), received)
    }
}

fn run(scene: &str, speed: Speed) -> Ran {
    let (plan, shared) = (plan(scene), Arc::<Shared>::default());
    let (ring, consumer) = ring::ring(1 << 16);
    let mut made = produce(&plan, &plan.outputs[..1], ring, &shared).remove(0);
    made.settle(plan.duration);
    let (sender, far) = memory(1 << 20);
    let seen = Arc::default();
    let clock = Noting { now: 0, far, seen: Arc::clone(&seen), stop: None };
    let mut pacer = pacer(clock, consumer, sender, speed, &shared);
    pacer.run(0);
    accounts_balance(&made, &mut pacer);
    assert_eq!(pacer.lanes[0].tally.dropped, 0, "a fault is no loss of ours");
    let _ = pacer.lanes[0].sender.finish();
    pacer.pace.clock.sleep_until(i64::MAX);
    let sent = pacer.lanes[0].tally.packets;
    drop(pacer);
    Ran { made, sent, seen: Arc::into_inner(seen).unwrap().into_inner().unwrap() }
}

fn play(protocol: &str, faults: &str) -> Ran {
    run(&scene(protocol, faults), Speed::Times(1.0))
}

/// Whether `count` of n packets is a share p, within five standard deviations.
fn is_about(count: u64, n: f64, p: f64) -> bool {
    (count as f64 - n * p).abs() < 5.0 * (n * p * (1.0 - p)).sqrt()
}

#[test]
fn a_receiver_counts_exactly_what_was_injected() {
    for name in ["mpu", "mavlink"] {
        let protocol = Protocol::from_name(name).unwrap();
        let clean = play(name, "");
        let (none, all) = clean.received(protocol);
        assert_eq!((none.lost, none.damaged, none.duplicates, none.out_of_order), (0, 0, 0, 0), "control");
        assert_eq!((all, &clean.made.samples[..3]), ([1000, 1000, 100], &[1000, 1000, 100][..]));
        // In 500 ms mpu sends imu and mag packets, mavlink one packet for both.
        let n = if name == "mpu" { 550.0 } else { 500.0 };
        for (kind, p) in [("drop", 0.2), ("corrupt", 0.2), ("duplicate", 0.2), ("reorder", 0.2 / 1.2)] {
            let ran = play(name, &fault(kind, "share = \"20 %\""));
            let (counts, samples) = ran.received(protocol);
            let acted = ran.acted();
            assert!(is_about(acted, n, p), "{name} {kind}: {acted}");
            let of = |injected: &str| if kind == injected { acted } else { 0 };
            assert_eq!(counts.lost, of("drop") + of("corrupt"), "{name} {kind}");
            assert_eq!((counts.duplicates, counts.out_of_order), (of("duplicate"), of("reorder")), "{kind}");
            assert_eq!(counts.damaged, of("corrupt"), "{name} {kind}");
            assert_eq!(ran.sent, clean.sent - of("drop") + of("duplicate"), "{name} {kind}");
            assert_eq!(counts.packets + of("corrupt"), ran.sent, "{name} {kind}");
            // As many samples arrive as the account says, except those in damaged packets.
            let (made, came): (u64, u64) = (ran.made.samples.iter().sum(), samples.iter().sum());
            assert!(
                if kind == "corrupt" { came < made } else { came == made },
                "{name} {kind}: {came} {made}"
            );
            let whole = clean.made.samples.iter().sum::<u64>();
            assert_eq!(made.cmp(&whole), (of("duplicate")).cmp(&of("drop")), "{name} {kind}");
        }
        for kind in ["stall", "split"] {
            let ran = play(name, &fault(kind, ""));
            assert_eq!(ran.bytes(), clean.bytes(), "{kind} changes no byte");
            assert_eq!((ran.acted(), ran.sent), (n as u64, clean.sent), "{kind}");
        }
    }
}

#[test]
fn flips_may_hit_the_framing_if_asked_and_then_cost_neighbours_too() {
    let ran = play("mpu", &fault("corrupt", "share = \"100 %\"\nbits = 64\nhurts = \"framing\""));
    let (counts, _) = ran.received(Protocol::Mpu);
    assert_eq!(ran.acted(), 550);
    // Half of the zeros that end packets are damaged, which merges two packets into one.
    assert!(counts.damaged != 550, "{}", counts.damaged);
    let spared = play("mpu", &fault("corrupt", "share = \"100 %\"\nbits = 64"));
    assert_eq!(spared.received(Protocol::Mpu).0.damaged, 550, "control: each costs itself alone");
    let flipped = |a: &[u8], b: &[u8]| a.iter().zip(b).map(|(a, b)| (a ^ b).count_ones()).sum::<u32>();
    let clean = play("mpu", "").bytes();
    assert_eq!(flipped(&clean, &ran.bytes()), 550 * 64);
    assert_eq!(flipped(&clean, &play("mpu", &fault("corrupt", "share = \"100 %\"")).bytes()), 550);
}

#[test]
fn a_stall_holds_everything_back_and_lets_it_out_at_once() {
    let at = |t: i64| move |(when, _): &&(i64, Vec<u8>)| *when / MS == t;
    let (ran, clean) = (play("mpu", &fault("stall", "")), play("mpu", ""));
    assert!(!ran.seen.iter().any(|(when, _)| (200..700).contains(&(when / MS))));
    let burst: usize = ran.seen.iter().filter(at(700)).map(|(_, bytes)| bytes.len()).sum();
    let held: usize =
        clean.seen.iter().filter(|(when, _)| (200..=700).contains(&(when / MS))).map(|it| it.1.len()).sum();
    assert_eq!(burst, held);
    assert_eq!(ran.seen.iter().filter(at(701)).count(), 1, "and then goes on");
    // A stall that outlasts the scene ends with it.
    let late = play("mpu", "[[fault]]\nkind = \"stall\"\nstart = \"900 ms\"\nduration = \"5 s\"\n");
    assert_eq!((late.bytes(), late.acted()), (clean.bytes(), 110));
    assert!(late.seen.iter().all(|(when, _)| *when < 1000 * MS));
}

#[test]
fn a_split_packet_goes_out_in_pieces_a_gap_apart() {
    let ran = play("mpu", &fault("split", "pieces = 3\ngap = \"200 us\""));
    let clean = play("mpu", "");
    // A mag packet follows every tenth imu packet: the first is then whole before the second begins.
    for k in (200..700).filter(|k| k % 10 != 0) {
        let pieces: Vec<_> = ran.seen.iter().filter(|(when, _)| when / MS == k).collect();
        let whole = &clean.seen.iter().find(|(when, _)| when / MS == k).unwrap().1;
        let third = whole.len().div_ceil(3);
        let lens: Vec<_> = pieces.iter().map(|(when, bytes)| (when % MS / 1000, bytes.len())).collect();
        assert_eq!(lens, [(0, third), (200, third), (400, whole.len() - 2 * third)], "at {k} ms");
    }
    // Where the gap between pieces is longer than that between packets, the next packet brings the rest.
    let slow = play("mpu", &fault("split", "gap = \"3 ms\""));
    assert_eq!(slow.bytes(), clean.bytes());
}

#[test]
fn faults_give_the_same_bytes_at_any_speed_as_resolved_and_beside_others() {
    let kinds = ["drop", "corrupt", "duplicate", "reorder"];
    let every: String = kinds.map(|kind| fault(kind, "share = \"10 %\"")).concat();
    let every = every + &fault("stall", "") + &fault("split", "");
    let text = scene("mpu", &every);
    let ran = run(&text, Speed::Times(1.0)).bytes();
    assert_ne!(ran, play("mpu", "").bytes());
    for speed in [Speed::Times(0.3), Speed::Times(7.0), Speed::Max] {
        assert_eq!(run(&text, speed).bytes(), ran, "{speed:?}");
    }
    assert_eq!(run(&plan(&text).resolved, Speed::Max).bytes(), ran, "as resolved");
    let more = format!(
        "{text}[[output]]\nto = \"csv@pty\"\n[[fault]]\noutput = 1\nkind = \"drop\"\nshare = \"50 %\"\n"
    );
    assert_eq!(run(&more, Speed::Max).bytes(), ran, "a fault of another output");
    assert_ne!(run(&text.replace("seed = 3", "seed = 4"), Speed::Max).bytes(), ran, "but by another seed");
}

#[test]
fn what_was_done_ahead_of_time_is_not_told() {
    let scene = scene("mpu", &fault("drop", "share = \"100 %\""));
    let (plan, shared) = (plan(&scene), Arc::<Shared>::default());
    let (ring, _consumer) = ring::ring(1 << 16);
    let mut made = produce(&plan, &plan.outputs, ring, &shared).remove(0);
    let fired = |made: &Made| made.fired(&plan.outputs[0]);
    assert_eq!(fired(&made), [""; 0], "nothing has gone out yet");
    made.faults[0].settle(SimTime(300 * MS));
    assert_eq!(
        (made.faults[0].packets, fired(&made)),
        (110, vec!["mpu@pty drop from 0.2 s to 0.7 s".into()])
    );
    made.faults[0].settle(plan.duration);
    assert_eq!((made.faults[0].packets, &made.samples[..3]), (550, &[500, 500, 50][..]));
}

#[test]
fn the_account_is_whole_wherever_a_run_with_faults_is_stopped() {
    let kinds = ["drop", "corrupt", "duplicate", "reorder"];
    let every = kinds.map(|kind| fault(kind, "share = \"30 %\"")).concat();
    let plan = plan(&scene("mavlink", &(every + &fault("stall", "") + &fault("split", ""))));
    for stop in [0, 150, 205, 400, 699, 701, 950].map(|ms| ms * MS) {
        let shared = Arc::<Shared>::default();
        let (ring, consumer) = ring::ring(1 << 16);
        let made = produce(&plan, &plan.outputs, ring, &shared).remove(0);
        let (sender, far) = memory(1 << 20);
        let clock = Noting { now: 0, far, seen: Arc::default(), stop: Some((stop, shared.clone())) };
        let mut pacer = pacer(clock, consumer, sender, Speed::Times(1.0), &shared);
        pacer.run(0);
        let played = shared.stream_ns.load(Ordering::Relaxed);
        assert!(
            (stop..stop + 60 * MS).contains(&played),
            "time goes on where nothing is sent: {played} of {stop}"
        );
        accounts_balance(&made, &mut pacer);
    }
}

#[test]
fn the_pacing_thread_allocates_nothing_with_faults_either() {
    let every =
        ["drop", "corrupt", "duplicate", "reorder", "stall", "split"].map(|kind| fault(kind, "")).concat();
    let (plan, shared) = (plan(&scene("mpu", &every)), Arc::<Shared>::default());
    let (ring, consumer) = ring::ring(1 << 16);
    produce(&plan, &plan.outputs, ring, &shared);
    let (sender, _far) = memory(1 << 20);
    let mut pacer = pacer(VirtualClock::default(), consumer, sender, Speed::Times(1.0), &shared);
    let counted = allocation_counter::measure(|| pacer.run(0));
    assert!(pacer.lanes[0].tally.packets > 1000);
    assert_eq!(counted.count_total, 0);
}
