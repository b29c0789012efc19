//! Emulates a UART on a pty, which has no baud rate of its own: bytes reach the reader as they would over a line at
//! a baud rate.
//!
//! ```text
//! pacing thread ─▶ transmit buffer, 4096 bytes ─▶ FIFO, up to 64 bytes ─▶ line: 10 bits a byte ─▶ reader
//! ```
//!
//! The buffer is as large as a serial driver's (Linux: a page). When it is full the sender learns so and decides
//! what to drop. A thread takes bytes from it one FIFO at a time and hands them over when their last stop bit would
//! end: a reader gets a UART's interrupts like that, and the last byte of a packet arrives on time. A reader that
//! does not read stops the line, as if it dropped CTS: nothing is lost here.

use super::baud::BITS_PER_BYTE;
use super::sender::{Carry, Out, Sender};
use crate::clock::{Clock, WallClock};
use crate::os;
use rtrb::{Consumer, Producer, RingBuffer};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use std::io;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicI64, AtomicU64, Ordering};
use std::thread::{self, JoinHandle, Thread};
use std::time::Duration;

/// Capacity of the transmit buffer, bytes.
pub(super) const BUFFER: usize = 4096;
/// A UART works without the processor, so its thread gets priority over ordinary work where that is allowed.
const PRIORITY: i32 = 45;
/// A thread without a wake-up looks this often.
const LOOK: Duration = Duration::from_millis(50);

/// The number of bytes handed over together. At the speeds of an 8250, one, so that no byte waits for another; then
/// the FIFO of a 16550; from 230 400 baud up the FIFO of a 16750, which is also a packet of full-speed USB. There
/// is then never much more than one wake-up in a quarter of a millisecond.
fn fifo(baud: u32) -> usize {
    match baud {
        ..1200 => 1,
        1200..230_400 => 16,
        _ => 64,
    }
}

/// State that the pacing thread, the line and the control side share.
struct Line {
    baud: u32,
    /// Bytes put into the buffer, and bytes handed to the reader.
    taken: AtomicU64,
    delivered: AtomicU64,
    /// When bytes last entered an empty buffer, ns on the line's clock.
    woken_ns: AtomicI64,
    /// Ends the line, whatever it still holds.
    stop: AtomicBool,
}

impl Line {
    /// Bytes that the reader cannot see yet.
    fn held(&self) -> u64 {
        let delivered = self.delivered.load(Ordering::Acquire);
        self.taken.load(Ordering::Acquire).saturating_sub(delivered)
    }
}

/// An emulated UART in front of a pty.
pub(super) struct Uart {
    line: Arc<Line>,
    thread: JoinHandle<()>,
}

impl Uart {
    /// Starts the line in front of `master`; dropping the sender ends it.
    pub(super) fn start(baud: u32, master: Arc<OwnedFd>) -> io::Result<(Uart, Sender)> {
        let (producer, consumer) = RingBuffer::new(BUFFER);
        // It sleeps and never spins: a late wake-up delays at most one FIFO of bytes, and delays do not accumulate.
        let clock = WallClock::start();
        let line = Arc::new(Line {
            baud,
            taken: AtomicU64::new(0),
            delivered: AtomicU64::new(0),
            woken_ns: AtomicI64::new(0),
            stop: AtomicBool::new(false),
        });
        let mut shifter = Shifter::new(clock, consumer, Arc::clone(&line));
        let body = move || {
            let _ = os::set_realtime_priority(PRIORITY);
            let stop = Arc::clone(&shifter.line);
            shifter.run(|bytes| hand_over(&master, bytes, &stop.stop));
        };
        let thread = thread::Builder::new().name("uart".into()).spawn(body)?;
        let buffer = Buffer { producer, clock, line: Arc::clone(&line), thread: thread.thread().clone() };
        Ok((Uart { line, thread }, Sender::new(buffer, Carry::packet())))
    }

    /// What it does, in one sentence.
    pub(super) fn notice(&self, name: &str) -> String {
        let baud = self.line.baud;
        format!(
            "{name} has the timing of a UART at {baud} baud: {} bytes/s (8N1) from a transmit buffer of {BUFFER} bytes",
            super::baud::bytes_per_second(baud)
        )
    }

