extern crate std;

use super::*;
use crate::chip::checks::{self, Backlog, Data, Port, both, burst, kth, put, rates, set};
use crate::chip::{read, write};
use proptest::prelude::*;
use std::vec::Vec;

/// Both sensors at 104 Hz, ±2 g and ±250 °/s.
fn awake() -> Lsm6dso {
    let mut chip = Lsm6dso::new(0x6a);
    put(&mut chip, &[0x10, 0x40, 0x40]);
    chip
}

#[test]
fn registers_reset_as_the_sheet_says() {
    let mut chip = awake();
    assert_eq!(burst(&mut chip, 0x0f), [0x6c]);
    put(&mut chip, &[0x07, 9, 1, 2, 6]);
    put(&mut chip, &[0x12, 0x01]);
    assert_eq!(burst(&mut chip, 0x10), [0, 0, 0x04, 0, 0, 0, 0, 0, 0xe0, 0], "and the bit clears itself");
    assert_eq!(burst(&mut chip, 0x07), [0; 8]);
    assert_eq!(burst(&mut chip, 0x02), [0x3f]);
    put(&mut chip, &[0x12, 0xc4]);
    assert_eq!(burst(&mut chip, 0x12), [0x44], "BOOT clears itself too");
}

#[test]
fn a_sensor_that_is_off_has_no_rate_and_keeps_its_data() {
    let mut chip = Lsm6dso::new(0x6b);
    assert!(chip.at(0x6a).is_none() && chip.at(0x6b).is_some());
    chip.sample(0, &kth(4));
    assert_eq!((chip.tally(Channel::Gyro).made, burst(&mut chip, 0x1e)), (0, [0]));
    put(&mut chip, &[0x10, 0x40, 0x40]);
    chip.sample(0, &kth(5));
    put(&mut chip, &[0x13, 0x40]);
    chip.sample(0, &kth(6));
    assert_eq!(chip.setting(Channel::Gyro).map(|setting| setting.rate), Some(None), "SLEEP_G");
    assert_eq!((burst(&mut chip, 0x22), burst(&mut chip, 0x28)), ([5, 0], [6, 0]));
}

#[test]
fn rates_ranges_and_filters_are_those_of_the_register_map() {
    let codes = [(25, 2), (26, 1), (52, 1), (104, 1), (208, 1), (416, 1), (833, 1), (1666, 1), (3332, 1)];
    for (code, rate) in (1u8..).zip(codes.into_iter().chain([(6664, 1)])) {
        let mut chip = Lsm6dso::new(0x6a);
        put(&mut chip, &[0x10, code << 4, code << 4]);
        assert_eq!(chip.setting(Channel::Gyro), Some(set(rate, 1, Some("LPF2"))));
        assert_eq!(chip.setting(Channel::Accel), Some(set(rate, 0, Some("LPF1 ODR/2"))));
    }
    // CTRL1_XL to CTRL8_XL.
    let rows: [([u8; 8], Setting, Setting); 6] = [
        (
            [0x44, 0x42, 4, 2, 0, 5, 0, 0],
            set((104, 1), 0, Some("LPF1 FTYPE 5")),
            set((104, 1), 3, Some("LPF1 ODR/2")),
        ),
        (
            [0x46, 0x44, 4, 2, 0, 5, 0x80, 0xe2],
            set((104, 1), 2, Some("LPF2")),
            set((104, 1), 0, Some("LPF2 ODR/800")),
        ),
        (
            [0x4a, 0x48, 4, 0, 0, 5, 0, 0x20],
            set((104, 1), 3, Some("LPF2")),
            set((104, 1), 1, Some("LPF2 ODR/10")),
        ),
        ([0x4e, 0x4c, 4, 0, 0, 0, 0, 0x64], set((104, 1), 4, Some("LPF2")), set((104, 1), 2, None)),
        ([0xb0, 0x40, 4, 0, 0, 0, 0, 0], set((104, 1), 1, Some("LPF2")), set((25, 2), 0, Some("LPF1 ODR/2"))),
        ([0xb0, 0x40, 4, 0, 0, 0x10, 0, 0], set((104, 1), 1, Some("LPF2")), set((8, 5), 0, None)),
    ];
    for (controls, gyro, accel) in rows {
        let mut chip = Lsm6dso::new(0x6a);
        put(&mut chip, &[&[0x10], &controls[..]].concat());
        assert_eq!(chip.setting(Channel::Gyro), Some(gyro), "{controls:x?}");
        assert_eq!(chip.setting(Channel::Accel), Some(accel), "{controls:x?}");
    }
    let mut chip = Lsm6dso::new(0x6a);
    put(&mut chip, &[0x10, 0xc0, 0xb0]);
    assert_eq!(rates(&chip), [None; 2], "reserved codes");
}

