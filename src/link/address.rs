//! The address of a link, as the user writes it.

use std::fmt;
use std::path::PathBuf;

use super::baud::DEFAULT_BAUD;
use super::endpoint::Endpoint;

/// The address of a link, spelled as in `pymavlink` and `rust-mavlink`.
///
/// `pty[:PATH][,BAUD]`, `/dev/ttyACM0[,BAUD]`, `serial:PATH[,BAUD]`, `tcpin:[ADDR:]PORT`, `tcpout:ADDR:PORT`,
/// `udpin:[ADDR:]PORT`, `udpout:ADDR:PORT`, `file:PATH`, and `-` for standard output. The output of
/// [`Display`](fmt::Display) parses back to the same address.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Address {
    /// A new pseudo terminal, published at `path` if given.
    Pty {
        /// Where to make a symbolic link to the terminal.
        path: Option<PathBuf>,
        /// The speed of the UART to emulate; without one, bytes arrive as fast as they are read.
        baud: Option<u32>,
    },
    /// A serial port, 8 data bits, no parity, one stop bit.
    Serial {
        /// The device.
        path: PathBuf,
        /// Its speed; [`DEFAULT_BAUD`] if not given.
        baud: Option<u32>,
    },
    /// A TCP socket that accepts one peer and rejects all others.
    TcpIn(Endpoint),
    /// A TCP connection to a listening peer.
    TcpOut(Endpoint),
    /// A UDP socket that sends to its first sender.
    UdpIn(Endpoint),
    /// A UDP socket that sends to one address.
    UdpOut(Endpoint),
    /// A file; its previous content is replaced.
    File {
        /// The file.
        path: PathBuf,
    },
    /// Standard output.
    Stdout,
}

impl Address {
    /// The speed of a serial port, or of the UART that a pty emulates; `None` for every other link.
    pub fn baud(&self) -> Option<u32> {
        match self {
            Self::Pty { baud, .. } => *baud,
            Self::Serial { baud, .. } => Some(baud.unwrap_or(DEFAULT_BAUD)),
            _ => None,
        }
    }

    /// The same address, with `default` for a serial port without a speed.
    pub fn or_baud(mut self, default: u32) -> Self {
        if let Self::Serial { baud, .. } = &mut self {
            baud.get_or_insert(default);
        }
        self
    }

    /// The same address, without a speed for a pty.
    pub fn unpaced(mut self) -> Self {
        if let Self::Pty { baud, .. } = &mut self {
            *baud = None;
        }
        self
    }

    /// The same address at another speed, if it has one.
    pub fn at_baud(mut self, speed: u32) -> Self {
        if let Self::Serial { baud, .. } | Self::Pty { baud, .. } = &mut self {
            *baud = Some(speed);
        }
        self
    }

    /// Whether bytes go out as a stream as they are written, not as datagrams or gathered blocks.
    pub fn is_stream(&self) -> bool {
        matches!(self, Self::Pty { .. } | Self::Serial { .. } | Self::TcpIn(_) | Self::TcpOut(_))
    }

    /// Whether something can come back on it.
    pub fn answers(&self) -> bool {
        !matches!(self, Self::File { .. } | Self::Stdout)
    }

    /// Whether it is standard output.
    pub fn is_stdout(&self) -> bool {
        *self == Self::Stdout
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pty { path, baud } => {
                f.write_str("pty")?;
                path.as_ref().map_or(Ok(()), |path| write!(f, ":{}", path.display()))?;
                comma(f, *baud)
            }
            Self::Serial { path, baud } => {
                let scheme = if path.is_absolute() { "" } else { "serial:" };
                write!(f, "{scheme}{}", path.display())?;
                comma(f, *baud)
            }
            Self::TcpIn(place) => write!(f, "tcpin:{place}"),
            Self::TcpOut(place) => write!(f, "tcpout:{place}"),
            Self::UdpIn(place) => write!(f, "udpin:{place}"),
            Self::UdpOut(place) => write!(f, "udpout:{place}"),
            Self::File { path } => write!(f, "file:{}", path.display()),
            Self::Stdout => f.write_str("-"),
        }
    }
}

/// The speed after an address.
fn comma(f: &mut fmt::Formatter<'_>, baud: Option<u32>) -> fmt::Result {
    baud.map_or(Ok(()), |baud| write!(f, ",{baud}"))
}

#[cfg(test)]
mod tests {
    use super::super::SCHEMES;
    use super::*;

    fn place(host: &str, port: u16) -> Endpoint {
        Endpoint::new(host, port)
    }

    fn pty(path: Option<&str>, baud: Option<u32>) -> Address {
        Address::Pty { path: path.map(PathBuf::from), baud }
    }

    fn serial(path: &str, baud: Option<u32>) -> Address {
        let path = path.into();
        Address::Serial { path, baud }
    }

