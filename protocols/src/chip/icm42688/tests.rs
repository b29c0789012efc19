use super::*;
use crate::chip::checks::{self, Data, Port, both, burst, kth, put, words};
use crate::chip::write;
use proptest::prelude::*;

/// Writes to a bank and goes back to bank 0.
fn put_in(chip: &mut Icm42688, bank: u8, bytes: &[u8]) {
    put(chip, &[0x76, bank]);
    put(chip, bytes);
    put(chip, &[0x76, 0]);
}

/// Both in low-noise mode.
fn awake() -> Icm42688 {
    let mut chip = Icm42688::new(0x68);
    put(&mut chip, &[0x4e, 0x0f]);
    burst::<1>(&mut chip, 0x2d);
    chip
}

/// With a FIFO in stream mode: FIFO_CONFIG1 is `config`.
fn streaming(config: u8) -> Icm42688 {
    let mut chip = awake();
    put(&mut chip, &[0x5f, config]);
    put(&mut chip, &[0x16, 0x40]);
    chip
}

#[test]
fn it_answers_with_its_identity_and_tells_that_a_reset_is_done() {
    let mut chip = Icm42688::new(0x69);
    assert!(chip.at(0x68).is_none());
    assert_eq!(burst(&mut chip, 0x75), [0x47]);
    assert!(chip.interrupt(), "RESET_DONE is routed to INT1 at first");
    assert_eq!((burst(&mut chip, 0x2d), burst(&mut chip, 0x2d)), ([0x10], [0x00]), "cleared by reading");
    put(&mut chip, &[0x4f, 0x26, 0x46, 0x1a]);
    put(&mut chip, &[0x11, 0x01]);
    assert_eq!(burst(&mut chip, 0x11), [0x00], "the reset bit clears itself");
    assert_eq!(burst(&mut chip, 0x4c), [0x30, 0x91, 0x00, 0x06, 0x06, 0x16, 0x11, 0x0d, 0x23]);
    assert_eq!(burst(&mut chip, 0x2d), [0x10]);
}

#[test]
fn a_bank_hides_the_registers_of_the_others() {
    let mut chip = awake();
    put(&mut chip, &[0x76, 0x01]);
    assert_eq!((burst(&mut chip, 0x76), burst(&mut chip, 0x0b)), ([0x01], [0xa0, 0x0d, 0xaa, 0x80]));
    assert_eq!(burst(&mut chip, 0x75), [0x00], "no identity in bank 1");
    put(&mut chip, &[0x76, 0x07]);
    assert_eq!(burst(&mut chip, 0x76), [0x01], "bank 7 is reserved");
    put(&mut chip, &[0x76, 0x02]);
    assert_eq!(burst(&mut chip, 0x03), [0x30, 0x40, 0x62]);
}

#[test]
fn a_burst_reads_temperature_accel_and_gyro_of_one_sample() {
    let mut chip = awake();
    let none = [0x80, 0, 0x80, 0, 0x80, 0, 0x80, 0, 0x80, 0, 0x80, 0, 0x80, 0];
    assert_eq!(burst(&mut chip, 0x1d), none, "before the first sample");
    chip.sample(0, &Samples { temperature_c: Some(26.0), ..both([1, 2, 3], [-1, -2, 16384]) });
    let seen: [u8; 14] = burst(&mut chip, 0x1d);
    assert_eq!(seen, [0x00, 0x84, 0xff, 0xff, 0xff, 0xfe, 0x40, 0, 0, 1, 0, 2, 0, 3]);
    put(&mut chip, &[0x4c, 0x20]);
    assert_eq!(burst(&mut chip, 0x1d), [0x84, 0, 0xff, 0xff, 0xfe, 0xff, 0, 0x40], "little-endian");
    put(&mut chip, &[0x11, 0x01]);
    put(&mut chip, &[0x4c, 0xb0]);
    assert_eq!(burst(&mut chip, 0x1d), [0; 14], "FIFO_HOLD_LAST_DATA_EN");
}

