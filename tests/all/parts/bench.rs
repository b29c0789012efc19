//! What a rate table, a thermal chamber and a centrifuge find out of a part: only readings are looked at.

use super::sheet::{Axes, G};
use ratetable::player::{BLOCK, Player};
use ratetable::scene::Plan;
use ratetable::sensor::{SensorKind, TERMS};
use ratetable::time::Rate;
use std::f64::consts::TAU;

/// Specimens of each part.
pub const SPECIMENS: u64 = 60;
/// Samples of noise on each axis.
pub const NOISE_SAMPLES: u64 = 40_000;
/// By how much the chamber warms a part.
const WARMER: f64 = 40.0;

/// Reading, error-free reading, and whether it clipped.
type Samples = Vec<(Axes, Axes, bool)>;

/// Plays a scene of one sensor with only these of its error terms; readings and error-free readings.
fn play(plan: &Plan, terms: &[&str]) -> Samples {
    let without: Vec<_> = TERMS.iter().map(|term| term.name).filter(|name| !terms.contains(name)).collect();
    let mut player = Player::without(plan, plan.duration, BLOCK, &without);
    let mut samples = Vec::new();
    while let Some(columns) = player.play_columns(ratetable::motion::Wants::NONE) {
        let block = columns.sensor(0);
        let of = |column: &[Vec<f64>; 3], i: usize| [0, 1, 2].map(|axis: usize| column[axis][i]);
        samples
            .extend((0..block.len()).map(|i| (of(&block.reading, i), of(&block.truth, i), block.clipped[i])));
    }
    samples
}

