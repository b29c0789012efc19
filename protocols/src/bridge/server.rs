//! The bridge's end: commands in, transfers on a bus, replies out.

use super::{
    MAX_MESSAGE, READ_PINS, READ_REGISTER, START, STATUS, STOP, Status, WRITE_PINS, WRITE_REGISTER, baud,
};
use crate::chip::Wired;

/// A bus of chips, as a master sees it.
pub trait Bus {
    /// Writes to the chip at a 7-bit address; `joined` goes on with the write before. Whether it acknowledged.
    fn write(&mut self, address: u8, bytes: &[u8], joined: bool) -> bool;

    /// Reads from the chip at an address. Whether it acknowledged.
    fn read(&mut self, address: u8, out: &mut [u8]) -> bool;

    /// What the bridge's pins read: bit i is the interrupt line of chip i, where it is an input.
    fn pins(&self) -> u8 {
        0
    }
}

impl Bus for Wired<'_, '_> {
    fn write(&mut self, address: u8, bytes: &[u8], joined: bool) -> bool {
        Wired::write(self, address, bytes, joined)
    }

    fn read(&mut self, address: u8, out: &mut [u8]) -> bool {
        Wired::read(self, address, out)
    }

    fn pins(&self) -> u8 {
        let lines = self.chips.iter().take(8).enumerate();
        lines.fold(0, |pins, (i, chip)| pins | u8::from(chip.interrupt()) << i)
    }
}

/// What a bridge has done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Transfers that ended.
    pub transfers: u64,
    /// Those that some chip did not acknowledge.
    pub refused: u64,
    /// Bytes that no command begins with, and commands cut short.
    pub strange: u64,
}

/// What is expected next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// A command.
    Idle,
    /// The address of a message.
    Address,
    /// The length of a message to this address as sent.
    Count(u8),
    /// So many more bytes of a message for this address.
    Data { address: u8, left: u8 },
    /// Another message, or the transfer's end.
    Next,
    /// A register to read, or the end.
    ReadRegister,
    /// A register to write, or the end.
    WriteRegister,
    /// The value of a register.
    Value(u8),
    /// The value of the pins.
    Pins,
    /// The end of a command that does this.
    End,
}

/// A bridge between a UART and a bus.
#[derive(Clone, Debug)]
pub struct Bridge {
    state: State,
    data: [u8; MAX_MESSAGE],
    len: usize,
    registers: [u8; 16],
    /// The address of the write before in this transfer, which another one would go on with.
    written: Option<u8>,
    /// Whether every message of this transfer was acknowledged.
    acknowledged: bool,
    /// The speed that a client set, not yet told.
    speed: Option<u32>,
    last_address: Option<u8>,
    counts: Counts,
}

impl Default for Bridge {
    fn default() -> Self {
        Self::new()
    }
}

impl Bridge {
    /// As it powers on.
    pub const fn new() -> Self {
        let mut registers = [0; 16];
        registers[0] = 0xf0; // 7372800/(16 + 0x2f0) = 9600 baud
        registers[1] = 0x02;
        registers[7] = 0x13; // 97 kHz
        registers[STATUS as usize] = Status::Done as u8;
        Self {
            state: State::Idle,
            data: [0; MAX_MESSAGE],
            len: 0,
            registers,
            written: None,
            acknowledged: true,
            speed: None,
            last_address: None,
            counts: Counts { transfers: 0, refused: 0, strange: 0 },
        }
    }

    /// Takes the bytes of a client; what it replies goes to `reply`, at once.
    pub fn feed(&mut self, bytes: &[u8], bus: &mut impl Bus, reply: &mut impl FnMut(&[u8])) {
        for &byte in bytes {
            self.step(byte, bus, reply);
        }
    }

    /// Forgets a command that was cut short: after a pause, or with a new client. Whether there was one.
    pub fn forget(&mut self) -> bool {
        let cut = !matches!(self.state, State::Idle);
        self.counts.strange += u64::from(cut);
        (self.state, self.written) = (State::Idle, None);
        cut
    }

    /// What it has done so far.
    pub const fn counts(&self) -> Counts {
        self.counts
    }

