//! Where bytes go out and come back: serial ports, pseudo terminals, sockets, files.
//!
//! A link does not know what is in a packet or when it is due. It opens at an [`Address`], on a tokio runtime. It
//! waits for its [`peer`](Link::peer) and gives away two halves: a [`Sender`] for the pacing thread, which never
//! waits, allocates or locks, and a [`Receiver`] for a task.
//!
//! Every kind of link is one file of the same shape: its line in the table, its address, how it opens, whom it
//! waits for at the start and at the end, then its two halves. [`SCHEMES`] lists them. A link reaches beyond this
//! machine only if the user gives an address.
//!
//! ```
//! use ratetable::link::Address;
//!
//! let address: Address = "/dev/ttyACM0,115200".parse()?;
//! assert_eq!(address.baud(), Some(115_200));
//! assert!("ttyACM0".parse::<Address>().is_err(), "the message says: did you mean /dev/ttyACM0?");
//! # Ok::<(), ratetable::link::LinkError>(())
//! ```

mod address;
mod baud;
mod endpoint;
mod error;
mod file;
mod holders;
mod identity;
mod listening;
mod memory;
mod net;
mod plug;
#[cfg(test)]
mod plug_tests;
mod ports;
mod problem;
mod pty;
mod receiver;
mod scheme;
mod sender;
mod serial;
mod spelling;
mod stdout;
mod stream;
mod tcp;
#[cfg(test)]
mod tests;
mod tty;
mod uart;
mod udp;
mod visitors;

use std::fmt::Display;
use std::io;

pub use address::Address;
pub use baud::{DEFAULT_BAUD, STANDARD_BAUDS, bytes_per_second};
pub use endpoint::Endpoint;
pub use error::LinkError;
pub use holders::Holder;
pub use identity::Identity;
pub use listening::is_pty;
pub use memory::{Far, memory};
pub use ports::{Port, ports};
pub use receiver::Receiver;
pub use scheme::SCHEMES;
pub use sender::{MAX_WRITE, Sender, Sent};
pub use serial::Baud;
pub use spelling::Scheme;

/// An open link.
pub struct Link {
    name: String,
    notices: Vec<String>,
    kind: Kind,
    sender: Option<Sender>,
    receiver: Option<Receiver>,
}

/// What remains of a link after its two halves are taken.
enum Kind {
    Pty(pty::Pty),
    Serial(serial::Serial),
    Tcp(tcp::Tcp),
    Udp(udp::Udp),
    /// Somebody is always there; no wait.
    Plain,
}

impl Link {
    /// Opens a link, ready to stream. A port that is missing or busy, or a peer that refuses, is an error at once.
    ///
    /// # Panics
    /// Outside a tokio runtime with I/O and time enabled.
    pub async fn open(address: &Address) -> Result<Self, LinkError> {
        match address {
            Address::Pty { path, baud } => pty::open(address, path.as_deref(), *baud),
            Address::Serial { path, baud } => serial::open(address, path, baud.unwrap_or(DEFAULT_BAUD)),
            Address::TcpIn(place) => tcp::listen(address, place).await,
            Address::TcpOut(place) => tcp::connect(address, place).await,
            Address::UdpIn(place) => udp::listen(address, place).await,
            Address::UdpOut(place) => udp::aim(address, place).await,
            Address::File { path } => file::open(address, path),
            Address::Stdout => stdout::open(address),
        }
    }

    fn new(name: impl Display, kind: Kind, sender: Sender, receiver: Option<Receiver>) -> Self {
        Self { name: name.to_string(), notices: Vec::new(), kind, sender: Some(sender), receiver }
    }

    /// What to connect to: `/dev/pts/4`, the path where a pty is published, `127.0.0.1:4560` with the chosen port,
    /// the serial port, the file, `-`.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What the user should know about how the link opened, one sentence each.
    pub fn notices(&self) -> &[String] {
        &self.notices
    }

