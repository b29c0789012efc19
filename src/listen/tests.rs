//! The meter on streams with exactly known rates, gaps and bursts.

use super::*;
use crate::report::HeardSensor;
use proptest::prelude::*;
use ratetable_protocols::mavlink::{self, Header, Message, Version, hil_sensor};
use ratetable_protocols::mpu::{self, Packet, gyro};

const MS: i64 = 1_000_000;

/// The `k`-th packet of a gyro at 1 kHz.
fn packet(k: i64) -> Vec<u8> {
    let mut bytes = [0; mpu::MAX_LEN];
    let packet = Packet::Gyro(gyro::Repr { gyro: [k as i16, 2, 3] });
    let len = mpu::encode(k as u8, (k * 1000) as u32, &packet, &mut bytes).unwrap();
    bytes[..len].to_vec()
}

/// A meter fed with these packets, the `k`-th arriving at `at(k)`.
fn heard(packets: impl IntoIterator<Item = i64>, at: impl Fn(i64) -> i64) -> Meter {
    let mut meter = Meter::new(Protocol::Mpu);
    packets.into_iter().for_each(|k| meter.arrived(&packet(k), Some(at(k))));
    meter.finish();
    meter
}

fn only(meter: &Meter) -> HeardSensor {
    let [sensor] = &meter.sensors()[..] else { panic!("{:?}", meter.sensors()) };
    sensor.clone()
}

/// Whether they agree within the three digits of a histogram.
fn close(found: f64, expected: f64) -> bool {
    (found - expected).abs() <= 2e-3 * expected.abs()
}

#[test]
fn an_even_stream_has_its_rate_no_jitter_and_no_bursts() {
    let sensor = only(&heard(0..1000, |k| 7 + k * MS));
    assert_eq!((sensor.name.as_str(), sensor.source.as_str(), sensor.received), ("gyro", "mpu", 1000));
    assert_eq!((sensor.rate_hz, sensor.received_hz), (Some(1000.0), Some(1000.0)));
    assert_eq!((sensor.missing, sensor.steps_back, sensor.burst_share), (Some(0), 0, Some(0.0)));
    let (interval, jitter) = (sensor.interval_us.unwrap(), sensor.jitter_us.unwrap());
    assert!(close(interval.p50, 1000.0) && close(interval.max, 1000.0) && interval.std < 1.0, "{interval:?}");
    assert_eq!((jitter.p50, jitter.max), (0.0, 0.0));
}

#[test]
fn a_slow_receiver_sees_another_rate_than_the_sender_says() {
    let sensor = only(&heard(0..500, |k| k * MS * 5 / 4));
    assert_eq!((sensor.rate_hz, sensor.received_hz), (Some(1000.0), Some(800.0)));
    assert!(close(sensor.jitter_us.unwrap().p50, 250.0), "1.25 ms against 1 ms: {:?}", sensor.jitter_us);
}

#[test]
fn bursts_of_sixteen_are_named_with_the_jitter_they_make() {
    let mut meter = Meter::new(Protocol::Mpu);
    for burst in 0..100 {
        let bytes: Vec<u8> = (0..16).flat_map(|k| packet(16 * burst + k)).collect();
        meter.arrived(&bytes, Some(burst * 16 * MS));
    }
    let sensor = only(&meter);
    assert_eq!(sensor.received, 1600);
    assert_eq!(sensor.burst_share, Some(1500.0 / 1599.0), "fifteen of sixteen came with the one before");
    assert!(close(sensor.received_hz.unwrap(), 1599.0 / (99.0 * 0.016)));
    let (interval, jitter) = (sensor.interval_us.unwrap(), sensor.jitter_us.unwrap());
    assert!(interval.p50 == 0.0 && close(interval.max, 16_000.0), "{interval:?}");
    assert!(close(jitter.p50, 1000.0) && close(jitter.max, 15_000.0), "{jitter:?}");
}

