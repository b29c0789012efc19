//! A scene's chips at work: time goes on, a driver reads and writes, the sensors follow.

use super::fitted::{Fitted, Scale, channel};
use super::following::Change;
use super::reads::Reads;
use crate::player::{Moment, Player};
use crate::scene::Plan;
use crate::sensor::SensorPlan;
use crate::time::SimTime;
use ratetable_protocols::bridge::Bus;
use ratetable_protocols::chip::{self, Channel, Samples, Tally, read, write};
use std::convert::Infallible;

/// Ticks computed at a time: few, as a driver may set a sensor to something else at any of them.
const BLOCK: usize = 64;

/// A scene's chips on a bus.
pub struct Board<'a> {
    plan: &'a Plan,
    player: Player<'a>,
    chips: Vec<Fitted>,
    /// What each channel of each chip was last set to.
    set: Vec<[Option<chip::Setting>; 3]>,
    /// Each sensor of the scene as it is set now, with the scale of its counts.
    sensors: Vec<(SensorPlan, Option<Scale>)>,
    reads: Vec<Reads>,
    changes: Vec<Change>,
    told: usize,
    /// Stream time now, and when the scene began.
    now: SimTime,
    start: Option<SimTime>,
    /// The vehicle rests for so long after a first sample is read.
    rest: SimTime,
    first_read: Option<SimTime>,
    trouble: Option<String>,
}

impl<'a> Board<'a> {
    /// The chips of `plan`, whose vehicle is held as in `still` until so long after a first sample is read.
    ///
    /// # Errors
    /// A chip's part lacks what the chip powers on with.
    pub fn new(
        plan: &'a Plan,
        still: &'a Plan,
        chips: Vec<Fitted>,
        rest: SimTime,
    ) -> Result<Board<'a>, String> {
        let sensors: Vec<_> = plan.sensors.iter().map(|sensor| (sensor.clone(), None)).collect();
        let mut board = Board {
            plan,
            player: Player::new(still, SimTime::FOREVER, BLOCK),
            set: vec![[None; 3]; chips.len()],
            reads: vec![Reads::default(); sensors.len()],
            sensors,
            chips,
            changes: Vec::new(),
            told: 0,
            now: SimTime::ZERO,
            start: None,
            rest,
            first_read: None,
            trouble: None,
        };
        board.follow(SimTime::ZERO);
        board.checked()?;
        Ok(board)
    }

    /// Plays up to this stream time: what is measured then is in the chips.
    ///
    /// # Errors
    /// A chip was set to something that its part's data lacks.
    pub fn advance(&mut self, now: SimTime) -> Result<(), String> {
        if let Some(at) =
            self.first_read.map(|read| read + self.rest).filter(|&at| self.start.is_none() && at <= now)
        {
            self.play(at);
            self.begin(at);
        }
        self.play(now);
        self.checked()
    }

    fn checked(&mut self) -> Result<(), String> {
        self.trouble.take().map_or(Ok(()), Err)
    }

    fn play(&mut self, now: SimTime) {
        self.now = now.max(self.now);
        let start = self.start.unwrap_or(SimTime::ZERO);
        let Board { player, chips, sensors, .. } = self;
        let until = self.now - start + SimTime(1);
        while let Ok(true) = player.play_block_before(until, |moment| {
            chips.iter_mut().for_each(|chip| hand_over(chip, &moment, start, sensors));
            Ok::<(), Infallible>(())
        }) {}
        if self.start.is_some() {
            self.look();
        }
    }

    /// Lets the scene begin now.
    pub fn begin(&mut self, at: SimTime) {
        if self.start.is_some() {
            return;
        }
        self.start = Some(at);
        self.player = Player::new(self.plan, SimTime::FOREVER, BLOCK);
        self.changes.clear();
        self.told = 0;
        self.set.fill([None; 3]);
        self.follow(SimTime::ZERO);
        for (i, reads) in self.reads.iter_mut().enumerate() {
            reads.begin(tally(&self.chips, i));
        }
    }

    /// Whether the scene has begun.
    pub fn has_begun(&self) -> bool {
        self.start.is_some()
    }

    /// Stream time at which the scene began.
    pub fn start(&self) -> Option<SimTime> {
        self.start
    }

    /// How a driver has read each sensor of the scene.
    pub fn reads(&self) -> &[Reads] {
        &self.reads
    }

    /// What the driver has set the sensors to since the scene began: as it found them first, then every change.
    pub fn changes(&self) -> &[Change] {
        &self.changes
    }

    /// The changes that this was not asked for yet.
    pub fn news(&mut self) -> &[Change] {
        let from = std::mem::replace(&mut self.told, self.changes.len());
        &self.changes[from.min(self.changes.len())..]
    }

    /// What drivers have turned on that a chip does not do.
    pub fn lacks(&self) -> impl Iterator<Item = (&'static str, &'static str)> {
        self.chips.iter().filter_map(|it| Some((it.kind.part, it.chip.lacks()?)))
    }

    /// Its chips.
    pub fn chips(&self) -> &[Fitted] {
        &self.chips
    }

    /// Sets each sensor to what its chip's registers say, from `start` on.
    fn follow(&mut self, start: SimTime) {
        for i in 0..self.chips.len() {
            for channel in Channel::ALL {
                let chip = &self.chips[i];
                let Some((sensor, set)) = chip.sensors[channel as usize]
                    .zip(chip.chip.setting(channel))
                    .filter(|(_, set)| self.set[i][channel as usize] != Some(*set))
                else {
                    continue;
                };
                self.set[i][channel as usize] = Some(set);
                let change = Change::new(self.plan, sensor, chip.kind.part, start, set);
                let kind = chip.kind;
                let took = change.and_then(|change| {
                    self.player.set(sensor, &change.setting).map_err(|error| error.message)?;
                    Ok(change)
                });
                match took {
                    Ok(change) => {
                        let (plan, scale) = &mut self.sensors[sensor];
                        plan.values = change.setting.values.clone();
                        *scale = Some(Scale::new(plan, kind));
                        self.changes.push(change);
                    }
                    Err(why) => self.trouble = Some(format!("{}: {why}", self.chips[i])),
                }
            }
        }
    }

    /// After a transfer: follows the chips' registers, and counts what was read.
    fn after(&mut self) {
        let start = self.now - self.start.unwrap_or(SimTime::ZERO) + SimTime(1);
        self.follow(start);
        if self.start.is_some() {
            return self.look();
        }
        let read = |tally: Tally| tally.read + tally.again > 0;
        if self.first_read.is_none() && (0..self.reads.len()).any(|sensor| read(tally(&self.chips, sensor))) {
            self.first_read = Some(self.now);
            if self.rest <= SimTime::ZERO {
                self.begin(self.now);
            }
        }
    }

    fn look(&mut self) {
        let t = self.now - self.start.unwrap_or(SimTime::ZERO);
        for (i, reads) in self.reads.iter_mut().enumerate() {
            reads.look(t, tally(&self.chips, i));
        }
    }
}

