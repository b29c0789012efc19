//! Standard output: bytes into a pipe, a file or a terminal.
//!
//! Other processes may share its descriptor, so it stays blocking. The link first polls whether it accepts bytes,
//! and writes no more than a pipe takes without blocking.

use std::fs::File;
use std::io::{self, Write};
use std::os::fd::{AsFd, BorrowedFd};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{FileType, fstat};

use super::address::Address;
use super::problem::Problem;
use super::sender::{Carry, Out, Sender};
use super::spelling::Scheme;
use super::{Kind, Link, LinkError};

/// Its line in the table of links.
pub(super) const SCHEME: Scheme =
    Scheme { name: "-", spelling: "-", about: "standard output; for `listen` standard input", parse };

fn parse(rest: Option<&str>) -> Result<Address, Problem> {
    match rest {
        None => Ok(Address::Stdout),
        Some(_) => Err(Problem::new("standard output takes no path", "write - alone, or file:PATH")),
    }
}

/// What a writable pipe takes without blocking (`PIPE_BUF`).
const PIECE: usize = 4096;

pub(super) fn open(address: &Address) -> Result<Link, LinkError> {
    let sender = sender(io::stdout()).map_err(|source| LinkError::Io {
        link: address.to_string(),
        doing: "write to standard output".to_owned(),
        source,
    })?;
    Ok(Link::new("-", Kind::Plain, sender, None))
}

fn sender(output: impl AsFd) -> io::Result<Sender> {
    let file = File::from(output.as_fd().try_clone_to_owned()?);
    Ok(match FileType::from_raw_mode(fstat(&file)?.st_mode) {
        FileType::RegularFile => Sender::new(file, Carry::batch()),
        _ => Sender::new(Pipe(file), Carry::lively_batch()),
    })
}

/// A pipe, or another file that may block.
struct Pipe(File);

impl Out for Pipe {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let at_once = Timespec::default();
        let mut asked = [PollFd::new(&self.0, PollFlags::OUT)];
        match poll(&mut asked, Some(&at_once))? {
            0 => Err(io::ErrorKind::WouldBlock.into()),
            _ => Write::write(&mut self.0, &bytes[..bytes.len().min(PIECE)]),
        }
    }

    fn poll_fd(&self) -> Option<BorrowedFd<'_>> {
        Some(self.0.as_fd())
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
        (sender(writer).unwrap(), reader)
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
