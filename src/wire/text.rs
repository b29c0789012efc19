//! `csv` and `jsonl`: one line for each reading, for people, plotters and quick scripts.

mod reader;

use super::row::{Row, any};
use super::samples::{self, Assumed};
use super::{Encoder, Now, Packet, Setup};
use crate::geometry::Axes;
use crate::sensor::{Fix, Kinds, Measured, Measurement, Position, Reading, SensorKind};
use crate::time::SimTime;
use std::io::Write;

pub(super) static CSV: Row = lines(
    "csv",
    "t_ns,sensor,x,y,z: one line a reading, in the scene's axes (baro, airspeed: Pa; gps: degrees, altitude, velocity)",
    |setup| Box::new(Text::csv(setup)),
    |assumed| Box::new(reader::Reader::csv(assumed.axes)),
);

pub(super) static JSONL: Row = lines(
    "jsonl",
    "the same as one JSON object a line",
    |setup| Box::new(Text::jsonl(setup)),
    |assumed| Box::new(reader::Reader::jsonl(assumed.axes)),
);

/// A line-based protocol.
const fn lines(
    name: &'static str,
    about: &'static str,
    encoder: fn(&Setup<'_>) -> Box<dyn Encoder>,
    reader: fn(&Assumed) -> Box<dyn samples::Reader>,
) -> Row {
    Row {
        name,
        about,
        carries: Kinds::ALL,
        encoder,
        reader,
        dialogue: |_| None,
        shared: |_, _| None,
        keys: &[],
        check: any,
        greeting: |_| b"\n".to_vec(),
        is_numbered: false,
        inside: |len| (0..len.saturating_sub(1), Some(b'\n')),
    }
}

/// Lines in the scene's own axes, SI units and µT.
pub(super) struct Text {
    axes: Axes,
    json: bool,
    header: Option<&'static str>,
    line: Vec<u8>,
}

impl Text {
    /// `t_ns,sensor,x,y,z`, named in a first line. For a barometer x is the pressure and the others are empty. For
    /// a GPS receiver they are latitude and longitude in degrees and altitude, followed by its velocity.
    pub(super) fn csv(setup: &Setup<'_>) -> Text {
        Text {
            axes: setup.axes,
            json: false,
            header: Some(match setup.sensors.iter().any(|sensor| sensor.kind == SensorKind::Gps) {
                true => "t_ns,sensor,x,y,z,vn,ve,vd\n",
                false => "t_ns,sensor,x,y,z\n",
            }),
            line: Vec::with_capacity(256),
        }
    }

    /// One JSON object on each line.
    pub(super) fn jsonl(setup: &Setup<'_>) -> Text {
        Text { axes: setup.axes, json: true, header: None, line: Vec::with_capacity(256) }
    }

    fn write(&mut self, t: SimTime, reading: &Reading) {
        match &reading.measurement {
            Measurement::Triad(Measured { value, .. }) => {
                let v = self.axes.body_out(*value);
                self.cells(t, reading.kind, &[("x", v.x), ("y", v.y), ("z", v.z)]);
            }
            Measurement::Pressure(Measured { value, .. }) => self.cells(t, reading.kind, &[("pa", *value)]),
            Measurement::Position(Position { fix: Fix { position, velocity }, .. }) => {
                let [vn, ve, vd] = velocity.v.to_array();
                let (lat, lon) = (position.latitude.to_degrees(), position.longitude.to_degrees());
                let place = [("lat", lat), ("lon", lon), ("alt", position.altitude)];
                let cells = [place, [("vn", vn), ("ve", ve), ("vd", vd)]].concat();
                self.cells(t, reading.kind, &cells);
            }
        }
    }

    /// A line of these numbers with their JSON names; a CSV line has at least three.
    fn cells(&mut self, t: SimTime, kind: SensorKind, cells: &[(&str, f64)]) {
        let (t, name, line) = (t.0, kind.name(), &mut self.line);
        line.clear();
        // Writing to a vector cannot fail.
        let _ = match self.json {
            false => write!(line, "{t},{name}"),
            true => write!(line, r#"{{"t_ns":{t},"sensor":"{name}""#),
        };
        let mut digits = ryu::Buffer::new();
        for (key, value) in cells {
            let number = digits.format(*value);
            let _ = match self.json {
                false => write!(line, ",{number}"),
                true => write!(line, r#","{key}":{number}"#),
            };
        }
        if self.json {
            line.push(b'}');
        } else {
            line.resize(line.len() + 3usize.saturating_sub(cells.len()), b',');
        }
        line.push(b'\n');
    }
}

impl Encoder for Text {
    fn encode(&mut self, now: &Now<'_>, out: &mut Vec<Packet>) {
        let Now { t, readings, .. } = *now;
        if let Some(header) = self.header.take() {
            out.push(Packet::new(t, Kinds::NONE, header.as_bytes()));
        }
        for reading in readings {
            self.write(t, reading);
            out.push(Packet::new(t, reading.kind.into(), &self.line));
        }
    }
}
