//! The emulator against the firmware in this package, over a real pty (or a socket) between them.
//!
//! The emulator plays a scene as `ratetable run` does; the other side opens the pty by its path, as firmware opens
//! its UART, and knows nothing else of it. Except where a test is about real time, the scene goes as fast as the
//! other side reads: nothing is paced and nothing dropped, so no result depends on how busy the machine is.

mod accuracy;
mod c_firmware;
mod mavlink_stream;
mod mishaps;
mod mpu_stream;
mod paced;
mod play;
mod program;
mod pymavlink;
mod scenes;
mod standins;
mod wrong_drivers;
