//! `csv` and `jsonl`: one sample for each line. It ignores names and keys beyond ours, so that lines of other
//! programs read too.

use crate::geometry::Axes;
use crate::sensor::{SensorKind, Shape};
use crate::time::SimTime;
use crate::wire::samples::{self, Carrier, Counts, Sample, Sensed, Source};
use glam::DVec3;
use std::borrow::Cow;

/// None of our lines is longer than a packet; those of other programs may be.
const LONGEST: usize = 1024;

pub(super) struct Reader {
    axes: Axes,
    source: Source,
    parse: for<'l> fn(&'l str) -> Option<Line<'l>>,
    held: Vec<u8>,
    overlong: bool,
}

/// A line of either format: three components, the pressure of a barometer, or something else of which only the time
/// is read, such as a receiver's fix.
#[derive(serde::Deserialize)]
struct Line<'l> {
    t_ns: i64,
    #[serde(borrow)]
    sensor: Cow<'l, str>,
    x: Option<f64>,
    y: Option<f64>,
    z: Option<f64>,
    pa: Option<f64>,
}

impl Line<'_> {
    fn kind(&self) -> Option<SensorKind> {
        SensorKind::from_name(&self.sensor)
    }

    /// Whether it has all values of its sensor.
    fn is_whole(&self) -> bool {
        match self.kind().map(SensorKind::shape) {
            Some(Shape::Pressure) => self.pa.is_some(),
            Some(Shape::Position) => true,
            _ => self.x.is_some() && self.y.is_some() && self.z.is_some(),
        }
    }
}

impl Reader {
    pub(super) fn csv(axes: Axes) -> Reader {
        Reader::new(axes, Source::only("csv"), csv)
    }

    pub(super) fn jsonl(axes: Axes) -> Reader {
        Reader::new(axes, Source::only("jsonl"), |line| {
            serde_json::from_str(line).ok().filter(Line::is_whole)
        })
    }

    fn new(axes: Axes, source: Source, parse: for<'l> fn(&'l str) -> Option<Line<'l>>) -> Reader {
        Reader { axes, source, parse, held: Vec::with_capacity(LONGEST), overlong: false }
    }

    /// Reads the held line.
    fn close(&mut self, counts: &mut Counts, each: &mut dyn FnMut(Sample)) {
        let overlong = std::mem::take(&mut self.overlong);
        let line = std::str::from_utf8(&self.held).ok().filter(|_| !overlong).map(str::trim);
        match line.map(|line| (line, (self.parse)(line))) {
            Some((_, Some(line))) => {
                counts.packets += 1;
                match line.kind() {
                    Some(kind) => each(self.sample(kind, &line)),
                    None => counts.foreign(&line.sensor),
                }
            }
            // The header line, blank lines and comments.
            Some((line, None)) if line.starts_with("t_ns,") => counts.packets += 1,
            Some((line, None)) if line.is_empty() || line.starts_with('#') => {}
            _ => counts.refuse(),
        }
        self.held.clear();
    }

    fn sample(&self, kind: SensorKind, line: &Line<'_>) -> Sample {
        let body = |((x, y), z)| Sensed::Body(self.axes.body_in(DVec3::new(x, y, z)));
        let value = match kind.shape() {
            Shape::Pressure => line.pa.map(Sensed::Pressure),
            Shape::Position => None,
            Shape::Triad => line.x.zip(line.y).zip(line.z).map(body),
        };
        let value = value.and_then(Sensed::known);
        Sample { kind, source: self.source, t: Some(SimTime(line.t_ns)), value, packet: Carrier::default() }
    }
}

impl samples::Reader for Reader {
    fn feed(&mut self, bytes: &[u8], counts: &mut Counts, each: &mut dyn FnMut(Sample)) {
        for piece in bytes.split_inclusive(|&byte| byte == b'\n') {
            let (piece, ends) = piece.strip_suffix(b"\n").map_or((piece, false), |piece| (piece, true));
            self.overlong |= self.held.len() + piece.len() > LONGEST;
            if !self.overlong {
                self.held.extend_from_slice(piece);
            }
            if ends {
                self.close(counts, each);
            }
        }
    }

    fn finish(&mut self, counts: &mut Counts, each: &mut dyn FnMut(Sample)) {
        if !self.overlong && std::str::from_utf8(&self.held).is_ok_and(|line| (self.parse)(line).is_some()) {
            self.close(counts, each);
        }
    }
}

/// `t_ns,sensor,x,y,z`; later columns are ignored. For a barometer only the pressure.
fn csv(line: &str) -> Option<Line<'_>> {
    let mut cells = line.split(',').map(str::trim);
    let t_ns = cells.next()?.parse().ok()?;
    let sensor = Cow::Borrowed(cells.next()?);
    let mut number = || cells.next()?.parse::<f64>().ok();
    let mut line = Line { t_ns, sensor, x: None, y: None, z: None, pa: None };
    if line.kind().map(SensorKind::shape) == Some(Shape::Pressure) {
        line.pa = number();
    } else {
        (line.x, line.y, line.z) = (number(), number(), number());
    }
    Some(line).filter(Line::is_whole)
}

#[cfg(test)]
mod tests {
    use super::*;
    use samples::Reader as _;

    #[test]
    fn a_line_without_an_end_does_not_fill_the_memory() {
        let mut reader = Reader::csv(Axes::NedFrd);
        reader.feed(&[b'7'; 1_000_000], &mut Counts::default(), &mut |_| {});
        assert!(reader.held.capacity() <= 1024, "{}", reader.held.capacity());
    }
}
