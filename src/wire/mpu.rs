//! `mpu`: register images of an MPU-6050 or MPU-9250, as its driver reads them.
//!
//! Readings become counts on the chip's axes. Without a scale in the scene, a sensor uses ±2000 °/s, ±16 g, 0.15 µT
//! with ASA 128, and 25 °C.

mod dialogue;
mod reader;

use super::row::Row;
use super::{Encoder, EverySecond, Layout, Newest, Now, Packet, Setup};
use crate::earth::STANDARD_GRAVITY;
use crate::sensor::{ByKind, Kinds, Mount, REFERENCE_TEMPERATURE, SensorKind, SensorPlan, lsb};
use crate::sensor::{FILTER, LOW_PASS, RANGE};
use crate::time::SimTime;
use ratetable_protocols::mpu::registers::{self, Chip};
use ratetable_protocols::mpu::{self, accel, config, gyro, imu, mag};

pub(super) static ROW: Row = Row {
    name: "mpu",
    about: "registers of an MPU-6050 or MPU-9250 in COBS frames with a CRC: imu, gyro, accel, mag, config",
    carries: Kinds::TRIADS,
    encoder: |setup| Box::new(Mpu::new(setup)),
    reader: |assumed| Box::new(reader::Reader::new(assumed.mounts)),
    dialogue: |_| Some(Box::new(dialogue::Answers::new())),
    shared: |_, _| None,
    keys: &["layout"],
    check: |options, sensors| {
        let has = |kind| sensors.iter().any(|sensor| sensor.kind == kind);
        match options.layout {
            Some(Layout::Burst) if !(has(SensorKind::Gyro) && has(SensorKind::Accel)) => {
                Err("`layout = \"burst\"` needs both [gyro] and [accel]".into())
            }
            _ => Ok(()),
        }
    },
    greeting: |_| vec![0],
    is_numbered: true,
    // A packet ends with its zero.
    inside: |len| (0..len.saturating_sub(1), Some(0)),
};

/// No adjustment of the magnetometer's sensitivity.
const ASA: u8 = 128;
/// 16-bit output, continuous measurement at 100 Hz.
const CNTL1: u8 = 0x16;
const IMU: Kinds = Kinds::of(&[SensorKind::Gyro, SensorKind::Accel]);

pub(super) struct Mpu {
    seq: u8,
    seconds: EverySecond,
    newest: Newest,
    config: config::Repr,
    chip: Chip,
    /// Of gyro, accel and mag: the rotation from body to chip, and the unit of one count.
    scales: [(Mount, f64); 3],
    /// The sensor whose ticks send an `imu` packet, if gyro and accel share packets.
    burst: Option<SensorKind>,
}

impl Mpu {
    pub(super) fn new(setup: &Setup<'_>) -> Mpu {
        let plan = |kind| setup.sensors.iter().find(|sensor| sensor.kind == kind);
        let [gyro, accel, mag] = SensorKind::TRIADS.map(plan);
        let is_60x0 = [gyro, accel].into_iter().flatten().any(|sensor| sensor.part == Some("MPU-6050"));
        let chip = if is_60x0 { Chip::Mpu60x0 } else { Chip::Mpu9250 };
        let (gyro_config, gyro_count) = gyro_scale(gyro);
        let (accel_config, accel_count) = accel_scale(accel);
        let mount =
            |sensor: Option<&SensorPlan>| sensor.and_then(|sensor| sensor.mount).unwrap_or_else(Mount::flu);
        let (config, smplrt_div) = sampling(chip, gyro, accel);
        Mpu {
            seq: 0,
            seconds: EverySecond::default(),
            newest: Newest::new(&setup.options),
            config: config::Repr {
                who_am_i: chip.who_am_i(),
                smplrt_div,
                config,
                gyro_config,
                accel_config,
                mag_who: if mag.is_some() { registers::WHO_AK8963 } else { 0 },
                cntl1: if mag.is_some() { CNTL1 } else { 0 },
                asa: [ASA; 3],
            },
            chip,
            scales: [
                (mount(gyro), gyro_count),
                (mount(accel), accel_count),
                (mount(mag), registers::mag_ut_per_lsb(ASA, true)),
            ],
            burst: burst(setup, gyro, accel),
        }
    }

