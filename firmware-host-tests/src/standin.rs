//! Stand-ins for flight controllers: each behaves on its link as the firmware was measured to.
//!
//! A [`Firmware`] touches no link and reads no clock: bytes and times go in, what it says comes out, so that a test
//! holds a whole conversation in memory. [`StandIn`] is the loop around one, on a port and a [`Clock`].
//! What the firmwares have in common is here: an estimator of their own, which nobody else's attitude
//! reaches, and a [`Record`] of what came of it.

mod ardupilot;
mod arrivals;
mod betaflight;
mod hil;
mod ilabs;
mod inav;
mod make;
mod mip;
mod mishap;
mod own;
mod px4;
mod px4_sitl;
mod px4_vectornav;
mod record;
mod sbg;
mod sockets;
mod validator;

use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

pub use ardupilot::Ardupilot;
pub use arrivals::{Clock, Framing};
pub use betaflight::{Betaflight, Build};
pub use ilabs::Ilabs;
pub use inav::Inav;
pub use make::{Make, Settings};
pub use mip::Mip;
pub use mishap::{Mishap, Unlucky};
pub use px4::{Parameters, Px4};
pub use px4_sitl::Px4Sitl;
pub use px4_vectornav::Px4Vectornav;
pub use record::{Counts, Moment, Record};
pub use sbg::Sbg;
pub use sockets::Program;

use crate::board::{Arrival, Port};
use own::Own;

/// How long the loop waits for bytes before it looks at what is due by itself.
const TURN: Duration = Duration::from_millis(2);

/// Bytes asked of the link at once.
const READ_LEN: usize = 4096;

/// Bytes that wait for the link before what is said is dropped, whole messages at a time.
const MAX_WAITING: usize = 16_384;

/// A flight controller's firmware, as far as its link shows.
pub trait Firmware {
    /// Takes bytes that have arrived by `now_us` of its own clock, and appends what it says to them.
    fn receive(&mut self, bytes: &[u8], now_us: u64, out: &mut Vec<u8>);

    /// The same on the link on which it is spoken with, if that is not the samples' own.
    fn receive_apart(&mut self, bytes: &[u8], now_us: u64, out: &mut Vec<u8>) {
        self.receive(bytes, now_us, out);
    }

    /// Does what is due by itself by `now_us`; called often, with times that never go back.
    fn turn(&mut self, now_us: u64, out: &mut Vec<u8>);

    /// What has happened so far.
    fn record(&self) -> &Record;

    /// The speed at which it wants its port, baud; `None` leaves it as it is.
    fn baud(&self) -> Option<u32> {
        None
    }
}

/// A firmware on a link.
pub struct StandIn {
    port: Box<dyn Port + Send>,
    firmware: Box<dyn Firmware + Send>,
    clock: Clock,
    waiting: Vec<u8>,
    unsaid: u64,
    /// The speed that the port was set to.
    baud: Option<u32>,
}

impl StandIn {
    /// A firmware on a link, with a clock of its own.
    pub fn new(port: Box<dyn Port + Send>, firmware: Box<dyn Firmware + Send>, clock: Clock) -> Self {
        Self { port, firmware, clock, waiting: Vec::new(), unsaid: 0, baud: None }
    }

    /// Runs until the other side is gone or `stop` is set.
    ///
    /// # Errors
    /// Those of the link, except that the other side is gone.
    pub fn run(&mut self, stop: &AtomicBool) -> io::Result<()> {
        while !stop.load(Ordering::Relaxed) && self.step()? {}
        let mut out = Vec::new();
        self.firmware.turn(self.clock.after_the_last(), &mut out);
        Ok(())
    }

    /// Runs until the other side is gone or the record is as `enough` wants it.
    ///
    /// # Errors
    /// Those of the link, except that the other side is gone.
    pub fn run_until(&mut self, enough: impl Fn(&Record) -> bool) -> io::Result<()> {
        while !enough(self.firmware.record()) && self.step()? {}
        Ok(())
    }

    /// Boots another firmware on the same port; gives back what came of the one before.
    pub fn reboot(&mut self, firmware: Box<dyn Firmware + Send>) -> Record {
        self.waiting.clear();
        std::mem::replace(&mut self.firmware, firmware).record().clone()
    }

    /// One turn of the loop: false when the other side is gone.
    fn step(&mut self) -> io::Result<bool> {
        let mut bytes = [0; READ_LEN];
        let mut out = Vec::new();
        let baud = self.firmware.baud();
        if let Some(baud) = baud.filter(|_| self.baud != baud) {
            self.port.set_baud(baud)?;
            self.baud = Some(baud);
        }
        match self.port.read(&mut bytes, TURN)? {
            Arrival::Bytes(len) => {
                for (piece, now_us) in self.clock.times(&bytes[..len]) {
                    self.firmware.turn(now_us, &mut out);
                    self.firmware.receive(piece, now_us, &mut out);
                    self.say(&mut out)?;
                }
            }
            Arrival::Idle => {
                self.clock.idle();
                self.firmware.turn(self.clock.now_us(), &mut out);
                self.say(&mut out)?;
            }
            Arrival::Closed => return Ok(false),
        }
        Ok(true)
    }

    /// Hands what was said to the link, or keeps it for later, or drops it if too much waits: a firmware does not
    /// wait for its link.
    fn say(&mut self, out: &mut Vec<u8>) -> io::Result<()> {
        if self.waiting.len() + out.len() > MAX_WAITING {
            self.unsaid += out.len() as u64;
        } else {
            self.waiting.extend_from_slice(out);
        }
        out.clear();
        if !self.waiting.is_empty() {
            let written = self.port.write(&self.waiting)?;
            self.waiting.drain(..written);
        }
        Ok(())
    }

    /// What has happened so far.
    pub fn record(&self) -> &Record {
        self.firmware.record()
    }

    /// Bytes that it wanted to say while the link was full.
    pub fn unsaid(&self) -> u64 {
        self.unsaid
    }
}
