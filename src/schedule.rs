//! Which sensors are due when: every distinct tick in order, exact.
//!
//! ```
//! use ratetable::{schedule::{Schedule, Ticks}, time::{Rate, SimTime}};
//!
//! let ticks = [Rate::hz(4), Rate::hz(2)].map(|rate| Ticks { rate, phase: SimTime::ZERO });
//! let due: Vec<u32> = Schedule::new(ticks, SimTime(1_000_000_000)).map(|due| due.sensors).collect();
//! assert_eq!(due, [0b11, 0b01, 0b11, 0b01]);
//! ```

use crate::time::{Rate, SimTime};

/// A sensor's ticks: its rate and when tick 0 is due.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ticks {
    /// Output data rate.
    pub rate: Rate,
    /// When tick 0 is due.
    pub phase: SimTime,
}

/// One distinct time and the sensors due then.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Due {
    /// When.
    pub t: SimTime,
    /// Bit i is set when sensor i is due.
    pub sensors: u32,
}

/// Iterates over the distinct ticks in `[0, end)` of at most 32 sensors.
#[derive(Clone, Debug)]
pub struct Schedule {
    groups: Vec<Group>,
    end: SimTime,
}

/// Sensors with the same ticks.
#[derive(Clone, Debug)]
struct Group {
    ticks: Ticks,
    sensors: u32,
    k: u64,
    next: SimTime,
}

impl Schedule {
    /// Of these sensors, up to but not including `end`.
    pub fn new(sensors: impl IntoIterator<Item = Ticks>, end: SimTime) -> Schedule {
        let mut groups: Vec<Group> = Vec::new();
        for (i, ticks) in sensors.into_iter().enumerate() {
            match groups.iter_mut().find(|group| group.ticks == ticks) {
                Some(group) => group.sensors |= 1 << i,
                None => groups.push(Group { ticks, sensors: 1 << i, k: 0, next: ticks.phase }),
            }
        }
        Schedule { groups, end }
    }
}

impl Schedule {
    /// Replaces what is in `times` and `sensors` by the next `count` distinct ticks, or by those that remain: when, and
    /// of which sensors.
    pub fn fill(&mut self, count: usize, times: &mut Vec<SimTime>, sensors: &mut Vec<u32>) {
        times.clear();
        sensors.clear();
        if let [group] = &mut self.groups[..] {
            let Ticks { rate, phase } = group.ticks;
            rate.extend_ticks(phase, group.k, count as u64, times);
            times.truncate(times.partition_point(|&t| t < self.end));
            sensors.resize(times.len(), group.sensors);
            group.k += times.len() as u64;
            group.next = group.ticks.phase + group.ticks.rate.tick(group.k);
            return;
        }
        for due in self.take(count) {
            times.push(due.t);
            sensors.push(due.sensors);
        }
    }
}

impl Iterator for Schedule {
    type Item = Due;

    fn next(&mut self) -> Option<Due> {
        let t = self.groups.iter().map(|group| group.next).min().filter(|&t| t < self.end)?;
        let mut sensors = 0;
        for group in self.groups.iter_mut().filter(|group| group.next == t) {
            sensors |= group.sensors;
            group.k += 1;
            group.next = group.ticks.phase + group.ticks.rate.tick(group.k);
        }
        Some(Due { t, sensors })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(hz: u32) -> Ticks {
        Ticks { rate: Rate::hz(hz), phase: SimTime::ZERO }
    }

    #[test]
    fn ticks_that_coincide_are_one_due_time() {
        let due: Vec<_> = Schedule::new([at(1000), at(500)], SimTime(3_000_000)).collect();
        let expected = [(0, 0b11), (1_000_000, 0b01), (2_000_000, 0b11)];
        assert_eq!(due, expected.map(|(t, sensors)| Due { t: SimTime(t), sensors }));
    }

    #[test]
    fn ticks_by_the_block_are_those_one_by_one() {
        let end = SimTime(1_000_000_007);
        let odd = Ticks { rate: Rate::new(400, 3).unwrap(), phase: SimTime(1234) };
        for sensors in [vec![at(1125), at(1125)], vec![odd], vec![at(1000), odd, at(50)], vec![]] {
            let one_by_one: Vec<_> = Schedule::new(sensors.clone(), end).collect();
            let (mut schedule, mut all) = (Schedule::new(sensors, end), Vec::new());
            let (mut times, mut masks) = (Vec::new(), Vec::new());
            for count in [1, 2, 64, 300].into_iter().cycle() {
                schedule.fill(count, &mut times, &mut masks);
                if times.is_empty() {
                    break;
                }
                assert!(times.len() == masks.len() && times.len() <= count);
                all.extend(times.iter().zip(&masks).map(|(&t, &sensors)| Due { t, sensors }));
            }
            assert_eq!(all, one_by_one);
        }
    }

    #[test]
    fn every_sensor_gets_exactly_its_own_ticks_in_order() {
        let sensors = [
            at(8000),
            Ticks { rate: Rate::new(400, 3).unwrap(), phase: SimTime(1234) },
            Ticks { rate: Rate::hz(1125), phase: SimTime::ZERO },
        ];
        let end = SimTime(2_000_000_001);
        let mut counts = [0u64; 3];
        let mut last = SimTime(-1);
        for due in Schedule::new(sensors, end) {
            assert!(due.t > last && due.t < end);
            last = due.t;
            for (i, ticks) in sensors.iter().enumerate() {
                if due.sensors >> i & 1 == 1 {
                    assert_eq!(due.t, ticks.phase + ticks.rate.tick(counts[i]));
                    counts[i] += 1;
                }
            }
        }
        for (count, ticks) in counts.iter().zip(sensors) {
            assert_eq!(*count, ticks.rate.ticks_before(ticks.phase, end));
        }
    }
}
