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
        let mut schedule = Schedule { groups: Vec::new(), end };
        for (i, ticks) in sensors.into_iter().enumerate() {
            schedule.add(i, ticks, SimTime::ZERO);
        }
        schedule
    }

    fn add(&mut self, sensor: usize, ticks: Ticks, from: SimTime) {
        let k = ticks.rate.ticks_before(ticks.phase, from);
        match self.groups.iter_mut().find(|group| group.ticks == ticks && group.k == k) {
            Some(group) => group.sensors |= 1 << sensor,
            None => {
                let next = ticks.phase + ticks.rate.tick(k);
                self.groups.push(Group { ticks, sensors: 1 << sensor, k, next });
            }
        }
    }

    /// Gives a sensor other ticks, those due from `from` on, or none, in the place of those that it would still have.
    pub fn set(&mut self, sensor: usize, ticks: Option<Ticks>, from: SimTime) {
        self.groups.iter_mut().for_each(|group| group.sensors &= !(1 << sensor));
        self.groups.retain(|group| group.sensors != 0);
        if let Some(ticks) = ticks {
            self.add(sensor, ticks, from);
        }
    }

    /// Replaces what is in `times` and `sensors` by the next `count` distinct ticks before `until`, or by those that
    /// remain: when, and of which sensors.
    pub fn fill(&mut self, count: usize, until: SimTime, times: &mut Vec<SimTime>, sensors: &mut Vec<u32>) {
        times.clear();
        sensors.clear();
        let end = self.end.min(until);
        if let [group] = &mut self.groups[..] {
            let Ticks { rate, phase } = group.ticks;
            rate.extend_ticks(phase, group.k, count as u64, times);
            times.truncate(times.partition_point(|&t| t < end));
            sensors.resize(times.len(), group.sensors);
            group.k += times.len() as u64;
            group.next = group.ticks.phase + group.ticks.rate.tick(group.k);
            return;
        }
        while times.len() < count
            && let Some(due) = self.take_before(end)
        {
            times.push(due.t);
            sensors.push(due.sensors);
        }
    }

    fn take_before(&mut self, end: SimTime) -> Option<Due> {
        let t = self.groups.iter().map(|group| group.next).min().filter(|&t| t < end)?;
        let mut sensors = 0;
        for group in self.groups.iter_mut().filter(|group| group.next == t) {
            sensors |= group.sensors;
            group.k += 1;
            group.next = group.ticks.phase + group.ticks.rate.tick(group.k);
        }
        Some(Due { t, sensors })
    }
}

impl Iterator for Schedule {
    type Item = Due;

    fn next(&mut self) -> Option<Due> {
        self.take_before(self.end)
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
                schedule.fill(count, SimTime::FOREVER, &mut times, &mut masks);
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

    #[test]
    fn a_sensor_with_other_ticks_leaves_its_group_and_joins_those_that_begin_with_it() {
        let mut schedule = Schedule::new([at(1000), at(1000), at(500)], SimTime(6_000_000));
        let take = |schedule: &mut Schedule, until| {
            let (mut times, mut masks) = (Vec::new(), Vec::new());
            schedule.fill(100, SimTime(until), &mut times, &mut masks);
            times.into_iter().map(|t| t.0).zip(masks).collect::<Vec<_>>()
        };
        assert_eq!(take(&mut schedule, 2_000_000), [(0, 0b111), (1_000_000, 0b011)]);
        let (slower, from) = (Ticks { rate: Rate::hz(250), phase: SimTime(2_000_000) }, SimTime(2_000_000));
        schedule.set(0, Some(slower), from);
        schedule.set(2, Some(slower), from);
        assert_eq!(schedule.groups.len(), 2);
        assert_eq!(
            take(&mut schedule, 5_000_000),
            [(2_000_000, 0b111), (3_000_000, 0b010), (4_000_000, 0b010)]
        );
        schedule.set(1, None, SimTime(5_000_000));
        assert_eq!(take(&mut schedule, 100_000_000), [], "the next of the others is at the end");
        assert_eq!(schedule.next(), None);
    }

    #[test]
    fn sensors_that_get_the_same_ticks_at_different_times_tick_together() {
        // The ticks of this rate are no whole ns, so that counting them from each one's start would part them.
        let ticks = Ticks { rate: Rate::new(1125, 11).unwrap(), phase: SimTime::ZERO };
        let mut schedule = Schedule::new([at(1000), at(1000)], SimTime(1_000_000_000));
        let mut take = |until, set: usize| {
            schedule.fill(10_000, SimTime(until), &mut Vec::new(), &mut Vec::new());
            schedule.set(set, Some(ticks), SimTime(until));
        };
        take(20_000_000, 0);
        take(110_000_000, 1);
        assert_eq!(schedule.groups.len(), 1);
        let due: Vec<_> = schedule.collect();
        assert_eq!(due[0], Due { t: ticks.rate.tick(12), sensors: 0b11 });
        assert!(due.iter().all(|due| due.sensors == 0b11));
    }
}
