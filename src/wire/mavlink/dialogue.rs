//! `mavlink`: an autopilot's heartbeat, attitude and clock, and the messages for a ground station.
//!
//! The first autopilot heard is the other side. The scene shares its system id ([`Peer::system`]); attitudes of
//! other senders are forwarded but are not its estimates. Replies use the MAVLink version in which it speaks. PX4
//! has its own procedure, on its board ([`px4`]) and as a program in lockstep.

mod asking;
mod parameters;
mod px4;
mod steady;

mod voice;

use crate::geometry::{Attitude, Euler};
use crate::wire::Controller;
use crate::wire::dialogue::{Dialogue, Estimate, Pause, Peer, Said, Stage, Stamp};
use crate::wire::mavlink::{COMPONENT, NO_AUTOPILOT};
use asking::Asking;
use glam::DQuat;
use px4::Px4;
use ratetable_protocols::Error;
use ratetable_protocols::mavlink::{
    Decoder, Header, Message, Received, attitude, attitude_quaternion, command_ack, heartbeat,
    hil_actuator_controls, timesync,
};
use voice::Voice;

/// MAV_TYPE_GCS: a ground station. It may name an autopilot's make but is none.
const GROUND_STATION: u8 = 6;

/// An autopilot may send the same estimate as quaternion and as Euler angles. The quaternion counts; Euler angles
/// count only after this long without a quaternion, ns.
const QUATERNION_GONE: i64 = 1_000_000_000;
/// Its clock goes back by more than this when it restarts, ms.
const SET_BACK: i32 = 1000;

/// The conversation on one link.
pub(super) struct Mavlink {
    decoder: Decoder,
    /// Of what it tells elsewhere.
    aside: Decoder,
    ear: Ear,
    pause: Pause,
}

/// The autopilot at the other end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Autopilot {
    system: u8,
    component: u8,
    /// `MAV_MODE_FLAG` of its newest heartbeat.
    base_mode: u8,
}

/// The condition for the scene to start.
enum Way {
    /// Nothing.
    Any,
    /// PX4 on its board: its heartbeat, then its settled estimator.
    Hitl(Box<Px4>),
    /// PX4 as a program: its first answer to samples.
    Sitl { took: bool },
}

/// Handles received messages.
struct Ear {
    voice: Voice,
    autopilot: Option<Autopilot>,
    asking: Asking,
    quaternion_at: Option<i64>,
    /// The newest time of its clock, ms.
    boot_ms: Option<u32>,
    way: Way,
    damaged: u64,
}

impl Mavlink {
    pub(super) fn new(controller: Option<Controller>) -> Mavlink {
        let way = match controller {
            Some(Controller::Px4) => Way::Hitl(Box::default()),
            Some(Controller::Px4Sitl) => Way::Sitl { took: false },
            Some(_) | None => Way::Any,
        };
        Mavlink {
            decoder: Decoder::new(),
            aside: Decoder::new(),
            pause: Pause::default(),
            ear: Ear {
                voice: Voice::default(),
                autopilot: None,
                asking: Asking::default(),
                quaternion_at: None,
                boot_ms: None,
                way,
                damaged: 0,
            },
        }
    }
}

