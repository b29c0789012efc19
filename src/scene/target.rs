//! Targets: a protocol plus what one flight controller needs to be fed well.

use super::{Plan, SceneError, builtin};
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
    /// The UDP port of this machine to which it tells its attitude, where that is not on the link itself.
    pub overheard: Option<u16>,
    /// What to do where nobody comes to the link.
    pub nobody: &'static str,
    /// Whether it has a source of heading: without one, a constant heading says nothing of it.
    pub has_heading: bool,
    /// The speed of a serial port that was given none.
    pub baud: Option<u32>,
    /// The speed that it sets a serial port to before it is sent anything.
    pub sets_baud: Option<u32>,
    /// The vehicle is held still for at least this long, and until its estimator is up.
    pub rest: SimTime,
    /// Samples a second that it takes at most, Hz: it is played to in real time or slower.
    pub most_hz: Option<u32>,
    /// The parameter of the number of packets a second that it asks for, where it does.
    pub asks_rate: Option<&'static str>,
    /// The scene it is sent by default.
    pub scene: &'static str,
    /// What that scene is set to, as by `--set`.
    pub settings: &'static [&'static str],
    /// The sensors that its firmware wants, as set where a built-in scene has none.
    pub wants: &'static [&'static str],
    /// What it is asked for, or sends by itself.
    pub asks: &'static str,
    /// What it tells while the scene is played.
    pub tells: Tells,
}

/// What a controller tells while it is played to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tells {
    /// Nothing.
    Nothing,
    /// Its attitude.
    Attitude,
    /// That it took a packet of samples: lockstep.
    Steps,
}

/// What most targets have.
const USUAL: Target = Target {
    name: "",
    about: "",
    protocol: Protocol::Mavlink,
    controller: Controller::Ardupilot,
    link: None,
    answers: None,
    overheard: None,
    nobody: "",
    has_heading: true,
    baud: None,
    sets_baud: None,
    rest: SimTime::ZERO,
    most_hz: None,
    asks_rate: None,
    scene: "level-then-turn",
    settings: &[],
    wants: &[],
    asks: "",
    tells: Tells::Nothing,
};

