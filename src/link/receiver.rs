//! The way back: what the other side answers.

use std::io;

use rustix::buffer::spare_capacity;

use super::{memory, tcp, tty, udp};
use crate::os::Readable;

/// The receiving side of a link, for one task.
pub struct Receiver(pub(super) From);

/// Where the bytes come from, one a kind of link that answers.
pub(super) enum From {
    Tty(tty::In),
    Tcp(tcp::In),
    Udp(udp::In),
    Memory(memory::In),
}

impl Receiver {
    /// Waits for bytes and appends them to `buffer`: how many, or 0 when the other side has left.
    ///
    /// A read may hold several packets, or a part of one; over UDP it is one datagram. On a link
    /// that waits for its peer, this waits for it too. Cancelling it loses nothing.
    pub async fn recv(&mut self, buffer: &mut Vec<u8>) -> io::Result<usize> {
        match &mut self.0 {
            From::Tty(input) => input.recv(buffer).await,
            From::Tcp(input) => input.recv(buffer).await,
            From::Udp(input) => input.recv(buffer).await,
            From::Memory(input) => input.recv(buffer).await,
        }
    }
}

/// Room made for one read.
const ROOM: usize = 4096;

/// Reads from a stream when it has something; 0 when it has ended or broken.
pub(super) async fn read_when_ready(stream: &Readable, buffer: &mut Vec<u8>) -> io::Result<usize> {
    buffer.reserve(ROOM);
    loop {
        let read = stream.read(|fd| rustix::io::read(fd, spare_capacity(buffer)).map_err(tty::lost));
        match read.await {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) if has_left(error.kind()) => return Ok(0),
            answer => return answer,
        }
    }
}

fn has_left(kind: io::ErrorKind) -> bool {
    use io::ErrorKind::{BrokenPipe, ConnectionAborted, ConnectionReset, NotConnected};
    matches!(kind, BrokenPipe | ConnectionAborted | ConnectionReset | NotConnected)
}
