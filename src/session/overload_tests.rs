//! Links that are too slow, on a virtual clock: what each policy loses, keeps and delays, packet by packet.

use super::account::Account;
use super::lane::Lane;
use super::pace::Pace;
use super::pacer::Pacer;
use super::queue::BACKLOG;
use super::tests::{memory, plan, produce};
use super::*;
use crate::clock::Clock;
use crate::link::Far;
use crate::scene::{Output, Overload};
use proptest::prelude::*;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex};

const MS: i64 = 1_000_000;
const POLICIES: [Overload; 3] = [Overload::DropNewest, Overload::DropOldest, Overload::Stretch];
/// A packet each millisecond for a second; as text, a packet contains its time.
const SCENE: &str = "duration = \"1 s\"\n[gyro]\nrate = \"1 kHz\"\nnoise_std = \"0.01 rad/s\"\n";

/// The other side of one link, and what it received.
struct Reader {
    far: Far,
    received: Vec<u8>,
}

impl Reader {
    fn read(&mut self) {
        self.received.extend(self.far.take());
    }

    /// The times of the packets received, in ms, whole lines only.
    fn times(&self) -> Vec<i64> {
        let text = String::from_utf8(self.received.clone()).unwrap();
        text.lines().map(|line| line.split([':', ',']).nth(1).unwrap().parse::<i64>().unwrap() / MS).collect()
    }
}

type Readers = Arc<Mutex<Vec<Reader>>>;

/// A virtual clock on which the readers act each millisecond, before any wait ends.
struct World<F> {
    now: i64,
    readers: Readers,
    act: F,
}

impl<F: FnMut(i64, &mut [Reader]) + Send> Clock for World<F> {
    fn now(&self) -> i64 {
        self.now
    }

    fn sleep_until(&mut self, t: i64) {
        let mut readers = self.readers.lock().unwrap();
        for ms in self.now / MS + 1..=t / MS {
            (self.act)(ms, &mut readers);
        }
        self.now = self.now.max(t);
    }
}

/// A finished run.
struct Ran {
    accounts: Vec<Account>,
    readers: Vec<Reader>,
    end: i64,
    stretched: i64,
}

/// Plays `scene` as text over memory links of `capacity` bytes, one for each policy, while `act` runs.
fn run(
    scene: &str,
    policies: &[Overload],
    capacity: usize,
    act: impl FnMut(i64, &mut [Reader]) + Send,
) -> Ran {
    run_until(scene, policies, capacity, &Arc::<Shared>::default(), act)
}

fn run_until(
    scene: &str,
    policies: &[Overload],
    capacity: usize,
    shared: &Arc<Shared>,
    act: impl FnMut(i64, &mut [Reader]) + Send,
) -> Ran {
    let plan = plan(scene);
    let (ring, consumer) = ring::ring(1 << 16);
    let outputs: Vec<_> = policies.iter().map(|_| Output::to("jsonl@pty".parse().unwrap())).collect();
    let made = produce(&plan, &outputs, ring, shared);
    let (lanes, readers): (Vec<Lane>, Vec<Reader>) = policies
        .iter()
        .map(|policy| (memory(capacity), *policy))
        .map(|((sender, far), policy)| (Lane::new(sender, policy), Reader { far, received: Vec::new() }))
        .unzip();
    let readers = Arc::new(Mutex::new(readers));
    let world = World { now: 0, readers: readers.clone(), act };
    let pace = Pace::new(world, Speed::Times(1.0), shared.clone());
    let mut pacer = Pacer::new(pace, consumer, lanes);
    pacer.run(0);
    pacer.give_up();
    let Pacer { pace: Pace { clock, stretched, .. }, mut lanes, .. } = pacer;
    let end = clock.now;
    drop(clock);
    let mut readers = Arc::into_inner(readers).unwrap().into_inner().unwrap();
    for (reader, lane) in readers.iter_mut().zip(&mut lanes) {
        reader.far.stall(false);
        reader.read();
        // The rest of a packet that the link took in part.
        let _ = lane.sender.send(&[]);
        reader.read();
    }
    let accounts = lanes.into_iter().zip(made).map(|(lane, made)| lane.account(made, end)).collect();
    Ran { accounts, readers, end, stretched }
}

