//! The conversation with the other end: its messages, our replies, and when it accepts samples.
//!
//! A [`Dialogue`] touches no link and reads no clock. Bytes and times go in and their meaning comes out, so a test
//! holds a whole conversation in memory. The session writes the replies, keeps the estimates for the score, and
//! holds the vehicle still until every [`Stage`] is [`Stage::Ready`].

mod frames;

pub use frames::frames;

use super::Controller;
use crate::geometry::Attitude;
use crate::time::{Rate, SimTime};

/// The meaning of a message from the other side.
#[derive(Debug)]
pub enum Said<'a> {
    /// Its estimate of the attitude.
    Estimate(Estimate),
    /// Send it these bytes as soon as possible, ahead of the stream; at most [`super::MAX_PACKET`].
    Reply(&'a [u8]),
    /// Before the stream it is to be sent this packet on the stream's own link, where the conversation is held on another;
    /// at most [`super::MAX_PACKET`]. Once the stream goes it is lost.
    Ahead(&'a [u8]),
    /// It has read a packet of samples and waits for the next: lockstep.
    Took,
    /// A notice for the user, given once.
    Notice(String),
    /// It has restarted: a notice for the user.
    Restart(String),
    /// A whole message of the other side for a ground station.
    Pass(&'a [u8]),
    /// It goes on at this speed, baud, once it has what was said before: a serial port follows.
    Speed(u32),
}

/// An attitude estimate of the other side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// When it held.
    pub stamp: Stamp,
    /// Body to nav.
    pub attitude: Attitude,
}

/// What is known of the time at which an estimate held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stamp {
    /// The stream time of its newest sample, as echoed: exact.
    Sample(SimTime),
    /// Time of the other side's own clock, ns since an unknown epoch.
    Own(i64),
    /// Only its arrival time.
    Arrival,
}

/// The stage of a conversation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// It does not accept samples yet: a handshake is in progress, or it has not spoken.
    Silent,
    /// It receives the vehicle at rest while its estimator settles.
    Still,
    /// The scene may start.
    Ready,
}

/// What the encoder has to know of the other side, once the stage is past [`Stage::Silent`]; it may change later.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peer {
    /// The system id to share (MAVLink).
    pub system: Option<u8>,
    /// The sample rate that it requested.
    pub rate: Option<Rate>,
    /// The rate at which it asked for the packets that go beside them.
    pub second: Option<Rate>,
    /// Who it is, by what it asks for.
    pub controller: Option<Controller>,
}

/// One end of a conversation. `now` is in ns on one clock; only differences matter.
pub trait Dialogue: Send {
    /// Processes bytes as they arrive, in pieces of any size.
    fn hear(&mut self, bytes: &[u8], now: i64, say: &mut dyn FnMut(Said<'_>));

    /// Processes bytes that it told elsewhere: whole messages.
    fn overhear(&mut self, _bytes: &[u8], _now: i64, _say: &mut dyn FnMut(Said<'_>)) {}

    /// Sends what is due without a request: a question, a retransmission, a notice that nobody answers. Call it
    /// about every ten milliseconds.
    fn tick(&mut self, _now: i64, _say: &mut dyn FnMut(Said<'_>)) {}

    /// Called when the run ends before the stream began, for a packet that leaves the other side with a vehicle at rest.
    fn leave(&mut self, _say: &mut dyn FnMut(Said<'_>)) {}

    /// The present stage.
    fn stage(&self) -> Stage {
        Stage::Ready
    }

    /// What is known of the other side.
    fn peer(&self) -> Peer {
        Peer::default()
    }

    /// Whether it answers every packet of the stream.
    fn answers_every_packet(&self) -> bool {
        false
    }

    /// Damaged packets, and runs of bytes that are no packet.
    fn damaged(&self) -> u64 {
        0
    }
}

/// After this long without a byte, ns, held bytes are read as they are: noise that looks like the start of a long
/// packet would otherwise hide the packets after it.
pub(super) const PAUSE: i64 = 100_000_000;

/// Detects a [`PAUSE`] in the received bytes.
#[derive(Debug, Default)]
pub(super) struct Pause {
    heard: Option<i64>,
}

impl Pause {
    /// Records that bytes arrived.
    pub fn heard(&mut self, now: i64) {
        self.heard = Some(now);
    }

    /// Whether a pause has begun since then; true once for each pause.
    pub fn is_now(&mut self, now: i64) -> bool {
        self.heard.take_if(|heard| now - *heard >= PAUSE).is_some()
    }
}
