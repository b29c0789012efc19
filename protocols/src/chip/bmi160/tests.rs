extern crate std;

use super::*;
use crate::chip::checks::{self, Backlog, Data, Port, both, burst, get, kth, put, rates, set};
use crate::chip::{Wired, read, write};
use proptest::prelude::*;

/// Awake at ±2000 °/s and ±2 g.
fn awake() -> Bmi160 {
    let mut chip = Bmi160::new(0x69);
    put(&mut chip, &[0x7e, 0x11]);
    put(&mut chip, &[0x7e, 0x15]);
    chip
}

#[test]
fn registers_reset_as_the_sheet_says() {
    let mut chip = awake();
    assert_eq!(burst(&mut chip, 0x00), [0xd1]);
    put(&mut chip, &[0x40, 0x0c, 0x0c, 0x0d, 0x04]);
    put(&mut chip, &[0x7e, 0xb6]);
    assert_eq!(burst(&mut chip, 0x40), [0x28, 0x03, 0x28, 0x00, 0x0b, 0x88, 0x80, 0x10]);
    assert_eq!(burst(&mut chip, 0x7e), [0], "the command clears itself");
    assert_eq!(burst(&mut chip, 0x5a), [0x07, 0x30, 0x81, 0x0b, 0xc0, 0x00, 0x14, 0x14, 0x24]);
    assert_eq!((burst(&mut chip, 0x03), burst(&mut chip, 0x1b)), ([0], [0x10]), "all in suspend mode");
}

#[test]
fn power_modes_are_commands_and_a_sensor_that_is_off_keeps_its_data() {
    let mut chip = Bmi160::new(0x68);
    for (command, status) in
        [(0x18, 0), (0x11, 0x10), (0x17, 0x1c), (0x15, 0x14), (0x19, 0x15), (0x12, 0x25), (0x1a, 0x26)]
    {
        put(&mut chip, &[0x7e, command]);
        assert_eq!(burst(&mut chip, 0x03), [status], "{command:#x}");
    }
    chip.sample(0, &kth(5));
    put(&mut chip, &[0x7e, 0x14]);
    chip.sample(0, &kth(6));
    assert_eq!(chip.setting(Channel::Gyro).map(|setting| setting.rate), Some(None));
    assert_eq!((burst(&mut chip, 0x0c), burst(&mut chip, 0x12)), ([5, 0], [6, 0]));
    put(&mut chip, &[0x7e, 0x03]);
    assert_eq!(burst(&mut chip, 0x1b), [0x18], "compensation has ended");
    assert!(chip.lacks().is_some_and(|lack| lack.contains("compensation")));
}

#[test]
fn rates_ranges_and_filters_are_those_of_the_register_map() {
    let normal = Some("normal");
    let rows: [(&[u8], Setting, Setting); 6] = [
        (&[0x40, 0x28, 0x03, 0x28, 0x00], set((100, 1), 4, normal), set((100, 1), 0, normal)),
        (&[0x40, 0x0c, 0x05, 0x0d, 0x01], set((3200, 1), 3, Some("OSR4")), set((1600, 1), 1, Some("OSR4"))),
        (&[0x40, 0x15, 0x08, 0x16, 0x02], set((25, 1), 2, Some("OSR2")), set((25, 2), 2, Some("OSR2"))),
        (&[0x40, 0x81, 0x0c, 0x27, 0x03], set((50, 1), 1, normal), set((25, 32), 3, None)),
        (&[0x40, 0x26, 0x00, 0x29, 0x04], set((200, 1), 0, normal), set((25, 1), 0, normal)),
        (&[0x40, 0x27, 0x0c, 0x2c, 0x04], set((1600, 1), 0, normal), set((50, 1), 3, normal)),
    ];
    for (bytes, gyro, accel) in rows {
        let mut chip = awake();
        put(&mut chip, bytes);
        assert_eq!(chip.setting(Channel::Gyro), Some(gyro), "{bytes:x?}");
        assert_eq!(chip.setting(Channel::Accel), Some(accel), "{bytes:x?}");
    }
    for reserved in [[0x40, 0x24, 0x03, 0x25], [0x40, 0x2d, 0x03, 0x2e], [0x40, 0x20, 0x03, 0x20]] {
        let mut chip = awake();
        put(&mut chip, &reserved);
        assert_eq!(rates(&chip), [None; 2], "{reserved:x?}");
    }
}

