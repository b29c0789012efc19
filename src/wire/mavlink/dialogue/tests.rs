//! Whole conversations in memory, against a minimal PX4.

use super::*;
use crate::time::NANOS;
use crate::wire::MAX_PACKET;
use proptest::prelude::*;
use ratetable_protocols::mavlink::{
    self, Version, command_ack, command_long, hil_sensor, param_name, param_value, system_time,
};
use std::collections::{BTreeMap, BTreeSet};

/// The time of a step, ns.
const STEP: i64 = NANOS / 100;

fn packet(header: Header, message: &Message) -> Vec<u8> {
    let mut bytes = [0; mavlink::MAX_LEN];
    let len = mavlink::encode(&header, message, &mut bytes).unwrap();
    bytes[..len].to_vec()
}

fn from(system: u8, component: u8, message: &Message) -> Vec<u8> {
    packet(Header { version: Version::V2, seq: 0, system, component }, message)
}

fn beat(autopilot: u8, base_mode: u8) -> Message {
    Message::Heartbeat(heartbeat::Repr { autopilot, base_mode, mavlink_version: 3, ..Default::default() })
}

fn actuators(flags: u64) -> Message {
    Message::HilActuatorControls(hil_actuator_controls::Repr { flags, ..Default::default() })
}

fn quaternion(time_boot_ms: u32, q: [f32; 4]) -> Message {
    Message::AttitudeQuaternion(attitude_quaternion::Repr { time_boot_ms, q, ..Default::default() })
}

fn euler(time_boot_ms: u32, [roll, pitch, yaw]: [f32; 3]) -> Message {
    Message::Attitude(attitude::Repr { time_boot_ms, roll, pitch, yaw, ..Default::default() })
}

/// The messages of a conversation, in order, as far as they matter after the call.
#[derive(Clone, Debug, PartialEq)]
enum Word {
    Estimate(Estimate),
    Reply(Vec<u8>),
    Took,
    Notice(String),
    Restart(String),
    Pass(Vec<u8>),
}

impl Word {
    fn of(said: &Said<'_>) -> Word {
        match said {
            Said::Estimate(estimate) => Word::Estimate(*estimate),
            Said::Reply(bytes) | Said::Ahead(bytes) => Word::Reply(bytes.to_vec()),
            Said::Took => Word::Took,
            Said::Notice(notice) => Word::Notice(notice.clone()),
            Said::Restart(notice) => Word::Restart(notice.clone()),
            Said::Pass(bytes) => Word::Pass(bytes.to_vec()),
            Said::Speed(baud) => panic!("nothing over MAVLink sets {baud} baud"),
        }
    }
}

/// The response to these bytes.
fn hear(dialogue: &mut Mavlink, bytes: &[u8], now: i64) -> Vec<Word> {
    let mut words = Vec::new();
    dialogue.hear(bytes, now, &mut |said| words.push(Word::of(&said)));
    words
}

/// What is said without a request, without forwarded messages.
fn said(words: Vec<Word>) -> Vec<Word> {
    words.into_iter().filter(|word| !matches!(word, Word::Pass(_))).collect()
}

fn message(bytes: &[u8]) -> (Header, Message) {
    let mut all = Vec::new();
    Decoder::new().feed(bytes, |received| all.push(received.unwrap()));
    let [received] = all[..] else { panic!("one message a packet: {all:?}") };
    (received.header, received.message.unwrap())
}

/// A minimal PX4: it sends heartbeats once woken, and has an attitude if it hears samples.
struct Board {
    system: u8,
    parameters: BTreeMap<&'static str, i32>,
    /// Whether this link is USB, which ignores MAV_x parameters.
    usb: bool,
    /// Whether the estimator starts at all.
    estimates: bool,
    /// Roll in degrees as a function of the seconds since the first sample.
    roll: fn(f64) -> f64,
    /// Lost requests for each parameter.
    loses: u32,
    /// When it is off, before a reboot.
    off: std::ops::Range<f64>,
    awake: bool,
    fed_since: Option<i64>,
    interval: BTreeMap<u32, i64>,
    asked: BTreeMap<String, u32>,
    decoder: Decoder,
    seq: u8,
}