impl Mavlink {
    /// Reads held bytes as they are after a pause.
    fn end_of_burst(&mut self, now: i64, say: &mut dyn FnMut(Said<'_>)) {
        if self.pause.is_now(now) {
            let Mavlink { decoder, ear, .. } = self;
            decoder.finish_whole(|received| ear.take(received, now, say));
        }
    }
}

impl Dialogue for Mavlink {
    fn hear(&mut self, bytes: &[u8], now: i64, say: &mut dyn FnMut(Said<'_>)) {
        self.end_of_burst(now, say);
        self.pause.heard(now);
        let Mavlink { decoder, ear, .. } = self;
        decoder.feed_whole(bytes, |received| ear.take(received, now, say));
    }

    fn overhear(&mut self, bytes: &[u8], now: i64, say: &mut dyn FnMut(Said<'_>)) {
        let Mavlink { aside, ear, .. } = self;
        aside.feed_whole(bytes, |received| ear.overhear(received.map(|(received, _)| received), now, say));
    }

    fn tick(&mut self, now: i64, say: &mut dyn FnMut(Said<'_>)) {
        self.end_of_burst(now, say);
        let Ear { voice, autopilot, asking, way, .. } = &mut self.ear;
        if let Way::Hitl(px4) = way {
            px4.tick(now, autopilot.as_ref(), voice, say);
        }
        // The link to a simulator carries no attitude.
        if let (Some(autopilot), Way::Any | Way::Hitl(_)) = (autopilot, way) {
            asking.tick(now, autopilot, voice, say);
        }
    }

    fn stage(&self) -> Stage {
        match &self.ear.way {
            Way::Any | Way::Sitl { took: true } => Stage::Ready,
            Way::Sitl { took: false } => Stage::Still,
            Way::Hitl(px4) => px4.stage(),
        }
    }

    fn peer(&self) -> Peer {
        Peer { system: self.ear.autopilot.map(|autopilot| autopilot.system), ..Peer::default() }
    }

    fn damaged(&self) -> u64 {
        self.ear.damaged
    }
}

impl Ear {
    fn take(&mut self, received: Result<(Received, &[u8]), Error>, now: i64, say: &mut dyn FnMut(Said<'_>)) {
        let Ok((Received { header, id, message, .. }, packet)) = received else {
            self.damaged += 1;
            return;
        };
        if [COMPONENT, voice::COMPONENT].contains(&header.component) {
            // Our own messages, on a line that is looped back.
            return;
        }
        if !is_hil(id) {
            say(Said::Pass(packet));
        }
        let Some(message) = message else { return };
        if let Message::Heartbeat(beat) = message {
            return self.beat(&header, &beat, now);
        }
        if self.autopilot.is_some_and(|autopilot| autopilot.system != header.system) {
            return;
        }
        match message {
            Message::Timesync(timesync::Repr { tc1: 0, ts1 }) => {
                self.voice.say(&Message::Timesync(timesync::Repr { tc1: now, ts1 }), say);
            }
            Message::AttitudeQuaternion(_) | Message::Attitude(_) => self.attitude(&message, now, say),
            Message::HilActuatorControls(controls) => {
                if controls.flags & hil_actuator_controls::LOCKSTEP != 0 {
                    say(Said::Took);
                }
                match &mut self.way {
                    Way::Any => {}
                    Way::Sitl { took } => *took = true,
                    Way::Hitl(px4) => px4.react(),
                }
            }
            Message::CommandAck(command_ack::Repr { command, result, .. }) => {
                self.asking.answered(command, result);
            }
            Message::ParamValue(value) => {
                if let Way::Hitl(px4) = &mut self.way {
                    px4.parameters.take(&value);
                }
            }
            _ => {}
        }
    }

    /// Its attitude, as quaternion or as Euler angles.
    fn attitude(&mut self, message: &Message, now: i64, say: &mut dyn FnMut(Said<'_>)) {
        match *message {
            Message::AttitudeQuaternion(attitude_quaternion::Repr { time_boot_ms, q, .. }) => {
                self.asking.hear(attitude_quaternion::ID, now);
                self.quaternion_at = Some(now);
                let [w, x, y, z] = q.map(f64::from);
                self.estimate(time_boot_ms, DQuat::from_xyzw(x, y, z, w), now, say);
            }
            Message::Attitude(attitude::Repr { time_boot_ms, roll, pitch, yaw, .. }) => {
                self.asking.hear(attitude::ID, now);
                if self.quaternion_at.is_none_or(|at| now - at > QUATERNION_GONE) {
                    let [roll, pitch, yaw] = [roll, pitch, yaw].map(f64::from);
                    self.estimate(time_boot_ms, Euler { roll, pitch, yaw }.to_quat(), now, say);
                }
            }
            _ => {}
        }
    }

    /// Reads what it tells elsewhere, where other programs may speak too: its attitude alone.
    fn overhear(&mut self, received: Result<Received, Error>, now: i64, say: &mut dyn FnMut(Said<'_>)) {
        let Ok(Received { header, message: Some(message), .. }) = received else { return };
        if self.autopilot.is_none_or(|autopilot| autopilot.system == header.system) {
            self.attitude(&message, now, say);
        }
    }

    /// Records a heartbeat; the first autopilot becomes the other side.
    fn beat(&mut self, header: &Header, beat: &heartbeat::Repr, now: i64) {
        if beat.autopilot == NO_AUTOPILOT || beat.kind == GROUND_STATION {
            return;
        }
        let &Header { version, system, component, .. } = header;
        let heard = Autopilot { system, component, base_mode: beat.base_mode };
        let known = *self.autopilot.get_or_insert(heard);
        if (known.system, known.component) != (system, component) {
            return;
        }
        self.autopilot = Some(heard);
        self.voice.adopt(version, system);
        if let Way::Hitl(px4) = &mut self.way
            && px4.beat(now)
        {
            self.asking = Asking::default();
        }
    }

    /// Its clock counts from its boot: where that goes back it has restarted, and has to be asked again.
    fn notice_restart(&mut self, time_boot_ms: u32, now: i64, say: &mut dyn FnMut(Said<'_>)) {
        let Some(before) = self.boot_ms.replace(time_boot_ms) else { return };
        // In whole turns of the 32 bits.
        if time_boot_ms.wrapping_sub(before).cast_signed() > -SET_BACK {
            return;
        }
        self.asking = Asking::default();
        if let Way::Hitl(px4) = &mut self.way {
            px4.boot(now);
        }
        let [before, after] = [before, time_boot_ms].map(|ms| f64::from(ms) / 1000.0);
        say(Said::Restart(format!(
            "the controller has restarted: its clock went back from {before:.1} s to {after:.1} s"
        )));
    }

    fn estimate(&mut self, time_boot_ms: u32, q: DQuat, now: i64, say: &mut dyn FnMut(Said<'_>)) {
        if !(q.is_finite() && q.length_squared() > 0.25) {
            self.damaged += 1;
            return;
        }
        self.notice_restart(time_boot_ms, now, say);
        let attitude = Attitude::from_quat(q.normalize());
        if let Way::Hitl(px4) = &mut self.way {
            px4.attitude(attitude, now);
        }
        say(Said::Estimate(Estimate { stamp: Stamp::Own(i64::from(time_boot_ms) * 1_000_000), attitude }));
    }
}

/// Whether a message of this id concerns only simulator and autopilot: HIL_STATE, HIL_CONTROLS, HIL_RC_INPUTS_RAW,
/// HIL_ACTUATOR_CONTROLS, HIL_SENSOR, HIL_GPS, HIL_OPTICAL_FLOW, HIL_STATE_QUATERNION.
const fn is_hil(id: u32) -> bool {
    matches!(id, 90..=93 | 107 | 113..=115)
}

#[cfg(test)]
mod tests;
