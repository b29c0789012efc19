//! `msp`: INAV's attitude from its answers, each an estimate at its arrival.
//!
//! Until it answers, INAV is asked for its identity and attitude twice a second. It hears the stream once it
//! answers a simulator message; it answers every one.

use crate::geometry::{Attitude, Euler};
use crate::wire::Controller;
use crate::wire::dialogue::{Dialogue, Estimate, Pause, Said, Stage, Stamp};
use ratetable_protocols::Error;
use ratetable_protocols::msp::{self, Decoder, Direction, MAX_LEN, Message, Received, fc_variant, simulator};

/// Time between two requests, ns.
const ASK_EVERY: i64 = 500_000_000;
/// Time without an answer before a notice, ns.
const PATIENCE: i64 = 5_000_000_000;

/// One link to a flight controller that speaks MSP.
pub(super) struct Inav {
    decoder: Decoder,
    damaged: u64,
    stage: Stage,
    /// When the first request went out, and when the next is due.
    asked: Option<i64>,
    ask_at: i64,
    pause: Pause,
    told: Told,
}

/// The notices already given.
#[derive(Default)]
struct Told {
    silence: bool,
    stranger: bool,
    refusal: bool,
}

impl Inav {
    /// With a controller, it must answer before the scene starts; without one, samples start at once.
    pub(super) fn new(controller: Option<Controller>) -> Inav {
        let stage = if controller.is_some() { Stage::Silent } else { Stage::Ready };
        Inav {
            decoder: Decoder::new(),
            damaged: 0,
            stage,
            asked: None,
            ask_at: i64::MIN,
            pause: Pause::default(),
            told: Told::default(),
        }
    }

    fn take(&mut self, received: Result<Received, Error>, say: &mut dyn FnMut(Said<'_>)) {
        match received {
            // Our own message, on a link that echoes.
            Ok(Received { direction: Direction::Request, .. }) => {}
            Ok(received) => {
                self.stage = self.stage.max(stage_after(&received));
                judge(&received, &mut self.told, say);
            }
            Err(_) => self.damaged += 1,
        }
    }
}

impl Dialogue for Inav {
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
        if self.stage != Stage::Silent {
            return;
        }
        let asked = *self.asked.get_or_insert(now);
        if now >= self.ask_at {
            self.ask_at = now + ASK_EVERY;
            for command in [fc_variant::COMMAND, msp::attitude::COMMAND] {
                let mut buffer = [0; MAX_LEN];
                let len = msp::encode(&Message::question(command), &mut buffer).unwrap_or(0);
                say(Said::Reply(&buffer[..len]));
            }
        }
        if now - asked >= PATIENCE && !std::mem::replace(&mut self.told.silence, true) {
            say(Said::Notice(
                "no answer to MSP questions: the port must be INAV's USB port or a UART with MSP switched on in its Ports tab, at the same baud rate, and no configurator connected".into(),
            ));
        }
    }

    fn stage(&self) -> Stage {
        self.stage
    }

    /// Measured: at 100 packets a second INAV answers each.
    fn answers_every_packet(&self) -> bool {
        true
    }

    fn damaged(&self) -> u64 {
        self.damaged
    }
}

/// Any answer shows that somebody is there; an answer to a simulator message shows that it hears the stream.
fn stage_after(received: &Received) -> Stage {
    match received.message {
        Some(Message::SimulatorReply(_)) => Stage::Ready,
        _ => Stage::Still,
    }
}

