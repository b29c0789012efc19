//! Command 0x201F with an airspeed: a [`simulator`] message and four bytes behind it.
//!
//! The three bits of `flags` that announce the bytes go together: [`EXTERNAL_VOLTAGE`], [`AIRSPEED`] and
//! [`MORE_FLAGS`], as INAV's X-Plane plugin sends them.

use super::simulator;
use crate::error::Error;

pub use super::simulator::{COMMAND, DIRECTION};

/// Bit of `flags`: the battery's voltage is said.
pub const EXTERNAL_VOLTAGE: u8 = 1 << 5;

/// Bit of `flags`: the airspeed is said.
pub const AIRSPEED: u8 = 1 << 6;

/// Bit of `flags`: there are more flags at the end.
pub const MORE_FLAGS: u8 = 1 << 7;

/// A full battery of three cells, 0.1 V: what INAV assumes where no voltage is said.
pub const FULL: u8 = 126;

/// What is behind the readings.
pub mod tail {
    payload! {
        little, exactly, "the end of a `simulator` request with an airspeed";
        /// Bytes of it.
        LEN;
        #[derive(Eq)]
        fields {
            /// The battery, 0.1 V.
            voltage / set_voltage: u8,
            /// Indicated airspeed, cm/s.
            airspeed / set_airspeed: u16,
            /// Failures to simulate; 0 is none.
            more_flags / set_more_flags: u8,
        }
    }

    #[cfg(test)]
    mod tests {
        use super::*;

        const GOLDEN: [u8; LEN] = [0x7e, 0xdc, 0x05, 0x03];

        fn repr() -> Repr {
            Repr { voltage: 126, airspeed: 1500, more_flags: 3 }
        }

        golden_tests!(GOLDEN, repr());
    }
}

/// Bytes of payload.
pub const LEN: usize = simulator::LEN + tail::LEN;

/// A view of the payload's bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Payload<T>(T);

impl<T: AsRef<[u8]>> Payload<T> {
    /// Takes `bytes` as the payload of a request with an airspeed.
    ///
    /// # Errors
    /// [`Error::Length`] unless there are exactly [`LEN`] bytes.
    pub fn new_checked(bytes: T) -> Result<Self, Error> {
        Error::check_length(LEN, bytes.as_ref().len())?;
        Ok(Self(bytes))
    }
}

/// Plain values of a request with an airspeed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Repr {
    /// What the sensors read.
    pub readings: simulator::Repr,
    /// The airspeed, and what stands beside it.
    pub tail: tail::Repr,
}

impl Repr {
    /// Reads every field of a view.
    pub fn parse<T: AsRef<[u8]>>(payload: &Payload<T>) -> Self {
        let (readings, tail) = payload.0.as_ref().split_at(simulator::LEN);
        // The view has the bytes of both.
        let readings = simulator::Payload::new_checked(readings).map(|view| simulator::Repr::parse(&view));
        let tail = tail::Payload::new_checked(tail).map(|view| tail::Repr::parse(&view));
        Self { readings: readings.unwrap_or_default(), tail: tail.unwrap_or_default() }
    }

    /// Bytes that [`emit`](Self::emit) writes.
    pub const fn buffer_len(&self) -> usize {
        LEN
    }

    /// Writes every field into a view.
    pub fn emit<T: AsRef<[u8]> + AsMut<[u8]>>(&self, payload: &mut Payload<T>) {
        let (readings, tail) = payload.0.as_mut().split_at_mut(simulator::LEN);
        if let (Ok(mut readings), Ok(mut tail)) =
            (simulator::Payload::new_checked(readings), tail::Payload::new_checked(tail))
        {
            self.readings.emit(&mut readings);
            self.tail.emit(&mut tail);
        }
    }
}
