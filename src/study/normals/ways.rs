//! The ways that are compared: how to make each, and how far its numbers are from exact ones.

use super::inverse::Inverse;
use super::makers::{Maker, from};
use super::pairs::{self, Full, High, Low, Pairs, Single};
use super::ziggurat::Table;
use crate::random::box_muller::Standard;

/// A way to make them.
pub(super) struct Way {
    /// As in the table.
    pub name: &'static str,
    /// Whether every scene uses it.
    pub is_default: bool,
    /// From a seed.
    pub make: fn(u64) -> Box<dyn Maker>,
    /// The largest difference from the exact transform of the same bits, σ.
    pub error: Option<fn() -> f64>,
}

const fn way(name: &'static str, make: fn(u64) -> Box<dyn Maker>, error: Option<fn() -> f64>) -> Way {
    Way { name, is_default: false, make, error }
}

/// Every way.
pub(super) static WAYS: [Way; 11] = [
    way("ziggurat", |seed| from(seed, Table::new()), None),
    way("inverse-1x64", |seed| from(seed, Inverse::<2, 6>::new()), Some(Inverse::<2, 6>::error)),
    way("inverse-2x16", |seed| from(seed, Inverse::<3, 4>::new()), Some(Inverse::<3, 4>::error)),
    way("inverse-3x8", |seed| from(seed, Inverse::<4, 3>::new()), Some(Inverse::<4, 3>::error)),
    way("inverse-3x32", |seed| from(seed, Inverse::<4, 5>::new()), Some(Inverse::<4, 5>::error)),
    way("inverse-5x16", |seed| from(seed, Inverse::<6, 4>::new()), Some(Inverse::<6, 4>::error)),
    way("box-muller-f32", |seed| from(seed, Single), Some(pairs::error::<Single>)),
    way("box-muller-low", |seed| from(seed, Pairs(Low)), Some(pairs::error::<Pairs<Low>>)),
    Way {
        name: "box-muller",
        is_default: true,
        make: |seed| from(seed, Pairs(Standard)),
        error: Some(pairs::error::<Pairs<Standard>>),
    },
    way("box-muller-high", |seed| from(seed, Pairs(High)), Some(pairs::error::<Pairs<High>>)),
    way("box-muller-full", |seed| from(seed, Pairs(Full)), Some(pairs::error::<Pairs<Full>>)),
];