/// Handles an answer.
fn judge(received: &Received, told: &mut Told, say: &mut dyn FnMut(Said<'_>)) {
    match received.message {
        Some(Message::SimulatorReply(reply)) => {
            let [roll, pitch, yaw] = reply.attitude.map(|angle| f64::from(angle) / 10.0);
            say(estimate(roll, pitch, yaw));
        }
        Some(Message::Attitude(reply)) => {
            say(estimate(f64::from(reply.roll) / 10.0, f64::from(reply.pitch) / 10.0, f64::from(reply.yaw)));
        }
        Some(Message::FcVariant(reply))
            if reply.name != fc_variant::INAV && !std::mem::replace(&mut told.stranger, true) =>
        {
            let name = String::from_utf8_lossy(&reply.name).into_owned();
            say(Said::Notice(format!(
                "the flight controller says that it is {name:?}: only INAV takes the simulator message"
            )));
        }
        _ if received.direction == Direction::Refusal
            && received.command == simulator::COMMAND
            && !std::mem::replace(&mut told.refusal, true) =>
        {
            say(Said::Notice(
                "the flight controller refuses the simulator message (0x201F): its firmware must be INAV built with USE_SIMULATOR, whose message has version 2".into(),
            ));
        }
        _ => {}
    }
}

/// Converts INAV's angles in degrees; its pitch is positive nose down.
fn estimate(roll: f64, pitch: f64, yaw: f64) -> Said<'static> {
    let [roll, pitch, yaw] = [roll, -pitch, yaw].map(f64::to_radians);
    let attitude = Attitude::from_quat(Euler { roll, pitch, yaw }.to_quat());
    Said::Estimate(Estimate { stamp: Stamp::Arrival, attitude })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::dialogue::PAUSE;
    use proptest::prelude::*;
    use ratetable_protocols::msp::{attitude, simulator_reply};

    /// What is sent in answer to a message, or unasked at a time.
    #[derive(Debug, PartialEq)]
    enum Heard {
        Estimate([f64; 3]),
        Question(u16),
        Notice(String),
    }

    fn note(said: Said<'_>, heard: &mut Vec<Heard>) {
        match said {
            Said::Estimate(Estimate { stamp: Stamp::Arrival, attitude }) => {
                let Euler { roll, pitch, yaw } = Euler::from_quat(attitude.q);
                heard.push(Heard::Estimate([roll, pitch, yaw].map(|x| x.to_degrees())));
            }
            Said::Reply(bytes) => Decoder::new().feed(bytes, |received| {
                let Ok(Received { direction: Direction::Request, command, .. }) = received else { panic!() };
                heard.push(Heard::Question(command));
            }),
            Said::Notice(text) => heard.push(Heard::Notice(text)),
            other => panic!("{other:?}"),
        }
    }

    fn hear(inav: &mut Inav, message: &Message) -> Vec<Heard> {
        let mut bytes = [0; MAX_LEN];
        let len = msp::encode(message, &mut bytes).unwrap();
        let mut heard = Vec::new();
        inav.hear(&bytes[..len], 0, &mut |said| note(said, &mut heard));
        heard
    }

    fn tick(inav: &mut Inav, now: i64) -> Vec<Heard> {
        let mut heard = Vec::new();
        inav.tick(now, &mut |said| note(said, &mut heard));
        heard
    }

    fn close(heard: &[Heard], expected: [f64; 3]) {
        let [Heard::Estimate(angles)] = heard else { panic!("{heard:?}") };
        assert!(angles.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{angles:?} {expected:?}");
    }

    fn simulated(attitude: [i16; 3]) -> Message {
        Message::SimulatorReply(simulator_reply::Repr { attitude, ..Default::default() })
    }

    #[test]
    fn it_is_asked_twice_a_second_until_it_answers_and_is_ready_once_it_hears_the_stream() {
        let mut inav = Inav::new(Some(Controller::Inav));
        let mut asked = 0;
        for now in (0..2_000_000_000).step_by(10_000_000) {
            let heard = tick(&mut inav, now);
            assert!(heard.is_empty() || heard == [Heard::Question(2), Heard::Question(108)]);
            asked += usize::from(!heard.is_empty());
        }
        assert_eq!((asked, inav.stage()), (4, Stage::Silent));
        close(
            &hear(&mut inav, &Message::Attitude(attitude::Repr { roll: -455, pitch: 100, yaw: 270 })),
            [-45.5, -10.0, -90.0],
        );
        assert_eq!(inav.stage(), Stage::Still);
        assert!(tick(&mut inav, 9_000_000_000).is_empty(), "it is asked no more");
        close(&hear(&mut inav, &simulated([300, -100, 900])), [30.0, 10.0, 90.0]);
        assert_eq!(inav.stage(), Stage::Ready);
        hear(&mut inav, &Message::Attitude(attitude::Repr::default()));
        assert_eq!((inav.stage(), inav.damaged()), (Stage::Ready, 0), "and stays so");
    }

    #[test]
    fn without_a_controller_to_wait_for_it_is_played_to_at_once_and_listened_to() {
        let mut inav = Inav::new(None);
        assert_eq!(inav.stage(), Stage::Ready);
        assert!(tick(&mut inav, 0).is_empty());
        close(&hear(&mut inav, &simulated([0, 0, 3599])), [0.0, 0.0, -0.1]);
    }

    #[test]
    fn what_keeps_it_from_hearing_is_said_once() {
        let mut inav = Inav::new(Some(Controller::Inav));
        tick(&mut inav, 0);
        for (now, told) in [(4_999_000_000, 0), (5_000_000_000, 1), (6_000_000_000, 0)] {
            let notices = tick(&mut inav, now).into_iter().filter(|heard| matches!(heard, Heard::Notice(_)));
            assert_eq!(notices.count(), told, "{now}");
        }
        let refusal = Message::Empty { direction: Direction::Refusal, command: simulator::COMMAND };
        let stranger = Message::FcVariant(fc_variant::Repr { name: *b"BTFL" });
        for (message, part) in [(refusal, "USE_SIMULATOR"), (stranger, "BTFL")] {
            let [Heard::Notice(text)] = &hear(&mut inav, &message)[..] else { panic!() };
            assert!(text.contains(part), "{text}");
            assert!(hear(&mut inav, &message).is_empty(), "only once");
        }
        assert_eq!(inav.stage(), Stage::Still, "it answers, but does not hear the stream");
        assert!(hear(&mut inav, &Message::FcVariant(fc_variant::Repr { name: fc_variant::INAV })).is_empty());
    }

    proptest! {
        #[test]
        fn any_bytes_do_not_hide_the_answer_behind_them(
            bytes in prop::collection::vec(
                prop_oneof![any::<u8>(), prop::sample::select(b"$X>!<\x1f\x20\0".to_vec())],
                0..400,
            ),
            piece in 1..100usize,
        ) {
            let mut inav = Inav::new(Some(Controller::Inav));
            bytes.chunks(piece).for_each(|piece| inav.hear(piece, 0, &mut |_| {}));
            inav.tick(PAUSE, &mut |_| {});
            close(&hear(&mut inav, &simulated([300, -100, 900])), [30.0, 10.0, 90.0]);
        }
    }

    #[test]
    fn its_own_stream_echoed_is_no_answer() {
        let mut inav = Inav::new(Some(Controller::Inav));
        hear(&mut inav, &Message::question(attitude::COMMAND));
        hear(&mut inav, &Message::Simulator(simulator::Repr::default()));
        assert_eq!(inav.stage(), Stage::Silent);
        inav.hear(b"$X>garbage and more garbage", 0, &mut |said| panic!("{said:?}"));
        assert_eq!(inav.stage(), Stage::Silent);
    }
}
