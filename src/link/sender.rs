//! The sending half of a link, for the pacing thread. No allocation, no lock, no executor.

use std::io;
use std::os::fd::BorrowedFd;
use std::sync::atomic::{AtomicBool, Ordering};

use rustix::event::{PollFd, PollFlags, Timespec, poll};

/// The longest packet that a link accepts, bytes.
pub const MAX_WRITE: usize = 65_536;

/// What happened to a packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub enum Sent {
    /// The link has all of it.
    Done,
    /// The link accepts nothing now, or nobody has connected yet; it has none of the packet.
    Full,
    /// The port was unplugged and may come back. It has none of the packet, and the rest of the previous one is
    /// lost.
    Away,
    /// Nobody is there any more, or the packet can never go out (`InvalidInput`: too long).
    Gone(io::ErrorKind),
}

/// The sending side of a link, for one thread.
///
/// A packet is never truncated: if the system takes only a part, the sender keeps the rest and sends it before the
/// next packet. Call [`finish`](Self::finish) at the end.
pub struct Sender {
    to: Box<dyn Out>,
    carry: Carry,
}

/// The output of one kind of link.
pub(super) trait Out: Send {
    /// One non-blocking system call: the number of bytes that it took, or `WouldBlock`.
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize>;

    /// The descriptor to poll until it accepts more, if there is one now.
    fn poll_fd(&self) -> Option<BorrowedFd<'_>>;

    /// Whether a peer that is not there now (`NotConnected`) may come back.
    fn comes_back(&self) -> bool {
        false
    }
}

impl Sender {
    pub(super) fn new(to: impl Out + 'static, carry: Carry) -> Self {
        Self { to: Box::new(to), carry }
    }

    /// Sends a packet if the link accepts it now; never waits.
    ///
    /// A file gathers packets and writes many at once; that write may wait for the disk.
    pub fn send(&mut self, packet: &[u8]) -> Sent {
        self.take(packet, self.carry.gather == Gather::Always)
    }

    /// Sends `bytes` and waits while the link is full; drops nothing.
    ///
    /// Returns `Full` or `Away` only after `stop` is set, which it checks every 50 ms. Of more than [`MAX_WRITE`]
    /// bytes, a part may then have been sent.
    pub fn send_all(&mut self, bytes: &[u8], stop: &AtomicBool) -> Sent {
        let gather = self.carry.gather != Gather::Never;
        for part in bytes.chunks(MAX_WRITE) {
            loop {
                match self.take(part, gather) {
                    Sent::Done => break,
                    refused @ (Sent::Full | Sent::Away) if stop.load(Ordering::Relaxed) => return refused,
                    Sent::Full | Sent::Away => _ = self.wait(),
                    gone @ Sent::Gone(_) => return gone,
                }
            }
        }
        Sent::Done
    }

    /// Whether [`send_all`](Self::send_all) would only put so many bytes with others that are to be written at once.
    #[inline]
    pub fn gathers(&self, count: usize) -> bool {
        self.carry.gather != Gather::Never && self.carry.fits(count)
    }

    /// Puts a packet with others, which the link [`gathers`](Self::gathers); otherwise does nothing.
    #[inline]
    pub fn gather(&mut self, packet: &[u8]) {
        if self.gathers(packet.len()) {
            self.carry.keep(packet);
        }
    }

    /// Sends a packet like [`send`](Self::send), but at most its first `count` bytes go out now. The rest waits for
    /// [`send_kept`](Self::send_kept) or the next packet. A link of datagrams or gathered blocks sends all of it.
    pub fn send_first(&mut self, packet: &[u8], count: usize) -> Sent {
        if self.carry.gather != Gather::Never || !self.carry.fits(packet.len()) {
            return self.send(packet);
        }
        match self.flush_carry() {
            Sent::Done => {}
            other => return other,
        }
        match write(&mut *self.to, &packet[..count.min(packet.len())]) {
            Ok(taken) => {
                self.carry.keep(&packet[taken..]);
                Sent::Done
            }
            Err(refused) => self.refused(refused),
        }
    }

