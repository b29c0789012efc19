//! A serial port: 8 data bits, no parity, one stop bit, any speed, claimed for us alone.

use std::fs;
use std::io;
use std::os::fd::{AsFd, OwnedFd};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use bytes::BytesMut;
use rustix::fs::{FlockOperation, Mode, OFlags, flock};
use rustix::io::Errno;
use rustix::termios::{OptionalActions, QueueSelector, tcflush, tcgetattr, tcsetattr};
use tokio::sync::Mutex;
use tokio_serial::{ClearBuffer, ErrorKind, SerialPort, SerialPortBuilderExt, SerialStream};

use super::address::Address;
use super::baud;
use super::holders::holders;
use super::plug::{Plug, Plugged};
use super::ports::ports;
use super::problem::Problem;
use super::sender::{Carry, Sender};
use super::spelling::Scheme;
use super::stream::read;
use super::{Kind, Link, LinkError};
use crate::os;

/// Its line in the table of links.
pub(super) const SCHEME: Scheme = Scheme {
    name: "serial",
    spelling: "/dev/ttyACM0[,BAUD]",
    about: "a serial port, 8N1, 921600 baud by default; also serial:PATH[,BAUD]",
    parse: |rest| parse(rest.unwrap_or_default()),
};

/// `PATH[,BAUD]`.
pub(super) fn parse(rest: &str) -> Result<Address, Problem> {
    let (path, baud) = baud::path_and_speed("", rest, "serial:/dev/ttyUSB0,921600")?;
    Ok(Address::Serial { path, baud })
}

/// Time between two attempts to open a port that was unplugged.
const AGAIN: Duration = Duration::from_millis(100);
/// How soon the receiving side notices that the sending side found the port gone.
const LOOK: Duration = Duration::from_millis(200);
/// How often, and with what between, a port that is to change its speed is asked whether it has sent all.
const LOOKS: u32 = 200;
const BETWEEN_LOOKS: Duration = Duration::from_millis(1);

/// An open serial port.
pub(super) struct Serial {
    plug: Arc<Plug>,
    /// Dropping it releases the port, so it lives as long as the link, whatever its receiver does.
    _claim: Arc<Mutex<Option<SerialStream>>>,
}

/// Opens a port. While somebody receives, the link finds an unplugged port again by its path.
pub(super) fn open(address: &Address, path: &Path, baud: u32) -> Result<Link, LinkError> {
    let (port, stream) = claim(address, path, baud)?;
    let notices = notices(path, baud, &port, &stream);
    let plug = Arc::new(Plug::new(port, baud));
    let sender = Sender::new(Plugged(Arc::clone(&plug)), Carry::packet());
    let stream = Arc::new(Mutex::new(Some(stream)));
    let input = In {
        plug: Arc::clone(&plug),
        stream: Arc::clone(&stream),
        address: address.clone(),
        path: path.into(),
    };
    let serial = Serial { plug, _claim: stream };
    let receiver = input.into();
    Ok(Link { notices, ..Link::new(path.display(), Kind::Serial(serial), sender, Some(receiver)) })
}

/// Opens a port twice: once for queries and writes without an executor, and once as [`SerialStream`], which claims
/// and configures it and receives.
///
/// Neither closes before the other is open: the modem lines rise only once, because that may reset a board.
fn claim(address: &Address, path: &Path, baud: u32) -> Result<(OwnedFd, SerialStream), LinkError> {
    let refused = |errno| refusal(address, path, baud, errno);
    let port = ask(path).map_err(refused)?;
    let builder = tokio_serial::new(path.to_string_lossy(), baud);
    let stream = builder.open_native_async().map_err(|error| match error.kind() {
        // Its only error for a port that another program has claimed since our query.
        ErrorKind::NoDevice => refused(Errno::BUSY),
        _ => match set_speed(&port, baud, OptionalActions::Now) {
            Err(errno) => refused(errno),
            Ok(()) => LinkError::Io {
                link: address.to_string(),
                doing: format!("set up {}", path.display()),
                source: error.into(),
            },
        },
    })?;
    // Discards earlier input; a port that cannot has none.
    let _ = stream.clear(ClearBuffer::All);
    Ok((port, stream))
}

