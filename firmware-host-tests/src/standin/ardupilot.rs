//! ArduPilot with a VN-100 as its external AHRS (`AP_ExternalAHRS_VectorNav`).
//!
//! It speaks first and sets the unit up command by command, each again every half second until its answer has come;
//! its boot waits for the end of that. From then on it is deaf to all but the two binary packets. Its own estimators
//! run on the IMU packet, stamped on arrival; the attitude of the AHRS packet is the unit's, not theirs.

use ratetable_protocols::vectornav::{self, Decoder, MAX_LEN, Packet, imu, line::Line};

use super::{Firmware, Own, Record, Settings};
use crate::sample::Sample;

/// Between a command and itself, µs.
const RESEND_US: u64 = 500_000;
/// Of the unit whose outputs are divided, Hz.
const UNIT_HZ: u32 = 800;
/// µT in a gauss.
const UT_PER_GAUSS: f64 = 100.0;
/// The command that is answered with the model's name, and how that answer begins.
const MODEL: (&str, &str) = ("VNRRG,01", "VNRRG,01,VN-1");

/// ArduPilot and its driver.
pub struct Ardupilot {
    decoder: Decoder,
    rest: External,
}

/// Everything but the stream's own state.
struct External {
    own: Own,
    record: Record,
    commands: Vec<String>,
    /// How many of them have been answered.
    done: usize,
    /// When the one under way was sent.
    sent_us: Option<u64>,
}

impl Ardupilot {
    /// Just booted; it asks for so many IMU packets a second as the settings say.
    pub fn new(settings: &Settings) -> Self {
        let divisor = (UNIT_HZ / settings.rate_hz.max(1)).max(1);
        let imu = format!("VNWRG,75,3,{divisor},01,0721");
        let commands = [
            "VNASY,0",
            "VNWRG,06,0,1",
            "VNWRG,06,0,2",
            MODEL.0,
            &imu,
            "VNWRG,76,3,16,11,0001,0106",
            "VNASY,1",
        ];
        let rest = External {
            own: Own::new(settings.ahrs, settings.declination_rad),
            record: Record::default(),
            commands: commands.map(str::to_owned).to_vec(),
            done: 0,
            sent_us: None,
        };
        Self { decoder: Decoder::new(), rest }
    }

    /// Whether the unit is set up.
    pub fn has_booted(&self) -> bool {
        self.rest.command().is_none()
    }
}

impl Firmware for Ardupilot {
    fn receive(&mut self, bytes: &[u8], now_us: u64, out: &mut Vec<u8>) {
        let Self { decoder, rest } = self;
        decoder.feed(bytes, |received| {
            rest.record.counts.packets += u64::from(received.is_ok());
            match received {
                Ok(Packet::Line(line)) => rest.hear(&line, now_us, out),
                Ok(Packet::Imu(imu)) => rest.feel(&imu, now_us),
                // The unit's attitude: for who chooses it (AHRS_EKF_TYPE = 11), and not for EKF3 and DCM.
                Ok(Packet::Ahrs(_)) => rest.record.counts.foreign += 1,
                // Outputs that it did not ask for.
                Ok(Packet::Inertial(_) | Packet::Navigation(_)) => rest.record.counts.refused += 1,
                Err(_) => rest.record.counts.damaged += 1,
            }
        });
    }

    fn turn(&mut self, now_us: u64, out: &mut Vec<u8>) {
        self.rest.ask(now_us, out);
    }

    fn record(&self) -> &Record {
        &self.rest.record
    }
}

impl External {
    /// The command under way.
    fn command(&self) -> Option<&str> {
        self.commands.get(self.done).map(String::as_str)
    }

    /// Sends the command under way, if it is time to.
    fn ask(&mut self, now_us: u64, out: &mut Vec<u8>) {
        if self.sent_us.is_some_and(|sent_us| now_us - sent_us < RESEND_US) {
            return;
        }
        let mut bytes = [0; MAX_LEN];
        let line = self.command().and_then(|command| Line::new(command).ok());
        let len = line.and_then(|line| vectornav::encode(&Packet::Line(line), &mut bytes).ok());
        if let Some(len) = len {
            self.record.counts.asked += 1;
            self.sent_us = Some(now_us);
            out.extend_from_slice(&bytes[..len]);
        }
    }

    /// Takes a line for the answer to the command under way, if it is.
    fn hear(&mut self, line: &Line, now_us: u64, out: &mut Vec<u8>) {
        let answers = self.command().is_some_and(|command| {
            if command == MODEL.0 { line.text().starts_with(MODEL.1) } else { line.text() == command }
        });
        if answers {
            self.record.counts.answers += 1;
            self.done += 1;
            self.sent_us = None;
            self.ask(now_us, out);
        }
    }

    /// Takes readings, as of now.
    fn feel(&mut self, imu: &imu::Repr, now_us: u64) {
        if self.command().is_some() {
            self.record.counts.refused += 1;
            return;
        }
        let wide = |values: [f32; 3]| values.map(f64::from);
        let sample = Sample {
            t_us: now_us,
            gyro: Some(wide(imu.gyro)),
            accel: Some(wide(imu.accel)),
            mag: Some(wide(imu.mag).map(|m| m * UT_PER_GAUSS)),
        };
        self.record.counts.samples += 1;
        self.own.take(&sample, Some(imu.time_ns / 1000), &mut self.record);
    }
}
