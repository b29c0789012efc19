//! Conversations on a virtual clock: messages and their times, the rest, lockstep.

use super::feed::Made;
use super::heard::Heard;
use super::pace::Pace;
use super::pacer::Pacer;
use super::producer::{self, Task};
use super::side::{Side, Waits};
use super::step::Step;
use super::talk::Talk;
use super::tally::Tally;
use super::tests::{feeds, memory, plan};
use super::*;
use crate::clock::Clock;
use crate::geometry::Attitude;
use crate::link::Far;
use crate::player::{BLOCK, Player};
use crate::scene::{Output, Plan};
use crate::sensor::SensorKind;
use crate::time::SimTime;
use crate::wire::dialogue::{Dialogue, Estimate, Said, Stage, Stamp};
use std::convert::Infallible;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex};
use std::thread;

const MS: i64 = 1_000_000;
const S: i64 = 1000 * MS;

/// A controller that speaks in letters: `h` is its heartbeat, which gets an answer, `r` says that it is ready, `t`
/// that it read a packet, `e` is an estimate, `p` something for a ground station; anything else is damage.
#[derive(Default)]
struct Letters {
    stage: Option<Stage>,
    damaged: u64,
}

impl Dialogue for Letters {
    fn hear(&mut self, bytes: &[u8], _now: i64, say: &mut dyn FnMut(Said<'_>)) {
        for byte in bytes {
            match byte {
                b'h' => {
                    self.stage = self.stage.max(Some(Stage::Still));
                    say(Said::Reply(b"[hello]\n"));
                }
                b'r' => self.stage = Some(Stage::Ready),
                b't' => say(Said::Took),
                b'e' => say(Said::Estimate(Estimate { stamp: Stamp::Arrival, attitude: Attitude::IDENTITY })),
                b'p' => say(Said::Pass(b"\xfd\0\0\0\0\x01\x01\0\0\0xx")),
                _ => self.damaged += 1,
            }
        }
    }

    fn tick(&mut self, now: i64, say: &mut dyn FnMut(Said<'_>)) {
        if self.stage.is_none() && now % (500 * MS) == 0 {
            say(Said::Reply(b"[who?]\n"));
        }
    }

    fn stage(&self) -> Stage {
        self.stage.unwrap_or(Stage::Silent)
    }

    fn damaged(&self) -> u64 {
        self.damaged
    }
}

fn output(to: &str) -> Output {
    Output::to(to.parse().unwrap_or_else(|error| panic!("{error}")))
}

/// A conversation in letters about a scene, over a link of this capacity.
fn letters(plan: &Arc<Plan>, shared: &Arc<Shared>, speed: Speed, capacity: usize) -> (Talk, Far) {
    let (sender, far) = memory(capacity);
    let heard = Heard::new(plan.clone(), shared.clone(), speed, false);
    let mut talk = Talk::new(
        vec![Side::new(&output("csv@pty"), sender, None, Waits { paced: true, rest: None })],
        heard,
    );
    talk.script(0, Box::new(Letters::default()));
    (talk, far)
}

/// A virtual clock on which the other side acts each millisecond.
struct World<F> {
    now: i64,
    act: F,
}

impl<F: FnMut(i64) + Send> Clock for World<F> {
    fn now(&self) -> i64 {
        self.now
    }

    fn sleep_until(&mut self, t: i64) {
        for ms in self.now / MS + 1..=t / MS {
            (self.act)(ms);
        }
        self.now = self.now.max(t);
    }
}

/// A finished run.
struct Ran {
    made: Made,
    text: String,
    tally: Tally,
    end: i64,
}

impl Ran {
    /// Stream times of the samples that arrived, by sensor and in order, with their values.
    fn rows(&self) -> Vec<(i64, SensorKind, [f64; 3])> {
        let lines = self.text.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
        let row = |line: &str| {
            let cells: Vec<_> = line.split(',').collect();
            let kind = SensorKind::ALL.into_iter().find(|kind| kind.name() == cells[1]).unwrap();
            (cells[0].parse().unwrap(), kind, [2, 3, 4].map(|i| cells[i].parse().unwrap()))
        };
        lines.map(row).collect()
    }

    /// The replies among what arrived; each line is whole.
    fn replies(&self) -> Vec<&str> {
        let lines = self.text.lines().filter(|line| !line.starts_with(|c: char| c.is_ascii_digit()));
        lines.filter(|line| !line.starts_with("t_ns")).collect()
    }
}

/// Plays a scene as text after a rest. `act` gets the time in ms and what has arrived, and returns the other side's
/// bytes.
fn live(
    scene: &str,
    rest: Option<SimTime>,
    speed: Speed,
    lockstep: bool,
    capacity: usize,
    mut act: impl FnMut(i64, &str, &mut Talk) + Send,
) -> (Ran, Arc<Shared>) {
    let plan = Arc::new(plan(scene));
    let shared = Arc::new(Shared::before(rest));
    let (talk, far) = letters(&plan, &shared, speed, capacity);
    let talk = Mutex::new(talk);
    let there = Mutex::new((far, Vec::<u8>::new()));
    let (ring, consumer) = ring::ring(8192);
    let outputs = [output("csv@pty")];
    let mut lane = talk.lock().unwrap().lane(0, &outputs[0]);
    lane.step = lockstep.then(|| Step::new(talk.lock().unwrap().sides[0].counter()));
    let (made, tally, end) = thread::scope(|scope| {
        let task = Task { plan: &plan, end: plan.duration, rest };
        let feeds = feeds(&plan, &outputs);
        let shared = &shared;
        let producer = scope.spawn(move || producer::produce(task, feeds, ring, shared).remove(0).made());
        let world = World {
            now: 0,
            act: |ms| {
                let (far, text) = &mut *there.lock().unwrap();
                text.extend(far.take());
                let mut talk = talk.lock().unwrap();
                act(ms, std::str::from_utf8(text).unwrap(), &mut talk);
                talk.tick(ms * MS);
                shared.ready.store(talk.unready().is_none(), Ordering::Relaxed);
            },
        };
        let pace = Pace::new(world, speed, shared.clone());
        let mut pacer = Pacer::new(pace, consumer, vec![lane]);
        pacer.run(0);
        let end = pacer.pace.clock.now;
        // The rest of a packet that the link took in part.
        while pacer.lanes[0].sender.kept() > 0 {
            let (far, text) = &mut *there.lock().unwrap();
            text.extend(far.take());
            let _ = pacer.lanes[0].sender.send(&[]);
        }
        let mut tally = pacer.lanes.remove(0).tally;
        tally.replies += talk.lock().unwrap().sides[0].replies();
        (producer.join().unwrap(), tally, end)
    });
    let (mut far, mut text) = there.into_inner().unwrap();
    text.extend(far.take());
    (Ran { made, text: String::from_utf8(text).unwrap(), tally, end }, shared)
}

const TURNING: &str = "seed = 3\n[start]\nattitude = \"[10, 20, 30] deg\"\n[[motion]]\nkind = \"rotate\"\nangular_rate = \"[40, -25, 60] deg/s\"\nduration = \"2 s\"\n[gyro]\nrate = \"400/3 Hz\"\nnoise_std = \"0.001 rad/s\"\nbias_instability = \"10 deg/h\"\ncorrelation_time = \"10 s\"\n[accel]\nrate = \"100 Hz\"\nnoise_std = \"0.01 m/s^2\"\n[mag]\nrate = \"20 Hz\"\nnoise_std = \"0.1 uT\"\n[[fault]]\nsensor = \"mag\"\nkind = \"stuck\"\nstart = \"0.5 s\"\nduration = \"0.2 s\"\n";

/// The scene's readings as its dataset has them.
fn readings(plan: &Plan) -> Vec<(i64, SensorKind, [f64; 3])> {
    let mut all = Vec::new();
    let played = Player::new(plan, plan.duration, BLOCK).play(|moment| {
        let row = |reading: &crate::sensor::Reading| {
            (moment.t.0, reading.kind, plan.axes.body_out(reading.body().unwrap().value).to_array())
        };
        all.extend(moment.readings.iter().map(row));
        Ok::<(), Infallible>(())
    });
    assert!(played.is_ok());
    all
}

#[test]
fn the_vehicle_is_held_still_until_the_other_side_is_ready_and_then_the_scene_is_that_of_the_dataset() {
    for (rest, ready_ms) in [(0, 2340), (7, 2340), (7, 0), (0, 0)] {
        let rest = SimTime(rest * S);
        let (ran, shared) = live(TURNING, Some(rest), Speed::Times(1.0), false, 1 << 20, |ms, _, talk| {
            if ms == ready_ms.max(1) {
                talk.hear(0, b"hr", ms * MS);
            }
        });
        let starts = shared.scene_starts_ns.load(Ordering::Relaxed);
        // Ticks at 400/3 Hz fall on every third second. A scene may start when every side is ready, later by at
        // most the lead.
        assert_eq!(starts % (3 * S), 0);
        assert!(starts >= rest.0 && starts <= (ready_ms * MS + 200 * MS).max(rest.0) + 3 * S, "{starts}");
        let rows = ran.rows();
        let first = rows.iter().position(|row| row.0 >= starts).unwrap();
        let plan = plan(TURNING);
        let scene: Vec<_> = rows[first..].iter().map(|&(t, kind, value)| (t - starts, kind, value)).collect();
        assert_eq!(scene, readings(&plan), "bit for bit");
        let (still, noise) = (plan.trajectory.at(SimTime::ZERO), [0.001, 0.01, 0.1]);
        for (t, kind, value) in &rows[..first] {
            let truth = plan.axes.body_out(crate::player::sensed(*kind, &still_of(&still))).to_array();
            let off = (0..3).map(|i| (value[i] - truth[i]).abs()).fold(0.0, f64::max);
            assert!(off > 0.0 && off < 6.0 * noise[*kind as usize], "{kind} at {t}: {off}");
        }
        for sensor in &plan.sensors {
            let (kind, rate) = (sensor.kind, sensor.rate);
            let ticks: Vec<_> = rows.iter().filter(|row| row.1 == kind).map(|row| row.0).collect();
            let whole = (0..ticks.len() as u64).map(|k| rate.tick(k).0).collect::<Vec<_>>();
            assert_eq!(ticks, whole, "{kind} ticks through the seam as if there were none");
            assert_eq!(
                ran.made.samples[kind as usize],
                ticks.len() as u64,
                "the counts have the rest in them"
            );
        }
        // A request goes out twice a second until it speaks; then it gets a reply.
        let (last, asked) = ran.replies().split_last().map(|(last, asked)| (*last, asked.len())).unwrap();
        assert_eq!((last, asked as i64), ("[hello]", ready_ms.max(1) / 500));
    }
}

/// The truth of a vehicle that does not move.
fn still_of(truth: &crate::motion::Truth) -> crate::motion::Truth {
    crate::motion::Truth { rate: crate::geometry::Vector::ZERO, ..*truth }
}

#[test]
fn before_the_stream_replies_go_out_at_once_and_what_came_is_told() {
    let (plan, shared) = (Arc::new(plan(TURNING)), Arc::new(Shared::before(None)));
    let (mut talk, mut far) = letters(&plan, &shared, Speed::Times(1.0), 1000);
    assert_eq!(talk.silent(), Some(0));
    talk.tick(0);
    talk.tick(10 * MS);
    talk.tick(500 * MS);
    assert_eq!(far.take(), b"[who?]\n[who?]\n", "its own requests");
    assert!(talk.sides[0].what_came().starts_with("nothing came"), "our own questions are not its answers");
    talk.hear(0, b"???", 501 * MS);
    assert!(
        talk.sides[0].what_came().starts_with("3 bytes came and no csv message"),
        "{}",
        talk.sides[0].what_came()
    );
    assert_eq!((talk.sides[0].damaged(), talk.silent()), (3, Some(0)));
    talk.hear(0, b"p", 502 * MS);
    assert!(
        talk.sides[0].what_came().starts_with("1 messages came in 4 bytes"),
        "{}",
        talk.sides[0].what_came()
    );
    talk.hear(0, b"h", 503 * MS);
    assert_eq!((talk.silent(), talk.unready()), (None, Some(0)));
    assert_eq!(far.take(), b"[hello]\n");
    talk.hear(0, b"r", 504 * MS);
    assert_eq!(talk.unready(), None);
    assert_eq!(talk.sides[0].replies(), 3);
}

#[test]
fn a_ground_station_hears_what_is_passed_on_and_its_frames_reach_the_controller_whole() {
    let (plan, shared) = (Arc::new(plan(TURNING)), Arc::new(Shared::before(None)));
    let (mut talk, mut far) = letters(&plan, &shared, Speed::Times(1.0), 1000);
    talk.hear(0, b"p", 0);
    talk.pass_down(b"\xfe\x01abcdefgh");
    let (sender, mut ground) = memory(1000);
    talk.bridge(sender, 0);
    talk.hear(0, b"php", 0);
    assert_eq!(
        ground.take(),
        b"\xfd\0\0\0\0\x01\x01\0\0\0xx\xfd\0\0\0\0\x01\x01\0\0\0xx",
        "and nothing before there was one"
    );
    assert_eq!(far.take(), b"[hello]\n");
    talk.pass_down(b"\xfe\x01abcd7cc\xfe\0abcdcc\xfe\x07half");
    assert_eq!(far.take(), b"\xfe\x01abcd7cc\xfe\0abcdcc");
}

#[test]
fn a_reply_is_written_between_packets_and_cuts_none() {
    // A link that takes 37 bytes a millisecond, less than a line: most packets go out in parts.
    for speed in [Speed::Times(1.0), Speed::Times(3.0)] {
        let mut asked = 0;
        let (ran, _) = live(TURNING, None, speed, false, 37, |ms, _, talk| {
            if ms % 7 == 0 && ms < 600 {
                talk.hear(0, b"h", ms * MS);
                asked += 1;
            }
        });
        let mut before = 0;
        assert!(ran.rows().iter().all(|row| std::mem::replace(&mut before, row.0) <= row.0), "in order");
        assert!(ran.replies().iter().all(|line| *line == "[hello]"), "{:?}", ran.replies());
        assert_eq!(ran.replies().len() as u64, ran.tally.replies, "what is counted arrived");
        assert!(asked > 80 && ran.tally.replies > 60, "{} of {asked}", ran.tally.replies);
        let samples: u64 = ran.tally.sensors.iter().map(|sensor| sensor.sent).sum();
        assert_eq!(ran.rows().len() as u64, samples, "and the stream's own count is its own");
    }
}

/// How long the other side takes for a packet, ms.
const THINKS: i64 = 3;

#[test]
fn in_lockstep_each_packet_waits_for_the_answer_to_the_one_before() {
    let scene = "duration = \"4 s\"\n[gyro]\nrate = \"100 Hz\"\nnoise_std = \"0.01 rad/s\"\n";
    for speed in [Speed::Times(1.0), Speed::Times(20.0), Speed::Max] {
        let (mut seen, mut answered, mut most, mut when) = (0, 0, 0, Vec::new());
        let (ran, shared) = live(scene, None, speed, true, 1 << 20, |ms, text, talk| {
            let lines = text.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit())).count();
            when.extend((seen..lines).map(|_| ms));
            seen = lines;
            // The first thirty stay unanswered; each later one is answered some time after it arrives.
            while answered < seen && (answered < 30 || when[answered] + THINKS <= ms) {
                if answered >= 30 {
                    talk.hear(0, b"t", ms * MS);
                }
                answered += 1;
            }
            if answered > 30 {
                most = most.max(seen - answered);
            }
        });
        assert_eq!(ran.rows().len(), 400, "{speed:?}");
        assert_eq!(ran.tally.dropped, 0);
        assert_eq!(most, 1, "{speed:?}: never two without an answer");
        assert_eq!(shared.untaken.get(), 0);
        // Until the first answer no faster than in real time; then at the requested speed or as fast as the other
        // side allows.
        let free = 310.0;
        let a_packet = match speed {
            Speed::Times(times) => (10.0 / times).max(THINKS as f64 + 1.0),
            Speed::Max => THINKS as f64 + 1.0,
        };
        let expected = free + 50.0 + 369.0 * a_packet;
        let took = ran.end as f64 / MS as f64;
        assert!((took / expected - 1.0).abs() < 0.3, "{speed:?}: {took} ms, {expected} expected");
    }
}

