//! The firmware's end of a bridge, over whatever sends and receives bytes.

use super::{MAX_MESSAGE, Message, READ_REGISTER, STATUS, STOP, Status, encode};
use crate::Error;

/// Sends and receives bytes of a UART.
pub trait Port {
    /// Why it could not.
    type Error;

    /// Sends all of these bytes.
    ///
    /// # Errors
    /// As the port has them.
    fn send(&mut self, bytes: &[u8]) -> Result<(), Self::Error>;

    /// Waits until all of `bytes` is received.
    ///
    /// # Errors
    /// As the port has them, a time-out among them.
    fn receive(&mut self, bytes: &mut [u8]) -> Result<(), Self::Error>;
}

/// Why a transfer failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trouble<E> {
    /// The port failed.
    Port(E),
    /// The bridge says so.
    Refused(Status),
    /// The bridge says something else.
    Unknown(u8),
    /// The transfer does not fit: a read of more than 255 bytes, or a write of more than 1 kB.
    TooLong,
}

/// Speaks with the chips behind a bridge. After each transfer it asks how it went.
#[derive(Clone, Debug)]
pub struct Client<P> {
    port: P,
}

impl<P: Port> Client<P> {
    /// Over this port, whose other end is at the bridge's speed.
    pub const fn new(port: P) -> Self {
        Self { port }
    }

    /// Writes to the chip at a 7-bit address.
    ///
    /// # Errors
    /// The port fails, or the chip does not acknowledge.
    pub fn write(&mut self, address: u8, bytes: &[u8]) -> Result<(), Trouble<P::Error>> {
        self.send(address, &[Message::Write(bytes)])?;
        self.check()
    }

    /// Reads from the chip.
    ///
    /// # Errors
    /// As [`Client::write`].
    pub fn read(&mut self, address: u8, out: &mut [u8]) -> Result<(), Trouble<P::Error>> {
        let count = count(out)?;
        self.send(address, &[Message::Read(count)])?;
        self.take(out)
    }

    /// Writes to the chip, such as a register's address, and reads from it without letting the bus go.
    ///
    /// # Errors
    /// As [`Client::write`].
    pub fn write_read(&mut self, address: u8, bytes: &[u8], out: &mut [u8]) -> Result<(), Trouble<P::Error>> {
        let count = count(out)?;
        self.send(address, &[Message::Write(bytes), Message::Read(count)])?;
        self.take(out)
    }

    fn send(&mut self, address: u8, messages: &[Message<'_>]) -> Result<(), Trouble<P::Error>> {
        let mut bytes = [0; 1100];
        let len = encode(address, messages, &mut bytes).map_err(|_: Error| Trouble::TooLong)?;
        self.port.send(&bytes[..len]).map_err(Trouble::Port)
    }

    fn take(&mut self, out: &mut [u8]) -> Result<(), Trouble<P::Error>> {
        self.port.receive(out).map_err(Trouble::Port)?;
        self.check()
    }

    fn check(&mut self) -> Result<(), Trouble<P::Error>> {
        let mut status = [0];
        self.port.send(&[READ_REGISTER, STATUS, STOP]).map_err(Trouble::Port)?;
        self.port.receive(&mut status).map_err(Trouble::Port)?;
        match Status::from_byte(status[0]) {
            Some(Status::Done) => Ok(()),
            Some(status) => Err(Trouble::Refused(status)),
            None => Err(Trouble::Unknown(status[0])),
        }
    }
}

fn count<E>(out: &[u8]) -> Result<u8, Trouble<E>> {
    u8::try_from(out.len()).ok().filter(|count| usize::from(*count) <= MAX_MESSAGE).ok_or(Trouble::TooLong)
}
