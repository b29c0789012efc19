//! The target `betaflight` against its stand-in: samples on one link, words on another.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::thread;
use std::time::Duration;

use ratetable::link::{Address, Endpoint};
use ratetable::scene::{Output, Plan};
use ratetable::score::{self, Align, Figures, Timed};
use ratetable::session::{self, Event, Job};
use ratetable::time::SimTime;
use ratetable::wire::{Controller, Release};
use ratetable_firmware_host_tests::standin::{Betaflight, Build, Clock, Firmware, Make, Program, Settings};
use ratetable_protocols::betaflight::{self, Decoder, state};

use super::memory::{Case, Told, converse_with, exact_deg, own};
use crate::emulator::play::scene;

/// As the target feeds it.
const CASE: Case = Case {
    make: Make::Betaflight,
    to: "betaflight",
    sets: &["gyro.rate=1 kHz", "accel.rate=1 kHz"],
    period_us: 1_000,
    rest_s: 5,
};

/// What the firmware itself reached in `level-then-turn` at 1 kHz, deg RMS (measured), and a tenth more. Most of it is
/// the heading that the gyro's bias turns away: it estimates none.
const BOUND_DEG: f64 = 1.1 * 0.1966;
/// And of that the inclination.
const INCLINATION_DEG: f64 = 1.1 * 0.07516;

type Stream = Vec<(u64, Vec<u8>)>;
type Wrong = fn(&mut state::Repr);

fn talk(plan: &Plan, build: Build, release: Release, alter: impl FnOnce(Stream, u64) -> Stream) -> Told {
    let settings = Settings { build, ..Settings::default() };
    converse_with(&CASE, plan, Some(Controller::Betaflight(release)), &settings, alter)
}

/// The judgement of a run with the target: one constant heading is taken out.
fn judge(plan: &Plan, said: &[Timed]) -> Figures {
    let truth = |t: SimTime| Some(plan.trajectory.at(t.max(SimTime::ZERO)).attitude);
    let options = score::Options { until: plan.duration, align: Align::Heading, ..score::Options::default() };
    score::judge(&truth, said, &options).expect("estimates").figures
}

/// The same packets with something of their state changed.
fn changed(stream: Stream, mut change: impl FnMut(usize, &mut state::Repr)) -> Stream {
    let change = |(k, (at, packet)): (usize, (u64, Vec<u8>))| {
        let mut state = state::Repr::parse(&state::Payload::new_checked(&packet).unwrap());
        change(k, &mut state);
        let mut bytes = [0; betaflight::MAX_LEN];
        betaflight::encode(&state, &mut bytes).unwrap();
        (at, bytes.to_vec())
    };
    stream.into_iter().enumerate().map(change).collect()
}

fn short(duration: &str) -> Arc<Plan> {
    scene("level-then-turn", &["gyro.rate=1 kHz", "accel.rate=1 kHz", duration])
}

#[test]
fn it_follows_as_closely_as_the_firmware_did_and_its_answers_are_read_right() {
    let plan = CASE.plan();
    let told = talk(&plan, Build::default(), Release::default(), |stream, _| stream);
    assert!(told.ready && told.notices.is_empty(), "{:?}", told.notices);
    let counts = told.record.counts;
    assert_eq!((counts.damaged, counts.stale, counts.foreign), (0, 0, 0), "{counts}");
    let own = judge(&plan, &own(&told.record, told.scene_us));
    let answers = judge(&plan, &told.answers);
    for figures in [&own, &answers] {
        eprintln!(
            "betaflight: {:.4} deg RMS, inclination {:.4}, heading {:.4}, {} of them, delay {:?} ms",
            figures.errors.rms_deg,
            figures.errors.inclination_rms_deg,
            figures.errors.heading_rms_deg,
            figures.samples,
            figures.delay_ms
        );
        assert!(figures.errors.rms_deg <= BOUND_DEG && figures.looks.is_none(), "{figures:?}");
        assert!(figures.errors.inclination_rms_deg <= INCLINATION_DEG, "{figures:?}");
    }
    assert!(answers.samples > 40 * 50, "{}", answers.samples);
}

#[test]
fn a_false_attitude_in_the_packets_changes_no_estimate() {
    let plan = short("duration=16 s");
    let honest = talk(&plan, Build::default(), Release::default(), |stream, _| stream);
    let lied_to = talk(&plan, Build::default(), Release::default(), |stream, _| {
        changed(stream, |_, state| state.orientation = [0.5; 4])
    });
    assert!(lied_to.record.counts.foreign > 10_000 && honest.record.counts.foreign == 0);
    assert_eq!(honest.record.history, lied_to.record.history);
}

