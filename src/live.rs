//! What a run, a measurement or a stream does, for people who look on: an embedded page and the viewers that they
//! have.

mod about;
mod batch;

pub use about::{About, Column, Shown, Span, columns};
pub use batch::{Batch, Readings, Told};
