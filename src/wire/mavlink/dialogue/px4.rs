//! PX4 on its board, in HITL: woken, waited for, its parameters read, and told on when it does not hear.
//!
//! PX4 takes HIL_SENSOR only in HIL mode and only on links of more than 5000 B/s (`Mavlink::set_hil_enabled`); a rate
//! of 0 stands for a twentieth of the baud rate. Everything else about such a link looks healthy, so what matters is
//! read from its parameters. In HIL mode it has no other sensors: an attitude means that it hears.

use super::parameters::Parameters;
use super::steady::Steady;
use super::{Autopilot, Said, Stage, Voice};
use crate::geometry::Attitude;
use crate::time::NANOS;
use crate::wire::Protocol;
use crate::wire::mavlink::HARDWARE_IN_THE_LOOP;

/// The slowest link that PX4 does not take samples from, B/s.
const DEAF_RATE: i32 = 5000;
/// What PX4's guides recommend for a companion's link.
const GOOD_BAUD: u32 = 921_600;
/// Without an attitude for so long after the first samples, ns, a slow link is to blame: over USB, which goes by no
/// parameter, attitude has come by then.
const PATIENCE: i64 = 4 * NANOS;
/// And for so long, it does not hear, ns.
const DEAF: i64 = 10 * NANOS;
/// Heartbeats come once a second: after a gap of so long it was booted anew, ns.
const REBOOTED: i64 = 4 * NANOS;

/// Its serial ports by the number that `MAV_x_CONFIG` gives them: name, parameter of the baud rate.
const PORTS: [(i32, &str, &str); 4] = [
    (101, "TELEM 1", "SER_TEL1_BAUD"),
    (102, "TELEM 2", "SER_TEL2_BAUD"),
    (103, "TELEM 3", "SER_TEL3_BAUD"),
    (104, "TELEM 4", "SER_TEL4_BAUD"),
];
/// Its MAVLink instances: name, port, data rate.
const INSTANCES: [(&str, &str, &str); 3] = [
    ("MAV_0", "MAV_0_CONFIG", "MAV_0_RATE"),
    ("MAV_1", "MAV_1_CONFIG", "MAV_1_RATE"),
    ("MAV_2", "MAV_2_CONFIG", "MAV_2_RATE"),
];
const HITL: &str = "SYS_HITL";

/// What is known of the controller, and what of it was said.
#[derive(Debug, Default)]
pub(super) struct Px4 {
    pub(super) parameters: Parameters,
    steady: Steady,
    /// When it was first ticked, last woken, first heard of since it booted, and last heard of.
    started_at: Option<i64>,
    woken: Option<(i64, u8)>,
    fed_since: Option<i64>,
    beat_at: Option<i64>,
    reacted: bool,
    settled: bool,
    ready: bool,
    given: Given,
}

/// Which notices were given since it booted.
#[derive(Debug, Default)]
struct Given {
    nobody: bool,
    gone: bool,
    mode: bool,
    hitl: bool,
    slow: bool,
    deaf: bool,
}

impl Px4 {
    pub(super) fn stage(&self) -> Stage {
        match (self.beat_at, self.ready) {
            (None, _) => Stage::Silent,
            (Some(_), false) => Stage::Still,
            (Some(_), true) => Stage::Ready,
        }
    }

    /// Takes a heartbeat; true where it begins anew, because it has just booted.
    pub(super) fn beat(&mut self, now: i64) -> bool {
        let last = self.beat_at.replace(now);
        let booted = last.is_none_or(|last| now - last > REBOOTED);
        if booted {
            self.parameters.forget();
            self.parameters.want(HITL);
            for (_, config, rate) in INSTANCES {
                self.parameters.want(config);
                self.parameters.want(rate);
            }
            (self.steady, self.given) = (Steady::default(), Given::default());
            (self.fed_since, self.reacted, self.settled) = (Some(now), false, false);
        }
        booted
    }

    /// Takes note that it does something with the samples.
    pub(super) fn react(&mut self) {
        self.reacted = true;
    }

    /// Takes its estimate.
    pub(super) fn attitude(&mut self, attitude: Attitude, now: i64) {
        self.reacted = true;
        self.settled |= self.steady.take(attitude, now);
    }

