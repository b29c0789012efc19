//! A file that takes the packets one after the other, as they would go over a wire.

use std::fs::File as Disk;
use std::io::{self, Write};
use std::os::fd::{AsFd, BorrowedFd};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::address::{Address, Problem};
use super::scheme::{self, Scheme};
use super::sender::{Carry, Sender, To};
use super::{LinkError, receiver};

/// Its line in the table of links.
pub(super) const SCHEME: Scheme = Scheme {
    name: "file",
    spelling: "file:PATH",
    about: "the same bytes to a file; what it held is replaced",
    parse,
};

fn parse(rest: Option<&str>) -> Result<Address, Problem> {
    let path = scheme::path(rest.unwrap_or_default(), "file:/tmp/packets.bin")?;
    Ok(Address::File { path })
}

/// A file being written.
pub(super) struct File {
    disk: Arc<Disk>,
    path: PathBuf,
}

impl File {
    pub(super) async fn open(address: &Address, path: &Path) -> Result<Self, LinkError> {
        let disk = Disk::create(path).map_err(|source| LinkError::Io {
            link: address.to_string(),
            doing: format!("write the file {}", path.display()),
            source,
        })?;
        Ok(Self { disk: Arc::new(disk), path: path.to_owned() })
    }

    pub(super) fn name(&self) -> String {
        super::address::shown(&self.path)
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn present(&self) -> bool {
        true
    }

    pub(super) async fn peer(&mut self) -> io::Result<()> {
        Ok(())
    }

    pub(super) fn sender(&mut self) -> Sender {
        let out = Out(Arc::clone(&self.disk));
        Sender::new(To::File(out), Carry::batch())
    }

    pub(super) fn receiver(&mut self) -> Option<receiver::From> {
        None
    }

    /// Nothing to wait for: the sender has written what it held.
    pub(super) async fn close(self) {}
}

/// The sending side.
pub(super) struct Out(Arc<Disk>);

impl Out {
    pub(super) fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.as_ref().write(bytes)
    }

    pub(super) fn poll_fd(&self) -> Option<BorrowedFd<'_>> {
        Some(self.0.as_fd())
    }

    pub(super) fn queued(&self) -> Option<usize> {
        None
    }
}