    fn push(&mut self, t: SimTime, kinds: Kinds, packet: &mpu::Packet, out: &mut Vec<Packet>) {
        let (seq, t_us) = (self.seq, (t.0 / 1000) as u32);
        // A packet of ours holds every one of the chip's.
        self.newest.append(out, t, kinds, |_, bytes| mpu::encode(seq, t_us, packet, bytes).unwrap_or(0));
        self.seq = seq.wrapping_add(1);
    }

    /// The newest reading in counts on the chip's axes.
    fn counts(&self, kind: SensorKind) -> [i16; 3] {
        let (mount, count) = self.scales[kind as usize];
        let Some(value) = self.newest.told.body(kind) else { return [0; 3] };
        let chip = mount.to_chip(value).v.to_array();
        match kind {
            SensorKind::Mag => registers::swap_mag_axes(chip).map(|x| registers::mag_raw(x, ASA)),
            _ => chip.map(|x| registers::nearest(x / count)),
        }
    }

    /// Temperature of the die, °C: the gyro's where it has one.
    fn temperature(&self) -> f64 {
        let of = |kind| self.newest.told.temperature(kind);
        of(SensorKind::Gyro).or_else(|| of(SensorKind::Accel)).unwrap_or(REFERENCE_TEMPERATURE)
    }

    fn imu(&self) -> mpu::Packet {
        mpu::Packet::Imu(imu::Repr {
            accel: self.counts(SensorKind::Accel),
            temperature: self.chip.temperature_raw(self.temperature()),
            gyro: self.counts(SensorKind::Gyro),
        })
    }

    /// A packet with the newest reading of this sensor alone; `None` for a sensor that these chips lack.
    fn alone(&self, kind: SensorKind) -> Option<mpu::Packet> {
        Some(match kind {
            SensorKind::Baro | SensorKind::Gps | SensorKind::Airspeed => return None,
            SensorKind::Gyro => mpu::Packet::Gyro(gyro::Repr { gyro: self.counts(kind) }),
            SensorKind::Accel => mpu::Packet::Accel(accel::Repr { accel: self.counts(kind) }),
            SensorKind::Mag => {
                let (mount, count) = self.scales[kind as usize];
                // AK8963 (MS1356-E): it overflows when |X| + |Y| + |Z| reaches the full scale.
                let sum = |value| mount.to_chip(value).v.abs().element_sum();
                let field = self.newest.told.body(kind).map_or(0.0, sum);
                let overflow = if field > f64::from(registers::MAG_MAX_COUNT) * count {
                    registers::ST2_OVERFLOW
                } else {
                    0
                };
                mpu::Packet::Mag(mag::Repr {
                    st1: registers::ST1_DATA_READY,
                    field: self.counts(kind),
                    st2: registers::ST2_16_BIT | overflow,
                })
            }
        })
    }
}

impl Encoder for Mpu {
    fn encode(&mut self, now: &Now<'_>, out: &mut Vec<Packet>) {
        let Now { t, readings, .. } = *now;
        for second in self.seconds.due(t) {
            let config = mpu::Packet::Config(self.config);
            self.push(second, Kinds::NONE, &config, out);
        }
        self.newest.take_in(readings);
        if self.burst.is_some_and(|carrier| readings.iter().any(|reading| reading.kind == carrier)) {
            self.push(t, IMU, &self.imu(), out);
        }
        let together = self.burst.is_some();
        let is_alone = |kind: &SensorKind| !together || *kind == SensorKind::Mag;
        for kind in readings.iter().map(|reading| reading.kind).filter(is_alone) {
            if let Some(packet) = self.alone(kind) {
                self.push(t, kind.into(), &packet, out);
            }
        }
    }

    fn waiting(&self) -> ByKind<u64> {
        self.newest.waiting()
    }
}