impl Board {
    /// A board with the settings of its HITL guide.
    fn good() -> Board {
        let parameters = [
            ("SYS_HITL", 1),
            ("MAV_0_CONFIG", 101),
            ("MAV_0_RATE", 0),
            ("SER_TEL1_BAUD", 921_600),
            ("MAV_1_CONFIG", 0),
            ("MAV_1_RATE", 0),
            ("MAV_2_CONFIG", 0),
            ("MAV_2_RATE", 100_000),
        ];
        Board {
            system: 7,
            parameters: parameters.into(),
            usb: false,
            estimates: true,
            roll: |t| 20.0 * (-3.0 * t).exp(),
            loses: 0,
            off: 0.0..0.0,
            awake: false,
            fed_since: None,
            interval: [(attitude::ID, NANOS / 10)].into(),
            asked: BTreeMap::new(),
            decoder: Decoder::new(),
            seq: 0,
        }
    }

    fn with(mut self, name: &'static str, value: i32) -> Board {
        self.parameters.insert(name, value);
        self
    }

    fn hears(&self) -> bool {
        let get = |name| self.parameters.get(name).copied().unwrap_or(0);
        let rate = match get("MAV_0_RATE") {
            0 => get("SER_TEL1_BAUD") / 20,
            rate => rate,
        };
        get("SYS_HITL") == 1 && (self.usb || rate > 5000)
    }

    fn say(&mut self, message: &Message, out: &mut Vec<u8>) {
        let header = Header { version: Version::V2, seq: self.seq, system: self.system, component: 1 };
        self.seq = self.seq.wrapping_add(1);
        out.extend(packet(header, message));
    }

    /// Handles bytes sent to it.
    fn take(&mut self, bytes: &[u8], out: &mut Vec<u8>) {
        let mut decoder = self.decoder.clone();
        decoder.feed(bytes, |received| match received.unwrap().message.unwrap() {
            Message::Heartbeat(beat) => self.awake |= beat.kind == GROUND_STATION,
            Message::ParamRequestRead(request) => {
                assert_eq!((request.target_system, request.target_component), (self.system, 1));
                assert_eq!(request.param_index, -1);
                let name = param_name(&request.param_id).to_string();
                let asked = self.asked.entry(name.clone()).or_default();
                *asked += 1;
                if *asked > self.loses
                    && let Some(value) = self.parameters.get(name.as_str())
                {
                    let value = param_value::Repr {
                        param_value: f32::from_bits(value.cast_unsigned()),
                        param_id: request.param_id,
                        param_type: param_value::INT32,
                        ..Default::default()
                    };
                    self.say(&Message::ParamValue(value), out);
                }
            }
            Message::CommandLong(command) => {
                assert_eq!((command.target_system, command.target_component), (self.system, 1));
                assert_eq!(command.command, command_long::SET_MESSAGE_INTERVAL);
                self.interval.insert(command.params[0] as u32, (command.params[1] * 1000.0) as i64);
                let ack = command_ack::Repr { command: command.command, ..Default::default() };
                self.say(&Message::CommandAck(ack), out);
            }
            other => panic!("{other:?}"),
        });
        self.decoder = decoder;
    }

    /// What it sends in this step.
    fn step(&mut self, now: i64, fed: bool, out: &mut Vec<u8>) {
        if !self.awake || self.off.contains(&(now as f64 * 1e-9)) {
            self.fed_since = None;
            return;
        }
        if now % NANOS == 0 {
            let hil = if self.parameters["SYS_HITL"] == 1 { 0x20 } else { 0 };
            self.say(&beat(12, 0x81 | hil), out);
        }
        if fed && self.estimates && (self.hears() || self.parameters["SYS_HITL"] == 0) {
            let since = *self.fed_since.get_or_insert(now);
            let roll = (self.roll)((now - since) as f64 * 1e-9).to_radians();
            let ms = (now / 1_000_000) as u32;
            for (id, interval) in self.interval.clone() {
                if now % interval == 0 {
                    let (sin, cos) = (roll / 2.0).sin_cos();
                    let told = match id {
                        attitude::ID => euler(ms, [roll as f32, 0.0, 0.0]),
                        _ => quaternion(ms, [cos as f32, sin as f32, 0.0, 0.0]),
                    };
                    self.say(&told, out);
                }
            }
        }
    }
}

/// The record of a conversation.
#[derive(Default)]
struct Talk {
    notices: Vec<(f64, String)>,
    stages: Vec<(f64, Stage)>,
    estimates: Vec<f64>,
    replies: Vec<(f64, Header, Message)>,
    system: Option<u8>,
}

