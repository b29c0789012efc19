//! Every method against every motion: how accurate, at what cost, and where it fails.
//!
//! [`accuracy`] measures the attitude error of each method at each rate beside the nanoseconds it takes;
//! [`stability`] tries what breaks methods; [`cost`] says what a scene's samples cost; [`normals`] compares ways to make
//! its random numbers; [`allan`] shows its sensors' noise beside theory. With the feature `filters`, `filters` measures
//! attitude filters as the first two do methods, and `parsimony` says what a scene could do without. All give rows for
//! a table; time comes in as an argument.
//!
//! ```
//! use ratetable::{scene::Plan, study::allan};
//!
//! let points = allan::run(&Plan::load("still", &[])?, allan::Effort::QUICK);
//! assert!(!points.is_empty());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod accuracy;
pub mod allan;
pub mod cost;
#[cfg(feature = "filters")]
pub mod filters;
mod inputs;
pub mod motions;
pub mod normals;

#[cfg(feature = "filters")]
pub mod parsimony;
pub mod stability;

pub use crate::parallel::{Progress, all_cores};
