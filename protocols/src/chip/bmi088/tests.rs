extern crate std;

use super::*;
use crate::chip::Wired;
use crate::chip::checks::{self, Backlog, Data, Port, kth, rates};
use proptest::prelude::*;

const ACCEL: u8 = 0x18;
const GYRO: u8 = 0x68;

fn put(chip: &mut Bmi088, address: u8, bytes: &[u8]) {
    checks::put(chip.at(address).expect("one of its addresses"), bytes);
}

fn burst<const N: usize>(chip: &mut Bmi088, address: u8, register: u8) -> [u8; N] {
    checks::burst(chip.at(address).expect("one of its addresses"), register)
}

fn awake() -> Bmi088 {
    let mut chip = Bmi088::new(ACCEL, GYRO);
    put(&mut chip, ACCEL, &[0x7c, 0x00, 0x04]);
    chip
}

#[test]
fn two_chips_answer_and_reset_each_on_its_own() {
    let mut chip = Bmi088::new(0x19, 0x69);
    let mut bus = Wired { t_ns: 0, chips: &mut [&mut chip] };
    for (address, id) in [(0x19, 0x1e), (0x69, 0x0f)] {
        let mut bytes = [0];
        assert!(bus.write(address, &[0x00], false) && bus.read(address, &mut bytes));
        assert_eq!(bytes, [id]);
    }
    assert!(!bus.write(0x18, &[0x00], false));
    let mut chip = awake();
    put(&mut chip, ACCEL, &[0x40, 0x8c, 0x03]);
    put(&mut chip, GYRO, &[0x0f, 0x04, 0x07, 0x80]);
    put(&mut chip, ACCEL, &[0x7e, 0xb6]);
    assert_eq!(burst(&mut chip, ACCEL, 0x40), [0xa8, 0x01]);
    assert_eq!(burst(&mut chip, ACCEL, 0x45), [0x80, 0x00, 0x02, 0x02, 0x10]);
    assert_eq!(burst(&mut chip, ACCEL, 0x7c), [0x03, 0x00, 0x00], "the command clears itself");
    assert_eq!(burst(&mut chip, ACCEL, 0x03), [0x10]);
    assert_eq!(burst(&mut chip, GYRO, 0x0f), [0x04, 0x87, 0x80], "the gyro is as it was");
    put(&mut chip, GYRO, &[0x14, 0xb6]);
    assert_eq!(burst(&mut chip, GYRO, 0x0f), [0, 0x80, 0, 0, 0, 0, 0, 0x0f, 0, 0, 0, 0, 0, 0, 0, 0x08]);
}

#[test]
fn the_accelerometer_starts_in_suspend_mode_and_the_gyro_in_normal_mode() {
    let mut chip = Bmi088::new(ACCEL, GYRO);
    assert_eq!(rates(&chip), [Some((2000, 1)), None]);
    put(&mut chip, ACCEL, &[0x7d, 0x04]);
    assert_eq!(rates(&chip)[1], Some((100, 1)), "chapter 3: this register alone");
    chip.sample(0, &kth(5));
    put(&mut chip, ACCEL, &[0x7c, 0x03]);
    put(&mut chip, GYRO, &[0x11, 0x80]);
    chip.sample(0, &kth(6));
    assert_eq!(rates(&chip), [None, None]);
    assert_eq!((burst(&mut chip, ACCEL, 0x12), burst(&mut chip, GYRO, 0x02)), ([5, 0], [5, 0]));
    put(&mut chip, GYRO, &[0x0f, 0x03]);
    put(&mut chip, GYRO, &[0x11, 0x00]);
    assert_eq!(burst(&mut chip, GYRO, 0x0f), [3], "suspend keeps the configuration");
    put(&mut chip, GYRO, &[0x11, 0x20]);
    put(&mut chip, GYRO, &[0x11, 0x00]);
    assert_eq!(burst(&mut chip, GYRO, 0x0f), [0], "deep suspend does not");
}

#[test]
fn rates_ranges_and_filters_are_those_of_the_register_map() {
    let mut chip = awake();
    let gyro = [
        (2000, "BW 532"),
        (2000, "BW 230"),
        (1000, "BW 116"),
        (400, "BW 47"),
        (200, "BW 23"),
        (100, "BW 12"),
        (200, "BW 64"),
        (100, "BW 32"),
    ];
    for (code, (hz, filter)) in (0u8..).zip(gyro) {
        put(&mut chip, GYRO, &[0x0f, code.min(4), code]);
        let expected = Setting { rate: Some((hz, 1)), range: 4 - code.min(4), filter: Some(filter) };
        assert_eq!(chip.setting(Channel::Gyro), Some(expected));
    }
    for (conf, rate, filter) in [
        (0xa5, (25, 2), "Normal"),
        (0x86, (25, 1), "OSR4"),
        (0x97, (50, 1), "OSR2"),
        (0xa8, (100, 1), "Normal"),
        (0xa9, (200, 1), "Normal"),
        (0x8a, (400, 1), "OSR4"),
        (0x9b, (800, 1), "OSR2"),
        (0xac, (1600, 1), "Normal"),
    ] {
        put(&mut chip, ACCEL, &[0x40, conf, conf & 3]);
        let expected = Setting { rate: Some(rate), range: conf & 3, filter: Some(filter) };
        assert_eq!(chip.setting(Channel::Accel), Some(expected));
        assert_eq!(burst(&mut chip, ACCEL, 0x02), [0]);
    }
    for reserved in [0xa4, 0xad] {
        put(&mut chip, ACCEL, &[0x40, reserved]);
        assert_eq!((rates(&chip)[1], burst(&mut chip, ACCEL, 0x02)), (None, [0x04]), "ACC_ERR_REG");
    }
}

