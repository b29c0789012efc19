//! AKM's magnetometers: the AK8963 in an MPU-9250, the AK09916 in an ICM-20948.
//!
//! Sources: MS1356-E-02 (AK8963), MS1553-E-01 (AK09916). A sample that a driver has begun to read stays as it is until the
//! driver reads ST2, whatever is measured meanwhile. A measurement asked for once takes the next sample that comes.
//!
//! ```
//! use ratetable_protocols::chip::{self, Channel, Chip, Samples, ak::Ak};
//!
//! let mut chip = Ak::ak8963([128; 3]);
//! let registers = chip.at(0x0c).expect("its only address");
//! chip::write(registers, 0, &[0x0a, 0x16], false); // continuous measurement at 100 Hz, 16 bits
//! assert_eq!(chip.setting(Channel::Mag).and_then(|setting| setting.rate), Some((100, 1)));
//! chip.sample(10_000_000, &Samples { mag: Some([1, 2, -3]), ..Samples::default() });
//! let registers = chip.at(0x0c).expect("its only address");
//! let mut read = [0; 8];
//! chip::write(registers, 11_000_000, &[0x02], false);
//! chip::read(registers, 11_000_000, &mut read);
//! assert_eq!(read, [0x01, 1, 0, 2, 0, 0xfd, 0xff, 0x10]);
//! ```

use super::{Channel, Chip, Latest, Registers, Samples, Setting, Tally};

/// Where both answer, 7 bits.
pub const ADDRESS: u8 = 0x0c;

const DATA_READY: u8 = 0x01;
const OVERRUN: u8 = 0x02;
const OVERFLOW: u8 = 0x08;
const SIXTEEN_BIT: u8 = 0x10;
/// The AK8963's access to its fuse ROM.
const FUSE_ROM: u8 = 0x0f;
/// Single measurement, of both.
const SINGLE: u8 = 1;
/// |x| + |y| + |z| in counts from which the sensor overflows: 4912 µT at 0.15 µT (MS1356-E-02 p. 9 and 24, MS1553-E-01).
const MOST: i32 = 32747;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Model {
    Ak8963,
    Ak09916,
}

/// Where a model has its registers.
struct Map {
    st1: u8,
    data: u8,
    st2: u8,
    mode: u8,
    reset: u8,
}

/// An AK8963 or AK09916.
#[derive(Clone, Debug)]
pub struct Ak {
    model: Model,
    asa: [u8; 3],
    pointer: u8,
    mode: u8,
    latest: Latest,
    status: u8,
    /// A driver has begun to read the sample and not yet read ST2.
    is_held: bool,
    /// What was measured meanwhile.
    next: Option<[i16; 3]>,
}

impl Ak {
    /// An AK8963 with this sensitivity adjustment (ASAX, ASAY, ASAZ).
    pub fn ak8963(asa: [u8; 3]) -> Ak {
        Ak::new(Model::Ak8963, asa)
    }

    /// An AK09916.
    pub fn ak09916() -> Ak {
        Ak::new(Model::Ak09916, [128; 3])
    }

    fn new(model: Model, asa: [u8; 3]) -> Ak {
        let latest = Latest::default();
        Ak { model, asa, pointer: 0, mode: 0, latest, status: 0, is_held: false, next: None }
    }

    const fn map(&self) -> Map {
        match self.model {
            Model::Ak8963 => Map { st1: 0x02, data: 0x03, st2: 0x09, mode: 0x0a, reset: 0x0b },
            Model::Ak09916 => Map { st1: 0x10, data: 0x11, st2: 0x18, mode: 0x31, reset: 0x32 },
        }
    }

    /// The register of the low byte of x.
    pub(super) fn data_register(&self) -> u8 {
        self.map().data
    }

    pub(super) fn latest(&mut self) -> &mut Latest {
        &mut self.latest
    }

    /// Back to how it powers on.
    pub(super) fn reset(&mut self) {
        self.latest.clear();
        *self = Ak { latest: self.latest, pointer: self.pointer, ..Ak::new(self.model, self.asa) };
    }

