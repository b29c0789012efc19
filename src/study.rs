//! Every method against every motion: how accurate, at what cost, and where it fails.
//!
//! [`accuracy`] measures the attitude error of each method at each rate beside the nanoseconds it takes. It gives
//! rows for a table; time comes in as an argument.

pub mod accuracy;
mod inputs;
pub mod motions;
mod parallel;

pub use parallel::all_cores;