#[test]
fn the_two_lowest_counts_are_kept_for_what_is_invalid() {
    for (config, lowest) in [(0x30, -32766), (0xb0, -32768)] {
        let mut chip = awake();
        put(&mut chip, &[0x4c, config]);
        chip.sample(0, &both([-32768, -32767, 32767], [0; 3]));
        let [x, ..] = [burst::<6>(&mut chip, 0x25)].map(|it| i16::from_be_bytes([it[0], it[1]]));
        assert_eq!(x, lowest);
    }
}

#[test]
fn data_ready_is_cleared_as_int_config0_says() {
    // The option, and whether a read of the status and of a sensor's register clears.
    for (option, by_status, by_data) in
        [(0, true, false), (1, true, false), (2, false, true), (3, true, true)]
    {
        let mut chip = awake();
        put(&mut chip, &[0x63, option << 4]);
        put(&mut chip, &[0x65, 0x08]);
        chip.sample(0, &kth(1));
        assert!(chip.interrupt());
        assert_eq!(burst(&mut chip, 0x2d), [0x08]);
        assert_eq!(chip.interrupt(), !by_status, "option {option}");
        chip.sample(0, &kth(1));
        burst::<6>(&mut chip, 0x25);
        assert_eq!(burst(&mut chip, 0x2d), [if by_data { 0 } else { 0x08 }], "option {option}");
    }
}

#[test]
fn modes_turn_each_channel_on_and_off() {
    let mut chip = Icm42688::new(0x68);
    // PWR_MGMT0, and whether the gyro and the accelerometer sample at their rates after a reset.
    for (mode, gyro, accel) in [
        (0x00, false, false),
        (0x04, false, false),
        (0x08, false, false),
        (0x0c, true, false),
        (0x01, false, false),
        (0x02, false, false), // low-power mode has not 1 kHz
        (0x03, false, true),
        (0x0f, true, true),
    ] {
        put(&mut chip, &[0x4e, mode]);
        let is_on = |channel| chip.setting(channel).is_some_and(|setting| setting.rate.is_some());
        assert_eq!((is_on(Channel::Gyro), is_on(Channel::Accel)), (gyro, accel), "{mode:#x}");
        let before = chip.tally(Channel::Gyro).made;
        chip.sample(0, &kth(1));
        assert_eq!(chip.tally(Channel::Gyro).made - before, u64::from(gyro));
    }
    assert_eq!(chip.setting(Channel::Mag), None);
    put(&mut chip, &[0x4d, 0x93]);
    assert_eq!(chip.setting(Channel::Gyro).and_then(|setting| setting.rate), None, "CLKSEL 3");
}

#[test]
fn rates_ranges_and_filters_are_those_of_the_register_map() {
    let hz = [
        None,
        Some((32000, 1)),
        Some((16000, 1)),
        Some((8000, 1)),
        Some((4000, 1)),
        Some((2000, 1)),
        Some((1000, 1)),
        Some((200, 1)),
        Some((100, 1)),
        Some((50, 1)),
        Some((25, 1)),
        Some((25, 2)),
        Some((25, 4)),
        Some((25, 8)),
        Some((25, 16)),
        Some((500, 1)),
    ];
    for (code, rate) in (0u8..).zip(hz) {
        let low = rate.filter(|_| code >= 7);
        let noise = rate.filter(|_| !matches!(code, 12..=14));
        let filter = if matches!(code, 1..=5) { Some("fixed") } else { Some("BW 7") };
        let mut chip = awake();
        put(&mut chip, &[0x52, 0xe7]);
        for range in 0..8 {
            put(&mut chip, &[0x4f, range << 5 | code, range << 5 | code]);
            let gyro = Setting { rate: noise, range: 7 - range, filter };
            assert_eq!(chip.setting(Channel::Gyro), Some(gyro), "{code} {range}");
            let filter = if filter == Some("fixed") { filter } else { Some("BW 14") };
            let accel = Setting { rate: noise, range: 3u8.saturating_sub(range), filter };
            assert_eq!(chip.setting(Channel::Accel), Some(accel), "{code} {range}");
        }
        put(&mut chip, &[0x4e, 0x0e]);
        let accel = chip.setting(Channel::Accel).map(|setting| (setting.rate, setting.filter));
        assert_eq!(accel, Some((low, None)), "low-power mode, {code}");
    }
}

