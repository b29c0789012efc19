//! `csv` and `jsonl`: a line a sample. Names and keys beyond ours are left alone, so that the lines of other
//! programs read too.

use super::{Counts, Sample, Source};
use crate::geometry::Axes;
use crate::sensor::SensorKind;
use crate::time::SimTime;
use glam::DVec3;
use std::borrow::Cow;

/// No line of ours is longer than a packet; those of others may be.
const LONGEST: usize = 1024;

pub(super) struct Reader {
    axes: Axes,
    source: Source,
    parse: for<'l> fn(&'l str) -> Option<Line<'l>>,
    held: Vec<u8>,
    overlong: bool,
}

/// A line of either kind.
#[derive(serde::Deserialize)]
struct Line<'l> {
    t_ns: i64,
    #[serde(borrow)]
    sensor: Cow<'l, str>,
    x: f64,
    y: f64,
    z: f64,
}

impl Reader {
    pub(super) fn csv(axes: Axes) -> Reader {
        Reader::new(axes, Source::only("csv"), csv)
    }

    pub(super) fn jsonl(axes: Axes) -> Reader {
        Reader::new(axes, Source::only("jsonl"), |line| serde_json::from_str(line).ok())
    }

    fn new(axes: Axes, source: Source, parse: for<'l> fn(&'l str) -> Option<Line<'l>>) -> Reader {
        Reader { axes, source, parse, held: Vec::with_capacity(LONGEST), overlong: false }
    }

    pub(super) fn feed(&mut self, bytes: &[u8], counts: &mut Counts, each: &mut impl FnMut(Sample)) {
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

    pub(super) fn finish(&mut self, counts: &mut Counts, each: &mut impl FnMut(Sample)) {
        if !self.overlong && std::str::from_utf8(&self.held).is_ok_and(|line| (self.parse)(line).is_some()) {
            self.close(counts, each);
        }
    }

    /// Judges the line that is held.
    fn close(&mut self, counts: &mut Counts, each: &mut impl FnMut(Sample)) {
        let overlong = std::mem::take(&mut self.overlong);
        let line = std::str::from_utf8(&self.held).ok().filter(|_| !overlong).map(str::trim);
        match line.map(|line| (line, (self.parse)(line))) {
            Some((_, Some(line))) => {
                counts.packets += 1;
                match SensorKind::ALL.into_iter().find(|kind| kind.name() == line.sensor) {
                    Some(kind) => each(self.sample(kind, &line)),
                    None => counts.foreign(&line.sensor),
                }
            }
            // The line of names, blank lines and remarks.
            Some((line, None)) if line.starts_with("t_ns,") => counts.packets += 1,
            Some((line, None)) if line.is_empty() || line.starts_with('#') => {}
            _ => counts.refuse(),
        }
        self.held.clear();
    }

    /// Bytes held.
    #[cfg(test)]
    pub(super) fn held(&self) -> usize {
        self.held.capacity()
    }

    fn sample(&self, kind: SensorKind, line: &Line<'_>) -> Sample {
        let value = DVec3::new(line.x, line.y, line.z);
        let value = value.is_finite().then(|| self.axes.body_in(value));
        Sample { kind, source: self.source, t: Some(SimTime(line.t_ns)), value }
    }
}

/// `t_ns,sensor,x,y,z`, and columns after those are not read.
fn csv(line: &str) -> Option<Line<'_>> {
    let mut cells = line.split(',').map(str::trim);
    let t_ns = cells.next()?.parse().ok()?;
    let sensor = Cow::Borrowed(cells.next()?);
    let mut number = || cells.next()?.parse::<f64>().ok();
    Some(Line { t_ns, sensor, x: number()?, y: number()?, z: number()? })
}
