//! Axes: ranges, ticks and their labels.

use super::series::{drawable, range};

/// A range of values on a line, with its ticks.
#[derive(Clone, Debug)]
pub(super) struct Axis {
    lo: f64,
    hi: f64,
    log: bool,
    pub ticks: Vec<Tick>,
    /// The power of ten that the labels leave out.
    pub power: Option<String>,
}

/// A position on an axis, with a label if there is room for one.
#[derive(Clone, Debug)]
pub(super) struct Tick {
    /// From 0 (start of the axis) to 1.
    pub at: f64,
    pub label: String,
}

/// How to derive an axis from its data.
#[derive(Clone, Copy, Default)]
pub(super) struct Options {
    pub log: bool,
    /// The number of labels that fit.
    pub room: usize,
    /// The fraction of the range left free at both ends.
    pub pad: f64,
    /// The period of an angle: its ticks divide it evenly.
    pub wrap: Option<f64>,
    /// Values at or below this lie on the floor of a logarithmic axis.
    pub floor: Option<f64>,
}

impl Axis {
    pub fn new(values: impl IntoIterator<Item = f64>, options: &Options) -> Self {
        if options.log { Self::log(values, options) } else { Self::linear(range(values), options) }
    }

    /// The same range without marks.
    pub fn without_ticks(self) -> Self {
        Self { ticks: Vec::new(), power: None, ..self }
    }

    fn linear(range: Option<(f64, f64)>, options: &Options) -> Self {
        let (lo, hi) = range.unwrap_or((0.0, 1.0));
        let middle = lo / 2.0 + hi / 2.0;
        let mut half = (hi / 2.0 - lo / 2.0) * (1.0 + 2.0 * options.pad);
        if half <= middle.abs() * 1e-9 {
            half = middle.abs() * 0.1;
        }
        if half < 1e-290 {
            half = 1.0;
        }
        let (lo, hi) = (middle - half, middle + half);
        let step = step(2.0 * half, options.room.max(2), options.wrap);
        let (first, last) = ((lo / step).ceil(), (hi / step).floor());
        let count = if last >= first { (last - first) as usize } else { 0 };
        let values: Vec<f64> = (0..=count.min(100))
            .map(|i| (first + i as f64) * step)
            .filter(|v| (lo..=hi).contains(v))
            .collect();
        let (labels, power) = labels(&values, step);
        let mut axis = Self { lo, hi, log: false, ticks: Vec::new(), power };
        axis.ticks =
            values.into_iter().zip(labels).map(|(v, label)| Tick { at: axis.place(v), label }).collect();
        axis
    }

    fn log(values: impl IntoIterator<Item = f64>, options: &Options) -> Self {
        let lowest = options.floor.filter(|f| drawable(*f)).unwrap_or(0.0).max(0.0);
        let (mut lo, mut hi) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut clamped = false;
        for v in values.into_iter().filter(|&v| drawable(v)) {
            if v > lowest && v >= f64::MIN_POSITIVE {
                (lo, hi) = (lo.min(v.log10()), hi.max(v.log10()));
            } else {
                clamped = true;
            }
        }
        if lo > hi {
            let base = if lowest > 0.0 { lowest.log10() } else { -3.0 };
            (lo, hi) = (base, base + 3.0);
        }
        if hi - lo < 1.0 {
            let middle = (lo + hi) / 2.0;
            (lo, hi) = (middle - 0.5, middle + 0.5);
        }
        let pad = (hi - lo) * options.pad;
        let floor = clamped.then(|| match lowest {
            f if f > 0.0 => f.log10(),
            _ => (lo - pad - 0.3).floor(),
        });
        (lo, hi) = (floor.unwrap_or(lo - pad), hi + pad);
        let mut axis = Self { lo, hi, log: true, ticks: Vec::new(), power: None };
        axis.ticks = axis.decades(options.room.max(2), floor.is_some());
        axis
    }

