//! What holds of every inertial chip, as properties, and the words in which its tests are written.
//!
//! A property takes what differs from chip to chip: registers, byte order and how it is reset.

extern crate std;

use super::{Channel, Chip, Registers, Samples, Setting, Tally, Wired, read, write};
use proptest::prelude::*;
use proptest::test_runner::TestCaseError;
use std::collections::VecDeque;
use std::vec::Vec;

/// From one step of a driver to the next.
const STEP_NS: u64 = 1_000_000;
/// The longest burst of the properties, bytes.
const LONGEST: usize = 64;

/// Writes a message at time 0.
pub(super) fn put(registers: &mut dyn Registers, bytes: &[u8]) {
    write(registers, 0, bytes, false);
}

/// Reads from a register on, at time 0.
pub(super) fn burst<const N: usize>(registers: &mut dyn Registers, register: u8) -> [u8; N] {
    burst_at(registers, 0, register)
}

/// Reads from a register on.
pub(super) fn burst_at<const N: usize>(registers: &mut dyn Registers, t_ns: u64, register: u8) -> [u8; N] {
    let mut bytes = [0; N];
    write(registers, t_ns, &[register], false);
    read(registers, t_ns, &mut bytes);
    bytes
}

/// Reads one register of a chip on a bus.
pub(super) fn get(bus: &mut Wired, address: u8, register: u8) -> u8 {
    let mut byte = [0];
    assert!(bus.write(address, &[register], false) && bus.read(address, &mut byte));
    byte[0]
}

pub(super) fn both(gyro: [i16; 3], accel: [i16; 3]) -> Samples {
    Samples { gyro: Some(gyro), accel: Some(accel), ..Samples::default() }
}

/// A sample whose every component is `k`.
pub(super) fn kth(k: i16) -> Samples {
    both([k; 3], [k; 3])
}

/// The six bytes of a sample, high byte first.
pub(super) fn words(counts: [i16; 3]) -> [u8; 6] {
    let [x, y, z] = counts.map(i16::to_be_bytes);
    [x[0], x[1], y[0], y[1], z[0], z[1]]
}

/// A channel that is on.
pub(super) fn set(rate: (u32, u32), range: u8, filter: Option<&'static str>) -> Setting {
    Setting { rate: Some(rate), range, filter }
}

/// The rates of gyro and accelerometer.
pub(super) fn rates(chip: &dyn Chip) -> [Option<(u32, u32)>; 2] {
    [Channel::Gyro, Channel::Accel].map(|channel| chip.setting(channel).and_then(|setting| setting.rate))
}

/// What happens to a chip next.
#[derive(Clone, Debug)]
pub(super) enum Step {
    /// Its driver writes these bytes, or goes on with the message before.
    Write([u8; 4], bool),
    /// Its driver reads from this register on.
    Read(u8),
    /// Its driver reads from the FIFO.
    ReadFifo,
    /// One channel alone has a sample.
    Alone(Channel),
    /// Every channel has one.
    All,
}

/// Anything that may happen to a chip, each at one of its addresses.
pub(super) fn steps() -> impl Strategy<Value = Vec<(u8, Step)>> {
    let step = prop_oneof![
        1 => any::<([u8; 4], bool)>().prop_map(|(bytes, joined)| Step::Write(bytes, joined)),
        1 => any::<u8>().prop_map(Step::Read),
        1 => Just(Step::ReadFifo),
        1 => prop::sample::select(&Channel::ALL[..2]).prop_map(Step::Alone),
        3 => Just(Step::All),
    ];
    prop::collection::vec((any::<u8>(), step), 1..400)
}

/// An address of a chip, and what its driver knows of it.
pub(super) struct Port<'a> {
    pub address: u8,
    /// The data register of its FIFO, and how many bytes a driver reads from there at once.
    pub fifo: (u8, usize),
    /// Messages that reset what answers there.
    pub reset: &'a [&'a [u8]],
}

