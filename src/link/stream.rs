//! Reading from a stream of bytes whose other side may leave.

use super::tty;
use bytes::{BufMut, BytesMut};
use std::io;
use tokio::io::{AsyncRead, AsyncReadExt};

/// The most that one read returns.
const ROOM: usize = 4096;

/// Reads from a stream when it has data; 0 when it has ended or failed.
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