/// Negative controls: what one release takes is wrong for another, and readings with a mistake do not pass.
#[test]
fn wrong_readings_do_not_pass() {
    let plan = short("duration=30 s");
    let wrong: [(&str, Wrong); 5] = [
        ("the other sign about the vertical", |state| state.gyro[2] = -state.gyro[2]),
        ("accel x the other way round", |state| state.accel[0] = -state.accel[0]),
        ("accel y the other way round", |state| state.accel[1] = -state.accel[1]),
        ("gyro x and y swapped", |state| state.gyro.swap(0, 1)),
        ("gyro 5 % too great", |state| state.gyro = state.gyro.map(|rate| rate * 1.05)),
    ];
    for (what, wrong) in wrong {
        let told = talk(&plan, Build::default(), Release::default(), |stream, _| {
            changed(stream, |_, state| wrong(state))
        });
        let figures = judge(&plan, &own(&told.record, told.scene_us));
        assert!(figures.errors.rms_deg > 2.0 * BOUND_DEG, "{what}: {}", figures.errors.rms_deg);
    }
}

/// Packets come unevenly by up to half a millisecond. With true times in them the firmware takes that for its clock's
/// rate, and so turns too far; a constant time leaves the clock alone.
#[test]
fn true_times_on_packets_that_come_unevenly_make_its_clock_run_fast() {
    let plan = short("duration=30 s");
    let uneven = |stream: Stream, stamped: bool| {
        let shift = |k: usize| [0, 300, 100, 450, 50, 350][k % 6];
        let late = changed(stream.clone(), |k, state| {
            state.timestamp = if stamped { stream[k].0 as f64 * 1e-6 } else { 0.0 };
        });
        late.into_iter().enumerate().map(|(k, (at, packet))| (at + shift(k), packet)).collect::<Stream>()
    };
    let [constant, stamped] = [false, true].map(|stamped| {
        let told = talk(&plan, Build::default(), Release::default(), |stream, _| uneven(stream, stamped));
        judge(&plan, &own(&told.record, told.scene_us)).errors.heading_rms_deg
    });
    eprintln!("heading with constant times {constant:.3} deg, with true ones {stamped:.3}");
    assert!(constant < BOUND_DEG, "{constant}");
    assert!(stamped > 10.0 * constant, "{stamped}");
}

#[test]
fn a_boot_that_went_wrong_is_told_from_one_that_went_well_and_is_not_fed() {
    let plan = short("duration=1 s");
    let well = Build::default();
    for (build, release, part) in [
        (Build { msp: false, ..well }, Release::Y2026M6, "no answer to MSP"),
        (Build { gyro: false, ..well }, Release::Y2026M6, "gyro does not answer"),
        (Build { gazebo: false, ..well }, Release::Y2026M6, "2026.6-legacy"),
        (Build { version: [25, 12], ..well }, Release::Y2026M6, "2025.12"),
    ] {
        let told = talk(&plan, build, release, |_, _| Vec::new());
        let [notice] = &told.notices[..] else { panic!("{part}: {:?}", told.notices) };
        assert!(notice.contains(part) && !told.ready, "{notice}");
    }
    let legacy = talk(&plan, Build { gazebo: false, ..well }, Release::Y2026M6Legacy, |stream, _| stream);
    assert!(legacy.ready && legacy.notices.is_empty(), "{:?}", legacy.notices);
}

#[test]
fn a_release_without_an_estimator_has_the_packets_attitude_and_no_score() {
    let plan = short("duration=16 s");
    for (release, version) in [(Release::Y2025M12, [25, 12]), (Release::V4M5, [4, 5])] {
        let told = talk(&plan, Build { version, ..Build::default() }, release, |stream, _| stream);
        assert!(told.ready && told.answers.is_empty(), "{release}");
        assert!(told.notices[0].contains("there is no score"), "{:?}", told.notices);
        let (rms, _) = exact_deg(&plan, &told.record, told.scene_us);
        assert!(rms < 1e-6, "{release}: {rms}: it is the truth itself");
    }
}