/// Whatever is written and read, nothing panics, and every sample was read, missed or lost, or waits. After a reset none
/// of gyro and accelerometer waits.
pub(super) fn every_sample_is_accounted_for(
    chip: &mut dyn Chip,
    ports: &[Port],
    steps: &[(u8, Step)],
) -> Result<(), TestCaseError> {
    for (k, (port, step)) in steps.iter().enumerate() {
        let (t_ns, port, k) = (k as u64 * STEP_NS, &ports[usize::from(*port) % ports.len()], k as i16);
        match step {
            Step::Write(bytes, joined) => write(at(chip, port.address), t_ns, bytes, *joined),
            Step::Read(register) => read_at(at(chip, port.address), t_ns, (*register, 30)),
            Step::ReadFifo => read_at(at(chip, port.address), t_ns, port.fifo),
            Step::Alone(Channel::Gyro) => chip.sample(t_ns, &Samples { accel: None, ..kth(k) }),
            Step::Alone(_) => chip.sample(t_ns, &Samples { gyro: None, ..kth(k) }),
            Step::All => chip.sample(t_ns, &Samples { mag: Some([k; 3]), ..kth(k) }),
        }
        none_is_counted_twice(chip)?;
    }
    for port in ports {
        port.reset.iter().for_each(|message| put(at(chip, port.address), message));
    }
    none_is_counted_twice(chip)?;
    for channel in [Channel::Gyro, Channel::Accel] {
        let Tally { made, read, missed, overflowed, .. } = chip.tally(channel);
        prop_assert_eq!(read + missed + overflowed, made, "{:?} {:?}", channel, chip.tally(channel));
    }
    Ok(())
}

fn none_is_counted_twice(chip: &dyn Chip) -> Result<(), TestCaseError> {
    for channel in Channel::ALL {
        let Tally { made, read, missed, overflowed, .. } = chip.tally(channel);
        prop_assert!(read + missed + overflowed <= made, "{channel:?} {:?}", chip.tally(channel));
    }
    Ok(())
}

fn at(chip: &mut dyn Chip, address: u8) -> &mut dyn Registers {
    chip.at(address).expect("its own address")
}

fn read_at(registers: &mut dyn Registers, t_ns: u64, (register, len): (u8, usize)) {
    write(registers, t_ns, &[register], false);
    read(registers, t_ns, &mut [0; LONGEST][..len]);
}

/// Registers that hold the newest samples.
pub(super) struct Data<'a> {
    pub address: u8,
    /// Where a burst begins.
    pub register: u8,
    /// The channels in it, and at which byte the x of each begins.
    pub parts: &'a [(Channel, usize)],
    pub order: fn(i16) -> [u8; 2],
    /// Every count before the first sample.
    pub at_first: i16,
}

impl Data<'_> {
    fn check(&self, chip: &mut dyn Chip, newest: &Samples) -> Result<(), TestCaseError> {
        let len = self.parts.iter().map(|(_, start)| start + 6).max().unwrap_or(0);
        let mut bytes = [0; LONGEST];
        let registers = at(chip, self.address);
        put(registers, &[self.register]);
        read(registers, 0, &mut bytes[..len]);
        for &(channel, start) in self.parts {
            let counts = newest.channel(channel).unwrap_or([self.at_first; 3]).map(self.order);
            prop_assert_eq!(&bytes[start..start + 6], counts.as_flattened(), "{:?}", channel);
        }
        Ok(())
    }
}

/// Against a simple model: bursts at any time are the newest sample, whole. `data` are all that hold gyro and accelerometer,
/// and `paces` so many samples before each burst.
pub(super) fn bursts_at_any_pace_are_whole_samples_in_order(
    chip: &mut dyn Chip,
    data: &[Data],
    paces: &[u8],
) -> Result<(), TestCaseError> {
    let (mut k, mut newest, mut fresh, mut expected) = (0, Samples::default(), false, Tally::default());
    for &samples in paces {
        for _ in 0..samples {
            k += 1;
            expected.made += 1;
            expected.missed += u64::from(fresh);
            fresh = true;
            newest = both([k, -k, k], [-k, k, -k]);
            chip.sample(0, &newest);
        }
        for data in data {
            data.check(chip, &newest)?;
        }
        if k > 0 {
            expected.read += u64::from(fresh);
            expected.again += u64::from(!fresh);
        }
        fresh = false;
        for channel in [Channel::Gyro, Channel::Accel] {
            prop_assert_eq!(chip.tally(channel), expected, "{:?}", channel);
        }
    }
    Ok(())
}

/// A FIFO that keeps the newest frames of one channel.
pub(super) struct Backlog<C> {
    /// Frames that have room.
    pub room: usize,
    /// Frames that wait, as the chip tells it.
    pub waiting: fn(&mut C) -> usize,
    /// Reads one frame: its x.
    pub next: fn(&mut C) -> i16,
    /// What `next` gives where none waits.
    pub empty: i16,
}

