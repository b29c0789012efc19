//! The unit of a field whose protocol does not say it.

/// What a receiver takes the numbers of a magnetic field for, in `sbg`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum MagUnit {
    /// Milligauss, as ArduPilot's driver does.
    #[default]
    Milligauss,
    /// Gauss, as PX4's driver does.
    Gauss,
}

impl MagUnit {
    /// As scenes spell them, the default first.
    pub const NAMES: [&str; 2] = ["milligauss", "gauss"];

    /// The one of that name; any other is the default.
    pub(crate) fn from_name(name: &str) -> MagUnit {
        if name == "gauss" { MagUnit::Gauss } else { MagUnit::Milligauss }
    }

    /// Of one of it, µT.
    pub(super) const fn microtesla(self) -> f64 {
        match self {
            MagUnit::Milligauss => 0.1,
            MagUnit::Gauss => 100.0,
        }
    }
}
