use super::ledger::{Ledger, Peaks};
use super::reader::Arrival;
use crate::scene::Plan;
use crate::sensor::SensorKind::{self, Accel, Gyro};
use crate::session::Record;
use crate::time::SimTime;

const SCENE: &str = "duration = \"1 s\"\n[gyro]\nrate = \"8 kHz\"\n[accel]\nrate = \"300 Hz\"\n";
const SLICE: SimTime = SimTime(1_000_000);

fn ledger(receives: bool) -> Ledger {
    Ledger::new(&Plan::parse(SCENE, "test", "test", &[]).unwrap(), receives, SLICE, 0)
}

/// Due 1 s on the clock after its time in the scene, written 200 ns late.
fn sample(kind: SensorKind, t: i64) -> Record {
    let due = t + 1_000_000_000;
    Record::Sample { kind, t: SimTime(t), due, sent: Some(due + 200) }
}

/// There 5 µs after it was due, its time in whole µs.
fn arrival(kind: SensorKind, t: i64) -> Arrival {
    Arrival { kind, t: SimTime(t / 1000 * 1000), at: t + 1_000_005_000 }
}

#[test]
fn each_arrival_finds_its_sample_and_what_did_not_arrive_is_missed() {
    let mut ledger = ledger(true);
    for k in [0, 1, 2, 3, 4] {
        ledger.record(sample(Gyro, k * 125_000));
    }
    // The one at 250 µs is lost, the accelerometer's tick 1 (3 333 333 ns) is there before its record.
    for t in [0, 125_000, 375_000] {
        ledger.arrival(arrival(Gyro, t));
    }
    ledger.arrival(arrival(Accel, 3_333_333));
    ledger.settle();
    ledger.record(sample(Accel, 3_333_333));
    ledger.settle();
    assert_eq!((ledger.sensors[0].received, ledger.sensors[0].missed), (3, 1), "one may still come");
    ledger.end();
    assert_eq!((ledger.sensors[0].received, ledger.sensors[0].missed), (3, 2));
    assert_eq!((ledger.sensors[1].received, ledger.sensors[1].missed), (1, 0));
    let transit = ledger.sensors[0].transit.spread().unwrap();
    assert!((transit.p50 - 4.8).abs() < 0.01, "{transit:?}");
    let lines = ledger.lines();
    for line in [
        "gyro,0,1000000000,1000000200,1000005000\n",
        "gyro,2,1000250000,1000250200,\n",
        "gyro,4,1000500000,1000500200,\n",
        "accel,1,1003333333,1003333533,1003338333\n",
    ] {
        assert!(lines.contains(line), "{line} in\n{lines}");
    }
    assert_eq!(lines.lines().count(), 6);
}

#[test]
fn a_value_held_over_from_an_earlier_packet_is_no_arrival() {
    let mut ledger = ledger(true);
    for t in [0, 125_000] {
        ledger.record(sample(Accel, t));
    }
    for t in [0, 0, 125_000, 125_000] {
        ledger.arrival(arrival(Accel, t));
    }
    ledger.end();
    assert_eq!((ledger.sensors[1].received, ledger.sensors[1].missed), (2, 0));
}

#[test]
fn a_sample_that_the_link_refused_has_no_time_and_is_missed() {
    let mut ledger = ledger(true);
    ledger.record(Record::Sample { kind: Gyro, t: SimTime(0), due: 7, sent: None });
    ledger.end();
    assert_eq!(ledger.sensors[0].missed, 1);
    assert_eq!(ledger.lines(), "gyro,0,7,,\n");
}

#[test]
fn without_a_receiver_nothing_waits_and_nothing_is_missed() {
    let mut ledger = ledger(false);
    ledger.record(sample(Gyro, 0));
    ledger.record(Record::Wake { k: 9, due: 100, woke: 150 });
    assert_eq!(ledger.lines(), "gyro,0,1000000000,1000000200,\nbaseline,9,100,150,\n");
    ledger.end();
    assert_eq!((ledger.sensors[0].missed, ledger.sensors[0].received_hz()), (0, None));
}

#[test]
fn the_received_rate_leaves_out_what_lies_between_slices() {
    let mut ledger = ledger(true);
    // Half a slice and a whole one, of a millisecond, half a second apart on the clock.
    for k in 0..12 {
        let t = k * 125_000;
        ledger.record(sample(Gyro, t));
        let gap = if t >= SLICE.0 / 2 { 500_000_000 } else { 0 };
        ledger.arrival(Arrival { at: t + gap, ..arrival(Gyro, t) });
    }
    ledger.end();
    assert!((ledger.sensors[0].received_hz().unwrap() / 8000.0 - 1.0).abs() < 1e-9);
}

#[test]
fn a_sample_a_whole_period_late_is_overdue() {
    let mut ledger = ledger(true);
    for late in [125_000, 125_001, 400_000] {
        ledger.record(Record::Sample { kind: Gyro, t: SimTime(late), due: 0, sent: Some(late) });
    }
    assert_eq!(ledger.sensors[0].overdue, 2);
}

#[test]
fn what_is_on_its_way_for_ever_takes_no_memory_for_ever() {
    let mut ledger = ledger(true);
    for k in 0..200_000 {
        ledger.record(sample(Gyro, k * 125_000));
        if k % 1000 == 0 {
            ledger.settle();
            ledger.lines();
        }
    }
    assert!(ledger.sensors[0].missed > 130_000);
    ledger.end();
    assert_eq!(ledger.sensors[0].missed, 200_000);
}

#[test]
fn peaks_of_a_run_of_any_length_are_a_thousand_at_most_and_lose_no_maximum() {
    let mut peaks = Peaks::new(0);
    for ms in 0..100_000i64 {
        peaks.add(ms * 1_000_000, if ms == 70_001 { 9.0 } else { 1.0 });
    }
    let (x, y) = peaks.points();
    assert!((500..=1000).contains(&y.len()), "{}", y.len());
    let top = y.iter().position(|&y| y == 9.0).unwrap();
    assert!((x[top] - 70.001).abs() <= peaks.width_ms() / 1000.0);
    assert!(y.iter().all(|&y| y >= 1.0));
}
