//! The I²C master inside an MPU or ICM: what it copies from the magnetometer at each sample, and single transfers.

use super::ak::{self, Ak};
use super::fifo::Frame;
use super::{Channel, Registers, read, write};

/// One of the four slaves that are read or written at each sample.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Slave {
    /// Bit 7 reads.
    pub address: u8,
    pub register: u8,
    /// Bit 7 enables, bit 6 swaps bytes, bit 5 leaves the register out, bit 4 groups, bits 3:0 are the length.
    pub control: u8,
    /// The byte to write.
    pub out: u8,
}

/// The external sensor data, and which of it is the magnetometer's newest sample.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct External {
    pub bytes: [u8; 24],
    pub len: usize,
    /// Where the magnetometer's low byte of x is.
    mag: Option<usize>,
    /// Whether that sample is new since the transfer before.
    is_new: bool,
    /// The copy of its sample, for counting what the driver reads.
    copy: super::Latest,
}

impl External {
    /// As after the master's reset; what was counted stays.
    pub fn reset(&mut self) {
        let mut copy = self.copy;
        copy.clear();
        *self = External { copy, ..External::default() };
    }

    /// Lets each enabled slave transfer, at time `t_ns`; gives back bit i where slave i did not acknowledge. Bit i of `queued`
    /// is whether the FIFO takes what slave i reads.
    pub fn run(&mut self, t_ns: u64, slaves: &[Slave; 4], queued: u8, mut aux: Option<&mut Ak>) -> u8 {
        let (mut missing, mut at) = (0, 0);
        (self.mag, self.is_new) = (None, false);
        for (i, slave) in slaves.iter().enumerate().filter(|(_, slave)| slave.control & 0x80 != 0) {
            let len = usize::from(slave.control & 0x0f).min(self.bytes.len() - at);
            let Some(aux) = aux.as_deref_mut().filter(|_| slave.address & 0x7f == ak::ADDRESS) else {
                missing |= 1 << i;
                at += if slave.address & 0x80 != 0 { len } else { 0 };
                continue;
            };
            if slave.address & 0x80 == 0 {
                write(aux, t_ns, &[slave.register, slave.out], false);
                continue;
            }
            let register = if slave.control & 0x20 == 0 { slave.register } else { *aux.pointer() };
            self.copy_from(aux, t_ns, register, at..at + len, queued & 1 << i != 0);
            if slave.control & 0x40 != 0 {
                swap(&mut self.bytes[at..at + len], slave.control & 0x10 != 0);
            }
            at += len;
        }
        self.len = at;
        missing
    }

    fn copy_from(
        &mut self,
        aux: &mut Ak,
        t_ns: u64,
        register: u8,
        to: core::ops::Range<usize>,
        queued: bool,
    ) {
        let before = aux.latest().tally;
        write(aux, t_ns, &[register], false);
        read(aux, t_ns, &mut self.bytes[to.clone()]);
        let data = usize::from(aux.data_register().wrapping_sub(register));
        if data < to.len() {
            self.mag = Some(to.start + data);
        }
        // Not the driver but this master has read it: the driver reads the copy.
        let latest = aux.latest();
        let copied = latest.tally.read > before.read;
        latest.tally = super::Tally { read: before.read, again: before.again, ..latest.tally };
        if copied {
            self.copy.put(latest.counts, queued && data + 6 <= to.len());
            self.is_new = true;
        }
    }

    /// Adds some of its bytes to what enters the FIFO.
    pub fn add_to(&self, frame: &mut Frame, bytes: core::ops::Range<usize>) {
        let end = self.mag.map(|mag| mag + 6).filter(|&end| bytes.start + 6 <= end && end <= bytes.end);
        let split = end.unwrap_or(bytes.start);
        frame.add(&self.bytes[bytes.start..split]);
        frame.is_sample(Channel::Mag, 6, self.is_new && end.is_some());
        frame.add(&self.bytes[split..bytes.end]);
    }

    /// What became of the magnetometer's samples in the FIFO.
    pub const fn tally_of_fifo(&mut self) -> &mut super::Tally {
        &mut self.copy.tally
    }

    /// Byte `i` as a driver reads it.
    pub fn read(&mut self, i: usize) -> u8 {
        if let Some(byte) = self.mag.and_then(|mag| i.checked_sub(mag)).filter(|byte| *byte < 6) {
            self.copy.low_first(byte as u8);
        }
        self.bytes.get(i).copied().unwrap_or(0)
    }

    /// What became of the magnetometer's samples: those that the driver read itself, and those it read as copies.
    pub fn tally(&self, direct: super::Tally) -> super::Tally {
        let copy = self.copy.tally;
        super::Tally {
            made: direct.made,
            read: direct.read + copy.read,
            again: direct.again + copy.again,
            missed: direct.missed + copy.missed,
            overflowed: direct.overflowed,
        }
    }
}

/// Swaps the bytes of each word; words begin at odd addresses where `odd`.
fn swap(bytes: &mut [u8], odd: bool) {
    let from = usize::from(odd).min(bytes.len());
    bytes[from..].chunks_exact_mut(2).for_each(|word| word.swap(0, 1));
}

/// A single transfer of slave 4: the byte read, 0 of a write; `None` where nobody acknowledged.
pub(super) fn single(t_ns: u64, slave: Slave, aux: Option<&mut Ak>) -> Option<u8> {
    let aux = aux.filter(|_| slave.address & 0x7f == ak::ADDRESS)?;
    if slave.address & 0x80 == 0 {
        write(aux, t_ns, &[slave.register, slave.out], false);
        return Some(0);
    }
    let mut byte = [0];
    write(aux, t_ns, &[slave.register], false);
    read(aux, t_ns, &mut byte);
    Some(byte[0])
}
