use super::*;
use crate::chip::checks::{self, Data, Port, both, burst, kth, put, set, words};
use crate::chip::write;
use proptest::prelude::*;

/// Writes to a bank and goes back to bank 0.
fn put_in(chip: &mut Icm20948, bank: u8, bytes: &[u8]) {
    put(chip, &[0x7f, bank << 4]);
    put(chip, bytes);
    put(chip, &[0x7f, 0]);
}

fn awake() -> Icm20948 {
    let mut chip = Icm20948::new(0x69);
    put(&mut chip, &[0x06, 0x01]);
    chip
}

fn mag(counts: [i16; 3]) -> Samples {
    Samples { mag: Some(counts), ..kth(0) }
}

#[test]
fn it_answers_with_its_identity_and_sleeps_after_a_reset() {
    let mut chip = Icm20948::new(0x68);
    assert!(chip.at(0x69).is_none() && chip.at(0x0c).is_none());
    assert_eq!((burst(&mut chip, 0x00), burst(&mut chip, 0x05)), ([0xea], [0x40, 0x41, 0x00]));
    put_in(&mut chip, 2, &[0x01, 0x3f]);
    put(&mut chip, &[0x06, 0x80]);
    assert_eq!(burst(&mut chip, 0x06), [0x41], "the reset bit clears itself");
    put(&mut chip, &[0x7f, 0x20]);
    assert_eq!((burst(&mut chip, 0x01), burst(&mut chip, 0x14)), ([0x01], [0x01]), "reset");
}

#[test]
fn a_bank_hides_the_registers_of_the_others() {
    let mut chip = awake();
    put(&mut chip, &[0x7f, 0x30]);
    assert_eq!((burst(&mut chip, 0x7f), burst(&mut chip, 0x00)), ([0x30], [0x00]), "no identity in bank 3");
    put(&mut chip, &[0x06, 0x80]);
    put(&mut chip, &[0x7f, 0x00]);
    assert_eq!(burst(&mut chip, 0x06), [0x01], "0x06 of bank 3 is I2C_SLV0_DO and resets nothing");
}

#[test]
fn a_burst_reads_accel_gyro_and_temperature_of_one_sample() {
    let mut chip = awake();
    chip.sample(0, &Samples { temperature_c: Some(22.0), ..both([1, 2, 3], [-1, -2, 16384]) });
    let seen: [u8; 14] = burst(&mut chip, 0x2d);
    assert_eq!(seen, [0xff, 0xff, 0xff, 0xfe, 0x40, 0, 0, 1, 0, 2, 0, 3, 0x01, 0x4e], "333.87 counts a °C");
    put(&mut chip, &[0x06, 0x09]);
    chip.sample(0, &Samples { temperature_c: Some(21.0), ..kth(0) });
    assert_eq!(burst(&mut chip, 0x39), [0x01, 0x4e], "TEMP_DIS");
}

#[test]
fn data_ready_is_cleared_by_reading_its_own_register() {
    let mut chip = awake();
    put(&mut chip, &[0x0f, 0x10]); // INT_ANYRD_2CLEAR is of INT_STATUS alone
    put(&mut chip, &[0x11, 0x01]);
    assert!(!chip.interrupt());
    chip.sample(0, &kth(1));
    assert!(chip.interrupt());
    assert_eq!((burst(&mut chip, 0x2d), burst(&mut chip, 0x19)), ([0, 1], [0]));
    assert_eq!((burst(&mut chip, 0x1a), burst(&mut chip, 0x1a)), ([1], [0]));
    assert!(!chip.interrupt());
    assert_eq!((burst(&mut chip, 0x74), burst(&mut chip, 0x74)), ([1], [0]), "DATA_RDY_STATUS");
}

#[test]
fn asleep_disabled_or_without_a_clock_it_takes_no_sample() {
    let mut chip = Icm20948::new(0x68);
    for (power, gyro, accel) in [
        ([0x41, 0x00], [0, 0], [0, 0]),
        ([0x07, 0x00], [0, 0], [0, 0]),
        ([0x01, 0x38], [0, 7], [0, 0]),
        ([0x01, 0x07], [0, 0], [0, 7]),
    ] {
        put(&mut chip, &[0x06, 0x80]);
        put(&mut chip, &[0x06, power[0], power[1]]);
        chip.sample(0, &kth(7));
        assert_eq!((burst(&mut chip, 0x33), burst(&mut chip, 0x2d)), (gyro, accel), "{power:x?}");
    }
}

