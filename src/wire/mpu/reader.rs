//! `mpu`: registers to readings, by the scales of the newest config packet.

use crate::earth::STANDARD_GRAVITY;
use crate::geometry::Vector;
use crate::sensor::{Mount, SensorKind};
use crate::time::SimTime;
use crate::wire::samples::{self, Carrier, Counts, Sample, Sensed, Source};
use crate::wire::wrap::{MICROS_32, unwrapped};
use ratetable_protocols::Losses;
use ratetable_protocols::mpu::registers::{self, ST1_DATA_READY, ST2_16_BIT, ST2_OVERFLOW};
use ratetable_protocols::mpu::{Decoder, Packet, Received, config, mag};

pub(super) struct Reader {
    decoder: Decoder,
    losses: Losses,
    newest: Option<SimTime>,
    config: Option<config::Repr>,
    mounts: [Mount; 3],
}

impl Reader {
    pub(super) fn new(mounts: [Mount; 3]) -> Reader {
        Reader { decoder: Decoder::new(), losses: Losses::new(), newest: None, config: None, mounts }
    }
}

impl samples::Reader for Reader {
    fn feed(&mut self, bytes: &[u8], counts: &mut Counts, each: &mut dyn FnMut(Sample)) {
        let Reader { decoder, losses, newest, config, mounts } = self;
        decoder.feed(bytes, |received| {
            let Ok(Received { seq, t_us, packet }) = received else { return counts.refuse() };
            counts.packets += 1;
            counts.number(losses, seq);
            if let Packet::Attitude(_) = packet {
                // Its time echoes the other direction's.
                return counts.foreign("attitude");
            }
            let first = SimTime(i64::from(t_us) * 1000);
            let t = newest.map_or(first, |newest| unwrapped(first.0, MICROS_32, newest));
            *newest = Some(t);
            let carrier = Carrier { lost: Some(losses.lost()), ..Carrier::default() };
            let mut sample = |kind: SensorKind, chip: Option<[f64; 3]>| {
                let body = |[x, y, z]: [f64; 3]| mounts[kind as usize].to_body(Vector::new(x, y, z));
                let (source, value) = (Source::only("mpu"), chip.map(body).map(Sensed::Body));
                each(Sample { kind, source, t: Some(t), value, packet: carrier });
            };
            match packet {
                Packet::Config(new) => {
                    *config = Some(new);
                    counts.foreign("config");
                }
                Packet::Gyro(seen) => sample(SensorKind::Gyro, gyro(config, seen.gyro)),
                Packet::Accel(seen) => sample(SensorKind::Accel, accel(config, seen.accel)),
                Packet::Imu(seen) => {
                    sample(SensorKind::Gyro, gyro(config, seen.gyro));
                    sample(SensorKind::Accel, accel(config, seen.accel));
                }
                Packet::Mag(seen) if seen.st1 & ST1_DATA_READY == 0 => counts.foreign("mag without new data"),
                Packet::Mag(seen) => sample(SensorKind::Mag, field(config, &seen)),
                Packet::Attitude(_) => {}
            }
        });
    }
}

/// Angular rate on the chip's axes, rad/s.
fn gyro(config: &Option<config::Repr>, counts: [i16; 3]) -> Option<[f64; 3]> {
    let unit = 1f64.to_radians() / registers::gyro_lsb_per_dps(config.as_ref()?.gyro_config);
    Some(counts.map(|count| f64::from(count) * unit))
}

/// Specific force on the chip's axes, m/s².
fn accel(config: &Option<config::Repr>, counts: [i16; 3]) -> Option<[f64; 3]> {
    let unit = STANDARD_GRAVITY / registers::accel_lsb_per_g(config.as_ref()?.accel_config);
    Some(counts.map(|count| f64::from(count) * unit))
}

/// The field on the axes of the gyro's chip, µT; `None` if the magnetometer reports an overflow.
fn field(config: &Option<config::Repr>, seen: &mag::Repr) -> Option<[f64; 3]> {
    let asa = config.as_ref()?.asa;
    let unit = |axis: usize| registers::mag_ut_per_lsb(asa[axis], seen.st2 & ST2_16_BIT != 0);
    let field = [0, 1, 2].map(|axis| f64::from(seen.field[axis]) * unit(axis));
    (seen.st2 & ST2_OVERFLOW == 0).then(|| registers::swap_mag_axes(field))
}
