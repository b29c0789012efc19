//! Inertial chips as their drivers see them: registers that a bus reads and writes.
//!
//! A [`Chip`] has no clock, no I/O and no heap. Whoever owns it hands in the time and the newest [`Samples`] in counts,
//! and passes on what a bus master writes and reads. A chip never makes a sample: its [`Setting`] says at which rate,
//! full scale and filter its driver wants them. One file a device; each register's meaning names its sheet.
//!
//! A read is answered at one moment, so that a burst never mixes two samples.
//!
//! ```
//! use ratetable_protocols::chip::{Channel, Chip, Samples, Wired, mpu::Mpu};
//!
//! let mut chip = Mpu::mpu6050(0x68);
//! let mut bus = Wired { t_ns: 0, chips: &mut [&mut chip] };
//! let mut who = [0];
//! assert!(bus.write(0x68, &[0x75], false) && bus.read(0x68, &mut who));
//! assert_eq!(who, [0x68]);
//! assert!(bus.write(0x68, &[0x6b, 0x00], false), "out of sleep");
//! assert!(!bus.write(0x69, &[0x75], false), "nobody answers there");
//! assert_eq!(chip.setting(Channel::Gyro).and_then(|setting| setting.rate), Some((8000, 1)));
//! chip.sample(0, &Samples { gyro: Some([1, -2, 3]), ..Samples::default() });
//! let (mut bus, mut gyro) = (Wired { t_ns: 1_000, chips: &mut [&mut chip] }, [0; 6]);
//! assert!(bus.write(0x68, &[0x43], false) && bus.read(0x68, &mut gyro));
//! assert_eq!(gyro, [0, 1, 0xff, 0xfe, 0, 3]);
//! ```

pub mod ak;
pub mod bmi088;
pub mod bmi160;
pub mod bmi270;
mod bosch;
#[cfg(test)]
mod checks;
mod fifo;
pub mod icm20948;
pub mod icm42688;
mod latest;
pub mod lsm6dso;
mod master;
pub mod mpu;

pub use latest::Tally;

use fifo::Fifo;
use latest::Latest;

/// What a chip senses along three axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// Angular rate.
    Gyro,
    /// Specific force.
    Accel,
    /// Magnetic field.
    Mag,
}

impl Channel {
    /// Every channel, in this order.
    pub const ALL: [Channel; 3] = [Channel::Gyro, Channel::Accel, Channel::Mag];
}

/// How a channel is set: what holds from its next sample on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Setting {
    /// Samples a second as a fraction; `None` while it takes none: asleep, in standby or off.
    pub rate: Option<(u32, u32)>,
    /// Its full scale: 0 is the smallest that the sheet lists for the channel.
    pub range: u8,
    /// Its low-pass filter by the name in the part's data file, such as `DLPF 3`; `None` where it has none to choose.
    pub filter: Option<&'static str>,
}

/// What the sensing elements measured at one moment, in counts of the present full scale on the chip's own axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Samples {
    /// Angular rate, where the gyro has a sample at this moment.
    pub gyro: Option<[i16; 3]>,
    /// Specific force: +1 g on an axis that points up at rest.
    pub accel: Option<[i16; 3]>,
    /// Magnetic field, on the magnetometer's own axes.
    pub mag: Option<[i16; 3]>,
    /// Temperature of the die, °C; `None` is as before, 25 °C at first.
    pub temperature_c: Option<f64>,
}

impl Samples {
    /// The counts of one channel.
    pub fn channel(&self, channel: Channel) -> Option<[i16; 3]> {
        match channel {
            Channel::Gyro => self.gyro,
            Channel::Accel => self.accel,
            Channel::Mag => self.mag,
        }
    }
}

/// A map of registers at one address of the bus.
pub trait Registers {
    /// The register that the next byte is read from or written to.
    fn pointer(&mut self) -> &mut u8;

    /// Writes a register at this time, ns.
    fn write(&mut self, t_ns: u64, register: u8, value: u8);

    /// Reads a register at this time, ns, with what reading does to it.
    fn read(&mut self, t_ns: u64, register: u8) -> u8;

