//! The conversation with whoever is at the other end: what they say, what is answered, when they may be played to.
//!
//! A [`Dialogue`] touches no link and reads no clock: bytes and times go in, what they mean comes out, so that a
//! test holds a whole conversation in memory. The session writes the replies, keeps the estimates for the score and
//! holds the vehicle still until every [`Stage`] is [`Stage::Ready`].

mod frames;

pub use frames::frames;

use crate::geometry::Attitude;
use crate::time::{Rate, SimTime};

/// What a message from the other side amounts to.
#[derive(Debug)]
pub enum Said<'a> {
    /// Its estimate of the attitude.
    Estimate(Estimate),
    /// It is to be sent these bytes as soon as possible, ahead of the stream; at most [`super::MAX_PACKET`].
    Reply(&'a [u8]),
    /// Before the stream it is to be sent this packet on the stream's own link, where the conversation is held on another;
    /// at most [`super::MAX_PACKET`]. Once the stream goes it is lost.
    Ahead(&'a [u8]),
    /// It has taken a packet of samples in and waits for the next: lockstep.
    Took,
    /// The user should know this; said once.
    Notice(String),
    /// A whole message of the other side that a ground station would want to see.
    Pass(&'a [u8]),
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
    /// The stream time of the newest sample it rests on, as echoed: exact.
    Sample(SimTime),
    /// Time of the other side's own clock, ns since whenever.
    Own(i64),
    /// Nothing but its arrival.
    Arrival,
}

/// How far a conversation is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// It is not to be sent samples yet: a handshake is under way, or it has not been heard.
    Silent,
    /// It is fed the vehicle at rest, for its estimator to settle.
    Still,
    /// The scene may start.
    Ready,
}

/// What the encoder has to know of the other side, once the stage is past [`Stage::Silent`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peer {
    /// The system id to share (MAVLink).
    pub system: Option<u8>,
    /// The rate at which it asked for samples.
    pub rate: Option<Rate>,
}

/// One end of a conversation; `now` is in ns on one clock, of which only differences matter.
pub trait Dialogue: Send {
    /// Takes in bytes as they arrive, however they are cut.
    fn hear(&mut self, bytes: &[u8], now: i64, say: &mut dyn FnMut(Said<'_>));

    /// Called every ten milliseconds or so, for what is due by itself: a request, a resend, a notice that nobody answers.
    fn tick(&mut self, _now: i64, _say: &mut dyn FnMut(Said<'_>)) {}

    /// Called when the run ends before the stream began, for a packet that leaves the other side with a vehicle at rest.
    fn leave(&mut self, _say: &mut dyn FnMut(Said<'_>)) {}

    /// How far it is.
    fn stage(&self) -> Stage {
        Stage::Ready
    }

    /// What is known of the other side.
    fn peer(&self) -> Peer {
        Peer::default()
    }

    /// Packets that came damaged, and runs of bytes that were none.
    fn damaged(&self) -> u64 {
        0
    }
}

/// After so long without a byte, ns, what is held is judged as it is: noise that looks like the start of a long packet
/// would hide what comes behind it.
pub(super) const PAUSE: i64 = 100_000_000;

/// Watches for a [`PAUSE`] in what arrives.
#[derive(Debug, Default)]
pub(super) struct Pause {
    heard: Option<i64>,
}

impl Pause {
    /// Bytes came.
    pub fn heard(&mut self, now: i64) {
        self.heard = Some(now);
    }

    /// Whether there is one since then; said once.
    pub fn is_now(&mut self, now: i64) -> bool {
        self.heard.take_if(|heard| now - *heard >= PAUSE).is_some()
    }
}
