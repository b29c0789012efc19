use super::*;
use crate::player::{BLOCK, Player};
use crate::scene::Plan;
use crate::sensor::SensorKind;
use crate::time::{NANOS, Rate, SimTime};
use proptest::prelude::*;
use ratetable_protocols::bridge::Bus;

const MS: i64 = 1_000_000;

const ROCKING: &str = "seed = 4\nduration = \"10 s\"\n[[motion]]\nkind = \"rock\"\naxis = \"roll\"\namplitude = \"200 deg/s\"\nfrequency = \"1 Hz\"\nduration = \"10 s\"\n[gyro]\npart = \"MPU-9250\"\nrate = \"1 kHz\"\n[accel]\npart = \"MPU-9250\"\nrate = \"1 kHz\"\n[mag]\npart = \"MPU-9250\"\nrate = \"100 Hz\"\n";

fn plan(text: &str) -> Plan {
    Plan::parse(text, "test", "test", &[]).unwrap_or_else(|error| panic!("{error}"))
}

fn refused(text: &str, chip: Option<&str>) -> String {
    fit(&plan(text).sensors, chip).expect_err(text)
}

fn counts(bytes: &[u8]) -> Vec<i16> {
    bytes.chunks(2).map(|pair| i16::from_be_bytes([pair[0], pair[1]])).collect()
}

/// ±500 °/s, DLPF 3, 200 Hz.
fn set_up(board: &mut Board<'_>) {
    for write in [[0x6b, 0x01], [0x1b, 0x08], [0x1a, 0x03], [0x1d, 0x03], [0x19, 0x04]] {
        assert!(board.write(0x68, &write, false));
    }
}

fn burst(board: &mut Board<'_>) -> Vec<i16> {
    let mut bytes = [0; 14];
    assert!(board.write(0x68, &[0x3b], false) && board.read(0x68, &mut bytes));
    counts(&bytes)
}

#[test]
fn what_a_driver_reads_is_what_the_scene_with_its_settings_measures() {
    let mut plan = plan(ROCKING);
    let rest = plan.at_rest();
    let chips = fit(&plan.sensors, None).unwrap();
    assert_eq!(
        chips.iter().map(ToString::to_string).collect::<Vec<_>>(),
        ["MPU-9250 at 0x68 (gyro, accel, mag)"]
    );
    let mut board = Board::new(&plan, &rest, chips, SimTime::ZERO).unwrap();
    set_up(&mut board);
    board.advance(SimTime(500 * MS)).unwrap();
    assert!(!board.has_begun(), "nobody has read a sample");
    burst(&mut board);
    assert_eq!(board.start(), Some(SimTime(500 * MS)));
    let mut read = Vec::new();
    for k in 0..400i64 {
        // In the middle of the second second the driver chooses another range and rate.
        if k == 300 {
            assert!(board.write(0x68, &[0x1b, 0x10], false) && board.write(0x68, &[0x19, 0x09], false));
        }
        board.advance(SimTime(500 * MS + 5 * MS * k)).unwrap();
        read.push(burst(&mut board));
    }
    let changes: Vec<_> = board.changes().to_vec();
    let reads = board.reads()[SensorKind::Gyro as usize];
    drop(board);
    assert_eq!(changes[0].to_string(), "gyro: 200 Hz, ±500 deg/s, low-pass 41 Hz");
    let last = changes.iter().rfind(|it| it.kind == SensorKind::Gyro).unwrap();
    assert_eq!(last.to_string(), "gyro: 100 Hz, ±1000 deg/s, low-pass 41 Hz");
    assert_eq!(last.setting.start, SimTime(1495 * MS + 1), "just after what was read before");
    // The scene with these settings, played without a bus, gives the same counts.
    plan.set(changes.iter().map(|it| (it.kind, it.setting.clone(), it.written.clone())));
    let again = Plan::parse(&plan.resolved, "resolved", "again", &[]).unwrap();
    let mut gyro = Vec::new();
    let Ok(()) = Player::new(&again, SimTime(2 * NANOS), BLOCK).play(|moment| {
        let found = moment.readings.iter().filter(|it| it.kind == SensorKind::Gyro);
        gyro.extend(found.map(|it| (moment.t.0, it.body().unwrap().value.v)));
        Ok::<(), std::convert::Infallible>(())
    });
    for (k, seen) in read.iter().enumerate() {
        let now = 5 * MS * k as i64;
        let (t, expected) = gyro[gyro.partition_point(|(t, _)| *t <= now) - 1];
        let lsb = if t <= 1495 * MS { 65.5 } else { 32.8 };
        // Chip axes: forward, left, up.
        let chip =
            [expected.x, -expected.y, -expected.z].map(|rate| (rate.to_degrees() * lsb).round() as i16);
        assert_eq!(seen[4..], chip, "{k}");
    }
    assert_eq!((reads.tally.missed, reads.waiting()), (0, 0));
    // After 1.5 s every sample is read twice.
    assert!((47..=51).contains(&reads.tally.again), "{reads:?}");
}