    /// A read begins: a FIFO may repeat or lose the frame of which the read before left a part.
    fn begin_read(&mut self) {}

    /// The register after this one in a burst: a FIFO's own address stays.
    fn after(&self, register: u8) -> u8 {
        register.wrapping_add(1)
    }
}

/// A chip on a bus.
pub trait Chip {
    /// The registers that answer at this 7-bit address now, if any.
    fn at(&mut self, address: u8) -> Option<&mut dyn Registers>;

    /// How a channel is set; `None` for one that the chip has not.
    fn setting(&self, channel: Channel) -> Option<Setting>;

    /// Takes what was measured at this time, ns; a channel that is off takes nothing.
    fn sample(&mut self, t_ns: u64, samples: &Samples);

    /// What became of the channel's samples.
    fn tally(&self, channel: Channel) -> Tally;

    /// Whether its first interrupt line is active.
    fn interrupt(&self) -> bool {
        false
    }

    /// Something that its driver has turned on and that is not modelled: what, and what happens instead.
    fn lacks(&self) -> Option<&'static str> {
        None
    }
}

/// Chips on one bus at one moment.
pub struct Wired<'a, 'b> {
    /// Now, ns.
    pub t_ns: u64,
    /// The chips; the first that answers at an address is the one.
    pub chips: &'a mut [&'b mut dyn Chip],
}

impl Wired<'_, '_> {
    /// Writes to the chip at a 7-bit address: the register, then its bytes. `joined` goes on with the write before, as two
    /// messages of a transfer without a start between them do. Whether somebody acknowledged.
    pub fn write(&mut self, address: u8, bytes: &[u8], joined: bool) -> bool {
        let found = self.chips.iter_mut().find_map(|chip| chip.at(address));
        found.map(|registers| write(registers, self.t_ns, bytes, joined)).is_some()
    }

    /// Reads from the chip at an address, from the register at which its pointer is. Whether somebody acknowledged.
    pub fn read(&mut self, address: u8, out: &mut [u8]) -> bool {
        let found = self.chips.iter_mut().find_map(|chip| chip.at(address));
        found.map(|registers| read(registers, self.t_ns, out)).is_some()
    }
}

/// Writes a message to a map of registers: the register's address first, unless it goes on with the message before.
pub fn write(registers: &mut dyn Registers, t_ns: u64, bytes: &[u8], joined: bool) {
    let values = match bytes {
        [register, values @ ..] if !joined => {
            *registers.pointer() = *register;
            values
        }
        values => values,
    };
    for &value in values {
        let register = *registers.pointer();
        registers.write(t_ns, register, value);
        *registers.pointer() = registers.after(register);
    }
}

/// Reads as many bytes as there is room for, from the pointer on.
pub fn read(registers: &mut dyn Registers, t_ns: u64, out: &mut [u8]) {
    registers.begin_read();
    for byte in out {
        let register = *registers.pointer();
        *byte = registers.read(t_ns, register);
        *registers.pointer() = registers.after(register);
    }
}

/// The samples of gyro and accelerometer that a chip takes: none of a channel that is off.
fn taken(chip: &impl Chip, samples: &Samples) -> [Option<[i16; 3]>; 2] {
    [Channel::Gyro, Channel::Accel].map(|channel| {
        samples
            .channel(channel)
            .filter(|_| chip.setting(channel).is_some_and(|setting| setting.rate.is_some()))
    })
}

/// The nearest count, clipped to what fits.
fn temperature(celsius: f64, zero_c: f64, per_c: f64) -> i16 {
    crate::mpu::registers::nearest((celsius - zero_c) * per_c)
}

/// Counts moved by so many each, clipped to what fits.
fn shifted(counts: [i16; 3], by: [i32; 3]) -> [i16; 3] {
    let mut moved = counts;
    for (count, by) in moved.iter_mut().zip(by) {
        *count = (i32::from(*count) + by).clamp(i32::from(i16::MIN), i32::from(i16::MAX)) as i16;
    }
    moved
}
