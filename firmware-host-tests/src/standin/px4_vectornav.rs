//! PX4 with a VectorNav unit on a UART (`vectornav` driver, `VN_MODE` 0), as its own code was measured to behave.
//!
//! It opens its port at 115200 baud and asks for the model; where nobody answers it tries the other speeds. Then it
//! sets 921600 baud, reads what the unit is, and sets up two outputs and a third one that it can do without. A command
//! goes out three times in half a second. An error or silence makes it begin again a second later: for the unit's
//! identity from the first speed on, for an output from there. Its own estimator runs on the first output, each sample
//! stamped on arrival, and takes the field from the second; the attitude in that one is the unit's, not its own.

use ratetable_protocols::vectornav::{self, Decoder, MAX_LEN, Packet, inertial, line::Line, navigation};

use super::{Firmware, Own, Record, Settings};
use crate::sample::Sample;

/// Of the unit whose outputs are divided, Hz.
const UNIT_HZ: u32 = 800;
/// µT in a gauss.
const UT_PER_GAUSS: f64 = 100.0;
/// Between a command and itself, and until it is given up, µs.
const RESEND_US: u64 = 200_000;
const TIMEOUT_US: u64 = 500_000;
/// Between two attempts, µs.
const AGAIN_US: u64 = 1_000_000;
/// Without samples for so long it begins again, µs.
const LOST_US: u64 = 5_000_000;
/// The speeds that it tries in turn, baud.
const SPEEDS: [u32; 10] =
    [115_200, 9_600, 19_200, 38_400, 57_600, 115_200, 128_000, 230_400, 460_800, 921_600];
/// The speed that it sets.
const SET_SPEED: u32 = 921_600;
/// Where commands stand in [`Driver::command`]: those from `CONFIGURE` on are sent again without the ones before.
const VERIFY: usize = 0;
const SPEED: usize = 2;
const CONFIGURE: usize = 7;
const READ_FILTER: usize = 8;
const WRITE_FILTER: usize = 9;
const FIRST: usize = 11;
const THIRD: usize = 13;
const DONE: usize = 14;

/// PX4 and its driver.
pub struct Px4Vectornav {
    decoder: Decoder,
    rest: Driver,
}

/// Everything but the stream's own state.
struct Driver {
    own: Own,
    record: Record,
    divisor: u32,
    /// The command under way.
    at: usize,
    /// Which of [`SPEEDS`] the port was opened at, and the speed now.
    tried: usize,
    speed: u32,
    /// What register 35 said.
    filter: [String; 4],
    /// When the command under way went out first, and last.
    asked_us: Option<(u64, u64)>,
    /// It does nothing until then.
    idle_until_us: u64,
    /// When the newest sample came.
    sample_us: Option<u64>,
}

impl Px4Vectornav {
    /// Just booted, with `VN_IMU_RATE` as the settings say.
    pub fn new(settings: &Settings) -> Self {
        let rest = Driver {
            own: Own::new(settings.ahrs, settings.declination_rad),
            record: Record::default(),
            divisor: (UNIT_HZ / settings.rate_hz.max(1)).max(1),
            at: VERIFY,
            tried: 0,
            speed: SPEEDS[0],
            filter: [(); 4].map(|()| "1".to_owned()),
            asked_us: None,
            idle_until_us: 0,
            sample_us: None,
        };
        Self { decoder: Decoder::new(), rest }
    }
}

impl Firmware for Px4Vectornav {
    fn receive(&mut self, bytes: &[u8], now_us: u64, out: &mut Vec<u8>) {
        let Self { decoder, rest } = self;
        decoder.feed(bytes, |received| {
            rest.record.counts.packets += u64::from(received.is_ok());
            match received {
                Ok(Packet::Line(line)) => rest.hear(&line, now_us, out),
                Ok(Packet::Inertial(seen)) => rest.feel(&seen, now_us),
                Ok(Packet::Navigation(seen)) => rest.sense(&seen, now_us),
                // Outputs that it did not ask for.
                Ok(Packet::Imu(_) | Packet::Ahrs(_)) => rest.record.counts.refused += 1,
                Err(_) => rest.record.counts.damaged += 1,
            }
        });
    }

    fn turn(&mut self, now_us: u64, out: &mut Vec<u8>) {
        let rest = &mut self.rest;
        if rest.at == DONE && rest.sample_us.is_some_and(|us| now_us.saturating_sub(us) > LOST_US) {
            rest.record.counts.timeouts += 1;
            rest.begin_again(VERIFY, now_us);
        }
        rest.ask(now_us, out);
    }

    fn record(&self) -> &Record {
        &self.rest.record
    }

    fn baud(&self) -> Option<u32> {
        Some(self.rest.speed)
    }
}