/// Every target.
pub static TARGETS: [Target; 10] = [
    Target {
        name: "px4",
        about: "PX4 on its board in HITL, over serial or USB: its EKF2 runs on HIL_SENSOR, timestamped on arrival",
        protocol: Protocol::Mavlink,
        controller: Controller::Px4,
        baud: Some(921_600),
        // "Preflight Fail: barometer 0 missing" without one (measured).
        wants: &["baro.rate=50 Hz"],
        asks: "ATTITUDE, ATTITUDE_QUATERNION, and the parameters that decide whether it accepts them",
        tells: Tells::Attitude,
        ..USUAL
    },
    Target {
        name: "px4-sitl",
        about: "PX4 as a program, in lockstep: it connects to ratetable and runs as fast as it can with --speed max",
        protocol: Protocol::Mavlink,
        controller: Controller::Px4Sitl,
        link: Some("tcpin:4560"),
        // "Preflight Fail: barometer 0 missing" without one (measured).
        wants: &["baro.rate=50 Hz"],
        asks: "HIL_ACTUATOR_CONTROLS, one for each HIL_SENSOR; its attitude is heard on UDP port 14550",
        // Where it looks for a ground station.
        overheard: Some(14_550),
        nobody: "start PX4, or restart it: after a run it does not connect again",
        tells: Tells::Steps,
        ..USUAL
    },
    Target {
        name: "px4-vectornav",
        about: "PX4, whose vectornav driver reads ratetable as a VN-100 on a plain UART: its EKF2 runs on the samples, without HITL",
        protocol: Protocol::Vectornav,
        controller: Controller::Px4Vectornav,
        // A new unit's, which its driver tries first.
        baud: Some(115_200),
        sets_baud: Some(921_600),
        rest: SimTime(5 * NANOS),
        asks_rate: Some("VN_IMU_RATE"),
        // As many as it asks for unless VN_IMU_RATE says otherwise.
        settings: &["gyro.rate=800 Hz", "accel.rate=800 Hz"],
        asks: "nothing: it sets up two outputs, the first at the rate in VN_IMU_RATE",
        ..USUAL
    },
    Target {
        name: "ardupilot",
        about: "ArduPilot, whose external AHRS driver reads ratetable as a VN-100: start ratetable before it boots",
        protocol: Protocol::Vectornav,
        controller: Controller::Ardupilot,
        baud: Some(115_200),
        // Its EKF aligns yaw 6.4 s after it boots (measured).
        rest: SimTime(10 * NANOS),
        asks_rate: Some("EAHRS_RATE"),
        // As many as its default baud rate carries; it asks for its own number of packets.
        settings: &["gyro.rate=100 Hz", "accel.rate=100 Hz"],
        asks: "nothing: it configures the output at the rate in EAHRS_RATE",
        ..USUAL
    },
    Target {
        name: "ardupilot-mip",
        about: "ArduPilot, whose external AHRS driver reads ratetable as a MicroStrain unit: start ratetable before it boots",
        protocol: Protocol::Mip,
        controller: Controller::Ardupilot,
        baud: Some(115_200),
        rest: SimTime(10 * NANOS),
        settings: &["gyro.rate=100 Hz", "accel.rate=100 Hz"],
        asks: "nothing: this unit is only listened to",
        ..USUAL
    },
    Target {
        name: "ilabs",
        about: "ArduPilot, whose external AHRS driver reads ratetable as an Inertial Labs unit: it asks for nothing",
        protocol: Protocol::Ilabs,
        controller: Controller::Ardupilot,
        baud: Some(230_400),
        // EKF3 aligns its heading 6.4 s after its boot begins.
        rest: SimTime(10 * NANOS),
        // The rate of the real unit: 70 bytes a frame.
        settings: &["gyro.rate=200 Hz", "accel.rate=200 Hz"],
        asks: "nothing: it only listens",
        ..USUAL
    },
    Target {
        name: "sbg",
        about: "ArduPilot, whose external AHRS driver reads ratetable as an SBG Systems unit: nothing has to be answered",
        protocol: Protocol::Sbg,
        controller: Controller::Ardupilot,
        baud: Some(230_400),
        rest: SimTime(10 * NANOS),
        settings: &["gyro.rate=200 Hz", "accel.rate=200 Hz"],
        asks: "nothing: it asks which device this is, and is answered",
        ..USUAL
    },
    Target {
        name: "px4-ilabs",
        about: "PX4, whose `ilabs` driver reads ratetable as an Inertial Labs unit: its own EKF2 on our samples, without HITL",
        protocol: Protocol::Ilabs,
        controller: Controller::Px4,
        // The driver has no other speed.
        baud: Some(921_600),
        rest: SimTime(10 * NANOS),
        settings: &["gyro.rate=200 Hz", "accel.rate=200 Hz"],
        asks: "nothing: it only listens",
        ..USUAL
    },
    Target {
        name: "inav",
        about: "INAV with its HITL simulator message over MSP",
        protocol: Protocol::Msp,
        controller: Controller::Inav,
        baud: Some(115_200),
        rest: SimTime(20 * NANOS),
        most_hz: Some(100),
        settings: &["gyro.rate=100 Hz", "accel.rate=100 Hz"],
        asks: "its variant and MSP_ATTITUDE until it answers; then each simulator message is answered with its attitude",
        tells: Tells::Attitude,
        ..USUAL
    },
    Target {
        name: "betaflight",
        about: "Betaflight as a program (SITL): gyro and accelerometer over UDP, its attitude back over MSP on TCP; start it first",
        protocol: Protocol::Betaflight,
        controller: Controller::Betaflight(Release::Y2026M6),
        link: Some("udpout:127.0.0.1:9003"),
        answers: Some(5761),
        has_heading: false,
        rest: SimTime(5 * NANOS),
        settings: &["gyro.rate=1 kHz", "accel.rate=1 kHz"],
        asks: "its variant, its version, whether its gyro answers a test rate; then its attitude up to 100 times a second",
        tells: Tells::Attitude,
        ..USUAL
    },
];

