//! A pseudo terminal: a serial port to the program that opens it.
//!
//! We own the master and one descriptor of the slave. The latter keeps the pair alive while readers come and go,
//! shows how much they have not read, and means that a write never fails: without a reader it is `Full` once the
//! kernel's buffers (12 to 20 kB) are.

use std::ffi::OsStr;
use std::fs;
use std::io;
use std::os::fd::OwnedFd;
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{OFlags, fcntl_getfl, fcntl_setfl};
use rustix::pty::{OpenptFlags, grantpt, ioctl_tiocgptpeer, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};

use super::address::Address;
use super::baud;
use super::problem::Problem;
use super::sender::{Carry, Sender};
use super::spelling::Scheme;
use super::tty::Terminal;
use super::uart::Uart;
use super::visitors::Visitors;
use super::{Kind, Link, LinkError};
use crate::os::{self, Readable};

/// Its line in the table of links.
pub(super) const SCHEME: Scheme = Scheme {
    name: "pty",
    spelling: "pty[:PATH][,BAUD]",
    about: "a new pseudo terminal, published as a symbolic link at PATH; starts when a reader opens it; with BAUD it has the timing of a UART",
    parse,
};

fn parse(rest: Option<&str>) -> Result<Address, Problem> {
    let Some(rest) = rest else { return Ok(Address::Pty { path: None, baud: None }) };
    let (path, baud) = baud::path_and_speed("pty:", rest, "pty:/tmp/imu, plain pty, or pty,115200")?;
    Ok(Address::Pty { path: Some(path), baud })
}

/// `pty,BAUD`: a speed without a path before it.
pub(super) fn parse_speed(digits: &str) -> Result<Address, Problem> {
    let baud = baud::speed("pty", digits)?;
    Ok(Address::Pty { path: None, baud: Some(baud) })
}

/// Time between two looks at the buffers when closing.
const LOOK: Duration = Duration::from_millis(5);
/// Looks before the close gives up on a reader that does not read: one second.
const LOOKS: u32 = 200;
/// Looks in a row that must find nothing unread: when a reader takes the last visible bytes, the kernel may show
/// more.
const EMPTY_LOOKS: u32 = 4;

/// An open pty.
pub(super) struct Pty {
    /// Closing it discards what the reader has not read, so it outlives both halves.
    master: Arc<OwnedFd>,
    slave: Arc<OwnedFd>,
    device: PathBuf,
    published: Option<PathBuf>,
    visitors: Visitors,
    /// The UART that it emulates, if any.
    uart: Option<Uart>,
}

pub(super) fn open(address: &Address, path: Option<&Path>, baud: Option<u32>) -> Result<Link, LinkError> {
    let link = address.to_string();
    let refused = |doing: &str, source| LinkError::Io { link: link.clone(), doing: doing.to_owned(), source };
    let (mut pty, readable) = pair().map_err(|source| refused("make a pseudo terminal", source))?;
    if let Some(path) = path {
        publish(&link, &pty.device, path)?;
        pty.published = Some(path.to_owned());
    }
    let name = path.unwrap_or(&pty.device).display().to_string();
    let mut notices = Vec::new();
    let sender = match baud {
        None => Sender::new(Terminal(Arc::clone(&pty.master)), Carry::packet()),
        Some(baud) => {
            let started = Uart::start(baud, Arc::clone(&pty.master));
            let (uart, sender) = started.map_err(|source| refused("start the thread of a UART", source))?;
            notices.push(uart.notice(&name));
            pty.uart = Some(uart);
            sender
        }
    };
    Ok(Link { notices, ..Link::new(name, Kind::Pty(pty), sender, Some(readable.into())) })
}

/// Opens a pair in raw mode, with the master ready for polling.
fn pair() -> io::Result<(Pty, Readable)> {
    let flags = OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC;
    let master = openpt(flags)?;
    grantpt(&master)?;
    unlockpt(&master)?;
    fcntl_setfl(&master, fcntl_getfl(&master)? | OFlags::NONBLOCK)?;
    let name = ptsname(&master, Vec::new())?;
    let device = PathBuf::from(OsStr::from_bytes(name.as_bytes()));
    let slave = Arc::new(ioctl_tiocgptpeer(&master, flags)?);
    let mut modes = tcgetattr(&slave)?;
    modes.make_raw();
    tcsetattr(&slave, OptionalActions::Now, &modes)?;
    let visitors = Visitors::watch(&device, Arc::clone(&slave))?;
    let master = Arc::new(master);
    let readable = Readable::new(Arc::clone(&master))?;
    Ok((Pty { master, slave, device, published: None, visitors, uart: None }, readable))
}

impl Pty {
    pub(super) fn present(&self) -> bool {
        self.visitors.present()
    }