impl Talk {
    fn notices(&self) -> Vec<&str> {
        self.notices.iter().map(|(_, notice)| notice.as_str()).collect()
    }

    /// When a stage was reached.
    fn when(&self, stage: Stage) -> Option<f64> {
        self.stages.iter().find(|(_, at)| *at == stage).map(|(t, _)| *t)
    }
}

/// Talks with a board for this many seconds.
fn talk(mut board: Board, seconds: i64) -> Talk {
    let mut dialogue = Mavlink::new(Some(Controller::Px4));
    let mut talk = Talk::default();
    for now in (0..seconds * NANOS).step_by(STEP as usize) {
        let t = now as f64 * 1e-9;
        let mut out = Vec::new();
        let mut words = Vec::new();
        board.step(now, dialogue.stage() >= Stage::Still, &mut out);
        words.extend(hear(&mut dialogue, &out, now));
        dialogue.tick(now, &mut |said| words.push(Word::of(&said)));
        out.clear();
        for word in words {
            match word {
                Word::Estimate(_) => talk.estimates.push(t),
                Word::Reply(bytes) => {
                    assert!(bytes.len() <= MAX_PACKET);
                    let (header, message) = message(&bytes);
                    talk.replies.push((t, header, message));
                    board.take(&bytes, &mut out);
                }
                Word::Notice(notice) | Word::Restart(notice) => talk.notices.push((t, notice)),
                Word::Took | Word::Pass(_) => {}
            }
        }
        hear(&mut dialogue, &out, now);
        if talk.stages.last().is_none_or(|(_, stage)| *stage != dialogue.stage()) {
            talk.stages.push((t, dialogue.stage()));
        }
    }
    talk.system = dialogue.peer().system;
    assert_eq!(dialogue.damaged(), 0);
    talk
}

#[test]
fn px4_is_woken_fed_and_played_to_once_its_estimator_is_steady() {
    let talk = talk(Board::good(), 20);
    assert_eq!(talk.notices(), [""; 0]);
    assert_eq!(talk.system, Some(7));
    let (still, ready) = (talk.when(Stage::Still).unwrap(), talk.when(Stage::Ready).unwrap());
    assert!(talk.stages[0] == (0.0, Stage::Silent) && (0.5..=1.5).contains(&still), "{:?}", talk.stages);
    // 20°·e^(−3t) is within 0.2° of its end from t = 1.54 s, and must stay so for 2 s.
    assert!((still + 3.5..still + 3.65).contains(&ready), "{:?}", talk.stages);
    let late = talk.estimates.iter().filter(|t| **t >= 10.0).count();
    assert!((490..=510).contains(&late), "{late} of 500: 50 Hz, and each estimate once");
    let asked = talk.replies.iter().filter(|(_, _, message)| matches!(message, Message::CommandLong(_)));
    assert_eq!(asked.count(), 2, "what is granted is not asked for again");
}

#[test]
fn our_words_are_those_of_another_component_of_its_system_and_none_is_missing() {
    let talk = talk(Board::good(), 10);
    let own = talk.replies.iter().map(|(_, header, _)| header).filter(|header| header.system == 7);
    for (i, header) in own.enumerate() {
        assert_eq!((header.component, header.seq), (voice::COMPONENT, i as u8));
        assert_ne!(header.component, COMPONENT, "the samples count for themselves");
    }
    let spread: Vec<_> = talk.replies.windows(2).map(|pair| pair[1].0 - pair[0].0).collect();
    assert!(spread.iter().filter(|gap| **gap < 0.005).count() <= 1, "no burst among the samples: {spread:?}");
}