    /// Bytes that the reader cannot see yet.
    pub(super) fn held(&self) -> usize {
        usize::try_from(self.line.held()).unwrap_or(usize::MAX)
    }

    /// Waits until the line has sent what it holds, as long as bytes move at least once a second. Drop the sender
    /// first.
    pub(super) async fn close(&self) {
        const PAUSE: Duration = Duration::from_millis(5);
        let (mut held, mut still) = (self.line.held(), 0);
        while !self.thread.is_finished() && still < 200 {
            tokio::time::sleep(PAUSE).await;
            let now = self.line.held();
            still = if now < held { 0 } else { still + 1 };
            held = now;
        }
    }
}

impl Drop for Uart {
    fn drop(&mut self) {
        self.line.stop.store(true, Ordering::Release);
        self.thread.thread().unpark();
    }
}

/// The sending side: a buffer that the line empties.
struct Buffer {
    producer: Producer<u8>,
    clock: WallClock,
    line: Arc<Line>,
    thread: Thread,
}

impl Out for Buffer {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let room = self.producer.slots();
        if room == 0 {
            return Err(io::ErrorKind::WouldBlock.into());
        }
        if room == BUFFER {
            // An idle line starts its first bit when the bytes arrive, not when its thread wakes.
            self.line.woken_ns.store(self.clock.now(), Ordering::Release);
        }
        let (taken, _) = self.producer.push_partial_slice(bytes);
        self.line.taken.fetch_add(taken.len() as u64, Ordering::AcqRel);
        // Waking a sleeping thread is one system call without a lock; for a running one it is a store.
        self.thread.unpark();
        Ok(taken.len())
    }

    fn poll_fd(&self) -> Option<BorrowedFd<'_>> {
        None
    }
}

impl Drop for Buffer {
    fn drop(&mut self) {
        self.thread.unpark();
    }
}

/// Exact times at which bytes leave a line, counted from its last idle time and never accumulated.
#[derive(Debug)]
struct Bits {
    baud: u32,
    /// When the line last went from idle to busy, ns.
    begun: i64,
    /// Bytes since then.
    bytes: i64,
}

impl Bits {
    /// When the last stop bit sent so far ends, ns.
    fn free(&self) -> i64 {
        let bits = i128::from(self.bytes) * i128::from(BITS_PER_BYTE);
        self.begun + (bits * 1_000_000_000 / i128::from(self.baud)) as i64
    }

    /// Sends `count` bytes that have been available since `since`; returns when they end, ns.
    fn send(&mut self, since: i64, count: usize) -> i64 {
        if since > self.free() {
            self.restart(since);
        }
        self.bytes += count as i64;
        self.free()
    }

    /// Marks the line as idle until `now`.
    fn restart(&mut self, now: i64) {
        (self.begun, self.bytes) = (now, 0);
    }
}

/// Takes bytes from the buffer at the speed of a line.
struct Shifter<C> {
    clock: C,
    buffer: Consumer<u8>,
    line: Arc<Line>,
    bits: Bits,
}

impl<C: Clock> Shifter<C> {
    fn new(clock: C, buffer: Consumer<u8>, line: Arc<Line>) -> Self {
        let bits = Bits { baud: line.baud, begun: 0, bytes: 0 };
        Self { clock, buffer, line, bits }
    }

    /// Works until the sender is gone and the buffer empty, or until stopped. `hand_over` returns whether it had to
    /// wait for the reader.
    fn run(&mut self, mut hand_over: impl FnMut(&[u8]) -> bool) {
        let mut fifo = [0; 64];
        while !self.line.stop.load(Ordering::Acquire) {
            // Check this first: then bytes that the sender added before it left are seen.
            let last = self.buffer.is_abandoned();
            let count = self.load(&mut fifo);
            if count > 0 {
                self.shift(&fifo[..count], &mut hand_over);
            } else if last {
                return;
            } else {
                thread::park_timeout(LOOK);
            }
        }
    }

    /// Moves what fits from the buffer to the FIFO.
    fn load(&mut self, fifo: &mut [u8; 64]) -> usize {
        let count = self.buffer.slots().min(self::fifo(self.line.baud));
        let Ok(chunk) = self.buffer.read_chunk(count) else { return 0 };
        let (first, second) = chunk.as_slices();
        fifo[..first.len()].copy_from_slice(first);
        fifo[first.len()..count].copy_from_slice(second);
        chunk.commit_all();
        count
    }

