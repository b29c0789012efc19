//! Vibration: sines that are felt beside the motion, and random vibration by its power spectral density.
//!
//! A sine is `A·sin(2πft + p)` at the sensor's ticks, so one above half the rate folds over, as in a part. A density S
//! over [from, to] is 32 sines, one of random frequency and phase from each slice Δf of the band, with A = √(2·∫S df)
//! (Rice 1944; Shinozuka & Jan 1972): nearly normal, of variance S·(to − from), and nothing outside the band. A table
//! of densities at frequencies is such a band from each point to the next, S being straight between them in logarithms
//! of both, as test standards draw profiles (MIL-STD-810H, method 514.8): S = S₁·(f/f₁)ᵇ. A filter of the sensor, and the mean of `sampling = "average"`, act on each sine as in continuous time: before it folds over.

use super::filter::LowPass;
use super::strides::{STRIDE, strides};
use super::{Block, Context, Kinds, Sampling, SensorKind, Stage, Term, TermKind, delay};
use crate::keys::{Key, KeyError, Name, Values};
use crate::quantity::{Kind, Sign};
use crate::time::{Rate, SimTime};
use glam::DVec3;
use rand::RngExt;
use std::f64::consts::{PI, TAU};

/// Sines that a band is made of.
const LINES: usize = 32;
const PROFILE: &str = "[{ frequency = \"20 Hz\", density = \"0.001 g^2/Hz\" }, { frequency = \"200 Hz\", density = \"0.01 g^2/Hz\" }]";
const EXAMPLE: &str = "[{ frequency = \"120 Hz\", amplitude = \"[0.2, 0.2, 1] m/s^2\" }]";

const HERTZ: Kind = Kind::FREQUENCY.signed(Sign::NonNegative);

/// Sines and random vibration.
pub const VIBRATION: Name<[Values]> = Name::new("vibration");
const FREQUENCY: Name<f64> = Name::new("frequency");
const AMPLITUDE: Name<DVec3> = Name::new("amplitude");
const PHASE: Name<DVec3> = Name::new("phase");
const DENSITY: Name<DVec3> = Name::new("density");
const FROM: Name<f64> = Name::new("from");
const TO: Name<f64> = Name::new("to");
const SPECTRUM: Name<[Values]> = Name::new("spectrum");

/// A point of a spectrum.
const fn point(spectrum: Kind) -> [Key; 2] {
    [FREQUENCY.scalar(HERTZ, "of the point"), DENSITY.per_axis(spectrum, "there, one-sided")]
}

static GYRO_POINT: [Key; 2] = point(Kind::GYRO_SPECTRUM);
static ACCEL_POINT: [Key; 2] = point(Kind::ACCEL_SPECTRUM);

const fn keys(reading: Kind, spectrum: Kind, point: &'static [Key]) -> [Key; 7] {
    [
        FREQUENCY.scalar(HERTZ, "of a sine"),
        AMPLITUDE.body_vector(reading, "of the sine"),
        PHASE.per_axis(Kind::ANGLE, "of the sine at t = 0").or("0"),
        DENSITY.per_axis(spectrum, "of random vibration, one-sided"),
        FROM.scalar(HERTZ, "where its band begins"),
        TO.scalar(HERTZ, "where its band ends"),
        SPECTRUM.tables(point, PROFILE, "of random vibration, as points"),
    ]
}

static GYRO: [Key; 7] = keys(Kind::ANGULAR_RATE, Kind::GYRO_SPECTRUM, &GYRO_POINT);
static ACCEL: [Key; 7] = keys(Kind::ACCELERATION, Kind::ACCEL_SPECTRUM, &ACCEL_POINT);