#[test]
fn each_wrong_parameter_is_named_with_what_would_be_right() {
    let low = "MAV_0_RATE is 1200 B/s: PX4 ignores HIL_SENSOR below 5000 B/s; set MAV_0_RATE to 0 and reboot";
    let both = "set MAV_0_RATE to 0 and SER_TEL1_BAUD to 921600 and reboot (MAV_0 is TELEM 1";
    let baud = "SER_TEL1_BAUD is 57600: MAV_0_RATE = 0 gives MAVLink a twentieth of it, 2880 B/s";
    let hitl = "SYS_HITL is 0: set it to 1 and reboot";
    let slow = || Board::good().with("MAV_0_RATE", 1200);
    for (board, expected) in [
        (slow(), vec![low]),
        (Board { loses: 3, ..slow() }, vec![low]),
        (slow().with("SER_TEL1_BAUD", 57_600), vec![both]),
        (Board::good().with("SER_TEL1_BAUD", 57_600), vec![baud]),
        (slow().with("MAV_1_CONFIG", 102).with("MAV_1_RATE", 5000), vec![low, "MAV_1_RATE is 5000 B/s"]),
        (slow().with("SYS_HITL", 0), vec![hitl]),
        (Board { usb: true, ..slow() }, vec![]),
        (Board::good().with("MAV_0_RATE", 5001), vec![]),
    ] {
        let talk = talk(board, 9);
        assert_eq!(talk.notices.len(), expected.len(), "{:?}", talk.notices);
        for (notice, part) in talk.notices().iter().zip(&expected) {
            assert!(notice.contains(part), "{notice} lacks {part}");
        }
        assert_eq!(talk.when(Stage::Ready).is_some(), expected.is_empty());
    }
}

#[test]
fn a_controller_without_some_parameters_is_judged_by_those_it_has() {
    let mut board = Board::good().with("MAV_0_RATE", 1200);
    board.parameters.retain(|name, _| ["SYS_HITL", "MAV_0_RATE"].contains(name));
    assert!(talk(board, 9).notices()[0].starts_with("MAV_0_RATE is 1200 B/s"));
    let mut board = Board { usb: true, ..Board::good() };
    board.parameters.retain(|name, _| *name == "SYS_HITL");
    let talk = talk(board, 12);
    assert!(talk.notices().is_empty() && talk.when(Stage::Ready).is_some());
    let mut asked: BTreeMap<_, u32> = BTreeMap::new();
    for (_, _, message) in &talk.replies {
        if let Message::ParamRequestRead(request) = message {
            *asked.entry(param_name(&request.param_id).to_string()).or_default() += 1;
        }
    }
    assert_eq!(
        (asked["SYS_HITL"], asked["MAV_0_RATE"]),
        (1, 5),
        "asked for until it comes, and not for ever"
    );
}

#[test]
fn one_that_beats_but_does_not_hear_is_told_of_once_with_the_causes_in_order() {
    let talk = talk(Board { estimates: false, ..Board::good() }, 40);
    let [(at, notice)] = &talk.notices[..] else { panic!("{:?}", talk.notices) };
    assert!((10.0..=12.0).contains(at));
    assert!(notice.contains("(1) this link's data rate") && !notice.contains("SYS_HITL"), "{notice}");
    assert_eq!(talk.when(Stage::Ready), None);
}

#[test]
fn an_estimator_that_never_settles_is_never_played_to() {
    let drifting = Board { roll: |t| 0.15 * t, ..Board::good() };
    let shaking = Board { roll: |t| 0.3 * (40.0 * t).sin(), ..Board::good() };
    for board in [drifting, shaking] {
        assert_eq!(talk(board, 20).when(Stage::Ready), None);
    }
}

#[test]
fn a_steady_attitude_of_its_own_sensors_starts_nothing() {
    let talk = talk(Board::good().with("SYS_HITL", 0), 20);
    assert!(talk.estimates.len() > 100, "it has one");
    assert_eq!(talk.when(Stage::Ready), None);
}

#[test]
fn a_heartbeat_without_hil_is_told_of() {
    let mut dialogue = Mavlink::new(Some(Controller::Px4));
    let mut notices = Vec::new();
    for k in 0..1000 {
        if k % 100 == 0 {
            hear(&mut dialogue, &from(1, 1, &beat(12, 0x81)), k * STEP);
        }
        dialogue.tick(k * STEP, &mut |said| {
            if let Said::Notice(notice) = said {
                notices.push(notice);
            }
        });
    }
    let [notice] = &notices[..] else { panic!("{notices:?}") };
    assert!(notice.contains("base_mode 0x81 lacks 0x20") && notice.contains("set SYS_HITL to 1"), "{notice}");
}