fn parse(text: &str) -> Plan {
    Plan::parse(text, "bench", "bench", &[]).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// A specimen of a part on the bench, in free fall, warmed from 25 °C: at rest for a second, then along each axis in turn
/// half its full scale for a second, and for a gyro then 1 g along each axis in turn.
pub struct Specimen {
    plan: Plan,
    kind: SensorKind,
    half_scale: f64,
}

impl Specimen {
    /// One of the part, whose full scale is `range` (SI); `more` are keys beside the part's.
    pub fn new(part: &str, kind: SensorKind, range: f64, seed: u64, more: &str) -> Specimen {
        let half = 0.5 * range;
        let unit = ["rad/s", "m/s^2", "uT"][kind as usize];
        let axis = |i: usize, size: f64| {
            let mut axes = [0.0; 3];
            axes[i] = size;
            format!("{axes:?}")
        };
        let mut text = format!(
            "seed = {seed}\nduration = \"7 s\"\n[[force]]\nframe = \"nav\"\nacceleration = \"[0, 0, {G}] m/s^2\"\nduration = \"7 s\"\n"
        );
        for i in 0..3 {
            let (at, force) = match kind {
                SensorKind::Gyro => (4 + i, G),
                _ => (1 + i, half),
            };
            if kind != SensorKind::Mag {
                text += &format!(
                    "[[force]]\nstart = \"{at} s\"\nduration = \"1 s\"\nacceleration = \"{} m/s^2\"\n",
                    axis(i, force)
                );
            }
        }
        if kind == SensorKind::Gyro {
            text += "[[motion]]\nkind = \"hold\"\nduration = \"1 s\"\n";
            for i in 0..3 {
                let rate = axis(i, half);
                text += &format!(
                    "[[motion]]\nkind = \"rotate\"\nangular_rate = \"{rate} {unit}\"\nduration = \"1 s\"\n"
                );
            }
        }
        text += &format!(
            "[{kind}]\npart = \"{part}\"\nrate = \"1 Hz\"\nphase = \"0.5 s\"\ntemperature = {{ ambient = \"25 degC\", rise = \"{WARMER} K\", time_constant = \"1 ms\" }}\n{more}\n"
        );
        Specimen { plan: parse(&text), kind, half_scale: half }
    }

    /// The columns of what comes of one unit along each axis, less the reading at rest.
    fn gain(&self, terms: &[&str]) -> [Axes; 3] {
        let samples = play(&self.plan, terms);
        let rest = samples[0].0;
        assert_eq!(samples[0].1.map(|x| x.abs() < 1e-12), [true; 3], "nothing is felt at rest in free fall");
        [1, 2, 3]
            .map(|i: usize| [0, 1, 2].map(|axis: usize| (samples[i].0[axis] - rest[axis]) / self.half_scale))
    }

    /// What it reads of nothing.
    pub fn zero(&self) -> Axes {
        let (reading, truth, _) = play(&self.plan, &["bias"])[0];
        [0, 1, 2].map(|axis| reading[axis] - truth[axis])
    }

    /// The same by temperature, a kelvin.
    pub fn zero_temperature(&self) -> Axes {
        let (reading, truth, _) = play(&self.plan, &["temperature", "bias_temperature"])[0];
        [0, 1, 2].map(|axis| (reading[axis] - truth[axis]) / WARMER)
    }

    /// Scale error of each axis, and the rotation vector of its axes: the rows of the gain are the turned axes, each as
    /// long as its scale.
    pub fn scale_and_cross_axis(&self) -> (Axes, Axes) {
        let columns = self.gain(&["matrix"]);
        let row = |i: usize| [0, 1, 2].map(|j: usize| columns[j][i]);
        let length = |row: Axes| row.iter().map(|x| x * x).sum::<f64>().sqrt();
        let scales = [0, 1, 2].map(|i| length(row(i)));
        let turned = |i: usize, j: usize| columns[j][i] / scales[i];
        let sine = [turned(1, 2) - turned(2, 1), turned(2, 0) - turned(0, 2), turned(0, 1) - turned(1, 0)]
            .map(|x| 0.5 * x);
        let size = length(sine);
        let angle = if size > 0.0 { size.asin() / size } else { 1.0 };
        (scales.map(|scale| scale - 1.0), sine.map(|x| x * angle))
    }

    /// Scale error of each axis a kelvin.
    pub fn scale_temperature(&self) -> Axes {
        let columns = self.gain(&["temperature", "scale_temperature"]);
        [0, 1, 2].map(|axis| (columns[axis][axis] - 1.0) / WARMER)
    }

    /// The deviation at half of full scale, where it is greatest, of full scale.
    pub fn nonlinearity(&self) -> Axes {
        let columns = self.gain(&["nonlinearity"]);
        [0, 1, 2].map(|axis| 0.5 * (columns[axis][axis] - 1.0))
    }

    /// What a gyro reads of an acceleration along the same axis, for one m/s².
    pub fn g_sensitivity(&self) -> Axes {
        assert_eq!(self.kind, SensorKind::Gyro);
        let samples = play(&self.plan, &["g_sensitivity"]);
        [0, 1, 2].map(|axis| samples[4 + axis].0[axis] / G)
    }
}

/// The standard deviation of the white noise on each axis, at rest and at 1 kHz.
pub fn noise(part: &str, kind: SensorKind, more: &str) -> Axes {
    let text = format!(
        "seed = 11\nduration = \"{} s\"\n[{kind}]\npart = \"{part}\"\nrate = \"1 kHz\"\n{more}\n",
        NOISE_SAMPLES / 1000
    );
    let samples = play(&parse(&text), &["white_noise"]);
    [0, 1, 2].map(|axis| {
        let squares: f64 =
            samples.iter().map(|(reading, truth, _)| (reading[axis] - truth[axis]).powi(2)).sum();
        (squares / samples.len() as f64).sqrt()
    })
}

/// Allan deviation at 1 s of what wanders in ten runs of 400 s, of the three axes together, and how many differences.
pub fn stability(part: &str, kind: SensorKind, more: &str) -> (f64, u64) {
    const RATE: usize = 25;
    let (mut squares, mut count) = (0.0, 0);
    for seed in 0..10 {
        let text = format!(
            "seed = {seed}\nduration = \"400 s\"\n[{kind}]\npart = \"{part}\"\nrate = \"{RATE} Hz\"\n{more}\n"
        );
        let samples = play(&parse(&text), &["flicker", "bias_instability"]);
        for axis in 0..3 {
            let mean = |second: &[(Axes, Axes, bool)]| {
                second.iter().map(|(reading, truth, _)| reading[axis] - truth[axis]).sum::<f64>()
                    / RATE as f64
            };
            let means: Vec<f64> = samples.chunks_exact(RATE).map(mean).collect();
            squares += means.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).sum::<f64>();
            count += means.len() as u64 - 1;
        }
    }
    ((0.5 * squares / count as f64).sqrt(), count)
}