    /// Waits until somebody is there: on a pty, 100 ms after a reader has opened it; on `tcpin`, until a peer
    /// connects; on `udpin`, until a first datagram, which remains to be received. Other links are ready at once.
    ///
    /// The wait may be cancelled at any time and called again.
    pub async fn peer(&mut self) -> Result<(), LinkError> {
        let came: io::Result<()> = match &mut self.kind {
            Kind::Pty(link) => {
                link.peer().await;
                Ok(())
            }
            Kind::Tcp(link) => link.peer().await,
            Kind::Udp(link) => link.peer().await,
            Kind::Serial(_) | Kind::Plain => Ok(()),
        };
        came.map_err(|source| LinkError::Io {
            link: self.name.clone(),
            doing: "wait for the other side".to_owned(),
            source,
        })
    }

    /// Whether somebody is there now, as far as the link can know: a pty's reader, a connected peer, or a
    /// plugged-in serial port. Files and standard output always have somebody.
    pub fn peer_is_present(&self) -> bool {
        match &self.kind {
            Kind::Pty(link) => link.present(),
            Kind::Tcp(link) => link.present(),
            Kind::Udp(link) => link.present(),
            Kind::Serial(link) => link.present(),
            Kind::Plain => true,
        }
    }

    /// Whether somebody was there and nobody is now, where the [`Sender`] does not report it itself
    /// ([`Sent::Gone`]): a pty without its reader is only `Full`, because another may come, and an unplugged serial
    /// port only `Away`.
    ///
    /// It may read `/proc`: call it now and then, not with every packet.
    pub fn peer_has_left(&self) -> bool {
        match &self.kind {
            Kind::Pty(link) => link.has_left(),
            Kind::Serial(link) => !link.present(),
            Kind::Tcp(_) | Kind::Udp(_) | Kind::Plain => false,
        }
    }

    /// Whether it is an unplugged port; the link looks for its path while somebody receives.
    pub fn is_unplugged(&self) -> bool {
        matches!(&self.kind, Kind::Serial(link) if !link.present())
    }

    /// The speed of a serial port; `None` of a link that has none to set.
    pub fn baud(&self) -> Option<Baud> {
        match &self.kind {
            Kind::Serial(link) => Some(link.baud()),
            Kind::Pty(_) | Kind::Tcp(_) | Kind::Udp(_) | Kind::Plain => None,
        }
    }

    /// Whether something may come back, for the [`Receiver`] that was not taken yet.
    pub fn answers(&self) -> bool {
        self.receiver.is_some()
    }

    /// Sent bytes that the other side does not have yet, where the system tells: in the buffers of a serial driver,
    /// of a TCP connection, of a pty (the visible part) and of the UART it emulates.
    pub fn queued(&self) -> Option<usize> {
        match &self.kind {
            Kind::Pty(link) => link.queued(),
            Kind::Serial(link) => link.queued(),
            Kind::Tcp(link) => link.queued(),
            Kind::Udp(_) | Kind::Plain => None,
        }
    }

    /// The sending side, for one thread.
    ///
    /// # Panics
    /// When it is taken a second time: two senders would mix their packets.
    pub fn sender(&mut self) -> Sender {
        self.sender.take().expect("a link has one sender")
    }

    /// The receiving side; `None` where nothing comes back, or when it was already taken.
    pub fn receiver(&mut self) -> Option<Receiver> {
        self.receiver.take()
    }

    /// Closes the link; gives the other side up to a second to read what was sent.
    ///
    /// First drop the [`Sender`] (after [`Sender::finish`]) and the [`Receiver`]. Dropping the link instead waits
    /// for nothing. Either way removes a published path.
    pub async fn close(self) {
        match self.kind {
            Kind::Pty(link) => link.close().await,
            Kind::Serial(link) => link.close().await,
            Kind::Tcp(link) => link.close().await,
            Kind::Udp(_) | Kind::Plain => {}
        }
    }
}