#[test]
fn gaps_are_counted_by_number_and_by_time() {
    let lost = |k: &i64| [10, 11, 12, 400, 999].contains(k);
    let meter = heard((0..1500).filter(|k| !lost(k)), |k| k * MS);
    assert_eq!((meter.counts().lost, only(&meter).missing, only(&meter).received), (5, Some(5), 1495));
    // The sequence number does not show a gap of 256; the time does.
    let meter = heard((0..100).chain(355..600), |k| k * MS);
    assert_eq!((meter.counts().lost, only(&meter).missing), (0, Some(255)));
    let meter = heard((0..100).chain(100 + 1000..2000), |k| k * MS);
    assert_eq!((meter.counts().lost, only(&meter).missing), (1000 - 3 * 256, Some(1000)), "whole turns");
}

#[test]
fn time_that_does_not_go_on_is_counted() {
    let mut meter = heard(0..100, |k| k * MS);
    (100..200).for_each(|k| meter.arrived(&packet(k - 100), Some(k * MS)));
    assert_eq!(only(&meter).steps_back, 1, "the sender began again");
    let mut meter = heard(0..100, |k| k * MS);
    meter.arrived(&packet(99), Some(100 * MS));
    assert_eq!((only(&meter).steps_back, meter.counts().lost), (1, 0), "a packet came twice");
}

#[test]
fn a_clock_that_is_set_changes_neither_rate_nor_loss_and_is_told() {
    // (step of the sender's clock at the 300th sample, steps back, steps forward)
    for (set, back, forward) in [(0, 0, 0), (-295, 1, 0), (-30, 1, 0), (5_000, 0, 1), (3_600_000, 0, 1)] {
        for live in [true, false] {
            let mut meter = if live { Meter::new(Protocol::Mpu) } else { Meter::recorded(Protocol::Mpu) };
            for k in 0..600i64 {
                let mut bytes = [0; mpu::MAX_LEN];
                let t_us = (k + if k < 300 { 0 } else { set }) * 1000;
                let gyro = Packet::Gyro(gyro::Repr { gyro: [1, 2, 3] });
                let len = mpu::encode(k as u8, t_us as u32, &gyro, &mut bytes).unwrap();
                meter.arrived(&bytes[..len], live.then_some(k * MS));
            }
            let sensor = only(&meter);
            assert_eq!((sensor.rate_hz, sensor.missing), (Some(1000.0), Some(0)), "{set} ms, live {live}");
            assert_eq!((sensor.steps_back, sensor.steps_forward), (back, forward), "{set} ms, live {live}");
            let longest = sensor.longest_step_s.map(|s| (s * 1000.0).round() as i64);
            assert_eq!(longest, (set != 0).then_some(set + 1), "{set} ms");
        }
    }
}

#[test]
fn silence_of_many_seconds_is_a_loss_where_the_arrivals_or_the_numbers_have_it() {
    // Five seconds without a packet, live; the number continues correctly.
    let meter = heard((0..300).chain(5300..5600), |k| k * MS);
    assert_eq!((only(&meter).missing, only(&meter).steps_forward), (Some(5000), 0));
    // The same in a recording, from the sequence numbers.
    let mut meter = Meter::recorded(Protocol::Mpu);
    (0..300).chain(5300..5600).for_each(|k| meter.arrived(&packet(k), None));
    assert_eq!((only(&meter).missing, only(&meter).steps_forward), (Some(5000), 0));
    // Text has no sequence numbers: in a recording the jump is ambiguous, and counts as a step of the clock.
    let line = |k: i64| format!("{},gyro,0,0,0\n", k * MS);
    let mut meter = Meter::recorded(Protocol::Csv);
    (0..300).chain(5300..5600).for_each(|k| meter.arrived(line(k).as_bytes(), None));
    let sensor = only(&meter);
    assert_eq!((sensor.missing, sensor.steps_forward, sensor.rate_hz), (Some(0), 1, Some(1000.0)));
    // A gap that is short enough counts as loss.
    let mut meter = Meter::recorded(Protocol::Csv);
    (0..300).chain(1200..1600).for_each(|k| meter.arrived(line(k).as_bytes(), None));
    assert_eq!((only(&meter).missing, only(&meter).steps_forward), (Some(900), 0));
}