#[test]
fn data_is_new_until_a_high_byte_is_read() {
    let mut chip = awake();
    put(&mut chip, &[0x0d, 0x03]);
    chip.sample(0, &Samples { temperature_c: Some(26.0), ..both([1, 2, -3], [4, 5, -6]) });
    assert_eq!((burst(&mut chip, 0x1e), chip.interrupt()), ([0x07], true));
    let expected = [0, 1, 1, 0, 2, 0, 0xfd, 0xff, 4, 0, 5, 0, 0xfa, 0xff];
    assert_eq!(burst(&mut chip, 0x22), [1]);
    assert_eq!(burst(&mut chip, 0x1e), [0x07], "a low byte");
    assert_eq!(burst(&mut chip, 0x20), expected, "temperature, gyro, accelerometer, low byte first");
    assert_eq!((burst(&mut chip, 0x1e), chip.interrupt()), ([0], false));
    put(&mut chip, &[0x0d, 0x00, 0x01]);
    chip.sample(0, &kth(1));
    assert!(!chip.interrupt(), "routed to INT2");
    put(&mut chip, &[0x13, 0x20]);
    assert!(chip.interrupt(), "INT2_on_INT1");
}

#[test]
fn addresses_count_up_with_if_inc_alone_and_go_round() {
    let mut chip = awake();
    chip.sample(0, &both([1; 3], [2; 3]));
    put(&mut chip, &[0x14, 0x60]);
    assert_eq!(burst(&mut chip, 0x22), [1, 0, 1, 0, 1, 0, 2, 0, 2, 0, 2, 0, 1, 0], "ROUNDING");
    put(&mut chip, &[0x14, 0x20]);
    assert_eq!(burst(&mut chip, 0x2c), [2, 0, 2]);
    put(&mut chip, &[0x12, 0x00]);
    assert_eq!(burst(&mut chip, 0x0f), [0x6c; 3]);
}

#[test]
fn offsets_of_the_user_are_subtracted_where_they_are_enabled() {
    let mut chip = awake();
    put(&mut chip, &[0x73, 1, 0xff, 0]);
    chip.sample(0, &kth(0));
    assert_eq!(burst(&mut chip, 0x28), [0; 6]);
    put(&mut chip, &[0x16, 0x02]);
    for (range, weight, count) in [(0x40, 0x00, 16), (0x48, 0x00, 8), (0x40, 0x08, 256), (0x44, 0x08, 32)] {
        put(&mut chip, &[0x10, range]);
        put(&mut chip, &[0x15, weight]);
        chip.sample(0, &kth(0));
        let expected = [-count, count, 0].map(i16::to_le_bytes).concat();
        assert_eq!(burst::<6>(&mut chip, 0x28)[..], expected);
    }
}

#[test]
fn pages_and_the_timestamp_are_as_in_the_sheet() {
    let mut chip = awake();
    put(&mut chip, &[0x01, 0x80]);
    put(&mut chip, &[0x10, 0x55]);
    put(&mut chip, &[0x01, 0x40]);
    assert_eq!(burst(&mut chip, 0x10), [0], "the sensor hub's page");
    put(&mut chip, &[0x01, 0x80]);
    assert_eq!(burst(&mut chip, 0x10), [0x55], "the embedded functions' page");
    put(&mut chip, &[0x01, 0x00]);
    assert_eq!(burst(&mut chip, 0x10), [0x40]);
    write(&mut chip, 1_000_000, &[0x19, 0x20], false);
    let time = |chip: &mut Lsm6dso, t_ns| {
        let mut bytes = [0; 4];
        write(chip, t_ns, &[0x40], false);
        read(chip, t_ns, &mut bytes);
        u32::from_le_bytes(bytes)
    };
    assert_eq!(time(&mut chip, 11_000_000), 400, "25 µs a unit");
    write(&mut chip, 11_000_000, &[0x42, 0xaa], false);
    assert_eq!(time(&mut chip, 11_025_000), 1);
}

