//! The comparison with a bare timer, and clocks that misbehave.

use super::feed::Made;
use super::pacer::Pacer;
use super::tests::{SCENE, accounts_balance, made, memory, pacer, plan, reports};
use super::watch::Watching;
use super::*;
use crate::clock::{Clock, Policy, Precise, VirtualClock, WallClock};
use crate::sensor::SensorKind;
use crate::time::{Rate, SimTime};
use std::sync::Arc;
use std::sync::atomic::Ordering;

const MILLI: i64 = 1_000_000;

/// A second of the scene, with a slice of the bare timer every 100 ms, and its records.
fn watched(clock: VirtualClock) -> (Pacer<VirtualClock>, Vec<Record>, Vec<u8>) {
    let (plan, shared) = (plan(SCENE), Arc::<Shared>::default());
    let (ring, made) = made(&plan, "mpu@pty", &shared);
    let (sender, mut far) = memory(1 << 20);
    let (records, mut recorded) = rtrb::RingBuffer::new(1 << 16);
    let mut pacer = pacer(clock, ring, sender, Speed::Times(1.0), &shared);
    let bare = BareTimer { slice: SimTime(100 * MILLI), rate: Rate::hz(1000) };
    pacer.pace.watching = Some(Watching::new(Watch { clock: WallClock::start(), bare: Some(bare), records }));
    let counted = allocation_counter::measure(|| pacer.run(MILLI));
    assert_eq!(counted.count_total, 0);
    accounts_balance(&made, &mut pacer);
    assert_eq!(shared.stream_ns.load(Ordering::Relaxed), 999 * MILLI, "scene time is that of a run alone");
    let records = std::iter::from_fn(|| recorded.pop().ok()).collect();
    (pacer, records, far.take())
}

fn alone() -> Vec<u8> {
    let (plan, shared) = (plan(SCENE), Arc::<Shared>::default());
    let (ring, _) = made(&plan, "mpu@pty", &shared);
    let (sender, mut far) = memory(1 << 20);
    pacer(VirtualClock::default(), ring, sender, Speed::Times(1.0), &shared).run(0);
    far.take()
}

/// Scene time, due and sent of the gyro's samples.
fn gyro(records: &[Record]) -> Vec<(i64, i64, i64)> {
    let sample = |record: &Record| match *record {
        Record::Sample { kind: SensorKind::Gyro, t, due, sent } => Some((t.0, due, sent?)),
        _ => None,
    };
    records.iter().filter_map(sample).collect()
}

#[test]
fn slices_of_the_bare_timer_change_no_byte_and_take_no_scene_time() {
    let (pacer, records, bytes) = watched(VirtualClock::waking_late([0, 3_000]));
    assert_eq!(bytes, alone());
    let gyro = gyro(&records);
    assert_eq!(gyro.len(), 1000);
    for pair in gyro.windows(2) {
        let [before, after] = [pair[0], pair[1]];
        let apart = after.1 - before.1;
        match after.0 % (100 * MILLI) {
            // Between two slices lie 100 wake-ups of the bare timer.
            t if t == 50 * MILLI => assert!((100 * MILLI..110 * MILLI).contains(&apart), "{apart}"),
            _ => assert_eq!(apart, after.0 - before.0),
        }
        assert!(after.2 >= after.1, "none is early");
    }
    let seen = pacer.pace.watching.unwrap().seen;
    assert_eq!((seen.late.count(), seen.unrecorded), (1050, 0), "as much of the one as of the other");
}

#[test]
fn rates_and_intervals_leave_the_bare_timers_slices_out() {
    let (mut pacer, ..) = watched(VirtualClock::default());
    let report = &reports(&plan(SCENE), &mut pacer, Made::default());
    for (sensor, hz, intervals) in [(0, 1000.0, 1_000.0), (2, 100.0, 10_000.0)] {
        assert!((report[sensor].sent_hz.unwrap() / hz - 1.0).abs() < 1e-9, "{:?}", report[sensor]);
        let interval = report[sensor].interval_us.unwrap();
        assert!((interval.max / intervals - 1.0).abs() < 2e-3 && interval.std < 0.01 * intervals);
    }
}

#[test]
fn the_bare_timer_is_as_late_as_the_clock_and_a_wake_later_than_a_period_is_counted() {
    let (pacer, records, _) = watched(VirtualClock::waking_late([20_000]));
    let late = pacer.pace.watching.unwrap().seen.late;
    let report = late.late().unwrap();
    assert!((report.p50 - 20.0).abs() < 0.02 && (report.max - 20.0).abs() < 0.02, "{report:?}");
    assert_eq!(late.above(MILLI), 0);
    let wakes: Vec<_> = records
        .iter()
        .filter_map(|record| match record {
            Record::Wake { k, due, woke } => Some((*k, woke - due)),
            Record::Sample { .. } => None,
        })
        .collect();
    let expected: Vec<_> = (0..1050).map(|k| (k, 20_000)).collect();
    assert_eq!(wakes, expected);
    // One sleep in a hundred is 2.5 ms late: that wake-up and the next are more than a period late.
    let sleeps: Vec<_> = (0..100).map(|i| if i == 50 { 2_500_000 } else { 0 }).collect();
    let (pacer, ..) = watched(VirtualClock::waking_late(sleeps));
    let late = pacer.pace.watching.unwrap().seen.late;
    assert!(late.above(MILLI) >= 2 && late.above(2 * MILLI) >= 1 && late.above(3 * MILLI) == 0);
}

/// A suspended machine or a stopped virtual machine: time goes on without the pacing thread.
#[test]
fn after_a_clock_that_steps_forward_late_packets_go_at_once_and_are_counted_late() {
    let steps: Vec<_> = (0..2000).map(|i| if i == 300 { 400 * MILLI } else { 0 }).collect();
    for capacity in [1 << 20, 2048] {
        let (plan, shared) = (plan(SCENE), Arc::<Shared>::default());
        let (ring, made) = made(&plan, "mpu@pty", &shared);
        let (sender, _far) = memory(capacity);
        let clock = Precise::new(VirtualClock::waking_late(steps.clone()), Policy::Fixed(0));
        let mut pacer = pacer(clock, ring, sender, Speed::Times(1.0), &shared);
        pacer.run(MILLI);
        accounts_balance(&made, &mut pacer);
        let report = &reports(&plan, &mut pacer, made)[0];
        assert_eq!(report.sent + report.dropped, 1000);
        if capacity == 1 << 20 {
            let late = report.late_us.unwrap();
            assert!((late.max / 400e3 - 1.0).abs() < 1e-3, "{late:?}");
            assert_eq!(report.dropped, 0);
            // 400 periods passed at once: the median is on time, and the run ends when its scene does.
            assert_eq!(late.p50, 0.0);
            assert_eq!(pacer.pace.clock.now(), MILLI + 999 * MILLI);
        } else {
            assert!(report.dropped > 300, "what the link could not take at once: {}", report.dropped);
        }
    }
}