/// Opens a port and finds what [`SerialStream`] would not report: why it does not open, whether it is a terminal,
/// whether another program has it.
///
/// This must come first: if root, who passes `TIOCEXCL`, fails to open a [`SerialStream`], that removes the claim
/// of the program that holds the port.
fn ask(path: &Path) -> Result<OwnedFd, Errno> {
    let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::NONBLOCK | OFlags::CLOEXEC;
    let port = rustix::fs::open(path, flags, Mode::empty())?;
    tcgetattr(&port)?;
    match flock(&port, FlockOperation::NonBlockingLockExclusive) {
        Err(Errno::WOULDBLOCK) => Err(Errno::BUSY),
        _ => {
            let _ = flock(&port, FlockOperation::Unlock);
            Ok(port)
        }
    }
}

/// What would be in the way of a speed.
fn set_speed(port: impl AsFd, baud: u32, when: OptionalActions) -> Result<(), Errno> {
    let mut modes = tcgetattr(&port)?;
    modes.set_speed(baud)?;
    tcsetattr(&port, when, &modes)
}

/// The speed of an open port, which may change while others send and receive.
pub struct Baud(Arc<Plug>);

impl Baud {
    /// The speed now, baud.
    pub fn now(&self) -> u32 {
        self.0.baud()
    }

    /// Sets another speed once what was written before has gone out, for which it waits a fifth of a second at most. A
    /// port that is unplugged has it when it is back.
    ///
    /// # Errors
    /// Those of the system: most often that the port cannot run at this speed.
    pub fn set(&self, baud: u32) -> io::Result<()> {
        if !self.0.is_out() {
            let empty = (0..LOOKS).any(|look| {
                std::thread::sleep(if look == 0 { Duration::ZERO } else { BETWEEN_LOOKS });
                os::unsent(&*self.0).map_or(true, |bytes| bytes == 0)
            });
            // On a line that is never empty the system would wait for ever.
            let when = if empty { OptionalActions::Drain } else { OptionalActions::Now };
            set_speed(&*self.0, baud, when)?;
        }
        self.0.note_baud(baud);
        Ok(())
    }
}

/// What the user should know about the port's setup.
fn notices(path: &Path, baud: u32, port: &OwnedFd, stream: &SerialStream) -> Vec<String> {
    let mut notices = Vec::new();
    let device = path.display();
    if let Ok(actual) = stream.baud_rate()
        && actual.abs_diff(baud) > baud / 50
    {
        notices.push(format!("{device} runs at {actual} baud instead of {baud}"));
    }
    match os::set_low_latency(port) {
        Ok(()) => {}
        // Most drivers lack this setting because they never hold anything back.
        Err(error) if error.kind() == io::ErrorKind::Unsupported => {}
        Err(error) => notices
            .push(format!("cannot set low latency on {device}: {error}; replies may be up to 16 ms late")),
    }
    if let Some((timer, milliseconds)) = latency_timer(Path::new(TERMINALS), path)
        && milliseconds > 1
    {
        notices.push(format!(
            "the adapter of {device} holds back what it receives for up to {milliseconds} ms; \
             `echo 1 | sudo tee {}` makes that 1 ms",
            timer.display()
        ));
    }
    notices
}

impl Serial {
    /// Its speed.
    pub(super) fn baud(&self) -> Baud {
        Baud(Arc::clone(&self.plug))
    }

    /// Whether the port is there.
    pub(super) fn present(&self) -> bool {
        !self.plug.is_out()
    }

    /// Bytes that the driver has not sent.
    pub(super) fn queued(&self) -> Option<usize> {
        os::unsent(&*self.plug).ok()
    }