#[test]
fn one_that_boots_anew_is_asked_anew() {
    let board = Board { estimates: false, off: 6.0..12.5, ..Board::good() };
    let talk = talk(board, 30);
    let notices: Vec<_> = talk.notices.iter().map(|(t, notice)| (t.round() as i64, &notice[..16])).collect();
    assert_eq!(notices, [(9, "no heartbeat for"), (23, "the controller b")], "{:?}", talk.notices);
    let again = talk
        .replies
        .iter()
        .filter(|(t, _, message)| *t > 12.5 && matches!(message, Message::ParamRequestRead(_)));
    assert_eq!(again.count(), 8);
}

#[test]
fn one_whose_clock_goes_back_has_restarted_and_is_asked_for_its_attitude_again() {
    let mut dialogue = Mavlink::new(None);
    hear(&mut dialogue, &from(1, 1, &beat(12, 0)), 0);
    let asks = |dialogue: &mut Mavlink, now| {
        let mut words = Vec::new();
        dialogue.tick(now, &mut |said| words.push(Word::of(&said)));
        words.iter().filter(|word| matches!(word, Word::Reply(_))).count()
    };
    let tell = |dialogue: &mut Mavlink, ms: u32, now| {
        said(hear(dialogue, &from(1, 1, &quaternion(ms, [1.0, 0.0, 0.0, 0.0])), now))
    };
    // Two seconds of both messages at 50 Hz: nothing is missing.
    for k in 0..100_u32 {
        let now = i64::from(k) * 20_000_000;
        assert!(
            tell(&mut dialogue, 100_000 + 20 * k, now).iter().all(|word| matches!(word, Word::Estimate(_)))
        );
        hear(&mut dialogue, &from(1, 1, &euler(100_000 + 20 * k, [0.0; 3])), now);
    }
    assert_eq!(asks(&mut dialogue, 2_000_000_000), 0);
    // A packet that overtook another is no restart.
    assert_eq!(tell(&mut dialogue, 101_900, 2_010_000_000).len(), 1);
    let words = tell(&mut dialogue, 700, 2_600_000_000);
    let [Word::Restart(notice), Word::Estimate(_)] = &words[..] else { panic!("{words:?}") };
    assert_eq!(notice, "the controller has restarted: its clock went back from 101.9 s to 0.7 s");
    assert_eq!(asks(&mut dialogue, 2_610_000_000), 1, "at once, although it flowed in the second before");
    // The 32 bits of its clock wrap after 49.7 days.
    assert_eq!(tell(&mut dialogue, u32::MAX - 10, 3_000_000_000).len(), 1);
    assert_eq!(tell(&mut dialogue, 9, 3_020_000_000).len(), 1);
}

#[test]
fn an_attitude_that_stops_is_asked_for_again_although_it_was_granted() {
    let mut dialogue = Mavlink::new(None);
    hear(&mut dialogue, &from(1, 1, &beat(12, 0)), 0);
    let asked = |dialogue: &mut Mavlink, now: i64| {
        let mut ids = Vec::new();
        dialogue.tick(now, &mut |said| {
            if let Said::Reply(bytes) = said
                && let (_, Message::CommandLong(command)) = message(bytes)
            {
                ids.push(command.params[0] as u32);
            }
        });
        ids
    };
    let grant =
        from(1, 1, &Message::CommandAck(command_ack::Repr { command: 511, result: 0, ..Default::default() }));
    for step in 0..4 {
        let now = step * 500_000_000;
        if !asked(&mut dialogue, now).is_empty() {
            hear(&mut dialogue, &grant, now);
        }
    }
    assert!(asked(&mut dialogue, 3_000_000_000).is_empty(), "both are granted, although none has come");
    for k in 0..100 {
        let now = 3_000_000_000 + k * 20_000_000;
        hear(&mut dialogue, &from(1, 1, &quaternion(k as u32 * 20, [1.0, 0.0, 0.0, 0.0])), now);
    }
    assert!(asked(&mut dialogue, 5_500_000_000).is_empty());
    assert_eq!(asked(&mut dialogue, 7_500_000_000), [31], "the one that flowed, and stopped");
}

#[test]
fn a_link_on_which_nobody_beats_is_told_of_once() {
    let mut dialogue = Mavlink::new(Some(Controller::Px4));
    let (mut notices, mut beats) = (0, 0);
    for k in 0..2000 {
        dialogue.tick(k * STEP, &mut |said| match said {
            Said::Notice(notice) => notices += u32::from(notice.contains("no heartbeat")),
            Said::Reply(bytes) => beats += u32::from(matches!(message(bytes).1, Message::Heartbeat(_))),
            _ => {}
        });
    }
    assert_eq!((notices, beats, dialogue.stage()), (1, 20, Stage::Silent));
}