    fn kept(&mut self, counts: [i16; 3]) {
        self.status |= if self.status & DATA_READY != 0 { OVERRUN } else { DATA_READY };
        self.latest.put(counts, false);
    }

    fn st2(&self) -> u8 {
        let sum: i32 = self.latest.counts.iter().map(|&count| i32::from(count).abs()).sum();
        let overflow = if sum > MOST { OVERFLOW } else { 0 };
        match self.model {
            Model::Ak8963 => overflow | self.mode & SIXTEEN_BIT,
            Model::Ak09916 => overflow,
        }
    }

    /// A byte of the sample, which stays as it is until ST2 is read.
    fn data(&mut self, byte: u8) -> u8 {
        self.is_held = true;
        self.status = 0;
        self.latest.low_first(byte)
    }
}

impl Registers for Ak {
    fn pointer(&mut self) -> &mut u8 {
        &mut self.pointer
    }

    fn write(&mut self, _t_ns: u64, register: u8, value: u8) {
        let map = self.map();
        if register == map.mode {
            self.mode = value & 0x1f;
        } else if register == map.reset && value & 1 == 1 {
            self.reset();
        }
    }

    fn read(&mut self, _t_ns: u64, register: u8) -> u8 {
        let map = self.map();
        match (self.model, register) {
            (_, 0x00) => 0x48,
            (Model::Ak8963, 0x01) => 0x9a, // assumed: INFO has no documented value
            (Model::Ak09916, 0x01) => 0x09,
            (Model::Ak8963, 0x10..=0x12) if self.mode & 0x0f == FUSE_ROM => {
                self.asa[usize::from(register - 0x10)]
            }
            (_, register) if register == map.st1 => self.status,
            (_, register) if (map.data..map.data + 6).contains(&register) => self.data(register - map.data),
            (_, register) if register == map.st2 => {
                let st2 = self.st2();
                self.is_held = false;
                self.status = 0;
                if let Some(next) = self.next.take() {
                    self.kept(next);
                }
                st2
            }
            (_, register) if register == map.mode => self.mode,
            _ => 0,
        }
    }

    /// A burst goes round: 00 follows 0C, and 10 follows 12, of the AK8963 (MS1356-E-02 p. 18); 10 follows 18 of the AK09916
    /// (MS1553-E-01, sequential read).
    fn after(&self, register: u8) -> u8 {
        match (self.model, register) {
            (Model::Ak8963, 0x0c) => 0x00,
            (Model::Ak8963, 0x12) => 0x10,
            (Model::Ak09916, 0x18) => 0x10,
            (Model::Ak09916, 0x32) => 0x30,
            _ => register.wrapping_add(1),
        }
    }
}

impl Chip for Ak {
    fn at(&mut self, address: u8) -> Option<&mut dyn Registers> {
        (address == ADDRESS).then_some(self as &mut dyn Registers)
    }

    fn setting(&self, channel: Channel) -> Option<Setting> {
        let hz = match (self.model, self.mode & 0x1f & !SIXTEEN_BIT) {
            (Model::Ak8963, 2) => Some(8),
            (Model::Ak8963, 6 | SINGLE) => Some(100),
            (Model::Ak09916, 2) => Some(10),
            (Model::Ak09916, 4) => Some(20),
            (Model::Ak09916, 6) => Some(50),
            (Model::Ak09916, 8 | SINGLE) => Some(100),
            _ => None,
        };
        (channel == Channel::Mag).then_some(Setting { rate: hz.map(|hz| (hz, 1)), range: 0, filter: None })
    }