#[test]
fn words_have_tags_whose_ones_are_even() {
    let mut chip = awake();
    put(&mut chip, &[0x09, 0x44, 0x06]);
    for k in 1..=5 {
        chip.sample(0, &both([k; 3], [-k; 3]));
    }
    assert_eq!(burst(&mut chip, 0x3a), [10, 0]);
    for k in 1..=5u8 {
        let words: [u8; 14] = burst(&mut chip, 0x78);
        let neg = 0u8.wrapping_sub(k);
        assert_eq!(words[1..7], [k, 0, k, 0, k, 0]);
        assert_eq!(words[8..], [neg, 0xff, neg, 0xff, neg, 0xff]);
        for (tag, sensor) in [(words[0], 1), (words[7], 2)] {
            assert_eq!((tag >> 3, tag >> 1 & 3, tag.count_ones() % 2), (sensor, k & 3, 0));
        }
    }
    assert_eq!((burst(&mut chip, 0x3a), burst(&mut chip, 0x78)), ([0, 0], [0; 7]));
    assert_eq!(chip.tally(Channel::Gyro), Tally { made: 5, read: 5, ..Tally::default() });
}

#[test]
fn a_word_leaves_when_its_last_byte_is_read() {
    let mut chip = awake();
    put(&mut chip, &[0x09, 0x04, 0x06]);
    chip.sample(0, &kth(7));
    let tag: [u8; 1] = burst(&mut chip, 0x78);
    assert_eq!((tag[0] >> 3, burst(&mut chip, 0x3a)), (2, [1]), "the tag by itself");
    assert_eq!((burst(&mut chip, 0x79), burst(&mut chip, 0x3a)), ([7, 0, 7, 0, 7, 0], [0]));
}

#[test]
fn batch_rates_divide_each_sensors_own() {
    for (batches, gyro, accel) in
        [(0x44, 64, 64), (0x32, 32, 16), (0xa9, 64, 64), (0xb0, 4, 0), (0x0b, 0, 1), (0x11, 8, 8)]
    {
        let mut chip = awake();
        put(&mut chip, &[0x09, batches, 0x06]);
        let mut count = 0;
        for k in 0..64 {
            chip.sample(0, &kth(k));
            let [level] = burst(&mut chip, 0x3a);
            count += usize::from(level);
            for _ in 0..level {
                burst::<7>(&mut chip, 0x78);
            }
        }
        assert_eq!(count, gyro + accel, "{batches:x}");
        let read = [Channel::Gyro, Channel::Accel].map(|channel| chip.tally(channel).read as usize);
        assert_eq!(read, [gyro, accel], "{batches:x}");
    }
}

#[test]
fn fifo_mode_keeps_the_oldest_and_continuous_mode_the_newest() {
    for (mode, first) in [(0x01, 0), (0x06, 600 - 512)] {
        let mut chip = awake();
        put(&mut chip, &[0x09, 0x40, mode]);
        for k in 0..510 {
            chip.sample(0, &kth(k));
        }
        assert_eq!(burst(&mut chip, 0x3a), [254, 0x01]);
        chip.sample(0, &kth(510));
        assert_eq!(burst(&mut chip, 0x3a), [255, 0x21], "full with the next");
        chip.sample(0, &kth(511));
        assert_eq!(burst(&mut chip, 0x3a), [0, 0x62], "full");
        for k in 512..600 {
            chip.sample(0, &kth(k));
        }
        assert_eq!((burst(&mut chip, 0x3b), burst(&mut chip, 0x3b)), ([0x6a], [0x62]), "overrun, told once");
        assert_eq!(burst::<3>(&mut chip, 0x78)[1..], i16::to_le_bytes(first), "mode {mode}");
        assert_eq!(chip.tally(Channel::Gyro).overflowed, 88);
        put(&mut chip, &[0x0a, 0x00]);
        assert_eq!((burst(&mut chip, 0x3a), chip.tally(Channel::Gyro).missed), ([0, 0], 512));
    }
}

