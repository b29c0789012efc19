//! Detects readers that open and close the slave of a pty, with `inotify`.

use std::io;
use std::mem::MaybeUninit;
use std::os::fd::{BorrowedFd, OwnedFd};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use rustix::fs::inotify::{self, CreateFlags, ReadFlags, WatchFlags};
use rustix::io::Errno;
use rustix::termios::ioctl_tiocnxcl;
use tokio::sync::watch;
use tokio::task::AbortHandle;

use super::holders::times_open;
use crate::os::Readable;

/// Many clients discard what arrived before they opened the port; by then they have done so.
const SETTLE: Duration = Duration::from_millis(100);

/// How often the slave was opened and closed since it was published.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    opened: u64,
    closed: u64,
}

/// A watch on the slave of a pty.
pub(super) struct Visitors {
    device: PathBuf,
    seen: watch::Receiver<Seen>,
    task: AbortHandle,
}

impl Visitors {
    /// Watches `device` from now on; `slave` is our own only descriptor of it.
    pub(super) fn watch(device: &Path, slave: Arc<OwnedFd>) -> io::Result<Self> {
        let events = inotify::init(CreateFlags::NONBLOCK | CreateFlags::CLOEXEC)?;
        inotify::add_watch(&events, device, WatchFlags::OPEN | WatchFlags::CLOSE)?;
        let (tell, seen) = watch::channel(Seen::default());
        let task = tokio::spawn(count(Readable::new(Arc::new(events))?, tell, slave)).abort_handle();
        let device = device.to_owned();
        Ok(Self { device, seen, task })
    }

    /// Whether somebody has the slave open.
    ///
    /// The kernel may merge two openings in a row into one event. When the counts say that all have left, this asks
    /// the processes themselves.
    pub(super) fn present(&self) -> bool {
        let seen = *self.seen.borrow();
        seen.opened > seen.closed || seen.opened > 0 && times_open(&self.device) > 1
    }

    /// Whether anybody has ever opened the slave.
    pub(super) fn came(&self) -> bool {
        self.seen.borrow().opened > 0
    }

    /// Waits until somebody has had the slave open for 100 ms.
    ///
    /// A process that opens it and leaves (`stty -F`) does not count. Cancelling it loses nothing.
    pub(super) async fn arrival(&mut self) {
        loop {
            let before = *self.seen.borrow_and_update();
            if self.present() {
                tokio::time::sleep(SETTLE).await;
                if self.seen.borrow().opened == before.opened && self.present() {
                    return;
                }
            } else if self.seen.changed().await.is_err() {
                // The watch is over and no reader will be seen: only the caller's timeout ends this.
                std::future::pending::<()>().await;
            }
        }
    }
}

impl Drop for Visitors {
    fn drop(&mut self) {
        self.task.abort();
    }
}

/// Counts openings and closings for the life of the link.
///
/// A reader may claim the slave (`TIOCEXCL`) and die without releasing it, which would lock out the next reader
/// while we hold the slave. So each closing releases it.
async fn count(events: Readable, tell: watch::Sender<Seen>, slave: Arc<OwnedFd>) {
    while let Ok(news) = events.read(drain).await {
        if news.closed > 0 {
            let _ = ioctl_tiocnxcl(&slave);
        }
        tell.send_modify(|seen| {
            seen.opened += news.opened;
            seen.closed += news.closed;
        });
    }
}

/// A close event, for any mode of opening.
const CLOSED: ReadFlags = ReadFlags::CLOSE_WRITE.union(ReadFlags::CLOSE_NOWRITE);

/// The events that wait to be read.
fn drain(events: BorrowedFd<'_>) -> io::Result<Seen> {
    let mut buffer = [MaybeUninit::uninit(); 1024];
    let mut reader = inotify::Reader::new(events, &mut buffer);
    let mut news = Seen::default();
    loop {
        match reader.next() {
            Ok(event) if event.events().contains(ReadFlags::OPEN) => news.opened += 1,
            Ok(event) if event.events().intersects(CLOSED) => news.closed += 1,
            Ok(_) => {}
            Err(Errno::WOULDBLOCK) if news.opened + news.closed > 0 => return Ok(news),
            Err(errno) => return Err(errno.into()),
        }
    }
}