pub(super) static KIND: TermKind = TermKind {
    name: "vibration",
    about: "vibration added to the motion: sines, or random by spectrum",
    serves: Kinds::of(&[SensorKind::Gyro, SensorKind::Accel]),
    stage: Stage::Signal,
    needs: &[],
    keys: |sensor| {
        let keys = match sensor {
            SensorKind::Gyro => &GYRO,
            _ => &ACCEL,
        };
        vec![VIBRATION.tables(
            keys,
            EXAMPLE,
            "each a sine (`frequency`, `amplitude`, `phase`), or random (`density` over `from` to `to`, or `spectrum`, points of it)",
        )]
    },
    build: |values, context| {
        let mut sines = Vec::new();
        for (i, given) in values.get(VIBRATION).unwrap_or_default().iter().enumerate() {
            let sine = given.get(FREQUENCY).zip(given.get(AMPLITUDE));
            let says_sine = given.has(FREQUENCY) || given.has(AMPLITUDE);
            let says_band = given.has(FROM) || given.has(TO);
            match (sine, given.get(DENSITY), given.get(SPECTRUM).unwrap_or_default()) {
                (Some((hz, amplitude)), None, []) if !says_band => {
                    sines.push(Sine { hz, amplitude, phase: given.get(PHASE).unwrap_or_default() });
                }
                (None, Some(density), []) if !says_sine => {
                    sines.extend(random(&band(given, density)?, i, context));
                }
                (None, None, points @ [_, ..]) if !says_sine && !says_band => {
                    sines.extend(random(&profile(points)?, i, context));
                }
                _ => {
                    let message = format!(
                        "an entry has a `frequency` and an `amplitude`, or a `density` with `from` and `to`, or a `spectrum`: {EXAMPLE}"
                    );
                    return Err(KeyError::new(VIBRATION, message));
                }
            }
        }
        let (filter, late) = (LowPass::of(values), delay(values));
        let felt: Vec<_> = sines.iter().map(|sine| Felt::new(sine, filter, late, context)).collect();
        Ok((!felt.is_empty()).then(|| {
            Box::new(Vibration { felt, clock: context.clock, phase: context.phase, k: 0 }) as Box<dyn Term>
        }))
    },
};

/// `amplitude·sin(2π·hz·t + phase)`.
struct Sine {
    hz: f64,
    amplitude: DVec3,
    phase: DVec3,
}

/// A frequency, Hz, and the density there.
type Point = (f64, DVec3);

/// A band of constant density.
fn band(given: &Values, density: DVec3) -> Result<[Point; 2], KeyError> {
    let band = given.get(FROM).zip(given.get(TO)).filter(|(from, to)| from < to);
    let Some((from, to)) = band else {
        return Err(KeyError::new(
            VIBRATION,
            "a `density` needs its band, `from` below `to`, such as from = \"20 Hz\", to = \"200 Hz\"",
        ));
    };
    Ok([(from, density), (to, density)])
}

/// The points of a table, refused where no line in logarithms goes through them.
fn profile(points: &[Values]) -> Result<Vec<Point>, KeyError> {
    let wrong = |message: String| Err(KeyError::new(VIBRATION, format!("{message}: spectrum = {PROFILE}")));
    let point = |values: &Values| values.get(FREQUENCY).zip(values.get(DENSITY));
    let Some(points) = points.iter().map(point).collect::<Option<Vec<Point>>>() else {
        return wrong("each point of a `spectrum` has its `frequency` and its `density`".into());
    };
    if points.len() < 2 {
        return wrong("a `spectrum` needs at least two points".into());
    }
    for pair in points.windows(2) {
        let [(from, low), (to, high)] = [pair[0], pair[1]];
        if from <= 0.0 || from >= to {
            return wrong(format!(
                "the frequencies of a `spectrum` rise from above 0, but {to} Hz follows {from} Hz"
            ));
        }
        if (0..3).any(|axis| (low[axis] == 0.0) != (high[axis] == 0.0)) {
            return wrong(format!(
                "a `spectrum` must be 0 on an axis everywhere or nowhere, but it changes from {from} to {to} Hz"
            ));
        }
    }
    Ok(points)
}

