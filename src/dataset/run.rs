//! One of many runs of a scene.

use crate::scene::SweptValue;
use serde::Serialize;

/// What makes one run differ from the others, as its manifest says it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Run {
    /// From 0.
    pub index: u64,
    /// The values of the keys that the scene sweeps.
    pub swept: Vec<SweptValue>,
}