#[test]
fn data_of_the_accelerometer_is_ready_until_it_is_read() {
    let mut chip = awake();
    put(&mut chip, ACCEL, &[0x53, 0x08]);
    put(&mut chip, ACCEL, &[0x58, 0x04]);
    chip.sample(0, &Samples { accel: Some([1, 2, -3]), ..Samples::default() });
    assert!(chip.interrupt());
    assert_eq!((burst(&mut chip, ACCEL, 0x03), burst(&mut chip, ACCEL, 0x1d)), ([0x90], [0x80]));
    assert_eq!(burst(&mut chip, ACCEL, 0x1d), [0]);
    assert_eq!(burst(&mut chip, ACCEL, 0x12), [1, 0, 2, 0, 0xfd, 0xff]);
    assert_eq!((burst(&mut chip, ACCEL, 0x03), chip.interrupt()), ([0x10], false));
}

#[test]
fn data_of_the_gyro_is_ready_for_280_us() {
    let mut chip = awake();
    let status = |chip: &mut Bmi088, t_ns| {
        let [status] = checks::burst_at(chip.at(GYRO).expect("the gyro"), t_ns, 0x0a);
        status
    };
    chip.sample(1_000, &kth(1));
    assert_eq!((status(&mut chip, 2_000), chip.interrupt()), (0, false), "not enabled");
    put(&mut chip, GYRO, &[0x15, 0x80]);
    put(&mut chip, GYRO, &[0x18, 0x01]);
    assert_eq!((status(&mut chip, 280_999), chip.interrupt()), (0x80, true));
    assert_eq!((status(&mut chip, 281_000), chip.interrupt()), (0, false));
}

#[test]
fn the_thermometer_is_the_accelerometers() {
    let mut chip = Bmi088::new(ACCEL, GYRO);
    assert_eq!(burst(&mut chip, ACCEL, 0x22), [0x80, 0], "off");
    put(&mut chip, ACCEL, &[0x7d, 0x04]);
    for (celsius, bytes) in [(85.0, [0x3e, 0]), (23.375, [0, 0x60]), (23.125, [0, 0x20]), (-40.0, [0xc1, 0])]
    {
        chip.sample(0, &Samples { temperature_c: Some(celsius), ..Samples::default() });
        assert_eq!(burst(&mut chip, ACCEL, 0x22), bytes, "{celsius} °C");
    }
}

#[test]
fn the_accelerometers_fifo_has_frames_with_headers() {
    let mut chip = awake();
    assert_eq!(burst(&mut chip, ACCEL, 0x24), [0, 0x80], "empty");
    put(&mut chip, ACCEL, &[0x49, 0x50]);
    put(&mut chip, ACCEL, &[0x46, 14, 0]);
    put(&mut chip, ACCEL, &[0x53, 0x08]);
    put(&mut chip, ACCEL, &[0x58, 0x02]);
    chip.sample(0, &kth(1));
    assert!(!chip.interrupt());
    chip.sample(0, &kth(2));
    assert_eq!((burst(&mut chip, ACCEL, 0x24), chip.interrupt()), ([14, 0], true));
    put(&mut chip, ACCEL, &[0x41, 0x03]);
    let time = [0x44, 0, 0, 0, 0x80, 0, 0x80];
    assert_eq!(burst(&mut chip, ACCEL, 0x26), [0x84, 1, 0, 1], "in part");
    let bytes: [u8; 23] = burst(&mut chip, ACCEL, 0x26);
    assert_eq!(bytes[..14], [0x84, 1, 0, 1, 0, 1, 0, 0x84, 2, 0, 2, 0, 2, 0]);
    assert_eq!((&bytes[14..16], &bytes[16..]), (&[0x48, 0x02][..], &time[..]));
    for k in 0..150 {
        chip.sample(0, &kth(k));
    }
    assert_eq!(burst(&mut chip, ACCEL, 0x24), (146 * 7u16).to_le_bytes());
    assert_eq!(burst(&mut chip, ACCEL, 0x26), [0x40, 4, 0x84, 4, 0]);
    put(&mut chip, ACCEL, &[0x7e, 0xb0]);
    let expected = Tally { made: 152, read: 2, overflowed: 4, missed: 146, again: 0 };
    assert_eq!(chip.tally(Channel::Accel), expected);
    put(&mut chip, ACCEL, &[0x48, 0x03]);
    put(&mut chip, ACCEL, &[0x45, 0x90]);
    put(&mut chip, ACCEL, &[0x7e, 0xb0]);
    for k in 0..400 {
        chip.sample(0, &kth(k));
    }
    assert_eq!(burst(&mut chip, ACCEL, 0x26), [0x40, 200 - 146, 0x84, 0, 0], "stopped, of every second");
}

