//! `icm20948-rs` 0.2 (embedded-hal 1.0): an ICM-20948 with its AK09916 through slaves 4 and 0, and its FIFO.

use ::icm20948::{
    AccelConfig, AccelDlpf, AccelFullScale, FifoConfig, FifoMode, GyroConfig, GyroDlpf, GyroFullScale,
    I2cInterface, Icm20948Driver, MagConfig, MagMode,
};
use ratetable_protocols::chip::{Channel, icm20948::Icm20948};

use super::bus::Fault;
use super::emulated::turning;
use super::flaw::{Flaw, Flawed};
use super::hal::{Delay, Hal};
use super::{
    ACCEL, Bench, GYRO, MAG, TDK, Verdict, agrees, agrees_everywhere, equal, notices, something, told,
};

const RANGES: [(GyroFullScale, AccelFullScale); 4] = [
    (GyroFullScale::Dps250, AccelFullScale::G2),
    (GyroFullScale::Dps500, AccelFullScale::G4),
    (GyroFullScale::Dps1000, AccelFullScale::G8),
    (GyroFullScale::Dps2000, AccelFullScale::G16),
];

type Driver<B> = Icm20948Driver<I2cInterface<Hal<B>>>;

fn started<B: Bench>(bench: &B) -> Result<Driver<B::Bus>, String> {
    let mut icm =
        Icm20948Driver::try_new(I2cInterface::default(Hal(bench.bus()))).map_err(told("identity"))?;
    icm.init(&mut Delay(bench)).map_err(told("start"))?;
    Ok(icm)
}

fn set<B: Bench>(icm: &mut Driver<B::Bus>, range: usize) -> Verdict {
    let (gyro, accel) = RANGES[range];
    icm.configure_gyroscope(GyroConfig {
        full_scale: gyro,
        dlpf: GyroDlpf::Hz51,
        dlpf_enable: true,
        sample_rate_div: 10,
    })
    .map_err(told("gyro"))?;
    icm.configure_accelerometer(AccelConfig {
        full_scale: accel,
        dlpf: AccelDlpf::Hz50,
        dlpf_enable: true,
        sample_rate_div: 10,
    })
    .map_err(told("accel"))
}

fn check<B: Bench>(bench: &B) -> Verdict {
    let mut icm = started(bench)?;
    icm.init_magnetometer(MagConfig { mode: MagMode::Continuous100Hz }, &mut Delay(bench))
        .map_err(told("magnetometer"))?;
    for range in 0..4 {
        set::<B>(&mut icm, range)?;
        let sensed = bench.show(something(GYRO[range], ACCEL[range]));
        bench.next();
        let ready = |icm: &mut Driver<B::Bus>| {
            icm.read_data_ready_status()
                .map(|it| it.any_ready())
                .map_err(told::<::icm20948::Error<Fault>>("status"))
        };
        equal("ready", ready(&mut icm)?, true)?;
        equal("interrupt", icm.read_interrupt_status().map_err(told("status"))?.raw_data_ready, true)?;
        let read = icm.read_gyroscope().map_err(told("read gyro"))?;
        agrees("gyro", [read.x, read.y, read.z].map(f64::from), sensed.gyro_dps, GYRO[range])?;
        let read = icm.read_accelerometer().map_err(told("read accel"))?;
        agrees("accel", [read.x, read.y, read.z].map(f64::from), sensed.accel_g, ACCEL[range])?;
        let read = icm.read_magnetometer().map_err(told("read mag"))?;
        agrees("mag", [read.x, read.y, read.z].map(f64::from), sensed.mag_ut, MAG)?;
        let read = f64::from(icm.read_temperature_celsius().map_err(told("read temperature"))?);
        agrees("temperature", [read; 3], [sensed.celsius; 3], 333.87)?;
        bench.comes_to("ready after reading", false, || {
            icm.read_gyroscope().map_err(told("read gyro"))?;
            ready(&mut icm)
        })?;
        bench.comes_to("interrupt after reading", false, || {
            Ok(icm.read_interrupt_status().map_err(told("status"))?.raw_data_ready)
        })?;
        // The driver calls this 51 Hz; of DLPFCFG 4 the sheet says 23.9 Hz (DS-000189 table 16).
        bench.is_set(Channel::Gyro, (1125, 11), range as u8, "DLPF 4")?;
        bench.is_set(Channel::Accel, (1125, 11), range as u8, "DLPF 3")?;
    }
    Ok(())
}

