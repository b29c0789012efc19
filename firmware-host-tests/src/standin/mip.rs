//! ArduPilot with a MicroStrain unit as its external AHRS: no handshake, each packet stamped on arrival.

use ratetable_protocols::mip::{Decoder, imu};

use super::{Firmware, Own, Record, Settings};
use crate::sample::Sample;

/// m/s² in a g.
const G: f64 = 9.80665;
/// µT in a gauss.
const UT_PER_GAUSS: f64 = 100.0;

/// ArduPilot and its driver.
pub struct Mip {
    decoder: Decoder,
    own: Own,
    record: Record,
}

impl Mip {
    /// Just booted.
    pub fn new(settings: &Settings) -> Self {
        let own = Own::new(settings.ahrs, settings.declination_rad);
        Self { decoder: Decoder::new(), own, record: Record::default() }
    }
}

impl Firmware for Mip {
    fn receive(&mut self, bytes: &[u8], now_us: u64, _out: &mut Vec<u8>) {
        let Self { decoder, own, record } = self;
        decoder.feed(bytes, |received| match received {
            Ok(imu) => {
                record.counts.packets += 1;
                record.counts.samples += 1;
                own.take(&sample(&imu, now_us), None, record);
            }
            Err(_) => record.counts.damaged += 1,
        });
    }

    fn turn(&mut self, _now_us: u64, _out: &mut Vec<u8>) {}

    fn record(&self) -> &Record {
        &self.record
    }
}

fn sample(imu: &imu::Repr, t_us: u64) -> Sample {
    let scaled = |values: Option<[f32; 3]>, scale: f64| values.map(|v| v.map(|c| f64::from(c) * scale));
    Sample {
        t_us,
        gyro: scaled(imu.gyro, 1.0),
        accel: scaled(imu.accel, G),
        mag: scaled(imu.mag, UT_PER_GAUSS),
    }
}
