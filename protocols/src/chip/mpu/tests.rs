use super::*;
use crate::chip::checks::{self, Data, Port, both, burst, kth, put, set, words};
use crate::chip::write;
use proptest::prelude::*;

#[test]
fn each_answers_with_its_own_identity_and_wakes_as_its_sheet_says() {
    for (mut chip, who, power) in [
        (Mpu::mpu6050(0x68), 0x68, 0x40),
        (Mpu::mpu6500(0x68), 0x70, 0x40),
        (Mpu::mpu9250(0x68, [128; 3]), 0x71, 0x01),
    ] {
        assert_eq!((burst(&mut chip, 0x75), burst(&mut chip, 0x6b)), ([who], [power]));
        put(&mut chip, &[0x1b, 0x18]);
        put(&mut chip, &[0x6b, 0x80]);
        assert_eq!(burst(&mut chip, 0x1b), [0], "reset");
        assert_eq!(burst(&mut chip, 0x6b), [power], "the reset bit clears itself");
    }
}

#[test]
fn a_burst_reads_accel_temperature_and_gyro_of_one_sample() {
    let mut chip = Mpu::mpu6050(0x68);
    put(&mut chip, &[0x6b, 0]);
    chip.sample(0, &Samples { temperature_c: Some(36.53), ..both([1, 2, 3], [-1, -2, 16384]) });
    let seen: [u8; 14] = burst(&mut chip, 0x3b);
    assert_eq!(seen, [0xff, 0xff, 0xff, 0xfe, 0x40, 0, 0, 0, 0, 1, 0, 2, 0, 3]);
    assert_eq!(burst(&mut chip, 0x3a), [1], "data ready");
    assert_eq!(burst(&mut chip, 0x3a), [0], "cleared by reading");
}

#[test]
fn asleep_or_in_standby_it_takes_no_sample() {
    let mut chip = Mpu::mpu6050(0x68);
    chip.sample(0, &kth(7));
    assert_eq!((burst(&mut chip, 0x43), chip.tally(Channel::Gyro).made), ([0, 0], 0));
    put(&mut chip, &[0x6b, 0, 0x38]);
    assert_eq!(chip.setting(Channel::Accel).and_then(|setting| setting.rate), None, "PWR_MGMT_2");
    chip.sample(0, &kth(7));
    assert_eq!((burst(&mut chip, 0x43), burst(&mut chip, 0x3b)), ([0, 7], [0, 0]));
}

#[test]
fn rates_ranges_and_filters_are_those_of_the_register_map() {
    let rows: [(Mpu, &[u8], Setting, Setting); 6] = [
        (
            Mpu::mpu6050(0x68),
            &[0x19, 0, 0, 0, 0],
            set((8000, 1), 0, Some("DLPF 0")),
            set((1000, 1), 0, Some("DLPF 0")),
        ),
        (
            Mpu::mpu6050(0x68),
            &[0x19, 7, 0, 0x18, 0x08],
            set((8000, 8), 3, Some("DLPF 0")),
            set((8000, 8), 1, Some("DLPF 0")),
        ),
        (
            Mpu::mpu6050(0x68),
            &[0x19, 4, 3, 0x08, 0x10],
            set((1000, 5), 1, Some("DLPF 3")),
            set((1000, 5), 2, Some("DLPF 3")),
        ),
        (
            Mpu::mpu6500(0x68),
            &[0x19, 4, 3, 0, 0, 2],
            set((1000, 5), 0, Some("DLPF 3")),
            set((1000, 5), 0, Some("DLPF 2")),
        ),
        (
            Mpu::mpu9250(0x68, [128; 3]),
            &[0x19, 9, 7, 0, 0, 8],
            set((8000, 1), 0, Some("DLPF 7")),
            set((4000, 1), 0, Some("Fchoice 0")),
        ),
        (
            Mpu::mpu9250(0x68, [128; 3]),
            &[0x19, 9, 1, 2, 0, 7],
            set((32000, 1), 0, Some("Fchoice 01")),
            set((1000, 10), 0, Some("DLPF 7")),
        ),
    ];
    for (mut chip, bytes, gyro, accel) in rows {
        put(&mut chip, &[0x6b, 0]);
        put(&mut chip, bytes);
        assert_eq!(
            (chip.setting(Channel::Gyro), chip.setting(Channel::Accel)),
            (Some(gyro), Some(accel)),
            "{bytes:?}"
        );
    }
}

