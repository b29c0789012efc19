//! Faults of an output: what happens to packets on their way, during a period. `faults` applies them.

use crate::keys::{Key, KeyError, Takes, Values};
use crate::quantity::{Kind, Sign};
use crate::time::{NANOS, SimTime};
use std::fmt;

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
        let key = |name, takes, default, about| Key { name, takes, default: Some(default), about };
        let share = |default, about| {
            key("share", Takes::Scalar(Kind::RATIO.signed(Sign::NonNegative)), default, about)
        };
        match self {
            PacketFaultKind::Drop => vec![share("1 %", "of the packets is missing")],
            PacketFaultKind::Corrupt => vec![
                share("1 %", "of the packets is hurt"),
                key("bits", Takes::Whole(1, 64), "1", "flipped in each"),
                key("hurts", Takes::Word(&["packet", "framing"]), "packet", "what may be hit"),
            ],
            PacketFaultKind::Duplicate => vec![share("1 %", "of the packets comes twice")],
            PacketFaultKind::Reorder => vec![share("1 %", "of the packets is overtaken")],
            PacketFaultKind::Stall => vec![],
            PacketFaultKind::Split => vec![
                share("100 %", "of the packets goes out in pieces"),
                key("pieces", Takes::Whole(2, 16), "2", "of a packet"),
                key("gap", Takes::Duration, "1 ms", "from piece to piece"),
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
        if self.values.scalar("share").is_some_and(|share| share > 1.0) {
            return Err(KeyError::new("share", "a share of the packets is at most 100 %"));
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
