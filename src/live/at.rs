//! Where the page is served.

use std::fmt;
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::str::FromStr;

/// The port unless another is named.
const PORT: u16 = 8420;

/// An address to serve on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct At(pub(super) SocketAddr);

impl Default for At {
    /// Loopback, port 8420.
    fn default() -> At {
        At(SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), PORT))
    }
}

impl At {
    /// Whether only this machine reaches it.
    pub fn is_loopback(&self) -> bool {
        self.0.ip().is_loopback()
    }
}

impl fmt::Display for At {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl FromStr for At {
    type Err = String;

    /// `ADDR:PORT`, or a port of loopback; port 0 is any that is free.
    fn from_str(text: &str) -> Result<At, String> {
        let local = |port: &str| Some(SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), port.parse().ok()?));
        let port = text.strip_prefix("localhost:").or(text.strip_prefix(':')).unwrap_or(text);
        let address = local(port).or_else(|| text.parse().ok());
        address.map(At).ok_or_else(|| {
            format!("`{text}` is no address: write ADDR:PORT, such as 0.0.0.0:8420, or a port of this machine, such as 8421")
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_or_a_port() {
        let at = |text: &str| text.parse::<At>().map(|at| at.to_string());
        assert_eq!(At::default().to_string(), "127.0.0.1:8420");
        assert_eq!(at("8421").as_deref(), Ok("127.0.0.1:8421"));
        assert_eq!(at("localhost:0").as_deref(), Ok("127.0.0.1:0"));
        assert_eq!(at("0.0.0.0:80").as_deref(), Ok("0.0.0.0:80"));
        assert_eq!(at("[::1]:8420").as_deref(), Ok("[::1]:8420"));
        assert!(
            "[::1]:1".parse::<At>().unwrap().is_loopback()
                && !"10.0.0.1:1".parse::<At>().unwrap().is_loopback()
        );
        for wrong in ["", "hill", "127.0.0.1", "127.0.0.1:70000", "70000", "::1:8420:x"] {
            let message = at(wrong).unwrap_err();
            assert!(message.contains(&format!("`{wrong}`")) && message.contains("ADDR:PORT"), "{message}");
        }
    }
}
