//! Where bytes go out and come back: serial ports, pseudo terminals, sockets, files.
//!
//! A link knows nothing of what is in a packet, nor of when it is due. It is opened by its
//! [`Address`] on a tokio runtime, waits for its [`peer`](Link::peer), and gives away its two
//! halves: a [`Sender`] for the pacing thread, which never waits, allocates or locks, and a
//! [`Receiver`] for a task.
//!
//! Every kind of link is one file of the same shape: its line in the table, the address it reads,
//! `open`, `name`, `peer`, `sender`, `receiver`, `close`, then the two halves. [`SCHEMES`] lists
//! them. A link that reaches beyond this machine does so only because an address was given.

mod address;
mod error;
mod file;
mod holders;
mod memory;
mod net;
mod ports;
mod pty;
mod receiver;
mod scheme;
mod sender;
mod serial;
mod stdout;
mod tcp;
#[cfg(test)]
mod tests;
mod tty;
mod udp;
mod visitors;

use std::path::Path;

pub use address::{Address, DEFAULT_BAUD, Place};
pub use error::LinkError;
pub use holders::Holder;
pub use memory::{Far, memory};
pub use ports::{Port, ports};
pub use receiver::Receiver;
pub use scheme::{SCHEMES, Scheme};
pub use sender::{MAX_PACKET, Sender, Sent};

/// An open link.
pub struct Link {
    name: String,
    kind: Kind,
    sender_taken: bool,
    receiver_taken: bool,
}

/// The kinds of link.
enum Kind {
    Pty(pty::Pty),
    Serial(serial::Serial),
    Tcp(tcp::Tcp),
    Udp(udp::Udp),
    File(file::File),
    Stdout(stdout::Stdout),
    Memory(memory::Memory),
}

/// Does the same with every kind of link.
macro_rules! each {
    ($kind:expr, $link:ident => $do:expr) => {
        match $kind {
            Kind::Pty($link) => $do,
            Kind::Serial($link) => $do,
            Kind::Tcp($link) => $do,
            Kind::Udp($link) => $do,
            Kind::File($link) => $do,
            Kind::Stdout($link) => $do,
            Kind::Memory($link) => $do,
        }
    };
}

impl Link {
    /// Opens a link, ready to stream; a port that is missing or busy, or a peer that refuses, is an
    /// error at once.
    ///
    /// # Panics
    /// Outside a tokio runtime with I/O and time enabled.
    pub async fn open(address: &Address) -> Result<Self, LinkError> {
        let kind = match address {
            Address::Pty { path } => Kind::Pty(pty::Pty::open(address, path.as_deref()).await?),
            Address::Serial { path, baud } => {
                let baud = baud.unwrap_or(DEFAULT_BAUD);
                Kind::Serial(serial::Serial::open(address, path, baud).await?)
            }
            Address::TcpIn(place) => Kind::Tcp(tcp::Tcp::listen(address, place).await?),
            Address::TcpOut(place) => Kind::Tcp(tcp::Tcp::connect(address, place).await?),
            Address::UdpIn(place) => Kind::Udp(udp::Udp::listen(address, place).await?),
            Address::UdpOut(place) => Kind::Udp(udp::Udp::aim(address, place).await?),
            Address::File { path } => Kind::File(file::File::open(address, path).await?),
            Address::Stdout => Kind::Stdout(stdout::Stdout::open(address).await?),
        };
        Ok(Self::new(kind))
    }

    fn new(kind: Kind) -> Self {
        Self { name: each!(&kind, link => link.name()), kind, sender_taken: false, receiver_taken: false }
    }

    /// What one connects to: `/dev/pts/4`, the path a pty is published at, `127.0.0.1:4560` with
    /// the port that was picked, the serial port, the file, `-`.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The same as a path, where the link has one.
    pub fn path(&self) -> Option<&Path> {
        match &self.kind {
            Kind::Pty(link) => Some(link.path()),
            Kind::Serial(link) => Some(link.path()),
            Kind::File(link) => Some(link.path()),
            Kind::Tcp(_) | Kind::Udp(_) | Kind::Stdout(_) | Kind::Memory(_) => None,
        }
    }

    /// What the user should know of how the link was opened, a sentence each.
    pub fn notices(&self) -> &[String] {
        match &self.kind {
            Kind::Serial(link) => link.notices(),
            _ => &[],
        }
    }

    /// Waits until somebody is there: on a pty, 100 ms after a reader has opened it; on `tcpin`,
    /// until a peer connects; on `udpin`, until a first datagram, which can still be received.
    /// Others are ready at once.
    ///
    /// It may be given up at any time and called again.
    pub async fn peer(&mut self) -> Result<(), LinkError> {
        each!(&mut self.kind, link => link.peer().await).map_err(|source| LinkError::Io {
            link: self.name.clone(),
            doing: "wait for the other side".to_owned(),
            source,
        })
    }

    /// Whether somebody is there now, as far as the link can know: a pty's reader, or a peer that
    /// has come. Serial ports, files and standard output always have somebody.
    pub fn peer_is_present(&self) -> bool {
        each!(&self.kind, link => link.present())
    }

    /// The sending side, for one thread.
    ///
    /// # Panics
    /// When it was taken before: two senders would mix their packets.
    pub fn sender(&mut self) -> Sender {
        assert!(!self.sender_taken, "a link has one sender");
        self.sender_taken = true;
        each!(&mut self.kind, link => link.sender())
    }

    /// The receiving side; `None` where nothing comes back, or when it was taken before.
    pub fn receiver(&mut self) -> Option<Receiver> {
        if self.receiver_taken {
            return None;
        }
        self.receiver_taken = true;
        each!(&mut self.kind, link => link.receiver()).map(Receiver)
    }

    /// Closes the link after the other side has had up to a second to take what was sent.
    ///
    /// Drop the [`Sender`] (after [`Sender::finish`]) and the [`Receiver`] first. A link that is
    /// dropped instead waits for nothing; a published path is removed either way.
    pub async fn close(self) {
        each!(self.kind, link => link.close().await);
    }
}
