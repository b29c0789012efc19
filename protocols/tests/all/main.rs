//! The crate against bytes that it did not make: golden packets, another MAVLink implementation, hostile bytes. One
//! binary: `cargo test -p ratetable-protocols --test all vectors::` runs one module.

mod c_header;
mod common;
mod examples;
mod mavlink_crate;
mod properties;
mod vectors;