    /// Like [`send_first`](Self::send_first), but waits like [`send_all`](Self::send_all).
    pub fn send_all_first(&mut self, packet: &[u8], count: usize, stop: &AtomicBool) -> Sent {
        loop {
            match self.send_first(packet, count) {
                Sent::Full | Sent::Away if !stop.load(Ordering::Relaxed) => _ = self.wait(),
                done => return done,
            }
        }
    }

    /// Sends `count` more of the kept bytes, as far as the link accepts them now.
    pub fn send_kept(&mut self, count: usize) {
        let kept = self.carry.kept();
        if !kept.is_empty() {
            match write(&mut *self.to, &kept[..count.min(kept.len())]) {
                Ok(taken) => self.carry.forget(taken),
                Err(refused) => _ = self.refused(refused),
            }
        }
    }

    /// Sends what is kept of earlier packets as far as the link accepts it now; never waits.
    ///
    /// `Done` when nothing is left, `Full` otherwise.
    fn flush_carry(&mut self) -> Sent {
        while !self.carry.kept().is_empty() {
            match write(&mut *self.to, self.carry.kept()) {
                Ok(count) => self.carry.forget(count),
                Err(full) => return self.refused(full),
            }
        }
        Sent::Done
    }

    /// Sends all that is kept and waits if necessary: without limit for a file or standard output, otherwise as
    /// long as bytes move at least once a second (`TimedOut`).
    pub fn finish(&mut self) -> io::Result<()> {
        let patient = self.carry.gather != Gather::Never;
        let mut idle_ms = 0;
        loop {
            let before = self.carry.kept().len();
            match self.flush_carry() {
                Sent::Done => return Ok(()),
                Sent::Gone(kind) => return Err(kind.into()),
                Sent::Away => return Err(io::ErrorKind::NotConnected.into()),
                Sent::Full if self.carry.kept().len() < before => idle_ms = 0,
                Sent::Full if idle_ms > PATIENCE_MS && !patient => {
                    return Err(io::ErrorKind::TimedOut.into());
                }
                Sent::Full => {}
            }
            idle_ms += self.wait();
        }
    }

    /// Bytes kept because the system has not taken them yet.
    pub fn kept(&self) -> usize {
        self.carry.kept().len()
    }

    fn take(&mut self, packet: &[u8], gather: bool) -> Sent {
        if packet.len() > MAX_WRITE {
            return Sent::Gone(io::ErrorKind::InvalidInput);
        }
        if gather && self.carry.fits(packet.len()) {
            self.carry.keep(packet);
            return Sent::Done;
        }
        match self.flush_carry() {
            Sent::Done => {}
            // A batch needs enough room, not an empty buffer.
            Sent::Full if gather && self.carry.fits(packet.len()) => {}
            other => return other,
        }
        if gather {
            self.carry.keep(packet);
            return Sent::Done;
        }
        match write(&mut *self.to, packet) {
            Ok(count) if count < packet.len() => {
                self.carry.keep(&packet[count..]);
                // A limit on one call may have stopped it: try again.
                match self.flush_carry() {
                    Sent::Full => Sent::Done,
                    other => other,
                }
            }
            Ok(_) => Sent::Done,
            Err(refused) => self.refused(refused),
        }
    }

    /// Handles a refusal: bytes kept for a peer that is gone are dropped.
    fn refused(&mut self, sent: Sent) -> Sent {
        if let Sent::Gone(_) | Sent::Away = sent {
            self.carry.clear();
        }
        sent
    }

