//! Shared by a pty and a serial port: bytes into a terminal.

use std::io;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::sync::Arc;

use super::sender::Out;

/// The sending side: a raw terminal, non-blocking.
pub(super) struct Terminal(pub(super) Arc<OwnedFd>);

impl Out for Terminal {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        rustix::io::write(&self.0, bytes).map_err(|errno| lost(errno.into()))
    }

    fn poll_fd(&self) -> Option<BorrowedFd<'_>> {
        Some(self.0.as_fd())
    }
}

/// Gives the error of a terminal that is gone a clear name.
pub(super) fn lost(error: io::Error) -> io::Error {
    match error.raw_os_error() {
        Some(libc::EIO | libc::ENXIO | libc::ENODEV) => io::ErrorKind::NotConnected.into(),
        _ => error,
    }
}
