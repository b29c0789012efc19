//! BMI088: two chips in one package, an accelerometer and a gyro, each with its own address, FIFO and interrupt lines.
//!
//! Source: BST-BMI088-DS001, revision 1.9. On this bus no byte precedes what is read; that is so on SPI alone. Self-tests
//! change nothing that is measured ([`Chip::lacks`] tells of them).
//!
//! ```
//! use ratetable_protocols::chip::{Channel, Chip, Wired, bmi088::Bmi088};
//!
//! let mut chip = Bmi088::new(0x18, 0x68);
//! let mut bus = Wired { t_ns: 0, chips: &mut [&mut chip] };
//! assert!(bus.write(0x18, &[0x7d, 0x04], false), "ACC_PWR_CTRL: on");
//! assert!(bus.write(0x68, &[0x0f, 0x02, 0x03], false), "GYRO_RANGE ±500 °/s, GYRO_BANDWIDTH 400 Hz");
//! let gyro = chip.setting(Channel::Gyro).expect("it has one");
//! assert_eq!((gyro.rate, gyro.range, gyro.filter), (Some((400, 1)), 2, Some("BW 47")));
//! assert_eq!(chip.setting(Channel::Accel).and_then(|accel| accel.rate), Some((100, 1)));
//! ```

mod accel;
mod gyro;

use super::{Channel, Chip, Registers, Samples, Setting, Tally};
use accel::Accel;
use gyro::Gyro;

/// A BMI088 at its two addresses.
#[derive(Clone, Debug)]
pub struct Bmi088 {
    addresses: [u8; 2],
    accel: Accel,
    gyro: Gyro,
}

impl Bmi088 {
    /// An accelerometer at 0x18 or 0x19 and a gyro at 0x68 or 0x69.
    pub fn new(accel: u8, gyro: u8) -> Bmi088 {
        Bmi088 { addresses: [accel, gyro], accel: Accel::new(), gyro: Gyro::new() }
    }
}

impl Chip for Bmi088 {
    fn at(&mut self, address: u8) -> Option<&mut dyn Registers> {
        let [accel, gyro] = self.addresses;
        match address {
            _ if address == accel => Some(&mut self.accel),
            _ if address == gyro => Some(&mut self.gyro),
            _ => None,
        }
    }

    fn setting(&self, channel: Channel) -> Option<Setting> {
        match channel {
            Channel::Gyro => Some(self.gyro.setting()),
            Channel::Accel => Some(self.accel.setting()),
            Channel::Mag => None,
        }
    }

    fn sample(&mut self, t_ns: u64, samples: &Samples) {
        self.accel.sample(samples);
        self.gyro.sample(t_ns, samples);
    }

    fn tally(&self, channel: Channel) -> Tally {
        match channel {
            Channel::Gyro => self.gyro.tally(),
            Channel::Accel => self.accel.tally(),
            Channel::Mag => Tally::default(),
        }
    }

    /// INT1 of the accelerometer or INT3 of the gyro.
    fn interrupt(&self) -> bool {
        self.accel.interrupt() || self.gyro.interrupt()
    }

    fn lacks(&self) -> Option<&'static str> {
        self.accel.lacks().or(self.gyro.lacks())
    }
}

#[cfg(test)]
mod tests;
