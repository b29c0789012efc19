//! What a pty and a serial port have in common: bytes in and out of a raw terminal.

use std::io;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::sync::Arc;

use rustix::fs::{OFlags, fcntl_getfl, fcntl_setfl};
use rustix::io::Errno;
use rustix::termios::{OptionalActions, Termios, tcgetattr, tcsetattr};

use super::receiver::read_when_ready;
use crate::os::{self, Readable};

/// The sending side.
pub(super) struct Out {
    pub(super) terminal: Arc<OwnedFd>,
    /// The other end, where it is ours to look at: the slave of a pty.
    pub(super) far: Option<Arc<OwnedFd>>,
}

impl Out {
    pub(super) fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        rustix::io::write(&self.terminal, bytes).map_err(lost)
    }

    pub(super) fn poll_fd(&self) -> Option<BorrowedFd<'_>> {
        Some(self.terminal.as_fd())
    }

    pub(super) fn queued(&self) -> Option<usize> {
        match &self.far {
            Some(slave) => os::unread(slave).ok(),
            None => os::unsent(&self.terminal).ok(),
        }
    }
}

/// The receiving side.
pub(super) struct In(Readable);

impl In {
    pub(super) fn new(terminal: Arc<OwnedFd>) -> io::Result<Self> {
        Readable::new(terminal).map(Self)
    }

    pub(super) async fn recv(&mut self, buffer: &mut Vec<u8>) -> io::Result<usize> {
        read_when_ready(&self.0, buffer).await
    }
}

/// The error of a terminal that is no longer there has a name that says so.
pub(super) fn lost(errno: Errno) -> io::Error {
    match errno {
        Errno::IO | Errno::NXIO | Errno::NODEV => io::ErrorKind::NotConnected.into(),
        other => other.into(),
    }
}

/// Makes a terminal pass every byte as it is: no echo, no line editing, no translation.
pub(super) fn make_raw(
    terminal: impl AsFd,
    set: impl FnOnce(&mut Termios) -> rustix::io::Result<()>,
) -> rustix::io::Result<()> {
    let mut modes = tcgetattr(&terminal)?;
    modes.make_raw();
    set(&mut modes)?;
    tcsetattr(&terminal, OptionalActions::Now, &modes)
}

/// From here on reads and writes of `file` return at once.
pub(super) fn make_nonblocking(file: impl AsFd) -> rustix::io::Result<()> {
    let flags = fcntl_getfl(&file)?;
    fcntl_setfl(&file, flags | OFlags::NONBLOCK)
}
