//! What happens to a controller in the middle of a run: it stops, stalls or restarts.
//!
//! Measured on firmware: a killed INAV gave 499 answers of 5000, a stalled one 732 of 1000, a PX4 that restarted within
//! 4 s was judged by 873 answers of 2500.

use super::{Firmware, Make, Record, Settings};

/// What happens, and when, µs of the firmware's own clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mishap {
    /// From then on it says nothing and takes nothing.
    Stops {
        /// When.
        at_us: u64,
    },
    /// It says nothing and takes nothing for a while.
    Stalls {
        /// When.
        at_us: u64,
        /// For how long.
        for_us: u64,
    },
    /// It boots anew, and is silent meanwhile.
    Restarts {
        /// When.
        at_us: u64,
        /// For how long it boots.
        for_us: u64,
    },
}

/// A firmware that meets with a mishap.
pub struct Unlucky {
    make: Make,
    settings: Settings,
    inner: Box<dyn Firmware + Send>,
    mishap: Mishap,
    /// When the present firmware booted.
    booted_us: u64,
}

impl Unlucky {
    /// A firmware of that make.
    pub fn new(make: Make, settings: &Settings, mishap: Mishap) -> Self {
        Self { make, settings: settings.clone(), inner: make.firmware(settings), mishap, booted_us: 0 }
    }

    /// Whether it works at that time; a restart that is over boots another firmware.
    fn works(&mut self, now_us: u64) -> bool {
        match self.mishap {
            Mishap::Stops { at_us } => now_us < at_us,
            Mishap::Stalls { at_us, for_us } => !(at_us..at_us + for_us).contains(&now_us),
            Mishap::Restarts { at_us, for_us } => {
                if now_us >= at_us + for_us && self.booted_us == 0 {
                    self.booted_us = at_us + for_us;
                    self.inner = self.make.firmware(&self.settings);
                }
                now_us < at_us || self.booted_us > 0
            }
        }
    }
}

impl Firmware for Unlucky {
    fn receive(&mut self, bytes: &[u8], now_us: u64, out: &mut Vec<u8>) {
        if self.works(now_us) {
            self.inner.receive(bytes, now_us - self.booted_us, out);
        }
    }

    fn turn(&mut self, now_us: u64, out: &mut Vec<u8>) {
        if self.works(now_us) {
            self.inner.turn(now_us - self.booted_us, out);
        }
    }

    fn record(&self) -> &Record {
        self.inner.record()
    }
}
