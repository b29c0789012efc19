//! ArduPilot (`AP_ExternalAHRS_InertialLabs`) and PX4 (`ilabs`) with an Inertial Labs unit: they only listen, and each
//! sample is stamped when its frame is handled.
//!
//! It shares no code with the emulator's codec: frames are cut out of the bytes here, as those drivers do (read in
//! ArduPilot 4.7-dev and PX4 main of 2026-08). Both drop a frame with an id that they do not know, and one with bytes
//! that belong to no id.

use super::validator::Validator;
use super::{Firmware, Own, Record, Settings};
use crate::sample::Sample;

/// The start of a frame: two bytes, the type of message, which message.
const START: [u8; 4] = [0xaa, 0x55, 0x01, 0x95];
/// The start and the length.
const HEADER_LEN: usize = 6;
/// Bytes that the length does not count.
const UNCOUNTED_LEN: usize = 2;
const SUM_LEN: usize = 2;

/// Metres a second squared in the unit's g.
const G: f64 = 9.8106;
/// µT in a count of 10 nT.
const UT_PER_COUNT: f64 = 0.01;
/// PX4 takes a count for a hundredth of what it is.
const PX4_MAG: f64 = 0.01;
/// For so long PX4 waits until its buffer is full; then it drops what is held, µs.
const PX4_PATIENCE_US: u64 = 500_000;
/// The status bit of a unit whose alignment failed: PX4 then uses nothing of it.
const ALIGNMENT_FAILED: u16 = 0x0001;

/// Whose driver it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Driver {
    Ardupilot,
    Px4,
}

impl Driver {
    /// Bytes of its buffer: no longer frame is taken.
    const fn buffer_len(self) -> usize {
        match self {
            Self::Ardupilot => 256,
            Self::Px4 => 250,
        }
    }
}

/// A firmware and its driver.
pub struct Ilabs {
    driver: Driver,
    /// What has come of the next frame; with PX4 of those after it too.
    held: Vec<u8>,
    /// Since when its buffer is being filled, µs.
    since_us: u64,
    own: Own,
    record: Record,
    gyro: Validator,
    accel: Validator,
}

/// What a frame tells of the sensors, in body axes.
#[derive(Debug, Default)]
struct Told {
    time_ms: Option<u32>,
    /// rad/s, m/s², µT.
    gyro: Option<[f32; 3]>,
    accel: Option<[f32; 3]>,
    mag: Option<[f32; 3]>,
    has_attitude: bool,
    status: u16,
}

impl Ilabs {
    /// ArduPilot, just booted.
    pub fn ardupilot(settings: &Settings) -> Self {
        Self::new(Driver::Ardupilot, settings)
    }

    /// PX4, just booted.
    pub fn px4(settings: &Settings) -> Self {
        Self::new(Driver::Px4, settings)
    }

    fn new(driver: Driver, settings: &Settings) -> Self {
        Self {
            driver,
            held: Vec::new(),
            since_us: 0,
            own: Own::new(settings.ahrs, settings.declination_rad),
            record: Record::default(),
            gyro: Validator::default(),
            accel: Validator::default(),
        }
    }

    /// Handles what is held, if there is enough of it: PX4 reads its whole buffer full before it looks.
    fn handle(&mut self, now_us: u64) {
        loop {
            let enough = match self.driver {
                Driver::Ardupilot => HEADER_LEN,
                Driver::Px4 => self.driver.buffer_len(),
            };
            if self.held.len() < enough {
                return;
            }
            self.since_us = now_us;
            let Some(len) = self.frame_len() else {
                self.lose_step();
                continue;
            };
            let Some(frame) = self.held.get(..len) else { return };
            let sum_at = len - SUM_LEN;
            let sum = frame[UNCOUNTED_LEN..sum_at].iter().fold(0_u16, |sum, &b| sum.wrapping_add(b.into()));
            if sum.to_le_bytes() != frame[sum_at..] {
                self.lose_step();
                continue;
            }
            self.record.counts.packets += 1;
            match told(&frame[HEADER_LEN..sum_at], self.driver) {
                Some(told) => self.feel(&told, now_us),
                None => self.record.counts.refused += 1,
            }
            self.held.drain(..len);
        }
    }

    /// Bytes of the frame that is held, if one is.
    fn frame_len(&self) -> Option<usize> {
        let counted = usize::from(u16::from_le_bytes([self.held[4], self.held[5]]));
        let len = UNCOUNTED_LEN + counted;
        let fits = (HEADER_LEN + 3 + SUM_LEN..=self.driver.buffer_len()).contains(&len);
        (self.held.starts_with(&START) && fits).then_some(len)
    }

