//! The emulator's own session against stand-ins on ptys and loopback TCP, opened by path.

use std::net::TcpStream;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use ratetable::scene::{Destination, Plan};
use ratetable::session::{Event, Outcome, Speed};
use ratetable::time::SimTime;
use ratetable_firmware_host_tests::board::{Device, Port};
use ratetable_firmware_host_tests::standin::{Clock, Make, Record, Settings, StandIn};

use super::follow::{BOUND_DEG, bound_deg, is_late};
use super::memory::{CASES, Case, exact_deg, judge, own, settings};
use crate::emulator::play::play_after;

/// Opens what the emulator is on: a port by its path, or a connection.
fn open(make: Make, place: &str) -> Box<dyn Port + Send> {
    match make {
        Make::Px4Sitl => {
            let address = place.strip_prefix("tcpin:").unwrap_or(place);
            Box::new(Device::from(TcpStream::connect(address).expect("a connection")))
        }
        _ => Box::new(Device::open(Path::new(place), None).expect("a port")),
    }
}

/// Plays a plan to a case's stand-in; gives back what both sides say of it, and the emulator's notices.
fn play(case: &Case, plan: &Arc<Plan>, speed: Speed) -> (Outcome, Record, Vec<String>) {
    let rest = case.to.parse::<Destination>().expect("a destination").target.map(|target| target.rest);
    let (make, period_us, settings) = (case.make, case.period_us, settings(case, plan));
    let standin = move |place: &str| {
        let clock = match speed {
            Speed::Max => Clock::even(period_us, make.framing()),
            Speed::Times(times) => Clock::wall(times),
        };
        let mut standin = StandIn::new(open(make, place), make.firmware(&settings), clock);
        standin.run(&AtomicBool::new(false)).expect("a link");
        // Faster than real time so is what it says, and the way back may be full.
        assert!(speed == Speed::Max || standin.unsaid() == 0, "the emulator listens");
        standin.record().clone()
    };
    let mut notices = Vec::new();
    let (outcome, record) = play_after(rest, plan, case.to, speed, standin, |event| {
        if let Event::Notice(notice) = event {
            notices.push(notice.clone());
        }
    });
    (outcome, record, notices)
}

/// Every sample that was made arrived and was used.
fn check_counts(case: &Case, outcome: &Outcome, record: &Record) {
    let counts = record.counts;
    let whole =
        (counts.damaged, counts.lost, counts.overflowed, counts.stale, counts.timeouts, counts.refused);
    assert_eq!(whole, (0, 0, 0, 0, 0, 0), "{}: {counts}", case.make);
    for sensor in &outcome.sensors {
        assert_eq!((sensor.made, 0, 0), (sensor.sent, sensor.dropped, sensor.queued), "{}", sensor.name);
    }
}

/// As fast as the stand-in reads, beside a link that delivers evenly: nothing depends on how busy the machine is.
fn follows(make: Make) {
    let case = Case::of(make);
    let plan = case.plan();
    let (outcome, record, notices) = play(case, &plan, Speed::Max);
    check_counts(case, &outcome, &record);
    let first_us = record.history.first().expect("estimates").t_us;
    let scene_us = first_us + (outcome.rest_s * 1e6).round() as u64;
    let figures = judge(&plan, &own(&record, scene_us));
    let (rms, max) = exact_deg(&plan, &record, scene_us);
    eprintln!(
        "{make} on a link after {} s at rest: own {:.4} deg RMS, {rms:.4} and {max:.3} at exact times; told: {:?}; \
         notices: {notices:?}",
        outcome.rest_s, figures.errors.rms_deg, outcome.attitude
    );
    assert!(figures.errors.rms_deg < bound_deg(make), "{make}: {figures:?}");
    assert!(rms < bound_deg(make) || is_late(make), "{make}: {rms}");
    let target = case.to.parse::<Destination>().expect("a destination").target;
    assert!(target.is_none_or(|target| outcome.rest_s >= target.rest.0 as f64 * 1e-9), "{make}");
}

#[test]
fn px4_on_a_pty_follows() {
    follows(Make::Px4);
}

#[test]
fn px4_as_a_program_follows_in_lockstep_over_tcp() {
    follows(Make::Px4Sitl);
}

