//! A serial port: 8 data bits, no parity, one stop bit, at any speed, for us alone.

use std::fs;
use std::io;
use std::os::fd::OwnedFd;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use rustix::fs::{FlockOperation, Mode, OFlags, flock};
use rustix::io::Errno;
use rustix::termios::{ControlModes, QueueSelector, ioctl_tiocexcl, ioctl_tiocnxcl, tcflush, tcgetattr};

use super::address::{Address, DEFAULT_BAUD, Problem};
use super::holders::holders;
use super::ports::ports;
use super::scheme::{self, Scheme};
use super::sender::{Carry, Sender, To};
use super::{LinkError, receiver, tty};
use crate::os;

/// Its line in the table of links.
pub(super) const SCHEME: Scheme = Scheme {
    name: "serial",
    spelling: "/dev/ttyACM0[,BAUD]",
    about: "a serial port, 8N1, 921600 baud where none is given; also serial:PATH[,BAUD]",
    parse: |rest| parse(rest.unwrap_or_default()),
};

/// `PATH[,BAUD]`.
pub(super) fn parse(rest: &str) -> Result<Address, Problem> {
    let example = "serial:/dev/ttyUSB0,921600";
    let Some((path, digits)) = rest.rsplit_once(',') else {
        if let Some((path, digits)) = rest.rsplit_once(':')
            && digits.parse::<u32>().is_ok_and(|number| number >= *SPEEDS.start())
        {
            return Err(Problem::new("the speed stands after a comma", format!("say {path},{digits}")));
        }
        let path = scheme::path(rest, example)?;
        return Ok(Address::Serial { path, baud: None });
    };
    let path = scheme::path(path, example)?;
    match digits.parse() {
        Ok(baud) if SPEEDS.contains(&baud) => Ok(Address::Serial { path, baud: Some(baud) }),
        _ => Err(Problem::new(
            format!("`{digits}` is no speed in baud"),
            format!("say {},{DEFAULT_BAUD}", path.display()),
        )),
    }
}

/// The speeds that make sense, in baud.
const SPEEDS: std::ops::RangeInclusive<u32> = 50..=20_000_000;

/// An open serial port.
pub(super) struct Serial {
    port: Arc<OwnedFd>,
    path: PathBuf,
    notices: Vec<String>,
    input: Option<tty::In>,
}

impl Serial {
    pub(super) async fn open(address: &Address, path: &Path, baud: u32) -> Result<Self, LinkError> {
        let refused = |errno| refusal(address, path, baud, errno);
        let port = take(path).map_err(refused)?;
        // Whatever fails from here on, dropping this gives the port back.
        let mut serial =
            Self { port: Arc::new(port), path: path.to_owned(), notices: Vec::new(), input: None };
        serial.configure(baud).map_err(refused)?;
        serial.hurry();
        let input = tty::In::new(Arc::clone(&serial.port)).map_err(|source| LinkError::Io {
            link: address.to_string(),
            doing: format!("wait for {}", path.display()),
            source,
        })?;
        serial.input = Some(input);
        Ok(serial)
    }

    /// Sets the speed and the shape of a byte, and forgets what came before.
    fn configure(&mut self, baud: u32) -> Result<(), Errno> {
        tty::make_raw(&self.port, |modes| {
            modes.control_modes |= ControlModes::CREAD | ControlModes::CLOCAL | ControlModes::CS8;
            modes.control_modes -= ControlModes::CSTOPB | ControlModes::PARENB | ControlModes::CRTSCTS;
            modes.set_speed(baud)
        })?;
        let actual = tcgetattr(&self.port)?.output_speed();
        if actual.abs_diff(baud) > baud / 50 {
            self.notices.push(format!("{} runs at {actual} baud instead of {baud}", self.path.display()));
        }
        let _ = tcflush(&self.port, QueueSelector::IOFlush);
        Ok(())
    }

    /// Asks the driver not to hold back what it receives, and says what it answers.
    fn hurry(&mut self) {
        let path = self.path.display();
        match os::set_low_latency(&self.port) {
            Ok(()) => {}
            // Most drivers have no such setting because they never hold anything back.
            Err(error) if error.kind() == io::ErrorKind::Unsupported => {}
            Err(error) => self.notices.push(format!(
                "low latency could not be set on {path}: {error}; answers may come up to 16 ms late"
            )),
        }
        if let Some((timer, milliseconds)) = latency_timer(&self.path)
            && milliseconds > 1
        {
            self.notices.push(format!(
                "the adapter of {path} holds back what it receives for up to {milliseconds} ms; \
                 `echo 1 | sudo tee {}` makes that 1 ms",
                timer.display()
            ));
        }
    }