    fn sample(&mut self, _t_ns: u64, samples: &Samples) {
        let Some(counts) =
            samples.mag.filter(|_| self.setting(Channel::Mag).is_some_and(|it| it.rate.is_some()))
        else {
            return;
        };
        // With 14 bits a count is four of those with 16.
        let short = self.model == Model::Ak8963 && self.mode & SIXTEEN_BIT == 0;
        let counts = if short { counts.map(|count| ((i32::from(count) + 2) >> 2) as i16) } else { counts };
        if self.is_held {
            if self.next.replace(counts).is_some() {
                self.latest.tally.made += 1;
                self.latest.tally.missed += 1;
                self.status |= OVERRUN;
            }
        } else {
            self.kept(counts);
        }
        if self.mode & 0x0f == SINGLE {
            self.mode &= SIXTEEN_BIT;
        }
    }

    fn tally(&self, channel: Channel) -> Tally {
        if channel == Channel::Mag { self.latest.tally } else { Tally::default() }
    }

    fn interrupt(&self) -> bool {
        self.status & DATA_READY != 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chip::checks::{burst, put};

    fn mag(counts: [i16; 3]) -> Samples {
        Samples { mag: Some(counts), ..Samples::default() }
    }

    #[test]
    fn a_sample_that_is_being_read_stays_until_st2_is_read() {
        for (mut chip, mode, st1) in
            [(Ak::ak8963([128; 3]), [0x0a, 0x16], 0x02), (Ak::ak09916(), [0x31, 0x08], 0x10)]
        {
            put(&mut chip, &mode);
            chip.sample(0, &mag([1, 2, 3]));
            assert_eq!(burst::<3>(&mut chip, st1), [1, 1, 0]);
            chip.sample(0, &mag([4, 5, 6]));
            assert_eq!(burst::<5>(&mut chip, st1 + 1), [1, 0, 2, 0, 3], "still the first");
            let st2 = chip.map().st2;
            burst::<1>(&mut chip, st2);
            assert_eq!(burst::<3>(&mut chip, st1), [1, 4, 0], "ready, and the second");
            let tally = chip.tally(Channel::Mag);
            assert_eq!((tally.made, tally.read, tally.missed), (2, 2, 0));
        }
    }

    #[test]
    fn a_driver_that_never_reads_st2_gets_one_sample_for_ever() {
        let mut chip = Ak::ak8963([128; 3]);
        put(&mut chip, &[0x0a, 0x16]);
        for count in 1..100 {
            chip.sample(0, &mag([count; 3]));
            assert_eq!(burst::<2>(&mut chip, 0x03), [1, 0]);
        }
        assert!(chip.tally(Channel::Mag).missed > 90);
    }

    #[test]
    fn overrun_overflow_and_the_fuse_rom_are_as_in_the_sheet() {
        let mut chip = Ak::ak8963([176, 177, 165]);
        assert_eq!(burst::<3>(&mut chip, 0x10), [0; 3], "not in this mode");
        put(&mut chip, &[0x0a, 0x0f]);
        assert_eq!(burst::<4>(&mut chip, 0x10), [176, 177, 165, 176], "goes round");
        chip.sample(0, &mag([1; 3]));
        assert_eq!(chip.tally(Channel::Mag).made, 0, "measures nothing in that mode");
        put(&mut chip, &[0x0a, 0x16]);
        chip.sample(0, &mag([1; 3]));
        chip.sample(0, &mag([20000, -10000, 5000]));
        assert_eq!(burst::<1>(&mut chip, 0x02), [0x03], "ready, and one was skipped");
        assert_eq!(burst::<1>(&mut chip, 0x09), [0x18], "16 bits, overflow");
        put(&mut chip, &[0x0b, 0x01]);
        assert_eq!(burst::<1>(&mut chip, 0x0a), [0], "reset");
    }

    #[test]
    fn a_single_measurement_ends_in_power_down() {
        let mut chip = Ak::ak8963([128; 3]);
        put(&mut chip, &[0x0a, 0x01]);
        chip.sample(0, &mag([4, -4, 7]));
        chip.sample(0, &mag([9; 3]));
        assert_eq!(burst::<7>(&mut chip, 0x03), [1, 0, 0xff, 0xff, 2, 0, 0], "in 14 bits");
        assert_eq!(chip.setting(Channel::Mag).and_then(|setting| setting.rate), None);
    }
}
