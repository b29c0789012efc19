//! What a unit says of its own attitude, beside the readings.

/// What a unit says of its own attitude, in protocols whose units have one to tell.
///
/// A flight controller that estimates for itself does not use it. A false one keeps the truth off the link, so that an
/// estimate that follows the motion follows the readings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Claim {
    /// Level and facing north, whatever the vehicle does.
    #[default]
    Level,
    /// What is true.
    Truth,
}

impl Claim {
    /// As scenes spell them, the default first.
    pub const NAMES: [&str; 2] = ["level", "truth"];

    /// The one of that name; any other is the default.
    pub(crate) fn from_name(name: &str) -> Claim {
        if name == "truth" { Claim::Truth } else { Claim::Level }
    }
}