impl Driver {
    /// The command under way.
    fn command(&self) -> String {
        let [_, _, filtering, tuning] = &self.filter;
        match self.at {
            VERIFY | 1 | 3 => "VNRRG,01".into(),
            SPEED => format!("VNWRG,5,{SET_SPEED}"),
            4 => "VNRRG,02".into(),
            5 => "VNRRG,03".into(),
            6 => "VNRRG,04".into(),
            CONFIGURE => "VNWRG,6,0".into(),
            READ_FILTER | 10 => "VNRRG,35".into(),
            // On, and heading by the field.
            WRITE_FILTER => format!("VNWRG,35,1,0,{filtering},{tuning}"),
            FIRST => format!("VNWRG,75,2,{},6,1,600", self.divisor),
            12 => "VNWRG,76,2,8,36,1,130,84,613".into(),
            _ => "VNWRG,77,2,80,A,1,26B9".into(),
        }
    }

    /// Sends the command under way if it is time to, and gives it up after a while.
    fn ask(&mut self, now_us: u64, out: &mut Vec<u8>) {
        if self.at == DONE || now_us < self.idle_until_us {
            return;
        }
        if self.asked_us.is_some_and(|(first_us, _)| now_us.saturating_sub(first_us) >= TIMEOUT_US) {
            return self.fail(now_us);
        }
        if self.asked_us.is_some_and(|(_, last_us)| now_us.saturating_sub(last_us) < RESEND_US) {
            return;
        }
        let mut bytes = [0; MAX_LEN];
        let line = Line::new(&self.command()).ok();
        let len = line.and_then(|line| vectornav::encode(&Packet::Line(line), &mut bytes).ok());
        if let Some(len) = len {
            self.record.counts.asked += 1;
            let first_us = self.asked_us.map_or(now_us, |(first_us, _)| first_us);
            self.asked_us = Some((first_us, now_us));
            out.extend_from_slice(&bytes[..len]);
        }
    }

    /// Takes a line for the answer to the command under way, if it is.
    fn hear(&mut self, line: &Line, now_us: u64, out: &mut Vec<u8>) {
        if self.asked_us.is_none() {
            return;
        }
        let (text, command) = (line.text(), self.command());
        if text.starts_with("VNERR") {
            return self.fail(now_us);
        }
        let is_read = command.starts_with("VNRRG");
        let answers = if is_read { text.starts_with(&format!("{command},")) } else { text == command };
        if !answers {
            return;
        }
        self.record.counts.answers += 1;
        match self.at {
            SPEED => self.speed = SET_SPEED,
            READ_FILTER => {
                let terms: Vec<_> = line.terms().skip(2).map(str::to_owned).collect();
                self.filter = terms.try_into().unwrap_or_else(|_| self.filter.clone());
            }
            _ => {}
        }
        self.go_on(self.at + 1);
        self.ask(now_us, out);
    }

    fn go_on(&mut self, at: usize) {
        self.at = at;
        self.asked_us = None;
    }

    /// An error, or no answer.
    fn fail(&mut self, now_us: u64) {
        match self.at {
            VERIFY if self.tried + 1 < SPEEDS.len() => {
                self.tried += 1;
                self.speed = SPEEDS[self.tried];
                self.go_on(VERIFY);
            }
            VERIFY..CONFIGURE => self.begin_again(VERIFY, now_us),
            // Without its own filter's settings it goes on to the outputs.
            CONFIGURE => self.go_on(READ_FILTER),
            READ_FILTER..FIRST => self.go_on(FIRST),
            THIRD => self.go_on(DONE),
            _ => self.begin_again(CONFIGURE, now_us),
        }
    }

    fn begin_again(&mut self, at: usize, now_us: u64) {
        if at == VERIFY {
            self.tried = 0;
            self.speed = SPEEDS[0];
        }
        self.record.counts.restarts += 1;
        self.sample_us = None;
        self.idle_until_us = now_us + AGAIN_US;
        self.go_on(at);
    }

    /// Takes readings of gyro and accelerometer, as of now.
    fn feel(&mut self, seen: &inertial::Repr, now_us: u64) {
        if self.at != DONE {
            self.record.counts.refused += 1;
            return;
        }
        let [gyro, accel] = [seen.gyro, seen.accel].map(|values| Some(values.map(f64::from)));
        let sample = Sample { t_us: now_us, gyro, accel, mag: None };
        self.sample_us = Some(now_us);
        self.record.counts.samples += 1;
        self.own.take(&sample, Some(seen.time_ns / 1000), &mut self.record);
    }

