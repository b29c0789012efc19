//! The descriptor of a serial port that may be unplugged and reconnected while packets are sent.
//!
//! Everybody writes to one descriptor for the life of the link. What it refers to changes: a port that is gone is
//! released at once (while it is held, the system gives the returning device another name), and the same path,
//! reopened, takes its place. The pacing thread sees a flag and never waits.

use std::io;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use rustix::fs::{Mode, OFlags};
use rustix::io::Errno;
use rustix::termios::tcgetattr;

use super::sender::Out;
use super::tty::lost;
use crate::os;

/// A descriptor of a port that comes and goes.
pub(super) struct Plug {
    port: OwnedFd,
    out: AtomicBool,
    baud: AtomicU32,
}

impl Plug {
    /// Of a port that is there, at this speed.
    pub(super) fn new(port: OwnedFd, baud: u32) -> Self {
        Self { port, out: AtomicBool::new(false), baud: AtomicU32::new(baud) }
    }

    /// The speed at which the port is, or is to be when it is back.
    pub(super) fn baud(&self) -> u32 {
        self.baud.load(Ordering::Relaxed)
    }

    /// Notes another speed.
    pub(super) fn note_baud(&self, baud: u32) {
        self.baud.store(baud, Ordering::Relaxed);
    }

    /// Whether the port is away.
    pub(super) fn is_out(&self) -> bool {
        self.out.load(Ordering::Acquire)
    }

    /// Asks the port itself: a terminal that is gone no longer answers.
    pub(super) fn has_gone(&self) -> bool {
        self.is_out()
            || matches!(
                tcgetattr(&self.port),
                Err(Errno::IO | Errno::NXIO | Errno::NODEV | Errno::NOTTY | Errno::BADF)
            )
    }

    /// Releases a port that is gone.
    pub(super) fn pull(&self) {
        self.out.store(true, Ordering::Release);
        // A stand-in that rejects writes as the lost port does.
        let flags = OFlags::RDONLY | OFlags::CLOEXEC;
        if let Ok(nothing) = rustix::fs::open("/dev/null", flags, Mode::empty()) {
            let _ = os::redirect(&self.port, &nothing);
        }
    }

    /// Puts `port` in its place.
    pub(super) fn put_in(&self, port: &OwnedFd) -> io::Result<()> {
        os::redirect(&self.port, port)?;
        self.out.store(false, Ordering::Release);
        Ok(())
    }
}

impl AsFd for Plug {
    fn as_fd(&self) -> BorrowedFd<'_> {
        self.port.as_fd()
    }
}

/// The sending side of such a port.
pub(super) struct Plugged(pub(super) Arc<Plug>);

impl Out for Plugged {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let away = io::ErrorKind::NotConnected;
        if self.0.is_out() {
            return Err(away.into());
        }
        let error = match rustix::io::write(&self.0.port, bytes) {
            Ok(count) => return Ok(count),
            Err(errno) => lost(errno.into()),
        };
        if error.kind() == away {
            self.0.out.store(true, Ordering::Release);
        }
        // Another thread may have released it between the two looks.
        Err(if self.0.is_out() { away.into() } else { error })
    }

    fn poll_fd(&self) -> Option<BorrowedFd<'_>> {
        (!self.0.is_out()).then(|| self.0.as_fd())
    }

    fn comes_back(&self) -> bool {
        true
    }
}
