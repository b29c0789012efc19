//! `vectornav`: a VN-100 that is set up by ArduPilot's driver.
//!
//! The flight controller speaks first, sends each command again every half second until it is answered, and blocks in
//! its boot until all are. A command is answered by itself, a register that is read by its contents, anything else by
//! an error, so that it is sent again. After the last one it is deaf to all but the stream.

use crate::time::Rate;
use crate::wire::Controller;
use crate::wire::dialogue::{Dialogue, Pause, Peer, Said, Stage};
use ratetable_protocols::Error;
use ratetable_protocols::vectornav::line::Line;
use ratetable_protocols::vectornav::{Decoder, MAX_LEN, Packet, encode};

/// Of the unit whose outputs are divided, Hz.
const UNIT_RATE: u64 = 800;
/// What it is; ArduPilot asks one of its first letters for IMU and AHRS packets alone.
const MODEL: &str = "VNRRG,01,VN-100T-CR";
/// The answer to what is damaged or not known.
const ERROR: &str = "VNERR,12";
/// How long nothing is asked before that is said, ns.
const PATIENCE: i64 = 10_000_000_000;

/// One link to a flight controller that takes this for its VN-100.
pub(super) struct Unit {
    decoder: Decoder,
    damaged: u64,
    stage: Stage,
    /// At which it asked for IMU packets.
    rate: Option<Rate>,
    since: Option<i64>,
    pause: Pause,
    asked: bool,
    told_silence: bool,
}

/// What a command wants.
#[derive(Debug, PartialEq)]
enum Command {
    /// What is done already.
    Nothing,
    /// To know the model.
    Model,
    /// No packets for now: the start of a handshake.
    Pause,
    /// IMU packets at this rate.
    Imu(Rate),
    /// The stream: the end of a handshake.
    Stream,
    /// An error said or repeated, which is not answered.
    Error,
    /// Something that this unit does not do.
    Unknown,
}

impl Command {
    fn of(line: &Line) -> Command {
        let terms: Vec<_> = line.terms().collect();
        match terms[..] {
            ["VNASY", "0"] => Command::Pause,
            ["VNASY", "1"] => Command::Stream,
            // No text output on either port.
            ["VNWRG", "06", "0", _] => Command::Nothing,
            ["VNRRG", "01"] => Command::Model,
            ["VNWRG", "75", _, divisor, "01", "0721"] => divisor
                .parse()
                .ok()
                .and_then(|divisor| Rate::new(UNIT_RATE, divisor))
                .map_or(Command::Unknown, Command::Imu),
            ["VNWRG", "76", _, "16", "11", "0001", "0106"] => Command::Nothing,
            ["VNERR", ..] => Command::Error,
            _ => Command::Unknown,
        }
    }
}

impl Unit {
    /// With a controller, its handshake comes before the scene; else it is played to at once.
    pub(super) fn new(controller: Option<Controller>) -> Unit {
        let stage = if controller.is_some() { Stage::Silent } else { Stage::Ready };
        Unit {
            decoder: Decoder::new(),
            damaged: 0,
            stage,
            rate: None,
            since: None,
            pause: Pause::default(),
            asked: false,
            told_silence: false,
        }
    }

    fn take(&mut self, received: Result<Packet, Error>, say: &mut dyn FnMut(Said<'_>)) {
        match received {
            Ok(Packet::Line(line)) => self.obey(&line, say),
            // Our own, on a link that echoes.
            Ok(Packet::Imu(_) | Packet::Ahrs(_)) => {}
            Err(_) => {
                self.damaged += 1;
                reply(ERROR, say);
            }
        }
    }

    fn obey(&mut self, line: &Line, say: &mut dyn FnMut(Said<'_>)) {
        self.asked = true;
        match Command::of(line) {
            Command::Nothing => reply(line.text(), say),
            Command::Model => reply(MODEL, say),
            Command::Pause => {
                if self.stage == Stage::Ready && self.rate.is_some() {
                    say(Said::Notice("the flight controller has restarted: it is answered again".into()));
                }
                reply(line.text(), say);
            }
            Command::Imu(rate) => {
                self.ask_rate(rate, say);
                reply(line.text(), say);
            }
            Command::Stream => {
                reply(line.text(), say);
                self.stage = Stage::Ready;
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

    /// The stream begins at the rate asked for before it, and keeps that.
    fn ask_rate(&mut self, rate: Rate, say: &mut dyn FnMut(Said<'_>)) {
        if self.stage < Stage::Ready {
            self.rate = Some(rate);
        } else if self.rate != Some(rate) {
            let began = self.rate.map_or("the gyro's rate".into(), |rate| rate.to_string());
            say(Said::Notice(format!(
                "the flight controller asks for IMU packets at {rate}, and the stream has begun at {began}: start `ardupilot@...` before its boot"
            )));
        }
    }
}

impl Dialogue for Unit {
    fn hear(&mut self, bytes: &[u8], now: i64, say: &mut dyn FnMut(Said<'_>)) {
        self.pause.heard(now);
        let mut decoder = std::mem::take(&mut self.decoder);
        decoder.feed(bytes, |received| self.take(received, say));
        self.decoder = decoder;
    }

    fn tick(&mut self, now: i64, say: &mut dyn FnMut(Said<'_>)) {
        if self.pause.is_now(now) {
            let mut decoder = std::mem::take(&mut self.decoder);
            decoder.finish(|received| self.take(received, say));
            self.decoder = decoder;
        }
        let since = *self.since.get_or_insert(now);
        let silent = self.stage == Stage::Silent && !self.asked && now - since >= PATIENCE;
        if silent && !std::mem::replace(&mut self.told_silence, true) {
            say(Said::Notice(
                "nobody has asked for a VN-100 yet: ArduPilot does at its boot (EAHRS_TYPE = 1, SERIALn_PROTOCOL = 36, SERIALn_BAUD as here), so restart it now".into(),
            ));
        }
    }

    fn stage(&self) -> Stage {
        self.stage
    }

    fn peer(&self) -> Peer {
        Peer { rate: self.rate, ..Peer::default() }
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
    use super::*;
    use crate::wire::dialogue::PAUSE;
    use proptest::prelude::*;

    /// Replies as text, notices behind a `#`.
    fn hear(unit: &mut Unit, bytes: &[u8]) -> String {
        let mut heard = String::new();
        unit.hear(bytes, 0, &mut |said| match said {
            Said::Reply(bytes) => heard += std::str::from_utf8(bytes).unwrap(),
            Said::Notice(text) => heard += &format!("#{text}\n"),
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
            ["VNRRG,02", "VNWRG,75,3,8,01,0729", "VNWRG,75,3,0,01,0721", "VNWRG,75,3,x,01,0721", "VNWNV"]
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
    fn a_controller_that_restarts_is_answered_again_and_a_new_rate_is_said_not_to_be_kept() {
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
        assert_eq!((unit.stage(), unit.peer().rate), (Stage::Ready, Some(Rate::hz(100))));
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
