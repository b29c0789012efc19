//! An I²C bus that knows no trait of any driver: what `hal.rs` turns into those of `embedded-hal`.

use ratetable_protocols::bridge::{Client, Port, Status, Trouble};

/// Why a transfer failed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Fault {
    /// Nobody acknowledged.
    Nack,
    /// Anything else.
    Other(String),
}

/// A master on a bus with 7-bit addresses.
pub trait I2c {
    /// Writes a message.
    fn write(&mut self, address: u8, bytes: &[u8]) -> Result<(), Fault>;

    /// Reads a message.
    fn read(&mut self, address: u8, out: &mut [u8]) -> Result<(), Fault>;

    /// Writes and then reads without letting the bus go.
    fn write_read(&mut self, address: u8, bytes: &[u8], out: &mut [u8]) -> Result<(), Fault>;
}

/// A bridge, over whatever port: in memory here, or a pty.
impl<P: Port<Error: std::fmt::Debug>> I2c for Client<P> {
    fn write(&mut self, address: u8, bytes: &[u8]) -> Result<(), Fault> {
        Client::write(self, address, bytes).map_err(fault)
    }

    fn read(&mut self, address: u8, out: &mut [u8]) -> Result<(), Fault> {
        Client::read(self, address, out).map_err(fault)
    }

    fn write_read(&mut self, address: u8, bytes: &[u8], out: &mut [u8]) -> Result<(), Fault> {
        Client::write_read(self, address, bytes, out).map_err(fault)
    }
}

fn fault<E: std::fmt::Debug>(trouble: Trouble<E>) -> Fault {
    match trouble {
        Trouble::Refused(Status::NoAddress) => Fault::Nack,
        trouble => Fault::Other(format!("{trouble:?}")),
    }
}