#[test]
fn a_slow_driver_misses_samples_and_a_fast_one_reads_them_again() {
    let plan = plan(ROCKING);
    let rest = plan.at_rest();
    for (period, read, again, missed) in [(20, 50, 0, 150), (1, 200, 800, 0)] {
        let mut board = Board::new(&plan, &rest, fit(&plan.sensors, None).unwrap(), SimTime::ZERO).unwrap();
        set_up(&mut board);
        board.begin(SimTime::ZERO);
        for k in 0..1000 / period {
            board.advance(SimTime(k * period * MS)).unwrap();
            burst(&mut board);
        }
        let reads = board.reads()[0];
        let tally = reads.tally;
        let near = |a: u64, b: u64| a.abs_diff(b) <= 5;
        assert!(
            near(tally.read, read) && near(tally.again, again) && near(tally.missed, missed),
            "{reads:?}"
        );
        let hz = reads.hz().unwrap();
        assert!((hz - 1000.0f64.min(read as f64)).abs() < 1.5, "{hz}");
    }
}

#[test]
fn the_vehicle_rests_on_after_a_first_read_if_that_is_asked() {
    let plan = plan(ROCKING);
    let rest = plan.at_rest();
    let mut board = Board::new(&plan, &rest, fit(&plan.sensors, None).unwrap(), SimTime(NANOS)).unwrap();
    set_up(&mut board);
    board.advance(SimTime(100 * MS)).unwrap();
    burst(&mut board);
    board.advance(SimTime(1099 * MS)).unwrap();
    assert!(!board.has_begun() && burst(&mut board)[4].abs() < 500, "at rest but for its bias");
    board.advance(SimTime(1101 * MS)).unwrap();
    assert_eq!(board.start(), Some(SimTime(1100 * MS)));
}

#[test]
fn samples_from_before_the_scene_that_wait_in_a_fifo_are_not_the_scenes() {
    let plan = plan(ROCKING);
    let rest = plan.at_rest();
    let mut board = Board::new(&plan, &rest, fit(&plan.sensors, None).unwrap(), SimTime(NANOS)).unwrap();
    set_up(&mut board);
    board.write(0x68, &[0x23, 0x78], false);
    board.write(0x68, &[0x6a, 0x44], false);
    board.advance(SimTime(100 * MS)).unwrap();
    burst(&mut board);
    board.advance(SimTime(1050 * MS)).unwrap();
    board.write(0x68, &[0x6a, 0x44], false);
    // Ten more come at rest, and twenty in the scene; it is read to the end.
    for k in 0..5 {
        board.advance(SimTime(1202 * MS)).unwrap();
        board.write(0x68, &[0x74], false);
        assert!(board.read(0x68, &mut [0; 72]), "{k}");
    }
    for reads in &board.reads()[..2] {
        let tally = reads.tally;
        assert!(tally.made >= 20 && reads.waiting() <= 1, "{tally:?}");
        assert_eq!(tally.made, tally.read + tally.missed + tally.overflowed + reads.waiting(), "{tally:?}");
    }
}

