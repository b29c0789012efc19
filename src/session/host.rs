//! What a run is on.

use crate::report::Host;

/// This machine; nothing was paced on it.
pub(super) fn host() -> Host {
    Host::new(std::thread::available_parallelism().map_or(1, |cpus| cpus.get()))
}
