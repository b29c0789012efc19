//! Faults of an output: what happens to packets on their way, during a period. `faults` applies them.

use crate::keys::{Key, KeyError, Name, Values};
use crate::quantity::{Kind, Sign};
use crate::time::{NANOS, SimTime};
use std::fmt;

pub(super) const SHARE: Name<f64> = Name::new("share");
pub(super) const BITS: Name<u64> = Name::new("bits");
pub(super) const HURTS: Name<&str> = Name::new("hurts");
pub(super) const PIECES: Name<u64> = Name::new("pieces");
pub(super) const GAP: Name<SimTime> = Name::new("gap");

/// The kinds of fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PacketFaultKind {
    /// A random `share` of the packets is lost.
    Drop,
    /// `bits` bits flip in a `share` of the packets.
    Corrupt,
    /// A `share` of the packets arrives twice.
    Duplicate,
    /// The next packet overtakes a `share` of the packets.
    Reorder,
    /// Nothing goes out; then everything goes at once.
    Stall,
    /// A `share` of the packets goes out in `pieces`, a `gap` apart.
    Split,
}

/// The longest stall: memory holds its packets.
const LONGEST_STALL: SimTime = SimTime(10 * NANOS);

impl PacketFaultKind {
    /// Every kind.
    pub const ALL: [PacketFaultKind; 6] = [
        PacketFaultKind::Drop,
        PacketFaultKind::Corrupt,
        PacketFaultKind::Duplicate,
        PacketFaultKind::Reorder,
        PacketFaultKind::Stall,
        PacketFaultKind::Split,
    ];

    /// Its name in scenes.
    pub const fn name(self) -> &'static str {
        ["drop", "corrupt", "duplicate", "reorder", "stall", "split"][self as usize]
    }

    /// Its keys besides `output`, `kind`, `start` and `duration`.
    pub fn keys(self) -> Vec<Key> {
        let share = |default, about| SHARE.scalar(Kind::RATIO.signed(Sign::NonNegative), about).or(default);
        match self {
            PacketFaultKind::Drop => vec![share("1 %", "of the packets is missing")],
            PacketFaultKind::Corrupt => vec![
                share("1 %", "of the packets is hurt"),
                BITS.whole(1, 64, "flipped in each").or("1"),
                HURTS.word(&["packet", "framing"], "what may be hit"),
            ],
            PacketFaultKind::Duplicate => vec![share("1 %", "of the packets comes twice")],
            PacketFaultKind::Reorder => vec![share("1 %", "of the packets is overtaken")],
            PacketFaultKind::Stall => vec![],
            PacketFaultKind::Split => vec![
                share("100 %", "of the packets goes out in pieces"),
                PIECES.whole(2, 16, "of a packet").or("2"),
                GAP.duration("from piece to piece").or("1 ms"),
            ],
        }
    }
}

/// A fault of an output.
#[derive(Clone, Debug)]
pub struct PacketFault {
    /// Its kind.
    pub kind: PacketFaultKind,
    /// Its start.
    pub start: SimTime,
    /// Its end.
    pub end: SimTime,
    /// The values of its kind's keys.
    pub values: Values,
}

impl fmt::Display for PacketFault {
    /// `drop from 2 s to 3 s`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} from {}", self.kind.name(), self.start)?;
        if self.end < SimTime::FOREVER { write!(f, " to {}", self.end) } else { Ok(()) }
    }
}

impl PacketFault {
    /// Checks the values.
    ///
    /// # Errors
    /// The key with a bad value, and what would be right.
    pub fn check(&self) -> Result<(), KeyError> {
        if self.values.get(SHARE).is_some_and(|share| share > 1.0) {
            return Err(KeyError::new(SHARE, "a share of the packets is at most 100 %"));
        }
        if self.kind == PacketFaultKind::Stall && self.end - self.start > LONGEST_STALL {
            let message = format!(
                "a stall lasts {LONGEST_STALL} at most, for its packets are kept; for a link that is away longer write kind = \"drop\", share = \"100 %\""
            );
            return Err(KeyError::new("duration", message));
        }
        Ok(())
    }
}
