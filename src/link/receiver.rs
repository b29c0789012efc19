//! The receiving half of a link.

use std::io;

use bytes::BytesMut;
use tokio::sync::mpsc;

use super::stream::read;
use super::{listening, serial, tcp, udp};
use crate::os::Readable;

/// The receiving side of a link, for one task.
pub struct Receiver(Source);

/// The source of the bytes, one variant for each kind of link that receives.
enum Source {
    Pty(Readable),
    Serial(serial::In),
    Tcp(tcp::In),
    Udp(udp::In),
    /// A file written earlier.
    Recording(listening::Recording),
    Memory(mpsc::UnboundedReceiver<Vec<u8>>),
}

impl Receiver {
    /// Whether the bytes were written earlier, and arrive as fast as they are read.
    pub(super) fn is_recording(&self) -> bool {
        matches!(self.0, Source::Recording(_))
    }

    /// Waits for bytes and appends them to `buffer`. Returns how many, or 0 when the other side has left.
    ///
    /// A read may hold several packets, or a part of one; over UDP it is one datagram. On a link that waits for its
    /// peer, this also waits for it. Cancelling it loses nothing.
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

/// Each kind of link converts its receiving side with `into`, so that it does not depend on this table.
macro_rules! from {
    ($($input:ty => $kind:ident),* $(,)?) => {$(
        impl From<$input> for Receiver {
            fn from(input: $input) -> Receiver {
                Receiver(Source::$kind(input))
            }
        }
    )*};
}

from! {
    Readable => Pty,
    serial::In => Serial,
    tcp::In => Tcp,
    udp::In => Udp,
    listening::Recording => Recording,
    mpsc::UnboundedReceiver<Vec<u8>> => Memory,
}