    fn shift(&mut self, bytes: &[u8], hand_over: &mut impl FnMut(&[u8]) -> bool) {
        let over = self.bits.send(self.line.woken_ns.load(Ordering::Acquire), bytes.len());
        self.clock.wait_until(over);
        if hand_over(bytes) {
            // The line stood still, and does not catch up.
            self.bits.restart(self.clock.now());
        }
        self.line.delivered.fetch_add(bytes.len() as u64, Ordering::AcqRel);
    }
}

/// Writes all of `bytes` to the reader and waits for it; returns whether it had to wait.
fn hand_over(master: &OwnedFd, mut bytes: &[u8], stop: &AtomicBool) -> bool {
    let mut waited = false;
    while !bytes.is_empty() && !stop.load(Ordering::Acquire) {
        match rustix::io::write(master, bytes) {
            Ok(count) if count > 0 => bytes = &bytes[count..],
            Ok(_) | Err(rustix::io::Errno::AGAIN) => {
                waited = true;
                wait_for_room(master.as_fd());
            }
            Err(rustix::io::Errno::INTR) => {}
            // We hold the other end ourselves, so it cannot go away.
            Err(_) => return waited,
        }
    }
    waited
}

fn wait_for_room(master: BorrowedFd<'_>) {
    let look = Timespec { tv_sec: 0, tv_nsec: i64::from(LOOK.subsec_nanos()) };
    let _ = poll(&mut [PollFd::from_borrowed_fd(master, PollFlags::OUT)], Some(&look));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clock::VirtualClock;

    /// A line on a virtual clock with this many bytes in its buffer since `woken_ns`, and no sender.
    fn line(baud: u32, woken_ns: i64, bytes: usize) -> Shifter<VirtualClock> {
        let (mut producer, consumer) = RingBuffer::new(BUFFER);
        assert_eq!(producer.push_partial_slice(&vec![7; bytes]).0.len(), bytes);
        let line = Line {
            baud,
            taken: AtomicU64::new(bytes as u64),
            delivered: AtomicU64::new(0),
            woken_ns: AtomicI64::new(woken_ns),
            stop: AtomicBool::new(false),
        };
        Shifter::new(VirtualClock::default(), consumer, Arc::new(line))
    }

    #[test]
    fn each_fifo_of_bytes_comes_when_its_last_stop_bit_is_over() {
        for (baud, fifo) in [(300, 1), (9600, 16), (115_200, 16), (921_600, 64), (1_234_567, 64)] {
            let (woken, bytes) = (5_000, 1000);
            let mut shifter = line(baud, woken, bytes);
            let (mut seen, mut ends) = (Vec::new(), Vec::new());
            while let count @ 1.. = shifter.load(&mut [0; 64]) {
                shifter.shift(&vec![7; count], &mut |bytes| {
                    seen.push(bytes.len());
                    false
                });
                ends.push(shifter.clock.now());
            }
            assert!(seen[..seen.len() - 1].iter().all(|count| *count == fifo), "{baud}: {seen:?}");
            let mut done = 0;
            for (count, end) in seen.iter().zip(ends) {
                done += count;
                let exact = woken as f64 + done as f64 * 10.0 * 1e9 / f64::from(baud);
                assert!((end as f64 - exact).abs() <= 1.0, "{baud}: {done} bytes at {end}, not {exact}");
            }
            assert_eq!((done, shifter.line.held()), (bytes, 0));
        }
    }

    #[test]
    fn a_late_wake_up_costs_the_line_no_capacity() {
        let mut shifter = line(115_200, 0, 4000);
        shifter.clock = VirtualClock::waking_late([70_000]);
        let mut delivered = 0;
        shifter.run(|bytes| {
            delivered += bytes.len();
            false
        });
        assert_eq!(delivered, 4000);
        let exact = 4000 * 10 * 1_000_000_000_i64 / 115_200;
        assert!((0..=70_000).contains(&(shifter.clock.now() - exact)), "{}", shifter.clock.now() - exact);
    }

    #[test]
    fn a_line_that_stood_still_does_not_make_up_for_it() {
        let mut shifter = line(115_200, 0, 160);
        let mut ends = Vec::new();
        while let mut fifo = [0; 64]
            && let count @ 1.. = shifter.load(&mut fifo)
        {
            if ends.len() == 2 {
                // As after a reader that delayed the previous bytes.
                shifter.clock.wait_until(1_000_000_000);
                shifter.bits.restart(1_000_000_000);
            }
            shifter.shift(&fifo[..count], &mut |_| false);
            ends.push(shifter.clock.now());
        }
        let fifo_ns = 16 * 10 * 1_000_000_000_i64 / 115_200;
        for (i, end) in ends.iter().enumerate() {
            let (begun, fifos) = if i < 2 { (0, i + 1) } else { (1_000_000_000, i - 1) };
            assert!((end - begun - fifos as i64 * fifo_ns).abs() <= 10, "{ends:?}");
        }
        assert_eq!(ends.len(), 10);
    }

    #[test]
    fn an_idle_line_begins_anew_and_a_busy_one_goes_on() {
        let mut bits = Bits { baud: 10_000, begun: 0, bytes: 0 };
        // A byte takes a millisecond.
        assert_eq!(bits.send(500, 3), 3_000_500);
        assert_eq!(bits.send(600, 2), 5_000_500, "still busy");
        assert_eq!(bits.send(9_000_000, 1), 10_000_000, "idle until then");
    }

    #[tokio::test]
    async fn over_a_pty_every_byte_arrives_once_and_in_order_and_never_before_its_time() {
        use std::io::Read;
        let baud = 460_800;
        let mut link = crate::link::Link::open(&format!("pty,{baud}").parse().unwrap()).await.unwrap();
        assert!(
            link.notices()[0].contains("UART at 460800 baud: 46080 bytes/s (8N1)"),
            "{:?}",
            link.notices()
        );
        let mut far = std::fs::File::open(link.name()).unwrap();
        let sent: Vec<u8> = (0..20_000_u32).map(|i| (i ^ (i >> 8)) as u8).collect();
        let (mut sender, packets) = (link.sender(), sent.clone());
        let clock = WallClock::start();
        let writing = thread::spawn(move || {
            let stop = AtomicBool::new(false);
            for packet in packets.chunks(77) {
                assert_eq!(sender.send_all(packet, &stop), crate::link::Sent::Done);
            }
            sender.finish().unwrap();
        });
        let reading = thread::spawn(move || {
            let mut received = vec![0; 20_000];
            let mut done = 0;
            while done < received.len() {
                done += far.read(&mut received[done..]).unwrap();
                let earliest = done as i64 * 10 * 1_000_000_000 / i64::from(baud);
                assert!(clock.now() >= earliest, "{done} bytes at {} ns", clock.now());
            }
            (received, far)
        });
        let (received, _far) = tokio::task::spawn_blocking(|| reading.join().unwrap()).await.unwrap();
        assert!(received == sent);
        writing.join().unwrap();
        link.close().await;
    }

    #[tokio::test]
    async fn what_a_line_has_not_sent_is_seen_and_a_full_buffer_takes_nothing() {
        // Ten bytes a second: almost nothing leaves during the test.
        let mut link = crate::link::Link::open(&"pty,100".parse().unwrap()).await.unwrap();
        let mut sender = link.sender();
        let mut taken = 0;
        while sender.send(&[7; 64]) == crate::link::Sent::Done {
            taken += 64;
        }
        assert!((BUFFER..=BUFFER + 2 * 64).contains(&taken), "{taken}");
        // One byte is on the line, and the last packet may have gone in part.
        let queued = link.queued().unwrap();
        assert!((BUFFER - 1..=BUFFER + 64).contains(&queued), "{queued}");
    }

    #[tokio::test]
    async fn to_hand_bytes_to_the_line_allocates_nothing() {
        let mut link = crate::link::Link::open(&"pty,9600".parse().unwrap()).await.unwrap();
        let mut sender = link.sender();
        let mut full = 0;
        let counted = allocation_counter::measure(|| {
            for _ in 0..100 {
                full += u32::from(sender.send(&[7; 100]) == crate::link::Sent::Full);
            }
        });
        assert!(full > 40, "a buffer of {BUFFER} bytes was filled: {full}");
        assert_eq!(counted.count_total, 0);
    }
}
