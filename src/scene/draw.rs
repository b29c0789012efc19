//! Values drawn once a run: `noise_std = { uniform = ["0.001 rad/s", "0.003 rad/s"] }`.

use super::declared::nav_in;
use super::document::{Node, Table, Value};
use super::drawn::Drawn;
use super::section::Section;
use crate::geometry::Vector;
use crate::keys::{self, Key, Takes};
use crate::quantity::{self, Kind, Sign};
use crate::random;
use crate::sensor::{self, SensorPlan};
use glam::{DMat3, DVec3};
use rand::RngExt;

/// The first text in a value: a quantity as it is written, or the first end of a distribution.
fn first_text(value: &Value) -> Option<&str> {
    match value {
        Value::Text(text) => Some(text),
        Value::Array(nodes) => nodes.iter().find_map(|node| first_text(&node.value)),
        Value::Table(table) => table.entries.iter().find_map(|entry| first_text(&entry.node.value)),
        _ => None,
    }
}

impl Section<'_> {
    /// A value drawn once a run: `{ uniform = [low, high] }` or `{ normal = [mean, std] }`, each axis by itself.
    pub(super) fn draw(&self, key: &Key, table: &Table) -> Option<keys::Value> {
        let (kind, scalar) = match key.takes() {
            Takes::Scalar(kind) | Takes::OneAxis(kind) => (kind, true),
            Takes::PerAxis(kind) | Takes::BodyVector(kind) | Takes::NavVector(kind) | Takes::Matrix(kind) => {
                (kind, false)
            }
            _ => {
                self.mistake(key.name, "cannot be drawn from a distribution");
                return None;
            }
        };
        let (shape, low, high) = self.distribution(key.name, kind, table)?;
        let fresh = shape.fresh(self.reader.seed.get(), &format!("draw/{}/{}", self.path, key.name));
        let mut drawn = [0.0; 3];
        for axis in if scalar { 0..1 } else { 0..3 } {
            let value = shape.value(low[axis], high[axis], fresh[axis]);
            // The size of a noise has no sign; the tail of a normal distribution is folded over.
            drawn[axis] = if kind.is_magnitude() { value.abs() } else { value };
        }
        let unit = kind.units()[0];
        let text =
            if scalar { quantity::text_scalar(drawn[0], unit) } else { quantity::text_vector(drawn, unit) };
        let written = table.entries.iter().find_map(|entry| first_text(&entry.node.value));
        let values = if scalar { &drawn[..1] } else { &drawn[..] };
        let path = format!("{}.{}", self.path, key.name);
        self.reader.draws.borrow_mut().push(Drawn::new(path, text.clone(), values, kind, written));
        self.resolve(key.name, text);
        let sign = self.reader.axes.get().body_sign();
        Some(match key.takes() {
            Takes::Scalar(_) => keys::Value::Scalar(drawn[0].into()),
            Takes::PerAxis(_) | Takes::OneAxis(_) => keys::Value::Triple(drawn.map(Into::into)),
            Takes::NavVector(_) => keys::Value::Triple(nav_in(self.axes(), kind, drawn.map(Into::into))),
            Takes::Matrix(_) => keys::Value::Matrix(DMat3::from_diagonal(DVec3::from_array(drawn))),
            _ => keys::Value::Triple([drawn[0], drawn[1] * sign, drawn[2] * sign].map(Into::into)),
        })
    }

    /// A turn-on bias with a spread is drawn here, once a run, so that the scene as resolved says what it is.
    pub(super) fn settle_bias(&self, plan: &mut SensorPlan) {
        let context = plan.context(self.seed());
        let Some(bias) = sensor::settle_bias(&mut plan.values, &context) else { return };
        let unit = plan.kind.unit();
        let values = match plan.kind.shape() {
            sensor::Shape::Pressure => vec![bias.x],
            sensor::Shape::Position => self.axes().nav_out(Vector::from_vec(bias)).to_array().to_vec(),
            sensor::Shape::Triad => self.axes().body_out(Vector::from_vec(bias)).to_array().to_vec(),
        };
        let text = match values[..] {
            [x, y, z] => quantity::text_vector([x, y, z], unit),
            _ => quantity::text_scalar(bias.x, unit),
        };
        let written =
            ["bias_std", "bias"].into_iter().find_map(|key| first_text(&self.entry(key)?.node.value));
        let (path, kind) = (format!("{}.bias", self.path), plan.kind.units().reading);
        self.reader.draws.borrow_mut().push(Drawn::new(path, text.clone(), &values, kind, written));
        self.resolve("bias", text);
        self.resolve("bias_std", format!("0 {}", plan.kind.unit()));
    }

    fn distribution(
        &self,
        key: &'static str,
        kind: Kind,
        table: &Table,
    ) -> Option<(Shape, [f64; 3], [f64; 3])> {
        let (shape, entry) = match &table.entries[..] {
            [entry] if entry.key == "uniform" => (Shape::Uniform, entry),
            [entry] if entry.key == "normal" => (Shape::Normal, entry),
            _ => {
                self.mistake(key, format!("a drawn value is {{ uniform = [low, high] }} or {{ normal = [mean, std] }}, such as {{ uniform = [\"1 {0}\", \"2 {0}\"] }}", kind.units()[0]));
                return None;
            }
        };
        let Value::Array(nodes) = &entry.node.value else {
            self.note(&entry.node.place, format!("`{key}`: `{}` takes an array of two strings", entry.key));
            return None;
        };
        let [low, high] = &nodes[..] else {
            self.note(
                &entry.node.place,
                format!("`{key}`: `{}` takes two values, not {}", entry.key, nodes.len()),
            );
            return None;
        };
        let end = |node: &Node, kind: Kind| {
            let text = self.spelled(key, node, kind.example())?;
            match kind.vector(&text) {
                Ok(value) => Some(value.map(|x| x.to_f64())),
                Err(error) => {
                    self.note(&node.place_in_text(error.offset()), format!("`{key}`: {error}"));
                    None
                }
            }
        };
        let second = if shape == Shape::Normal { kind.signed(Sign::NonNegative) } else { kind };
        let (first, second) = (end(low, kind), end(high, second));
        let (first, second) = (first?, second?);
        if shape == Shape::Uniform && (0..3).any(|axis| first[axis] > second[axis]) {
            self.note(&entry.node.place, format!("`{key}`: `uniform` takes the lower end first"));
            return None;
        }
        Some((shape, first, second))
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Shape {
    Uniform,
    Normal,
}

impl Shape {
    /// A number an axis from the distribution's standard form, of the streams of this name.
    fn fresh(self, seed: u64, name: &str) -> [f64; 3] {
        match self {
            Shape::Uniform => random::axes(seed, name).map(|mut stream| stream.random::<f64>()),
            Shape::Normal => random::normals(seed, name, [true; 3]).draw(),
        }
    }

    /// What that means between two ends, or about a mean and with a standard deviation.
    fn value(self, a: f64, b: f64, fresh: f64) -> f64 {
        match self {
            Shape::Uniform => a + (b - a) * fresh,
            Shape::Normal => a + b * fresh,
        }
    }
}
