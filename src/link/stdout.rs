//! Standard output: the bytes into a pipe, a file or a terminal.
//!
//! Its descriptor may be shared with other processes, so it is left blocking; it is asked first
//! whether it takes bytes, and given no more than a pipe takes without blocking.

use std::fs::File;
use std::io::{self, Write};
use std::os::fd::{AsFd, BorrowedFd};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{FileType, fstat};

use super::address::{Address, Problem};
use super::scheme::Scheme;
use super::sender::{Carry, Sender, To};
use super::{LinkError, receiver};

/// Its line in the table of links.
pub(super) const SCHEME: Scheme = Scheme { name: "-", spelling: "-", about: "standard output", parse };

fn parse(rest: Option<&str>) -> Result<Address, Problem> {
    match rest {
        None => Ok(Address::Stdout),
        Some(_) => Err(Problem::new("standard output takes no path", "say - alone, or file:PATH")),
    }
}

/// What a pipe that takes anything takes without blocking (`PIPE_BUF`).
const PIECE: usize = 4096;

/// Standard output, open.
pub(super) struct Stdout {
    file: Option<File>,
    regular: bool,
}

impl Stdout {
    pub(super) async fn open(address: &Address) -> Result<Self, LinkError> {
        Self::of(io::stdout()).map_err(|source| LinkError::Io {
            link: address.to_string(),
            doing: "write to standard output".to_owned(),
            source,
        })
    }

    pub(super) fn of(output: impl AsFd) -> io::Result<Self> {
        let file = output.as_fd().try_clone_to_owned()?;
        let kind = FileType::from_raw_mode(fstat(&file)?.st_mode);
        Ok(Self { file: Some(file.into()), regular: kind == FileType::RegularFile })
    }

    pub(super) fn name(&self) -> String {
        "-".to_owned()
    }

    pub(super) fn present(&self) -> bool {
        true
    }

    pub(super) async fn peer(&mut self) -> io::Result<()> {
        Ok(())
    }

    pub(super) fn sender(&mut self) -> Sender {
        let carry = match self.regular {
            true => Carry::batch(),
            false => Carry::lively_batch(),
        };
        let file = self.file.take();
        Sender::new(To::Stdout(Out { file, regular: self.regular }), carry)
    }

    pub(super) fn receiver(&mut self) -> Option<receiver::From> {
        None
    }

    /// Nothing to wait for: the sender has written what it held.
    pub(super) async fn close(self) {}
}

/// The sending side.
pub(super) struct Out {
    file: Option<File>,
    regular: bool,
}

impl Out {
    pub(super) fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let Some(file) = &mut self.file else {
            return Err(io::ErrorKind::NotConnected.into());
        };
        if self.regular {
            return file.write(bytes);
        }
        let at_once = Timespec::default();
        let mut asked = [PollFd::new(file, PollFlags::OUT)];
        match poll(&mut asked, Some(&at_once))? {
            0 => Err(io::ErrorKind::WouldBlock.into()),
            _ => file.write(&bytes[..bytes.len().min(PIECE)]),
        }
    }

    pub(super) fn poll_fd(&self) -> Option<BorrowedFd<'_>> {
        self.file.as_ref().map(AsFd::as_fd)
    }

    pub(super) fn queued(&self) -> Option<usize> {
        None
    }
}

#[cfg(test)]
mod tests {
    use std::io::Read;
    use std::sync::atomic::AtomicBool;

    use super::super::Sent;
    use super::*;

    fn pipe() -> (Sender, io::PipeReader) {
        let (reader, writer) = io::pipe().unwrap();
        (Stdout::of(writer).unwrap().sender(), reader)
    }

    #[test]
    fn a_packet_goes_into_a_pipe_at_once() {
        let (mut sender, mut reader) = pipe();
        assert_eq!(sender.send(b"packet"), Sent::Done);
        let mut received = [0; 6];
        reader.read_exact(&mut received).unwrap();
        assert_eq!(&received, b"packet");
    }

    #[test]
    fn a_pipe_that_nobody_reads_is_full_and_never_blocks() {
        let (mut sender, mut reader) = pipe();
        let mut done = 0_u64;
        while sender.send(&[7; 1000]) == Sent::Done {
            done += 1;
        }
        assert_eq!(sender.send(&[7; 1000]), Sent::Full);
        let all = std::thread::spawn(move || {
            let mut all = Vec::new();
            reader.read_to_end(&mut all).unwrap();
            all
        });
        sender.finish().unwrap();
        drop(sender);
        let all = all.join().unwrap();
        assert_eq!(all.len() as u64, done * 1000);
    }

    #[test]
    fn a_pipe_whose_reader_has_left_is_gone() {
        let (mut sender, reader) = pipe();
        drop(reader);
        assert_eq!(sender.send(b"packet"), Sent::Gone(io::ErrorKind::BrokenPipe));
        let stop = AtomicBool::new(false);
        let gone = loop {
            match sender.send_all(b"packet", &stop) {
                Sent::Done => continue,
                gone => break gone,
            }
        };
        assert_eq!(gone, Sent::Gone(io::ErrorKind::BrokenPipe));
        assert!(matches!(sender.send(b"packet"), Sent::Gone(io::ErrorKind::BrokenPipe)));
    }
}
