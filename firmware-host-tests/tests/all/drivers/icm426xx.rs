//! `icm426xx` 0.4 (embedded-hal 1.0, SPI): an ICM-42688-P and its FIFO of 20-bit packets.

use ::icm426xx::{Config, ICM42688, OutputDataRate, Timestamp};
use ratetable_protocols::chip::{Channel, icm42688::Icm42688};

use super::bench::Part;
use super::emulated::{still, turning};
use super::flaw::{Flaw, Flawed};
use super::hal::{Delay, Spi};
use super::{ACCEL, Bench, Verdict, agrees, agrees_everywhere, equal, notices, something, told};

/// DS-000347 section 3.1, table 1.
const GYRO: [f64; 8] = [2097.2, 1048.6, 524.3, 262.0, 131.0, 65.5, 32.8, 16.4];
const PART: Part = Part { gyro: &GYRO, accel: &ACCEL, mag: 0.0 };

const G: f64 = 9.80665;

fn check<B: Bench>(bench: &B) -> Verdict {
    let config = Config { rate: OutputDataRate::Hz200, ..Config::default() };
    let mut icm =
        ICM42688::new(Spi(bench.bus(), 0x68, 0)).initialize(Delay(bench), config).map_err(told("start"))?;
    // At 25 °C, where the driver's scale of the temperature does not matter: it takes the 16 bits of a 20-bit packet for
    // the 8 of the others, 2.07 counts a °C and unsigned. The sheet has 132.48 (DS-000347 sections 6.1 and 14.6).
    let sensed = bench.show(super::Sensed { celsius: 25.0, ..something(GYRO[7], ACCEL[3]) });
    bench.wait(50_000_000);
    let bytes = usize::from(icm.read_fifo_count().map_err(told("count"))?);
    equal("part of a packet", bytes % 20, 0)?;
    let packets = bytes / 20;
    bench.counts("packets", packets, 10)?;
    for left in (0..packets).rev() {
        let (sample, more) = icm.read_sample().map_err(told("read"))?.ok_or("no sample")?;
        let (x, y, z) = sample.gyro.ok_or("no gyro")?;
        agrees("gyro", [x, y, z].map(|it| f64::from(it).to_degrees()), sensed.gyro_dps, GYRO[7])?;
        let (x, y, z) = sample.accel.ok_or("no accel")?;
        agrees("accel", [x, y, z].map(|it| f64::from(it) / G), sensed.accel_g, ACCEL[3])?;
        agrees("temperature", [f64::from(sample.temperature_celsius); 3], [25.0; 3], 1.0)?;
        equal("more", more, left > 0 || (more && !B::STANDS_STILL))?;
        // 5 ms in steps of 16 µs · 32/30 since the sample before.
        let Timestamp::OdrTimestamp(ticks) = sample.timestamp else { return Err("no time".into()) };
        equal("time", if left + 1 == packets { ticks == 0 } else { (292..=294).contains(&ticks) }, true)?;
    }
    bench.comes_to("empty", true, || Ok(icm.read_sample().map_err(told("read"))?.is_none()))?;
    bench.wait(1_000_000_000); // 200 packets, of which 101 have room
    equal("overflow", matches!(icm.read_sample(), Err(::icm426xx::Error::FifoOverflow)), true)?;
    bench.comes_to("flushed", 0, || {
        icm.reset_fifo().map_err(told("flush"))?;
        icm.read_fifo_count().map_err(told("count"))
    })?;
    bench.is_set(Channel::Gyro, (200, 1), 7, "BW 0")?;
    bench.is_set(Channel::Accel, (200, 1), 3, "BW 0")
}

/// What the driver makes of 35 °C: 1325 counts of 132.48 a °C, at 2.07 a °C.
fn warm(bench: &impl Bench) -> Verdict {
    let spi = Spi(bench.bus(), 0x68, 0);
    let mut icm = ICM42688::new(spi).initialize(Delay(bench), Config::default()).map_err(told("start"))?;
    bench.show(super::Sensed { celsius: 35.0, ..something(GYRO[7], ACCEL[3]) });
    bench.wait(5_000_000);
    let (sample, _) = icm.read_sample().map_err(told("read"))?.ok_or("no sample")?;
    let read = (f64::from(sample.temperature_celsius) - 25.0) * 2.07;
    agrees("temperature", [read; 3], [1325.0; 3], 1.0)
}

#[test]
fn the_driver_reads_a_warm_icm42688_as_far_too_hot() {
    let shown = still("ICM-42688-P", super::Sensed { celsius: 35.0, ..something(GYRO[7], ACCEL[3]) });
    agrees_everywhere!(warm, PART, Icm42688::new(0x68), shown);
}

#[test]
fn an_icm42688_reads_as_its_driver_scales_it() {
    agrees_everywhere!(check, PART, Icm42688::new(0x68), turning("ICM-42688-P").celsius(25.0));
}

#[test]
fn flaws_of_an_icm42688_are_noticed() {
    let flawed = |flaw| Flawed::new(Icm42688::new(0x68), 0x68, flaw).banks(0x76).fifo(0x30);
    notices!(check, PART, flawed(Flaw::Scale { bank: 0, register: 0x5f, bits: 0x10 }), "packets");
    notices!(check, PART, flawed(Flaw::Scale { bank: 0, register: 0x4c, bits: 0x10 }), "gyro x");
    notices!(check, PART, flawed(Flaw::Scale { bank: 0, register: 0x50, bits: 0x01 }), "packets");
    notices!(check, PART, flawed(Flaw::Stuck { register: 0x2d, bits: 0x02 }), "FifoOverflow");
}