    /// Ticks at powers of ten, and at 2 and 5 if there are few.
    fn decades(&self, room: usize, floor: bool) -> Vec<Tick> {
        let (first, last) = (self.lo.ceil() as i32, self.hi.floor() as i32);
        let count = (last - first + 1).max(0) as usize;
        let stride = count.div_ceil(room).max(1) as i32;
        let plain = first >= -3 && last <= 4;
        let mut ticks = Vec::new();
        for exponent in first - 1..=last {
            for mantissa in [1.0, 2.0, 5.0] {
                let at = f64::from(exponent) + f64::log10(mantissa);
                let fine = mantissa > 1.0;
                if at < self.lo - 1e-9 || at > self.hi + 1e-9 || (fine && count > 2) {
                    continue;
                }
                let shown = exponent.rem_euclid(stride) == 0;
                let label = match shown {
                    true => power_label(mantissa, exponent, plain),
                    false => String::new(),
                };
                let at = (at - self.lo) / (self.hi - self.lo);
                ticks.push(Tick { at, label });
            }
        }
        if floor {
            let near = 0.7 / room as f64;
            for tick in ticks.iter_mut().filter(|t| t.at < near) {
                tick.label.clear();
            }
            let exponent = self.lo.floor() as i32;
            let mantissa = 10f64.powf(self.lo - self.lo.floor());
            let label = format!("≤ {}", power_label(mantissa, exponent, plain));
            ticks.retain(|t| t.at > 1e-9);
            ticks.insert(0, Tick { at: 0.0, label });
        }
        ticks
    }

    /// The position of a value, from 0 to 1; values below the floor lie on it.
    pub fn place(&self, v: f64) -> f64 {
        let v = match self.log {
            true if v >= f64::MIN_POSITIVE => v.log10(),
            true => self.lo,
            false => v,
        };
        // Halves, so that the full range of numbers does not overflow.
        let span = self.hi / 2.0 - self.lo / 2.0;
        ((v / 2.0 - self.lo / 2.0) / span).clamp(0.0, 1.0)
    }

    /// `count + 1` edges that divide the axis evenly as drawn.
    pub fn edges(&self, count: usize) -> Vec<f64> {
        (0..=count)
            .map(|i| {
                let v = self.lo + (self.hi - self.lo) * i as f64 / count as f64;
                if self.log { 10f64.powf(v) } else { v }
            })
            .collect()
    }
}

/// A round step that gives at most `room` ticks over `span`.
fn step(span: f64, room: usize, wrap: Option<f64>) -> f64 {
    let least = span / room as f64;
    if let Some(wrap) = wrap.filter(|w| w.is_normal() && *w > 0.0) {
        let parts = [24.0, 12.0, 8.0, 4.0, 2.0, 1.0].map(|n| wrap / n);
        if let Some(step) = parts.into_iter().find(|s| *s >= least)
            && least > wrap / 72.0
        {
            return step;
        }
    }
    let decade = 10f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .map(|m| m * decade)
        .into_iter()
        .find(|s| *s >= least * (1.0 - 1e-9))
        .unwrap_or(decade * 10.0)
}

/// Labels of linear ticks, and the power of ten that they leave out.
fn labels(values: &[f64], step: f64) -> (Vec<String>, Option<String>) {
    let largest = values.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    let power = match largest {
        v if v >= 1e5 || (v > 0.0 && v < 1e-2) => 3 * (v.log10() / 3.0).floor() as i32,
        _ => 0,
    };
    // Two factors, because one alone could overflow.
    let scale = |v: f64| v / 10f64.powi(power / 2) / 10f64.powi(power - power / 2);
    let decimals = (-(scale(step) * 1.0001).log10().floor()).clamp(0.0, 12.0) as usize;
    // A step of 45 or 22.5 needs its own decimals.
    let exact = |d: usize| {
        let unit = 10f64.powi(d as i32) * scale(step);
        (unit - unit.round()).abs() < 1e-6
    };
    let decimals = (decimals..12).find(|&d| exact(d)).unwrap_or(decimals);
    let text = |&v: &f64| {
        let text = format!("{:.decimals$}", scale(v));
        match text.strip_prefix('-') {
            Some(rest) if rest.bytes().all(|b| matches!(b, b'0' | b'.')) => rest.to_owned(),
            Some(rest) => format!("−{rest}"),
            None => text,
        }
    };
    let power = (power != 0).then(|| format!("×10{}", superscript(power)));
    (values.iter().map(text).collect(), power)
}

fn power_label(mantissa: f64, exponent: i32, plain: bool) -> String {
    if plain {
        let decimals = (-exponent).max(0) as usize;
        return format!("{:.decimals$}", mantissa * 10f64.powi(exponent));
    }
    let power = format!("10{}", superscript(exponent));
    match (mantissa - 1.0).abs() < 1e-6 {
        true => power,
        false => format!("{:.0}·{power}", mantissa),
    }
}

/// An integer in superscript digits.
pub(super) fn superscript(n: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    n.to_string().chars().map(|c| c.to_digit(10).map_or('⁻', |d| DIGITS[d as usize])).collect()
}