#[test]
fn a_scene_without_parts_takes_the_chip_that_is_named() {
    let bare = "duration = \"1 s\"\n[gyro]\nrate = \"1 kHz\"\n[accel]\nrate = \"1 kHz\"\n";
    assert!(refused(bare, None).contains("[gyro] has no part"));
    let plan = plan(bare);
    let rest = plan.at_rest();
    let chips = fit(&plan.sensors, Some("mpu-6050")).unwrap();
    let mut board = Board::new(&plan, &rest, chips, SimTime::ZERO).unwrap();
    board.write(0x68, &[0x6b, 0], false);
    board.advance(SimTime(10 * MS)).unwrap();
    assert_eq!(burst(&mut board)[..3], [0, 0, 16384], "exactly 1 g upwards");
}

#[test]
fn gyro_and_accel_of_a_chip_sample_together_whenever_each_is_set() {
    let mut plan = plan(&ROCKING.replace("MPU-9250", "ICM-20948"));
    let rest = plan.at_rest();
    let mut board = Board::new(&plan, &rest, fit(&plan.sensors, None).unwrap(), SimTime::ZERO).unwrap();
    board.begin(SimTime::ZERO);
    // Out of sleep; in bank 2 both at 1125/11 Hz with a filter, the accelerometer 31.3 ms after the gyro.
    let writes: [(i64, &[u8]); 5] = [
        (1_000_000, &[0x06, 0x01]),
        (2_000_000, &[0x7f, 0x20]),
        (3_100_000, &[0x00, 10, 0x19]),
        (34_400_000, &[0x10, 0, 10]),
        (34_700_000, &[0x14, 0x19]),
    ];
    for (t, write) in writes {
        board.advance(SimTime(t)).unwrap();
        assert!(board.write(0x68, write, false));
    }
    let changes = board.changes().to_vec();
    drop(board);
    let rates: Vec<_> = changes.iter().rev().take(2).map(|it| it.setting.rate).collect();
    assert_eq!(changes.last().unwrap().setting.rate, Rate::new(1125, 11), "{rates:?}");
    plan.set(changes.iter().map(|it| (it.kind, it.setting.clone(), it.written.clone())));
    let again = Plan::parse(&plan.resolved, "resolved", "again", &[]).unwrap();
    let mut moments = 0;
    let Ok(()) = Player::new(&again, SimTime(NANOS), BLOCK).play(|moment| {
        let has = |kind| moment.readings.iter().any(|it| it.kind == kind);
        if moment.t > SimTime(40 * MS) {
            assert!(has(SensorKind::Gyro) && has(SensorKind::Accel), "{}", moment.t);
            moments += 1;
        }
        Ok::<(), std::convert::Infallible>(())
    });
    assert_eq!(moments, 98);
}

#[test]
fn a_chips_thermometer_is_that_of_its_gyro_and_not_of_its_magnetometer() {
    let warm =
        "duration = \"1 s\"\n[gyro]\nrate = \"1 kHz\"\ntemperature = \"30 degC\"\n[mag]\nrate = \"100 Hz\"\n";
    let plan = plan(warm);
    let rest = plan.at_rest();
    let chips = fit(&plan.sensors, Some("MPU-9250")).unwrap();
    let mut board = Board::new(&plan, &rest, chips, SimTime::ZERO).unwrap();
    board.begin(SimTime::ZERO);
    // 1000/7 Hz, and the magnetometer at 100 Hz by the bypass: it alone has a sample at 10 ms.
    for write in [[0x1a, 0x03], [0x19, 0x06], [0x37, 0x02]] {
        assert!(board.write(0x68, &write, false));
    }
    assert!(board.write(0x0c, &[0x0a, 0x16], false));
    board.advance(SimTime(10 * MS)).unwrap();
    let mut bytes = [0; 2];
    assert!(board.write(0x68, &[0x41], false) && board.read(0x68, &mut bytes));
    assert_eq!(i16::from_be_bytes(bytes), (9.0 * 333.87f64).round() as i16);
}