/// Random vibration as sines, [`LINES`] from each point to the next.
fn random(points: &[Point], i: usize, context: &Context) -> Vec<Sine> {
    let mut streams = context.streams(&format!("vibration/{i}"));
    let mut sines = Vec::with_capacity(LINES * points.len());
    for pair in points.windows(2) {
        let ((from, low), (to, high)) = (pair[0], pair[1]);
        let slice = (to - from) / LINES as f64;
        sines.extend((0..LINES).map(|line| {
            let begin = from + slice * line as f64;
            let power = |axis: usize| power((from, low[axis]), (to, high[axis]), begin, slice);
            let amplitude = DVec3::from_array([0, 1, 2].map(|axis| libm::sqrt(2.0 * power(axis))));
            let hz = from + slice * (line as f64 + streams[0].random::<f64>());
            let phase = DVec3::from_array(streams.each_mut().map(|stream| TAU * stream.random::<f64>()));
            Sine { hz, amplitude, phase }
        }));
    }
    sines
}

/// ∫ S₁·(f/f₁)ᵇ df over a slice that begins at `begin`, the line going from one point to another.
fn power((from, low): (f64, f64), (to, high): (f64, f64), begin: f64, slice: f64) -> f64 {
    if low == high {
        return slice * low;
    }
    let b = libm::log(high / low) / libm::log(to / from);
    let (x, y) = (begin / from, (begin + slice) / from);
    // The antiderivative's limit at b = −1 is a logarithm, whose neighbourhood loses digits.
    let area = if (b + 1.0).abs() < 1e-9 {
        libm::log(y / x)
    } else {
        libm::pow(x, b + 1.0) * libm::expm1((b + 1.0) * libm::log(y / x)) / (b + 1.0)
    };
    low * from * area
}

/// A sine as the sensor feels it.
struct Felt {
    hz: f64,
    amplitude: [f64; 3],
    phase: [f64; 3],
    /// sin and cos of what j ticks turn it by.
    sines: [f64; STRIDE],
    cosines: [f64; STRIDE],
}

impl Felt {
    fn new(sine: &Sine, filter: Option<LowPass>, late: SimTime, context: &Context) -> Felt {
        let (hz, half) = (sine.hz, PI * sine.hz * context.clock.period());
        let (mut gain, mut shift) = filter.map_or((1.0, 0.0), |filter| filter.response(hz));
        if context.sampling == Sampling::Average && half > 0.0 {
            (gain, shift) = (gain * libm::sin(half) / half, shift - half);
        }
        shift -= TAU * turns(hz, late.seconds());
        let angle = |j: usize| TAU * turns(hz, j as f64 * context.clock.period());
        Felt {
            hz,
            amplitude: (sine.amplitude * gain).to_array(),
            phase: (sine.phase + shift).to_array(),
            sines: std::array::from_fn(|j| libm::sin(angle(j))),
            cosines: std::array::from_fn(|j| libm::cos(angle(j))),
        }
    }
}

/// The part of a turn that a frequency makes in a time.
fn turns(hz: f64, seconds: f64) -> f64 {
    let turns = hz * seconds;
    turns - turns.floor()
}

struct Vibration {
    felt: Vec<Felt>,
    clock: Rate,
    phase: SimTime,
    k: u64,
}

impl Term for Vibration {
    #[inline(always)]
    fn apply(&mut self, block: &mut Block) {
        for stride in strides(self.k, block.len()) {
            let t = (self.phase + self.clock.tick(stride.anchor)).seconds();
            let within = stride.offset..stride.offset + stride.samples.len();
            for felt in &self.felt {
                let angle = TAU * turns(felt.hz, t);
                let (sines, cosines) = (&felt.sines[within.clone()], &felt.cosines[within.clone()]);
                for axis in (0..3).filter(|&axis| felt.amplitude[axis] != 0.0) {
                    let (amplitude, start) = (felt.amplitude[axis], angle + felt.phase[axis]);
                    let (sine, cosine) = (amplitude * libm::sin(start), amplitude * libm::cos(start));
                    let column = &mut block.reading[axis][stride.samples.clone()];
                    for ((reading, s), c) in column.iter_mut().zip(sines).zip(cosines) {
                        *reading += sine * c + cosine * s;
                    }
                }
            }
        }
        self.k += block.len() as u64;
    }
}
