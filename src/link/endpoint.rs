//! A host and a port, as users write them.

use super::problem::Problem;
use std::fmt;

/// A network endpoint: a name or an address, and a port.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Endpoint {
    /// A host name or an address; IPv6 without brackets.
    pub host: String,
    /// The port; 0 lets a listening link choose any free one.
    pub port: u16,
}

impl Endpoint {
    /// An endpoint from its host and port.
    pub fn new(host: impl Into<String>, port: u16) -> Self {
        let host = host.into();
        Self { host, port }
    }
}

impl fmt::Display for Endpoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { host, port } = self;
        match host.contains(':') {
            true => write!(f, "[{host}]:{port}"),
            false => write!(f, "{host}:{port}"),
        }
    }
}

/// Whether it consists of digits only.
pub(super) fn is_number(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
}

/// Where a link listens: `ADDR:PORT`, or `PORT` alone for the loopback. Port 0 chooses a free one.
pub(super) fn listening(name: &str, rest: Option<&str>) -> Result<Endpoint, Problem> {
    let rest = rest.unwrap_or_default();
    if is_number(rest) {
        let port = port(name, rest)?;
        return Ok(Endpoint::new(LOOPBACK, port));
    }
    place(name, rest)
}

/// Where a link connects or sends to: `ADDR:PORT`.
pub(super) fn destination(name: &str, rest: Option<&str>) -> Result<Endpoint, Problem> {
    let rest = rest.unwrap_or_default();
    if is_number(rest) {
        return Err(Problem::new(
            format!("`{rest}` has no address"),
            format!("add an address: {name}:{LOOPBACK}:{rest}"),
        ));
    }
    let place = place(name, rest)?;
    if place.port == 0 {
        return Err(Problem::new(
            "port 0 is only for listening",
            format!("use a port from 1 to 65535: {name}:{}:14550", place.host),
        ));
    }
    Ok(place)
}

/// Where a link listens if only a port is given.
pub(super) const LOOPBACK: &str = "127.0.0.1";

/// `ADDR:PORT`; an IPv6 address needs brackets.
fn place(name: &str, rest: &str) -> Result<Endpoint, Problem> {
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
            format!("an IPv6 address needs brackets: {name}:[::1]:14550")
        };
        return Err(Problem::new(format!("`{host}` is not an address"), hint));
    }
    if plain.is_empty() {
        return Err(Problem::new("the address is missing", format!("say {example}")));
    }
    Ok(Endpoint::new(plain, port(name, digits)?))
}

/// A port's number.
fn port(name: &str, digits: &str) -> Result<u16, Problem> {
    digits.parse().map_err(|_| {
        Problem::new(
            format!("`{digits}` is not a port"),
            format!("a port is a number up to 65535, as in {name}:{LOOPBACK}:14550"),
        )
    })
}