/// Against a queue: what leaves the FIFO is what entered it, oldest first. `paces` are samples, and frames that are then
/// read.
pub(super) fn the_fifo_keeps_the_newest_frames_in_order<C: Chip>(
    chip: &mut C,
    fifo: &Backlog<C>,
    paces: &[(usize, usize)],
) -> Result<(), TestCaseError> {
    let (mut k, mut model) = (0i16, VecDeque::new());
    for &(samples, frames) in paces {
        for _ in 0..samples {
            k += 1;
            model.push_back(k);
            chip.sample(0, &kth(k));
        }
        while model.len() > fifo.room {
            model.pop_front();
        }
        prop_assert_eq!((fifo.waiting)(chip), model.len());
        for _ in 0..frames {
            prop_assert_eq!((fifo.next)(chip), model.pop_front().unwrap_or(fifo.empty));
        }
    }
    Ok(())
}

/// Chips that are wrong: each property finds it.
mod tests {
    use super::*;
    use crate::chip::mpu::Mpu;

    /// An MPU-6050 whose samples and tallies pass through these.
    struct Wrong(Mpu, fn(Samples) -> Samples, fn(Tally) -> Tally);

    impl Wrong {
        fn new(sample: fn(Samples) -> Samples, tally: fn(Tally) -> Tally) -> Wrong {
            let mut chip = Mpu::mpu6050(0x68);
            put(&mut chip, &[0x6b, 0]);
            Wrong(chip, sample, tally)
        }
    }

    impl Chip for Wrong {
        fn at(&mut self, address: u8) -> Option<&mut dyn Registers> {
            self.0.at(address)
        }

        fn setting(&self, channel: Channel) -> Option<Setting> {
            self.0.setting(channel)
        }

        fn sample(&mut self, t_ns: u64, samples: &Samples) {
            self.0.sample(t_ns, &self.1(*samples));
        }

        fn tally(&self, channel: Channel) -> Tally {
            self.2(self.0.tally(channel))
        }
    }

    #[test]
    fn a_sample_that_is_lost_or_counted_twice_is_found() {
        let port = Port { address: 0x68, fifo: (0x74, 30), reset: &[&[0x6b, 0x80]] };
        let steps = [(0, Step::All), (0, Step::Read(0x3b)), (0, Step::All)];
        for (tally, is_right) in [
            ((|it| it) as fn(Tally) -> Tally, true),
            (|it| Tally { missed: 0, ..it }, false),
            (|it| Tally { missed: it.missed + it.read, ..it }, false),
        ] {
            let mut chip = Wrong::new(|it| it, tally);
            let checked = every_sample_is_accounted_for(&mut chip, core::slice::from_ref(&port), &steps);
            assert_eq!(checked.is_ok(), is_right, "{checked:?}");
        }
    }

    #[test]
    fn a_burst_of_another_sample_or_order_is_found() {
        let swapped = |it: Samples| Samples { accel: it.accel.map(|[x, y, z]| [y, x, z]), ..it };
        for (sample, order, is_right) in [
            ((|it| it) as fn(Samples) -> Samples, i16::to_be_bytes as fn(i16) -> [u8; 2], true),
            (|it| it, i16::to_le_bytes, false),
            (swapped, i16::to_be_bytes, false),
        ] {
            let parts = [(Channel::Accel, 0), (Channel::Gyro, 8)];
            let data = Data { address: 0x68, register: 0x3b, parts: &parts, order, at_first: 0 };
            let mut chip = Wrong::new(sample, |it| it);
            let checked = bursts_at_any_pace_are_whole_samples_in_order(&mut chip, &[data], &[0, 1, 3, 0]);
            assert_eq!(checked.is_ok(), is_right, "{checked:?}");
        }
    }

    #[test]
    fn a_frame_that_is_out_of_order_is_found() {
        for (sample, room, is_right) in [
            ((|it| it) as fn(Samples) -> Samples, 170, true),
            (|it| it, 169, false),
            (|_| kth(9), 170, false),
        ] {
            let mut chip = Wrong::new(sample, |it| it);
            put(at(&mut chip, 0x68), &[0x6a, 0x44]);
            put(at(&mut chip, 0x68), &[0x23, 0x08]);
            let fifo = Backlog {
                room,
                waiting: |chip| usize::from(u16::from_be_bytes(burst(at(chip, 0x68), 0x72))) / 6,
                next: |chip: &mut Wrong| {
                    let [high, low, ..] = burst::<6>(at(chip, 0x68), 0x74);
                    i16::from_be_bytes([high, low])
                },
                empty: 0,
            };
            let checked = the_fifo_keeps_the_newest_frames_in_order(&mut chip, &fifo, &[(170, 3), (2, 4)]);
            assert_eq!(checked.is_ok(), is_right, "{checked:?}");
        }
    }
}
