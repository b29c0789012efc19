//! `betaflight`: the firmware's attitude over MSP, on a connection of its own beside the stream.
//!
//! It is asked who it is, and for its release and the time between two runs of its control loop; then whether its
//! [gyro answers](super::probe). From then on it is asked for its attitude, again as soon as it has answered: it looks
//! for a question a hundred times a second and answers at once, so that an answer holds when it arrives.

use super::Release;
use super::probe::{Probe, Verdict, bytes};
use crate::geometry::Attitude;
use crate::wire::Controller;
use crate::wire::dialogue::{Dialogue, Estimate, Pause, Said, Stage, Stamp};
use glam::DQuat;
use ratetable_protocols::Error;
use ratetable_protocols::betaflight::state;
use ratetable_protocols::msp::{
    self, Decoder, Direction, MAX_LEN, Message, Received, attitude, attitude_quaternion, fc_variant,
    fc_version, raw_imu, status,
};

/// A question that is not answered is asked again after so long, ns.
const ASK_AGAIN: i64 = 200_000_000;
/// Nobody answers, or no control loop runs, for so long before that is said, ns.
const PATIENCE: i64 = 2_000_000_000;

/// Betaflight's SITL.
pub(super) struct Sitl {
    decoder: Decoder,
    pause: Pause,
    damaged: u64,
    ear: Ear,
}

/// What becomes of messages.
struct Ear {
    release: Release,
    step: Step,
    known: Known,
    /// The question that is not answered yet, and since when.
    asked: Option<(u16, i64)>,
    /// When it was first asked, and when it said something last.
    since: Option<i64>,
    heard: i64,
    told: Told,
}

/// How far the conversation is.
enum Step {
    /// Who is it?
    Asking,
    /// Does its gyro answer?
    Probing(Probe),
    /// It is fed; whether it tells its attitude. Its gains are so high while it rests that the target's rest will do.
    Telling(bool),
    /// It is not to be fed. What the user can do was said.
    Refused,
}

/// What it said of itself.
#[derive(Default)]
struct Known {
    variant: bool,
    version: bool,
    is_running: bool,
}

/// What the user has been told.
#[derive(Default)]
struct Told {
    silence: bool,
    standstill: bool,
    gone: bool,
}

impl Sitl {
    /// With a controller its gyro has to answer before it is fed; else it is played to at once.
    pub(super) fn new(controller: Option<Controller>) -> Sitl {
        let step = if controller.is_some() { Step::Asking } else { Step::Telling(true) };
        let ear = Ear {
            release: Release::of(controller),
            step,
            known: Known::default(),
            asked: None,
            since: None,
            heard: i64::MIN,
            told: Told::default(),
        };
        Sitl { decoder: Decoder::new(), pause: Pause::default(), damaged: 0, ear }
    }