#[test]
fn addresses_are_checked_and_chips_that_share_one_are_refused() {
    let one =
        |more: &str| format!("duration = \"1 s\"\n[gyro]\nrate = \"1 kHz\"\npart = \"MPU-6050\"\n{more}");
    let error = refused(&one("address = 0x70\n"), None);
    assert!(error.contains("answers at 0x68 or 0x69, not at 0x70"), "{error}");
    let two = one("[accel]\nrate = \"1 kHz\"\npart = \"MPU-9250\"\n");
    assert!(refused(&two, None).contains("answer at the same address"));
    let apart = format!("{two}address = 0x69\n");
    assert_eq!(fit(&plan(&apart).sensors, None).unwrap().len(), 2);
    let error = refused(&one("[accel]\nrate = \"1 kHz\"\npart = \"ADIS16470\"\n"), None);
    assert!(error.contains("no registers of the ADIS16470"), "{error}");
    assert!(Plan::parse(&one("address = 0x99\n"), "t", "t", &[]).unwrap_err().to_string().contains("7 bits"));
}

#[test]
fn every_setting_that_a_chip_can_be_asked_for_is_in_its_parts_data() {
    for kind in CHIPS {
        let part = crate::sensor::parts::find(kind.part, SensorKind::Gyro)
            .or_else(|| crate::sensor::parts::find(kind.part, SensorKind::Mag));
        let part = part.unwrap_or_else(|| panic!("{}", kind.part));
        for channel in kind.channels() {
            let settings = crate::scene::parts::settings(part, SensorKind::TRIADS[channel as usize]).unwrap();
            assert!(!settings.rates.is_empty() && !settings.scales.is_empty(), "{} {channel:?}", kind.part);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, ..ProptestConfig::default() })]

    /// Whatever a driver writes, each sensor can be set so, nothing panics, and every sample is accounted for.
    #[test]
    fn whatever_is_written_the_sensors_follow(
        kind in 0..CHIPS.len(),
        writes in prop::collection::vec((any::<u8>(), any::<[u8; 2]>()), 1..60),
    ) {
        let kind = &CHIPS[kind];
        let mut text = "duration = \"1 s\"\n".to_string();
        for channel in kind.channels() {
            text += &format!("[{}]\nrate = \"100 Hz\"\n", SensorKind::TRIADS[channel as usize]);
        }
        let plan = plan(&text);
        let rest = plan.at_rest();
        let mut board = Board::new(&plan, &rest, fit(&plan.sensors, Some(kind.part)).unwrap(), SimTime::ZERO).unwrap();
        let addresses: Vec<u8> = kind.places.iter().map(|(_, addresses)| addresses[0]).collect();
        board.begin(SimTime::ZERO);
        for (k, (register, values)) in writes.into_iter().enumerate() {
            let address = addresses[k % addresses.len()];
            board.write(address, &[register, values[0], values[1]], false);
            if let Err(why) = board.advance(SimTime(k as i64 * MS / 4)) {
                prop_assert!(false, "{} {register:#x} {values:x?}: {why}", kind.part);
            }
            board.read(address, &mut [0; 20]);
        }
        for reads in board.reads() {
            let tally = reads.tally;
            prop_assert!(tally.read + tally.missed + tally.overflowed <= tally.made, "{tally:?}");
        }
        let rates = board.changes().iter().filter_map(|it| it.setting.rate);
        prop_assert!(rates.map(Rate::as_hz).all(|hz| hz > 0.0));
    }
}
