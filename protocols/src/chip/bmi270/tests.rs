extern crate std;

use super::*;
use crate::chip::checks::{self, Backlog, Data, Port, both, get, kth, rates, set};
use crate::chip::{Wired, write};
use proptest::prelude::*;

const READY_NS: u64 = 20_000_000;

fn put(chip: &mut Bmi270, bytes: &[u8]) {
    write(chip, READY_NS, bytes, false);
}

fn burst<const N: usize>(chip: &mut Bmi270, register: u8) -> [u8; N] {
    checks::burst_at(chip, READY_NS, register)
}

/// Uploads `len` bytes in bursts of `step`, each at its own address, at time 0.
fn upload(chip: &mut Bmi270, len: usize, step: usize) {
    write(chip, 0, &[0x59, 0x00], false);
    for at in (0..len).step_by(step) {
        write(chip, 0, &[0x5b, ((at / 2) & 0x0f) as u8, (at >> 5) as u8], false);
        write(chip, 0, &[0x5e], false);
        write(chip, 0, &[7; 8192][..step.min(len - at)], true);
    }
    write(chip, 0, &[0x59, 0x01], false);
}

/// With its program, accelerometer, gyro and thermometer on.
fn awake() -> Bmi270 {
    let mut chip = Bmi270::new(0x68);
    upload(&mut chip, 8192, 8192);
    put(&mut chip, &[0x7c, 0x00, 0x0e]);
    chip
}

#[test]
fn registers_reset_as_the_sheet_says() {
    let mut chip = awake();
    assert_eq!(burst(&mut chip, 0x00), [0x24]);
    assert_eq!((burst(&mut chip, 0x1b), burst(&mut chip, 0x1b)), ([1], [0]), "it was reset: told once");
    put(&mut chip, &[0x40, 0x8c, 0x03, 0x8d, 0x04]);
    put(&mut chip, &[0x7e, 0xb6]);
    let map = [0xa8, 0x02, 0xa9, 0x00, 0x46, 0x88, 0x00, 0x02, 0x02, 0x10];
    assert_eq!(burst(&mut chip, 0x40), map);
    assert_eq!(burst(&mut chip, 0x7c), [0x03, 0x00, 0x00], "the command clears itself");
    assert_eq!((burst(&mut chip, 0x03), burst(&mut chip, 0x1b)), ([0x10], [0x01]));
    assert_eq!((burst(&mut chip, 0x21), burst(&mut chip, 0x22)), ([0], [0x00, 0x80]));
}

#[test]
fn it_measures_nothing_before_its_whole_program_is_there() {
    for (len, step, message) in [
        (8192, 8192, 1),
        (8192, 32, 1),
        (8192, 46, 1),
        (328, 328, 1),
        (8190, 8190, 2),
        (330, 330, 2),
        (0, 1, 2),
    ] {
        let mut chip = Bmi270::new(0x68);
        put(&mut chip, &[0x7d, 0x0e]);
        upload(&mut chip, len, step);
        let status = checks::burst_at(&mut chip, READY_NS - 1, 0x21);
        assert_eq!(status, [if message == 1 { 0 } else { 2 }], "{len} bytes, not yet");
        assert_eq!(burst(&mut chip, 0x21), [message], "{len} bytes in bursts of {step}");
        assert_eq!(rates(&chip).map(|rate| rate.is_some()), [message == 1; 2]);
    }
    let mut chip = Bmi270::new(0x68);
    write(&mut chip, 0, &[0x5e; 8193], false);
    write(&mut chip, 0, &[0x59, 0x00], false);
    write(&mut chip, 0, &[0x59, 0x01], false);
    assert_eq!(burst(&mut chip, 0x21), [2], "INIT_CTRL 0 begins anew");
}

#[test]
fn a_sensor_that_is_off_has_no_rate_and_keeps_its_data() {
    let mut chip = awake();
    chip.sample(0, &kth(5));
    put(&mut chip, &[0x7d, 0x04]);
    chip.sample(0, &kth(6));
    assert_eq!(rates(&chip), [None, Some((100, 1))]);
    assert_eq!((burst(&mut chip, 0x0c), burst(&mut chip, 0x12)), ([6, 0], [5, 0]));
}

