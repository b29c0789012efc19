//! A whole conversation in memory: the emulator's encoder and dialogue on one side, a firmware on the other, and time
//! that goes by in steps.

use std::sync::Arc;

use glam::DQuat;
use ratetable::earth::declination;
use ratetable::geometry::Attitude;
use ratetable::player::{Moment, Player};
use ratetable::scene::{Destination, Output, Plan};
use ratetable::score::{self, Figures, Timed};
use ratetable::time::SimTime;
use ratetable::wire::dialogue::{Dialogue, Estimate, Said, Stage, Stamp};
use ratetable::wire::{self, Controller, Now, Packet, Setup};
use ratetable_firmware_host_tests::standin::{Firmware, Make, Record, Settings};

use crate::emulator::play::scene;

/// Between two steps, µs.
const STEP_US: u64 = 1_000;
/// The latest at which a controller is heard, µs.
const HEARD_US: u64 = 30_000_000;

/// A firmware, the emulator's name for it, and how it is fed.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    pub make: Make,
    pub to: &'static str,
    /// Scene keys set beside those that the target sets.
    pub sets: &'static [&'static str],
    /// Between packets of samples, µs.
    pub period_us: u64,
    /// At rest before the scene, s.
    pub rest_s: u64,
}

const SCENE_HZ: u64 = 4_000;

const SCENE_200: &[&str] = &["gyro.rate=200 Hz", "accel.rate=200 Hz"];

/// Every stand-in with the target that is made for it; a MicroStrain unit has none.
pub const CASES: [Case; 9] = [
    Case { make: Make::Px4, to: "px4@pty", sets: &[], period_us: SCENE_HZ, rest_s: 6 },
    Case { make: Make::Px4Sitl, to: "px4-sitl@tcpin:0", sets: &[], period_us: SCENE_HZ, rest_s: 2 },
    Case {
        make: Make::Px4Vectornav,
        to: "px4-vectornav@pty",
        sets: &["gyro.rate=200 Hz", "accel.rate=200 Hz"],
        period_us: 5_000,
        rest_s: 5,
    },
    Case {
        make: Make::Ardupilot,
        to: "ardupilot@pty",
        sets: &["gyro.rate=100 Hz", "accel.rate=100 Hz"],
        period_us: 10_000,
        rest_s: 5,
    },
    Case { make: Make::ArdupilotMip, to: "mip@pty", sets: &[], period_us: SCENE_HZ, rest_s: 5 },
    Case { make: Make::ArdupilotIlabs, to: "ilabs@pty", sets: SCENE_200, period_us: 5_000, rest_s: 10 },
    Case { make: Make::ArdupilotSbg, to: "sbg@pty", sets: SCENE_200, period_us: 5_000, rest_s: 10 },
    Case { make: Make::Px4Ilabs, to: "px4-ilabs@pty", sets: SCENE_200, period_us: 5_000, rest_s: 10 },
    Case {
        make: Make::Inav,
        to: "inav@pty",
        sets: &["gyro.rate=100 Hz", "accel.rate=100 Hz"],
        period_us: 10_000,
        rest_s: 20,
    },
];

impl Case {
    pub fn of(make: Make) -> &'static Case {
        CASES.iter().find(|case| case.make == make).expect("every make has a case")
    }

    /// The scene that its target is sent.
    pub fn plan(&self) -> Arc<Plan> {
        scene("level-then-turn", self.sets)
    }
}

/// What a case's firmware is told before it starts: it asks for as many samples as the case has.
pub fn settings(case: &Case, plan: &Plan) -> Settings {
    Settings {
        declination_rad: declination(plan.trajectory.field()),
        rate_hz: (1_000_000 / case.period_us) as u32,
        ..Settings::default()
    }
}

/// The packets of a rest and then of the scene.
pub fn packets(plan: &Plan, case: &Case, dialogue: Option<&dyn Dialogue>) -> Vec<Packet> {
    let output = Output::to(case.to.parse::<Destination>().expect("a destination"));
    packets_to(plan, case, &output, dialogue)
}