#[test]
fn px4_in_sitl_is_fed_at_once_and_played_to_when_it_answers() {
    let mut dialogue = Mavlink::new(Some(Controller::Px4Sitl));
    assert_eq!(dialogue.stage(), Stage::Still);
    let wants = Message::CommandLong(command_long::Repr { command: 511, ..Default::default() });
    for greeting in [from(1, 1, &wants), from(1, 1, &beat(12, 0x20)), from(1, 1, &actuators(0))] {
        assert_eq!(said(hear(&mut dialogue, &greeting, 0)), []);
    }
    assert_eq!(dialogue.stage(), Stage::Ready, "even one that is not in lockstep answers");
    let mut dialogue = Mavlink::new(Some(Controller::Px4Sitl));
    (0..1000).for_each(|k| dialogue.tick(k * STEP, &mut |said| panic!("{said:?}")));
    assert_eq!(dialogue.stage(), Stage::Still);
    assert_eq!(hear(&mut dialogue, &from(1, 1, &actuators(1)), NANOS), [Word::Took]);
    assert_eq!(dialogue.stage(), Stage::Ready);
}

#[test]
fn without_a_controller_by_name_nothing_is_waited_for() {
    for controller in [None, Some(Controller::Ardupilot)] {
        let mut dialogue = Mavlink::new(controller);
        assert_eq!((dialogue.stage(), dialogue.peer().system), (Stage::Ready, None));
        hear(&mut dialogue, &from(9, 1, &beat(3, 0)), 0);
        assert_eq!((dialogue.stage(), dialogue.peer().system), (Stage::Ready, Some(9)));
        let mut asked = Vec::new();
        for k in 0..300 {
            dialogue.tick(k * STEP, &mut |said| {
                let Said::Reply(bytes) = said else { panic!("{said:?}") };
                let Message::CommandLong(command) = message(bytes).1 else { panic!("{said:?}") };
                assert_eq!((command.params[1], command.target_system), (20_000.0, 9));
                asked.push(command.params[0] as u32);
            });
        }
        assert_eq!(asked, [31, 30, 31, 30, 31, 30], "in turn, until one answers");
    }
}

#[test]
fn a_refused_message_is_not_asked_for_again_and_a_busy_one_is() {
    for (result, asked) in
        [(0, 2), (3, 2), (command_ack::IN_PROGRESS, 8), (command_ack::TEMPORARILY_REJECTED, 8)]
    {
        let mut dialogue = Mavlink::new(None);
        hear(&mut dialogue, &from(1, 1, &beat(12, 0)), 0);
        let ack = Message::CommandAck(command_ack::Repr { command: 511, result, ..Default::default() });
        let mut count = 0;
        for k in 0..400 {
            let mut heard = false;
            dialogue.tick(k * STEP, &mut |_| heard = true);
            if heard {
                count += 1;
                hear(&mut dialogue, &from(1, 1, &ack), k * STEP);
            }
        }
        assert_eq!(count, asked, "result {result}");
    }
}

#[test]
fn questions_after_the_clock_are_answered_and_answers_are_not() {
    for version in [Version::V1, Version::V2] {
        let mut dialogue = Mavlink::new(None);
        let header = Header { version, seq: 0, system: 3, component: 1 };
        hear(&mut dialogue, &packet(header, &beat(12, 0)), 0);
        let question = Message::Timesync(timesync::Repr { tc1: 0, ts1: 123_456_789 });
        let words = said(hear(&mut dialogue, &packet(header, &question), 42));
        let [Word::Reply(bytes)] = &words[..] else { panic!("{words:?}") };
        let (header, reply) = message(bytes);
        assert_eq!(reply, Message::Timesync(timesync::Repr { tc1: 42, ts1: 123_456_789 }));
        assert_eq!((header.version, header.system), (version, 3), "in the version it was asked in");
        let answer = Message::Timesync(timesync::Repr { tc1: 7, ts1: 8 });
        assert_eq!(said(hear(&mut dialogue, &from(3, 1, &answer), 43)), []);
    }
}