#[test]
fn rates_ranges_and_filters_are_those_of_the_register_map() {
    let rows: [([u8; 2], [u8; 3], Setting, Setting); 4] = [
        ([0, 0x01], [0, 0, 0x01], set((1125, 1), 0, Some("DLPF 0")), set((1125, 1), 0, Some("DLPF 0"))),
        (
            [255, 0x3f],
            [0x0f, 0xff, 0x3f],
            set((1125, 256), 3, Some("DLPF 7")),
            set((1125, 4096), 3, Some("DLPF 7")),
        ),
        ([4, 0x1b], [0xf0, 21, 0x2d], set((1125, 5), 1, Some("DLPF 3")), set((1125, 22), 2, Some("DLPF 5"))),
        ([4, 0x04], [0, 9, 0x02], set((9000, 1), 2, Some("bypass")), set((4500, 1), 1, Some("bypass"))),
    ];
    for (gyro_bytes, accel_bytes, gyro, accel) in rows {
        let mut chip = awake();
        put_in(&mut chip, 2, &[0x00, gyro_bytes[0], gyro_bytes[1]]);
        put_in(&mut chip, 2, &[0x10, accel_bytes[0], accel_bytes[1]]);
        put_in(&mut chip, 2, &[0x14, accel_bytes[2]]);
        let seen = (chip.setting(Channel::Gyro), chip.setting(Channel::Accel));
        assert_eq!(seen, (Some(gyro), Some(accel)), "{gyro_bytes:x?} {accel_bytes:x?}");
    }
}

#[test]
fn offsets_shift_what_is_read_at_every_full_scale() {
    let mut chip = awake();
    put_in(&mut chip, 2, &[0x03, 0, 10, 0xff, 0xf6, 0, 0]);
    put_in(&mut chip, 1, &[0x14, 0, 20]);
    for (bits, gyro, accel) in [(0x01, 40, 160), (0x03, 20, 80), (0x05, 10, 40), (0x07, 5, 20)] {
        put_in(&mut chip, 2, &[0x01, bits]);
        put_in(&mut chip, 2, &[0x14, bits]);
        chip.sample(0, &kth(100));
        assert_eq!(burst(&mut chip, 0x33), words([100 + gyro, 100 - gyro, 100]));
        assert_eq!(burst(&mut chip, 0x2d), words([100 + accel, 100, 100]));
    }
}

#[test]
fn the_magnetometer_answers_in_bypass_and_through_the_master() {
    let mut chip = awake();
    put(&mut chip, &[0x0f, 0x02]);
    write(chip.at(0x0c).expect("bypass"), 0, &[0x31, 0x08], false);
    assert_eq!(chip.setting(Channel::Mag).and_then(|setting| setting.rate), Some((100, 1)));
    put(&mut chip, &[0x03, 0x20]);
    assert!(chip.at(0x0c).is_none(), "the master has the bus");
    // Slave 4 reads the identity; slave 0 reads ST1 to ST2 at each sample.
    put_in(&mut chip, 3, &[0x13, 0x8c, 0x01, 0xc0]);
    assert_eq!((burst(&mut chip, 0x19), burst(&mut chip, 0x17)), ([0x01], [0x40]), "I2C_MST_INT, SLV4_DONE");
    put(&mut chip, &[0x7f, 0x30]);
    assert_eq!(burst(&mut chip, 0x15), [0x40, 0x00, 0x09], "enable clears itself");
    put_in(&mut chip, 3, &[0x03, 0x8c, 0x10, 0x89]);
    chip.sample(0, &mag([1, 2, -3]));
    assert_eq!(burst(&mut chip, 0x3b), [0x01, 1, 0, 2, 0, 0xfd, 0xff, 0, 0]);
    assert_eq!(chip.tally(Channel::Mag), Tally { made: 1, read: 1, ..Tally::default() });
    // Bytes swapped in words that begin at an odd address, behind a slave that nobody answers.
    put_in(&mut chip, 3, &[0x03, 0x8d, 0x00, 0x82, 0, 0x8c, 0x10, 0xd7]);
    chip.sample(0, &mag([4, 5, 6]));
    assert_eq!(burst(&mut chip, 0x3d), [0x01, 0, 4, 0, 5, 0, 6]);
    assert_eq!(burst(&mut chip, 0x17), [0x01], "slave 0 was not acknowledged");
}

#[test]
fn the_master_works_while_gyro_and_accelerometer_are_off() {
    let mut chip = awake();
    put(&mut chip, &[0x07, 0x3f]);
    put(&mut chip, &[0x03, 0x20]);
    put_in(&mut chip, 3, &[0x06, 0x08]);
    put_in(&mut chip, 3, &[0x03, 0x0c, 0x31, 0x81]);
    assert_eq!(chip.setting(Channel::Mag).and_then(|setting| setting.rate), Some((100, 1)), "CNTL2 written");
    put_in(&mut chip, 3, &[0x03, 0x8c, 0x11, 0x88]);
    chip.sample(0, &mag([7, 8, 9]));
    assert_eq!(burst(&mut chip, 0x3b), [7, 0, 8, 0, 9, 0]);
}

