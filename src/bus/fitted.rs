//! Which chips a scene's sensors are, at which addresses, and what their counts mean.

use crate::geometry::{Body, Vector};
use crate::sensor::{Mount, SensorKind, SensorPlan, lsb};
use ratetable_protocols::chip::ak::{self, Ak};
use ratetable_protocols::chip::bmi088::Bmi088;
use ratetable_protocols::chip::bmi160::Bmi160;
use ratetable_protocols::chip::bmi270::Bmi270;
use ratetable_protocols::chip::icm20948::Icm20948;
use ratetable_protocols::chip::icm42688::Icm42688;
use ratetable_protocols::chip::lsm6dso::Lsm6dso;
use ratetable_protocols::chip::mpu::Mpu;
use ratetable_protocols::chip::{Channel, Chip};
use ratetable_protocols::mpu::registers;

/// A chip that can stand on a bus.
#[derive(Debug)]
pub struct ChipKind {
    /// The part whose data it has, as `part = "…"` names it.
    pub part: &'static str,
    /// What it senses, and where that may answer, 7 bits; the first address is the usual one. Most answer at one address
    /// for all that they sense.
    pub places: &'static [(&'static [Channel], &'static [u8])],
    /// From the axes of its gyro and accelerometer to those of its magnetometer.
    turn: fn([f64; 3]) -> [f64; 3],
    /// From an address for each of its places.
    make: fn(&[u8]) -> Box<dyn Chip + Send>,
}

impl ChipKind {
    /// What it senses.
    pub fn channels(&self) -> impl Iterator<Item = Channel> {
        self.places.iter().flat_map(|(channels, _)| channels.iter().copied())
    }

    fn has(&self, channel: Channel) -> bool {
        self.channels().any(|has| has == channel)
    }

    /// Which of its places a channel is at.
    fn place(&self, channel: Channel) -> usize {
        self.places.iter().position(|(channels, _)| channels.contains(&channel)).unwrap_or(0)
    }

    const fn new(
        part: &'static str,
        places: &'static [(&'static [Channel], &'static [u8])],
        make: fn(&[u8]) -> Box<dyn Chip + Send>,
    ) -> ChipKind {
        ChipKind { part, places, turn: |v| v, make }
    }
}

/// No adjustment of an AK8963's sensitivity.
const ASA: [u8; 3] = [128; 3];

const SIX: &[Channel] = &[Channel::Gyro, Channel::Accel];
const NINE: &[Channel] = &Channel::ALL;
const MAG: &[Channel] = &[Channel::Mag];

/// Every chip.
pub static CHIPS: &[ChipKind] = &[
    ChipKind::new("MPU-6050", &[(SIX, &[0x68, 0x69])], |at| Box::new(Mpu::mpu6050(at[0]))),
    ChipKind::new("MPU-6500", &[(SIX, &[0x68, 0x69])], |at| Box::new(Mpu::mpu6500(at[0]))),
    ChipKind {
        turn: registers::swap_mag_axes,
        ..ChipKind::new("MPU-9250", &[(NINE, &[0x68, 0x69])], |at| Box::new(Mpu::mpu9250(at[0], ASA)))
    },
    ChipKind {
        // DS-000189 figures 12 and 13.
        turn: |[x, y, z]| [x, -y, -z],
        ..ChipKind::new("ICM-20948", &[(NINE, &[0x68, 0x69])], |at| Box::new(Icm20948::new(at[0])))
    },
    ChipKind::new("ICM-42688-P", &[(SIX, &[0x68, 0x69])], |at| Box::new(Icm42688::new(at[0]))),
    ChipKind::new("BMI088", &[(&[Channel::Gyro], &[0x68, 0x69]), (&[Channel::Accel], &[0x18, 0x19])], |at| {
        Box::new(Bmi088::new(at[1], at[0]))
    }),
    ChipKind::new("BMI160", &[(SIX, &[0x68, 0x69])], |at| Box::new(Bmi160::new(at[0]))),
    ChipKind::new("BMI270", &[(SIX, &[0x68, 0x69])], |at| Box::new(Bmi270::new(at[0]))),
    ChipKind::new("LSM6DSO", &[(SIX, &[0x6a, 0x6b])], |at| Box::new(Lsm6dso::new(at[0]))),
    ChipKind::new("AK8963", &[(MAG, &[ak::ADDRESS])], |_| Box::new(Ak::ak8963(ASA))),
    ChipKind::new("AK09916", &[(MAG, &[ak::ADDRESS])], |_| Box::new(Ak::ak09916())),
];