fn fifo<B: Bench>(bench: &B) -> Verdict {
    let mut icm = started(bench)?;
    set::<B>(&mut icm, 0)?;
    let config = FifoConfig {
        enable_accel: true,
        enable_gyro: true,
        enable_temp: true,
        enable_mag: false,
        mode: FifoMode::Stream,
    };
    let sensed = bench.show(something(GYRO[0], ACCEL[0]));
    icm.fifo_configure(&config).map_err(told("FIFO"))?;
    icm.fifo_enable(true).map_err(told("FIFO"))?;
    icm.fifo_reset().map_err(told("FIFO"))?;
    bench.wait(100_000_000); // 10 samples at 102.3 Hz
    let mut bytes = [0; 512];
    let len = icm.fifo_read(&mut bytes).map_err(told("read"))?;
    let records = icm.fifo_parse(&bytes[..len], &config.into()).map_err(told("parse"))?;
    bench.counts("records", records.len(), 10)?;
    for record in &records {
        let (x, y, z) = record.gyro.ok_or("no gyro")?;
        agrees("gyro", [x, y, z].map(|it| f64::from(it) / GYRO[0]), sensed.gyro_dps, GYRO[0])?;
        let (x, y, z) = record.accel.ok_or("no accel")?;
        agrees("accel", [x, y, z].map(|it| f64::from(it) / ACCEL[0]), sensed.accel_g, ACCEL[0])?;
        let read = f64::from(record.temp.ok_or("no temperature")?) / 333.87 + 21.0;
        agrees("temperature", [read; 3], [sensed.celsius; 3], 333.87)?;
    }
    let mut left = icm.fifo_count();
    bench.comes_to("left", 0, || {
        let count = std::mem::replace(&mut left, Ok(0)).map_err(told("count"))?;
        if count > 0 {
            icm.fifo_read(&mut bytes).map_err(told("read"))?;
            left = icm.fifo_count();
        }
        Ok(count)
    })?;
    bench.wait(1_000_000_000);
    match icm.fifo_read(&mut bytes) {
        Err(::icm20948::Error::FifoOverflow) => Ok(()),
        other => Err(format!("no overflow: {other:?}")),
    }
}

#[test]
fn an_icm20948_reads_as_its_driver_scales_it() {
    agrees_everywhere!(check, TDK, Icm20948::new(0x68), turning("ICM-20948"));
}

#[test]
fn the_fifo_of_an_icm20948_parses_as_its_driver_expects() {
    agrees_everywhere!(fifo, TDK, Icm20948::new(0x68), turning("ICM-20948"));
}

#[test]
fn flaws_of_an_icm20948_are_noticed() {
    let flawed = |flaw| Flawed::new(Icm20948::new(0x68), 0x68, flaw).banks(0x7f).fifo(0x72);
    notices!(check, TDK, flawed(Flaw::Scale { bank: 0x20, register: 0x01, bits: 0x02 }), "gyro x");
    notices!(check, TDK, flawed(Flaw::Scale { bank: 0x20, register: 0x14, bits: 0x04 }), "accel x");
    notices!(check, TDK, flawed(Flaw::Swapped(0x2d..0x3b)), "gyro x");
    notices!(check, TDK, flawed(Flaw::Swapped(0x3c..0x42)), "mag x");
    notices!(check, TDK, flawed(Flaw::Stuck { register: 0x74, bits: 0x01 }), "ready after reading");
    notices!(check, TDK, flawed(Flaw::Stuck { register: 0x1a, bits: 0x01 }), "interrupt after reading");
    notices!(fifo, TDK, flawed(Flaw::Stuck { register: 0x1b, bits: 0x01 }), "FifoOverflow");
    notices!(fifo, TDK, flawed(Flaw::Stuck { register: 0x72, bits: 0x80 }), "gyro");
}