impl Target {
    /// The target of that name.
    pub fn from_name(name: &str) -> Option<&'static Target> {
        TARGETS.iter().find(|target| target.name == name)
    }

    /// Loads a scene for this target, or its own, with `--set` overrides. A built-in scene gets what the controller needs:
    /// a rate that it takes, for each sensor that is faster, and the sensors that its firmware wants. Returns these
    /// settings too.
    ///
    /// # Errors
    /// No such scene, or every mistake in it.
    pub fn load(
        &self,
        scene: Option<&str>,
        sets: &[String],
    ) -> Result<(Plan, Vec<&'static str>), SceneError> {
        let name = scene.unwrap_or(self.scene);
        let plan = Plan::load(name, sets)?;
        if builtin::text(name).is_none() {
            return Ok((plan, Vec::new()));
        }
        let of = |setting: &str| plan.sensors.iter().find(|it| setting.starts_with(&format!("{}.", it.kind)));
        let most = self.most_hz.map_or(f64::INFINITY, f64::from);
        let is_faster = |setting: &&&str| of(setting).is_some_and(|sensor| sensor.rate.as_hz() > most);
        let rates = self.settings.iter().filter(|setting| scene.is_none() || is_faster(setting));
        let absent = self.wants.iter().filter(|setting| of(setting).is_none());
        let set: Vec<_> = rates.chain(absent).copied().collect();
        let all: Vec<_> = set.iter().map(|setting| setting.to_string()).chain(sets.iter().cloned()).collect();
        Ok((Plan::load(name, &all)?, set))
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
        lines.extend(self.sets_baud.map(|baud| format!("changes a serial port to {baud} baud")));
        lines.extend(self.most_hz.map(|hz| format!("at most {hz} samples a second of each sensor")));
        lines.push(match self.rest {
            SimTime::ZERO => "holds still until its estimator is ready".into(),
            rest => format!("holds still for {} s and until its estimator is ready", rest.0 / NANOS),
        });
        let set = |setting: &&str| format!(" --set '{setting}'");
        let settings: String = self.settings.iter().chain(self.wants).map(set).collect();
        lines.push(format!("scene {}{settings} by default", self.scene));
        lines.push(format!("asked for {}", self.asks));
        lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensor::SensorKind;

    fn rates(target: &str, scene: Option<&str>, sets: &[&str]) -> Vec<(SensorKind, f64)> {
        let target = Target::from_name(target).unwrap();
        let sets: Vec<_> = sets.iter().map(|set| set.to_string()).collect();
        let (plan, _) = target.load(scene, &sets).unwrap_or_else(|error| panic!("{error}"));
        plan.sensors.iter().map(|sensor| (sensor.kind, sensor.rate.as_hz())).collect()
    }

    #[test]
    fn a_built_in_scene_gets_what_the_controller_needs_and_a_file_stays_as_it_is() {
        use SensorKind::{Accel, Baro, Gyro, Mag};
        let inav = [(Gyro, 100.0), (Accel, 100.0), (Mag, 100.0)];
        assert_eq!(rates("inav", None, &[]), inav);
        assert_eq!(rates("inav", Some("level-then-turn"), &[]), inav, "by its name too");
        let own = rates("inav", Some("level-then-turn"), &["gyro.rate=50 Hz", "accel.rate=400 Hz"]);
        assert_eq!(own, [(Gyro, 50.0), (Accel, 400.0), (Mag, 100.0)], "--set has the last word");
        // A faster magnetometer stays: nothing says what rate it should have.
        let px4 = rates("px4-sitl", Some("still"), &[]);
        assert_eq!(px4.last(), Some(&(Baro, 50.0)), "PX4 wants a barometer");
        assert_eq!(px4[0], rates("ardupilot", Some("still"), &[])[0], "no other rate changes");
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.toml");
        std::fs::write(&path, "duration = \"1 s\"\n[gyro]\nrate = \"1 kHz\"\n").unwrap();
        for target in ["inav", "px4"] {
            assert_eq!(rates(target, path.to_str(), &[]), [(Gyro, 1000.0)]);
        }
        let said = Target::from_name("inav").unwrap().load(Some("still"), &[]).unwrap().1;
        assert_eq!(said, ["gyro.rate=100 Hz", "accel.rate=100 Hz"]);
    }
}