#[test]
fn ardupilot_on_a_pty_follows() {
    follows(Make::Ardupilot);
}

#[test]
fn ardupilot_with_a_microstrain_unit_on_a_pty_follows() {
    follows(Make::ArdupilotMip);
}

#[test]
fn ardupilot_with_an_inertial_labs_unit_on_a_pty_follows() {
    follows(Make::ArdupilotIlabs);
}

#[test]
fn ardupilot_with_an_sbg_systems_unit_on_a_pty_follows() {
    follows(Make::ArdupilotSbg);
}

#[test]
fn px4_with_an_inertial_labs_unit_on_a_pty_follows() {
    follows(Make::Px4Ilabs);
}

#[test]
fn inav_on_a_pty_follows() {
    follows(Make::Inav);
}

/// Still, a roll, still, read by the parts that `level-then-turn` has.
const SHORT: &str = "seed = 5\n[[motion]]\nkind = \"hold\"\nduration = \"1.5 s\"\n[[motion]]\nkind = \"rotate\"\n\
    roll = \"30 deg/s\"\nduration = \"1 s\"\n[[motion]]\nkind = \"hold\"\nduration = \"0.5 s\"\n\
    [gyro]\npart = \"MPU-9250\"\nrate = \"100 Hz\"\nsampling = \"average\"\nbias = \"[0.02, -0.02, 0.01] deg/s\"\n\
    scale_error = \"0 %\"\nmisalignment = \"0 deg\"\nnonlinearity = \"0 %\"\n\
    [accel]\npart = \"MPU-9250\"\nrate = \"100 Hz\"\nbias = \"[0.5, -0.5, 1] mg\"\n\
    scale_error = \"0 %\"\nmisalignment = \"0 deg\"\nnonlinearity = \"0 %\"\n\
    [mag]\npart = \"MPU-9250\"\nrate = \"50 Hz\"\nbias = \"[0, 0, 0] uT\"\n";

/// The angular rate of its turn, deg/s.
const RATE_DPS: f64 = 30.0;

#[test]
fn in_real_time_who_stamps_on_arrival_is_off_by_what_arrives_unevenly_and_no_more() {
    let plan = Arc::new(Plan::parse(SHORT, "short", "short", &[]).unwrap_or_else(|error| panic!("{error}")));
    for case in CASES.iter().filter(|case| matches!(case.make, Make::Px4 | Make::Ardupilot)) {
        let (outcome, record, notices) = play(case, &plan, Speed::Times(1.0));
        let counts = record.counts;
        let sent: u64 = outcome.sensors[0].sent;
        assert!(counts.samples >= sent && counts.refused == 0, "{}: {sent} sent, {counts}", case.make);
        let rest_us = (outcome.rest_s * 1e6).round() as u64;
        // How much later than the sender's times samples arrived, at the least and at the most.
        let scene: Vec<_> =
            record.history.iter().filter(|m| m.said_us.is_some_and(|us| us >= rest_us)).collect();
        let late: Vec<i64> = scene.iter().map(|m| m.t_us as i64 - m.said_us.unwrap_or(0) as i64).collect();
        let (least, most) = (late.iter().min().unwrap_or(&0), late.iter().max().unwrap_or(&0));
        let uneven_s = (most - least) as f64 * 1e-6;
        let errors: Vec<f64> = scene
            .iter()
            .map(|m| {
                let t = SimTime((m.said_us.unwrap_or(0) - rest_us) as i64 * 1000);
                let [w, x, y, z] = m.attitude;
                let estimate = ratetable::geometry::Attitude::from_quat(glam::DQuat::from_xyzw(x, y, z, w));
                estimate.angle_to(plan.trajectory.at(t.min(plan.duration)).attitude).to_degrees()
            })
            .collect();
        let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
        let bound = BOUND_DEG + RATE_DPS * uneven_s;
        eprintln!(
            "{} in real time: {rms:.3} deg RMS, uneven by {uneven_s:.4} s; {counts}; {notices:?}",
            case.make
        );
        assert!(errors.len() > 200, "{}: {} estimates", case.make, errors.len());
        if case.make == Make::Px4 {
            // A wrong axis or sign of its answers would be tens of degrees; a delay that is not told, tenths.
            let told = outcome.attitude.expect("answers");
            assert!(
                told.samples > 100 && told.errors.rms_deg < 2.0 + bound && told.looks.is_none(),
                "{told:?}"
            );
        }
        assert!(rms < bound, "{}: {rms} deg, and {uneven_s} s uneven allow {bound}", case.make);
    }
}