    /// The speed that a client has set since this was asked last, baud: it goes on at that one.
    pub const fn take_speed(&mut self) -> Option<u32> {
        self.speed.take()
    }

    /// The 7-bit address that nobody acknowledged in the last refused transfer, once.
    pub const fn take_refused(&mut self) -> Option<u8> {
        self.last_address.take()
    }

    fn step(&mut self, byte: u8, bus: &mut impl Bus, reply: &mut impl FnMut(&[u8])) {
        self.state = match self.state {
            State::Idle => {
                if byte == READ_PINS {
                    reply(&[bus.pins()]);
                }
                self.command(byte)
            }
            State::Address => State::Count(byte),
            State::Count(address) if address & 1 == 1 => self.read(address, byte, bus, reply),
            State::Count(address) => {
                self.len = 0;
                self.take_in(State::Data { address, left: byte }, bus)
            }
            State::Data { address, left } => {
                self.data[self.len] = byte;
                self.len += 1;
                self.take_in(State::Data { address, left: left - 1 }, bus)
            }
            State::Next => match byte {
                START => State::Address,
                STOP => self.end(),
                _ => self.strange(),
            },
            State::ReadRegister => match byte {
                STOP => State::Idle,
                register => {
                    reply(&[self.register(register)]);
                    State::ReadRegister
                }
            },
            State::WriteRegister => match byte {
                STOP => State::Idle,
                register => State::Value(register),
            },
            State::Value(register) => {
                self.set(register, byte);
                State::WriteRegister
            }
            // No chip of ours has a pin that a bridge would drive.
            State::Pins => State::End,
            State::End => match byte {
                STOP => State::Idle,
                _ => self.strange(),
            },
        };
    }

    fn command(&mut self, byte: u8) -> State {
        self.written = None;
        self.acknowledged = true;
        match byte {
            START => State::Address,
            READ_REGISTER => State::ReadRegister,
            WRITE_REGISTER => State::WriteRegister,
            WRITE_PINS => State::Pins,
            READ_PINS => State::End,
            _ => self.strange(),
        }
    }

    fn strange(&mut self) -> State {
        self.counts.strange += 1;
        State::Idle
    }

    /// Goes on with a write, and makes it when it is whole.
    fn take_in(&mut self, state: State, bus: &mut impl Bus) -> State {
        let State::Data { address, left: 0 } = state else { return state };
        let joined = self.written == Some(address);
        let is_there = bus.write(address >> 1, &self.data[..self.len], joined);
        self.note(address, is_there);
        self.written = Some(address);
        State::Next
    }

    /// Reads, and sends back as many bytes as were asked for: FF where nobody drives the bus.
    fn read(&mut self, address: u8, count: u8, bus: &mut impl Bus, reply: &mut impl FnMut(&[u8])) -> State {
        let out = &mut self.data[..usize::from(count)];
        out.fill(0xff);
        // A write before it that nobody acknowledged has ended the transfer.
        let is_there = self.acknowledged && bus.read(address >> 1, out);
        if count > 0 {
            reply(out);
        }
        self.note(address, is_there);
        self.written = None;
        State::Next
    }

    fn note(&mut self, address: u8, is_there: bool) {
        if !is_there {
            self.acknowledged = false;
            self.last_address = Some(address >> 1);
        }
    }

    fn end(&mut self) -> State {
        self.counts.transfers += 1;
        self.counts.refused += u64::from(!self.acknowledged);
        let status = if self.acknowledged { Status::Done } else { Status::NoAddress };
        self.registers[usize::from(STATUS)] = status as u8;
        State::Idle
    }

    fn register(&self, register: u8) -> u8 {
        self.registers.get(usize::from(register)).copied().unwrap_or(0)
    }

    fn set(&mut self, register: u8, value: u8) {
        if let Some(held) = self.registers.get_mut(usize::from(register)).filter(|_| register != STATUS) {
            *held = value;
        }
        if register == 1 {
            self.speed = Some(baud(u16::from_le_bytes([self.registers[0], self.registers[1]])));
        }
    }
}

#[cfg(test)]
mod tests;