#[test]
fn the_gyros_fifo_stops_at_100_frames_or_streams_99() {
    for (mode, frames, first) in [(0x40, 100, 0), (0x80, 99, 51)] {
        let mut chip = awake();
        put(&mut chip, GYRO, &[0x3e, mode]);
        put(&mut chip, GYRO, &[0x15, 0x40]);
        put(&mut chip, GYRO, &[0x18, 0x04]);
        for k in 0..frames {
            assert!(!chip.interrupt());
            chip.sample(0, &kth(k));
        }
        assert!(chip.interrupt(), "full");
        assert_eq!(burst(&mut chip, GYRO, 0x0e), [frames as u8]);
        for k in frames..150 {
            chip.sample(0, &kth(k));
        }
        assert_eq!(burst(&mut chip, GYRO, 0x0e), [0x80 | frames as u8], "overrun");
        assert_eq!(chip.tally(Channel::Gyro).overflowed, 150 - frames as u64);
        assert_eq!(burst(&mut chip, GYRO, 0x3f), [first, 0, first, 0, first, 0, first + 1]);
        assert_eq!(burst(&mut chip, GYRO, 0x3f), [first + 2, 0], "the rest of the second is lost");
        assert_eq!(burst(&mut chip, GYRO, 0x0e), [0x80 | (frames - 3) as u8]);
        put(&mut chip, GYRO, &[0x3e, mode]);
        assert_eq!(burst(&mut chip, GYRO, 0x0e), [0], "cleared by writing its configuration");
        assert_eq!(burst(&mut chip, GYRO, 0x3f), [0; 6]);
    }
}

#[test]
fn the_gyros_watermark_counts_frames() {
    let mut chip = awake();
    put(&mut chip, GYRO, &[0x3d, 3, 0x80]);
    put(&mut chip, GYRO, &[0x15, 0x40]);
    put(&mut chip, GYRO, &[0x1e, 0x88]);
    for (k, expected) in [(1, 0), (2, 0), (3, 0x10)] {
        chip.sample(0, &kth(k));
        assert_eq!(burst(&mut chip, GYRO, 0x0a), [expected]);
    }
}

#[test]
fn self_tests_end_well_and_what_is_not_modelled_is_told() {
    let mut chip = awake();
    assert_eq!(burst(&mut chip, GYRO, 0x3c), [0x10]);
    put(&mut chip, GYRO, &[0x3c, 0x01]);
    assert_eq!(burst(&mut chip, GYRO, 0x3c), [0x12]);
    assert_eq!(chip.lacks(), None);
    put(&mut chip, ACCEL, &[0x5e, 0xb6, 0xb6, 0xb6]);
    put(&mut chip, ACCEL, &[0x59, 0x01]);
    assert!(chip.lacks().is_some_and(|lack| lack.contains("synchronizes")));
    put(&mut chip, ACCEL, &[0x6d, 0x0d]);
    assert!(chip.lacks().is_some_and(|lack| lack.contains("ACC_SELF_TEST")));
}

proptest! {
    #[test]
    fn every_sample_is_accounted_for(steps in checks::steps()) {
        let mut chip = awake();
        put(&mut chip, ACCEL, &[0x49, 0x50]);
        put(&mut chip, GYRO, &[0x3e, 0x80]);
        let accel = Port { address: ACCEL, fifo: (0x26, 30), reset: &[&[0x7e, 0xb6]] };
        let gyro = Port { address: GYRO, fifo: (0x3f, 30), reset: &[&[0x14, 0xb6]] };
        checks::every_sample_is_accounted_for(&mut chip, &[accel, gyro], &steps)?;
    }

    #[test]
    fn bursts_at_any_pace_are_whole_samples_in_order(paces in prop::collection::vec(0u8..5, 1..100)) {
        let mut chip = awake();
        let [gyro, accel] = [(GYRO, 0x02, &[(Channel::Gyro, 0)]), (ACCEL, 0x12, &[(Channel::Accel, 0)])].map(
            |(address, register, parts)| Data { address, register, parts, order: i16::to_le_bytes, at_first: 0 },
        );
        checks::bursts_at_any_pace_are_whole_samples_in_order(&mut chip, &[gyro, accel], &paces)?;
    }

    #[test]
    fn the_gyros_fifo_keeps_the_newest_frames_in_order(paces in prop::collection::vec((0usize..60, 0usize..60), 1..20)) {
        let mut chip = awake();
        put(&mut chip, GYRO, &[0x3e, 0x80]);
        let fifo = Backlog {
            room: 99,
            waiting: |chip| usize::from(burst::<1>(chip, GYRO, 0x0e)[0] & 0x7f),
            next: |chip| {
                let [low, high, ..] = burst::<6>(chip, GYRO, 0x3f);
                i16::from_le_bytes([low, high])
            },
            empty: 0,
        };
        checks::the_fifo_keeps_the_newest_frames_in_order(&mut chip, &fifo, &paces)?;
    }
}
