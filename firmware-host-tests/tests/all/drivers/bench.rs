//! Where a driver is tested: a bus with a chip, its time, and what the chip senses. In memory the time is virtual and goes
//! on only while a driver waits. [`Emulated`](super::emulated::Emulated) has the same functions in real time.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

use ratetable_protocols::bridge::{Bridge, Client, Port};
use ratetable_protocols::chip::{Channel, Chip, Samples, Setting, Wired};

use super::bus::{Fault, I2c};
use super::{Verdict, equal};

/// What the sensing elements are given, on the chip's own axes.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sensed {
    pub gyro_dps: [f64; 3],
    pub accel_g: [f64; 3],
    pub mag_ut: [f64; 3],
    pub celsius: f64,
}

/// Counts a deg/s and a g by range, and counts a µT.
pub struct Part {
    pub gyro: &'static [f64],
    pub accel: &'static [f64],
    pub mag: f64,
}

/// A bus with one chip.
pub trait Bench {
    /// A handle to the bus.
    type Bus: I2c;

    /// Another handle to the same bus.
    fn bus(&self) -> Self::Bus;

    /// Lets so many ns pass.
    fn wait(&self, ns: u64);

    /// What is sensed from now on: this where the bench can choose, else what its scene has. Gives back what it is.
    fn show(&self, sensed: Sensed) -> Sensed;

    /// That a channel is set like this: now, or by the record of the run when it is over.
    fn is_set_as(&self, wanted: Wanted) -> Verdict;

    /// Whether time stands still between two transfers. Where it does not, a sample may come between any two.
    const STANDS_STILL: bool;

    /// Waits for the next sample of every channel.
    fn next(&self) {
        self.wait(200_000_000);
    }

    /// That a channel has this rate, range and filter.
    fn is_set(&self, channel: Channel, rate: (u32, u32), range: u8, filter: &'static str) -> Verdict {
        self.is_set_as(Wanted { channel, rate: Some(rate), range: range.into(), filter: Some(filter) })
    }

    /// That something becomes so at a look: at the first where time stands still, at one of many where it does not.
    fn comes_to<T: PartialEq + std::fmt::Debug>(
        &self,
        what: &str,
        truth: T,
        mut look: impl FnMut() -> Result<T, String>,
    ) -> Verdict {
        let mut looks = if Self::STANDS_STILL { 1 } else { 1000 };
        loop {
            let read = look()?;
            looks -= 1;
            if looks == 0 || read == truth {
                return equal(what, read, truth);
            }
        }
    }

    /// That so many have come since a wait of just so long: at least, where the wait is longer.
    fn counts(&self, what: &str, read: usize, truth: usize) -> Verdict {
        if Self::STANDS_STILL || read < truth { equal(what, read, truth) } else { Ok(()) }
    }
}

/// How a driver is to have set a channel. `None` is not looked at.
#[derive(Clone, Copy, Debug)]
pub struct Wanted {
    pub channel: Channel,
    pub rate: Option<(u32, u32)>,
    pub range: usize,
    pub filter: Option<&'static str>,
}

impl Wanted {
    fn is(&self, set: Option<Setting>) -> Verdict {
        let set = set.ok_or_else(|| format!("no {:?}", self.channel))?;
        equal("range", usize::from(set.range), self.range)?;
        equal("rate", self.rate.and(set.rate), self.rate)?;
        equal("filter", self.filter.and(set.filter), self.filter)
    }
}

struct World {
    chip: Box<dyn Chip>,
    part: &'static Part,
    t_ns: u64,
    sensed: Sensed,
}

impl World {
    /// The first time after now at which the channel has a sample.
    fn due(&self, channel: Channel) -> Option<u64> {
        let (hz, by) = self.chip.setting(channel)?.rate?;
        let second = u128::from(by) * 1_000_000_000;
        let next = u128::from(self.t_ns) * u128::from(hz) / second + 1;
        u64::try_from((next * second).div_ceil(u128::from(hz))).ok()
    }

    fn pass(&mut self, ns: u64) {
        let end = self.t_ns + ns;
        loop {
            let due = Channel::ALL.map(|channel| self.due(channel));
            let Some(now) = due.into_iter().flatten().min().filter(|due| *due <= end) else { break };
            self.t_ns = now;
            let [gyro, accel, mag] = Channel::ALL
                .map(|channel| self.counts(channel).filter(|_| due[channel as usize] == Some(now)));
            let temperature_c = Some(self.sensed.celsius);
            self.chip.sample(now, &Samples { gyro, accel, mag, temperature_c });
        }
        self.t_ns = end;
    }