impl Ran {
    /// Checks what always holds: each packet and each sample is sent, dropped or queued; what was sent arrived
    /// once, whole and in order; the lateness of each was recorded. Returns the missing times.
    fn check(&self, link: usize) -> Vec<i64> {
        let Account { made, tally, left, .. } = &self.accounts[link];
        assert_eq!(made.packets, tally.packets + tally.dropped + left.packets, "packets");
        let sensor = &tally.sensors[0];
        assert_eq!(made.samples[0], sensor.sent + sensor.dropped + left.samples[0], "samples");
        let times = self.readers[link].times();
        assert_eq!(times.len() as u64, tally.packets, "sent is received");
        assert_eq!(self.readers[link].received.len() as u64, tally.bytes);
        assert!(times.is_sorted_by(|a, b| a < b), "in order");
        assert_eq!(tally.sensors[0].lateness_count(), tally.packets);
        (0..made.packets as i64).filter(|t| times.binary_search(t).is_err()).collect()
    }

    fn latest_ms(&self, link: usize) -> f64 {
        self.accounts[link].tally.sensors[0].latest_ns() as f64 / MS as f64
    }
}

/// Reads everything, except from `from` to `to` ms, where it reads nothing.
fn absent(from: i64, to: i64) -> impl FnMut(i64, &mut [Reader]) + Send {
    move |ms, readers| {
        if !(from..to).contains(&ms) {
            readers.iter_mut().for_each(Reader::read);
        }
    }
}

#[test]
fn a_reader_that_stops_and_resumes_costs_each_policy_its_own_packets() {
    let ran = POLICIES.map(|policy| run(SCENE, &[policy], 2000, absent(300, 600)));
    let lost = ran.each_ref().map(|ran| ran.check(0));
    // All three first lose the packet that the link has no room for, some forty packets after the reader stopped.
    let full = lost[0][0];
    assert!((310..400).contains(&full), "{full}");
    assert_eq!(lost[0], (full..600).collect::<Vec<_>>(), "drop-newest: whatever was due while it was full");
    assert!(ran[0].latest_ms(0) < 0.01, "and what is sent is on time");
    let kept = 600 - BACKLOG as i64;
    assert_eq!(lost[1], (full..kept).collect::<Vec<_>>(), "drop-oldest: all but the newest {BACKLOG}");
    assert!((ran[1].latest_ms(0) - BACKLOG as f64).abs() < 0.1, "which are late: {}", ran[1].latest_ms(0));
    assert_eq!(lost[2], Vec::<i64>::new(), "stretch: nothing");
    assert!(ran[2].latest_ms(0) < 0.01, "nor is anything late");
    assert_eq!(ran.each_ref().map(|ran| ran.stretched), [0, 0, (600 - full) * MS], "but time stood still");
    assert_eq!(ran[2].end, 999 * MS + ran[2].stretched);
}

#[test]
fn a_link_that_stalls_is_the_same_as_a_reader_that_stops() {
    for policy in POLICIES {
        let ran = run(SCENE, &[policy], 1 << 20, |ms, readers| {
            readers[0].far.stall((300..600).contains(&ms));
            readers[0].read();
        });
        let lost = ran.check(0);
        let expected = match policy {
            Overload::DropNewest => (300..600).collect(),
            Overload::DropOldest => (300..600 - BACKLOG as i64).collect(),
            Overload::Stretch => Vec::new(),
        };
        assert_eq!(lost, expected, "{policy:?}");
        assert_eq!(ran.stretched, if policy == Overload::Stretch { 300 * MS } else { 0 });
    }
}

#[test]
fn a_scene_that_asks_too_much_gets_what_the_link_carries_and_the_rest_is_counted() {
    // A packet has some eighty bytes and is due each millisecond; the link carries half of that.
    const CARRIED: usize = 1000;
    for policy in POLICIES {
        let ran = run(SCENE, &[policy], CARRIED, |ms, readers| {
            if ms % 32 == 0 {
                readers[0].read();
            }
        });
        let lost = ran.check(0);
        let tally = &ran.accounts[0].tally;
        match policy {
            Overload::Stretch => {
                assert!(lost.is_empty());
                let periods = tally.bytes as f64 / CARRIED as f64;
                let took = ran.end as f64 / (32 * MS) as f64;
                assert!((took / periods - 1.0).abs() < 0.1, "{took} periods of 32 ms for {periods} linkfuls");
            }
            _ => {
                assert!(lost.len() > 300, "{policy:?}: {}", lost.len());
                assert_eq!(tally.dropped + ran.accounts[0].left.packets, lost.len() as u64);
                // The link is never idle: it carries all it can until the end, plus or minus one linkful.
                let (linkfuls, periods) =
                    (tally.bytes as f64 / CARRIED as f64, ran.end as f64 / (32 * MS) as f64);
                assert!(
                    (periods - 1.0..periods + 2.0).contains(&linkfuls),
                    "{policy:?}: {linkfuls} in {periods}"
                );
            }
        }
        // A queue spans at most `BACKLOG` ms, and at the end it leaves as fast as the link allows.
        let packet = tally.bytes as f64 / tally.packets as f64;
        let latest = match policy {
            Overload::DropOldest => BACKLOG as f64 * (1.0 + packet / CARRIED as f64 * 32.0) + 32.0,
            _ => 0.01,
        };
        assert!(ran.latest_ms(0) <= latest, "{policy:?}: {}", ran.latest_ms(0));
    }
}