/// A chip with the sensors of a scene that it stands for.
pub struct Fitted {
    /// What it is.
    pub kind: &'static ChipKind,
    /// Where it answers, for each of its places.
    pub addresses: Vec<u8>,
    /// Which of the scene's sensors each of its channels measures, in the order of [`Channel::ALL`].
    pub sensors: [Option<usize>; 3],
    pub(super) chip: Box<dyn Chip + Send>,
}

impl std::fmt::Display for Fitted {
    /// `MPU-9250 at 0x68 (gyro, accel, mag)`, `BMI088 at 0x68 and 0x18 (gyro, accel)`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let sensed = self.sensors.iter().zip(SensorKind::TRIADS).filter(|(sensor, _)| sensor.is_some());
        let names: Vec<_> = sensed.map(|(_, kind)| kind.name()).collect();
        let addresses: Vec<_> = self.addresses.iter().map(|address| format!("{address:#04x}")).collect();
        write!(f, "{} at {} ({})", self.kind.part, addresses.join(" and "), names.join(", "))
    }
}

impl std::fmt::Debug for Fitted {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("Fitted").field(&self.to_string()).finish()
    }
}

/// The channel of a kind of sensor.
pub(super) fn channel(kind: SensorKind) -> Option<Channel> {
    Channel::ALL.into_iter().find(|channel| SensorKind::TRIADS[*channel as usize] == kind)
}

/// The chips that these sensors are by their parts, or by `chip` where they have none.
///
/// # Errors
/// A sensor without a part, a part that is no chip of this version, an address that a chip has not or that two share.
pub fn fit(sensors: &[SensorPlan], chip: Option<&str>) -> Result<Vec<Fitted>, String> {
    let mut chips: Vec<Fitted> = Vec::new();
    let mut inside = Vec::new();
    for (i, sensor) in sensors.iter().enumerate() {
        let Some(channel) = channel(sensor.kind) else { continue };
        let kind = kind_of(sensor, channel, chip)?;
        if is_inside(kind, channel) {
            inside.push((i, sensor, kind));
        } else {
            place(&mut chips, kind, channel, (i, sensor))?;
        }
    }
    // A magnetometer that is part of a chip on the board is that one.
    for (i, sensor, kind) in inside {
        let host = chips.iter_mut().find(|it| it.kind.has(Channel::Mag) && holds(it.kind.part, kind.part));
        match host {
            Some(host) if host.sensors[Channel::Mag as usize].is_none() => {
                host.sensors[Channel::Mag as usize] = Some(i);
            }
            _ => place(&mut chips, kind, Channel::Mag, (i, sensor))?,
        }
    }
    if chips.is_empty() {
        return Err("a bus needs a gyro, an accel or a mag in the scene".into());
    }
    for (i, a) in chips.iter().enumerate() {
        if let Some(b) = chips[..i].iter().find(|b| b.addresses.iter().any(|it| a.addresses.contains(it))) {
            return Err(format!(
                "{b} and {a} answer at the same address: give one of them another `address`"
            ));
        }
    }
    Ok(chips)
}