#[test]
fn the_fifo_holds_frames_in_the_order_of_registers_and_says_when_it_overflows() {
    let mut chip = awake();
    put(&mut chip, &[0x03, 0x40]);
    put(&mut chip, &[0x67, 0x1f]);
    put(&mut chip, &[0x12, 0x01]);
    chip.sample(0, &Samples { temperature_c: Some(21.0), ..both([1, 2, 3], [4, 5, 6]) });
    assert_eq!(burst(&mut chip, 0x70), [0, 14]);
    assert_eq!(burst(&mut chip, 0x72), [0, 4, 0, 5, 0, 6, 0, 1, 0, 2, 0, 3, 0, 0], "its address stays");
    assert_eq!(burst(&mut chip, 0x72), [0xff], "empty");
    put(&mut chip, &[0x67, 0x1e]);
    for k in 0..43 {
        chip.sample(0, &kth(k));
    }
    assert!(chip.interrupt(), "FIFO_OVERFLOW_EN");
    assert_eq!(burst(&mut chip, 0x70), 512u16.to_be_bytes());
    assert_eq!((burst(&mut chip, 0x1b), burst(&mut chip, 0x1b)), ([1], [0]), "cleared by reading");
    let lost = [Channel::Accel, Channel::Gyro].map(|channel| chip.tally(channel).overflowed);
    assert_eq!(lost, [1, 0], "4 bytes of 516 had no room, and the oldest are the accelerometer's");
    put(&mut chip, &[0x68, 0x1f]);
    chip.sample(0, &kth(0));
    assert_eq!(burst(&mut chip, 0x70), [0, 0], "held in reset");
    put(&mut chip, &[0x68, 0x1e]);
    chip.sample(0, &kth(0));
    assert_eq!(burst(&mut chip, 0x70), [0, 12]);
    assert_eq!(chip.tally(Channel::Gyro).missed, 43 + 1, "those in the FIFO, and the one while it was held");
}

#[test]
fn a_snapshot_keeps_the_oldest_and_a_count_is_that_of_its_high_byte() {
    let mut chip = awake();
    put(&mut chip, &[0x03, 0x40]);
    put(&mut chip, &[0x69, 0x01]);
    put(&mut chip, &[0x67, 0x0e]);
    for k in 0..100 {
        chip.sample(0, &kth(k));
    }
    assert_eq!(burst(&mut chip, 0x70), 510u16.to_be_bytes(), "85 frames");
    assert_eq!(burst(&mut chip, 0x72), [0, 0, 0, 0, 0, 0, 0, 1]);
    assert_eq!(burst(&mut chip, 0x71), [(510u16 & 0xff) as u8], "latched");
    assert_eq!(burst(&mut chip, 0x70), 502u16.to_be_bytes());
    assert_eq!(chip.tally(Channel::Gyro).overflowed, 15);
}

#[test]
fn the_fifo_takes_what_a_slave_has_read() {
    let mut chip = awake();
    put(&mut chip, &[0x0f, 0x02]);
    write(chip.at(0x0c).expect("bypass"), 0, &[0x31, 0x08], false);
    put(&mut chip, &[0x03, 0x60]);
    put(&mut chip, &[0x66, 0x02, 0x02]);
    put_in(&mut chip, 3, &[0x03, 0x8c, 0x00, 0x82, 0, 0x8c, 0x11, 0x88]);
    chip.sample(0, &Samples { gyro: Some([1, 2, 3]), ..mag([4, 5, 6]) });
    assert_eq!(burst(&mut chip, 0x72), [0, 1, 4, 0, 5, 0, 6, 0, 0, 0], "gyro x, and slave 1 alone");
}

#[test]
fn what_is_not_there_is_told() {
    let rows: [(u8, &[u8], &str); 5] = [
        (0, &[0x03, 0x80], "DMP"),
        (0, &[0x03, 0x10], "I²C"),
        (0, &[0x05, 0x20], "duty"),
        (2, &[0x02, 0x08], "self-test"),
        (2, &[0x15, 0x04], "self-test"),
    ];
    for (bank, bytes, told) in rows {
        let mut chip = awake();
        assert_eq!(chip.lacks(), None);
        put_in(&mut chip, bank, bytes);
        assert!(chip.lacks().is_some_and(|lack| lack.contains(told)), "{:?}", chip.lacks());
    }
}

proptest! {
    #[test]
    fn every_sample_is_accounted_for(steps in checks::steps()) {
        let mut chip = awake();
        put(&mut chip, &[0x03, 0x60]);
        put(&mut chip, &[0x67, 0x1e]);
        let port = Port { address: 0x69, fifo: (0x72, 37), reset: &[&[0x7f, 0], &[0x06, 0x80]] };
        checks::every_sample_is_accounted_for(&mut chip, &[port], &steps)?;
    }

    #[test]
    fn bursts_at_any_pace_are_whole_samples_in_order(paces in prop::collection::vec(0u8..5, 1..100)) {
        let mut chip = awake();
        let parts = [(Channel::Accel, 0), (Channel::Gyro, 6)];
        let data = Data { address: 0x69, register: 0x2d, parts: &parts, order: i16::to_be_bytes, at_first: 0 };
        checks::bursts_at_any_pace_are_whole_samples_in_order(&mut chip, &[data], &paces)?;
    }
}