    pub(super) fn name(&self) -> String {
        super::address::shown(&self.path)
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn notices(&self) -> &[String] {
        &self.notices
    }

    pub(super) fn present(&self) -> bool {
        true
    }

    pub(super) async fn peer(&mut self) -> io::Result<()> {
        Ok(())
    }

    pub(super) fn sender(&mut self) -> Sender {
        let out = tty::Out { terminal: Arc::clone(&self.port), far: None };
        Sender::new(To::Tty(out), Carry::packet())
    }

    pub(super) fn receiver(&mut self) -> Option<receiver::From> {
        self.input.take().map(receiver::From::Tty)
    }

    /// Waits, up to a second, until the port has sent what it holds, and drops the rest: the
    /// kernel itself would wait for thirty.
    pub(super) async fn close(self) {
        for _ in 0..200 {
            if os::unsent(&self.port).unwrap_or(0) == 0 {
                return;
            }
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
        let _ = tcflush(&self.port, QueueSelector::OFlush);
    }
}

impl Drop for Serial {
    fn drop(&mut self) {
        let _ = ioctl_tiocnxcl(&self.port);
    }
}

/// Opens a port and claims it, so that no other program's bytes mix with ours.
fn take(path: &Path) -> Result<OwnedFd, Errno> {
    let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::NONBLOCK | OFlags::CLOEXEC;
    let port = rustix::fs::open(path, flags, Mode::empty())?;
    tcgetattr(&port)?;
    // The lock comes first: a port that another holds must not lose that one's own claim.
    // Other refusals are no reason to stop: not every file system has locks.
    if flock(&port, FlockOperation::NonBlockingLockExclusive) == Err(Errno::WOULDBLOCK) {
        return Err(Errno::BUSY);
    }
    ioctl_tiocexcl(&port)?;
    Ok(port)
}

/// What the system's answer means to the user.
fn refusal(address: &Address, path: &Path, baud: u32, errno: Errno) -> LinkError {
    let link = address.to_string();
    let path = path.to_owned();
    match errno {
        Errno::NOENT | Errno::NXIO | Errno::NODEV | Errno::IO => {
            LinkError::NoSuchPort { link, path, ports: ports().iter().map(ToString::to_string).collect() }
        }
        Errno::ACCESS | Errno::PERM => LinkError::Denied { link, remedy: remedy(&path), path },
        Errno::BUSY => LinkError::Busy { link, holders: holders(&path), path },
        Errno::NOTTY | Errno::ISDIR | Errno::NOTDIR => LinkError::NotSerial { link, path },
        Errno::INVAL => LinkError::Baud { link, baud },
        errno => LinkError::Io { link, doing: format!("open {}", path.display()), source: errno.into() },
    }
}

/// What would let this user open a device.
fn remedy(path: &Path) -> String {
    let group = fs::metadata(path)
        .ok()
        .and_then(|device| group_name(&fs::read_to_string("/etc/group").ok()?, device.gid()));
    let rule = "a udev rule with MODE=\"0666\" also does";
    match group.as_deref() {
        None | Some("root") => format!(
            "it belongs to no group that you could join; {}",
            rule.replace("also does", "would open it")
        ),
        Some(group) => format!(
            "it belongs to the group {group}: `sudo usermod -aG {group} $USER`, then log in again; {rule}"
        ),
    }
}

/// The name of a group in the text of `/etc/group`.
fn group_name(groups: &str, id: u32) -> Option<String> {
    groups.lines().find_map(|line| {
        let mut fields = line.split(':');
        let name = fields.next()?;
        (fields.nth(1)?.parse() == Ok(id)).then(|| name.to_owned())
    })
}

/// The file and the value, in ms, of an FTDI adapter's latency timer.
fn latency_timer(path: &Path) -> Option<(PathBuf, u32)> {
    let device = fs::canonicalize(path).ok()?;
    let timer = Path::new("/sys/class/tty").join(device.file_name()?).join("device/latency_timer");
    let milliseconds = fs::read_to_string(&timer).ok()?.trim().parse().ok()?;
    Some((timer, milliseconds))
}

#[cfg(test)]
mod tests {
    use super::super::holders::Holder;
    use super::*;

    fn address(path: &str) -> Address {
        format!("serial:{path}").parse().unwrap()
    }

    async fn refused(path: &str) -> String {
        let error = Serial::open(&address(path), Path::new(path), 57_600).await;
        error.err().expect("it opened").to_string()
    }

    #[tokio::test]
    async fn a_missing_port_is_named_with_those_present() {
        let text = refused("/dev/ttyNONE7").await;
        assert!(text.contains("`/dev/ttyNONE7`"), "{text}");
        assert!(text.contains("there is no port /dev/ttyNONE7"), "{text}");
        assert!(text.contains("present"), "{text}");
        let listed = LinkError::NoSuchPort {
            link: "x".into(),
            path: "x".into(),
            ports: vec!["/dev/ttyACM0 (PX4)".into()],
        };
        assert!(listed.to_string().ends_with("present: /dev/ttyACM0 (PX4)"));
    }

    #[tokio::test]
    async fn a_path_that_is_no_port_says_how_to_write_a_file() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let path = file.path().to_str().unwrap();
        let text = refused(path).await;
        assert!(text.contains("not a serial port"), "{text}");
        assert!(text.contains(&format!("file:{path}")), "{text}");
        assert!(refused("/dev").await.contains("not a serial port"));
    }

    #[test]
    fn a_refusal_says_what_would_be_right() {
        let address = address("/dev/null");
        let refusal = |errno| refusal(&address, Path::new("/dev/null"), 57_600, errno).to_string();
        assert!(refusal(Errno::ACCESS).contains("permission denied: /dev/null"));
        assert!(refusal(Errno::ACCESS).contains("udev rule"));
        assert!(refusal(Errno::INVAL).contains("57600 baud"));
        let busy = LinkError::Busy {
            link: "/dev/ttyACM0".into(),
            path: "/dev/ttyACM0".into(),
            holders: vec![Holder { pid: 42, name: "QGroundControl".into() }],
        };
        let text = busy.to_string();
        assert!(text.contains("held by QGroundControl (process 42)"), "{text}");
        assert!(text.contains("AutoConnect"), "{text}");
    }

    #[test]
    fn the_group_that_owns_a_device_is_found_by_its_number() {
        let groups = "root:x:0:\ndialout:x:20:me\nnobody:x:65534:\n";
        assert_eq!(group_name(groups, 20).as_deref(), Some("dialout"));
        assert_eq!(group_name(groups, 21), None);
    }
}
