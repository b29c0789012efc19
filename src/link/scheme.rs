//! The kinds of link there are, as a table: adding a kind is one file and one line here.

use super::address::{Address, Place, Problem};
use super::{file, pty, serial, stdout, tcp, udp};

/// One way to spell a link.
#[derive(Clone, Copy, Debug)]
pub struct Scheme {
    /// What stands before the first colon.
    pub name: &'static str,
    /// How a whole address looks.
    pub spelling: &'static str,
    /// What it is, in one line.
    pub about: &'static str,
    /// Reads what stands after the first colon; `None` where there is no colon.
    pub(super) parse: fn(Option<&str>) -> Result<Address, Problem>,
}

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

/// What other tools call these links, and what they are called here.
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

/// Reads an address by the table.
pub(super) fn parse(spelled: &str) -> Result<Address, Problem> {
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

/// Why `name` is no link, and which one was probably meant.
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
        return Problem::new(
            "a serial port is given by its whole path",
            format!("did you mean /dev/{path}?"),
        );
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

/// `tcp:` and `udp:` do not say who waits for whom.
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
        format!("`{name}` has two readings"),
        format!("{name}in:{place} {inward}, {name}out:{place} {outward}"),
    )
}

/// The spelling whose name is closest to `name`, where one is close.
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

fn is_number(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
}

/// A path that must not be empty.
pub(super) fn path(rest: &str, example: &str) -> Result<std::path::PathBuf, Problem> {
    if rest.is_empty() {
        Err(Problem::new("the path is missing", format!("say where: {example}")))
    } else {
        Ok(rest.into())
    }
}

/// Where a link listens: `ADDR:PORT`, or `PORT` alone for the loopback. Port 0 picks a free one.
pub(super) fn listening(name: &str, rest: Option<&str>) -> Result<Place, Problem> {
    let rest = rest.unwrap_or_default();
    if is_number(rest) {
        let port = port(name, rest)?;
        return Ok(Place::new(LOOPBACK, port));
    }
    place(name, rest)
}

/// Where a link goes to: `ADDR:PORT`.
pub(super) fn destination(name: &str, rest: Option<&str>) -> Result<Place, Problem> {
    let rest = rest.unwrap_or_default();
    if is_number(rest) {
        return Err(Problem::new(
            format!("`{rest}` has no address"),
            format!("say whom to reach: {name}:{LOOPBACK}:{rest}"),
        ));
    }
    let place = place(name, rest)?;
    if place.port == 0 {
        return Err(Problem::new(
            "port 0 can only be listened on",
            format!("a port from 1 to 65535: {name}:{}:14550", place.host),
        ));
    }
    Ok(place)
}

const LOOPBACK: &str = "127.0.0.1";

/// `ADDR:PORT`; an IPv6 address stands in brackets.
fn place(name: &str, rest: &str) -> Result<Place, Problem> {
    let example = format!("{name}:{LOOPBACK}:14550");
    if rest.is_empty() {
        return Err(Problem::new("the address is missing", format!("say {example}")));
    }
    let Some((host, digits)) = rest.rsplit_once(':') else {
        return Err(Problem::new(format!("`{rest}` has no port"), format!("say {name}:{rest}:14550")));
    };
    let bracketed = host.strip_prefix('[').and_then(|host| host.strip_suffix(']'));
    let plain = bracketed.unwrap_or(host);
    if bracketed.is_none() && (plain.contains(':') || plain.contains('/')) {
        let hint = if plain.contains('/') {
            format!("say {name}:{}:{digits}", plain.trim_start_matches('/'))
        } else {
            format!("an IPv6 address stands in brackets: {name}:[::1]:14550")
        };
        return Err(Problem::new(format!("`{host}` is no address"), hint));
    }
    if plain.is_empty() {
        return Err(Problem::new("the address is missing", format!("say {example}")));
    }
    Ok(Place::new(plain, port(name, digits)?))
}

/// A port's number.
fn port(name: &str, digits: &str) -> Result<u16, Problem> {
    digits.parse().map_err(|_| {
        Problem::new(
            format!("`{digits}` is no port"),
            format!("a port is a number up to 65535, as in {name}:{LOOPBACK}:14550"),
        )
    })
}