/// Boots a case's firmware a second time, asking for twice as many samples, once it has had some hundreds.
fn restart(case: &Case) -> (Outcome, Record, Vec<String>) {
    let times = 4.0;
    let plan = Arc::new(Plan::load("still", &["duration=20 s".to_owned()]).unwrap());
    let (make, settings) = (case.make, settings(case, &plan));
    let standin = move |place: &str| {
        let mut standin = StandIn::new(open(make, place), make.firmware(&settings), Clock::wall(times));
        standin.run_until(|record| record.counts.samples >= 700).expect("a link");
        let faster = Settings { rate_hz: 2 * settings.rate_hz, ..settings.clone() };
        let before = standin.reboot(make.firmware(&faster));
        assert!(before.counts.samples >= 700 && before.counts.refused == 0, "{}", before.counts);
        standin.run(&AtomicBool::new(false)).expect("a link");
        standin.record().clone()
    };
    let mut notices = Vec::new();
    let rest = Some(SimTime(1_000_000_000));
    let (outcome, record) = play_after(rest, &plan, case.to, Speed::Times(times), standin, |event| {
        if let Event::Notice(notice) = event {
            notices.push(notice.clone());
        }
    });
    (outcome, record, notices)
}

#[test]
fn a_controller_that_boots_again_and_asks_for_another_rate_gets_it() {
    for make in [Make::Ardupilot, Make::Px4Vectornav] {
        let case = Case::of(make);
        let (outcome, record, notices) = restart(case);
        let asked = &outcome.links[0].asked;
        let hz = 2e6 / case.period_us as f64;
        assert_eq!(asked.iter().map(|asked| asked.hz).collect::<Vec<_>>(), [hz], "{make}");
        assert!(notices.iter().any(|notice| notice.contains(&format!("at {hz} Hz"))), "{make}: {notices:?}");
        let at_us = (asked[0].at_s * 1e6).round() as u64;
        let said: Vec<u64> = record.history.iter().filter_map(|moment| moment.said_us).collect();
        let new: Vec<u64> = said.into_iter().filter(|&us| us >= at_us).collect();
        eprintln!(
            "{make}: {hz} Hz from {} s on, {} samples at that; {}",
            asked[0].at_s,
            new.len(),
            record.counts
        );
        assert!(new.len() > 400, "{make}: {}", record.counts);
        // One that was lost on a busy machine leaves a gap of whole periods; the last packet is the farewell.
        let steps = new[..new.len() - 1].windows(2).map(|pair| pair[1] - pair[0]);
        assert!(steps.clone().all(|step| step.is_multiple_of(case.period_us / 2)), "{make}");
        assert!(steps.filter(|&step| step == case.period_us / 2).count() > 300, "{make}");
    }
}

#[test]
fn px4_with_a_vectornav_unit_on_a_pty_follows() {
    follows(Make::Px4Vectornav);
}

#[test]
fn in_real_time_inav_at_rest_is_told_level() {
    let case = Case::of(Make::Inav);
    let sets: Vec<String> = case.sets.iter().copied().chain(["duration=2 s"]).map(str::to_owned).collect();
    let plan = Arc::new(Plan::load("level-then-turn", &sets).unwrap());
    // Twenty seconds of rest in two. At rest nothing depends on when a message comes; what is told is in steps of 0.1°.
    let (outcome, record, _) = play(case, &plan, Speed::Times(10.0));
    let told = outcome.attitude.expect("answers");
    eprintln!("inav ten times as fast: {told:?}; {}", record.counts);
    assert!(told.errors.inclination_rms_deg < 0.3 && told.errors.heading_rms_deg < 1.0, "{told:?}");
    assert!(outcome.rest_s >= 20.0 && record.counts.samples > 0);
}
