//! A TCP connection to one peer, waited for (`tcpin`) or made (`tcpout`).

use std::io::{self, Read, Write};
use std::net::{Shutdown, TcpStream};
use std::os::fd::{AsFd, BorrowedFd};
use std::sync::Arc;
use std::time::Duration;

use tokio::net::TcpListener;
use tokio::sync::{Mutex, OnceCell};

use super::address::{Address, Place, Problem};
use super::net::{cannot_listen, cannot_reach, resolve, resolve_one};
use super::receiver::read_when_ready;
use super::scheme::{self, Scheme};
use super::sender::{Carry, Sender, To};
use super::{LinkError, receiver};
use crate::os::{self, Readable};

/// The listening line in the table of links.
pub(super) const SCHEME_IN: Scheme = Scheme {
    name: "tcpin",
    spelling: "tcpin:[ADDR:]PORT",
    about: "waits for one TCP connection; on this machine alone where no ADDR is given",
    parse: parse_in,
};

/// The connecting line in the table of links.
pub(super) const SCHEME_OUT: Scheme = Scheme {
    name: "tcpout",
    spelling: "tcpout:ADDR:PORT",
    about: "connects to a listening TCP peer",
    parse: parse_out,
};

fn parse_in(rest: Option<&str>) -> Result<Address, Problem> {
    scheme::listening("tcpin", rest).map(Address::TcpIn)
}

fn parse_out(rest: Option<&str>) -> Result<Address, Problem> {
    scheme::destination("tcpout", rest).map(Address::TcpOut)
}

/// A peer that has not answered in this time will not.
const CONNECT: Duration = Duration::from_secs(10);

/// An open TCP link.
pub(super) struct Tcp {
    name: String,
    way: Arc<Way>,
}

/// The connection, once there is one.
pub(super) struct Way {
    listener: Mutex<Option<TcpListener>>,
    stream: OnceCell<TcpStream>,
}

impl Tcp {
    pub(super) async fn listen(address: &Address, place: &Place) -> Result<Self, LinkError> {
        let local = resolve_one(address, place).await?;
        let refused = |source| cannot_listen(address, place, source);
        let listener = TcpListener::bind(local).await.map_err(refused)?;
        let name = listener.local_addr().map_err(refused)?.to_string();
        let way = Arc::new(Way { listener: Mutex::new(Some(listener)), stream: OnceCell::new() });
        Ok(Self { name, way })
    }

    pub(super) async fn connect(address: &Address, place: &Place) -> Result<Self, LinkError> {
        let refused = |source| cannot_reach(address, place, source);
        let addresses = resolve(address, place).await?;
        let connect = tokio::net::TcpStream::connect(addresses.as_slice());
        let stream = match tokio::time::timeout(CONNECT, connect).await {
            Ok(answer) => answer.map_err(refused)?,
            Err(_) => return Err(refused(io::ErrorKind::TimedOut.into())),
        };
        let name = stream.peer_addr().map_err(refused)?.to_string();
        let way = Arc::new(Way {
            listener: Mutex::new(None),
            stream: OnceCell::new_with(Some(plain(stream).map_err(refused)?)),
        });
        Ok(Self { name, way })
    }

    pub(super) fn name(&self) -> String {
        self.name.clone()
    }

    pub(super) fn present(&self) -> bool {
        self.way.stream.initialized()
    }

    pub(super) async fn peer(&mut self) -> io::Result<()> {
        self.way.connected().await.map(drop)
    }

    pub(super) fn sender(&mut self) -> Sender {
        Sender::new(To::Tcp(Out(Arc::clone(&self.way))), Carry::packet())
    }

    pub(super) fn receiver(&mut self) -> Option<receiver::From> {
        Some(receiver::From::Tcp(In { way: Arc::clone(&self.way), socket: None }))
    }

    /// Says that nothing more comes, and waits up to a second until the peer has it all.
    ///
    /// What the peer still sends is read and dropped: closing with bytes unread would reset the
    /// connection and could take our last packets with it.
    pub(super) async fn close(self) {
        let Some(mut stream) = self.way.stream.get() else {
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
    /// The connection, waited for where there is none yet. Cancelling it loses nothing.
    async fn connected(&self) -> io::Result<&TcpStream> {
        self.stream.get_or_try_init(|| self.accept()).await
    }

    /// Takes the first peer that connects, and turns all others away.
    async fn accept(&self) -> io::Result<TcpStream> {
        let mut listener = self.listener.lock().await;
        let Some(open) = listener.as_ref() else {
            return Err(io::ErrorKind::NotConnected.into());
        };
        let stream = loop {
            match open.accept().await {
                Ok((stream, _)) => break stream,
                // It left again before it was seen.
                Err(error) if error.kind() == io::ErrorKind::ConnectionAborted => {}
                Err(error) => return Err(error),
            }
        };
        *listener = None;
        plain(stream)
    }
}

/// A connection that the pacing thread can write to by itself, each packet at once.
fn plain(stream: tokio::net::TcpStream) -> io::Result<TcpStream> {
    stream.set_nodelay(true)?;
    stream.into_std()
}

/// The sending side.
pub(super) struct Out(Arc<Way>);

impl Out {
    pub(super) fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.0.stream.get() {
            Some(mut stream) => stream.write(bytes),
            None => Err(io::ErrorKind::WouldBlock.into()),
        }
    }

    pub(super) fn poll_fd(&self) -> Option<BorrowedFd<'_>> {
        self.0.stream.get().map(AsFd::as_fd)
    }

    pub(super) fn queued(&self) -> Option<usize> {
        os::unsent(self.0.stream.get()?).ok()
    }
}

/// The receiving side.
pub(super) struct In {
    way: Arc<Way>,
    socket: Option<Readable>,
}

impl In {
    pub(super) async fn recv(&mut self, buffer: &mut Vec<u8>) -> io::Result<usize> {
        if self.socket.is_none() {
            let stream = self.way.connected().await?.try_clone()?;
            self.socket = Some(Readable::new(Arc::new(stream.into()))?);
        }
        match &self.socket {
            Some(socket) => read_when_ready(socket, buffer).await,
            None => Ok(0),
        }
    }
}
