//! Shared by TCP and UDP: names, and the meaning of a refusal.

use std::io;
use std::net::SocketAddr;

use super::LinkError;
use super::address::Address;
use super::endpoint::Endpoint;

/// The addresses of an endpoint, IPv4 first.
pub(super) async fn resolve(address: &Address, place: &Endpoint) -> Result<Vec<SocketAddr>, LinkError> {
    let unknown =
        |source| LinkError::UnknownHost { link: address.to_string(), host: place.host.clone(), source };
    let found = tokio::net::lookup_host((place.host.as_str(), place.port)).await;
    let mut found: Vec<_> = found.map_err(unknown)?.collect();
    found.sort_by_key(SocketAddr::is_ipv6);
    match found.is_empty() {
        true => Err(unknown(io::ErrorKind::NotFound.into())),
        false => Ok(found),
    }
}

/// The first address of an endpoint.
pub(super) async fn resolve_one(address: &Address, place: &Endpoint) -> Result<SocketAddr, LinkError> {
    Ok(resolve(address, place).await?[0])
}

/// Why a link cannot listen at an endpoint.
pub(super) fn cannot_listen(address: &Address, place: &Endpoint, source: io::Error) -> LinkError {
    let why = match source.kind() {
        io::ErrorKind::AddrInUse => "another program uses that port; port 0 picks a free one",
        io::ErrorKind::AddrNotAvailable => {
            "this machine has no such address; 127.0.0.1 is this machine alone, 0.0.0.0 is every network"
        }
        io::ErrorKind::PermissionDenied => "ports below 1024 need root; choose a higher one",
        _ => "the system refused",
    };
    LinkError::Listen { link: address.to_string(), place: place.to_string(), why, source }
}

/// Why a link cannot reach an endpoint.
pub(super) fn cannot_reach(address: &Address, place: &Endpoint, source: io::Error) -> LinkError {
    let why = match source.kind() {
        io::ErrorKind::ConnectionRefused => {
            "nothing listens there; start the other side first, or wait for it with tcpin"
        }
        io::ErrorKind::TimedOut => "no answer; check the address and any firewall",
        io::ErrorKind::HostUnreachable | io::ErrorKind::NetworkUnreachable => "no route to that address",
        _ => "the system refused",
    };
    LinkError::Refused { link: address.to_string(), place: place.to_string(), why, source }
}