#[test]
fn data_is_ready_until_one_of_its_registers_is_read() {
    let mut chip = awake();
    put(&mut chip, &[0x53, 0x08]);
    put(&mut chip, &[0x51, 0x10]);
    put(&mut chip, &[0x56, 0x80]);
    assert!(!chip.interrupt());
    chip.sample(0, &Samples { temperature_c: Some(24.0), ..both([1, 2, -3], [4, 5, -6]) });
    assert!(chip.interrupt());
    assert_eq!((burst(&mut chip, 0x1b), burst(&mut chip, 0x1d)), ([0xd0], [0x10]));
    assert_eq!(burst(&mut chip, 0x0c), [1, 0, 2, 0, 0xfd, 0xff], "gyro first, low byte first");
    assert_eq!(burst(&mut chip, 0x1b), [0x90], "the accelerometer's still is");
    assert_eq!(burst(&mut chip, 0x12), [4, 0, 5, 0, 0xfa, 0xff]);
    assert!(!chip.interrupt());
    assert_eq!(burst(&mut chip, 0x20), 512i16.to_le_bytes());
}

#[test]
fn offsets_shift_what_is_read_where_they_are_enabled() {
    let mut chip = awake();
    put(&mut chip, &[0x71, 1, 0xff, 0, 2, 0xfe, 0, 0x0c]);
    chip.sample(0, &kth(0));
    assert_eq!(burst(&mut chip, 0x0c), [0; 12]);
    put(&mut chip, &[0x77, 0xcc]);
    for (gyro, accel, step) in [(0x04, 0x03, 1), (0x03, 0x05, 2)] {
        put(&mut chip, &[0x41, accel]);
        put(&mut chip, &[0x43, gyro]);
        chip.sample(0, &kth(0));
        let counts = [32, -32, 0, 64, -64, 0].map(|count: i16| count / step);
        let expected = counts.map(i16::to_le_bytes).concat();
        assert_eq!(burst::<12>(&mut chip, 0x0c)[..], expected);
    }
}

#[test]
fn frames_have_headers_and_the_oldest_are_lost() {
    let mut chip = awake();
    put(&mut chip, &[0x47, 0xd0]);
    chip.sample(0, &both([1, 2, 3], [4, 5, 6]));
    chip.sample(0, &Samples { gyro: Some([7; 3]), ..Samples::default() });
    assert_eq!(burst(&mut chip, 0x22), [20, 0]);
    assert_eq!(burst(&mut chip, 0x24), [0x8c, 1, 0, 2], "in part");
    let whole = [0x8c, 1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6, 0, 0x88, 7, 0, 7, 0, 7, 0, 0x80];
    assert_eq!(burst(&mut chip, 0x24), whole, "again, and what an empty FIFO reads");
    assert_eq!(chip.tally(Channel::Gyro), Tally { made: 2, read: 2, ..Tally::default() });
    for k in 0..80 {
        chip.sample(0, &kth(k));
    }
    assert_eq!(burst(&mut chip, 0x22), (78 * 13 + 2u16).to_le_bytes(), "with the skip frame");
    assert_eq!(burst(&mut chip, 0x24), [0x40, 2, 0x8c, 2, 0]);
    assert_eq!(chip.tally(Channel::Accel).overflowed, 2);
    put(&mut chip, &[0x7e, 0xb0]);
    assert_eq!((burst(&mut chip, 0x22), chip.tally(Channel::Accel).missed), ([0, 0], 78));
}

#[test]
fn without_headers_a_frame_is_the_sensors_data() {
    let mut chip = awake();
    put(&mut chip, &[0x47, 0x40]);
    put(&mut chip, &[0x45, 0x98]);
    for k in 1..=4 {
        chip.sample(0, &kth(k));
    }
    let every_second = [1, 0, 1, 0, 1, 0, 3, 0, 3, 0, 3, 0];
    assert_eq!(burst::<12>(&mut chip, 0x24), every_second, "FIFO_DOWNS: every second");
    assert_eq!(burst(&mut chip, 0x24), [0x80, 0]);
    assert_eq!(chip.tally(Channel::Accel), Tally { made: 4, read: 2, missed: 1, ..Tally::default() });
}