fn packets_to(plan: &Plan, case: &Case, output: &Output, dialogue: Option<&dyn Dialogue>) -> Vec<Packet> {
    let setup = Setup {
        sensors: &plan.sensors,
        axes: plan.axes,
        day: plan.day,
        options: output.wire,
        peer: dialogue.map_or_else(Default::default, |dialogue| dialogue.peer()),
    };
    let mut encoder = wire::encoder(output.to.protocol, &setup);
    let rest = SimTime(case.rest_s as i64 * 1_000_000_000);
    let mut packets = Vec::new();
    let mut play = |plan: &Plan, from: SimTime, end: SimTime| {
        let played = Player::new(plan, end, 1000).play(|Moment { t, truth, readings }| {
            let t = from + t;
            encoder
                .encode(&Now { t, truth: &ratetable::motion::Truth { t, ..*truth }, readings }, &mut packets);
            Ok::<(), std::convert::Infallible>(())
        });
        played.expect("nothing stops it");
    };
    play(&plan.at_rest(), SimTime::ZERO, rest);
    play(plan, rest, plan.duration);
    packets
}

/// What came of a conversation.
pub struct Told {
    pub record: Record,
    /// What the firmware's estimates are by the emulator's reading of its answers, in scene time.
    pub answers: Vec<Timed>,
    pub notices: Vec<String>,
    pub ready: bool,
    /// Of the firmware's clock when the scene began, µs.
    pub scene_us: u64,
}

/// One side's words and what they come to.
struct Table {
    dialogue: Option<Box<dyn Dialogue>>,
    firmware: Box<dyn Firmware + Send>,
    answers: Vec<(Estimate, u64)>,
    notices: Vec<String>,
    to_firmware: Vec<u8>,
    /// What goes on the samples' own link ahead of them, where it is spoken with on another.
    ahead: Vec<Vec<u8>>,
}

impl Table {
    /// Both sides at one time: the firmware takes these bytes and does what is due, the emulator answers.
    fn step(&mut self, now_us: u64, bytes: &[u8]) {
        let mut out = Vec::new();
        self.firmware.turn(now_us, &mut out);
        let answers = std::mem::take(&mut self.to_firmware);
        if !answers.is_empty() {
            self.firmware.receive_apart(&answers, now_us, &mut out);
        }
        let ahead = std::mem::take(&mut self.ahead);
        for bytes in ahead.iter().map(Vec::as_slice).chain([bytes]).filter(|bytes| !bytes.is_empty()) {
            self.firmware.receive(bytes, now_us, &mut out);
        }
        let Self { dialogue: Some(dialogue), answers, notices, to_firmware, ahead, .. } = self else {
            return;
        };
        let now = now_us as i64 * 1000;
        let mut say = |said: Said<'_>| match said {
            Said::Estimate(estimate) => answers.push((estimate, now_us)),
            Said::Reply(bytes) => to_firmware.extend_from_slice(bytes),
            Said::Ahead(bytes) => ahead.push(bytes.to_vec()),
            Said::Notice(notice) | Said::Restart(notice) => notices.push(notice),
            Said::Took | Said::Pass(_) | Said::Speed(_) => {}
        };
        dialogue.hear(&out, now, &mut say);
        if now_us.is_multiple_of(10_000) {
            dialogue.tick(now, &mut say);
        }
    }

    fn stage(&self) -> Stage {
        self.dialogue.as_ref().map_or(Stage::Ready, |dialogue| dialogue.stage())
    }
}

/// Holds a conversation; `alter` may change, drop, delay or add to what goes out: it is given all packets with their
/// stream times (µs) and where the scene begins among those.
pub fn converse(
    case: &Case,
    plan: &Plan,
    settings: &Settings,
    alter: impl FnOnce(Vec<(u64, Vec<u8>)>, u64) -> Vec<(u64, Vec<u8>)>,
) -> Told {
    converse_with(case, plan, None, settings, alter)
}

