//! A pseudo terminal: to the program that opens it, a serial port.
//!
//! We own the master and one descriptor of the slave. The latter keeps the pair alive while readers
//! come and go, lets us see how much they have not read, and means that a write never fails: with
//! nobody there it is `Full` once the kernel's buffers (12 to 20 kB) are.

use std::ffi::OsStr;
use std::fs;
use std::io;
use std::os::fd::OwnedFd;
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::pty::{OpenptFlags, grantpt, ioctl_tiocgptpeer, openpt, ptsname, unlockpt};

use super::address::{Address, Problem};
use super::scheme::{self, Scheme};
use super::sender::{Carry, Sender, To};
use super::visitors::Visitors;
use super::{LinkError, receiver, tty};
use crate::os;

/// Its line in the table of links.
pub(super) const SCHEME: Scheme = Scheme {
    name: "pty",
    spelling: "pty[:PATH]",
    about: "a new pseudo terminal, published as a symbolic link at PATH; starts when a reader opens it",
    parse,
};

fn parse(rest: Option<&str>) -> Result<Address, Problem> {
    let path = match rest {
        Some(path) => Some(scheme::path(path, "pty:/tmp/imu, or plain pty")?),
        None => None,
    };
    Ok(Address::Pty { path })
}

/// The rest between two looks at the buffers when closing.
const LOOK: Duration = Duration::from_millis(5);
/// Looks before a reader that does not read is left alone: one second.
const LOOKS: u32 = 200;
/// Looks in a row that must find nothing unread: a reader that has just taken the last visible
/// bytes is about to make the kernel show the next ones.
const EMPTY_LOOKS: u32 = 4;

/// An open pty.
pub(super) struct Pty {
    master: Arc<OwnedFd>,
    slave: Arc<OwnedFd>,
    device: PathBuf,
    published: Option<PathBuf>,
    visitors: Visitors,
    input: Option<tty::In>,
}

impl Pty {
    pub(super) async fn open(address: &Address, path: Option<&Path>) -> Result<Self, LinkError> {
        let link = address.to_string();
        let mut pty = Self::new().map_err(|source| LinkError::Io {
            link: link.clone(),
            doing: "make a pseudo terminal".to_owned(),
            source,
        })?;
        if let Some(path) = path {
            publish(&link, &pty.device, path)?;
            pty.published = Some(path.to_owned());
        }
        Ok(pty)
    }

    fn new() -> io::Result<Self> {
        let flags = OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC;
        let master = openpt(flags)?;
        grantpt(&master)?;
        unlockpt(&master)?;
        tty::make_nonblocking(&master)?;
        let name = ptsname(&master, Vec::new())?;
        let device = PathBuf::from(OsStr::from_bytes(name.as_bytes()));
        let slave = Arc::new(ioctl_tiocgptpeer(&master, flags)?);
        tty::make_raw(&slave, |_| Ok(()))?;
        let master = Arc::new(master);
        Ok(Self {
            visitors: Visitors::watch(&device, Arc::clone(&slave))?,
            input: Some(tty::In::new(Arc::clone(&master))?),
            master,
            slave,
            device,
            published: None,
        })
    }

    pub(super) fn name(&self) -> String {
        super::address::shown(self.path())
    }

    pub(super) fn path(&self) -> &Path {
        self.published.as_deref().unwrap_or(&self.device)
    }

    pub(super) fn present(&self) -> bool {
        self.visitors.present()
    }

    pub(super) async fn peer(&mut self) -> io::Result<()> {
        self.visitors.arrival().await;
        Ok(())
    }

    pub(super) fn sender(&mut self) -> Sender {
        let out = tty::Out { terminal: Arc::clone(&self.master), far: Some(Arc::clone(&self.slave)) };
        Sender::new(To::Tty(out), Carry::packet())
    }

    pub(super) fn receiver(&mut self) -> Option<receiver::From> {
        self.input.take().map(receiver::From::Tty)
    }

    /// Waits, up to a second, until the reader has emptied the buffers; not when there is none.
    pub(super) async fn close(self) {
        let mut empty = 0;
        for _ in 0..LOOKS {
            empty = if self.is_read() { empty + 1 } else { 0 };
            if empty == EMPTY_LOOKS || !self.visitors.present() {
                return;
            }
            tokio::time::sleep(LOOK).await;
        }
    }
}

impl Pty {
    /// Whether nothing is left to read, as far as the kernel shows it.
    ///
    /// `FIONREAD` alone says 0 while bytes wait to be moved to where it counts them, on a loaded
    /// machine for long; `poll` has them moved first.
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

/// Makes `path` a symbolic link to `device`, in the place of one that a killed run left behind.
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

/// Whether `path` links to a pseudo terminal that is gone, or that is now our own.
fn is_stale(path: &Path, device: &Path) -> bool {
    fs::read_link(path)
        .is_ok_and(|target| target == device || target.starts_with("/dev/pts") && !target.exists())
}

#[cfg(test)]
mod tests {
    use super::*;

    async fn open(path: &Path) -> Result<Pty, LinkError> {
        let address = Address::Pty { path: Some(path.to_owned()) };
        Pty::open(&address, Some(path)).await
    }

    #[tokio::test]
    async fn the_symbolic_link_lives_as_long_as_the_pty() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("imu");
        let pty = open(&path).await.unwrap();
        assert_eq!(fs::read_link(&path).unwrap(), pty.device);
        assert_eq!(pty.path(), path);
        pty.close().await;
        assert!(fs::symlink_metadata(&path).is_err());
    }

    #[tokio::test]
    async fn a_link_left_by_a_killed_run_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("imu");
        std::os::unix::fs::symlink("/dev/pts/999999", &path).unwrap();
        let pty = open(&path).await.unwrap();
        assert_eq!(fs::read_link(&path).unwrap(), pty.device);
    }

    #[tokio::test]
    async fn what_is_at_the_path_is_never_overwritten() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("imu");
        fs::write(&path, "precious").unwrap();
        let error = open(&path).await.err().unwrap().to_string();
        assert!(error.contains("already exists") && error.contains("imu"), "{error}");
        assert_eq!(fs::read_to_string(&path).unwrap(), "precious");

        let taken = folder.path().join("taken");
        let first = open(&taken).await.unwrap();
        let error = open(&taken).await.err().unwrap().to_string();
        assert!(error.contains("and links to /dev/pts/"), "{error}");
        drop(first);
        open(&taken).await.unwrap();
    }

    #[tokio::test]
    async fn a_link_that_somebody_has_replaced_is_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("imu");
        let pty = open(&path).await.unwrap();
        fs::remove_file(&path).unwrap();
        std::os::unix::fs::symlink("/dev/null", &path).unwrap();
        drop(pty);
        assert_eq!(fs::read_link(&path).unwrap(), Path::new("/dev/null"));
    }
}