    #[test]
    fn every_spelling_is_understood_and_reads_back() {
        let cases = [
            ("pty", pty(None, None)),
            ("pty:/tmp/imu", pty(Some("/tmp/imu"), None)),
            ("pty,115200", pty(None, Some(115_200))),
            ("pty:/tmp/imu,1234567", pty(Some("/tmp/imu"), Some(1_234_567))),
            ("/dev/ttyACM0", serial("/dev/ttyACM0", None)),
            ("/dev/ttyACM0,57600", serial("/dev/ttyACM0", Some(57_600))),
            ("serial:/dev/ttyUSB0", serial("/dev/ttyUSB0", None)),
            ("serial:/dev/ttyUSB0,1234567", serial("/dev/ttyUSB0", Some(1_234_567))),
            ("serial:here/port,9600", serial("here/port", Some(9600))),
            ("serial:/dev/serial/by-path/pci-0:1:1.0", serial("/dev/serial/by-path/pci-0:1:1.0", None)),
            ("tcpin:4560", Address::TcpIn(place("127.0.0.1", 4560))),
            ("tcpin:0", Address::TcpIn(place("127.0.0.1", 0))),
            ("tcpin:0.0.0.0:4560", Address::TcpIn(place("0.0.0.0", 4560))),
            ("tcpout:localhost:5760", Address::TcpOut(place("localhost", 5760))),
            ("tcpout:[::1]:5760", Address::TcpOut(place("::1", 5760))),
            ("udpin:14550", Address::UdpIn(place("127.0.0.1", 14_550))),
            ("udpin:192.168.0.5:14550", Address::UdpIn(place("192.168.0.5", 14_550))),
            ("udpout:192.168.0.255:14550", Address::UdpOut(place("192.168.0.255", 14_550))),
            ("file:/tmp/out.bin", Address::File { path: "/tmp/out.bin".into() }),
            ("file:out.bin", Address::File { path: "out.bin".into() }),
            ("-", Address::Stdout),
        ];
        for (spelled, expected) in cases {
            let address: Address = spelled.parse().unwrap_or_else(|error| panic!("{spelled}: {error}"));
            assert_eq!(address, expected, "{spelled}");
            let again: Address = address.to_string().parse().unwrap();
            assert_eq!(again, expected, "{spelled} as {address}");
        }
    }

    #[test]
    fn a_bad_spelling_is_told_what_would_be_right() {
        let cases: &[(&str, &[&str])] = &[
            ("tcp:127.0.0.1:4560", &["is ambiguous", "tcpin:127.0.0.1:4560", "tcpout:127.0.0.1:4560"]),
            ("udp:", &["is ambiguous", "udpin:", "udpout:"]),
            ("udp", &["is ambiguous", "udpin:", "udpout:"]),
            ("udp:9000", &["udpin:127.0.0.1:9000", "udpout:127.0.0.1:9000"]),
            ("udp://10.0.0.1:14550", &["udpin:10.0.0.1:14550", "udpout:10.0.0.1:14550"]),
            ("COM3", &["`COM3`", "/dev/ttyACM0", "list ports"]),
            ("COM3,57600", &["/dev/ttyACM0"]),
            ("ttyACM0", &["/dev/ttyACM0"]),
            ("dev/ttyACM0", &["did you mean /dev/ttyACM0"]),
            ("tpcin:4560", &["`tpcin`", "did you mean tcpin:"]),
            ("tcp-listen:4560", &["did you mean tcpin:"]),
            ("udpserver:4560", &["did you mean udpin:"]),
            ("stdout", &["did you mean -?"]),
            ("carrier-pigeon:1", &["`carrier-pigeon`", "one of pty", "udpout:ADDR:PORT"]),
            ("", &["empty", "one of pty"]),
            ("pty:", &["path", "pty:/tmp/imu"]),
            ("pty:,115200", &["path", "pty:/tmp/imu", "pty,115200"]),
            ("pty,fast", &["`fast`", "pty,921600"]),
            ("pty:/tmp/imu,0", &["`0`", "pty:/tmp/imu,921600"]),
            ("file:", &["path", "file:"]),
            ("file", &["path", "file:"]),
            ("serial:", &["path", "serial:/dev/ttyUSB0"]),
            ("-:x", &["standard output"]),
            ("tcpin:", &["address is missing", "tcpin:127.0.0.1:14550"]),
            ("tcpin:70000", &["`70000`", "65535"]),
            ("tcpin:localhost", &["`localhost` has no port"]),
            ("tcpout:5760", &["no address", "tcpout:127.0.0.1:5760"]),
            ("tcpout:localhost:0", &["port 0"]),
            ("tcpout:localhost:http", &["`http`", "65535"]),
            ("udpout::14550", &["address is missing"]),
            ("udpout:::1:14550", &["brackets", "[::1]"]),
            ("udpout://10.0.0.1:14550", &["udpout:10.0.0.1:14550"]),
            ("/dev/ttyACM0,fast", &["`fast`", "921600"]),
            ("/dev/ttyACM0,0", &["`0`", "921600"]),
            ("/dev/ttyACM0,", &["baud", "921600"]),
            ("/dev/ttyACM0,99999999999", &["`99999999999`"]),
            ("serial:/dev/ttyACM0:57600", &["comma", "/dev/ttyACM0,57600"]),
        ];
        for (spelled, expected) in cases {
            let error = spelled.parse::<Address>().unwrap_err();
            let text = error.to_string();
            assert!(text.contains(&format!("`{spelled}`")), "{text} does not name {spelled}");
            for part in *expected {
                assert!(text.contains(part), "{spelled}: {text:?} does not say {part:?}");
            }
        }
    }

    #[test]
    fn a_serial_port_without_a_speed_has_the_default() {
        let address = serial("/dev/ttyACM0", None);
        assert_eq!(address.baud(), Some(921_600));
        assert_eq!(address.clone().or_baud(57_600).baud(), Some(57_600));
        assert_eq!(serial("/dev/ttyACM0", Some(9600)).or_baud(57_600).baud(), Some(9600));
        assert_eq!(Address::Stdout.or_baud(57_600).baud(), None);
    }

    #[test]
    fn no_two_schemes_share_a_name_and_each_spelling_starts_with_its_own() {
        for (index, scheme) in SCHEMES.iter().enumerate() {
            assert!(SCHEMES[..index].iter().all(|other| other.name != scheme.name));
            assert!(scheme.spelling.starts_with(scheme.name) || scheme.spelling.starts_with("/dev/"));
            assert!(!scheme.about.is_empty());
        }
    }
}