#[test]
fn rates_ranges_and_filters_are_those_of_the_register_map() {
    let normal = Some("normal");
    let rows: [(&[u8], Setting, Setting); 5] = [
        (&[0x40, 0xa8, 0x02, 0xa9, 0x00], set((200, 1), 4, normal), set((100, 1), 2, normal)),
        (&[0x40, 0x8c, 0x00, 0xcd, 0x01], set((3200, 1), 3, Some("OSR4")), set((1600, 1), 0, Some("OSR4"))),
        (&[0x40, 0x95, 0x01, 0xd6, 0x02], set((25, 1), 2, Some("OSR2")), set((25, 2), 1, Some("OSR2"))),
        (&[0x40, 0x01, 0x03, 0xe7, 0x03], set((50, 1), 1, normal), set((25, 32), 3, None)),
        (&[0x40, 0xaa, 0x03, 0xec, 0x04], set((1600, 1), 0, normal), set((400, 1), 3, normal)),
    ];
    for (bytes, gyro, accel) in rows {
        let mut chip = awake();
        put(&mut chip, bytes);
        assert_eq!(chip.setting(Channel::Gyro), Some(gyro), "{bytes:x?}");
        assert_eq!(chip.setting(Channel::Accel), Some(accel), "{bytes:x?}");
    }
    let mut chip = awake();
    burst::<1>(&mut chip, 0x1b);
    for (bytes, error) in [([0x40, 0xa4], 1), ([0x42, 0xa5], 3), ([0x40, 0xa8], 2), ([0x42, 0xa8], 0)] {
        put(&mut chip, &bytes);
        assert_eq!(burst(&mut chip, 0x1b), [error << 2], "{bytes:x?}");
    }
}

#[test]
fn data_is_ready_until_one_of_its_registers_is_read() {
    let mut chip = awake();
    put(&mut chip, &[0x53, 0x08]);
    put(&mut chip, &[0x58, 0x04]);
    chip.sample(0, &Samples { temperature_c: Some(24.0), ..both([1, 2, -3], [4, 5, -6]) });
    assert!(chip.interrupt());
    assert_eq!((burst(&mut chip, 0x03), burst(&mut chip, 0x1d)), ([0xd0], [0xc0]));
    assert_eq!(burst(&mut chip, 0x1d), [0], "cleared by reading");
    let frame = [4, 0, 5, 0, 0xfa, 0xff, 1, 0, 2, 0, 0xfd, 0xff];
    assert_eq!(burst(&mut chip, 0x0c), frame, "accelerometer first, low byte first");
    assert_eq!((burst(&mut chip, 0x03), chip.interrupt()), ([0x10], false));
    assert_eq!(burst(&mut chip, 0x22), 512i16.to_le_bytes());
    put(&mut chip, &[0x55, 0x01]);
    chip.sample(0, &kth(1));
    burst::<12>(&mut chip, 0x0c);
    assert!(chip.interrupt(), "latched");
    burst::<1>(&mut chip, 0x1d);
    assert!(!chip.interrupt());
}

#[test]
fn offsets_shift_what_is_read_where_they_are_enabled() {
    let mut chip = awake();
    put(&mut chip, &[0x71, 1, 0xff, 0, 2, 0xfe, 0, 0x0c]);
    chip.sample(0, &kth(0));
    assert_eq!(burst(&mut chip, 0x0c), [0; 12]);
    put(&mut chip, &[0x70, 0x08]);
    put(&mut chip, &[0x77, 0x4c]);
    for (gyro, accel, step) in [(0x04, 0x00, 1), (0x03, 0x01, 2)] {
        put(&mut chip, &[0x41, accel]);
        put(&mut chip, &[0x43, gyro]);
        chip.sample(0, &kth(0));
        let counts = [64, -64, 0, 32, -32, 0].map(|count: i16| count / step);
        assert_eq!(burst::<12>(&mut chip, 0x0c)[..], counts.map(i16::to_le_bytes).concat());
    }
}

#[test]
fn features_are_pages_of_memory() {
    let mut chip = awake();
    for page in 0..8 {
        put(&mut chip, &[0x2f, page]);
        put(&mut chip, &[0x30, page + 1, 9]);
    }
    put(&mut chip, &[0x2f, 3]);
    assert_eq!((burst(&mut chip, 0x30), burst(&mut chip, 0x3f)), ([4, 9, 0], [0, 0xa8]));
}

#[test]
fn its_fifo_has_2048_bytes_and_6144_without_features() {
    for (image, size) in [(8192, 2048u16), (328, 6144)] {
        let mut chip = Bmi270::new(0x68);
        upload(&mut chip, image, 32);
        put(&mut chip, &[0x7d, 0x0e]);
        put(&mut chip, &[0x49, 0xd0]);
        for k in 0..600 {
            chip.sample(0, &kth(k));
        }
        let lost = 600 - size / 13;
        assert_eq!(burst(&mut chip, 0x24), (size / 13 * 13 + 2).to_le_bytes());
        let skipped = lost.min(255) as u8;
        let [low, high] = lost.to_le_bytes();
        assert_eq!(burst(&mut chip, 0x26), [0x40, skipped, 0x8c, low, high]);
        assert_eq!(chip.tally(Channel::Gyro).overflowed, u64::from(lost));
        put(&mut chip, &[0x7e, 0xb0]);
        assert_eq!(burst(&mut chip, 0x24), [0, 0]);
    }
}