impl Bus for Board<'_> {
    fn write(&mut self, address: u8, bytes: &[u8], joined: bool) -> bool {
        let now = self.now.0 as u64;
        let found = self.chips.iter_mut().find_map(|it| it.chip.at(address));
        let is_there = found.map(|registers| write(registers, now, bytes, joined)).is_some();
        self.after();
        is_there
    }

    fn read(&mut self, address: u8, out: &mut [u8]) -> bool {
        let now = self.now.0 as u64;
        let found = self.chips.iter_mut().find_map(|it| it.chip.at(address));
        let is_there = found.map(|registers| read(registers, now, out)).is_some();
        self.after();
        is_there
    }

    fn pins(&self) -> u8 {
        let lines = self.chips.iter().take(8).enumerate();
        lines.fold(0, |pins, (i, it)| pins | u8::from(it.chip.interrupt()) << i)
    }
}

/// What became of a sensor's samples in its chip.
fn tally(chips: &[Fitted], sensor: usize) -> Tally {
    let of = |it: &Fitted| {
        let channel =
            Channel::ALL.into_iter().find(|channel| it.sensors[*channel as usize] == Some(sensor))?;
        Some(it.chip.tally(channel))
    };
    chips.iter().find_map(of).unwrap_or_default()
}

/// Hands a chip its samples of a moment of the scene, which began at `start`.
fn hand_over(
    chip: &mut Fitted,
    moment: &Moment<'_>,
    start: SimTime,
    sensors: &[(SensorPlan, Option<Scale>)],
) {
    // The thermometer is the gyro's and the accelerometer's.
    let is_mag_alone = chip.sensors[..2].iter().all(Option::is_none);
    let mut samples = Samples::default();
    let mut any = false;
    for reading in moment.readings {
        let Some(channel) =
            channel(reading.kind).filter(|channel| chip.sensors[*channel as usize] == Some(reading.sensor))
        else {
            continue;
        };
        let Some((body, scale)) = reading.body().zip(sensors[reading.sensor].1) else { continue };
        let counts = Some(scale.counts(body.value));
        match channel {
            Channel::Gyro => samples.gyro = counts,
            Channel::Accel => samples.accel = counts,
            Channel::Mag => samples.mag = counts,
        }
        if channel != Channel::Mag || is_mag_alone {
            samples.temperature_c = Some(reading.temperature);
        }
        any = true;
    }
    if any {
        chip.chip.sample((start + moment.t).0 as u64, &samples);
    }
}