#[test]
fn a_clock_of_32_bits_that_wraps_does_not_step() {
    for wrap in [(1i64 << 32) * 1000, (1 << 32) * MS] {
        let mut meter = Meter::recorded(Protocol::Csv);
        for k in 0..4000 {
            let k = if k == 2001 { 1998 } else { k };
            let t = (wrap - 2000 * MS + k * MS) % wrap;
            meter.arrived(format!("{t},gyro,0,0,0\n").as_bytes(), None);
        }
        let sensor = only(&meter);
        assert_eq!((sensor.rate_hz, sensor.missing), (Some(1000.0), Some(0)));
        assert_eq!(
            (sensor.steps_back, sensor.steps_forward),
            (1, 0),
            "the one that was overtaken around the wrap"
        );
    }
    let mut meter = Meter::recorded(Protocol::Csv);
    for k in 0..400 {
        let t = if k < 200 { 4_000_000 * MS } else { 0 } + k * MS;
        meter.arrived(format!("{t},gyro,0,0,0\n").as_bytes(), None);
    }
    assert_eq!(only(&meter).steps_back, 1, "control: from elsewhere it is a step");
}

#[test]
fn five_in_a_hundred_lost_do_not_make_a_sensor_slower() {
    let meter = heard((0..10_000).filter(|k| k % 20 != 7), |k| k * MS);
    let sensor = only(&meter);
    assert_eq!((sensor.rate_hz, sensor.missing, meter.counts().lost), (Some(1000.0), Some(500), 500));
    assert!(close(sensor.received_hz.unwrap(), 950.0), "what arrives is less: {:?}", sensor.received_hz);
}

#[test]
fn who_is_overtaken_is_out_of_order_and_neither_lost_nor_missing() {
    let meter = heard([0, 1, 2, 3, 5, 4, 6, 7, 9, 8].into_iter().chain(10..100), |k| k * MS);
    let (counts, sensor) = (meter.counts(), only(&meter));
    assert_eq!((counts.lost, counts.out_of_order, counts.duplicates), (0, 2, 0));
    assert_eq!((sensor.missing, sensor.steps_back, sensor.received), (Some(0), 2, 100));
    // One packet overtaken and one lost.
    let meter = heard([0, 1, 3, 2, 4, 6].into_iter().chain(7..100), |k| k * MS);
    assert_eq!((meter.counts().lost, meter.counts().out_of_order), (1, 1));
    assert_eq!(only(&meter).missing, Some(1));
}

#[test]
fn a_recording_has_the_senders_rate_and_no_other() {
    let mut meter = Meter::new(Protocol::Mpu);
    (0..100).for_each(|k| meter.arrived(&packet(k), None));
    let sensor = only(&meter);
    assert_eq!((sensor.rate_hz, sensor.missing), (Some(1000.0), Some(0)));
    assert!(sensor.received_hz.is_none() && sensor.burst_share.is_none() && sensor.interval_us.is_none());
    assert!(sensor.jitter_us.is_none() && sensor.sample_interval_us.is_some());
    let link = meter.link("x".into(), "x".into(), Some(115_200));
    assert!(meter.duration_s().is_none() && link.bytes_per_s.is_none() && link.utilisation.is_none());
}

#[test]
fn the_load_of_a_port_is_bytes_after_the_first_read_against_its_baud_rate() {
    let meter = heard(0..1001, |k| k * MS);
    let link = meter.link("mpu@x".into(), "x".into(), Some(921_600));
    let bytes: usize = (1..1001).map(|k| packet(k).len()).sum();
    assert_eq!((link.packets, link.bytes), (1001, bytes as u64 + packet(0).len() as u64));
    assert_eq!(link.bytes_per_s, Some(bytes as f64));
    assert_eq!(link.utilisation, Some(bytes as f64 * 10.0 / 921_600.0));
    assert_eq!((link.lost_seq, link.crc_errors, link.joined_midway), (Some(0), 0, 0));
}