    /// Drops a false start, and all up to the next that may be one.
    fn lose_step(&mut self) {
        self.record.counts.damaged += 1;
        let next = self.held[1..].windows(2).position(|pair| pair == &START[..2]);
        match next {
            Some(at) => drop(self.held.drain(..=at)),
            // The first byte of one may be the last that has come.
            None if self.held.last() == Some(&START[0]) => drop(self.held.drain(..self.held.len() - 1)),
            None => self.held.clear(),
        }
    }

    /// Takes what a frame tells, as of now.
    fn feel(&mut self, told: &Told, now_us: u64) {
        self.record.counts.foreign += u64::from(told.has_attitude);
        // ArduPilot takes an inertial sample where one frame has both.
        let (Some(gyro), Some(accel)) = (told.gyro, told.accel) else {
            self.record.counts.refused += 1;
            return;
        };
        if self.driver == Driver::Px4 && told.status & ALIGNMENT_FAILED != 0 {
            self.record.counts.refused += 1;
            return;
        }
        self.record.counts.samples += 1;
        let fresh = |validator: &mut Validator, value: [f32; 3], stale: &mut u64| {
            let used = self.driver != Driver::Px4 || validator.take(value, now_us);
            *stale += u64::from(!used);
            used.then(|| value.map(f64::from))
        };
        let stale = &mut self.record.counts.stale;
        let sample = Sample {
            t_us: now_us,
            gyro: fresh(&mut self.gyro, gyro, stale),
            accel: fresh(&mut self.accel, accel, stale),
            mag: told.mag.map(|field| field.map(f64::from)),
        };
        self.own.take(&sample, told.time_ms.map(|ms| u64::from(ms) * 1000), &mut self.record);
    }
}

impl Firmware for Ilabs {
    fn receive(&mut self, bytes: &[u8], now_us: u64, _out: &mut Vec<u8>) {
        if self.driver == Driver::Px4 && now_us.saturating_sub(self.since_us) > PX4_PATIENCE_US {
            self.held.clear();
            self.since_us = now_us;
        }
        for &byte in bytes {
            self.held.push(byte);
            self.handle(now_us);
        }
    }

    fn turn(&mut self, now_us: u64, _out: &mut Vec<u8>) {
        let silent = [&mut self.gyro, &mut self.accel].map(|validator| validator.times_out(now_us));
        self.record.counts.timeouts += u64::from(silent.contains(&true));
    }

    fn record(&self) -> &Record {
        &self.record
    }
}

/// Reads ids and data; `None` where the driver drops the frame.
fn told(payload: &[u8], driver: Driver) -> Option<Told> {
    let (&count, rest) = payload.split_first()?;
    let (ids, mut data) = rest.split_at_checked(usize::from(count)).filter(|(ids, _)| !ids.is_empty())?;
    let mut told = Told::default();
    for &id in ids {
        let len = match id {
            0x01 => 4,
            0x21 | 0x23 => 12,
            0x07 | 0x24 | 0x25 => 6,
            0x52 | 0x53 | 0x5a => 2,
            _ => return None,
        };
        let (value, behind) = data.split_at_checked(len)?;
        data = behind;
        match id {
            0x01 => told.time_ms = Some(u32::from_le_bytes(value.try_into().ok()?)),
            0x23 => told.accel = Some(frd(counts(value), G * 1e-6)),
            0x21 => told.gyro = Some(frd(counts(value), 1e-5_f64.to_radians())),
            0x24 => {
                let wrong = if driver == Driver::Px4 { PX4_MAG } else { 1.0 };
                told.mag = Some(frd(counts(value), UT_PER_COUNT * wrong));
            }
            0x07 => told.has_attitude = true,
            0x53 => told.status = u16::from_le_bytes(value.try_into().ok()?),
            _ => {}
        }
    }
    data.is_empty().then_some(told)
}

/// Three whole numbers of as many bytes as there are for each.
fn counts(value: &[u8]) -> [f64; 3] {
    let len = value.len() / 3;
    std::array::from_fn(|i| match value[i * len..(i + 1) * len] {
        [a, b] => i16::from_le_bytes([a, b]).into(),
        [a, b, c, d] => i32::from_le_bytes([a, b, c, d]).into(),
        _ => 0.0,
    })
}

