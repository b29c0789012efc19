//! The firmware in this package: its estimators, its board, and the whole of it behind the emulator. One binary, so
//! that the library is linked once: `cargo test -p ratetable-firmware-host-tests --test all board::` runs one module.

mod ahrs;
mod board;
mod common;
mod drivers;
mod emulator;
