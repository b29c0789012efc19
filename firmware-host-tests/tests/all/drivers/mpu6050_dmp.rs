//! `mpu6050-dmp` 0.6 (embedded-hal 1.0): an MPU-6050. Its program for the DMP is not run by the emulated chip: what can be
//! checked is that the program arrives, that raw samples are read, and that calibration reaches the offset registers.

use ::mpu6050_dmp::accel::AccelFullScale;
use ::mpu6050_dmp::address::Address;
use ::mpu6050_dmp::calibration::{CalibrationParameters, ReferenceGravity};
use ::mpu6050_dmp::config::DigitalLowPassFilter;
use ::mpu6050_dmp::gyro::GyroFullScale;
use ::mpu6050_dmp::sensor::Mpu6050;
use ratetable_protocols::chip::{Channel, mpu::Mpu};

use super::bench::Sensed;
use super::bus::I2c;
use super::emulated::{still, turning};
use super::flaw::{Flaw, Flawed};
use super::hal::{Delay, Hal};
use super::{ACCEL, Bench, GYRO, TDK, Verdict, agrees, agrees_everywhere, equal, notices, something, told};

fn started<B: Bench>(bench: &B) -> Result<Mpu6050<Hal<B::Bus>>, String> {
    let mut mpu =
        Mpu6050::new(Hal(bench.bus()), Address::default()).map_err(|it| format!("start: {:?}", it.error))?;
    mpu.set_digital_lowpass_filter(DigitalLowPassFilter::Filter3).map_err(told("filter"))?;
    mpu.set_sample_rate_divider(9).map_err(told("rate"))?;
    Ok(mpu)
}

fn check(bench: &impl Bench) -> Verdict {
    // The driver sets bits of a range and clears none, so that each range needs a start of its own.
    let ranges = [
        (GyroFullScale::Deg250, AccelFullScale::G2),
        (GyroFullScale::Deg500, AccelFullScale::G4),
        (GyroFullScale::Deg1000, AccelFullScale::G8),
        (GyroFullScale::Deg2000, AccelFullScale::G16),
    ];
    for (range, (gyro, accel)) in ranges.into_iter().enumerate() {
        started(bench)?.reset(&mut Delay(bench)).map_err(told("reset"))?;
        let mut mpu = started(bench)?;
        mpu.set_gyro_full_scale(gyro).map_err(told("gyro"))?;
        mpu.set_accel_full_scale(accel).map_err(told("accel"))?;
        let sensed = bench.show(something(GYRO[range], ACCEL[range]));
        bench.next();
        equal("ready", mpu.interrupt_read_clear().map_err(told("status"))? & 1, 1)?;
        let (read_accel, read_gyro) = mpu.motion6().map_err(told("read"))?;
        let read = read_gyro.scaled(gyro);
        agrees("gyro", [read.x(), read.y(), read.z()].map(f64::from), sensed.gyro_dps, GYRO[range])?;
        let read = read_accel.scaled(accel);
        agrees("accel", [read.x(), read.y(), read.z()].map(f64::from), sensed.accel_g, ACCEL[range])?;
        let read = f64::from(mpu.temperature().map_err(told("read temperature"))?.celsius());
        agrees("temperature", [read; 3], [sensed.celsius; 3], 340.0)?;
        bench.comes_to("ready after reading", 0, || {
            mpu.motion6().map_err(told("read"))?;
            Ok(mpu.interrupt_read_clear().map_err(told("status"))? & 1)
        })?;
        bench.is_set(Channel::Gyro, (1000, 10), range as u8, "DLPF 3")?;
    }
    Ok(())
}

/// A bus that keeps what is written to the DMP's memory: bank, address, bytes.
struct Watched<B> {
    bus: B,
    at: [u8; 2],
    program: Vec<(u8, u8, Vec<u8>)>,
}

impl<B: I2c> I2c for &mut Watched<B> {
    fn write(&mut self, address: u8, bytes: &[u8]) -> Result<(), super::bus::Fault> {
        match *bytes {
            [0x6d, bank] => self.at[0] = bank,
            [0x6e, start] => self.at[1] = start,
            [0x6f, ..] => self.program.push((self.at[0], self.at[1], bytes[1..].to_vec())),
            _ => {}
        }
        self.bus.write(address, bytes)
    }

