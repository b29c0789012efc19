//! Targets: a protocol plus what one flight controller needs to be fed well.

use crate::time::{NANOS, SimTime};
use crate::wire::{Controller, Protocol};

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
pub static TARGETS: [Target; 7] = [
    Target {
        name: "px4",
        about: "PX4 on its board in HITL, over serial or USB: its EKF2 runs on HIL_SENSOR, timestamped on arrival",
        protocol: Protocol::Mavlink,
        controller: Controller::Px4,
        link: None,
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
        baud: Some(115_200),
        rest: SimTime(5 * NANOS),
        most_hz: None,
        scene: "level-then-turn",
        // As many as its default baud rate carries; it asks for its own number of packets.
        settings: &["gyro.rate=100 Hz", "accel.rate=100 Hz"],
        asks: "nothing: it configures the output at the rate in EAHRS_RATE",
    },
    Target {
        name: "ardupilot-ilabs",
        about: "ArduPilot, whose external AHRS driver reads ratetable as an Inertial Labs unit: it asks for nothing",
        protocol: Protocol::Ilabs,
        controller: Controller::Ardupilot,
        link: None,
        baud: Some(230_400),
        // EKF3 aligns its heading 6.4 s after its boot begins.
        rest: SimTime(10 * NANOS),
        most_hz: None,
        scene: "level-then-turn",
        // The rate of the real unit: 70 bytes a frame.
        settings: &["gyro.rate=200 Hz", "accel.rate=200 Hz"],
        asks: "nothing: it only listens",
    },
    Target {
        name: "ardupilot-sbg",
        about: "ArduPilot, whose external AHRS driver reads ratetable as an SBG Systems unit: nothing has to be answered",
        protocol: Protocol::Sbg,
        controller: Controller::Ardupilot,
        link: None,
        baud: Some(230_400),
        rest: SimTime(10 * NANOS),
        most_hz: None,
        scene: "level-then-turn",
        settings: &["gyro.rate=200 Hz", "accel.rate=200 Hz"],
        asks: "nothing: it asks which device this is, and is answered",
    },
    Target {
        name: "px4-ilabs",
        about: "PX4, whose `ilabs` driver reads ratetable as an Inertial Labs unit: its own EKF2 on our samples, without HITL",
        protocol: Protocol::Ilabs,
        controller: Controller::Px4,
        link: None,
        // The driver has no other speed.
        baud: Some(921_600),
        rest: SimTime(10 * NANOS),
        most_hz: None,
        scene: "level-then-turn",
        settings: &["gyro.rate=200 Hz", "accel.rate=200 Hz"],
        asks: "nothing: it only listens",
    },
    Target {
        name: "inav",
        about: "INAV with its HITL simulator message over MSP",
        protocol: Protocol::Msp,
        controller: Controller::Inav,
        link: None,
        baud: Some(115_200),
        rest: SimTime(20 * NANOS),
        most_hz: Some(100),
        scene: "level-then-turn",
        settings: &["gyro.rate=100 Hz", "accel.rate=100 Hz"],
        asks: "its variant and MSP_ATTITUDE until it answers; then each simulator message is answered with its attitude",
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