/// What a sensor is.
fn kind_of(sensor: &SensorPlan, channel: Channel, chip: Option<&str>) -> Result<&'static ChipKind, String> {
    let kind = sensor.kind;
    let Some(part) = sensor.part.or(chip) else {
        return Err(format!(
            "[{kind}] has no part, so there is no chip for it on a bus: give it one, such as part = \"MPU-9250\", or give all of them registers without that part's errors with `chip = \"MPU-9250\"` in [[output]]: --set 'output=[{{to=\"bus@pty\",chip=\"MPU-9250\"}}]' in place of --to"
        ));
    };
    let has = |it: &&ChipKind| it.has(channel);
    CHIPS.iter().filter(has).find(|it| it.part.eq_ignore_ascii_case(part)).ok_or_else(|| {
        let mut names: Vec<_> = CHIPS.iter().filter(has).map(|it| it.part).collect();
        names.dedup();
        format!(
            "[{kind}]: this version has no registers of the {part}; a bus has those of {}",
            names.join(", ")
        )
    })
}

/// Whether it is a magnetometer that others have inside.
fn is_inside(kind: &ChipKind, channel: Channel) -> bool {
    channel == Channel::Mag && kind.channels().count() == 1
}

/// Whether a part has this magnetometer inside.
fn holds(part: &str, mag: &str) -> bool {
    crate::sensor::parts::find(mag, SensorKind::Mag).is_some_and(|found| found.names.contains(&part))
}

fn place(
    chips: &mut Vec<Fitted>,
    kind: &'static ChipKind,
    channel: Channel,
    (i, sensor): (usize, &SensorPlan),
) -> Result<(), String> {
    let (at, asked) = (kind.place(channel), sensor.address);
    let usual = kind.places[at].1;
    if let Some(address) = asked.filter(|address| !usual.contains(address)) {
        let places: Vec<_> = usual.iter().map(|address| format!("{address:#04x}")).collect();
        return Err(format!(
            "[{}]: the {} answers at {}, not at {address:#04x}",
            sensor.kind,
            kind.part,
            places.join(" or ")
        ));
    }
    // The same chip, unless another address says that it is a second one.
    let is_free = |it: &Fitted| {
        let free = std::ptr::eq(it.kind, kind) && it.sensors[channel as usize].is_none();
        let alone = kind.places[at].0.iter().all(|channel| it.sensors[*channel as usize].is_none());
        free && (alone || asked.is_none_or(|address| address == it.addresses[at]))
    };
    let chip = match chips.iter_mut().position(|it| is_free(it)) {
        Some(found) => &mut chips[found],
        None => {
            let addresses: Vec<u8> = kind.places.iter().map(|(_, usual)| usual[0]).collect();
            let chip = (kind.make)(&addresses);
            chips.push(Fitted { kind, addresses, sensors: [None; 3], chip });
            let last = chips.len() - 1;
            &mut chips[last]
        }
    };
    if let Some(address) = asked.filter(|address| *address != chip.addresses[at]) {
        chip.addresses[at] = address;
        chip.chip = (kind.make)(&chip.addresses);
    }
    chip.sensors[channel as usize] = Some(i);
    Ok(())
}

/// What a reading of a sensor is in counts on a chip's channel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    mount: Mount,
    /// The size of a count, in the sensor's unit.
    count: f64,
    turn: fn([f64; 3]) -> [f64; 3],
}

impl Scale {
    /// Of a sensor as it is set now.
    pub fn new(sensor: &SensorPlan, kind: &ChipKind) -> Scale {
        let turn = if sensor.kind == SensorKind::Mag { kind.turn } else { |v| v };
        let count = lsb(&sensor.values, sensor.kind).unwrap_or(1.0);
        Scale { mount: sensor.mount.unwrap_or_else(Mount::flu), count, turn }
    }

    /// The nearest counts, at most what fits.
    pub fn counts(&self, value: Vector<Body>) -> [i16; 3] {
        let chip = self.mount.to_chip(value).v.to_array();
        (self.turn)(chip).map(|x| registers::nearest(x / self.count))
    }
}
