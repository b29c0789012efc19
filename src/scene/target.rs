//! Targets: a protocol plus what one flight controller needs to be fed well.

use crate::time::{NANOS, SimTime};
use crate::wire::{Controller, Protocol, Release};

/// A flight controller as `--to` names it.
#[derive(Debug, PartialEq)]
pub struct Target {
    /// As `--to` spells it.
    pub name: &'static str,
    /// One line.
    pub about: &'static str,
    /// What it is spoken to in.
    pub protocol: Protocol,
    /// Whose ways the conversation keeps to.
    pub controller: Controller,
    /// Where it is looked for unless that is said.
    pub link: Option<&'static str>,
    /// The TCP port of the same machine at which it answers, where that is not on the link itself.
    pub answers: Option<u16>,
    /// Whether it has a source of heading: without one, a constant heading says nothing of it.
    pub has_heading: bool,
    /// The speed of a serial port that was given none.
    pub baud: Option<u32>,
    /// The vehicle is held still for at least this long, and until its estimator is up.
    pub rest: SimTime,
    /// Samples a second that it takes at most, Hz.
    pub most_hz: Option<u32>,
    /// The scene it is sent by default.
    pub scene: &'static str,
    /// What that scene is set to, as by `--set`.
    pub settings: &'static [&'static str],
    /// What it is asked for, or sends by itself.
    pub asks: &'static str,
}

/// Every target.
pub static TARGETS: [Target; 5] = [
    Target {
        name: "px4",
        about: "PX4 on its board in HITL, over serial or USB: its EKF2 runs on HIL_SENSOR, timestamped on arrival",
        protocol: Protocol::Mavlink,
        controller: Controller::Px4,
        link: None,
        answers: None,
        has_heading: true,
        baud: Some(921_600),
        rest: SimTime::ZERO,
        most_hz: None,
        scene: "level-then-turn",
        settings: &[],
        asks: "ATTITUDE, ATTITUDE_QUATERNION, and the parameters that decide whether it accepts them",
    },
    Target {
        name: "px4-sitl",
        about: "PX4 as a program, in lockstep: it connects to ratetable and runs as fast as it can with --speed max",
        protocol: Protocol::Mavlink,
        controller: Controller::Px4Sitl,
        link: Some("tcpin:4560"),
        answers: None,
        has_heading: true,
        baud: None,
        rest: SimTime::ZERO,
        most_hz: None,
        scene: "level-then-turn",
        settings: &[],
        asks: "HIL_ACTUATOR_CONTROLS, one for each HIL_SENSOR",
    },
    Target {
        name: "ardupilot",
        about: "ArduPilot, whose external AHRS driver reads ratetable as a VN-100: start ratetable before it boots",
        protocol: Protocol::Vectornav,
        controller: Controller::Ardupilot,
        link: None,
        answers: None,
        has_heading: true,
        baud: Some(115_200),
        rest: SimTime(5 * NANOS),
        most_hz: None,
        scene: "level-then-turn",
        // As many as its default baud rate carries; it asks for its own number of packets.
        settings: &["gyro.rate=100 Hz", "accel.rate=100 Hz"],
        asks: "nothing: it configures the output at the rate in EAHRS_RATE",
    },
    Target {
        name: "inav",
        about: "INAV with its HITL simulator message over MSP",
        protocol: Protocol::Msp,
        controller: Controller::Inav,
        link: None,
        answers: None,
        has_heading: true,
        baud: Some(115_200),
        rest: SimTime(20 * NANOS),
        most_hz: Some(100),
        scene: "level-then-turn",
        settings: &["gyro.rate=100 Hz", "accel.rate=100 Hz"],
        asks: "its variant and MSP_ATTITUDE until it answers; then each simulator message is answered with its attitude",
    },
    Target {
        name: "betaflight",
        about: "Betaflight as a program (SITL): gyro and accelerometer over UDP, its attitude back over MSP on TCP; start it first",
        protocol: Protocol::Betaflight,
        controller: Controller::Betaflight(Release::Y2026M6),
        link: Some("udpout:127.0.0.1:9003"),
        answers: Some(5761),
        has_heading: false,
        baud: None,
        rest: SimTime(5 * NANOS),
        most_hz: None,
        scene: "level-then-turn",
        settings: &["gyro.rate=1 kHz", "accel.rate=1 kHz"],
        asks: "its variant, its version, whether its gyro answers a test rate; then its attitude up to 100 times a second",
    },
];

impl Target {
    /// The target of that name.
    pub fn from_name(name: &str) -> Option<&'static Target> {
        TARGETS.iter().find(|target| target.name == name)
    }

    /// What it sets, a line each.
    pub fn expansion(&self) -> Vec<String> {
        let mut lines = vec![format!("protocol {}", self.protocol.name())];
        lines.extend(self.link.map(|link| format!("link {link} by default")));
        lines.extend(self.answers.map(|port| format!("answers on TCP port {port} of the same machine")));
        if !self.has_heading {
            lines.push("has no source of heading: one constant heading is taken out of its attitude (--align none keeps it)".into());
        }
        lines.extend(self.baud.map(|baud| format!("{baud} baud on a serial port by default")));
        lines.extend(self.most_hz.map(|hz| format!("at most {hz} samples a second of each sensor")));
        lines.push(match self.rest {
            SimTime::ZERO => "holds still until its estimator is ready".into(),
            rest => format!("holds still for {} s and until its estimator is ready", rest.0 / NANOS),
        });
        let set = |setting: &&str| format!(" --set '{setting}'");
        let settings: String = self.settings.iter().map(set).collect();
        lines.push(format!("scene {}{settings} by default", self.scene));
        lines.push(format!("asked for {}", self.asks));
        lines
    }
}