/// What a part gives at a range when half as much again is asked of chip x, and the opposite of chip y: the reading on
/// x and on y at the ends, whether they are flagged, and the readings on z meanwhile, in chip axes.
pub struct Ends {
    pub high: f64,
    pub low: f64,
    pub flagged: bool,
    pub between: Vec<f64>,
}

/// At a range (SI).
pub fn ends(part: &str, kind: SensorKind, range: f64, more: &str) -> Ends {
    let beyond = 1.5 * range;
    let stimulus = match kind {
        SensorKind::Gyro => format!(
            "[[motion]]\nkind = \"rotate\"\nangular_rate = \"[{beyond}, {beyond}, 0] rad/s\"\nduration = \"1 s\"\n"
        ),
        SensorKind::Accel => {
            format!("[[force]]\nacceleration = \"[{beyond}, {beyond}, {G}] m/s^2\"\nduration = \"1 s\"\n")
        }
        _ => {
            format!("[earth]\nfield = \"[{beyond}, {beyond}, 0] uT\"\n")
        }
    };
    let unit = ["rad/s", "m/s^2", "uT"][kind as usize];
    let range = format!("range = \"{range} {unit}\"");
    let text = format!(
        "seed = 2\nduration = \"1 s\"\n{stimulus}[{kind}]\npart = \"{part}\"\nrate = \"1 kHz\"\n{range}\n{more}\n"
    );
    let samples = play(&parse(&text), &["white_noise", "range", "resolution"]);
    let (first, _, _) = samples[0];
    assert!(samples.iter().all(|(reading, _, _)| reading[..2] == first[..2]), "clipped throughout");
    Ends {
        high: first[0],
        // Chip y is body −y of a chip that lies flat.
        low: -first[1],
        flagged: samples.iter().all(|(_, _, clipped)| *clipped),
        between: samples.iter().map(|(reading, _, _)| -reading[2]).collect(),
    }
}

/// The gain of a part's filter, by its name and at a rate, for a sine of this frequency (Hz). At half the rate a sine has
/// no phase that samples could show: it is then measured at a rate 0.2 % lower, which is the same setting.
pub fn gain(part: &str, kind: SensorKind, filter: &str, rate: &Rate, hz: f64) -> f64 {
    let half = (2.0 * hz / rate.as_hz() - 1.0).abs() < 1e-6;
    let rate = if half { format!("{} Hz", 0.998 * rate.as_hz()) } else { rate.to_string() };
    let unit = ["rad/s", "m/s^2"][kind as usize];
    let text = format!(
        "duration = \"600 s\"\n[{kind}]\npart = \"{part}\"\nrate = \"{rate}\"\nfilter = \"{filter}\"\nvibration = {{ frequency = \"{hz} Hz\", amplitude = \"1 {unit}\" }}\n"
    );
    let mut plan = parse(&text);
    plan.duration = plan.sensors[0].rate.tick(500);
    let rate = plan.sensors[0].rate.as_hz();
    let [mut cc, mut cs, mut ss, mut xc, mut xs] = [0.0; 5];
    for (k, (reading, truth, _)) in play(&plan, &["vibration", "filter"]).into_iter().enumerate() {
        // Of whole turns nothing is left to round.
        let (sine, cosine) = (TAU * (hz * k as f64 / rate).fract()).sin_cos();
        let x = reading[0] - truth[0];
        (cc, cs, ss) = (cc + cosine * cosine, cs + cosine * sine, ss + sine * sine);
        (xc, xs) = (xc + x * cosine, xs + x * sine);
    }
    let determinant = cc * ss - cs * cs;
    let [a, b] = [(xc * ss - xs * cs) / determinant, (xs * cc - xc * cs) / determinant];
    a.hypot(b)
}