#[test]
fn the_watermark_counts_in_four_bytes_and_full_is_two_frames_before_the_end() {
    let mut chip = awake();
    put(&mut chip, &[0x46, 4, 0x50]);
    put(&mut chip, &[0x51, 0x60]);
    put(&mut chip, &[0x53, 0x08]);
    put(&mut chip, &[0x56, 0x40]);
    for (k, expected) in [(1, false), (2, false), (3, true)] {
        chip.sample(0, &kth(k));
        assert_eq!(chip.interrupt(), expected, "{k} frames of 7 bytes against 16");
    }
    put(&mut chip, &[0x56, 0x20]);
    for k in 4..=143 {
        chip.sample(0, &kth(k));
        assert!(!chip.interrupt());
    }
    chip.sample(0, &kth(144));
    assert!(chip.interrupt(), "two of 146 frames still have room");
}

#[test]
fn time_follows_the_last_frame_and_a_new_configuration_precedes_its_first() {
    let mut chip = awake();
    put(&mut chip, &[0x47, 0x92]);
    put(&mut chip, &[0x43, 0x04]);
    put(&mut chip, &[0x41, 0x05]);
    chip.sample(0, &kth(1));
    let mut bytes = [0; 14];
    write(&mut chip, 0, &[0x24], false);
    read(&mut chip, 10_000_000, &mut bytes);
    assert_eq!(bytes, [0x48, 0x08, 0x88, 1, 0, 1, 0, 1, 0, 0x44, 0, 1, 0, 0x80]);
    assert_eq!(burst(&mut chip, 0x18), [0; 3]);
}

#[test]
fn it_answers_what_zephyrs_driver_sends() {
    let mut chip = Bmi160::new(0x69);
    let mut bus = Wired { t_ns: 0, chips: &mut [&mut chip] };
    assert!(bus.write(0x69, &[0x7e], false) && bus.write(0x69, &[0xb6], true), "one write in two messages");
    assert_eq!((get(&mut bus, 0x69, 0x7f), get(&mut bus, 0x69, 0x00)), (0, 0xd1));
    for (command, mask, value) in [(0x18, 0x03, 0x00), (0x11, 0x30, 0x10), (0x15, 0x0c, 0x04)] {
        bus.write(0x69, &[0x7e, command], false);
        assert_eq!(get(&mut bus, 0x69, 0x03) & mask, value);
    }
    for write in [[0x40, 0x28], [0x41, 0x03], [0x43, 0x00]] {
        bus.write(0x69, &write, false);
    }
    assert_eq!(get(&mut bus, 0x69, 0x1b) & 0xc0, 0);
    chip.sample(0, &both([1, 2, 3], [-1, -2, 16384]));
    let mut bus = Wired { t_ns: 0, chips: &mut [&mut chip] };
    assert_eq!(get(&mut bus, 0x69, 0x1b) & 0xc0, 0xc0);
    let mut fetched = [0; 12];
    assert!(bus.write(0x69, &[0x0c], false) && bus.read(0x69, &mut fetched));
    assert_eq!(fetched, [1, 0, 2, 0, 3, 0, 0xff, 0xff, 0xfe, 0xff, 0, 0x40]);
}

proptest! {
    #[test]
    fn every_sample_is_accounted_for(steps in checks::steps()) {
        let mut chip = awake();
        put(&mut chip, &[0x47, 0xd2]);
        let port = Port { address: 0x69, fifo: (0x24, 30), reset: &[&[0x7e, 0xb6]] };
        checks::every_sample_is_accounted_for(&mut chip, &[port], &steps)?;
    }

    #[test]
    fn bursts_at_any_pace_are_whole_samples_in_order(paces in prop::collection::vec(0u8..5, 1..100)) {
        let mut chip = awake();
        let parts = [(Channel::Gyro, 0), (Channel::Accel, 6)];
        let data = Data { address: 0x69, register: 0x0c, parts: &parts, order: i16::to_le_bytes, at_first: 0 };
        checks::bursts_at_any_pace_are_whole_samples_in_order(&mut chip, &[data], &paces)?;
    }

    #[test]
    fn the_fifo_keeps_the_newest_frames_in_order(paces in prop::collection::vec((0usize..60, 0usize..90), 1..20)) {
        let mut chip = awake();
        put(&mut chip, &[0x47, 0x80]);
        let fifo = Backlog {
            room: 1024 / 6,
            waiting: |chip| usize::from(u16::from_le_bytes(burst(chip, 0x22))) / 6,
            next: |chip| {
                let [low, high, ..] = burst::<6>(chip, 0x24);
                i16::from_le_bytes([low, high])
            },
            empty: 0x0080,
        };
        checks::the_fifo_keeps_the_newest_frames_in_order(&mut chip, &fifo, &paces)?;
    }
}