    /// Takes the field, as of now, and leaves the unit's attitude.
    fn sense(&mut self, seen: &navigation::Repr, now_us: u64) {
        if self.at != DONE {
            return;
        }
        self.record.counts.foreign += 1;
        let mag = Some(seen.mag.map(|m| f64::from(m) * UT_PER_GAUSS));
        self.own.take(&Sample { t_us: now_us, gyro: None, accel: None, mag }, None, &mut self.record);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(bytes: &[u8]) -> Vec<String> {
        let mut all = Vec::new();
        Decoder::new().feed(bytes, |received| match received {
            Ok(Packet::Line(line)) => all.push(line.text().to_owned()),
            other => panic!("{other:?}"),
        });
        all
    }

    fn say(driver: &mut Px4Vectornav, text: &str, now_us: u64) -> Vec<String> {
        let mut bytes = [0; MAX_LEN];
        let len = vectornav::encode(&Packet::Line(Line::new(text).unwrap()), &mut bytes).unwrap();
        let mut out = Vec::new();
        driver.receive(&bytes[..len], now_us, &mut out);
        lines(&out)
    }

    /// What it says by itself from then to then, with the times.
    fn turns(driver: &mut Px4Vectornav, from_us: u64, to_us: u64) -> Vec<(u64, String)> {
        let mut all = Vec::new();
        for now_us in (from_us..to_us).step_by(1_000) {
            let mut out = Vec::new();
            driver.turn(now_us, &mut out);
            all.extend(lines(&out).into_iter().map(|line| (now_us, line)));
        }
        all
    }

    /// The measured conversation at 200 Hz: what it says, and what it is answered.
    const TALK: [(&str, &str); 14] = [
        ("VNRRG,01", "VNRRG,01,VN-100T-CR"),
        ("VNRRG,01", "VNRRG,01,VN-100T-CR"),
        ("VNWRG,5,921600", "VNWRG,5,921600"),
        ("VNRRG,01", "VNRRG,01,VN-100T-CR"),
        ("VNRRG,02", "VNRRG,02,7"),
        ("VNRRG,03", "VNRRG,03,1"),
        ("VNRRG,04", "VNRRG,04,1.0"),
        ("VNWRG,6,0", "VNWRG,6,0"),
        ("VNRRG,35", "VNRRG,35,1,1,1,1"),
        ("VNWRG,35,1,0,1,1", "VNWRG,35,1,0,1,1"),
        ("VNRRG,35", "VNRRG,35,1,1,1,1"),
        ("VNWRG,75,2,4,6,1,600", "VNWRG,75,2,4,6,1,600"),
        ("VNWRG,76,2,8,36,1,130,84,613", "VNWRG,76,2,8,36,1,130,84,613"),
        ("VNWRG,77,2,80,A,1,26B9", "VNERR,12"),
    ];

    fn booted() -> Px4Vectornav {
        Px4Vectornav::new(&Settings { rate_hz: 200, ..Settings::default() })
    }

    #[test]
    fn it_holds_the_measured_conversation_and_goes_on_at_the_speed_that_it_sets() {
        let mut driver = booted();
        let mut asked = turns(&mut driver, 0, 1_000).remove(0).1;
        for (k, (command, answer)) in TALK.into_iter().enumerate() {
            assert_eq!(asked, command, "{k}");
            assert_eq!(driver.baud(), Some(if k > SPEED { 921_600 } else { 115_200 }), "{k}");
            asked = say(&mut driver, answer, 1_000).pop().unwrap_or_default();
        }
        assert_eq!((asked, driver.rest.at), (String::new(), DONE));
        assert_eq!(driver.record().counts.restarts, 0);
    }

    #[test]
    fn an_error_to_the_change_of_speed_makes_it_begin_again_for_ever() {
        let mut driver = booted();
        let mut now_us = 0;
        for round in 1..=3 {
            turns(&mut driver, now_us, now_us + 1_000);
            say(&mut driver, "VNRRG,01,VN-100T-CR", now_us);
            say(&mut driver, "VNRRG,01,VN-100T-CR", now_us);
            assert_eq!(say(&mut driver, "VNERR,12", now_us), [""; 0]);
            assert_eq!(driver.record().counts.restarts, round);
            now_us += AGAIN_US;
            assert_eq!(turns(&mut driver, now_us - 5_000, now_us), [], "it waits");
        }
    }

    #[test]
    fn what_is_not_answered_goes_out_three_times_and_then_at_the_other_speeds() {
        let mut driver = booted();
        let asked = turns(&mut driver, 0, 1_000_000);
        let times: Vec<u64> = asked.iter().map(|(us, _)| *us).collect();
        assert_eq!(times[..6], [0, 200_000, 400_000, 501_000, 701_000, 901_000]);
        assert_eq!(driver.baud(), Some(9_600));
        turns(&mut driver, 1_000_000, 5_000_000);
        assert_eq!(driver.baud(), Some(921_600), "the last one it tries");
        turns(&mut driver, 5_000_000, 5_100_000);
        assert_eq!((driver.record().counts.restarts, driver.baud()), (1, Some(115_200)));
    }
}