#[test]
fn a_reader_that_never_comes_back_leaves_what_waits_in_the_queue() {
    let shared = Arc::<Shared>::default();
    for policy in POLICIES {
        let ran = run_until(SCENE, &[policy], 2000, &Arc::<Shared>::default(), absent(300, 3000));
        ran.check(0);
        // The last second of patience ends one second after the last packet.
        let queued = if policy == Overload::DropOldest { BACKLOG as u64 } else { 0 };
        assert_eq!(ran.accounts[0].left.packets, queued, "{policy:?}");
    }
    // A scene that stands still ends on request; what was due and what was not are both left.
    let ran = run_until(SCENE, &[Overload::Stretch], 2000, &shared, |ms, readers| {
        if ms < 300 {
            readers[0].read();
        }
        shared.stop.store(ms > 5000, Ordering::Relaxed);
    });
    let lost = ran.check(0);
    assert_eq!((ran.accounts[0].tally.dropped, ran.accounts[0].left.packets), (0, lost.len() as u64));
    assert_eq!(lost, (lost[0]..1000).collect::<Vec<_>>());
}

#[test]
fn a_port_that_is_unplugged_gets_the_present_when_it_is_back_and_the_gap_is_told() {
    for policy in POLICIES {
        let ran = run(SCENE, &[policy], 1 << 20, |ms, readers| {
            readers[0].far.unplug((200..450).contains(&ms) || (700..800).contains(&ms));
            readers[0].read();
        });
        let (lost, gap) = (ran.check(0), &ran.accounts[0].tally.gaps);
        if policy == Overload::Stretch {
            // The scene waits for the reader: the second gap starts 250 ms earlier in scene time.
            assert_eq!((lost.len(), gap.count, gap.dropped, ran.stretched), (0, 2, 0, 350 * MS));
        } else {
            assert_eq!(lost, (200..450).chain(700..800).collect::<Vec<_>>(), "{policy:?}");
            assert_eq!((gap.count, gap.dropped, gap.samples), (2, 350, 350));
            assert!(ran.latest_ms(0) < 0.01);
        }
        assert_eq!(gap.total_ns, 350 * MS, "{policy:?}");
    }
}

#[test]
fn a_clock_that_steps_makes_packets_late_and_each_is_told() {
    let (scene, step) = (plan(SCENE), 200 * MS);
    for (policy, capacity) in POLICIES.iter().flat_map(|policy| [(*policy, 1 << 20), (*policy, 4000)]) {
        let shared = Arc::<Shared>::default();
        let (ring, consumer) = ring::ring(1 << 16);
        let made = produce(&scene, &[Output::to("jsonl@pty".parse().unwrap())], ring, &shared).remove(0);
        let (sender, far) = memory(capacity);
        let readers = Arc::new(Mutex::new(vec![Reader { far, received: Vec::new() }]));
        let world = World { now: 0, readers: readers.clone(), act: absent(0, 0) };
        // After half a second the machine sleeps for 200 ms: nothing happens meanwhile.
        let clock = Stepping { world, at: 500 * MS, step };
        let pace = Pace::new(clock, Speed::Times(1.0), shared.clone());
        let mut pacer = Pacer::new(pace, consumer, vec![Lane::new(sender, policy)]);
        pacer.run(0);
        pacer.give_up();
        let Lane { tally, left, .. } = &pacer.lanes[0];
        assert_eq!(made.packets, tally.packets + tally.dropped + left.packets, "{policy:?}");
        assert_eq!(tally.sensors[0].lateness_count(), tally.packets);
        let latest = tally.sensors[0].latest_ns();
        assert!((latest - step).abs() < MS / 2, "{policy:?}: {latest} ns");
        // Late packets go at once. Two hundred packets at once are too many for the smaller link.
        let all = capacity == 1 << 20 || policy == Overload::Stretch;
        assert_eq!(tally.dropped == 0, all, "{policy:?}: {}", tally.dropped);
    }
}

