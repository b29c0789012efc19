//! A link within the process, for tests: bounded; it stalls, unplugs or breaks on request.

use std::io;
use std::os::fd::BorrowedFd;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use rtrb::{Consumer, Producer, RingBuffer};
use tokio::sync::mpsc;

use super::sender::{Carry, Out, Sender};
use super::{Kind, Link};

/// A link whose far side the caller holds; it accepts `capacity` bytes before it is full.
pub fn memory(capacity: usize) -> (Link, Far) {
    let (producer, consumer) = RingBuffer::new(capacity);
    let (answer, answers) = mpsc::unbounded_channel();
    let switches = Arc::new(Switches::default());
    let out = Ring { producer, switches: Arc::clone(&switches) };
    let far = Far { consumer, switches, answer: Some(answer) };
    let receiver = Some(answers.into());
    (Link::new("memory", Kind::Plain, Sender::new(out, Carry::packet()), receiver), far)
}

#[derive(Default)]
struct Switches {
    stalled: AtomicBool,
    unplugged: AtomicBool,
    gone: AtomicBool,
}

/// The far side of a [`memory`] link.
pub struct Far {
    consumer: Consumer<u8>,
    switches: Arc<Switches>,
    answer: Option<mpsc::UnboundedSender<Vec<u8>>>,
}

impl Far {
    /// Takes the bytes that arrived since the last call, which makes room for as many.
    pub fn take(&mut self) -> Vec<u8> {
        let waiting = self.consumer.slots();
        let Ok(chunk) = self.consumer.read_chunk(waiting) else {
            return Vec::new();
        };
        let (first, second) = chunk.as_slices();
        let bytes = [first, second].concat();
        chunk.commit_all();
        bytes
    }

    /// While stalled, the link accepts nothing, whatever room it has.
    pub fn stall(&self, stalled: bool) {
        self.switches.stalled.store(stalled, Ordering::Release);
    }

    /// While unplugged, the link is `Away`, like a serial port that may come back.
    pub fn unplug(&self, unplugged: bool) {
        self.switches.unplugged.store(unplugged, Ordering::Release);
    }

    /// Sends bytes back.
    pub fn answer(&self, bytes: &[u8]) {
        if let Some(answer) = &self.answer {
            // A dropped link no longer listens.
            let _ = answer.send(bytes.to_owned());
        }
    }

    /// Leaves: from now on the link is `Gone` and its receiver ends. Bytes that arrived can still be taken.
    pub fn leave(&mut self) {
        self.switches.gone.store(true, Ordering::Release);
        self.answer = None;
    }
}

/// The near side.
struct Ring {
    producer: Producer<u8>,
    switches: Arc<Switches>,
}

impl Out for Ring {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.switches.gone.load(Ordering::Acquire) || self.producer.is_abandoned() {
            return Err(io::ErrorKind::BrokenPipe.into());
        }
        if self.comes_back() {
            return Err(io::ErrorKind::NotConnected.into());
        }
        let stalled = self.switches.stalled.load(Ordering::Acquire);
        if stalled || self.producer.slots() == 0 {
            return Err(io::ErrorKind::WouldBlock.into());
        }
        let (taken, _) = self.producer.push_partial_slice(bytes);
        Ok(taken.len())
    }

    fn poll_fd(&self) -> Option<BorrowedFd<'_>> {
        None
    }

    fn comes_back(&self) -> bool {
        self.switches.unplugged.load(Ordering::Acquire)
    }
}