    fn counts(&self, channel: Channel) -> Option<[i16; 3]> {
        let range = usize::from(self.chip.setting(channel)?.range);
        let (sensed, per_unit) = match channel {
            Channel::Gyro => (self.sensed.gyro_dps, self.part.gyro[range]),
            Channel::Accel => (self.sensed.accel_g, self.part.accel[range]),
            Channel::Mag => (self.sensed.mag_ut, self.part.mag),
        };
        Some(sensed.map(|it| (it * per_unit).round() as i16))
    }

    fn wired<T>(&mut self, transfer: impl FnOnce(&mut Wired<'_, '_>) -> T) -> T {
        transfer(&mut Wired { t_ns: self.t_ns, chips: &mut [&mut *self.chip] })
    }
}

/// A chip on a bus in memory, with virtual time.
#[derive(Clone)]
pub struct Memory(Rc<RefCell<World>>);

impl Memory {
    /// A bus with this chip.
    pub fn new(part: &'static Part, chip: Box<dyn Chip>) -> Memory {
        Memory(Rc::new(RefCell::new(World { chip, part, t_ns: 0, sensed: Sensed::default() })))
    }

    fn transfer(&self, transfer: impl FnOnce(&mut Wired<'_, '_>) -> bool) -> Result<(), Fault> {
        if self.0.borrow_mut().wired(transfer) { Ok(()) } else { Err(Fault::Nack) }
    }
}

impl I2c for Memory {
    fn write(&mut self, address: u8, bytes: &[u8]) -> Result<(), Fault> {
        self.transfer(|bus| bus.write(address, bytes, false))
    }

    fn read(&mut self, address: u8, out: &mut [u8]) -> Result<(), Fault> {
        self.transfer(|bus| bus.read(address, out))
    }

    fn write_read(&mut self, address: u8, bytes: &[u8], out: &mut [u8]) -> Result<(), Fault> {
        self.transfer(|bus| bus.write(address, bytes, false) && bus.read(address, out))
    }
}

impl Bench for Memory {
    type Bus = Memory;

    fn bus(&self) -> Memory {
        self.clone()
    }

    fn wait(&self, ns: u64) {
        self.0.borrow_mut().pass(ns);
    }

    const STANDS_STILL: bool = true;

    fn show(&self, sensed: Sensed) -> Sensed {
        self.0.borrow_mut().sensed = sensed;
        sensed
    }

    fn is_set_as(&self, wanted: Wanted) -> Verdict {
        wanted.is(self.0.borrow().chip.setting(wanted.channel))
    }
}

/// The same chip behind an emulated bridge, whose bytes go through memory.
pub struct Bridged {
    memory: Memory,
    bridge: Rc<RefCell<Bridge>>,
}

impl Bridged {
    /// A bus with this chip.
    pub fn new(part: &'static Part, chip: Box<dyn Chip>) -> Bridged {
        Bridged { memory: Memory::new(part, chip), bridge: Rc::new(RefCell::new(Bridge::new())) }
    }
}

/// The wire to a bridge.
pub struct Wire {
    memory: Memory,
    bridge: Rc<RefCell<Bridge>>,
    replies: VecDeque<u8>,
}

impl Port for Wire {
    type Error = &'static str;

    fn send(&mut self, bytes: &[u8]) -> Result<(), Self::Error> {
        let Wire { memory, bridge, replies } = self;
        let mut reply = |bytes: &[u8]| replies.extend(bytes);
        memory.0.borrow_mut().wired(|bus| bridge.borrow_mut().feed(bytes, bus, &mut reply));
        Ok(())
    }

    fn receive(&mut self, bytes: &mut [u8]) -> Result<(), Self::Error> {
        bytes
            .iter_mut()
            .try_for_each(|byte| self.replies.pop_front().map(|reply| *byte = reply))
            .ok_or("silence")
    }
}

impl Bench for Bridged {
    type Bus = Client<Wire>;

    fn bus(&self) -> Client<Wire> {
        let (memory, bridge) = (self.memory.clone(), self.bridge.clone());
        Client::new(Wire { memory, bridge, replies: VecDeque::new() })
    }

    fn wait(&self, ns: u64) {
        self.memory.wait(ns);
    }

    const STANDS_STILL: bool = true;

    fn show(&self, sensed: Sensed) -> Sensed {
        self.memory.show(sensed)
    }

    fn is_set_as(&self, wanted: Wanted) -> Verdict {
        self.memory.is_set_as(wanted)
    }
}
