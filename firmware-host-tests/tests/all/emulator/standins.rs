//! The emulator's targets against stand-ins for their firmwares: in memory, where every byte has an exact time, and
//! over ptys and loopback TCP, opened by path.

mod betaflight;
mod damage;
mod doctor;
mod follow;
mod lies;
mod link;
mod memory;
