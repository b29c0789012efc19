//! The driver of an MPU whose registers come as packets.

use ratetable_protocols::Losses;
use ratetable_protocols::mpu::{self, Packet, Received, config, imu, mag, registers};

use super::{Counts, Driver};
use crate::sample::{Sample, Unwrap};

/// Standard gravity, m/s²: one g.
const G: f64 = 9.80665;

/// How the chip sits in the vehicle: turns vectors from chip axes to body axes (FRD).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mount([[f64; 3]; 3]);

impl Mount {
    /// Chip axes are forward, left, up: the usual way.
    pub const FLU: Self = Self([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]]);

    /// Chip axes are forward, right, down.
    pub const FRD: Self = Self([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);

    /// A mount by its rotation matrix: each row is a body axis in chip axes.
    pub const fn from_rows(rows: [[f64; 3]; 3]) -> Self {
        Self(rows)
    }

    /// A vector in chip axes as one in body axes.
    pub fn to_body(&self, chip: [f64; 3]) -> [f64; 3] {
        self.0.map(|row| row[0] * chip[0] + row[1] * chip[1] + row[2] * chip[2])
    }
}

/// Units per count, as the configuration packet says.
#[derive(Debug, Clone, Copy)]
struct Scales {
    chip: Option<registers::Chip>,
    gyro: f64,
    accel: f64,
    has_mag: bool,
    asa: [u8; 3],
}

impl Scales {
    fn of(config: &config::Repr) -> Self {
        Self {
            chip: registers::Chip::from_who_am_i(config.who_am_i),
            gyro: (1.0 / registers::gyro_lsb_per_dps(config.gyro_config)).to_radians(),
            accel: G / registers::accel_lsb_per_g(config.accel_config),
            has_mag: config.mag_who == registers::WHO_AK8963,
            asa: config.asa,
        }
    }
}

/// Reads `mpu` packets; takes no reading before a `config` packet has told the scales.
#[derive(Debug, Clone)]
pub struct MpuDriver {
    decoder: mpu::Decoder,
    state: State,
}

/// Everything but the stream's own state.
#[derive(Debug, Clone)]
struct State {
    mount: Mount,
    scales: Option<Scales>,
    time: Unwrap,
    losses: Losses,
    counts: Counts,
    temperature_c: Option<f64>,
}

impl MpuDriver {
    /// A driver for a chip that is mounted so.
    pub fn new(mount: Mount) -> Self {
        let state = State {
            mount,
            scales: None,
            time: Unwrap::default(),
            losses: Losses::new(),
            counts: Counts::default(),
            temperature_c: None,
        };
        Self { decoder: mpu::Decoder::new(), state }
    }

    /// The chip's temperature, °C, once an `imu` packet of a known chip has come.
    pub fn temperature_c(&self) -> Option<f64> {
        self.state.temperature_c
    }
}

impl Driver for MpuDriver {
    fn feed(&mut self, bytes: &[u8], on: &mut dyn FnMut(Sample)) {
        let Self { decoder, state } = self;
        decoder.feed(bytes, |received| match received {
            Ok(received) => {
                if let Some(sample) = state.receive(&received) {
                    on(sample);
                }
            }
            Err(_) => state.counts.damaged += 1,
        });
    }

    fn counts(&self) -> Counts {
        Counts { lost: self.state.losses.lost(), ..self.state.counts }
    }
}

impl State {
    /// Takes a packet; gives its readings if it has any that can be used.
    fn receive(&mut self, received: &Received) -> Option<Sample> {
        self.counts.packets += 1;
        self.losses.observe(received.seq);
        if let Packet::Config(config) = &received.packet {
            self.scales = Some(Scales::of(config));
            return None;
        }
        let t_us = self.time.unwrap(received.t_us);
        let sample = self.scales.and_then(|scales| self.read(t_us, &scales, &received.packet));
        match &sample {
            Some(sample) => self.counts.take(sample),
            None => self.counts.skipped += 1,
        }
        sample
    }

    /// A packet's readings in units and body axes.
    fn read(&mut self, t_us: u64, scales: &Scales, packet: &Packet) -> Option<Sample> {
        let none = Sample { t_us, ..Sample::default() };
        match packet {
            Packet::Imu(imu) => {
                self.temperature_c = temperature_c(scales, imu);
                let gyro = Some(self.inertial(imu.gyro, scales.gyro));
                let accel = Some(self.inertial(imu.accel, scales.accel));
                Some(Sample { gyro, accel, ..none })
            }
            Packet::Gyro(repr) => {
                let gyro = Some(self.inertial(repr.gyro, scales.gyro));
                Some(Sample { gyro, ..none })
            }
            Packet::Accel(repr) => {
                let accel = Some(self.inertial(repr.accel, scales.accel));
                Some(Sample { accel, ..none })
            }
            Packet::Mag(repr) => {
                let mag = Some(self.mount.to_body(mag_ut(scales, repr)?));
                Some(Sample { mag, ..none })
            }
            Packet::Config(_) | Packet::Attitude(_) => None,
        }
    }

