//! The board's end of a link.

use std::io::{self, Read};
use std::net::TcpStream;
use std::os::fd::OwnedFd;
use std::path::Path;
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{Mode, OFlags, open};
use rustix::io::Errno;
use rustix::termios::{OptionalActions, isatty, tcgetattr, tcsetattr};

/// What came of waiting for bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arrival {
    /// So many bytes.
    Bytes(usize),
    /// Nothing in time.
    Idle,
    /// Nothing more will come.
    Closed,
}

/// A link as a board sees it.
pub trait Port {
    /// Waits up to `timeout` for bytes.
    ///
    /// # Errors
    /// Those of the link, except that the other side is gone: that is [`Arrival::Closed`].
    fn read(&mut self, bytes: &mut [u8], timeout: Duration) -> io::Result<Arrival>;

    /// Hands over as many bytes as the link takes at once and returns how many, perhaps none.
    ///
    /// # Errors
    /// Those of the link, except that it is full or the other side is gone.
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize>;

    /// Goes on at this speed once what was written has gone out, where the link has one.
    ///
    /// # Errors
    /// Those of setting the terminal.
    fn set_baud(&mut self, _baud: u32) -> io::Result<()> {
        Ok(())
    }
}

/// A serial port, a pty or a file, by its path; or a connection.
#[derive(Debug)]
pub struct Device {
    fd: OwnedFd,
}

impl Device {
    /// Opens it for reading and writing (or only reading, where that is all that is allowed),
    /// without making it the controlling terminal; a terminal is made raw and keeps what waits
    /// in it.
    ///
    /// # Errors
    /// Those of opening and of setting the terminal.
    pub fn open(path: &Path, baud: Option<u32>) -> io::Result<Self> {
        let flags = OFlags::NOCTTY | OFlags::NONBLOCK | OFlags::CLOEXEC;
        let fd = match open(path, flags | OFlags::RDWR, Mode::empty()) {
            Err(Errno::ACCESS | Errno::PERM | Errno::ROFS) => {
                open(path, flags | OFlags::RDONLY, Mode::empty())
            }
            other => other,
        }?;
        if isatty(&fd) {
            let mut settings = tcgetattr(&fd)?;
            settings.make_raw();
            if let Some(baud) = baud {
                settings.set_speed(baud)?;
            }
            tcsetattr(&fd, OptionalActions::Now, &settings)?;
        }
        Ok(Self { fd })
    }
}

impl From<TcpStream> for Device {
    /// A connection; should it refuse not to wait, reading still waits for no longer than it is told to.
    fn from(stream: TcpStream) -> Self {
        let _ = stream.set_nodelay(true).and_then(|()| stream.set_nonblocking(true));
        Self { fd: stream.into() }
    }
}

impl Port for Device {
    fn read(&mut self, bytes: &mut [u8], timeout: Duration) -> io::Result<Arrival> {
        let timeout = Timespec {
            tv_sec: i64::try_from(timeout.as_secs()).unwrap_or(i64::MAX),
            tv_nsec: timeout.subsec_nanos().into(),
        };
        let mut fds = [PollFd::new(&self.fd, PollFlags::IN)];
        match poll(&mut fds, Some(&timeout)) {
            Ok(0) | Err(Errno::INTR) => return Ok(Arrival::Idle),
            Ok(_) => {}
            Err(error) => return Err(error.into()),
        }
        match rustix::io::read(&self.fd, bytes) {
            Ok(0) | Err(Errno::IO | Errno::CONNRESET) => Ok(Arrival::Closed),
            Ok(len) => Ok(Arrival::Bytes(len)),
            Err(Errno::AGAIN | Errno::INTR) => Ok(Arrival::Idle),
            Err(error) => Err(error.into()),
        }
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match rustix::io::write(&self.fd, bytes) {
            Ok(len) => Ok(len),
            Err(Errno::AGAIN | Errno::INTR) => Ok(0),
            // The other side is gone, or the device is read-only: answers go nowhere.
            Err(Errno::IO | Errno::PIPE | Errno::BADF | Errno::CONNRESET) => Ok(bytes.len()),
            Err(error) => Err(error.into()),
        }
    }

    fn set_baud(&mut self, baud: u32) -> io::Result<()> {
        if isatty(&self.fd) {
            let mut settings = tcgetattr(&self.fd)?;
            settings.set_speed(baud)?;
            tcsetattr(&self.fd, OptionalActions::Drain, &settings)?;
        }
        Ok(())
    }
}

/// Any reader as a link; what is written to it is lost.
#[derive(Debug)]
pub struct Source<R>(pub R);

impl<R: Read> Port for Source<R> {
    fn read(&mut self, bytes: &mut [u8], _timeout: Duration) -> io::Result<Arrival> {
        match self.0.read(bytes) {
            Ok(0) => Ok(Arrival::Closed),
            Ok(len) => Ok(Arrival::Bytes(len)),
            Err(error) => match error.kind() {
                io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut | io::ErrorKind::Interrupted => {
                    Ok(Arrival::Idle)
                }
                io::ErrorKind::BrokenPipe | io::ErrorKind::ConnectionReset | io::ErrorKind::UnexpectedEof => {
                    Ok(Arrival::Closed)
                }
                _ => Err(error),
            },
        }
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        Ok(bytes.len())
    }
}