    pub(super) fn has_left(&self) -> bool {
        self.visitors.came() && !self.visitors.present()
    }

    pub(super) async fn peer(&mut self) {
        self.visitors.arrival().await;
    }

    /// Bytes that the reader has not read: those the kernel shows, at most 4 kB of its buffers, and those that a
    /// UART holds.
    pub(super) fn queued(&self) -> Option<usize> {
        let unread = os::unread(&self.slave).ok()?;
        Some(unread + self.uart.as_ref().map_or(0, Uart::held))
    }

    /// Waits up to a second until the reader has emptied the buffers; does not wait without a reader. A UART first
    /// sends what it holds.
    pub(super) async fn close(self) {
        if let Some(uart) = self.uart.as_ref().filter(|_| self.visitors.present()) {
            uart.close().await;
        }
        let mut empty = 0;
        for _ in 0..LOOKS {
            empty = if self.is_read() { empty + 1 } else { 0 };
            if empty == EMPTY_LOOKS || !self.visitors.present() {
                return;
            }
            tokio::time::sleep(LOOK).await;
        }
    }

    /// Whether nothing is left to read, as far as the kernel shows it.
    ///
    /// `FIONREAD` alone says 0 while bytes still wait to be moved to where it counts them, which takes long on a
    /// loaded machine; `poll` moves them first.
    fn is_read(&self) -> bool {
        let at_once = Timespec::default();
        let mut asked = [PollFd::new(&self.slave, PollFlags::IN)];
        let _ = poll(&mut asked, Some(&at_once));
        os::unread(&self.slave).is_ok_and(|bytes| bytes == 0)
    }
}

impl Drop for Pty {
    fn drop(&mut self) {
        if let Some(path) = &self.published
            && fs::read_link(path).is_ok_and(|target| target == self.device)
        {
            let _ = fs::remove_file(path);
        }
    }
}

/// Makes `path` a symbolic link to `device`, replacing one that a killed run left behind.
fn publish(link: &str, device: &Path, path: &Path) -> Result<(), LinkError> {
    if is_stale(path, device) {
        let _ = fs::remove_file(path);
    }
    std::os::unix::fs::symlink(device, path).map_err(|source| match source.kind() {
        io::ErrorKind::AlreadyExists => LinkError::PathTaken {
            link: link.to_owned(),
            path: path.to_owned(),
            what: match fs::read_link(path) {
                Ok(target) => format!(" and links to {}", target.display()),
                Err(_) => String::new(),
            },
        },
        _ => LinkError::Io {
            link: link.to_owned(),
            doing: format!("make a symbolic link at {}", path.display()),
            source,
        },
    })
}

/// Whether `path` links to a pseudo terminal that is gone, or that is now ours.
fn is_stale(path: &Path, device: &Path) -> bool {
    fs::read_link(path)
        .is_ok_and(|target| target == device || target.starts_with("/dev/pts") && !target.exists())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn open(path: &Path) -> Result<Link, LinkError> {
        let address = Address::Pty { path: Some(path.to_owned()), baud: None };
        super::open(&address, Some(path), None)
    }

    /// The slave that `path` links to.
    fn device(path: &Path) -> bool {
        fs::read_link(path).is_ok_and(|target| target.starts_with("/dev/pts") && target.exists())
    }

    #[tokio::test]
    async fn the_symbolic_link_lives_as_long_as_the_pty() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("imu");
        let pty = open(&path).unwrap();
        assert!(device(&path));
        assert_eq!(Path::new(pty.name()), path);
        pty.close().await;
        assert!(fs::symlink_metadata(&path).is_err());
    }

    #[tokio::test]
    async fn a_link_left_by_a_killed_run_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("imu");
        std::os::unix::fs::symlink("/dev/pts/999999", &path).unwrap();
        let _pty = open(&path).unwrap();
        assert!(device(&path));
    }

    #[tokio::test]
    async fn what_is_at_the_path_is_never_overwritten() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("imu");
        fs::write(&path, "precious").unwrap();
        let error = open(&path).err().unwrap().to_string();
        assert!(error.contains("already exists") && error.contains("imu"), "{error}");
        assert_eq!(fs::read_to_string(&path).unwrap(), "precious");

        let taken = folder.path().join("taken");
        let first = open(&taken).unwrap();
        let error = open(&taken).err().unwrap().to_string();
        assert!(error.contains("and links to /dev/pts/"), "{error}");
        drop(first);
        open(&taken).unwrap();
    }

    #[tokio::test]
    async fn a_link_that_somebody_has_replaced_is_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("imu");
        let pty = open(&path).unwrap();
        fs::remove_file(&path).unwrap();
        std::os::unix::fs::symlink("/dev/null", &path).unwrap();
        drop(pty);
        assert_eq!(fs::read_link(&path).unwrap(), Path::new("/dev/null"));
    }
}
