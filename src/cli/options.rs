//! Values of options that are not plain strings.

use crate::link::Address;
use crate::live::At;
use crate::quantity::{self, Sign};
use crate::report::Limit;
use crate::scene::{Destination, Output, Plan};
use crate::score::{Align, Delay};
use crate::session::Speed;
use crate::time::SimTime;
use std::ops::RangeInclusive;
use std::time::Duration;

/// Scene seconds a second that can be paced: at the slowest the longest scene, 292 years, still has due times.
const SPEEDS: RangeInclusive<f64> = 1e-6..=1e6;

/// `--for`: a time of scene, or `forever`.
pub fn span(text: &str) -> Result<SimTime, String> {
    if text == "forever" {
        return Ok(SimTime::FOREVER);
    }
    match quantity::duration_ns(text, Sign::Positive) {
        Ok(ns) => Ok(SimTime(ns)),
        Err(error) => Err(format!("{error}; or write `forever`")),
    }
}

/// `--wait`: a time, or `0`.
pub fn wait(text: &str) -> Result<Duration, String> {
    if text == "0" {
        return Ok(Duration::ZERO);
    }
    let ns = quantity::duration_ns(text, Sign::NonNegative).map_err(|error| error.to_string())?;
    Ok(Duration::from_nanos(ns.unsigned_abs()))
}

/// `--live`: where to show it.
pub fn at(text: &str) -> Result<At, String> {
    text.parse()
}

/// `--speed`: scene seconds a second, or `max`.
pub fn speed(text: &str) -> Result<Speed, String> {
    match text.parse::<f64>() {
        _ if text == "max" => Ok(Speed::Max),
        Ok(times) if SPEEDS.contains(&times) => Ok(Speed::Times(times)),
        _ => Err(format!(
            "write 1 for real time, a number from {:e} to {:e} for that many scene seconds per second, or max",
            SPEEDS.start(),
            SPEEDS.end()
        )),
    }
}

/// `--runs`: how many, also as `1e6`.
pub fn runs(text: &str) -> Result<u64, String> {
    // Beyond 2^53 a float stands for several whole numbers.
    const MOST: f64 = 9_007_199_254_740_992.0;
    let whole = text.parse().ok().or_else(|| {
        let value = text.parse::<f64>().ok()?;
        ((1.0..=MOST).contains(&value) && value.fract() == 0.0).then_some(value as u64)
    });
    whole
        .filter(|runs| *runs > 0)
        .ok_or_else(|| "write a whole number of 1 or more, such as 1000 or 1e6".into())
}

/// `--rest`, `--settle`: a time, or `0`.
pub fn from_zero(text: &str) -> Result<SimTime, String> {
    Ok(SimTime(wait(text)?.as_nanos() as i64))
}

/// `--align`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Alignment {
    /// Nothing
    None,
    /// One constant heading, which is arbitrary without a magnetometer
    Heading,
    /// One constant rotation of the world
    World,
    /// One constant rotation of the world and one of the body
    Frames,
}

impl Alignment {
    /// As spelled.
    pub const fn name(self) -> &'static str {
        ["none", "heading", "world", "frames"][self as usize]
    }
}

impl From<Alignment> for Align {
    fn from(alignment: Alignment) -> Align {
        match alignment {
            Alignment::None => Align::None,
            Alignment::Heading => Align::Heading,
            Alignment::World => Align::World,
            Alignment::Frames => Align::Frames,
        }
    }
}

/// `--delay`.
pub fn delay(text: &str) -> Result<Delay, String> {
    match text {
        "0" => Ok(Delay::Keep),
        "fit" => Ok(Delay::Fit),
        _ => match quantity::duration_ns(text, Sign::Any) {
            Ok(ns) => Ok(Delay::Given(ns)),
            Err(error) => Err(format!("{error}; or write 0 to keep it, or fit to estimate it")),
        },
    }
}

/// `--qgc`: where a ground station listens.
pub fn ground(text: &str) -> Result<Address, String> {
    format!("udpout:{text}").parse().map_err(|error: crate::link::LinkError| error.to_string())
}

/// `--cpu`: a processor that this process may use.
pub fn processor(text: &str) -> Result<usize, String> {
    let allowed = crate::os::affinity().map_err(|error| error.to_string())?;
    let found = text.parse().ok().filter(|cpu| allowed.contains(cpu));
    found.ok_or_else(|| {
        let names: Vec<_> = allowed.iter().map(usize::to_string).collect();
        format!("this process can use only processors {}", names.join(", "))
    })
}

/// `--to`: where packets go.
pub fn output(text: &str) -> Result<Output, String> {
    Ok(Output::to(text.parse::<Destination>()?))
}

/// Where nothing is sent, and an attitude heard.
pub fn mute(text: &str) -> Result<Output, String> {
    let to = text.parse::<Destination>()?;
    if to.protocol.dialogue(None).is_none() {
        return Err(format!("nobody tells an attitude in `{}`: use mavlink, msp or mpu", to.protocol.name()));
    }
    if !to.address.answers() {
        return Err(format!(
            "nothing comes back on `{}`: use pty, a serial port, tcpin, tcpout or udpin",
            to.address
        ));
    }
    Ok(Output::mute(to))
}

/// Where packets come from.
pub fn destination(text: &str) -> Result<Destination, String> {
    text.parse()
}

/// `--limit`.
pub fn limit(text: &str) -> Result<Limit, String> {
    text.parse().map_err(|error: crate::report::LimitError| error.to_string())
}

/// The limits of the command line and of the scene itself.
pub fn limits(given: &[Limit], plan: &Plan) -> Result<Vec<Limit>, super::Refusal> {
    let mut limits = given.to_vec();
    for (text, place) in &plan.limits {
        limits.push(text.parse().map_err(|error| super::Refusal(format!("{place}: {error}")))?);
    }
    Ok(limits)
}
