//! Errors of opening and using a link.

use std::io;
use std::path::PathBuf;

use super::holders::Holder;

/// Why a link did not open, or nobody connected.
///
/// One enum for the room, because a caller only shows these errors: each names the link as spelled, the bad value,
/// and what would be right.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LinkError {
    /// The address has a spelling error.
    #[error("link `{spelled}`: {problem}; {right}")]
    Spelling {
        /// The address as written.
        spelled: String,
        /// What is wrong with it.
        problem: String,
        /// What would be right.
        right: String,
    },
    /// There is no serial port with this name.
    #[error("link `{link}`: there is no port {}; {}", path.display(), present(ports))]
    NoSuchPort {
        /// The link as spelled.
        link: String,
        /// The device that is missing.
        path: PathBuf,
        /// The existing ports.
        ports: Vec<String>,
    },
    /// The user has no permission for the device.
    #[error("link `{link}`: permission denied: {}; {remedy}", path.display())]
    Denied {
        /// The link as spelled.
        link: String,
        /// The device or file.
        path: PathBuf,
        /// How to get permission.
        remedy: String,
    },
    /// Another process uses the port.
    #[error("link `{link}`: {} is busy: {}", path.display(), held_by(holders))]
    Busy {
        /// The link as spelled.
        link: String,
        /// The device.
        path: PathBuf,
        /// The processes that hold it, as far as this user can see them.
        holders: Vec<Holder>,
    },
    /// The path is not a serial port.
    #[error("link `{link}`: {} is not a serial port; to write a file use file:{0}", path.display())]
    NotSerial {
        /// The link as spelled.
        link: String,
        /// The path.
        path: PathBuf,
    },
    /// The port does not support this speed.
    #[error("link `{link}`: the port does not run at {baud} baud; usual speeds are 57600, 115200, 921600")]
    Baud {
        /// The link as spelled.
        link: String,
        /// The requested speed.
        baud: u32,
    },
    /// A pty cannot publish itself at this path.
    #[error("link `{link}`: {} already exists{what}; choose another path, or remove it", path.display())]
    PathTaken {
        /// The link as spelled.
        link: String,
        /// The path.
        path: PathBuf,
        /// What is there already, if that helps.
        what: String,
    },
    /// The host name has no address.
    #[error("link `{link}`: `{host}` has no address; give a numeric one, as in 127.0.0.1")]
    UnknownHost {
        /// The link as spelled.
        link: String,
        /// The name.
        host: String,
        /// The resolver's error.
        source: io::Error,
    },
    /// The address does not allow listening.
    #[error("link `{link}`: cannot listen on {place}: {why}")]
    Listen {
        /// The link as spelled.
        link: String,
        /// The address and port.
        place: String,
        /// The obstacle, and what would work.
        why: &'static str,
        /// The system's error.
        source: io::Error,
    },
    /// Nobody answers at the address.
    #[error("link `{link}`: {place} does not answer: {why}")]
    Refused {
        /// The link as spelled.
        link: String,
        /// The address and port.
        place: String,
        /// The obstacle, and what would work.
        why: &'static str,
        /// The system's error.
        source: io::Error,
    },
    /// Any other error of the system.
    #[error("link `{link}`: cannot {doing}")]
    Io {
        /// The link as spelled.
        link: String,
        /// The operation that failed.
        doing: String,
        /// The system's error.
        source: io::Error,
    },
}

/// The existing ports, as the end of a sentence.
fn present(ports: &[String]) -> String {
    match ports {
        [] => "no serial port found (`ratetable list ports` looks again)".to_owned(),
        ports => format!("present: {}", ports.join(", ")),
    }
}

/// Who holds a port, and how to release it.
fn held_by(holders: &[Holder]) -> String {
    if holders.is_empty() {
        return "another process holds it (as root, find it with `sudo fuser -v` on it)".to_owned();
    }
    let named: Vec<_> = holders.iter().map(Holder::to_string).collect();
    let advice = holders.iter().filter_map(Holder::advice);
    let mut text = format!("held by {}", named.join(", "));
    for advice in advice {
        text.push_str("; ");
        text.push_str(advice);
    }
    text
}
