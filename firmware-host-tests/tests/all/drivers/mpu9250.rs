//! `mpu9250` 0.25 (embedded-hal 0.2): an MPU-9250 with its AK8963 in bypass, and an MPU-6500.

use ::mpu9250::{
    AccelDataRate, AccelScale, Dlpf, GyroScale, GyroTempDataRate, InterruptEnable, Mpu9250, MpuConfig,
};
use ratetable_protocols::chip::{Channel, mpu::Mpu};

use super::emulated::{still, turning};
use super::flaw::{Flaw, Flawed};
use super::hal::{Delay, Hal};
use super::{
    ACCEL, Bench, GYRO, MAG, TDK, Verdict, agrees, agrees_everywhere, equal, notices, something, told,
};

/// What the driver takes for 1 g, m/s².
const G: f64 = 9.807;

const RANGES: [(GyroScale, AccelScale); 4] = [
    (GyroScale::_250DPS, AccelScale::_2G),
    (GyroScale::_500DPS, AccelScale::_4G),
    (GyroScale::_1000DPS, AccelScale::_8G),
    (GyroScale::_2000DPS, AccelScale::_16G),
];

fn marg(bench: &impl Bench) -> Verdict {
    let mut config = MpuConfig::marg();
    config
        .gyro_temp_data_rate(GyroTempDataRate::DlpfConf(Dlpf::_3))
        .accel_data_rate(AccelDataRate::DlpfConf(Dlpf::_2))
        .mag_scale(::mpu9250::MagScale::_16BITS)
        .sample_rate_divisor(4);
    let mut mpu = Mpu9250::marg(Hal(bench.bus()), &mut Delay(bench), &mut config)
        .map_err(|it| format!("start: {it:?}"))?;
    for (range, (gyro, accel)) in RANGES.into_iter().enumerate() {
        mpu.gyro_scale(gyro).map_err(told("gyro"))?;
        mpu.accel_scale(accel).map_err(told("accel"))?;
        let sensed = bench.show(something(GYRO[range], ACCEL[range]));
        bench.next();
        let ready = |mpu: &mut Mpu9250<_, _>| {
            mpu.get_interrupt_status().map(|it| it.contains(InterruptEnable::RAW_RDY_EN))
        };
        equal("ready", ready(&mut mpu).map_err(told("status"))?, true)?;
        let read = mpu.all::<[f32; 3]>().map_err(told("read"))?;
        agrees("gyro", read.gyro.map(|it| f64::from(it).to_degrees()), sensed.gyro_dps, GYRO[range])?;
        agrees("accel", read.accel.map(|it| f64::from(it) / G), sensed.accel_g, ACCEL[range])?;
        // In milligauss.
        agrees("mag", read.mag.map(|it| f64::from(it) / 10.0), sensed.mag_ut, MAG)?;
        agrees("temperature", [f64::from(read.temp); 3], [sensed.celsius; 3], 333.87)?;
        bench.comes_to("ready after reading", false, || {
            mpu.all::<[f32; 3]>().map_err(told("read"))?;
            ready(&mut mpu).map_err(told("status"))
        })?;
        bench.is_set(Channel::Gyro, (1000, 5), range as u8, "DLPF 3")?;
        bench.is_set(Channel::Accel, (1000, 5), range as u8, "DLPF 2")?;
    }
    Ok(())
}

fn imu(bench: &impl Bench) -> Verdict {
    let mut mpu =
        Mpu9250::imu_default(Hal(bench.bus()), &mut Delay(bench)).map_err(|it| format!("start: {it:?}"))?;
    let sensed = bench.show(something(GYRO[0], ACCEL[0]));
    bench.next();
    let read = mpu.all::<[f32; 3]>().map_err(told("read"))?;
    agrees("gyro", read.gyro.map(|it| f64::from(it).to_degrees()), sensed.gyro_dps, GYRO[0])?;
    agrees("accel", read.accel.map(|it| f64::from(it) / G), sensed.accel_g, ACCEL[0])?;
    bench.is_set(Channel::Gyro, (8000, 1), 0, "DLPF 0")
}

/// The driver takes the temperature's counts for unsigned: below 21 °C it is 65536/333.87 = 196 °C too high.
fn cold(bench: &impl Bench) -> Verdict {
    let mut mpu =
        Mpu9250::imu_default(Hal(bench.bus()), &mut Delay(bench)).map_err(|it| format!("start: {it:?}"))?;
    bench.show(super::Sensed { celsius: 15.0, ..something(GYRO[0], ACCEL[0]) });
    bench.next();
    let read = f64::from(mpu.temp().map_err(told("read"))?) - 65536.0 / 333.87;
    agrees("temperature", [read; 3], [15.0; 3], 333.87)
}

fn chip() -> Mpu {
    Mpu::mpu9250(0x68, [128; 3])
}

#[test]
fn an_mpu9250_reads_as_its_driver_scales_it() {
    agrees_everywhere!(marg, TDK, chip(), turning("MPU-9250"));
}

#[test]
fn an_mpu6500_reads_as_the_driver_of_its_family_scales_it() {
    agrees_everywhere!(imu, TDK, Mpu::mpu6500(0x68), turning("MPU-6500"));
}

#[test]
fn the_driver_reads_a_cold_mpu9250_as_hot() {
    let shown = still("MPU-9250", super::Sensed { celsius: 15.0, ..something(GYRO[0], ACCEL[0]) });
    agrees_everywhere!(cold, TDK, chip(), shown);
}

#[test]
fn an_mpu6050_is_refused_by_a_driver_of_another_chip() {
    notices!(imu, TDK, Mpu::mpu6050(0x68), "InvalidDevice(104)");
    notices!(imu, TDK, Mpu::mpu6500(0x69), "Nack");
}

#[test]
fn flaws_of_an_mpu9250_are_noticed() {
    let scale = Flaw::Scale { bank: 0, register: 0x1b, bits: 0x08 };
    notices!(marg, TDK, Flawed::new(chip(), 0x68, scale), "gyro x");
    let scale = Flaw::Scale { bank: 0, register: 0x1c, bits: 0x10 };
    notices!(marg, TDK, Flawed::new(chip(), 0x68, scale), "accel x");
    notices!(marg, TDK, Flawed::new(chip(), 0x68, Flaw::Swapped(0x3b..0x49)), "gyro x");
    let stuck = Flaw::Stuck { register: 0x3a, bits: 0x01 };
    notices!(marg, TDK, Flawed::new(chip(), 0x68, stuck), "ready after reading");
}
