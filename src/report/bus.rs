//! How a driver reads chips on a bus.

use super::Spread;
use serde::Serialize;

/// How a driver read a sensor, in the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ReadReport {
    /// Samples read a second, from the first read to the last.
    pub hz: Option<f64>,
    /// Samples read, each counted once.
    pub samples: u64,
    /// Reads of a sample that was read before, or that the FIFO holds as well.
    pub again: u64,
    /// Samples that a newer one replaced before anybody read them.
    pub missed: u64,
    /// Samples that the chip's FIFO lost.
    pub overflowed: u64,
}

/// What a driver asked of a bus, in the scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct BusReport {
    /// The chips and their addresses: `MPU-9250 at 0x68 (gyro, accel, mag)`.
    pub chips: Vec<String>,
    /// Transfers, each a register read or written.
    pub transfers: u64,
    /// The same a second of scene time.
    pub transfers_per_s: Option<f64>,
    /// Transfers that nobody acknowledged.
    pub refused: u64,
    /// Bytes that begin no command, and commands cut short, in the whole run.
    pub strange: u64,
    /// From the read of a question's last bytes to the end of the write that answers it, µs.
    pub answer_us: Option<Spread>,
}

impl BusReport {
    /// A report with every possible field, to check limits against.
    pub(super) fn shape() -> BusReport {
        BusReport { transfers_per_s: Some(0.0), answer_us: Some(Spread::default()), ..BusReport::default() }
    }
}
