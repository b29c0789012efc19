//! Chips with a flaw that a driver's check must notice.

use std::ops::Range;

use ratetable_protocols::chip::{Channel, Chip, Registers, Samples, Setting, Tally};

/// What is wrong with a chip.
#[derive(Clone, Debug)]
pub enum Flaw {
    /// These bits of this register arrive inverted, in the bank that is selected by this value: another full scale.
    Scale { bank: u8, register: u8, bits: u8 },
    /// The bytes of each word of these registers are swapped.
    Swapped(Range<u8>),
    /// These bits of this register always read as 1.
    Stuck { register: u8, bits: u8 },
}

/// A chip with a flaw at its main address.
pub struct Flawed<C> {
    chip: C,
    address: u8,
    /// The register that selects a bank, and what was last written there.
    banks: Option<u8>,
    bank: u8,
    /// The register of a FIFO.
    fifo: Option<u8>,
    flaw: Flaw,
}

impl<C: Chip> Flawed<C> {
    /// This chip at this address.
    pub fn new(chip: C, address: u8, flaw: Flaw) -> Flawed<C> {
        Flawed { chip, address, banks: None, bank: 0, fifo: None, flaw }
    }

    /// The register that selects its banks.
    pub fn banks(self, register: u8) -> Flawed<C> {
        Flawed { banks: Some(register), ..self }
    }

    /// The register of its FIFO.
    pub fn fifo(self, register: u8) -> Flawed<C> {
        Flawed { fifo: Some(register), ..self }
    }

    fn inner(&mut self) -> &mut dyn Registers {
        self.chip.at(self.address).expect("its own address")
    }
}

impl<C: Chip> Registers for Flawed<C> {
    fn pointer(&mut self) -> &mut u8 {
        self.inner().pointer()
    }

    fn write(&mut self, t_ns: u64, register: u8, value: u8) {
        if Some(register) == self.banks {
            self.bank = value;
        }
        let flipped = match self.flaw {
            Flaw::Scale { bank, register: here, bits } if (bank, here) == (self.bank, register) => bits,
            _ => 0,
        };
        self.inner().write(t_ns, register, value ^ flipped);
    }

    fn read(&mut self, t_ns: u64, register: u8) -> u8 {
        match self.flaw.clone() {
            Flaw::Scale { bank, register: here, bits } if (bank, here) == (self.bank, register) => {
                self.inner().read(t_ns, register) ^ bits
            }
            Flaw::Swapped(registers) if self.bank == 0 && registers.contains(&register) => {
                let other = registers.start + ((register - registers.start) ^ 1);
                self.inner().read(t_ns, other)
            }
            Flaw::Stuck { register: here, bits } if self.bank == 0 && here == register => {
                self.inner().read(t_ns, register) | bits
            }
            _ => self.inner().read(t_ns, register),
        }
    }

    fn after(&self, register: u8) -> u8 {
        if self.fifo == Some(register) { register } else { register.wrapping_add(1) & 0x7f }
    }
}

impl<C: Chip> Chip for Flawed<C> {
    fn at(&mut self, address: u8) -> Option<&mut dyn Registers> {
        if address == self.address { Some(self) } else { self.chip.at(address) }
    }

    fn setting(&self, channel: Channel) -> Option<Setting> {
        self.chip.setting(channel)
    }

    fn sample(&mut self, t_ns: u64, samples: &Samples) {
        self.chip.sample(t_ns, samples);
    }

    fn tally(&self, channel: Channel) -> Tally {
        self.chip.tally(channel)
    }
}