#[test]
fn a_controller_that_stops_answering_is_waited_for_some_seconds_and_then_again_once_it_answers() {
    let scene = "duration = \"9 s\"\n[gyro]\nrate = \"100 Hz\"\nnoise_std = \"0.01 rad/s\"\n";
    for speed in [Speed::Times(1.0), Speed::Max] {
        let (mut answered, mut at_timeout, mut lead) = (0, 0, 0);
        let (ran, shared) = live(scene, None, speed, true, 1 << 20, |ms, text, talk| {
            let seen = text.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit())).count();
            if (100..300).contains(&seen) {
                // Answers nothing for two hundred packets.
                at_timeout = at_timeout.max(usize::from(seen > 101) * 101);
                answered = seen;
                return;
            }
            if seen > 320 {
                lead = lead.max(seen - answered);
            }
            for _ in answered..seen {
                talk.hear(0, b"t", ms * MS);
            }
            answered = seen;
        });
        assert_eq!((ran.rows().len(), ran.tally.dropped), (900, 0), "{speed:?}");
        assert_eq!(shared.untaken.get(), 1, "{speed:?}: told once");
        assert!(lead <= 1, "{speed:?}: in lockstep again, {lead} ahead");
        // Three seconds without an answer, then two hundred packets in real time.
        assert!(ran.end > 3 * S + 2 * S, "{speed:?}: {}", ran.end);
    }
}

