//! A firmware that is a program with two sockets: samples come over UDP, and it is spoken with over TCP.

use std::io::{self, ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream, UdpSocket};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use super::{Clock, Firmware, Record};

/// Between two looks at the connection where no sample comes.
const TURN: Duration = Duration::from_millis(2);
/// Bytes asked of a socket at once.
const READ_LEN: usize = 4096;

/// A firmware on two sockets.
pub struct Program {
    samples: UdpSocket,
    listener: TcpListener,
    /// One client at a time.
    client: Option<TcpStream>,
    firmware: Box<dyn Firmware + Send>,
    clock: Clock,
}

impl Program {
    /// Listens at `HOST:UDP_PORT:TCP_PORT`; a port of 0 is any free one.
    ///
    /// # Errors
    /// Those of the sockets, and a place that is none.
    pub fn open(place: &str, firmware: Box<dyn Firmware + Send>, clock: Clock) -> io::Result<Self> {
        let none =
            || io::Error::new(ErrorKind::InvalidInput, format!("`{place}` is not HOST:UDP_PORT:TCP_PORT"));
        let (samples, port) = place.rsplit_once(':').ok_or_else(none)?;
        let (host, _) = samples.rsplit_once(':').ok_or_else(none)?;
        let samples = UdpSocket::bind(samples)?;
        samples.set_read_timeout(Some(TURN))?;
        let listener = TcpListener::bind(format!("{host}:{port}"))?;
        listener.set_nonblocking(true)?;
        Ok(Self { samples, listener, client: None, firmware, clock })
    }

    /// Where it takes samples, and where it is spoken with.
    ///
    /// # Errors
    /// Those of the sockets.
    pub fn places(&self) -> io::Result<[SocketAddr; 2]> {
        Ok([self.samples.local_addr()?, self.listener.local_addr()?])
    }

    /// Runs until its client has left or `stop` is set.
    ///
    /// # Errors
    /// Those of the sockets.
    pub fn run(&mut self, stop: &AtomicBool) -> io::Result<()> {
        let mut packet = [0; READ_LEN];
        while !stop.load(Ordering::Relaxed) {
            let mut out = Vec::new();
            match self.samples.recv(&mut packet) {
                Ok(len) => self.firmware.receive(&packet[..len], self.clock.now_us(), &mut out),
                Err(error) if is_idle(&error) => self.firmware.turn(self.clock.now_us(), &mut out),
                Err(error) => return Err(error),
            }
            if !self.attend(&mut out)? {
                break;
            }
        }
        // What waits came before its client left.
        self.samples.set_nonblocking(true)?;
        while let Ok(len) = self.samples.recv(&mut packet) {
            self.firmware.receive(&packet[..len], self.clock.now_us(), &mut Vec::new());
        }
        Ok(())
    }

    /// Hears its client and says what there is to say: false once it has left.
    fn attend(&mut self, out: &mut Vec<u8>) -> io::Result<bool> {
        let Some(client) = &mut self.client else {
            match self.listener.accept() {
                Ok((client, _)) => {
                    client.set_nonblocking(true)?;
                    client.set_nodelay(true)?;
                    self.client = Some(client);
                }
                Err(error) if is_idle(&error) => {}
                Err(error) => return Err(error),
            }
            return Ok(true);
        };
        let mut bytes = [0; READ_LEN];
        match client.read(&mut bytes) {
            Ok(0) => return Ok(false),
            Ok(len) => self.firmware.receive_apart(&bytes[..len], self.clock.now_us(), out),
            Err(error) if is_idle(&error) => {}
            Err(_) => return Ok(false),
        }
        // A client that is gone reads nothing; the next look tells.
        let _ = client.write_all(out);
        Ok(true)
    }

    /// What has happened so far.
    pub fn record(&self) -> &Record {
        self.firmware.record()
    }
}

fn is_idle(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted)
}
