//! A file that receives the packets one after another, as a wire would carry them.

use std::fs::File;
use std::io::{self, Write};
use std::os::fd::{AsFd, BorrowedFd};
use std::path::Path;

use super::address::Address;
use super::problem::{self, Problem};
use super::sender::{Carry, Out, Sender};
use super::spelling::Scheme;
use super::{Kind, Link, LinkError};

/// Its line in the table of links.
pub(super) const SCHEME: Scheme = Scheme {
    name: "file",
    spelling: "file:PATH",
    about: "the same bytes to a file, replacing its contents; `listen` reads it",
    parse,
};

fn parse(rest: Option<&str>) -> Result<Address, Problem> {
    let path = problem::path(rest.unwrap_or_default(), "file:/tmp/packets.bin")?;
    Ok(Address::File { path })
}

/// Creates the file, or empties it.
pub(super) fn open(address: &Address, path: &Path) -> Result<Link, LinkError> {
    let file = File::create(path).map_err(|source| LinkError::Io {
        link: address.to_string(),
        doing: format!("write the file {}", path.display()),
        source,
    })?;
    Ok(Link::new(path.display(), Kind::Plain, Sender::new(file, Carry::batch()), None))
}

impl Out for File {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        Write::write(self, bytes)
    }

    fn poll_fd(&self) -> Option<BorrowedFd<'_>> {
        Some(self.as_fd())
    }
}
