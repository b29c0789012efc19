//! `icm20948-async` 0.6 (embedded-hal-async): an ICM-20948 with its AK09916 through slave 0 alone.

use ::icm20948_async::{AccDlp, AccRange, AccUnit, GyrDlp, GyrRange, GyrUnit, IcmBuilder};
use ratetable_protocols::chip::{Channel, icm20948::Icm20948};

use super::emulated::turning;
use super::flaw::{Flaw, Flawed};
use super::hal::{Delay, Hal, block_on};
use super::{
    ACCEL, Bench, GYRO, MAG, TDK, Verdict, agrees, agrees_everywhere, equal, notices, something, told,
};

fn check(bench: &impl Bench) -> Verdict {
    block_on(async {
        let mut icm = IcmBuilder::new_i2c(Hal(bench.bus()), Delay(bench))
            .set_address(0x68)
            .gyr_unit(GyrUnit::Dps)
            .acc_unit(AccUnit::Gs)
            .gyr_dlp(GyrDlp::Hz120)
            .acc_dlp(AccDlp::Hz111)
            .gyr_odr(4)
            .acc_odr(9)
            .initialize_9dof()
            .await
            .map_err(told("start"))?;
        let ranges = [
            (GyrRange::Dps250, AccRange::Gs2),
            (GyrRange::Dps500, AccRange::Gs4),
            (GyrRange::Dps1000, AccRange::Gs8),
            (GyrRange::Dps2000, AccRange::Gs16),
        ];
        for (range, (gyro, accel)) in ranges.into_iter().enumerate() {
            icm.set_gyr_range(gyro).await.map_err(told("gyro"))?;
            icm.set_acc_range(accel).await.map_err(told("accel"))?;
            let sensed = bench.show(something(GYRO[range], ACCEL[range]));
            bench.next();
            equal("ready", icm.new_data_ready().await, 1)?;
            let read = icm.read_9dof().await.map_err(told("read"))?;
            agrees("gyro", read.gyr.map(f64::from), sensed.gyro_dps, GYRO[range])?;
            agrees("accel", read.acc.map(f64::from), sensed.accel_g, ACCEL[range])?;
            agrees("mag", read.mag.map(f64::from), sensed.mag_ut, MAG)?;
            agrees("temperature", [f64::from(read.tmp); 3], [sensed.celsius; 3], 333.87)?;
            bench.comes_to("ready after reading", 0, || {
                block_on(icm.read_9dof()).map_err(told("read"))?;
                Ok(block_on(icm.new_data_ready()))
            })?;
            bench.is_set(Channel::Gyro, (1125, 5), range as u8, "DLPF 2")?;
            bench.is_set(Channel::Accel, (1125, 10), range as u8, "DLPF 2")?;
        }
        // Offsets in counts of the register: 4 at ±250 deg/s and 16 at ±2 g; the driver takes them away.
        icm.set_gyr_range(GyrRange::Dps250).await.map_err(told("gyro"))?;
        icm.set_gyr_offsets([10, 0, -10]).await.map_err(told("gyro offsets"))?;
        let before = bench.show(something(GYRO[3], ACCEL[3])).gyro_dps.map(|it| it * GYRO[0]);
        bench.next();
        let read = icm.read_gyr_unscaled().await.map_err(told("read"))?.map(f64::from);
        agrees("gyro with offsets", read, [before[0] - 40.0, before[1], before[2] + 40.0], 1.0)
    })
}

#[test]
fn an_icm20948_reads_as_its_driver_scales_it() {
    agrees_everywhere!(check, TDK, Icm20948::new(0x68), turning("ICM-20948"));
}

#[test]
fn flaws_of_an_icm20948_are_noticed() {
    let flawed = |flaw| Flawed::new(Icm20948::new(0x68), 0x68, flaw).banks(0x7f);
    notices!(check, TDK, flawed(Flaw::Scale { bank: 0x20, register: 0x01, bits: 0x04 }), "gyro x");
    notices!(check, TDK, flawed(Flaw::Scale { bank: 0x20, register: 0x14, bits: 0x02 }), "accel x");
    notices!(check, TDK, flawed(Flaw::Swapped(0x2d..0x33)), "accel x");
    notices!(check, TDK, flawed(Flaw::Swapped(0x3b..0x41)), "MagWhoAmI(0)");
    notices!(check, TDK, flawed(Flaw::Stuck { register: 0x74, bits: 0x01 }), "ready after reading");
    notices!(check, TDK, Icm20948::new(0x69), "Nack");
}