#[test]
fn only_whole_datagrams_are_taken_a_silence_costs_the_next_and_the_last_rate_goes_on() {
    let mut firmware = Betaflight::new(&Settings::default());
    let mut bytes = [0; betaflight::MAX_LEN];
    let turn = state::Repr { gyro: [0.0, 0.0, -0.5], ..state::Repr::LEVEL };
    betaflight::encode(&turn, &mut bytes).unwrap();
    let mut out = Vec::new();
    for (at_us, len) in [(0, 144), (1_000, 143), (2_000, 136), (3_000, 144), (600_000, 144)] {
        firmware.receive(&bytes[..len], at_us, &mut out);
    }
    let counts = firmware.record().counts;
    assert_eq!((counts.samples, counts.damaged, counts.refused), (1, 2, 2), "{counts}");
    let yaw = |firmware: &Betaflight| {
        let [w, _, _, z] = firmware.record().history.last().unwrap().attitude;
        2.0 * z.atan2(w).to_degrees()
    };
    // Half a radian a second, in silence too.
    firmware.turn(1_003_000, &mut out);
    assert!((firmware.rate_dps()[2] - 28.6).abs() < 0.1, "{:?}", firmware.rate_dps());
    firmware.receive(&bytes, 1_050_000, &mut out);
    assert!((yaw(&firmware) - 0.5_f64.to_degrees() * 1.047).abs() < 0.2, "{}", yaw(&firmware));
    betaflight::encode(&state::Repr::LEVEL, &mut bytes).unwrap();
    firmware.receive(&bytes, 1_051_000, &mut out);
    assert_eq!(firmware.rate_dps(), [0.0; 3]);
}

/// Still, a roll, a turn, still.
const SHORT: &str = "seed = 5\n[[motion]]\nkind = \"hold\"\nduration = \"1 s\"\n[[motion]]\nkind = \"rotate\"\n\
    roll = \"30 deg/s\"\nduration = \"1 s\"\n[[motion]]\nkind = \"rotate\"\nyaw = \"30 deg/s\"\nduration = \"1 s\"\n\
    [gyro]\nrate = \"1 kHz\"\n[accel]\nrate = \"1 kHz\"\n";

#[test]
fn over_udp_and_tcp_in_real_time_it_is_spoken_with_fed_scored_and_left_at_rest() {
    let plan = Arc::new(Plan::parse(SHORT, "short", "short", &[]).unwrap_or_else(|error| panic!("{error}")));
    let settings = Settings::default();
    let firmware = Box::new(Betaflight::new(&settings));
    let mut program = Program::open("127.0.0.1:0:0", firmware, Clock::wall(1.0)).expect("two ports");
    let [samples, words] = program.places().expect("two ports");
    let mut output = Output::to(format!("betaflight@udpout:{samples}").parse().expect("a destination"));
    output.to.answers = Some(Address::TcpOut(Endpoint::new("127.0.0.1", words.port())));
    let ran = thread::spawn(move || {
        program.run(&AtomicBool::new(false)).expect("sockets");
        program.record().clone()
    });
    let mut job = Job { wait: Duration::from_secs(30), ..Job::new(plan, vec![output]) };
    job.judging.align = Align::Heading;
    let mut notices = Vec::new();
    let outcome = session::run(job, &mut |event| {
        if let Event::Notice(notice) = event {
            notices.push(notice.clone());
        }
    })
    .expect("a run");
    let record = ran.join().expect("it ends when its client leaves");
    let told = outcome.attitude.as_ref().expect("answers");
    eprintln!("betaflight over sockets: {told:?}; {}; {notices:?}", record.counts);
    // A wrong axis or sign would be tens of degrees; a host that stands still costs some.
    assert!(told.errors.rms_deg < 3.0 && told.looks.is_none() && told.samples > 60, "{told:?}");
    assert!(outcome.rest_s >= 5.0 && outcome.links[0].replies > 60, "{outcome:?}");
    // What is sent ahead and at the end is no part of the stream.
    let [made, sent] = [outcome.links[0].made, outcome.links[0].sent];
    assert!(made == sent && record.counts.packets > sent, "{made} {sent} {}", record.counts);
}

/// The decoder of a stream sees the same packets as the firmware's datagrams.
#[test]
fn the_stream_reads_back_as_packets() {
    let plan = short("duration=1 s");
    let mut packets = 0;
    talk(&plan, Build::default(), Release::default(), |stream, _| {
        let mut decoder = Decoder::new();
        stream
            .iter()
            .for_each(|(_, bytes)| decoder.feed(bytes, |state| packets += usize::from(state.is_ok())));
        assert_eq!(packets, stream.len());
        stream
    });
    assert_eq!(packets, 6000);
}
