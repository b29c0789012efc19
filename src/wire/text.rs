//! `csv` and `jsonl`: one line a reading, for eyes, plotters and quick scripts.

use super::{Encoder, Now, Packet, Setup};
use crate::geometry::Axes;
use crate::sensor::Reading;
use crate::time::SimTime;
use std::io::Write;

/// Lines in the scene's own axes, SI units and µT.
pub(super) struct Text {
    axes: Axes,
    json: bool,
    header: Option<&'static str>,
    line: Vec<u8>,
}

impl Text {
    /// `t_ns,sensor,x,y,z`, named in a first line.
    pub(super) fn csv(setup: &Setup<'_>) -> Text {
        Text {
            axes: setup.axes,
            json: false,
            header: Some("t_ns,sensor,x,y,z\n"),
            line: Vec::with_capacity(256),
        }
    }

    /// One JSON object a line.
    pub(super) fn jsonl(setup: &Setup<'_>) -> Text {
        Text { axes: setup.axes, json: true, header: None, line: Vec::with_capacity(256) }
    }

    fn write(&mut self, t: SimTime, reading: &Reading) {
        let v = self.axes.body_out(reading.value);
        let (mut x, mut y, mut z) = (ryu::Buffer::new(), ryu::Buffer::new(), ryu::Buffer::new());
        let (x, y, z) = (x.format(v.x), y.format(v.y), z.format(v.z));
        let (t, name) = (t.0, reading.kind.name());
        self.line.clear();
        // Writing to a vector cannot fail.
        let _ = match self.json {
            false => writeln!(self.line, "{t},{name},{x},{y},{z}"),
            true => writeln!(self.line, r#"{{"t_ns":{t},"sensor":"{name}","x":{x},"y":{y},"z":{z}}}"#),
        };
    }
}

impl Encoder for Text {
    fn encode(&mut self, now: &Now<'_>, out: &mut Vec<Packet>) {
        let Now { t, readings, .. } = *now;
        if let Some(header) = self.header.take() {
            out.push(Packet::new(t, 0, header.as_bytes()));
        }
        for reading in readings {
            self.write(t, reading);
            out.push(Packet::new(t, 1 << reading.kind as u8, &self.line));
        }
    }
}