    /// Counts of gyro or accelerometer as units in body axes.
    fn inertial(&self, counts: [i16; 3], scale: f64) -> [f64; 3] {
        self.mount.to_body(counts.map(|count| f64::from(count) * scale))
    }
}

/// The die's temperature, °C.
fn temperature_c(scales: &Scales, imu: &imu::Repr) -> Option<f64> {
    Some(scales.chip?.temperature_c(imu.temperature))
}

/// The field in µT and *chip* axes; `None` if the reading is old, overflowed or not there.
fn mag_ut(scales: &Scales, mag: &mag::Repr) -> Option<[f64; 3]> {
    let fresh = mag.st1 & registers::ST1_DATA_READY != 0;
    let overflowed = mag.st2 & registers::ST2_OVERFLOW != 0;
    if !scales.has_mag || !fresh || overflowed {
        return None;
    }
    let sixteen_bit = mag.st2 & registers::ST2_16_BIT != 0;
    let field_ut = std::array::from_fn(|axis| {
        f64::from(mag.field[axis]) * registers::mag_ut_per_lsb(scales.asa[axis], sixteen_bit)
    });
    Some(registers::swap_mag_axes(field_ut))
}

#[cfg(test)]
mod tests {
    use super::*;
    use ratetable_protocols::mpu::{accel, encode, gyro};

    const CONFIG: config::Repr = config::Repr {
        who_am_i: registers::WHO_MPU9250,
        smplrt_div: 0,
        config: 1,
        gyro_config: 0x18,
        accel_config: 0x08,
        mag_who: registers::WHO_AK8963,
        cntl1: 0x16,
        asa: [128, 128, 128],
    };

    fn feed(driver: &mut MpuDriver, seq: u8, t_us: u32, packet: Packet) -> Vec<Sample> {
        let mut bytes = [0; mpu::MAX_LEN];
        let len = encode(seq, t_us, &packet, &mut bytes).unwrap();
        let mut samples = Vec::new();
        driver.feed(&bytes[..len], &mut |sample| samples.push(sample));
        samples
    }

    #[test]
    fn no_reading_is_taken_before_the_scales_are_known() {
        let mut driver = MpuDriver::new(Mount::FLU);
        let gyro = Packet::Gyro(gyro::Repr { gyro: [164, 0, 0] });
        assert!(feed(&mut driver, 0, 0, gyro).is_empty());
        assert!(feed(&mut driver, 1, 0, Packet::Config(CONFIG)).is_empty());
        let [sample] = feed(&mut driver, 4, 1000, gyro)[..] else { panic!() };
        assert_eq!(sample.t_us, 1000);
        assert!((sample.gyro.unwrap()[0] - 10_f64.to_radians()).abs() < 1e-12);
        let counts = driver.counts();
        assert_eq!((counts.packets, counts.lost, counts.gyro, counts.skipped), (3, 2, 1, 1));
    }

    #[test]
    fn a_chip_lying_flat_gives_level_readings_in_body_axes() {
        let mut driver = MpuDriver::new(Mount::FLU);
        feed(&mut driver, 0, 0, Packet::Config(CONFIG));
        let flat = Packet::Accel(accel::Repr { accel: [0, 0, 8192] });
        let [sample] = feed(&mut driver, 1, 0, flat)[..] else { panic!() };
        assert_eq!(sample.accel.map(|f| f[2]), Some(-G));

        // Field north 15 µT and down 30 µT: chip (FLU) [15, 0, -30], AK8963 [0, 15, 30].
        let field = Packet::Mag(mag::Repr { st1: 1, field: [0, 100, 200], st2: 0x10 });
        let [sample] = feed(&mut driver, 2, 0, field)[..] else { panic!() };
        assert_eq!(sample.mag, Some([15.0, 0.0, 30.0]));
    }

    #[test]
    fn an_overflowed_or_old_field_is_left() {
        let mut driver = MpuDriver::new(Mount::FLU);
        feed(&mut driver, 0, 0, Packet::Config(CONFIG));
        for (st1, st2) in [(1, 0x18), (0, 0x10)] {
            let packet = Packet::Mag(mag::Repr { st1, field: [1, 2, 3], st2 });
            assert!(feed(&mut driver, 1, 0, packet).is_empty());
        }
        assert_eq!(driver.counts().skipped, 2);
    }

    #[test]
    fn a_burst_carries_both_and_the_temperature() {
        let mut driver = MpuDriver::new(Mount::FRD);
        feed(&mut driver, 0, 0, Packet::Config(CONFIG));
        let burst = imu::Repr { accel: [0, 0, -8192], temperature: 1335, gyro: [0, 0, 164] };
        let [sample] = feed(&mut driver, 1, 7, Packet::Imu(burst))[..] else { panic!() };
        assert_eq!(sample.accel, Some([0.0, 0.0, -G]));
        assert!((sample.gyro.unwrap()[2].to_degrees() - 10.0).abs() < 1e-9);
        assert!((driver.temperature_c().unwrap() - 25.0).abs() < 0.01);
    }
}