/// A HIL_SENSOR of gyro and accel of a system, number `seq`.
fn hil(system: u8, seq: u8) -> Vec<u8> {
    let header = Header { version: Version::V2, seq, system, component: 1 };
    let fields_updated = hil_sensor::GYRO | hil_sensor::ACCEL;
    let time_usec = u64::from(seq) * 4000;
    let message = Message::HilSensor(hil_sensor::Repr { time_usec, fields_updated, ..Default::default() });
    let mut bytes = [0; mavlink::MAX_LEN];
    let len = mavlink::encode(&header, &message, &mut bytes).unwrap();
    bytes[..len].to_vec()
}

#[test]
fn two_senders_on_one_link_are_told_apart() {
    let mut meter = Meter::new(Protocol::Mavlink);
    for seq in 0..100 {
        meter.arrived(&hil(1, seq), Some(i64::from(seq) * 4 * MS));
        if seq % 2 == 0 {
            meter.arrived(&hil(2, seq / 2), Some(i64::from(seq) * 4 * MS + MS));
        }
    }
    let seen = meter.sensors();
    let of = |name: &str| seen.iter().find(|sensor| sensor.name == name).unwrap_or_else(|| panic!("{name}"));
    assert_eq!(seen.len(), 4);
    assert_eq!((of("gyro").received, of("gyro-2").received, of("accel-2").received), (100, 50, 50));
    assert_eq!(
        (of("gyro").source.as_str(), of("gyro-2").source.as_str()),
        ("hil_sensor 1/1/0", "hil_sensor 2/1/0")
    );
    assert_eq!((of("gyro").received_hz, of("gyro-2").received_hz), (Some(250.0), Some(125.0)));
    assert_eq!(meter.counts().lost, 0, "each counts for itself");
}

#[test]
fn however_many_senders_there_are_memory_is_bounded() {
    let mut meter = Meter::new(Protocol::Mavlink);
    (0..=255).for_each(|system| meter.arrived(&hil(system, 0), Some(i64::from(system) * MS)));
    assert_eq!(meter.streams().len(), 32);
    assert_eq!(meter.streams().iter().map(Stream::count).sum::<u64>(), 512);
}

#[test]
fn bytes_of_another_protocol_are_recognised() {
    let mut meter = Meter::new(Protocol::Mpu);
    (0..20).for_each(|seq| meter.arrived(&hil(1, seq), None));
    assert_eq!((meter.counts().packets, meter.reads_as()), (0, Some(Protocol::Mavlink)));
    let mut meter = Meter::new(Protocol::Mavlink);
    meter.arrived(&[0x55; 50_000], None);
    assert_eq!((meter.counts().packets, meter.reads_as()), (0, None), "rubbish is nothing");
}

proptest! {
    #[test]
    fn any_bytes_at_any_time_do_not_panic(
        protocol in prop::sample::select(Protocol::STREAMS.to_vec()),
        reads in prop::collection::vec((prop::collection::vec(any::<u8>(), 0..60), any::<Option<i64>>(), any::<bool>()), 0..40),
    ) {
        let mut meter = Meter::new(protocol);
        for (k, (bytes, now, whole)) in reads.into_iter().enumerate() {
            let bytes = if whole { packet(k as i64) } else { bytes };
            meter.arrived(&bytes, now);
        }
        meter.finish();
        let (counts, sensors) = (meter.counts().clone(), meter.sensors());
        let link = meter.link(String::new(), String::new(), Some(1));
        prop_assert_eq!(link.bytes, counts.bytes);
        let samples: u64 = meter.streams().iter().map(Stream::count).sum();
        prop_assert_eq!(sensors.iter().map(|sensor| sensor.received).sum::<u64>(), samples);
        let _ = (meter.duration_s(), meter.reads_as());
    }
}