    pub(super) fn tick(
        &mut self,
        now: i64,
        autopilot: Option<&Autopilot>,
        voice: &mut Voice,
        say: &mut dyn FnMut(Said<'_>),
    ) {
        let started = *self.started_at.get_or_insert(now);
        let (Some(autopilot), Some(fed_since)) = (autopilot, self.fed_since) else {
            return self.wake(now, started, say);
        };
        for (_, config, _) in INSTANCES {
            if let Some((_, _, baud)) = self.port(config) {
                self.parameters.want(baud);
            }
        }
        self.parameters.tick(now, autopilot, voice, say);
        self.judge(now, autopilot, now - fed_since, say);
        // With sensors of its own its attitude says nothing of ours.
        self.ready |= self.settled && self.parameters.get(HITL).is_none_or(|hitl| hitl == 1);
    }

    /// Beats like a ground station: USB ports of PX4 wait for one before they speak MAVLink.
    fn wake(&mut self, now: i64, started: i64, say: &mut dyn FnMut(Said<'_>)) {
        let seq = self.woken.map_or(0, |(_, seq)| seq.wrapping_add(1));
        if self.woken.is_none_or(|(at, _)| now - at >= NANOS) {
            self.woken = Some((now, seq));
            say(Said::Reply(&Protocol::Mavlink.greeting(seq)));
        }
        if now - started > 5 * NANOS {
            once(&mut self.given.nobody, say, || {
                "no heartbeat of a controller for 5 s: is this its MAVLink port, and this its baud rate?"
                    .into()
            });
        }
    }

    /// Says what is known to be wrong.
    fn judge(&mut self, now: i64, autopilot: &Autopilot, fed: i64, say: &mut dyn FnMut(Said<'_>)) {
        let hitl = self.parameters.get(HITL);
        if let Some(hitl) = hitl.filter(|hitl| *hitl != 1) {
            once(&mut self.given.hitl, say, || format!("{HITL} is {hitl}: set it to 1 and reboot"));
        }
        if autopilot.base_mode & HARDWARE_IN_THE_LOOP == 0
            && hitl.is_none_or(|hitl| hitl == 1)
            && self.parameters.settled(HITL, now)
        {
            let mode = autopilot.base_mode;
            let cure = if hitl.is_some() { "SYS_HITL is 1: reboot" } else { "set SYS_HITL to 1 and reboot" };
            once(&mut self.given.mode, say, || {
                format!(
                    "the controller's heartbeat does not say HIL (base_mode {mode:#04x} lacks 0x20); {cure}"
                )
            });
        }
        let silent = self.beat_at.map_or(0, |at| now - at);
        if silent > REBOOTED {
            once(&mut self.given.gone, say, || {
                format!("no heartbeat for {} s: the controller reboots or was unplugged", silent / NANOS)
            });
            return;
        }
        let rates_are_known = INSTANCES.iter().all(|(_, config, rate)| {
            let baud = self.port(config).is_none_or(|(_, _, baud)| self.parameters.settled(baud, now));
            self.parameters.settled(config, now) && self.parameters.settled(rate, now) && baud
        });
        if !self.reacted && !self.given.slow && fed >= PATIENCE && rates_are_known {
            self.given.slow = true;
            self.slow_links().into_iter().for_each(|notice| say(Said::Notice(notice)));
        }
        if !self.reacted && fed >= DEAF {
            once(&mut self.given.deaf, say, || self.parameters.why_deaf());
        }
    }

    /// The port of an instance: number, name, parameter of its baud rate.
    fn port(&self, config: &str) -> Option<(i32, &'static str, &'static str)> {
        let number = self.parameters.get(config)?;
        PORTS.into_iter().find(|port| port.0 == number)
    }

    /// What is to be changed of each instance that is too slow to be listened to.
    fn slow_links(&self) -> Vec<String> {
        let slow = |(name, config, rate): (&str, &'static str, &'static str)| {
            if self.parameters.get(config) == Some(0) {
                // Switched off.
                return None;
            }
            let bytes = self.parameters.get(rate)?;
            let port = self.port(config);
            let baud = port.and_then(|(_, _, key)| Some((key, self.parameters.get(key)?)));
            // 0 is found out by PX4 itself.
            let slow_baud = baud.filter(|(_, baud)| (1..=20 * DEAF_RATE).contains(baud));
            let here = port.map_or(String::new(), |(_, port, _)| {
                format!(" ({name} is {port}; USB goes by none of them)")
            });
            let and_baud = slow_baud.map_or(String::new(), |(key, _)| format!(" and {key} to {GOOD_BAUD}"));
            match (bytes, slow_baud) {
                (1..=DEAF_RATE, _) => Some(format!(
                    "{rate} is {bytes} B/s: PX4 ignores HIL_SENSOR below {DEAF_RATE} B/s; set {rate} to 0{and_baud} and reboot{here}"
                )),
                (0, Some((key, baud))) => Some(format!(
                    "{key} is {baud}: {rate} = 0 gives MAVLink a twentieth of it, {} B/s, and PX4 ignores HIL_SENSOR below {DEAF_RATE} B/s; set {key} to {GOOD_BAUD} and reboot{here}",
                    baud / 20
                )),
                _ => None,
            }
        };
        INSTANCES.into_iter().filter_map(slow).collect()
    }
}

impl Parameters {
    /// The causes of a controller that beats but does not hear, in order; those that its parameters rule out are not
    /// among them.
    fn why_deaf(&self) -> String {
        let hitl = (self.get(HITL) != Some(1)).then_some("SYS_HITL is not 1");
        let causes = [
            hitl,
            Some(
                "this link's data rate is not above 5000 B/s (MAV_x_RATE; where that is 0, a twentieth of the baud rate)",
            ),
            Some("it was not rebooted since one of these was changed"),
            Some("its estimator was started long before the samples: reboot it now, the stream goes on"),
        ];
        let causes: Vec<_> =
            causes.into_iter().flatten().zip(1..).map(|(cause, i)| format!("({i}) {cause}")).collect();
        format!(
            "the controller beats but does not answer samples for {} s; causes in order: {}",
            DEAF / NANOS,
            causes.join(", ")
        )
    }
}

/// Gives a notice that was not given yet.
fn once(said: &mut bool, say: &mut dyn FnMut(Said<'_>), notice: impl FnOnce() -> String) {
    if !*said {
        *said = true;
        say(Said::Notice(notice()));
    }
}