/// A clock that jumps once.
struct Stepping<C> {
    world: C,
    at: i64,
    step: i64,
}

impl<F: FnMut(i64, &mut [Reader]) + Send> Clock for Stepping<World<F>> {
    fn now(&self) -> i64 {
        self.world.now()
    }

    fn sleep_until(&mut self, t: i64) {
        self.world.sleep_until(t);
        if self.world.now >= self.at {
            self.world.now += std::mem::take(&mut self.step);
        }
    }
}

#[test]
fn one_stalling_reader_neither_delays_nor_drops_the_packets_of_the_others() {
    for policy in [Overload::DropNewest, Overload::DropOldest] {
        let ran = run(SCENE, &[policy, Overload::DropNewest, policy], 4000, |ms, readers| {
            let [stalling, others @ ..] = readers else { unreachable!() };
            others.iter_mut().for_each(Reader::read);
            if ms > 800 {
                stalling.read();
            }
        });
        assert!(ran.check(0).len() > 100, "{policy:?}");
        for link in [1, 2] {
            assert_eq!(ran.check(link), Vec::<i64>::new(), "{policy:?}");
            assert!(ran.latest_ms(link) < 0.01);
        }
    }
    // Stretched scene time is stretched for every output; even so nothing is lost.
    let ran = run(SCENE, &[Overload::Stretch, Overload::DropNewest], 4000, |ms, readers| {
        readers[1].read();
        if ms > 800 {
            readers[0].read();
        }
    });
    assert_eq!((ran.check(0), ran.check(1)), (Vec::new(), Vec::new()));
    assert!(ran.stretched > 600 * MS && ran.latest_ms(1) < 1.01);
}

#[test]
fn no_policy_allocates_in_the_pacing_thread() {
    for policy in POLICIES {
        let (plan, shared) = (plan(SCENE), Arc::<Shared>::default());
        let (ring, consumer) = ring::ring(1 << 16);
        produce(&plan, &[Output::to("jsonl@pty".parse().unwrap())], ring, &shared);
        let (sender, far) = memory(1 << 20);
        let readers = Arc::new(Mutex::new(vec![Reader { far, received: Vec::new() }]));
        let act = |ms: i64, readers: &mut [Reader]| {
            readers[0].far.stall((100..400).contains(&ms));
            readers[0].far.unplug((600..700).contains(&ms));
        };
        let world = World { now: 0, readers, act };
        let pace = Pace::new(world, Speed::Times(1.0), shared.clone());
        let mut pacer = Pacer::new(pace, consumer, vec![Lane::new(sender, policy)]);
        let counted = allocation_counter::measure(|| pacer.run(0));
        assert!(pacer.lanes[0].tally.packets >= 600 && pacer.lanes[0].tally.gaps.count == 1);
        assert_eq!(counted.count_total, 0, "{policy:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Readers read, rest, stall, unplug and leave at random: the accounts balance to the packet.
    #[test]
    fn whatever_the_other_sides_do_every_packet_is_accounted_for(
        whims in prop::collection::vec((0..3_usize, 0..6_u8, 1..60_i64), 5..60),
        capacity in 100..5000_usize,
    ) {
        let mut whims = whims.into_iter().cycle();
        let mut until = [0; 3];
        let mut reads = [true; 3];
        let mut over = 0;
        let shared = Arc::<Shared>::default();
        let ran = run_until(SCENE, &POLICIES, capacity, &shared, |ms, readers| {
            if ms >= over {
                let (link, whim, lasts) = whims.next().unwrap();
                over = ms + lasts;
                until[link] = over;
                reads[link] = whim != 1;
                readers[link].far.stall(whim == 2);
                readers[link].far.unplug(whim == 3);
                if whim == 4 && ms > 900 {
                    readers[link].far.leave();
                }
            }
            for (link, reader) in readers.iter_mut().enumerate() {
                if reads[link] {
                    reader.read();
                }
            }
            shared.stop.store(ms > 3000, Ordering::Relaxed);
        });
        for link in 0..3 {
            let Account { made, tally, left, .. } = &ran.accounts[link];
            prop_assert_eq!(made.packets, tally.packets + tally.dropped + left.packets);
            let sensor = &tally.sensors[0];
            prop_assert_eq!(made.samples[0], sensor.sent + sensor.dropped + left.samples[0]);
        }
        prop_assert_eq!(ran.accounts.iter().map(|it| it.tally.dropped).sum::<u64>(), shared.dropped.get());
    }
}
