//! The way back: what the other side answers.

use std::io;

use bytes::{BufMut, BytesMut};
use tokio::io::{AsyncRead, AsyncReadExt};
use tokio::sync::mpsc;

use super::{listening, serial, tcp, tty, udp};
use crate::os::Readable;

/// The receiving side of a link, for one task.
pub struct Receiver(pub(super) Source);

/// Where the bytes come from, one a kind of link that answers.
pub(super) enum Source {
    Pty(Readable),
    Serial(serial::In),
    Tcp(tcp::In),
    Udp(udp::In),
    /// A file that was written before.
    Recording(listening::Recording),
    Memory(mpsc::UnboundedReceiver<Vec<u8>>),
}

impl Receiver {
    /// Waits for bytes and appends them to `buffer`: how many, or 0 when the other side has left.
    ///
    /// A read may hold several packets, or a part of one; over UDP it is one datagram. On a link
    /// that waits for its peer, this waits for it too. Cancelling it loses nothing.
    pub async fn recv(&mut self, buffer: &mut BytesMut) -> io::Result<usize> {
        match &mut self.0 {
            Source::Pty(master) => read(master, buffer).await,
            Source::Serial(port) => port.recv(buffer).await,
            Source::Tcp(input) => input.recv(buffer).await,
            Source::Udp(input) => input.recv(buffer).await,
            Source::Recording(file) => file.recv(buffer).await,
            Source::Memory(answers) => {
                let bytes = answers.recv().await.unwrap_or_default();
                buffer.extend_from_slice(&bytes);
                Ok(bytes.len())
            }
        }
    }
}

/// The most that one read takes.
const ROOM: usize = 4096;

/// Reads from a stream when it has something; 0 when it has ended or broken.
pub(super) async fn read(stream: &mut (impl AsyncRead + Unpin), buffer: &mut BytesMut) -> io::Result<usize> {
    loop {
        buffer.reserve(ROOM);
        match stream.read_buf(&mut (&mut *buffer).limit(ROOM)).await.map_err(tty::lost) {
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