    fn read(&mut self, address: u8, out: &mut [u8]) -> Result<(), super::bus::Fault> {
        self.bus.read(address, out)
    }

    fn write_read(&mut self, address: u8, bytes: &[u8], out: &mut [u8]) -> Result<(), super::bus::Fault> {
        self.bus.write_read(address, bytes, out)
    }
}

/// Starts the DMP, and reads its program back as it was sent.
fn uploads(bench: &impl Bench) -> Verdict {
    let mut watched = Watched { bus: bench.bus(), at: [0; 2], program: Vec::new() };
    let mut mpu =
        Mpu6050::new(Hal(&mut watched), Address::default()).map_err(|it| format!("start: {:?}", it.error))?;
    mpu.initialize_dmp(&mut Delay(bench)).map_err(|it| format!("DMP: {it:?}"))?;
    equal("chunks of the program", watched.program.len(), 3062_usize.div_ceil(16))?;
    for (bank, start, sent) in watched.program {
        let mut back = vec![0; sent.len()];
        let chip = |it| format!("read back: {it:?}");
        watched.bus.write(0x68, &[0x6d, bank]).map_err(chip)?;
        watched.bus.write(0x68, &[0x6e, start]).map_err(chip)?;
        watched.bus.write_read(0x68, &[0x6f], &mut back).map_err(chip)?;
        equal("program", (bank, start, back), (bank, start, sent))?;
    }
    bench.is_set(Channel::Gyro, (1000, 5), 3, "DLPF 1")
}

/// Rates of whole units of the offset registers, 4 counts: the driver wants to be within 1 count, so that it would go on
/// for ever from 2 counts off, where real noise lets it end.
fn uncalibrated() -> Sensed {
    let gyro_dps = [196.0, -264.0, 92.0].map(|counts| counts / GYRO[0]);
    Sensed { gyro_dps, accel_g: [0.05, -0.03, 1.02], ..something(1.0, 1.0) }
}

/// Calibrates a tilted and turning chip, and reads rest.
fn calibrates(bench: &impl Bench) -> Verdict {
    let mut mpu = started(bench)?;
    bench.show(uncalibrated());
    bench.next();
    let parameters =
        CalibrationParameters::new(AccelFullScale::G2, GyroFullScale::Deg250, ReferenceGravity::ZP);
    mpu.calibrate(&mut Delay(bench), &parameters).map_err(told("calibrate"))?;
    bench.next();
    let (accel, gyro) = mpu.motion6().map_err(told("read"))?;
    let off = [gyro.x(), gyro.y(), gyro.z()].map(i32::from);
    equal("gyro after calibration", off.iter().all(|it| it.abs() <= 4), true)?;
    let off = [accel.x().into(), accel.y().into(), i32::from(accel.z()) - 16384];
    equal("accel after calibration", off.iter().all(|it: &i32| it.abs() <= 16), true)
}

#[test]
fn an_mpu6050_reads_as_its_driver_scales_it() {
    agrees_everywhere!(check, TDK, Mpu::mpu6050(0x68), turning("MPU-6050"));
}

#[test]
fn the_program_of_the_dmp_is_read_back_as_it_was_sent() {
    agrees_everywhere!(uploads, TDK, Mpu::mpu6050(0x68), turning("MPU-6050"));
}

#[test]
fn calibration_reaches_the_offset_registers() {
    agrees_everywhere!(calibrates, TDK, Mpu::mpu6050(0x68), still("MPU-6050", uncalibrated()));
}

#[test]
fn flaws_of_an_mpu6050_are_noticed() {
    let chip = || Mpu::mpu6050(0x68);
    let scale = Flaw::Scale { bank: 0, register: 0x1c, bits: 0x08 };
    notices!(check, TDK, Flawed::new(chip(), 0x68, scale), "accel x");
    notices!(check, TDK, Flawed::new(chip(), 0x68, Flaw::Swapped(0x3b..0x49)), "gyro x");
    let stuck = Flaw::Stuck { register: 0x3a, bits: 0x01 };
    notices!(check, TDK, Flawed::new(chip(), 0x68, stuck), "ready after reading");
    let stuck = Flaw::Stuck { register: 0x6f, bits: 0x80 };
    notices!(uploads, TDK, Flawed::new(chip(), 0x68, stuck).fifo(0x6f), "program");
}
