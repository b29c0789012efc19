//! A link opened to receive; it sends nothing except an optional greeting.

use super::address::Address;
use super::{Kind, Link, LinkError};
use crate::os::Readable;
use bytes::BytesMut;
use rustix::fs::{FileType, Mode, OFlags, fcntl_getfl, fcntl_setfl, fstat, open};
use std::fs::File;
use std::io::{self, Read};
use std::os::fd::{AsFd, OwnedFd};
use std::path::Path;
use std::sync::Arc;

impl Link {
    /// Opens a link for its [`receiver`](Link::receiver), like [`open`](Link::open), with two differences:
    /// `file:PATH` is read, a recording to its end and a pipe or device as data arrives, and `-` is standard input.
    ///
    /// # Errors
    /// The errors of [`open`](Link::open), and a file that is not readable.
    ///
    /// # Panics
    /// Outside a tokio runtime with I/O and time enabled.
    pub async fn listen(address: &Address) -> Result<Link, LinkError> {
        let refused =
            |doing: String| move |source| LinkError::Io { link: address.to_string(), doing, source };
        match address {
            Address::File { path } => {
                let doing = format!("read {}", path.display());
                from_path(path).map_err(refused(doing))
            }
            Address::Stdout => {
                let input = io::stdin().as_fd().try_clone_to_owned();
                input.and_then(|input| of("-", input)).map_err(refused("read standard input".into()))
            }
            Address::Serial { path, .. } if is_plain_file(path) => {
                let path = path.display().to_string();
                Err(LinkError::Spelling {
                    spelled: address.to_string(),
                    problem: "that is a file, not a port".into(),
                    right: format!("to read a recording write file:{path}"),
                })
            }
            other => Link::open(other).await,
        }
    }

    /// Whether bytes arrive when they are sent, not from a recording.
    pub fn is_live(&self) -> bool {
        !self.receiver.as_ref().is_some_and(|receiver| receiver.is_recording())
    }
}

/// Whether a path names a pseudo terminal, where a baud rate has no meaning.
pub fn is_pty(path: &Path) -> bool {
    std::fs::canonicalize(path).is_ok_and(|device| device.starts_with("/dev/pts"))
}

fn is_plain_file(path: &Path) -> bool {
    std::fs::metadata(path).is_ok_and(|found| found.is_file())
}

fn from_path(path: &Path) -> io::Result<Link> {
    let flags = OFlags::RDONLY | OFlags::NOCTTY | OFlags::NONBLOCK | OFlags::CLOEXEC;
    of(&path.display().to_string(), open(path, flags, Mode::empty())?)
}

/// A link that only receives what `input` holds.
fn of(name: &str, input: OwnedFd) -> io::Result<Link> {
    let receiver = match FileType::from_raw_mode(fstat(&input)?.st_mode) {
        FileType::RegularFile => Recording(File::from(input)).into(),
        FileType::Directory => return Err(io::ErrorKind::IsADirectory.into()),
        _ => {
            fcntl_setfl(&input, fcntl_getfl(&input)? | OFlags::NONBLOCK)?;
            let input = Arc::new(input);
            match Readable::new(input.clone()) {
                Ok(input) => input.into(),
                // A file that does not support polling, like /dev/null, is always ready.
                Err(error) if error.kind() == io::ErrorKind::PermissionDenied => {
                    Recording(File::from(input.try_clone()?)).into()
                }
                Err(error) => return Err(error),
            }
        }
    };
    let receiver = Some(receiver);
    Ok(Link { name: name.to_string(), notices: Vec::new(), kind: Kind::Plain, sender: None, receiver })
}

/// A file read to its end.
pub(super) struct Recording(File);

impl Recording {
    /// The next piece. A disk is always ready; this lets other tasks run.
    pub(super) async fn recv(&mut self, buffer: &mut BytesMut) -> io::Result<usize> {
        tokio::task::yield_now().await;
        let mut piece = [0; 16_384];
        let count = self.0.read(&mut piece)?;
        buffer.extend_from_slice(&piece[..count]);
        Ok(count)
    }
}
