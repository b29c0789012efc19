//! Which firmware, and what it is told before it starts.

use std::fmt;
use std::str::FromStr;

use ratetable_protocols::{betaflight, ilabs, mavlink, mip, msp, sbg, vectornav};

use super::{
    Ardupilot, Betaflight, Build, Firmware, Framing, Ilabs, Inav, Mip, Parameters, Px4, Px4Sitl,
    Px4Vectornav, Sbg,
};
use crate::ahrs::Kind;

/// A firmware on a kind of link.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Make {
    /// PX4 on its board, in HITL.
    Px4,
    /// PX4 as a program, in lockstep.
    Px4Sitl,
    /// PX4 with a VN-100.
    Px4Vectornav,
    /// ArduPilot with a VN-100.
    Ardupilot,
    /// ArduPilot with a MicroStrain unit.
    ArdupilotMip,
    /// ArduPilot with an Inertial Labs unit.
    ArdupilotIlabs,
    /// ArduPilot with an SBG Systems unit.
    ArdupilotSbg,
    /// PX4 with an Inertial Labs unit.
    Px4Ilabs,
    /// INAV.
    Inav,
    /// Betaflight as a program.
    Betaflight,
}

/// A firmware's parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Its estimator; INAV has one of its own.
    pub ahrs: Kind,
    /// Declination of the field at its place, rad, positive east; INAV takes it as 0.
    pub declination_rad: f64,
    /// PX4: whole-number parameters that differ from [`Px4::parameters`].
    pub parameters: Parameters,
    /// PX4 as a program: samples that it does not answer while it boots.
    pub unanswered: u64,
    /// ArduPilot and PX4 with a VN-100: packets of samples a second that they ask it for.
    pub rate_hz: u32,
    /// Betaflight: how it is built, and what went wrong in its boot.
    pub build: Build,
}

impl Default for Settings {
    /// VQF, magnetic north, 100 unanswered samples, 100 Hz.
    fn default() -> Self {
        Self {
            ahrs: Kind::default(),
            declination_rad: 0.0,
            parameters: Parameters::new(),
            unanswered: 100,
            rate_hz: 100,
            build: Build::default(),
        }
    }
}

impl Make {
    /// Every make.
    pub const ALL: [Self; 10] = [
        Self::Px4,
        Self::Px4Sitl,
        Self::Px4Vectornav,
        Self::Ardupilot,
        Self::ArdupilotMip,
        Self::ArdupilotIlabs,
        Self::ArdupilotSbg,
        Self::Px4Ilabs,
        Self::Inav,
        Self::Betaflight,
    ];

    /// As it is called.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Px4 => "px4",
            Self::Px4Sitl => "px4-sitl",
            Self::Px4Vectornav => "px4-vectornav",
            Self::Ardupilot => "ardupilot",
            Self::ArdupilotMip => "ardupilot-mip",
            Self::ArdupilotIlabs => "ardupilot-ilabs",
            Self::ArdupilotSbg => "ardupilot-sbg",
            Self::Px4Ilabs => "px4-ilabs",
            Self::Inav => "inav",
            Self::Betaflight => "betaflight",
        }
    }

    /// One that has just booted.
    pub fn firmware(self, settings: &Settings) -> Box<dyn Firmware + Send> {
        match self {
            Self::Px4 => Box::new(Px4::new(settings)),
            Self::Px4Sitl => Box::new(Px4Sitl::new(settings)),
            Self::Px4Vectornav => Box::new(Px4Vectornav::new(settings)),
            Self::Ardupilot => Box::new(Ardupilot::new(settings)),
            Self::ArdupilotMip => Box::new(Mip::new(settings)),
            Self::ArdupilotIlabs => Box::new(Ilabs::ardupilot(settings)),
            Self::ArdupilotSbg => Box::new(Sbg::new(settings)),
            Self::Px4Ilabs => Box::new(Ilabs::px4(settings)),
            Self::Inav => Box::new(Inav::new(settings)),
            Self::Betaflight => Box::new(Betaflight::new(settings)),
        }
    }

    /// What its packets of samples look like.
    pub fn framing(self) -> Framing {
        match self {
            Self::Px4 | Self::Px4Sitl => Framing::Mavlink(Box::new(mavlink::Decoder::new())),
            Self::Px4Vectornav | Self::Ardupilot => Framing::Vectornav(Box::new(vectornav::Decoder::new())),
            Self::ArdupilotMip => Framing::Mip(Box::new(mip::Decoder::new())),
            Self::ArdupilotIlabs | Self::Px4Ilabs => Framing::Ilabs(Box::new(ilabs::Decoder::new())),
            Self::ArdupilotSbg => Framing::Sbg(Box::new(sbg::Decoder::new())),
            Self::Inav => Framing::Msp(Box::new(msp::Decoder::new())),
            Self::Betaflight => Framing::Betaflight(Box::new(betaflight::Decoder::new())),
        }
    }
}

impl FromStr for Make {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|make| make.name() == name);
        found.ok_or_else(|| format!("no stand-in `{name}`: {}", Self::ALL.map(Self::name).join(", ")))
    }
}

impl fmt::Display for Make {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
