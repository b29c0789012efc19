//! A bus and its time as drivers want them: `embedded-hal` 1.0 and 0.2, `embedded-hal-async`, and a chip's SPI.

use std::future::Future;
use std::pin::pin;
use std::task::{Context, Poll, Waker};

use embedded_hal::i2c::{ErrorKind, ErrorType, NoAcknowledgeSource, Operation};
use embedded_hal::spi;
use embedded_hal_02::blocking::{delay as delay_02, i2c as i2c_02};

use super::bench::Bench;
use super::bus::{Fault, I2c};

/// A bus in a driver's hands.
pub struct Hal<B>(pub B);

impl embedded_hal::i2c::Error for Fault {
    fn kind(&self) -> ErrorKind {
        match self {
            Fault::Nack => ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address),
            Fault::Other(_) => ErrorKind::Other,
        }
    }
}

impl<B> ErrorType for Hal<B> {
    type Error = Fault;
}

/// Adjacent operations of a kind are one message, without a start between them; a read after a write begins with one.
impl<B: I2c> embedded_hal::i2c::I2c for Hal<B> {
    fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), Fault> {
        let mut written: Option<Vec<u8>> = None;
        let mut rest = operations.iter_mut().peekable();
        while let Some(operation) = rest.next() {
            match operation {
                Operation::Write(bytes) => written.get_or_insert_default().extend_from_slice(bytes),
                Operation::Read(first) => {
                    let mut parts: Vec<&mut [u8]> = vec![first];
                    while let Some(Operation::Read(more)) =
                        rest.next_if(|it| matches!(it, Operation::Read(_)))
                    {
                        parts.push(more);
                    }
                    let mut bytes = vec![0; parts.iter().map(|part| part.len()).sum()];
                    match written.take() {
                        Some(register) => self.0.write_read(address, &register, &mut bytes)?,
                        None => self.0.read(address, &mut bytes)?,
                    }
                    let mut from = bytes.into_iter();
                    parts.into_iter().flatten().for_each(|byte| *byte = from.next().unwrap_or(0));
                }
            }
        }
        written.map_or(Ok(()), |bytes| self.0.write(address, &bytes))
    }
}

impl<B: I2c> embedded_hal_async::i2c::I2c for Hal<B> {
    async fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), Fault> {
        embedded_hal::i2c::I2c::transaction(self, address, operations)
    }
}

impl<B: I2c> i2c_02::Write for Hal<B> {
    type Error = Fault;

    fn write(&mut self, address: u8, bytes: &[u8]) -> Result<(), Fault> {
        self.0.write(address, bytes)
    }
}

impl<B: I2c> i2c_02::Read for Hal<B> {
    type Error = Fault;

    fn read(&mut self, address: u8, out: &mut [u8]) -> Result<(), Fault> {
        self.0.read(address, out)
    }
}

impl<B: I2c> i2c_02::WriteRead for Hal<B> {
    type Error = Fault;

    fn write_read(&mut self, address: u8, bytes: &[u8], out: &mut [u8]) -> Result<(), Fault> {
        self.0.write_read(address, bytes, out)
    }
}

/// The bench's time in a driver's hands.
pub struct Delay<'a, B>(pub &'a B);

impl<B: Bench> embedded_hal::delay::DelayNs for Delay<'_, B> {
    fn delay_ns(&mut self, ns: u32) {
        self.0.wait(u64::from(ns));
    }
}

impl<B: Bench> embedded_hal_async::delay::DelayNs for Delay<'_, B> {
    async fn delay_ns(&mut self, ns: u32) {
        self.0.wait(u64::from(ns));
    }
}

impl<B: Bench> delay_02::DelayMs<u8> for Delay<'_, B> {
    fn delay_ms(&mut self, ms: u8) {
        self.0.wait(u64::from(ms) * 1_000_000);
    }
}

/// A chip at this address as its SPI reaches it: bit 7 of the first byte reads, and so many bytes come before the data.
pub struct Spi<B>(pub B, pub u8, pub usize);

impl<B: I2c> Spi<B> {
    fn take(&mut self, register: u8, out: &mut [u8]) -> Result<(), Fault> {
        let data = out.get_mut(self.2..).unwrap_or_default();
        self.0.write_read(self.1, &[register & 0x7f], data)
    }
}

impl spi::Error for Fault {
    fn kind(&self) -> spi::ErrorKind {
        spi::ErrorKind::Other
    }
}

impl<B> spi::ErrorType for Spi<B> {
    type Error = Fault;
}

impl<B: I2c> spi::SpiDevice for Spi<B> {
    fn transaction(&mut self, operations: &mut [spi::Operation<'_, u8>]) -> Result<(), Fault> {
        let (mut sent, mut register) = (Vec::new(), None);
        for operation in operations {
            match operation {
                spi::Operation::Write([first, ..]) if register.is_none() && first & 0x80 != 0 => {
                    register = Some(first & 0x7f);
                }
                spi::Operation::Write(bytes) => sent.extend_from_slice(bytes),
                spi::Operation::TransferInPlace([first, out @ ..]) if *first & 0x80 != 0 => {
                    let register = *first;
                    self.take(register, out)?;
                }
                spi::Operation::TransferInPlace(bytes) => sent.extend_from_slice(bytes),
                spi::Operation::Read(out) => match register {
                    Some(register) => self.take(register, out)?,
                    None => self.0.read(self.1, out)?,
                },
                spi::Operation::DelayNs(_) => {}
                other => return Err(Fault::Other(format!("not a chip's: {other:?}"))),
            }
        }
        if sent.is_empty() { Ok(()) } else { self.0.write(self.1, &sent) }
    }
}

/// Drives a future that never waits.
pub fn block_on<F: Future>(future: F) -> F::Output {
    let mut future = pin!(future);
    let mut context = Context::from_waker(Waker::noop());
    loop {
        if let Poll::Ready(output) = future.as_mut().poll(&mut context) {
            return output;
        }
    }
}