    /// Waits until the link may accept something, for one slice at most. Returns about how many ms it waited.
    ///
    /// An early or spurious wake-up only makes the caller try again.
    fn wait(&self) -> i64 {
        let (slice_ms, woken) = match self.to.poll_fd() {
            Some(fd) => (SLICE_MS, poll_writable(fd, &ms(SLICE_MS))),
            None => (BLIND_SLICE_MS, poll(&mut [], Some(&ms(BLIND_SLICE_MS)))),
        };
        match woken {
            Ok(0) => slice_ms,
            _ => 1,
        }
    }
}

impl Drop for Sender {
    /// Sends what the link accepts without a wait; only `finish` confirms it.
    fn drop(&mut self) {
        let _ = self.flush_carry();
    }
}

/// The longest wait before `stop` is checked again.
const SLICE_MS: i64 = 50;
/// The same without a wake-up: in memory, and with nobody connected.
const BLIND_SLICE_MS: i64 = 1;
/// How long `finish` waits for bytes to move.
const PATIENCE_MS: i64 = 1000;

fn ms(milliseconds: i64) -> Timespec {
    Timespec { tv_sec: 0, tv_nsec: milliseconds * 1_000_000 }
}

fn poll_writable(fd: BorrowedFd<'_>, slice: &Timespec) -> rustix::io::Result<usize> {
    poll(&mut [PollFd::from_borrowed_fd(fd, PollFlags::OUT)], Some(slice))
}

/// One write: the number of bytes taken, or why none was.
fn write(to: &mut dyn Out, bytes: &[u8]) -> Result<usize, Sent> {
    loop {
        match to.write(bytes) {
            Ok(0) if !bytes.is_empty() => return Err(Sent::Full),
            Ok(count) => return Ok(count),
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) if error.kind() == io::ErrorKind::NotConnected && to.comes_back() => {
                return Err(Sent::Away);
            }
            Err(error) => return Err(meaning(&error)),
        }
    }
}

fn meaning(error: &io::Error) -> Sent {
    match (error.kind(), error.raw_os_error()) {
        (io::ErrorKind::WouldBlock, _) | (_, Some(libc::ENOBUFS)) => Sent::Full,
        (_, Some(libc::EMSGSIZE)) => Sent::Gone(io::ErrorKind::InvalidInput),
        (kind, _) => Sent::Gone(kind),
    }
}

/// When to gather packets and write many at once.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Gather {
    Never,
    /// Only in `send_all`: a packet that is due goes out at once.
    WhenUnpaced,
    Always,
}

/// Bytes that the system has not taken yet, in a buffer that never grows.
pub(super) struct Carry {
    bytes: Box<[u8]>,
    start: usize,
    end: usize,
    gather: Gather,
}

impl Carry {
    fn new(size: usize, gather: Gather) -> Self {
        Self { bytes: vec![0; size].into_boxed_slice(), start: 0, end: 0, gather }
    }

    /// For a stream: room for the rest of a packet.
    pub(super) fn packet() -> Self {
        Self::new(MAX_WRITE, Gather::Never)
    }

    /// For datagrams, which go out whole or not at all.
    pub(super) fn none() -> Self {
        Self::new(0, Gather::Never)
    }

    /// For a file.
    pub(super) fn batch() -> Self {
        Self::new(4 * MAX_WRITE, Gather::Always)
    }

    /// For a pipe that somebody may watch.
    pub(super) fn lively_batch() -> Self {
        Self::new(4 * MAX_WRITE, Gather::WhenUnpaced)
    }

    fn kept(&self) -> &[u8] {
        &self.bytes[self.start..self.end]
    }

    fn fits(&self, count: usize) -> bool {
        count <= self.bytes.len() - (self.end - self.start)
    }

    /// Adds bytes that fit.
    fn keep(&mut self, more: &[u8]) {
        if more.len() > self.bytes.len() - self.end {
            self.bytes.copy_within(self.start..self.end, 0);
            self.end -= self.start;
            self.start = 0;
        }
        self.bytes[self.end..self.end + more.len()].copy_from_slice(more);
        self.end += more.len();
    }