#[test]
fn attitude_is_an_estimate_of_its_own_clock_and_told_twice_counts_once() {
    let mut dialogue = Mavlink::new(None);
    let (roll, pitch, yaw) = (0.5f32, -0.25f32, 3.0f32);
    let angles = Euler { roll: roll.into(), pitch: pitch.into(), yaw: yaw.into() };
    let one = |words: Vec<Word>| {
        let [Word::Estimate(estimate)] = said(words)[..] else { panic!() };
        estimate
    };
    let seen = one(hear(&mut dialogue, &from(1, 1, &euler(1500, [roll, pitch, yaw])), 0));
    assert_eq!(seen.stamp, Stamp::Own(1_500_000_000));
    assert!(seen.attitude.angle_to(Attitude::from_quat(angles.to_quat())) < 1e-7);
    // 90° to the right, its nose to the east: forward is east.
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let seen = one(hear(&mut dialogue, &from(1, 1, &quaternion(1520, [half, 0.0, 0.0, half])), STEP));
    let nose = seen.attitude.apply(crate::geometry::Vector::new(1.0, 0.0, 0.0)).v;
    assert!((nose - glam::DVec3::Y).length() < 1e-6, "{nose}");
    let twice = hear(&mut dialogue, &from(1, 1, &euler(1520, [roll, pitch, yaw])), 2 * STEP);
    assert_eq!(said(twice), []);
    let alone = hear(&mut dialogue, &from(1, 1, &euler(3000, [roll, pitch, yaw])), 3 * NANOS);
    one(alone);
    for bad in [[0.0; 4], [f32::NAN, 0.0, 0.0, 0.0], [0.1; 4]] {
        assert_eq!(said(hear(&mut dialogue, &from(1, 1, &quaternion(1, bad)), 4 * NANOS)), []);
    }
    assert_eq!(dialogue.damaged(), 3);
}

#[test]
fn only_the_autopilot_is_listened_to() {
    let mut dialogue = Mavlink::new(None);
    let station =
        Message::Heartbeat(heartbeat::Repr { kind: GROUND_STATION, autopilot: 3, ..Default::default() });
    hear(&mut dialogue, &from(255, 190, &station), 0);
    hear(&mut dialogue, &from(1, 154, &beat(NO_AUTOPILOT, 0)), 0);
    assert_eq!(dialogue.peer().system, None);
    hear(&mut dialogue, &from(4, 1, &beat(12, 0)), 0);
    hear(&mut dialogue, &from(5, 1, &beat(12, 0)), 0);
    assert_eq!(dialogue.peer().system, Some(4), "the first one");
    let level = quaternion(1, [1.0, 0.0, 0.0, 0.0]);
    assert_eq!(said(hear(&mut dialogue, &from(5, 1, &level), 0)), []);
    assert_eq!(said(hear(&mut dialogue, &from(4, 1, &level), 0)).len(), 1);
    assert_eq!(said(hear(&mut dialogue, &from(4, 1, &actuators(0)), 0)), [], "lockstep is a bit");
}

#[test]
fn a_ground_station_sees_every_message_but_the_simulators() {
    let mut dialogue = Mavlink::new(None);
    // An unknown id from another sender.
    let unknown = vec![0xfd, 2, 0, 0, 9, 5, 1, 0xff, 0xff, 0, 7, 8, 0x12, 0x34];
    let time = from(1, 1, &Message::SystemTime(system_time::Repr { time_unix_usec: 1, time_boot_ms: 2 }));
    let shown = [from(1, 1, &beat(12, 0)), unknown, time, from(255, 190, &beat(NO_AUTOPILOT, 0))];
    let hil = from(1, 1, &Message::HilSensor(hil_sensor::Repr::default()));
    let hidden = [hil, from(1, 1, &actuators(1)), from(1, COMPONENT, &beat(12, 0))];
    let stream = [&shown[..2], &hidden[..], &shown[2..]].concat().concat();
    let mut passed = Vec::new();
    for piece in stream.chunks(7) {
        let words = hear(&mut dialogue, piece, 0);
        passed.extend(words.into_iter().filter_map(|word| match word {
            Word::Pass(bytes) => Some(bytes),
            _ => None,
        }));
    }
    assert_eq!(passed, shown);
    assert_eq!(dialogue.peer().system, Some(1), "our own heartbeat, looped back, is nobody's");
}

