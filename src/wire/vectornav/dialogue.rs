//! `vectornav`: a VN-100 that is set up by ArduPilot's driver or by PX4's.
//!
//! The controller speaks first, sends each command again until it is answered, and goes no further before it is. A
//! write is answered by itself, a register that is read by its contents, anything else by an error. What it asks for
//! decides what it is sent: each firmware has its own outputs. ArduPilot's boot waits for the last answer; PX4 begins
//! again after an error, except to the third output, which it does without.

mod command;

use crate::time::Rate;
use crate::wire::Controller;
use crate::wire::dialogue::{Dialogue, Pause, Peer, Said, Stage};
use command::{Command, ERROR};
use ratetable_protocols::Error;
use ratetable_protocols::vectornav::line::Line;
use ratetable_protocols::vectornav::{Decoder, MAX_LEN, Packet, encode};

/// How long nothing is asked before that is said, ns.
const PATIENCE: i64 = 10_000_000_000;
/// How long PX4's last command is waited for after the one before, ns: the stream does not depend on it.
const LAST: i64 = 1_000_000_000;
/// So long after a change of speed what comes is noise of the one before, ns: PX4 would take an error for an answer.
const NOISE: i64 = 100_000_000;

/// One link to a flight controller that takes this for its VN-100.
pub(super) struct Unit {
    decoder: Decoder,
    damaged: u64,
    stage: Stage,
    /// Whom it was started for.
    expected: Option<Controller>,
    /// What was asked for so far.
    peer: Peer,
    /// Register 35: how the unit's own filter is to work.
    filter: String,
    since: Option<i64>,
    /// When PX4 asked for its second output, until it asks for the third.
    second_at: Option<i64>,
    /// When the speed was changed.
    changed_at: Option<i64>,
    pause: Pause,
    asked: bool,
    told_silence: bool,
}

impl Unit {
    /// With a controller, its handshake comes before the scene; else it is played to at once.
    pub(super) fn new(controller: Option<Controller>) -> Unit {
        let stage = if controller.is_some() { Stage::Silent } else { Stage::Ready };
        Unit {
            decoder: Decoder::new(),
            damaged: 0,
            stage,
            expected: controller,
            peer: Peer::default(),
            filter: "1,1,1,1".into(),
            since: None,
            second_at: None,
            changed_at: None,
            pause: Pause::default(),
            asked: false,
            told_silence: false,
        }
    }

