//! What a key accepts. The kinds themselves are in `table.rs`; `read.rs` reads a text as one of them.

use super::unit::Dimension;

/// What a key of a scene accepts.
///
/// Values come out in inside units, given with each constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kind {
    pub(super) name: &'static str,
    pub(super) dimensions: &'static [Dimension],
    /// A value as one would write it.
    pub(super) example: &'static str,
    /// Units to offer where one is missing; the first is the inside one.
    pub(super) units: &'static [&'static str],
    pub(super) sign: Sign,
}

impl Kind {
    /// The same kind with these signs allowed.
    pub const fn signed(mut self, sign: Sign) -> Self {
        self.sign = sign;
        self
    }

    /// What it is called: `angular rate`.
    pub const fn name(&self) -> &'static str {
        self.name
    }

    /// Whether it has no sign, as the size of a noise.
    pub const fn is_magnitude(&self) -> bool {
        !matches!(self.sign, Sign::Any)
    }

    /// Which values it takes, to be said behind its name: `, 0 or more`; nothing where it takes any.
    pub const fn bounds(&self) -> &'static str {
        match self.sign {
            Sign::Any => "",
            Sign::NonNegative => ", 0 or more",
            Sign::Positive => ", above 0",
        }
    }

    /// A value as one would write it: `20 deg/s`.
    pub const fn example(&self) -> &'static str {
        self.example
    }

    /// Units worth offering: `rad/s`, `deg/s`.
    pub const fn units(&self) -> &'static [&'static str] {
        self.units
    }

    /// The dimensions accepted.
    pub const fn dimensions(&self) -> &'static [Dimension] {
        self.dimensions
    }

    /// `an angular rate`.
    pub(super) fn with_article(&self) -> String {
        let article = if self.name.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
        format!("{article} {}", self.name)
    }
}

/// Which signs a value may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    /// Any.
    Any,
    /// Zero or above.
    NonNegative,
    /// Above zero.
    Positive,
}
