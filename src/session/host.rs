//! The machine of a run.

use crate::report::Host;

/// This machine, without pacing.
pub(super) fn host() -> Host {
    Host::new(std::thread::available_parallelism().map_or(1, |cpus| cpus.get()))
}