/// [`converse`] in the ways of another controller than the target's own.
pub fn converse_with(
    case: &Case,
    plan: &Plan,
    controller: Option<Controller>,
    settings: &Settings,
    alter: impl FnOnce(Vec<(u64, Vec<u8>)>, u64) -> Vec<(u64, Vec<u8>)>,
) -> Told {
    let mut output = Output::to(case.to.parse::<Destination>().expect("a destination"));
    output.wire.controller = controller.or(output.wire.controller);
    let mut table = Table {
        dialogue: output.to.protocol.dialogue(output.wire.controller),
        firmware: case.make.firmware(settings),
        answers: Vec::new(),
        notices: Vec::new(),
        to_firmware: Vec::new(),
        ahead: Vec::new(),
    };
    let mut now_us = 0;
    while table.stage() == Stage::Silent && now_us < HEARD_US {
        table.step(now_us, &[]);
        now_us += STEP_US;
    }
    let start_us = now_us;
    let packets = packets_to(plan, case, &output, table.dialogue.as_deref());
    let stream = packets.iter().map(|packet| (packet.due.0 as u64 / 1000, packet.bytes().to_vec())).collect();
    let rest_us = case.rest_s * 1_000_000;
    for (at_us, bytes) in alter(stream, rest_us) {
        while now_us + STEP_US <= start_us + at_us {
            now_us += STEP_US;
            table.step(now_us, &[]);
        }
        table.step(start_us + at_us, &bytes);
    }
    (0..20).for_each(|k| table.step(now_us + k * STEP_US, &[]));
    let scene_us = start_us + rest_us;
    let in_scene = |us: u64| SimTime((us as i64 - scene_us as i64) * 1000);
    let answers = table.answers.iter().map(|(estimate, us)| Timed {
        arrival: in_scene(*us),
        stamp: match estimate.stamp {
            Stamp::Own(ns) => score::HeldAt::Own(ns),
            Stamp::Sample(t) => score::HeldAt::Sample(t),
            Stamp::Arrival => score::HeldAt::Arrival,
        },
        attitude: estimate.attitude,
    });
    Told {
        answers: answers.filter(|it| it.arrival >= SimTime::ZERO).collect(),
        ready: table.stage() == Stage::Ready,
        record: table.firmware.record().clone(),
        notices: table.notices,
        scene_us,
    }
}

/// [`converse`] with the stream as it is.
pub fn converse_well(case: &Case) -> (Arc<Plan>, Told) {
    let plan = case.plan();
    let told = converse(case, &plan, &settings(case, &plan), |stream, _| stream);
    (plan, told)
}

/// The emulator's judgement of a series of estimates.
pub fn judge(plan: &Plan, said: &[Timed]) -> Figures {
    let truth = |t: SimTime| Some(plan.trajectory.at(t.max(SimTime::ZERO)).attitude);
    let options = score::Options { until: plan.duration, ..score::Options::default() };
    score::judge(&truth, said, &options).expect("estimates").figures
}

/// The firmware's own estimates in the scene, each as if it had been told at its sample's time.
pub fn own(record: &Record, scene_us: u64) -> Vec<Timed> {
    let moments = record.history.iter().filter(|moment| moment.t_us >= scene_us);
    moments
        .map(|moment| {
            let [w, x, y, z] = moment.attitude;
            Timed {
                arrival: SimTime((moment.t_us - scene_us) as i64 * 1000),
                stamp: score::HeldAt::Arrival,
                attitude: Attitude::from_quat(DQuat::from_xyzw(x, y, z, w)),
            }
        })
        .collect()
}

/// Root mean square of the firmware's own error in the scene at its samples' exact times, and the largest, deg; no
/// delay is taken out.
pub fn exact_deg(plan: &Plan, record: &Record, scene_us: u64) -> (f64, f64) {
    let errors: Vec<f64> = own(record, scene_us)
        .iter()
        .filter(|it| it.arrival < plan.duration)
        .map(|it| it.attitude.angle_to(plan.trajectory.at(it.arrival).attitude).to_degrees())
        .collect();
    let square = errors.iter().map(|e| e * e).sum::<f64>() / errors.len().max(1) as f64;
    (square.sqrt(), errors.iter().copied().fold(0.0, f64::max))
}