/// The size of one count of gyro, accel and mag: rad/s, m/s², µT.
pub(super) fn counts(sensors: &[SensorPlan]) -> [f64; 3] {
    let plan = |kind| sensors.iter().find(|sensor| sensor.kind == kind);
    let mag = registers::mag_ut_per_lsb(ASA, true);
    [gyro_scale(plan(SensorKind::Gyro)).1, accel_scale(plan(SensorKind::Accel)).1, mag]
}

fn gyro_scale(gyro: Option<&SensorPlan>) -> (u8, f64) {
    scale(gyro, |config| 1f64.to_radians() / registers::gyro_lsb_per_dps(config))
}

fn accel_scale(accel: Option<&SensorPlan>) -> (u8, f64) {
    scale(accel, |config| STANDARD_GRAVITY / registers::accel_lsb_per_g(config))
}

/// A nominal full scale may exceed what 16 bits hold by this factor: 1000 °/s at 32.8 LSB/(°/s) is 32 800 counts.
const NOMINAL: f64 = 1.01;

/// The full-scale bits whose count is the scene's, else those of the smallest scale that holds its range, else of
/// the largest.
fn scale(sensor: Option<&SensorPlan>, count: impl Fn(u8) -> f64) -> (u8, f64) {
    let scales =
        [0, 1, 2, 3].map(|bits| (registers::full_scale_bits(bits), count(registers::full_scale_bits(bits))));
    let wanted = sensor.and_then(|sensor| lsb(&sensor.values, sensor.kind));
    let exact = scales.iter().find(|(_, count)| wanted.is_some_and(|lsb| (lsb / count - 1.0).abs() < 1e-6));
    let range = sensor.and_then(|sensor| sensor.values.get(RANGE));
    let holding =
        scales.iter().find(|(_, count)| range.is_some_and(|range| range <= NOMINAL * 32768.0 * count));
    *exact.or(holding).unwrap_or(&scales[3])
}

/// The sensor at whose ticks gyro and accel go out together: on request, or by default when their ticks agree.
fn burst(setup: &Setup<'_>, gyro: Option<&SensorPlan>, accel: Option<&SensorPlan>) -> Option<SensorKind> {
    let (gyro, accel) = (gyro?, accel?);
    let alike = gyro.ticks_with(accel);
    let together = setup.options.layout.map_or(alike, |layout| layout == Layout::Burst);
    let faster = if accel.rate.as_hz() > gyro.rate.as_hz() { SensorKind::Accel } else { SensorKind::Gyro };
    together.then_some(faster)
}

/// CONFIG and SMPLRT_DIV for the rate of the faster sensor and the gyro's low-pass filter (the accelerometer's
/// without a gyro): the nearest bandwidth available at that rate. Without a filter DLPF_CFG is 1 up to 1 kHz, 0
/// above.
fn sampling(chip: Chip, gyro: Option<&SensorPlan>, accel: Option<&SensorPlan>) -> (u8, u8) {
    let hz = [gyro, accel].into_iter().flatten().map(|sensor| sensor.rate.as_hz()).fold(0.0, f64::max);
    let divider = |undivided: f64| (libm::round(undivided / hz) - 1.0).clamp(0.0, 255.0) as u8;
    // Half a per cent of tolerance: the clocks of these parts are less accurate.
    if hz > 1005.0 {
        return (0, if chip == Chip::Mpu60x0 { divider(8000.0) } else { 0 });
    }
    let filter = gyro.or(accel).and_then(|sensor| sensor.values.get(FILTER)?.get(LOW_PASS));
    let Some(cut_off) = filter else { return (1, divider(1000.0)) };
    let bandwidths = chip.gyro_bandwidths_hz();
    // Only an MPU-6050 divides 8 kHz, and by 256 at most.
    let widest = if chip == Chip::Mpu60x0 && hz >= 8000.0 / 256.0 { 0 } else { 1 };
    let off = |config: &u8| libm::log(bandwidths[usize::from(*config)] / cut_off).abs();
    let config = (widest..=6).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(1);
    (config, divider(if config == 0 { 8000.0 } else { 1000.0 }))
}