    /// Waits up to a second until the port has sent what it holds, then drops the rest: the kernel itself would
    /// wait for thirty seconds.
    pub(super) async fn close(self) {
        for _ in 0..200 {
            if self.queued().unwrap_or(0) == 0 {
                return;
            }
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
        let _ = tcflush(&*self.plug, QueueSelector::OFlush);
    }
}

/// The receiving side. It also finds an unplugged port again. Nobody else locks the stream.
pub(super) struct In {
    plug: Arc<Plug>,
    stream: Arc<Mutex<Option<SerialStream>>>,
    address: Address,
    path: PathBuf,
}

impl In {
    pub(super) async fn recv(&mut self, buffer: &mut BytesMut) -> io::Result<usize> {
        let mut stream = self.stream.lock().await;
        loop {
            let Some(port) = stream.as_mut().filter(|_| !self.plug.is_out()) else {
                self.plug.pull();
                // Release the old descriptor before the port comes back.
                *stream = None;
                *stream = Some(found_again(&self.plug, &self.address, &self.path).await);
                continue;
            };
            match tokio::time::timeout(LOOK, read(port, buffer)).await {
                Ok(Ok(0) | Err(_)) if self.plug.has_gone() => self.plug.pull(),
                Ok(answer) => return answer,
                // Time to check the plug.
                Err(_) => {}
            }
        }
    }
}

/// Waits until the port is back, and puts it in the place of the old one.
async fn found_again(plug: &Plug, address: &Address, path: &Path) -> SerialStream {
    loop {
        tokio::time::sleep(AGAIN).await;
        // Not there yet, or not yet ours: its rights are set a moment after it appears.
        if let Ok((port, stream)) = claim(address, path, plug.baud()) {
            let _ = os::set_low_latency(&port);
            if plug.put_in(&port).is_ok() {
                return stream;
            }
        }
    }
}

/// The meaning of a system error for the user.
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

/// How this user gets permission for a device.
fn remedy(path: &Path) -> String {
    let group = fs::metadata(path)
        .ok()
        .and_then(|device| group_name(&fs::read_to_string("/etc/group").ok()?, device.gid()));
    let rule = "a udev rule with MODE=\"0666\" also does";
    match group.as_deref() {
        None | Some("root") => {
            format!("no group that you can join owns it; {}", rule.replace("also does", "would open it"))
        }
        Some(group) => format!(
            "it belongs to the group {group}: `sudo usermod -aG {group} $USER`, then log in again; {rule}"
        ),
    }
}

/// The name of a group, from the text of `/etc/group`.
fn group_name(groups: &str, id: u32) -> Option<String> {
    groups.lines().find_map(|line| {
        let mut fields = line.split(':');
        let name = fields.next()?;
        (fields.nth(1)?.parse() == Ok(id)).then(|| name.to_owned())
    })
}

/// Where the system lists its terminals.
const TERMINALS: &str = "/sys/class/tty";

/// The file and the value, in ms, of an FTDI adapter's latency timer. The driver lists it with the port, some
/// versions with the USB interface above it.
fn latency_timer(terminals: &Path, path: &Path) -> Option<(PathBuf, u32)> {
    let device = terminals.join(fs::canonicalize(path).ok()?.file_name()?).join("device");
    ["latency_timer", "../latency_timer"].iter().find_map(|place| {
        let timer = device.join(place);
        let milliseconds = fs::read_to_string(&timer).ok()?.trim().parse().ok()?;
        Some((timer, milliseconds))
    })
}

#[cfg(test)]
mod tests {
    use super::super::holders::Holder;
    use super::*;

    fn address(path: &str) -> Address {
        format!("serial:{path}").parse().unwrap()
    }

    fn refused(path: &str) -> String {
        open(&address(path), Path::new(path), 57_600).err().expect("it opened").to_string()
    }

    #[test]
    fn a_missing_port_is_named_with_those_present() {
        let text = refused("/dev/ttyNONE7");
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

    #[test]
    fn a_path_that_is_no_port_says_how_to_write_a_file() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let path = file.path().to_str().unwrap();
        let text = refused(path);
        assert!(text.contains("not a serial port"), "{text}");
        assert!(text.contains(&format!("file:{path}")), "{text}");
        assert!(refused("/dev").contains("not a serial port"));
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
    fn an_adapter_that_holds_back_is_found_wherever_its_driver_says_so() {
        let folder = tempfile::tempdir().unwrap();
        let port = folder.path().join("ttyUSB7");
        fs::write(&port, "").unwrap();
        let terminals = folder.path().join("class");
        assert_eq!(latency_timer(&terminals, &port), None);
        let interface = folder.path().join("interface");
        fs::create_dir_all(interface.join("ttyUSB7")).unwrap();
        fs::create_dir_all(terminals.join("ttyUSB7")).unwrap();
        let device = terminals.join("ttyUSB7/device");
        std::os::unix::fs::symlink(interface.join("ttyUSB7"), &device).unwrap();
        fs::write(interface.join("latency_timer"), "16\n").unwrap();
        assert_eq!(latency_timer(&terminals, &port), Some((device.join("../latency_timer"), 16)));
        fs::write(interface.join("ttyUSB7/latency_timer"), "1\n").unwrap();
        assert_eq!(latency_timer(&terminals, &port), Some((device.join("latency_timer"), 1)));
    }

    #[test]
    fn the_group_that_owns_a_device_is_found_by_its_number() {
        let groups = "root:x:0:\ndialout:x:20:me\nnobody:x:65534:\n";
        assert_eq!(group_name(groups, 20).as_deref(), Some("dialout"));
        assert_eq!(group_name(groups, 21), None);
    }
}
