//! A TCP connection to one peer, accepted (`tcpin`) or opened (`tcpout`).

use std::io::{self, Read, Write};
use std::net::{Shutdown, SocketAddr, TcpStream};
use std::os::fd::{AsFd, BorrowedFd};
use std::sync::Arc;
use std::time::Duration;

use bytes::BytesMut;
use tokio::net::TcpListener;
use tokio::sync::{Mutex, OnceCell};

use super::address::Address;
use super::endpoint::{self, Endpoint};
use super::net::{cannot_listen, cannot_reach, resolve, resolve_one};
use super::problem::Problem;
use super::sender::{Carry, Out, Sender};
use super::spelling::Scheme;
use super::stream::read;
use super::{Kind, Link, LinkError};
use crate::os;

/// Its listening line in the table of links.
pub(super) const SCHEME_IN: Scheme = Scheme {
    name: "tcpin",
    spelling: "tcpin:[ADDR:]PORT",
    about: "waits for one TCP peer and refuses others; listens only on this machine unless ADDR is given",
    parse: parse_in,
};

/// Its connecting line in the table of links.
pub(super) const SCHEME_OUT: Scheme = Scheme {
    name: "tcpout",
    spelling: "tcpout:ADDR:PORT",
    about: "connects to a listening TCP peer",
    parse: parse_out,
};

fn parse_in(rest: Option<&str>) -> Result<Address, Problem> {
    endpoint::listening("tcpin", rest).map(Address::TcpIn)
}

fn parse_out(rest: Option<&str>) -> Result<Address, Problem> {
    endpoint::destination("tcpout", rest).map(Address::TcpOut)
}

/// Timeout for a connection.
const CONNECT: Duration = Duration::from_secs(10);

/// An open TCP link.
pub(super) struct Tcp(Arc<Way>);

/// The connection, once there is one.
struct Way {
    listener: Mutex<Option<TcpListener>>,
    stream: OnceCell<TcpStream>,
}

pub(super) async fn listen(address: &Address, place: &Endpoint) -> Result<Link, LinkError> {
    let local = resolve_one(address, place).await?;
    let refused = |source| cannot_listen(address, place, source);
    let listener = TcpListener::bind(local).await.map_err(refused)?;
    let name = listener.local_addr().map_err(refused)?;
    Ok(link(name, Way { listener: Mutex::new(Some(listener)), stream: OnceCell::new() }))
}

pub(super) async fn connect(address: &Address, place: &Endpoint) -> Result<Link, LinkError> {
    let refused = |source| cannot_reach(address, place, source);
    let addresses = resolve(address, place).await?;
    let connect = tokio::net::TcpStream::connect(addresses.as_slice());
    let stream = match tokio::time::timeout(CONNECT, connect).await {
        Ok(answer) => answer.map_err(refused)?,
        Err(_) => return Err(refused(io::ErrorKind::TimedOut.into())),
    };
    let name = stream.peer_addr().map_err(refused)?;
    let stream = OnceCell::new_with(Some(plain(stream).map_err(refused)?));
    Ok(link(name, Way { listener: Mutex::new(None), stream }))
}

fn link(name: SocketAddr, way: Way) -> Link {
    let way = Arc::new(way);
    let sender = Sender::new(Segments(Arc::clone(&way)), Carry::packet());
    let receiver = In { way: Arc::clone(&way), stream: None }.into();
    Link::new(name, Kind::Tcp(Tcp(way)), sender, Some(receiver))
}

impl Tcp {
    pub(super) fn present(&self) -> bool {
        self.0.stream.initialized()
    }

    pub(super) async fn peer(&self) -> io::Result<()> {
        self.0.connected().await.map(drop)
    }

    /// Bytes that the peer has not acknowledged.
    pub(super) fn queued(&self) -> Option<usize> {
        os::unsent(self.0.stream.get()?).ok()
    }

    /// Shuts down the sending direction, and waits up to a second until the peer has everything.
    ///
    /// It reads and drops what the peer still sends: a close with unread bytes would reset the connection and could
    /// lose our last packets.
    pub(super) async fn close(self) {
        let Some(mut stream) = self.0.stream.get() else {
            return;
        };
        let _ = stream.shutdown(Shutdown::Write);
        let mut dropped = [0; 4096];
        for _ in 0..200 {
            match stream.read(&mut dropped) {
                Ok(0) => return,
                Ok(_) => continue,
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
                Err(_) => return,
            }
            if os::unsent(stream).unwrap_or(0) == 0 {
                return;
            }
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
    }
}

impl Way {
    /// The connection; waits for it if there is none yet. Cancelling it loses nothing.
    async fn connected(&self) -> io::Result<&TcpStream> {
        self.stream.get_or_try_init(|| self.accept()).await
    }

    /// Accepts the first peer that connects, and rejects all others.
    async fn accept(&self) -> io::Result<TcpStream> {
        let mut listener = self.listener.lock().await;
        let Some(open) = listener.as_ref() else {
            return Err(io::ErrorKind::NotConnected.into());
        };
        let stream = loop {
            match open.accept().await {
                Ok((stream, _)) => break stream,
                // It disconnected before it was accepted.
                Err(error) if error.kind() == io::ErrorKind::ConnectionAborted => {}
                Err(error) => return Err(error),
            }
        };
        *listener = None;
        plain(stream)
    }
}

/// A connection that the pacing thread writes to directly, each packet at once.
fn plain(stream: tokio::net::TcpStream) -> io::Result<TcpStream> {
    stream.set_nodelay(true)?;
    stream.into_std()
}

/// The sending side.
struct Segments(Arc<Way>);

impl Out for Segments {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.0.stream.get() {
            Some(mut stream) => stream.write(bytes),
            None => Err(io::ErrorKind::WouldBlock.into()),
        }
    }

    fn poll_fd(&self) -> Option<BorrowedFd<'_>> {
        self.0.stream.get().map(AsFd::as_fd)
    }
}

/// The receiving side.
pub(super) struct In {
    way: Arc<Way>,
    /// The same connection, for polling.
    stream: Option<tokio::net::TcpStream>,
}

impl In {
    pub(super) async fn recv(&mut self, buffer: &mut BytesMut) -> io::Result<usize> {
        if self.stream.is_none() {
            let again = self.way.connected().await?.try_clone()?;
            self.stream = Some(tokio::net::TcpStream::from_std(again)?);
        }
        match &mut self.stream {
            Some(stream) => read(stream, buffer).await,
            None => Ok(0),
        }
    }
}