#[test]
fn the_watermark_the_counter_and_their_interrupts_are_as_in_the_sheet() {
    let mut chip = awake();
    put(&mut chip, &[0x07, 4, 0x00, 0x44, 0x06, 0x20, 3, 0x08]);
    for (k, status) in [(1, 0), (2, 0x80), (3, 0x90)] {
        chip.sample(0, &kth(k));
        assert_eq!((burst(&mut chip, 0x3b), chip.interrupt()), ([status], status & 0x80 != 0), "{k}");
    }
    assert_eq!((burst(&mut chip, 0x0b), burst(&mut chip, 0x3b)), ([0x20], [0x80]), "cleared by reading");
    put(&mut chip, &[0x08, 0x80]);
    put(&mut chip, &[0x0a, 0x00]);
    put(&mut chip, &[0x0a, 0x06]);
    for k in 0..10 {
        chip.sample(0, &kth(k));
    }
    assert_eq!(burst(&mut chip, 0x3a), [4, 0xf8], "STOP_ON_WTM");
}

#[test]
fn temperature_and_time_are_batched_where_they_are_asked_for() {
    let mut chip = awake();
    put(&mut chip, &[0x19, 0x20]);
    put(&mut chip, &[0x09, 0x04, 0x66]);
    let at = |chip: &mut Lsm6dso, t_ns| {
        chip.sample(t_ns, &Samples { temperature_c: Some(26.0), ..kth(1) });
        let [level] = burst(chip, 0x3a);
        (0..level)
            .map(|_| burst::<7>(chip, 0x78))
            .map(|word| (word[0] >> 3, word[1..5].to_vec()))
            .collect::<Vec<_>>()
    };
    let words = at(&mut chip, 1_000_000);
    assert_eq!(words, [(4, [40, 0, 0, 0].into()), (2, [1, 0, 1, 0].into()), (3, [0, 1, 0, 0].into())]);
    let tags = |words: Vec<(u8, Vec<u8>)>| words.into_iter().map(|word| word.0).collect::<Vec<_>>();
    assert_eq!(tags(at(&mut chip, 80_999_999)), [4, 2], "12.5 Hz");
    assert_eq!(tags(at(&mut chip, 81_000_000)), [4, 2, 3]);
}

#[test]
fn what_is_turned_on_and_not_modelled_is_told() {
    for bytes in [[0x14, 0x01], [0x16, 0x40], [0x17, 0x04], [0x0a, 0x03], [0x0a, 0x07]] {
        let mut chip = awake();
        assert_eq!(chip.lacks(), None);
        put(&mut chip, &bytes);
        assert!(chip.lacks().is_some(), "{bytes:x?}");
    }
}

proptest! {
    #[test]
    fn every_sample_is_accounted_for(steps in checks::steps()) {
        let mut chip = awake();
        put(&mut chip, &[0x09, 0x44, 0x06]);
        let port = Port { address: 0x6a, fifo: (0x78, 30), reset: &[&[0x01, 0x00], &[0x12, 0x01]] };
        checks::every_sample_is_accounted_for(&mut chip, &[port], &steps)?;
    }

    #[test]
    fn bursts_at_any_pace_are_whole_samples_in_order(paces in prop::collection::vec(0u8..5, 1..100)) {
        let mut chip = awake();
        let parts = [(Channel::Gyro, 0), (Channel::Accel, 6)];
        let data = Data { address: 0x6a, register: 0x22, parts: &parts, order: i16::to_le_bytes, at_first: 0 };
        checks::bursts_at_any_pace_are_whole_samples_in_order(&mut chip, &[data], &paces)?;
    }

    #[test]
    fn the_fifo_keeps_the_newest_words_in_order(paces in prop::collection::vec((0usize..300, 0usize..300), 1..20)) {
        let mut chip = awake();
        put(&mut chip, &[0x09, 0x04, 0x06]);
        let fifo = Backlog {
            room: 512,
            waiting: |chip| usize::from(u16::from_le_bytes(burst(chip, 0x3a)) & 0x3ff),
            next: |chip| {
                let [_, low, high, ..] = burst::<7>(chip, 0x78);
                i16::from_le_bytes([low, high])
            },
            empty: 0,
        };
        checks::the_fifo_keeps_the_newest_frames_in_order(&mut chip, &fifo, &paces)?;
    }
}