#[test]
fn noise_that_looks_like_a_long_packet_does_not_hide_what_follows() {
    let mut dialogue = Mavlink::new(None);
    let noise = [0xfd, 0xff, 0, 0];
    assert_eq!(hear(&mut dialogue, &[&noise[..], &from(6, 1, &beat(12, 0))].concat(), 0), []);
    let mut after = Vec::new();
    (0..=11).for_each(|k| dialogue.tick(k * STEP, &mut |said| after.push(Word::of(&said))));
    assert_eq!(dialogue.peer().system, Some(6), "a tenth of a second later");
    assert_eq!(after[0], Word::Pass(from(6, 1, &beat(12, 0))));
    assert_eq!(dialogue.damaged(), 1, "the noise");
    // A packet in two pieces with less than a pause between them is whole.
    let bytes = from(6, 1, &actuators(1));
    assert_eq!(hear(&mut dialogue, &bytes[..9], NANOS), []);
    (0..=9).for_each(|k| dialogue.tick(NANOS + k * STEP, &mut |_| {}));
    assert_eq!(hear(&mut dialogue, &bytes[9..], NANOS + 10 * STEP - 1), [Word::Took]);
}

/// Whole messages of every kind that is acted on, and bytes that are none.
fn any_stream() -> impl Strategy<Value = Vec<u8>> {
    let kinds = prop_oneof![
        any::<(u8, u8)>().prop_map(|(autopilot, mode)| beat(autopilot % 16, mode)),
        any::<(u32, [f32; 4])>().prop_map(|(ms, q)| quaternion(ms, q)),
        any::<(u32, [f32; 3])>().prop_map(|(ms, angles)| euler(ms, angles)),
        any::<u64>().prop_map(actuators),
        any::<(bool, i64)>()
            .prop_map(|(asks, ts1)| Message::Timesync(timesync::Repr { tc1: i64::from(!asks), ts1 })),
        any::<(u32, u8, prop::sample::Index)>().prop_map(|(bits, param_type, which)| {
            let names = ["SYS_HITL", "MAV_0_RATE", "MAV_0_CONFIG", "SER_TEL1_BAUD", "OTHER"];
            let param_id = mavlink::param_id(names[which.index(names.len())]);
            let param_value = f32::from_bits(bits);
            Message::ParamValue(param_value::Repr { param_value, param_id, param_type, ..Default::default() })
        }),
        any::<(u16, u8)>().prop_map(|(command, result)| {
            Message::CommandAck(command_ack::Repr { command, result, ..Default::default() })
        }),
    ];
    let whole = (any::<(bool, u8, u8)>(), kinds).prop_map(|((v1, system, component), message)| {
        let version = if v1 { Version::V1 } else { Version::V2 };
        packet(Header { version, seq: 0, system: system % 3, component: component % 60 }, &message)
    });
    let noise = prop::collection::vec(prop_oneof![Just(0xfd), Just(0xfe), any::<u8>()], 0..40);
    let pieces = prop::collection::vec(prop_oneof![4 => whole, 1 => noise], 0..40);
    pieces.prop_map(|pieces| pieces.concat())
}

proptest! {
    #[test]
    fn no_bytes_panic_and_it_matters_not_how_they_are_cut(
        bytes in any_stream(),
        cut in 1..100usize,
        controller in prop::sample::select(vec![None, Some(Controller::Px4), Some(Controller::Px4Sitl)]),
    ) {
        let run = |cut: usize| {
            let mut dialogue = Mavlink::new(controller);
            let mut words = Vec::new();
            for piece in bytes.chunks(cut) {
                words.extend(hear(&mut dialogue, piece, NANOS));
            }
            for k in 0..1500 {
                dialogue.tick(NANOS + k * STEP, &mut |said| words.push(Word::of(&said)));
            }
            (words, dialogue.stage(), dialogue.peer(), dialogue.damaged())
        };
        let (words, stage, peer, damaged) = run(cut);
        for word in &words {
            if let Word::Reply(bytes) = word {
                prop_assert!(bytes.len() <= MAX_PACKET);
                message(bytes);
            }
        }
        let notices: Vec<_> = words.iter().filter(|word| matches!(word, Word::Notice(_))).collect();
        prop_assert_eq!(notices.iter().map(|word| format!("{word:?}")).collect::<BTreeSet<_>>().len(), notices.len());
        prop_assert_eq!((words, stage, peer, damaged), run(bytes.len().max(1)));
    }
}