#[test]
fn a_fifo_that_stops_keeps_the_oldest() {
    let mut chip = awake();
    put(&mut chip, &[0x48, 0x01, 0xc0]);
    for k in 0..200 {
        chip.sample(0, &kth(k));
    }
    assert_eq!(burst(&mut chip, 0x24), (170 * 12u16).to_le_bytes());
    assert_eq!(burst(&mut chip, 0x26), [0; 12]);
    assert_eq!(burst(&mut chip, 0x26), [1, 0, 1, 0], "the second, in part");
    assert_eq!(chip.tally(Channel::Accel), Tally { made: 200, read: 1, overflowed: 30, ..Tally::default() });
}

#[test]
fn the_watermark_counts_bytes_and_time_follows_the_last_frame() {
    let mut chip = awake();
    put(&mut chip, &[0x46, 14, 0x00, 0x02, 0x50]);
    put(&mut chip, &[0x53, 0x08]);
    put(&mut chip, &[0x58, 0x02]);
    chip.sample(0, &kth(1));
    assert!(!chip.interrupt());
    chip.sample(0, &kth(2));
    assert!(chip.interrupt());
    assert_eq!(burst(&mut chip, 0x1d), [0xc2]);
    put(&mut chip, &[0x41, 0x00]);
    let bytes: [u8; 25] = burst(&mut chip, 0x26);
    assert_eq!(bytes[..8], [0x84, 1, 0, 1, 0, 1, 0, 0x84]);
    assert_eq!(bytes[14..], [0x48, 0x02, 0, 2, 0, 0x44, 0, 2, 0, 0x80, 0], "512 ticks of 39.0625 µs");
    assert!(!chip.interrupt());
}

#[test]
fn the_makers_own_driver_finds_what_it_expects() {
    // BMI270_SensorAPI: soft reset, power saving off, INIT_CTRL read and written, bursts of 46 bytes, 20 ms.
    let mut chip = Bmi270::new(0x68);
    let mut bus = Wired { t_ns: 0, chips: &mut [&mut chip] };
    assert_eq!(get(&mut bus, 0x68, 0x00), 0x24);
    bus.write(0x68, &[0x7e, 0xb6], false);
    let power = get(&mut bus, 0x68, 0x7c) & !0x01;
    bus.write(0x68, &[0x7c, power], false);
    let control = get(&mut bus, 0x68, 0x59) & !0x01;
    bus.write(0x68, &[0x59, control], false);
    let mut at = 0u16;
    while at < 8192 {
        let step = if at < 8188 { 46 } else { 2 };
        bus.write(0x68, &[0x5b, ((at / 2) & 0x0f) as u8, (at >> 5) as u8], false);
        bus.write(0x68, &[0x5e; 47][..=step], false);
        at += step as u16;
    }
    let control = get(&mut bus, 0x68, 0x59) | 0x01;
    bus.write(0x68, &[0x59, control], false);
    bus.t_ns = 20_000_000;
    assert_eq!(get(&mut bus, 0x68, 0x21) & 0x0f, 0x01);
}

proptest! {
    #[test]
    fn every_sample_is_accounted_for(steps in checks::steps()) {
        let mut chip = awake();
        put(&mut chip, &[0x49, 0xd0]);
        let port = Port { address: 0x68, fifo: (0x26, 30), reset: &[&[0x7e, 0xb6]] };
        checks::every_sample_is_accounted_for(&mut chip, &[port], &steps)?;
    }

    #[test]
    fn bursts_at_any_pace_are_whole_samples_in_order(paces in prop::collection::vec(0u8..5, 1..100)) {
        let mut chip = awake();
        let parts = [(Channel::Accel, 0), (Channel::Gyro, 6)];
        let data = Data { address: 0x68, register: 0x0c, parts: &parts, order: i16::to_le_bytes, at_first: 0 };
        checks::bursts_at_any_pace_are_whole_samples_in_order(&mut chip, &[data], &paces)?;
    }

    #[test]
    fn the_fifo_keeps_the_newest_frames_in_order(paces in prop::collection::vec((0usize..200, 0usize..200), 1..20)) {
        let mut chip = awake();
        put(&mut chip, &[0x49, 0x40]);
        let fifo = Backlog {
            room: 2048 / 6,
            waiting: |chip| usize::from(u16::from_le_bytes(burst(chip, 0x24))) / 6,
            next: |chip| {
                let [low, high, ..] = burst::<6>(chip, 0x26);
                i16::from_le_bytes([low, high])
            },
            empty: i16::MIN,
        };
        checks::the_fifo_keeps_the_newest_frames_in_order(&mut chip, &fifo, &paces)?;
    }
}
