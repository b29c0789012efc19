//! The table of link kinds: adding a kind is one file and one line here.

use super::address::Address;
use super::endpoint::{LOOPBACK, is_number};
use super::problem::Problem;
use super::spelling::Scheme;
use super::{LinkError, file, pty, serial, stdout, tcp, udp};
use std::str::FromStr;

/// Every kind of link.
pub const SCHEMES: &[Scheme] = &[
    pty::SCHEME,
    serial::SCHEME,
    tcp::SCHEME_IN,
    tcp::SCHEME_OUT,
    udp::SCHEME_IN,
    udp::SCHEME_OUT,
    file::SCHEME,
    stdout::SCHEME,
];

/// Names for these links in other tools, and their names here.
const ELSEWHERE: &[(&str, &str)] = &[
    ("stdout", "-"),
    ("tcplisten", "tcpin"),
    ("tcpserver", "tcpin"),
    ("tcpclient", "tcpout"),
    ("udplisten", "udpin"),
    ("udpserver", "udpin"),
    ("udpclient", "udpout"),
    ("udpcast", "udpout"),
    ("udpbcast", "udpout"),
    ("tty", "serial"),
    ("uart", "serial"),
    ("usb", "serial"),
    ("pts", "pty"),
];

impl FromStr for Address {
    type Err = LinkError;

    fn from_str(spelled: &str) -> Result<Self, LinkError> {
        parse(spelled.trim()).map_err(|problem| LinkError::Spelling {
            spelled: spelled.to_owned(),
            problem: problem.what,
            right: problem.right,
        })
    }
}

/// Parses an address by the table.
fn parse(spelled: &str) -> Result<Address, Problem> {
    if spelled.starts_with('/') {
        return serial::parse(spelled);
    }
    if let Some(speed) = spelled.strip_prefix("pty,") {
        return pty::parse_speed(speed);
    }
    let (name, rest) = match spelled.split_once(':') {
        Some((name, rest)) => (name, Some(rest)),
        None => (spelled, None),
    };
    match SCHEMES.iter().find(|scheme| scheme.name == name) {
        Some(scheme) => (scheme.parse)(rest),
        None => Err(unknown(name, rest)),
    }
}

/// Why `name` is no link, and which link was probably meant.
fn unknown(name: &str, rest: Option<&str>) -> Problem {
    let rest = rest.map(|rest| rest.trim_start_matches('/'));
    let lower = name.to_ascii_lowercase();
    if lower == "tcp" || lower == "udp" {
        return two_readings(&lower, rest);
    }
    if lower.strip_prefix("com").is_some_and(is_number) {
        return Problem::new(
            format!("`{name}` is a Windows name"),
            "a serial port here is /dev/ttyACM0 or /dev/ttyUSB0; `ratetable list ports` names those present",
        );
    }
    if lower.starts_with("tty") && lower != "tty" || lower.starts_with("dev/") {
        let path = name.strip_prefix("dev/").unwrap_or(name);
        return Problem::new("a serial port needs its full path", format!("did you mean /dev/{path}?"));
    }
    let what = match name {
        "" => "it is empty".to_owned(),
        name => format!("there is no link called `{name}`"),
    };
    match nearest(&lower) {
        Some(meant) => Problem::new(what, format!("did you mean {meant}?")),
        None => Problem::new(what, format!("a link is one of {}", spellings())),
    }
}

/// `tcp:` and `udp:` do not say which side waits.
fn two_readings(name: &str, rest: Option<&str>) -> Problem {
    let place = match rest.unwrap_or_default() {
        "" => format!("{LOOPBACK}:14550"),
        port if is_number(port) => format!("{LOOPBACK}:{port}"),
        place => place.to_owned(),
    };
    let (inward, outward) = match name {
        "tcp" => ("waits there for a connection", "connects to it"),
        _ => ("waits there for a first datagram", "sends to it"),
    };
    Problem::new(
        format!("`{name}` is ambiguous"),
        format!("{name}in:{place} {inward}, {name}out:{place} {outward}"),
    )
}

/// The spelling whose name is closest to `name`, if one is close.
fn nearest(name: &str) -> Option<&'static str> {
    let plain: String = name.chars().filter(char::is_ascii_alphabetic).collect();
    let elsewhere = ELSEWHERE.iter().find(|(other, _)| *other == plain);
    let meant = match elsewhere {
        Some((_, ours)) => SCHEMES.iter().find(|scheme| scheme.name == *ours),
        None => SCHEMES
            .iter()
            .map(|scheme| (strsim::damerau_levenshtein(&plain, scheme.name), scheme))
            .filter(|(distance, scheme)| *distance <= 2 && *distance < scheme.name.len())
            .min_by_key(|(distance, _)| *distance)
            .map(|(_, scheme)| scheme),
    };
    meant.map(|scheme| scheme.spelling)
}

/// All spellings in one line.
fn spellings() -> String {
    let all: Vec<_> = SCHEMES.iter().map(|scheme| scheme.spelling).collect();
    all.join(", ")
}