#[test]
fn offsets_shift_what_is_read_at_every_full_scale() {
    let mut chip = Mpu::mpu6500(0x68);
    put(&mut chip, &[0x6b, 0]);
    put(&mut chip, &[0x13, 0, 10, 0xff, 0xf6, 0, 0]);
    put(&mut chip, &[0x77, 0, 20]);
    for (bits, gyro, accel) in [(0x00, 40, 160), (0x08, 20, 80), (0x10, 10, 40), (0x18, 5, 20)] {
        put(&mut chip, &[0x1b, bits, bits]);
        chip.sample(0, &kth(100));
        assert_eq!(burst(&mut chip, 0x43), words([100 + gyro, 100 - gyro, 100]));
        assert_eq!(burst(&mut chip, 0x3b), words([100 + accel, 100, 100]));
    }
}

#[test]
fn the_magnetometer_answers_in_bypass_and_through_the_master() {
    let mut chip = Mpu::mpu9250(0x68, [128; 3]);
    assert!(chip.at(0x0c).is_none());
    put(&mut chip, &[0x37, 0x02]);
    write(chip.at(0x0c).expect("bypass"), 0, &[0x0a, 0x16], false);
    put(&mut chip, &[0x6a, 0x20]);
    assert!(chip.at(0x0c).is_none(), "the master has the bus");
    // Slave 4 reads the identity; slave 0 reads 7 bytes from HXL at each sample.
    put(&mut chip, &[0x31, 0x8c, 0x00, 0, 0x80]);
    assert_eq!((burst(&mut chip, 0x36), burst(&mut chip, 0x35)), ([0x40], [0x48]));
    put(&mut chip, &[0x25, 0x8c, 0x03, 0x87]);
    chip.sample(0, &Samples { mag: Some([1, 2, 3]), ..kth(0) });
    assert_eq!(burst(&mut chip, 0x49), [1, 0, 2, 0, 3, 0, 0x10]);
    assert_eq!(chip.tally(Channel::Mag), Tally { made: 1, read: 1, ..Tally::default() });
    chip.sample(0, &kth(0));
    let again: [u8; 7] = burst(&mut chip, 0x49);
    assert_eq!((again[0], chip.tally(Channel::Mag).again), (1, 1), "no newer one yet");
    // With its bytes swapped in words that begin at an odd address.
    put(&mut chip, &[0x25, 0x8c, 0x02, 0xd8]);
    chip.sample(0, &Samples { mag: Some([4, 5, 6]), ..kth(0) });
    assert_eq!(burst::<7>(&mut chip, 0x49)[1..], [0, 4, 0, 5, 0, 6]);
    put(&mut chip, &[0x31, 0x8d, 0x00, 0, 0x80]);
    assert_eq!(burst(&mut chip, 0x36), [0x50], "nobody at 0x0d: done, not acknowledged");
}

#[test]
fn the_fifo_holds_frames_in_the_order_of_registers_and_says_when_it_overflows() {
    let mut chip = Mpu::mpu6050(0x68);
    put(&mut chip, &[0x6b, 0]);
    put(&mut chip, &[0x6a, 0x44]);
    put(&mut chip, &[0x23, 0x78]);
    chip.sample(0, &both([1, 2, 3], [4, 5, 6]));
    assert_eq!(burst(&mut chip, 0x72), [0, 12]);
    assert_eq!(burst(&mut chip, 0x74), [0, 4, 0, 5, 0, 6, 0, 1, 0, 2, 0, 3], "its address stays");
    assert_eq!(burst(&mut chip, 0x74), [3], "empty: the last byte again");
    for k in 0..86 {
        chip.sample(0, &kth(k));
    }
    let count: [u8; 2] = burst(&mut chip, 0x72);
    assert!(u16::from_be_bytes(count) > 1012, "full: {count:?}");
    assert_eq!(burst(&mut chip, 0x3a), [0x11], "overflow, and data ready");
    assert_eq!(chip.tally(Channel::Gyro), Tally { made: 87, read: 1, overflowed: 1, ..Tally::default() });
    put(&mut chip, &[0x6a, 0x44]);
    assert_eq!(burst(&mut chip, 0x72), [0, 0], "reset, and the reset bit clears itself");
    assert_eq!(chip.tally(Channel::Gyro).missed, 85);
}