#[test]
fn the_pacing_thread_allocates_nothing_while_it_replies_and_keeps_step() {
    let plan = Arc::new(plan(tests::SCENE));
    let shared = Arc::new(Shared::before(None));
    let (mut talk, _far) = letters(&plan, &shared, Speed::Times(1.0), 1 << 20);
    let mut lane = talk.lane(0, &output("csv@pty"));
    talk.hear(0, &[b'h'; 50], 0);
    let took = talk.sides[0].counter();
    let (ring, consumer) = ring::ring(1 << 16);
    tests::produce(&plan, &[output("csv@pty")], ring, &shared);
    // Each packet gets its answer in the next millisecond.
    let (answers, sent) = (took.clone(), shared.clone());
    let world = World { now: 0, act: move |_| answers.store(sent.packets.get(), Ordering::Relaxed) };
    lane.step = Some(Step::new(took));
    let pace = Pace::new(world, Speed::Times(1.0), shared.clone());
    let mut pacer = Pacer::new(pace, consumer, vec![lane]);
    let counted = allocation_counter::measure(|| pacer.run(0));
    assert!(pacer.lanes[0].tally.packets > 2000);
    assert_eq!((pacer.lanes[0].tally.replies, counted.count_total), (50, 0));
}

#[test]
fn estimates_of_the_rest_count_for_nothing_and_those_of_the_scene_are_set_against_its_time() {
    let (ran, _) = live(TURNING, Some(SimTime(2 * S)), Speed::Times(1.0), false, 1 << 20, |ms, _, talk| {
        talk.hear(0, if ms == 1 { b"hr" } else { b"e" }, ms * MS);
        // The rest ends at 3 s, where the scene's first packet is due.
        let expected = (ms > 3000).then_some(SimTime((ms - 3000) * MS));
        assert_eq!(
            talk.newest_arrival(),
            expected.or_else(|| talk.newest_arrival().filter(|_| ms == 3000)),
            "{ms}"
        );
    });
    assert!(ran.end > 4 * S);
}