    fn take(&mut self, received: Result<Received, Error>, now: i64, say: &mut dyn FnMut(Said<'_>)) {
        match received {
            Ok(received) => self.ear.take(&received, now, say),
            Err(_) => self.damaged += 1,
        }
    }
}

impl Dialogue for Sitl {
    fn hear(&mut self, bytes: &[u8], now: i64, say: &mut dyn FnMut(Said<'_>)) {
        self.pause.heard(now);
        let mut decoder = std::mem::take(&mut self.decoder);
        decoder.feed(bytes, |received| self.take(received, now, say));
        self.decoder = decoder;
    }

    fn tick(&mut self, now: i64, say: &mut dyn FnMut(Said<'_>)) {
        if self.pause.is_now(now) {
            let mut decoder = std::mem::take(&mut self.decoder);
            decoder.finish(|received| self.take(received, now, say));
            self.decoder = decoder;
        }
        self.ear.tick(now, say);
    }

    fn leave(&mut self, say: &mut dyn FnMut(Said<'_>)) {
        // The rate of the probe would go on turning it.
        say(Said::Ahead(&bytes(&state::Repr::LEVEL)));
    }

    fn stage(&self) -> Stage {
        match self.ear.step {
            Step::Telling(true) => Stage::Ready,
            Step::Telling(false) => Stage::Still,
            _ => Stage::Silent,
        }
    }

    fn damaged(&self) -> u64 {
        self.damaged
    }
}

impl Ear {
    fn take(&mut self, received: &Received, now: i64, say: &mut dyn FnMut(Said<'_>)) {
        self.heard = now;
        if self.asked.is_some_and(|(command, _)| command == received.command) {
            self.asked = None;
        }
        if received.direction == Direction::Refusal {
            return;
        }
        match received.message {
            Some(Message::FcVariant(reply)) if reply.name == fc_variant::BETAFLIGHT => {
                self.known.variant = true
            }
            Some(Message::FcVariant(reply)) => self.refuse(stranger(&reply), say),
            Some(Message::FcVersion(reply)) if self.release.fits(&reply) => self.known.version = true,
            Some(Message::FcVersion(reply)) => self.refuse(other_release(&reply, self.release), say),
            Some(Message::Status(reply)) => self.known.is_running |= reply.cycle_time > 0,
            Some(Message::RawImu(reply)) => {
                if let Step::Probing(probe) = &mut self.step {
                    probe.hear(&reply);
                }
            }
            Some(Message::AttitudeQuaternion(reply)) => self.estimate(&reply, say),
            Some(Message::Attitude(_)) => self.hears(),
            _ => {}
        }
    }

    /// What it estimates.
    fn estimate(&mut self, reply: &attitude_quaternion::Repr, say: &mut dyn FnMut(Said<'_>)) {
        let [w, x, y, z] = reply.q.map(f64::from);
        let q = DQuat::from_xyzw(x, -y, -z, w);
        if q.length() < 0.5 * attitude_quaternion::SCALE {
            return;
        }
        let attitude = Attitude::from_quat(q.normalize());
        self.hears();
        if self.release.estimates() {
            say(Said::Estimate(Estimate { stamp: Stamp::Arrival, attitude }));
        }
    }

    /// It tells an attitude: the scene may start.
    fn hears(&mut self) {
        if let Step::Telling(ready) = &mut self.step {
            *ready = true;
        }
    }

    fn refuse(&mut self, why: String, say: &mut dyn FnMut(Said<'_>)) {
        if !matches!(self.step, Step::Refused) {
            say(Said::Notice(why));
        }
        self.step = Step::Refused;
    }

    fn tick(&mut self, now: i64, say: &mut dyn FnMut(Said<'_>)) {
        let since = *self.since.get_or_insert(now);
        self.heard = self.heard.max(since);
        let silent = now - self.heard >= PATIENCE;
        match &mut self.step {
            Step::Asking if self.known.variant && self.known.version && self.known.is_running => {
                self.step = Step::Probing(Probe::default());
            }
            Step::Asking => self.complain(silent, now - since >= PATIENCE, say),
            Step::Probing(probe) => {
                let state = probe.next(now, self.release);
                let verdict = probe.verdict();
                say(Said::Ahead(&bytes(&state)));
                self.judge(verdict, say);
            }
            Step::Telling(_) => {
                if silent && !std::mem::replace(&mut self.told.gone, true) {
                    say(Said::Notice(
                        "the firmware has not answered for 2 s: its attitude is not known from here on"
                            .into(),
                    ));
                }
            }
            Step::Refused => return,
        }
        if self.asked.is_none_or(|(_, at)| now - at >= ASK_AGAIN) {
            let command = self.question();
            self.asked = Some((command, now));
            let mut buffer = [0; MAX_LEN];
            let len = msp::encode(&Message::question(command), &mut buffer).unwrap_or(0);
            say(Said::Reply(&buffer[..len]));
        }
    }

    /// What is to be known next.
    fn question(&self) -> u16 {
        match self.step {
            Step::Probing(_) => raw_imu::COMMAND,
            Step::Telling(_) if self.release.estimates() => attitude_quaternion::COMMAND,
            Step::Telling(_) => attitude::COMMAND,
            _ if !self.known.variant => fc_variant::COMMAND,
            _ if !self.known.version => fc_version::COMMAND,
            _ => status::COMMAND,
        }
    }

    /// Tells once of a firmware that says nothing, and of one whose control loop stands still.
    fn complain(&mut self, silent: bool, standing: bool, say: &mut dyn FnMut(Said<'_>)) {
        if silent && !std::mem::replace(&mut self.told.silence, true) {
            say(Said::Notice(format!("no answer to MSP questions: {RESTART}")));
        }
        let stands = standing && self.known.variant && self.known.version;
        if stands && !std::mem::replace(&mut self.told.standstill, true) {
            say(Said::Notice(format!("its control loop does not run (its cycle time is 0): {RESTART}")));
        }
    }

    /// What the probe's verdict means.
    fn judge(&mut self, verdict: Verdict, say: &mut dyn FnMut(Said<'_>)) {
        match verdict {
            Verdict::Open => {}
            Verdict::Alive => {
                self.step = Step::Telling(false);
                if !self.release.estimates() {
                    say(Said::Notice(format!(
                        "Betaflight {} takes its attitude from the packet (it is built without USE_IMU_CALC): its answers only repeat what it was sent, so there is no score",
                        self.release
                    )));
                }
            }
            Verdict::Mirrored => self.refuse(mirrored(self.release), say),
            Verdict::Dead => self.refuse(
                format!("its gyro does not answer a test rate on UDP port 9003 within 2 s: {RESTART}"),
                say,
            ),
        }
    }
}

/// What helps against the races of its start-up.
const RESTART: &str =
    "Betaflight's start-up went wrong (its SITL has races there), so end it and start it again";

fn stranger(reply: &fc_variant::Repr) -> String {
    let name = String::from_utf8_lossy(&reply.name).into_owned();
    format!(
        "the firmware says that it is {name:?}, not Betaflight (INAV's SITL has the same port): end it and start Betaflight's"
    )
}

fn other_release(reply: &fc_version::Repr, release: Release) -> String {
    let named = match reply.major {
        25.. => format!("20{}.{}.{}", reply.major, reply.minor, reply.patch),
        _ => format!("{}.{}.{}", reply.major, reply.minor, reply.patch),
    };
    let right = Release::of_version(reply);
    format!(
        "this is Betaflight {named}, and the packets are for {release}: write version = \"{right}\" in the scene's [[output]]"
    )
}

fn mirrored(release: Release) -> String {
    let right = if release == Release::Y2026M6 { Release::Y2026M6Legacy } else { Release::Y2026M6 };
    format!(
        "its gyro reads the rate about the vertical with the other sign than {release}'s: write version = \"{right}\" in the scene's [[output]]"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Euler;
    use crate::time::NANOS;
    use proptest::prelude::*;
    use ratetable_protocols::betaflight::{self, GYRO_COUNTS};

    /// The firmware as far as it is spoken with; well, and of 2026.12.
    struct Firmware {
        name: [u8; 4],
        version: [u8; 3],
        cycle_time: u16,
        /// Whether it answers at all, and its gyro reads what comes.
        speaks: bool,
        senses: bool,
        /// The sign with which it takes the rate about the vertical: Gazebo's or the others'.
        yaw: f64,
        told: [i16; 4],
        gyro: [f64; 3],
        /// What each packet turned it by, deg.
        turned: Vec<[f64; 3]>,
        questions: Vec<u16>,
    }

    impl Default for Firmware {
        fn default() -> Self {
            Firmware {
                name: fc_variant::BETAFLIGHT,
                version: [26, 12, 0],
                cycle_time: 997,
                speaks: true,
                senses: true,
                yaw: 1.0,
                told: [32767, 0, 0, 0],
                gyro: [0.0; 3],
                turned: Vec::new(),
                questions: Vec::new(),
            }
        }
    }

    impl Firmware {
        fn sense(&mut self, packet: &[u8]) {
            betaflight::Decoder::new().feed(packet, |state| {
                let [p, q, r] = state.unwrap().gyro.map(f64::to_degrees);
                let turned = [p, -q, self.yaw * r];
                self.turned.push(turned.map(|rate| rate / 100.0));
                if self.senses {
                    self.gyro = turned;
                }
            });
        }

        fn answer(&mut self, question: &[u8]) -> Vec<u8> {
            let mut answer = None;
            Decoder::new().feed(question, |received| answer = received.ok());
            let command = answer.unwrap().command;
            self.questions.push(command);
            let [major, minor, patch] = self.version;
            let reply = match command {
                fc_variant::COMMAND => Message::FcVariant(fc_variant::Repr { name: self.name }),
                fc_version::COMMAND => Message::FcVersion(fc_version::Repr { major, minor, patch }),
                status::COMMAND => {
                    Message::Status(status::Repr { cycle_time: self.cycle_time, ..Default::default() })
                }
                raw_imu::COMMAND => Message::RawImu(raw_imu::Repr {
                    gyro: self.gyro.map(|dps| (dps * GYRO_COUNTS) as i16),
                    ..Default::default()
                }),
                attitude_quaternion::COMMAND => {
                    Message::AttitudeQuaternion(attitude_quaternion::Repr { q: self.told })
                }
                _ => Message::Attitude(attitude::Repr { roll: 150, pitch: -100, yaw: 90 }),
            };
            let mut bytes = [0; MAX_LEN];
            let len = msp::encode(&reply, &mut bytes).unwrap();
            if self.speaks { bytes[..len].to_vec() } else { Vec::new() }
        }
    }

    #[derive(Default)]
    struct Heard {
        notices: Vec<String>,
        estimates: Vec<Attitude>,
        /// When each stage began, in ticks.
        stages: Vec<(usize, Stage)>,
    }

    /// So many ticks of 10 ms; what is asked is answered at the next.
    fn converse(sitl: &mut Sitl, firmware: &mut Firmware, ticks: usize) -> Heard {
        let (mut heard, mut on_its_way) = (Heard::default(), Vec::new());
        for k in 0..ticks {
            let now = k as i64 * NANOS / 100;
            let (mut ahead, mut asked) = (Vec::new(), Vec::new());
            let mut say = |said: Said<'_>| match said {
                Said::Reply(bytes) => asked.push(bytes.to_vec()),
                Said::Ahead(bytes) => ahead.push(bytes.to_vec()),
                Said::Notice(notice) => heard.notices.push(notice),
                Said::Estimate(estimate) => {
                    assert_eq!(estimate.stamp, Stamp::Arrival);
                    heard.estimates.push(estimate.attitude);
                }
                Said::Took | Said::Pass(_) | Said::Speed(_) | Said::Restart(_) => panic!("{said:?}"),
            };
            sitl.hear(&std::mem::take(&mut on_its_way), now, &mut say);
            sitl.tick(now, &mut say);
            ahead.iter().for_each(|packet| firmware.sense(packet));
            on_its_way = asked.iter().flat_map(|question| firmware.answer(question)).collect();
            if heard.stages.last().is_none_or(|(_, stage)| *stage != sitl.stage()) {
                heard.stages.push((k, sitl.stage()));
            }
        }
        heard
    }

    fn sitl(release: Release) -> Sitl {
        Sitl::new(Some(Controller::Betaflight(release)))
    }

    fn close(seen: Attitude, [roll, pitch, yaw]: [f64; 3]) -> bool {
        let [roll, pitch, yaw] = [roll, pitch, yaw].map(f64::to_radians);
        seen.angle_to(Attitude::from_quat(Euler { roll, pitch, yaw }.to_quat())) < 1e-4
    }

    #[test]
    fn it_is_asked_turned_there_and_back_fed_and_played_to_once_it_tells_its_attitude() {
        let mut firmware = Firmware::default();
        let heard = converse(&mut sitl(Release::Y2026M6), &mut firmware, 400);
        assert_eq!(heard.notices, Vec::<String>::new());
        let stages: Vec<_> = heard.stages.iter().map(|(_, stage)| *stage).collect();
        assert_eq!(stages, [Stage::Silent, Stage::Still, Stage::Ready]);
        let began: Vec<_> = heard.stages.iter().map(|(k, _)| *k).collect();
        assert!(began[1] < 50 && began[2] - began[1] < 5, "{began:?}");
        for axis in 0..3 {
            let all: f64 = firmware.turned.iter().map(|turned| turned[axis]).sum();
            let most = firmware.turned.iter().map(|turned| turned[axis].abs()).fold(0.0, f64::max);
            assert!(all.abs() < 1e-9 && most > 0.09, "{axis}: {all} of {most}");
        }
        assert_eq!(firmware.gyro, [0.0; 3], "and stands");
        let asked = [fc_variant::COMMAND, fc_version::COMMAND, status::COMMAND, raw_imu::COMMAND];
        let mut questions = firmware.questions.clone();
        questions.dedup();
        assert_eq!(questions, [&asked[..], &[attitude_quaternion::COMMAND]].concat());
        assert!(heard.estimates.len() > 300, "as often as it answers: {}", heard.estimates.len());
    }

    #[test]
    fn its_quaternion_is_from_forward_left_up_to_north_west_up() {
        // Roll 30, pitch 10 (nose up), yaw 90 degrees (east), by the same script as the golden packets.
        let told = [0.6963642403200191, 0.12278780396897288, -0.24184476264797528, -0.6644630243886747];
        let mut firmware =
            Firmware { told: told.map(|x: f64| (x * 32767.0).round() as i16), ..Firmware::default() };
        let heard = converse(&mut sitl(Release::Y2026M6), &mut firmware, 100);
        assert!(
            heard.estimates.iter().all(|seen| close(*seen, [30.0, 10.0, 90.0])),
            "{:?}",
            heard.estimates[0]
        );
        assert!(!close(heard.estimates[0], [30.0, -10.0, 90.0]), "a negative control");
        let nothing = Firmware { told: [0; 4], ..Firmware::default() };
        assert!(converse(&mut sitl(Release::Y2026M6), &mut { nothing }, 100).estimates.is_empty());
    }

    #[test]
    fn what_keeps_it_from_being_fed_is_said_once_and_nothing_turns_on() {
        let well = Firmware::default;
        let cases: [(Firmware, Release, &str); 9] = [
            (Firmware { speaks: false, ..well() }, Release::Y2026M6, "no answer to MSP|start it again"),
            (Firmware { cycle_time: 0, ..well() }, Release::Y2026M6, "control loop|start it again"),
            (Firmware { senses: false, ..well() }, Release::Y2026M6, "gyro does not answer|start it again"),
            (Firmware { name: *b"INAV", ..well() }, Release::Y2026M6, "\"INAV\"|not Betaflight"),
            (Firmware { yaw: -1.0, ..well() }, Release::Y2026M6, "other sign|\"2026.6-legacy\""),
            (well(), Release::Y2026M6Legacy, "other sign|\"2026.6\""),
            (Firmware { version: [25, 12, 1], ..well() }, Release::Y2026M6, "2025.12.1|\"2025.12\""),
            (Firmware { version: [4, 5, 2], ..well() }, Release::Y2025M12, "4.5.2|\"4.5\""),
            (Firmware { version: [26, 6, 1], ..well() }, Release::V4M5, "2026.6.1|\"2026.6\""),
        ];
        for (mut firmware, release, parts) in cases {
            let heard = converse(&mut sitl(release), &mut firmware, 600);
            let [notice] = &heard.notices[..] else { panic!("{parts}: {:?}", heard.notices) };
            assert!(parts.split('|').all(|part| notice.contains(part)), "{notice}");
            assert_eq!(heard.stages, [(0, Stage::Silent)], "{notice}");
            let turned = firmware
                .turned
                .iter()
                .fold([0.0; 3], |all: [f64; 3], turned| std::array::from_fn(|axis| all[axis] + turned[axis]));
            assert!(turned.iter().all(|turned| turned.abs() < 1e-9), "{notice}: {turned:?}");
            assert!(firmware.turned.last().is_none_or(|turned| *turned == [0.0; 3]), "{notice}");
        }
    }

    #[test]
    fn a_build_for_another_simulator_is_fed_with_its_own_sign() {
        let mut firmware = Firmware { yaw: -1.0, ..Firmware::default() };
        let heard = converse(&mut sitl(Release::Y2026M6Legacy), &mut firmware, 400);
        assert_eq!(heard.notices, Vec::<String>::new());
        assert_eq!(heard.stages.last().map(|(_, stage)| *stage), Some(Stage::Ready));
    }

    #[test]
    fn a_release_that_takes_the_attitude_from_the_packet_is_fed_and_not_scored() {
        for (release, version) in [(Release::Y2025M12, [25, 12, 0]), (Release::V4M5, [4, 5, 2])] {
            let mut firmware = Firmware { version, yaw: -1.0, ..Firmware::default() };
            let heard = converse(&mut sitl(release), &mut firmware, 400);
            let [notice] = &heard.notices[..] else { panic!("{:?}", heard.notices) };
            assert!(notice.contains("there is no score") && notice.contains(release.name()), "{notice}");
            assert_eq!(heard.stages.last().map(|(_, stage)| *stage), Some(Stage::Ready));
            assert!(heard.estimates.is_empty());
        }
    }

    #[test]
    fn a_firmware_that_falls_silent_is_told_of_once() {
        let (mut sitl, mut firmware) = (sitl(Release::Y2026M6), Firmware::default());
        converse(&mut sitl, &mut firmware, 400);
        firmware.speaks = false;
        let mut notices = Vec::new();
        for k in 400..1000 {
            sitl.tick(k * NANOS / 100, &mut |said| {
                if let Said::Notice(notice) = said {
                    notices.push((k, notice));
                }
            });
        }
        let [(k, notice)] = &notices[..] else { panic!("{notices:?}") };
        assert!((595..605).contains(k) && notice.contains("not answered for 2 s"), "{k}: {notice}");
    }

    #[test]
    fn who_leaves_before_the_stream_sends_a_packet_without_a_rate() {
        let mut sitl = sitl(Release::Y2026M6);
        let mut left = Vec::new();
        sitl.leave(&mut |said| {
            let Said::Ahead(bytes) = said else { panic!("{said:?}") };
            left.push(bytes.to_vec());
        });
        assert_eq!(left, [bytes(&state::Repr::LEVEL)]);
    }

    proptest! {
        #[test]
        fn any_bytes_do_not_hide_the_answer_behind_them(
            bytes in prop::collection::vec(
                prop_oneof![any::<u8>(), prop::sample::select(b"$X>!<\x65\x66\xa7\0".to_vec())],
                0..400,
            ),
            piece in 1..100usize,
        ) {
            let mut sitl = Sitl::new(None);
            bytes.chunks(piece).for_each(|piece| sitl.hear(piece, 0, &mut |_| {}));
            sitl.tick(NANOS, &mut |_| {});
            let mut frame = [0; MAX_LEN];
            let message = Message::AttitudeQuaternion(attitude_quaternion::Repr { q: [32767, 0, 0, 0] });
            let len = msp::encode(&message, &mut frame).unwrap();
            let mut estimates = 0;
            sitl.hear(&frame[..len], NANOS, &mut |said| estimates += u32::from(matches!(said, Said::Estimate(_))));
            prop_assert_eq!(estimates, 1);
        }
    }
}
