//! Attitudes, and arrays of them with their times: `keys = [{ t = "2 s", attitude = "[0, 30, 0] deg" }]`.

use super::document::Value;
use super::section::Section;
use crate::double::Double;
use crate::geometry::{Attitude, Euler};
use crate::quantity::{Kind, Sign};
use crate::time::SimTime;
use glam::DQuat;

impl Section<'_> {
    /// The keys `attitude` (three angles) or `quaternion`, in the program's own axes.
    pub(super) fn attitude(&self, default: Option<&str>) -> Option<Attitude> {
        let q = if self.has("quaternion") {
            if self.has("attitude") {
                self.mistake("quaternion", "`attitude` is also given: keep only one");
            }
            self.quaternion("quaternion").map(|[w, x, y, z]| DQuat::from_xyzw(x, y, z, w))
        } else {
            // Half angles to full precision: a decimal in degrees is not its nearest double in radians.
            self.vector("attitude", Kind::ANGLE, default).map(|angles| {
                Euler::quat_of_half_angles(angles.map(|angle| (angle / Double::from(2.0)).sin_cos()))
            })
        };
        q.map(|q| self.axes().attitude_in(q))
    }

    /// An array of tables, each a time `t` and an attitude.
    pub(super) fn keyframes(&self, key: &'static str) -> Option<Vec<(SimTime, Attitude)>> {
        let example = "{ t = \"2 s\", attitude = \"[0, 30, 0] deg\" }";
        let node = &self.entry(key)?.node;
        let Value::Array(nodes) = &node.value else {
            self.mistake(key, format!("is {}; write an array, [{example}]", node.value.what()));
            return None;
        };
        let (mut frames, mut resolved) = (Vec::new(), Vec::new());
        for (i, node) in nodes.iter().enumerate() {
            let Value::Table(table) = &node.value else {
                let is = node.value.what();
                self.note(&node.place, format!("`{key}` holds {is}: write each as {example}"));
                continue;
            };
            let frame = Section::new(self.reader, format!("{}.{key}.{i}", self.path), table.clone());
            frame.call(format!("an entry of `{key}`"));
            if !frame.has("t") || !(frame.has("attitude") || frame.has("quaternion")) {
                frame.lacks(format!("an entry of `{key}` needs a time and an attitude: {example}"));
            }
            let (t, attitude) = (frame.time("t", None, Sign::NonNegative), frame.attitude(None));
            frames.extend(t.zip(attitude));
            resolved.push(toml::Value::from(frame.finish()));
        }
        self.resolve(key, resolved);
        (frames.len() == nodes.len()).then_some(frames)
    }
}