#[test]
fn offsets_shift_what_is_read_at_every_full_scale() {
    let mut chip = awake();
    // Gyro x +32, y −32, z 0; accel x +2, y −2000, z +4 of 1/32 deg/s and of 0.5 mg.
    put_in(&mut chip, 4, &[0x77, 32, 0xf0, 0xe0, 0, 0x00, 2, 0x30, 0x08, 4]);
    let gyro = [2097, 1049, 524, 262, 131, 66, 33, 16];
    let accel = [(16, 33, 16384), (8, 16, 8192), (4, 8, 4096), (2, 4, 2048)];
    for (code, gyro) in (0u8..).zip(gyro.into_iter().rev()) {
        put(&mut chip, &[0x4f, code << 5 | 6]);
        chip.sample(0, &kth(100));
        assert_eq!(burst(&mut chip, 0x25), words([100 + gyro, 100 - gyro, 100]), "{code}: 1 deg/s");
    }
    for (code, (one_mg, two_mg, g)) in (0u8..).zip(accel.into_iter().rev()) {
        put(&mut chip, &[0x50, code << 5 | 6]);
        chip.sample(0, &kth(100));
        assert_eq!(burst(&mut chip, 0x1f), words([100 + one_mg, 100 - g, 100 + two_mg]), "{code}");
    }
}

#[test]
fn packets_are_those_of_the_sheet() {
    let sample = Samples { temperature_c: Some(35.0), ..both([1, 2, -3], [4, 5, -6]) };
    let accel = [0, 4, 0, 5, 0xff, 0xfa];
    let gyro = [0, 1, 0, 2, 0xff, 0xfd];
    // 10 °C above 25 are 20.7 or 1324.8 counts; 1 s is 937 500 of its own µs, 0xe4e1c.
    let rows: [(u8, &[&[u8]]); 4] = [
        (0x01, &[&[0x40], &accel, &[21]]),
        (0x02, &[&[0x20], &gyro, &[21]]),
        (0x03, &[&[0x68], &accel, &gyro, &[21, 0x4e, 0x1c]]),
        (0x10, &[&[0x78], &accel, &gyro, &[0x05, 0x2d, 0x4e, 0x1c, 0, 0, 0]]),
    ];
    for (config, packet) in rows {
        let mut chip = streaming(config);
        chip.sample(1_000_000_000, &sample);
        let packet = packet.concat();
        assert_eq!(burst(&mut chip, 0x2e), [0, packet.len() as u8], "{config:#x}");
        let seen: [u8; 21] = burst(&mut chip, 0x30);
        assert_eq!(seen[..packet.len()], packet, "{config:#x}");
        assert_eq!(seen[packet.len()], 0xff, "empty: bit 7 of a header");
        assert_eq!(chip.tally(Channel::Gyro).read, u64::from(config != 0x01));
    }
}

#[test]
fn endianness_and_records_change_packets_and_counts() {
    let mut chip = streaming(0x03);
    put(&mut chip, &[0x4c, 0x00]);
    put(&mut chip, &[0x54, 0x2b]); // 16 µs
    chip.sample(1_000_000_000, &Samples { temperature_c: Some(25.0), ..both([1, 2, 3], [4, 5, 6]) });
    assert_eq!(burst(&mut chip, 0x2e), [16, 0]);
    assert_eq!(burst(&mut chip, 0x30), [0x68, 4, 0, 5, 0, 6, 0, 1, 0, 2, 0, 3, 0, 0, 0xe1, 0xe4]);
    put(&mut chip, &[0x4c, 0x70]);
    chip.sample(0, &kth(1));
    chip.sample(0, &kth(2));
    assert_eq!(burst(&mut chip, 0x2e), [0, 2], "records");
    burst::<16>(&mut chip, 0x30);
    assert_eq!((burst(&mut chip, 0x2f), burst(&mut chip, 0x2e)), ([2], [0, 1]), "latched by its high byte");
}

#[test]
fn with_twenty_bits_the_full_scales_are_the_largest() {
    let mut chip = streaming(0x10);
    put(&mut chip, &[0x4f, 0xe6, 0x66]);
    let range = |channel| chip.setting(channel).map(|setting| setting.range);
    assert_eq!((range(Channel::Gyro), range(Channel::Accel)), (Some(7), Some(3)));
}