#[test]
fn a_frame_counts_the_samples_that_are_new_in_it() {
    let mut chip = Mpu::mpu6050(0x68);
    put(&mut chip, &[0x6b, 0]);
    put(&mut chip, &[0x6a, 0x44]);
    put(&mut chip, &[0x23, 0x78]);
    chip.sample(0, &Samples { gyro: None, ..kth(1) });
    assert_eq!(burst(&mut chip, 0x72), [0, 0], "the gyro's samples make the frames");
    put(&mut chip, &[0x6c, 0x07]);
    chip.sample(0, &kth(2));
    assert_eq!(burst(&mut chip, 0x74), [0, 2, 0, 2, 0, 2, 0, 0, 0, 0, 0, 0], "unless it is off");
    assert_eq!(chip.tally(Channel::Accel), Tally { made: 2, read: 1, missed: 1, ..Tally::default() });
    assert_eq!(chip.tally(Channel::Gyro), Tally::default());
}

#[test]
fn a_fifo_that_stops_keeps_the_oldest() {
    let mut chip = Mpu::mpu9250(0x68, [128; 3]);
    put(&mut chip, &[0x1a, 0x41]);
    put(&mut chip, &[0x6a, 0x44]);
    put(&mut chip, &[0x23, 0x70]);
    for k in 0..100 {
        chip.sample(0, &kth(k));
    }
    assert_eq!(burst(&mut chip, 0x72), 510u16.to_be_bytes(), "85 frames in 512 bytes");
    assert_eq!(burst(&mut chip, 0x74), [0, 0, 0, 0, 0, 0, 0, 1]);
    assert_eq!(chip.tally(Channel::Gyro).overflowed, 15);
}

#[test]
fn the_dmps_memory_reads_back_and_its_absence_is_told() {
    let mut chip = Mpu::mpu6050(0x68);
    put(&mut chip, &[0x6d, 2, 0xf0]);
    put(&mut chip, &[0x6f, 1, 2, 3, 4]);
    put(&mut chip, &[0x6d, 2, 0xf1]);
    assert_eq!(burst(&mut chip, 0x6f), [2, 3, 4]);
    assert_eq!(chip.lacks(), None);
    put(&mut chip, &[0x6a, 0x80]);
    assert!(chip.lacks().is_some_and(|lack| lack.contains("DMP")));
}

proptest! {
    #[test]
    fn every_sample_is_accounted_for(steps in checks::steps(), model in 0..3usize) {
        let mut chip = [Mpu::mpu6050(0x68), Mpu::mpu6500(0x68), Mpu::mpu9250(0x68, [1, 2, 3])][model].clone();
        put(&mut chip, &[0x6b, 0]);
        let port = Port { address: 0x68, fifo: (0x74, 30), reset: &[&[0x6b, 0x80]] };
        checks::every_sample_is_accounted_for(&mut chip, &[port], &steps)?;
    }

    #[test]
    fn bursts_at_any_pace_are_whole_samples_in_order(paces in prop::collection::vec(0u8..5, 1..100)) {
        let mut chip = Mpu::mpu6050(0x68);
        put(&mut chip, &[0x6b, 0]);
        let parts = [(Channel::Accel, 0), (Channel::Gyro, 8)];
        let data = Data { address: 0x68, register: 0x3b, parts: &parts, order: i16::to_be_bytes, at_first: 0 };
        checks::bursts_at_any_pace_are_whole_samples_in_order(&mut chip, &[data], &paces)?;
    }
}

#[test]
fn an_accelerometer_that_samples_between_the_gyros_samples_is_counted_once_in_the_fifo() {
    let mut chip = Mpu::mpu6500(0x68);
    for write in [[0x6b, 0], [0x23, 0x78], [0x6a, 0x44]] {
        put(&mut chip, &write);
    }
    for k in 0..10 {
        chip.sample(0, &Samples { accel: Some([k; 3]), ..Samples::default() });
        chip.sample(0, &Samples { gyro: Some([k; 3]), ..Samples::default() });
    }
    let _: [u8; 120] = burst(&mut chip, 0x74);
    let all = Tally { made: 10, read: 10, ..Tally::default() };
    assert_eq!([Channel::Gyro, Channel::Accel].map(|channel| chip.tally(channel)), [all; 2]);
    // One that a newer one replaces enters no FIFO, and one that finds it off neither.
    for k in 0..2 {
        chip.sample(0, &Samples { accel: Some([k; 3]), ..Samples::default() });
    }
    put(&mut chip, &[0x6a, 0x00]);
    chip.sample(0, &Samples { gyro: Some([0; 3]), ..Samples::default() });
    assert_eq!(chip.tally(Channel::Accel), Tally { made: 12, missed: 2, ..all });
}