/// Right, forward, up to forward, right, down.
fn frd([right, forward, up]: [f64; 3], unit: f64) -> [f32; 3] {
    [forward, right, -up].map(|count| (count * unit) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a real driver: gyro 30, −31, 2 rad/s; accel 156, −156, 20 m/s²; mag −3200, 3200, −7.8 mG.
    const TURNED: &str = "aa550195440009012321252407535a523a420000105e0dfff0a1f200ade4e0ffecc769f5ebca3e0aac2551ff92b8\
                          00000000007d00834e00b80b00006efb00000000fa004d17";

    fn golden() -> Vec<u8> {
        (0..TURNED.len()).step_by(2).map(|i| u8::from_str_radix(&TURNED[i..i + 2], 16).unwrap()).collect()
    }

    /// The same frame with other ids and data.
    fn reframed(payload: &[u8]) -> Vec<u8> {
        let mut frame = golden()[..HEADER_LEN].to_vec();
        frame[4] = (payload.len() + HEADER_LEN) as u8;
        frame.extend_from_slice(payload);
        let sum = frame[UNCOUNTED_LEN..].iter().fold(0_u16, |sum, &byte| sum.wrapping_add(byte.into()));
        frame.extend(sum.to_le_bytes());
        frame
    }

    #[test]
    fn a_golden_frame_says_what_it_was_made_of() {
        let frame = golden();
        let of = |driver| told(&frame[HEADER_LEN..frame.len() - SUM_LEN], driver).unwrap();
        let seen = of(Driver::Ardupilot);
        let near = |seen: Option<[f32; 3]>, expected: [f32; 3]| {
            seen.unwrap().iter().zip(expected).all(|(a, b)| (a - b).abs() <= 2e-6 * b.abs())
        };
        assert!(near(seen.gyro, [30.0, -31.0, 2.0]), "{seen:?}");
        assert!(near(seen.accel, [156.0, -156.0, 20.0]), "{seen:?}");
        assert!(near(seen.mag, [-320.0, 320.0, -0.78]), "{seen:?}");
        assert!(near(of(Driver::Px4).mag, [-3.2, 3.2, -0.0078]), "a hundredth");
        assert_eq!((seen.time_ms, seen.has_attitude), (Some(16_954), true));
    }

    #[test]
    fn a_frame_with_an_id_that_is_not_known_or_stray_bytes_is_dropped_and_the_next_is_used() {
        let whole = golden();
        let payload = &whole[HEADER_LEN..whole.len() - SUM_LEN];
        let mut unknown = payload.to_vec();
        unknown[1] = 0x99;
        let stray = [payload, &[0]].concat();
        let cut = &payload[..payload.len() - 1];
        for wrong in [&unknown[..], &stray, cut] {
            let stream = [reframed(wrong), whole.clone()].concat();
            let mut firmware = Ilabs::ardupilot(&Settings::default());
            firmware.receive(&stream, 0, &mut Vec::new());
            let counts = firmware.record().counts;
            assert_eq!((counts.packets, counts.refused, counts.samples, counts.damaged), (2, 1, 1, 0));
        }
    }

    #[test]
    fn noise_between_frames_costs_no_frame() {
        for make in [Ilabs::ardupilot, Ilabs::px4] {
            let mut firmware = make(&Settings::default());
            let stream = [&[1, 2, 0xaa, 3, 0xaa][..], &golden(), &[0xaa, 0x55], &golden().repeat(8)].concat();
            stream.chunks(7).for_each(|piece| firmware.receive(piece, 0, &mut Vec::new()));
            let counts = firmware.record().counts;
            // PX4's buffer of 250 bytes keeps the last three.
            let kept = if firmware.driver == Driver::Px4 { 3 } else { 0 };
            assert_eq!(counts.samples, 9 - kept, "{:?} {counts}", firmware.driver);
            assert!(counts.damaged > 0);
        }
    }

    #[test]
    fn px4_handles_a_frame_when_its_buffer_is_full() {
        let mut firmware = Ilabs::px4(&Settings::default());
        let mut handled = Vec::new();
        for k in 0..20_u64 {
            firmware.receive(&golden(), k * 5000, &mut Vec::new());
            handled.push(firmware.record().counts.samples);
        }
        assert_eq!(handled[..5], [0, 0, 0, 1, 2], "three frames and a half are held");
        // After half a second it begins again.
        firmware.receive(&golden(), 2_000_000, &mut Vec::new());
        assert_eq!((firmware.record().counts.samples, firmware.held.len()), (17, 70));
    }
}