#[test]
fn a_slower_channel_is_invalid_between_its_samples_or_held() {
    for (config, between) in [(0x30, [0x80, 0x00]), (0xb0, [0, 7])] {
        let mut chip = streaming(0x03);
        put(&mut chip, &[0x4c, config]);
        chip.sample(0, &kth(7));
        chip.sample(0, &Samples { gyro: Some([8; 3]), ..Samples::default() });
        let seen: [u8; 32] = burst(&mut chip, 0x30);
        assert_eq!((&seen[17..19], &seen[23..25]), (&between[..], &[0, 8][..]));
        assert_eq!(chip.tally(Channel::Accel), Tally { made: 1, read: 1, ..Tally::default() });
    }
}

#[test]
fn a_header_tells_a_changed_rate_once_and_a_delta_its_time() {
    let mut chip = streaming(0x03);
    put(&mut chip, &[0x54, 0x27]); // TMST_DELTA_EN
    let mut headers = [0; 4];
    for (k, header) in headers.iter_mut().enumerate() {
        if k == 2 {
            put(&mut chip, &[0x4f, 0x07]);
        }
        chip.sample(k as u64 * 1_000_000, &kth(0));
        let packet: [u8; 16] = burst(&mut chip, 0x30);
        *header = packet[0];
        let ticks = u16::from_be_bytes([packet[14], packet[15]]);
        assert!(if k == 0 { ticks == 0 } else { (937..=938).contains(&ticks) }, "{ticks}");
    }
    assert_eq!(headers, [0x68, 0x68, 0x69, 0x68]);
}

#[test]
fn a_full_fifo_loses_packets_and_counts_them() {
    // FIFO_CONFIG, the first packet that is left of 130, of which 127 have room.
    for (mode, oldest) in [(0x40, 3), (0x80, 0), (0xc0, 0)] {
        let mut chip = streaming(0x03);
        put(&mut chip, &[0x16, mode]);
        for k in 0..127 {
            chip.sample(0, &kth(k));
            assert_eq!(burst::<1>(&mut chip, 0x2d)[0] & 0x02 != 0, k == 126, "full at {k}");
        }
        (127..130).for_each(|k| chip.sample(0, &kth(k)));
        assert_eq!(burst(&mut chip, 0x2e), 2032u16.to_be_bytes());
        assert_eq!(burst(&mut chip, 0x6c), [3, 0], "FIFO_LOST_PKT");
        assert_eq!(burst::<3>(&mut chip, 0x30)[1..], [0, oldest]);
        assert_eq!(chip.tally(Channel::Accel).overflowed, 3);
        put(&mut chip, &[0x4b, 0x02]);
        assert_eq!((burst(&mut chip, 0x4b), burst(&mut chip, 0x2e)), ([0], [0, 0]), "flushed");
        assert_eq!(chip.tally(Channel::Accel).missed, 127);
    }
    for (config, bytes) in [(0x01, 2040u16), (0x10, 2020)] {
        let mut chip = streaming(config);
        (0..300).for_each(|k| chip.sample(0, &kth(k)));
        assert_eq!(burst(&mut chip, 0x2e), bytes.to_be_bytes());
    }
}

#[test]
fn a_packet_that_is_half_read_is_lost_whole() {
    let mut chip = streaming(0x03);
    (0..127).for_each(|k| chip.sample(0, &kth(k)));
    assert_eq!(burst(&mut chip, 0x30), [0x68, 0, 0, 0]);
    (127..129).for_each(|k| chip.sample(0, &kth(k)));
    assert_eq!(burst(&mut chip, 0x30), [0x68, 0, 2], "packets are not torn");
}

