//! Real time over a pty: every sample is accounted for, whatever the machine was busy with.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use ratetable::report::SensorReport;
use ratetable::scene::Plan;
use ratetable::session::{Event, Outcome, Speed};
use ratetable_firmware_host_tests::{Board, Options, Protocol, Report, Step};

use crate::emulator::play::{play, play_and_tell, scene};

/// Every sample of the scene was sent, dropped or left in the queue.
fn check_identity(plan: &Plan, outcome: &Outcome) {
    for (sensor, of) in outcome.sensors.iter().zip(&plan.sensors) {
        let SensorReport { name, made, sent, dropped, queued, .. } = sensor;
        assert_eq!(*made, sent + dropped + queued, "{name}");
        assert_eq!(*made, of.rate.ticks_before(of.phase, plan.duration), "{name}: all ticks of the scene");
    }
}

/// What was sent is what arrived, and what did not arrive was reported as dropped.
fn check_arrivals(outcome: &Outcome, report: &Report) {
    let counts = report.counts;
    let arrived = [counts.gyro, counts.accel, counts.mag];
    let sent: Vec<u64> = outcome.sensors.iter().map(|sensor| sensor.sent).collect();
    assert_eq!(sent, arrived, "samples");
    let link = &outcome.links[0];
    assert_eq!((counts.packets, counts.damaged, counts.skipped), (link.packets, 0, 0));
    // Numbers have eight bits: of a longer gap they tell the length modulo 256.
    assert_eq!(
        counts.lost % 256,
        link.dropped % 256,
        "packets lost by their numbers, of {} dropped",
        link.dropped
    );
}

fn board(path: &str, protocol: Protocol) -> Board {
    Board::open(path, protocol, Options { quiet: None, ..Options::default() }).expect("a board")
}

#[test]
fn what_is_made_is_sent_dropped_or_queued_and_what_is_sent_arrives() {
    for protocol in [Protocol::Mpu, Protocol::Mavlink] {
        let plan = scene("manoeuvre", &["duration=1 s"]);
        let (outcome, report) = play(&plan, &format!("{protocol}@pty"), Speed::Times(1.0), move |path| {
            board(path, protocol).run(&AtomicBool::new(false)).expect("a link")
        });
        check_identity(&plan, &outcome);
        check_arrivals(&outcome, &report);
    }
}

/// A board that reads for a moment, then does something else until it is woken, then reads on.
fn absent_for_a_while(path: &str, protocol: Protocol, wake: &AtomicBool) -> Report {
    let mut board = board(path, protocol);
    while board.report().span_us.is_none_or(|(_, newest_us)| newest_us < 100_000) {
        assert_ne!(board.step(Duration::from_secs(1)).expect("a link"), Step::Closed);
    }
    while !wake.load(Ordering::Relaxed) {
        thread::sleep(Duration::from_millis(1));
    }
    board.run(&AtomicBool::new(false)).expect("a link")
}

#[test]
fn a_board_that_does_not_read_for_a_while_loses_exactly_what_is_reported_as_dropped() {
    for protocol in [Protocol::Mpu, Protocol::Mavlink] {
        // Its buffers, the kernel's, hold some 20 kB: less than a second of this.
        let plan = scene("still", &["duration=3 s"]);
        let wake = Arc::new(AtomicBool::new(false));
        let (woken, full) = (wake.clone(), move |event: &Event<'_>| {
            if let Event::Progress(progress) = event {
                wake.fetch_or(progress.dropped > 0, Ordering::Relaxed);
            }
        });
        let to = format!("{protocol}@pty");
        let absent = move |path: &str| absent_for_a_while(path, protocol, &woken);
        let (outcome, report) = play_and_tell(&plan, &to, Speed::Times(1.0), absent, full);
        check_identity(&plan, &outcome);
        check_arrivals(&outcome, &report);
        assert!(outcome.links[0].dropped > 0 && report.counts.lost > 0, "it was away for long enough");
    }
}