    fn take(&mut self, received: Result<Packet, Error>, now: i64, say: &mut dyn FnMut(Said<'_>)) {
        match received {
            Ok(Packet::Line(line)) => self.obey(&line, now, say),
            // Our own, on a link that echoes.
            Ok(_) => {}
            Err(_) => {
                self.damaged += 1;
                if self.changed_at.is_none_or(|changed_at| now - changed_at >= NOISE) {
                    reply(ERROR, say);
                }
            }
        }
    }

    fn obey(&mut self, line: &Line, now: i64, say: &mut dyn FnMut(Said<'_>)) {
        self.asked = true;
        match Command::of(line) {
            Command::Nothing => reply(line.text(), say),
            Command::Read(contents) => reply(contents, say),
            Command::ReadFilter => reply(&format!("VNRRG,35,{}", self.filter), say),
            Command::Filter(settings) => {
                self.filter = settings.into();
                reply(line.text(), say);
            }
            Command::Pause => {
                self.tell_restart(say);
                reply(line.text(), say);
            }
            Command::Speed(baud) => {
                self.tell_restart(say);
                reply(line.text(), say);
                self.changed_at = Some(now);
                say(Said::Speed(baud));
            }
            Command::First(whose, rate) => {
                self.ask_rate(whose, rate, say);
                reply(line.text(), say);
            }
            Command::Second(whose, rate) => {
                self.peer.second = Some(rate);
                self.second_at = (whose == Controller::Px4Vectornav).then_some(now);
                reply(line.text(), say);
            }
            Command::Third => {
                reply(ERROR, say);
                self.begin();
            }
            Command::Stream => {
                reply(line.text(), say);
                self.begin();
            }
            Command::Error => {}
            Command::Unknown => {
                say(Said::Notice(format!(
                    "the flight controller asks for {:?}, which this VN-100 does not do: it is answered with error 12",
                    line.text()
                )));
                reply(ERROR, say);
            }
        }
    }

    /// The end of a handshake.
    fn begin(&mut self) {
        self.second_at = None;
        self.stage = Stage::Ready;
    }

    /// A handshake begins; where one has ended before, the controller has booted again.
    fn tell_restart(&self, say: &mut dyn FnMut(Said<'_>)) {
        if self.stage == Stage::Ready && self.peer.rate.is_some() {
            say(Said::Restart("the flight controller has restarted: it is answered again".into()));
        }
    }

    /// Before the stream has begun it is all the same; after that it changes.
    fn ask_rate(&mut self, whose: Controller, rate: Rate, say: &mut dyn FnMut(Said<'_>)) {
        if self.stage == Stage::Ready && self.peer.rate != Some(rate) {
            let before = self.peer.rate.map_or("the gyro's rate".into(), |rate| rate.to_string());
            say(Said::Notice(format!(
                "the flight controller asks for its samples at {rate}: the stream changes to that from {before}"
            )));
        }
        if self.peer.controller != Some(whose) {
            self.peer.second = None;
        }
        self.peer = Peer { rate: Some(rate), controller: Some(whose), ..self.peer };
    }

    /// What would make a controller ask that has not asked yet.
    fn silence(&self) -> String {
        let why = match self.expected {
            Some(Controller::Px4Vectornav) => {
                "PX4's driver does once a second or so (SENS_VN_CFG on this port, VN_MODE = 0), at 115200 baud first"
            }
            _ => {
                "ArduPilot does at its boot (EAHRS_TYPE = 1, SERIALn_PROTOCOL = 36, SERIALn_BAUD as here), so restart it now"
            }
        };
        format!("nobody has asked for a VN-100 yet: {why}")
    }
}

impl Dialogue for Unit {
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
        if self.second_at.is_some_and(|second_at| now - second_at >= LAST) {
            self.begin();
        }
        let since = *self.since.get_or_insert(now);
        let silent = self.stage == Stage::Silent && !self.asked && now - since >= PATIENCE;
        if silent && !std::mem::replace(&mut self.told_silence, true) {
            say(Said::Notice(self.silence()));
        }
    }

    fn stage(&self) -> Stage {
        self.stage
    }

    fn peer(&self) -> Peer {
        self.peer
    }

    fn damaged(&self) -> u64 {
        self.damaged
    }
}

fn reply(text: &str, say: &mut dyn FnMut(Said<'_>)) {
    let mut buffer = [0; MAX_LEN];
    // Every answer is a line, and MAX_LEN holds every line.
    let len = Line::new(text).and_then(|line| encode(&Packet::Line(line), &mut buffer)).unwrap_or(0);
    say(Said::Reply(&buffer[..len]));
}

#[cfg(test)]
mod tests {
    use super::command::MODEL;
    use super::*;
    use crate::wire::dialogue::PAUSE;
    use proptest::prelude::*;

    /// Replies as text, notices behind a `#`.
    fn hear(unit: &mut Unit, bytes: &[u8]) -> String {
        let mut heard = String::new();
        unit.hear(bytes, 0, &mut |said| match said {
            Said::Reply(bytes) => heard += std::str::from_utf8(bytes).unwrap(),
            Said::Notice(text) | Said::Restart(text) => heard += &format!("#{text}\n"),
            Said::Speed(baud) => heard += &format!("@{baud}\n"),
            other => panic!("{other:?}"),
        });
        heard
    }

    /// The commands of ArduPilot's driver that asks for 100 Hz, in order.
    const HANDSHAKE: [&str; 7] = [
        "$VNASY,0*4F\r\n",
        "$VNWRG,06,0,1*71\r\n",
        "$VNWRG,06,0,2*72\r\n",
        "$VNRRG,01*72\r\n",
        "$VNWRG,75,3,8,01,0721*7A\r\n",
        "$VNWRG,76,3,16,11,0001,0106*69\r\n",
        "$VNASY,1*4E\r\n",
    ];

    fn shake_hands(unit: &mut Unit) {
        for command in HANDSHAKE {
            let answer = if command.contains("RRG") { "$VNRRG,01,VN-100T-CR*32\r\n" } else { command };
            assert_eq!(hear(unit, command.as_bytes()), answer);
        }
    }

    fn new() -> Unit {
        Unit::new(Some(Controller::Ardupilot))
    }

    #[test]
    fn every_command_is_echoed_and_the_last_one_lets_the_stream_begin_at_the_rate_asked_for() {
        let mut unit = new();
        for command in &HANDSHAKE[..6] {
            hear(&mut unit, command.as_bytes());
            assert_eq!(unit.stage(), Stage::Silent);
        }
        hear(&mut unit, HANDSHAKE[6].as_bytes());
        assert_eq!((unit.stage(), unit.peer().rate, unit.damaged()), (Stage::Ready, Some(Rate::hz(100)), 0));
        let peer = unit.peer();
        assert_eq!((peer.second, peer.controller), (Some(Rate::hz(50)), Some(Controller::Ardupilot)));
    }

    /// The conversation of PX4's driver at 200 Hz as measured, with what it is answered.
    const PX4: [(&str, &str); 14] = [
        ("VNRRG,01", "VNRRG,01,VN-100T-CR"),
        ("VNRRG,01", "VNRRG,01,VN-100T-CR"),
        ("VNWRG,5,921600", "VNWRG,5,921600"),
        ("VNRRG,01", "VNRRG,01,VN-100T-CR"),
        ("VNRRG,02", "VNRRG,02,7"),
        ("VNRRG,03", "VNRRG,03,100000001"),
        ("VNRRG,04", "VNRRG,04,2.1.0.0"),
        ("VNWRG,6,0", "VNWRG,6,0"),
        ("VNRRG,35", "VNRRG,35,1,1,1,1"),
        ("VNWRG,35,1,0,1,1", "VNWRG,35,1,0,1,1"),
        ("VNRRG,35", "VNRRG,35,1,0,1,1"),
        ("VNWRG,75,2,4,6,1,600", "VNWRG,75,2,4,6,1,600"),
        ("VNWRG,76,2,8,36,1,130,84,613", "VNWRG,76,2,8,36,1,130,84,613"),
        ("VNWRG,77,2,80,A,1,26B9", "VNERR,12"),
    ];

    fn line(text: &str) -> String {
        let mut bytes = [0; MAX_LEN];
        let len = encode(&Packet::Line(Line::new(text).unwrap()), &mut bytes).unwrap();
        std::str::from_utf8(&bytes[..len]).unwrap().to_owned()
    }

    fn for_px4() -> Unit {
        Unit::new(Some(Controller::Px4Vectornav))
    }

    fn shake_hands_with_px4(unit: &mut Unit) {
        for (command, answer) in PX4 {
            let speed = if command.contains(",5,") { "@921600\n" } else { "" };
            assert_eq!(hear(unit, line(command).as_bytes()), line(answer) + speed, "{command}");
        }
    }

    #[test]
    fn px4_is_answered_as_it_was_measured_and_its_port_is_set_behind_the_echo() {
        let mut unit = for_px4();
        for (command, answer) in &PX4[..13] {
            assert!(hear(&mut unit, line(command).as_bytes()).starts_with(&line(answer)));
            assert_eq!(unit.stage(), Stage::Silent, "{command}");
        }
        hear(&mut unit, line(PX4[13].0).as_bytes());
        let expected = Peer {
            system: None,
            rate: Some(Rate::hz(200)),
            second: Some(Rate::hz(100)),
            controller: Some(Controller::Px4Vectornav),
        };
        assert_eq!((unit.stage(), unit.peer(), unit.damaged()), (Stage::Ready, expected, 0));
        shake_hands_with_px4(&mut for_px4());
    }

    #[test]
    fn px4_is_not_waited_for_longer_than_a_second_once_its_outputs_are_known() {
        let mut unit = for_px4();
        PX4[..13].iter().for_each(|(command, _)| drop(hear(&mut unit, line(command).as_bytes())));
        unit.tick(999_999_999, &mut |_| {});
        assert_eq!(unit.stage(), Stage::Silent);
        unit.tick(1_000_000_000, &mut |_| {});
        assert_eq!(unit.stage(), Stage::Ready);
    }

    #[test]
    fn noise_of_a_change_of_speed_is_no_command_and_is_not_answered() {
        let mut unit = for_px4();
        hear(&mut unit, line("VNWRG,5,921600").as_bytes());
        let mut heard = 0;
        let noise = b"$VNRRG,01*00\r\n";
        unit.hear(noise, 99_999_999, &mut |_| heard += 1);
        assert_eq!((heard, unit.damaged()), (0, 1));
        unit.hear(line("VNRRG,01").as_bytes(), 99_999_999, &mut |_| heard += 1);
        unit.hear(noise, 100_000_000, &mut |_| heard += 1);
        assert_eq!((heard, unit.damaged()), (2, 2));
    }

    #[test]
    fn a_speed_or_an_output_that_a_vn_100_does_not_have_is_refused() {
        for unknown in [
            "VNWRG,5,921601",
            "VNWRG,5,-1",
            "VNWRG,75,2,0,6,1,600",
            "VNWRG,75,2,65536,6,1,600",
            "VNWRG,75,2,1,6,1,C",
            "VNWRG,76,2,0,36,1,130,84,613",
            "VNWRG,35,1,0,1",
        ] {
            let mut unit = for_px4();
            let heard = hear(&mut unit, line(unknown).as_bytes());
            assert!(heard.contains(unknown) && heard.ends_with(&line(ERROR)), "{heard}");
            assert!(!heard.contains('@') && unit.peer() == Peer::default());
        }
    }

    #[test]
    fn px4_that_restarts_with_another_rate_is_followed() {
        let mut unit = for_px4();
        shake_hands_with_px4(&mut unit);
        assert_eq!(hear(&mut unit, line("VNRRG,01").as_bytes()), line(MODEL));
        let heard = hear(&mut unit, line("VNWRG,5,921600").as_bytes());
        assert!(heard.starts_with("#the flight controller has restarted"), "{heard}");
        let faster = "VNWRG,75,2,1,6,1,600";
        let heard = hear(&mut unit, line(faster).as_bytes());
        assert!(heard.contains("800 Hz") && heard.contains("from 200 Hz"), "{heard}");
        assert!(heard.ends_with(&line(faster)));
        assert_eq!((unit.stage(), unit.peer().rate), (Stage::Ready, Some(Rate::hz(800))));
    }

    #[test]
    fn commands_may_come_again_and_in_pieces() {
        let mut unit = new();
        for command in HANDSHAKE {
            let answer = hear(&mut unit, command.as_bytes());
            assert_eq!(hear(&mut unit, command.as_bytes()).lines().last(), answer.lines().last());
            let pieces: Vec<_> = command.as_bytes().chunks(1).map(|byte| hear(&mut unit, byte)).collect();
            assert_eq!(pieces.concat().lines().last(), answer.lines().last());
        }
        assert_eq!((unit.stage(), unit.peer().rate), (Stage::Ready, Some(Rate::hz(100))));
    }

    #[test]
    fn what_is_damaged_or_not_known_is_answered_with_an_error_and_the_handshake_goes_on() {
        let mut unit = new();
        assert_eq!(hear(&mut unit, b"$VNASY,0*4E\r\n"), "$VNERR,12*72\r\n");
        for unknown in
            ["VNRRG,05", "VNWRG,75,3,8,01,0729", "VNWRG,75,3,0,01,0721", "VNWRG,75,3,x,01,0721", "VNWNV"]
        {
            let mut bytes = [0; MAX_LEN];
            let len = encode(&Packet::Line(Line::new(unknown).unwrap()), &mut bytes).unwrap();
            let heard = hear(&mut unit, &bytes[..len]);
            assert!(heard.contains(unknown) && heard.ends_with("$VNERR,12*72\r\n"), "{heard}");
        }
        assert_eq!((unit.stage(), unit.peer().rate, unit.damaged()), (Stage::Silent, None, 1));
        shake_hands(&mut unit);
        assert_eq!(unit.stage(), Stage::Ready);
    }

    #[test]
    fn every_bit_flipped_in_a_command_costs_that_command_and_nothing_more() {
        for command in HANDSHAKE {
            let bytes = command.as_bytes();
            for bit in 0..(bytes.len() - 2) * 8 {
                let mut hurt = bytes.to_vec();
                hurt[bit / 8] ^= 1 << (bit % 8);
                let mut unit = new();
                let heard = hear(&mut unit, &hurt);
                // A digit of the checksum in its small letter says the same.
                let at = bit / 8;
                let small = at >= bytes.len() - 4 && hurt[at].eq_ignore_ascii_case(&bytes[at]);
                assert!(!heard.contains(command) || small, "{heard}");
                assert_eq!(unit.stage() == Stage::Ready, small && command == HANDSHAKE[6]);
                if unit.stage() == Stage::Silent {
                    shake_hands(&mut unit);
                }
            }
        }
    }

    #[test]
    fn a_controller_that_restarts_is_answered_again_and_followed_to_a_new_rate() {
        let mut unit = new();
        shake_hands(&mut unit);
        let restarted = hear(&mut unit, HANDSHAKE[0].as_bytes());
        assert!(restarted.starts_with("#the flight controller has restarted"));
        assert!(restarted.ends_with(HANDSHAKE[0]));
        for command in &HANDSHAKE[1..] {
            assert_eq!(hear(&mut unit, command.as_bytes()).lines().count(), 1, "the same rate is no news");
        }
        let faster = hear(&mut unit, b"$VNWRG,75,3,4,01,0721*76\r\n");
        assert!(faster.contains("200 Hz") && faster.contains("100 Hz"), "{faster}");
        assert!(faster.ends_with("$VNWRG,75,3,4,01,0721*76\r\n"));
        assert_eq!((unit.stage(), unit.peer().rate), (Stage::Ready, Some(Rate::hz(200))));
    }

    #[test]
    fn an_echoing_link_is_no_conversation() {
        let mut unit = new();
        let first = hear(&mut unit, b"$VNXXX*00\r\n");
        assert_eq!(first, "$VNERR,12*72\r\n");
        assert_eq!(hear(&mut unit, first.as_bytes()), "");
        let mut bytes = [0; MAX_LEN];
        let len = encode(&Packet::Imu(Default::default()), &mut bytes).unwrap();
        assert_eq!(hear(&mut unit, &bytes[..len]), "");
        assert_eq!(unit.stage(), Stage::Silent);
    }

    proptest! {
        #[test]
        fn any_bytes_do_not_keep_the_handshake_from_its_end(
            bytes in prop::collection::vec(
                prop_oneof![any::<u8>(), prop::sample::select(b"$VNASYRGW,*0123\r\n\xfa\x01\x21\x07".to_vec())],
                0..400,
            ),
            piece in 1..100usize,
        ) {
            let mut unit = new();
            bytes.chunks(piece).for_each(|piece| drop(hear(&mut unit, piece)));
            prop_assume!(unit.stage() == Stage::Silent);
            // A pause, as before a command is sent again.
            unit.tick(PAUSE, &mut |_| {});
            shake_hands(&mut unit);
            prop_assert_eq!(unit.stage(), Stage::Ready);
        }
    }

    #[test]
    fn that_nobody_asks_is_said_once() {
        let (mut unit, mut told) = (new(), 0);
        for now in (0..30_000_000_000).step_by(10_000_000) {
            unit.tick(now, &mut |said| {
                assert!(now == 10_000_000_000 && matches!(said, Said::Notice(_)));
                told += 1;
            });
        }
        assert_eq!(told, 1);
        assert_eq!(
            Unit::new(None).stage(),
            Stage::Ready,
            "whoever plays without a controller in mind waits for none"
        );
    }
}