#[test]
fn the_watermark_fires_once_or_at_each_packet() {
    for (config, fired) in [(0x03, [false, true, false, false]), (0x23, [false, true, true, true])] {
        let mut chip = streaming(config);
        put(&mut chip, &[0x60, 32, 0]);
        put(&mut chip, &[0x65, 0x04]);
        for fires in fired {
            chip.sample(0, &kth(0));
            assert_eq!(chip.interrupt(), fires);
            burst::<1>(&mut chip, 0x2d);
        }
        // Cleared by one byte of the FIFO and not by the status: option 2 of bits 3:2.
        put(&mut chip, &[0x63, 0x08]);
        put(&mut chip, &[0x60, 80]);
        chip.sample(0, &kth(0));
        assert_eq!(burst::<1>(&mut chip, 0x2d)[0] & 0x04, 0x04);
        assert!(chip.interrupt());
        burst::<1>(&mut chip, 0x30);
        assert!(!chip.interrupt());
    }
}

#[test]
fn the_time_is_read_by_a_strobe() {
    let mut chip = awake();
    write(&mut chip, 1_000_000_000, &[0x4b, 0x04], false);
    put(&mut chip, &[0x76, 1]);
    assert_eq!(burst(&mut chip, 0x62), [0; 3], "TMST_TO_REGS_EN is off");
    put_in(&mut chip, 0, &[0x54, 0x33]);
    write(&mut chip, 1_000_000_000, &[0x4b, 0x04], false);
    put(&mut chip, &[0x76, 1]);
    assert_eq!(burst(&mut chip, 0x62), [0x1c, 0x4e, 0x0e], "937 500 µs of its own clock");
}

#[test]
fn what_is_not_there_is_told() {
    let rows: [(u8, &[u8], &str); 6] = [
        (0, &[0x70, 0x01], "self-test"),
        (0, &[0x51, 0x12], "order"),
        (0, &[0x53, 0x15], "order"),
        (0, &[0x4c, 0x33], "I²C"),
        (1, &[0x0c, 0x01], "anti-alias"),
        (1, &[0x03, 0x81], "axes"),
    ];
    for (bank, bytes, told) in rows {
        let mut chip = awake();
        assert_eq!(chip.lacks(), None);
        put_in(&mut chip, bank, bytes);
        assert!(chip.lacks().is_some_and(|lack| lack.contains(told)), "{:?}", chip.lacks());
    }
    let mut chip = awake();
    put(&mut chip, &[0x50, 0x68]);
    put(&mut chip, &[0x4e, 0x02]);
    assert!(chip.lacks().is_some_and(|lack| lack.contains("low-power")));
}

proptest! {
    #[test]
    fn every_sample_is_accounted_for(steps in checks::steps(), config in any::<u8>()) {
        let mut chip = streaming(config);
        let port = Port { address: 0x68, fifo: (0x30, 41), reset: &[&[0x76, 0], &[0x11, 0x01]] };
        checks::every_sample_is_accounted_for(&mut chip, &[port], &steps)?;
    }

    /// Against a simple model: packets leave whole and in order, however many are read at a time.
    #[test]
    fn packets_at_any_pace_are_whole_samples_in_order(reads in prop::collection::vec((0u8..40, 0u8..40), 1..40)) {
        let mut chip = streaming(0x03);
        // What waits: the samples from `oldest` on, before `next`.
        let (mut oldest, mut next) = (0i16, 0i16);
        for (samples, packets) in reads {
            for _ in 0..samples {
                chip.sample(0, &both([next; 3], [-next; 3]));
                next += 1;
                oldest = oldest.max(next - 127);
            }
            for _ in 0..packets {
                let packet: [u8; 16] = burst(&mut chip, 0x30);
                if oldest == next {
                    prop_assert_eq!(packet, [0xff; 16]);
                    continue;
                }
                prop_assert_eq!(packet[0], 0x68);
                prop_assert_eq!(&packet[1..7], &words([-oldest; 3])[..]);
                prop_assert_eq!(&packet[7..13], &words([oldest; 3])[..]);
                oldest += 1;
            }
        }
    }

    #[test]
    fn bursts_at_any_pace_are_whole_samples_in_order(paces in prop::collection::vec(0u8..5, 1..100)) {
        let mut chip = awake();
        let parts = [(Channel::Accel, 0), (Channel::Gyro, 6)];
        let data = Data { address: 0x68, register: 0x1f, parts: &parts, order: i16::to_be_bytes, at_first: i16::MIN };
        checks::bursts_at_any_pace_are_whole_samples_in_order(&mut chip, &[data], &paces)?;
    }
}
