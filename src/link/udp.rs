//! UDP datagrams, one per packet, to the first sender (`udpin`) or to one address (`udpout`).
//!
//! UDP does not report whether a datagram arrived, so a missing listener never makes the link `Gone`.

use std::io;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, UdpSocket};
use std::os::fd::{AsFd, BorrowedFd};
use std::sync::Arc;

use bytes::BytesMut;
use tokio::sync::OnceCell;

use super::address::Address;
use super::endpoint::{self, Endpoint};
use super::net::{cannot_listen, cannot_reach, resolve_one};
use super::problem::Problem;
use super::sender::{Carry, Out, Sender};
use super::spelling::Scheme;
use super::{Kind, Link, LinkError};

/// Its listening line in the table of links.
pub(super) const SCHEME_IN: Scheme = Scheme {
    name: "udpin",
    spelling: "udpin:[ADDR:]PORT",
    about: "waits for a first datagram and answers its sender; listens only on this machine unless ADDR is given",
    parse: parse_in,
};

/// Its sending line in the table of links.
pub(super) const SCHEME_OUT: Scheme = Scheme {
    name: "udpout",
    spelling: "udpout:ADDR:PORT",
    about: "sends UDP datagrams to one address, one packet each",
    parse: parse_out,
};

fn parse_in(rest: Option<&str>) -> Result<Address, Problem> {
    endpoint::listening("udpin", rest).map(Address::UdpIn)
}

fn parse_out(rest: Option<&str>) -> Result<Address, Problem> {
    endpoint::destination("udpout", rest).map(Address::UdpOut)
}

/// The longest datagram there is.
const LONGEST: usize = 65_536;

/// An open UDP link.
pub(super) struct Udp(Arc<Way>);

/// The socket, and its destination once known.
struct Way {
    /// For the pacing thread, which does not use the executor.
    plain: UdpSocket,
    /// The same socket, for polling.
    socket: tokio::net::UdpSocket,
    peer: OnceCell<SocketAddr>,
}

pub(super) async fn listen(address: &Address, place: &Endpoint) -> Result<Link, LinkError> {
    let local = resolve_one(address, place).await?;
    let refused = |source| cannot_listen(address, place, source);
    let plain = UdpSocket::bind(local).map_err(refused)?;
    let name = plain.local_addr().map_err(refused)?;
    link(name, plain, OnceCell::new()).map_err(refused)
}

pub(super) async fn aim(address: &Address, place: &Endpoint) -> Result<Link, LinkError> {
    let far = resolve_one(address, place).await?;
    let refused = |source| cannot_reach(address, place, source);
    let any = match far {
        SocketAddr::V4(_) => IpAddr::V4(Ipv4Addr::UNSPECIFIED),
        SocketAddr::V6(_) => IpAddr::V6(Ipv6Addr::UNSPECIFIED),
    };
    let local = match far.ip().is_loopback() {
        true => far.ip(),
        false => any,
    };
    let plain = UdpSocket::bind((local, 0)).map_err(refused)?;
    plain.set_broadcast(true).map_err(refused)?;
    link(far, plain, OnceCell::new_with(Some(far))).map_err(refused)
}

fn link(name: SocketAddr, plain: UdpSocket, peer: OnceCell<SocketAddr>) -> io::Result<Link> {
    plain.set_nonblocking(true)?;
    let socket = tokio::net::UdpSocket::from_std(plain.try_clone()?)?;
    let way = Arc::new(Way { plain, socket, peer });
    let sender = Sender::new(Datagrams(Arc::clone(&way)), Carry::none());
    let receiver = In(Arc::clone(&way)).into();
    Ok(Link::new(name, Kind::Udp(Udp(way)), sender, Some(receiver)))
}

impl Udp {
    pub(super) fn present(&self) -> bool {
        self.0.peer.initialized()
    }

    pub(super) async fn peer(&self) -> io::Result<()> {
        self.0.known().await.map(drop)
    }
}

impl Way {
    /// The destination: the first sender, if none was named. Cancelling it loses nothing, and that first datagram
    /// remains to be received.
    async fn known(&self) -> io::Result<SocketAddr> {
        let first = || async {
            let mut peeked = [0];
            self.socket.peek_from(&mut peeked).await.map(|(_, sender)| sender)
        };
        self.peer.get_or_try_init(first).await.copied()
    }
}

/// The sending side.
struct Datagrams(Arc<Way>);

impl Out for Datagrams {
    /// Sends `bytes` as one datagram: all of them or none.
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.0.peer.get() {
            Some(peer) => self.0.plain.send_to(bytes, peer),
            None => Err(io::ErrorKind::WouldBlock.into()),
        }
    }

    fn poll_fd(&self) -> Option<BorrowedFd<'_>> {
        self.0.peer.get().map(|_| self.0.plain.as_fd())
    }
}

/// The receiving side.
pub(super) struct In(Arc<Way>);

impl In {
    /// One datagram from the peer; drops those of others.
    pub(super) async fn recv(&mut self, buffer: &mut BytesMut) -> io::Result<usize> {
        let peer = self.0.known().await?;
        loop {
            let before = buffer.len();
            buffer.reserve(LONGEST);
            let (count, sender) = self.0.socket.recv_buf_from(buffer).await?;
            if count > 0 && from_peer(peer, sender) {
                return Ok(count);
            }
            buffer.truncate(before);
        }
    }
}

/// Whether `sender` counts as `peer`: many hosts answer a broadcast, and a peer may answer from another port.
fn from_peer(peer: SocketAddr, sender: SocketAddr) -> bool {
    let many = match peer.ip() {
        IpAddr::V4(ip) => ip.is_broadcast() || ip.is_multicast() || ip.octets()[3] == 255,
        IpAddr::V6(ip) => ip.is_multicast(),
    };
    many || peer.ip().is_unspecified() || peer.ip() == sender.ip()
}