    fn forget(&mut self, count: usize) {
        self.start += count;
        if self.start == self.end {
            self.clear();
        }
    }

    fn clear(&mut self) {
        self.start = 0;
        self.end = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::super::memory;
    use super::*;

    #[test]
    fn a_packet_that_half_fits_is_finished_before_the_next() {
        let (mut link, mut far) = memory(10);
        let mut sender = link.sender();
        assert_eq!(sender.send(b"abcdefg"), Sent::Done);
        assert_eq!(sender.send(b"ABCDEFG"), Sent::Done);
        assert_eq!(sender.kept(), 4);
        assert_eq!(sender.send(b"never"), Sent::Full);
        assert_eq!(far.take(), b"abcdefgABC");
        assert_eq!(sender.send(b"123"), Sent::Done);
        assert_eq!(far.take(), b"DEFG123");
    }

    #[test]
    fn a_packet_goes_out_in_pieces_and_whole_before_the_next() {
        let (mut link, mut far) = memory(100);
        let mut sender = link.sender();
        assert_eq!(sender.send_first(b"abcdefg", 3), Sent::Done);
        assert_eq!(far.take(), b"abc");
        sender.send_kept(3);
        assert_eq!(far.take(), b"def");
        sender.send_kept(3);
        sender.send_kept(3);
        assert_eq!(far.take(), b"g", "and nothing after the end");
        assert_eq!(sender.send_first(b"abcdefg", 3), Sent::Done);
        assert_eq!(sender.send(b"123"), Sent::Done);
        assert_eq!(far.take(), b"abcdefg123");
        far.stall(true);
        assert_eq!(sender.send_first(b"abcdefg", 3), Sent::Full, "nothing of it");
        assert_eq!(sender.send_all_first(b"abcdefg", 3, &AtomicBool::new(true)), Sent::Full);
        assert_eq!(sender.kept(), 0);
    }

    #[test]
    fn what_is_kept_is_flushed_when_there_is_room() {
        let (mut link, mut far) = memory(4);
        let mut sender = link.sender();
        assert_eq!(sender.send(b"abcdef"), Sent::Done);
        assert_eq!(sender.flush_carry(), Sent::Full);
        assert_eq!(far.take(), b"abcd");
        assert_eq!(sender.flush_carry(), Sent::Done);
        sender.finish().unwrap();
        assert_eq!(far.take(), b"ef");
    }

    #[test]
    fn a_carry_makes_room_by_moving_what_it_keeps() {
        let mut carry = Carry::new(6, Gather::Never);
        carry.keep(b"abcdef");
        carry.forget(4);
        assert!(carry.fits(4) && !carry.fits(5));
        carry.keep(b"1234");
        assert_eq!(carry.kept(), b"ef1234");
        carry.forget(6);
        assert!(carry.fits(6));
    }

    #[test]
    fn a_packet_longer_than_any_is_refused_whole() {
        let (mut link, mut far) = memory(10);
        let mut sender = link.sender();
        let sent = sender.send(&vec![0; MAX_WRITE + 1]);
        assert_eq!(sent, Sent::Gone(io::ErrorKind::InvalidInput));
        assert_eq!(far.take(), b"");
    }

    #[test]
    fn waiting_ends_when_told_to_stop() {
        let (mut link, far) = memory(4);
        let mut sender = link.sender();
        far.stall(true);
        assert_eq!(sender.send_all(b"ab", &AtomicBool::new(true)), Sent::Full);
        far.stall(false);
        assert_eq!(sender.send_all(b"ab", &AtomicBool::new(true)), Sent::Done);
    }

    #[test]
    fn a_reader_that_never_comes_ends_the_finish_too() {
        let (mut link, _far) = memory(4);
        let mut sender = link.sender();
        assert_eq!(sender.send(b"abcdef"), Sent::Done);
        assert_eq!(sender.finish().unwrap_err().kind(), io::ErrorKind::TimedOut);
    }
}
