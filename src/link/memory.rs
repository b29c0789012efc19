//! A link within the process, for tests: bounded, and it stalls or breaks when told to.

use std::io;
use std::os::fd::BorrowedFd;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use rtrb::{Consumer, Producer, RingBuffer};
use tokio::sync::mpsc;

use super::sender::{Carry, Sender, To};
use super::{Kind, Link, receiver};

/// A link whose far side is in the caller's hand and takes `capacity` bytes before it is full.
pub fn memory(capacity: usize) -> (Link, Far) {
    let (producer, consumer) = RingBuffer::new(capacity);
    let (answer, answers) = mpsc::unbounded_channel();
    let switches = Arc::new(Switches::default());
    let near = Memory { producer: Some(producer), switches: Arc::clone(&switches), answers: Some(answers) };
    let far = Far { consumer, switches, answer: Some(answer) };
    (Link::new(Kind::Memory(near)), far)
}

#[derive(Default)]
struct Switches {
    stalled: AtomicBool,
    gone: AtomicBool,
}

/// The far side of a [`memory`] link.
pub struct Far {
    consumer: Consumer<u8>,
    switches: Arc<Switches>,
    answer: Option<mpsc::UnboundedSender<Vec<u8>>>,
}

impl Far {
    /// The bytes that have arrived since the last call; makes room for as many.
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

    /// While it stalls, the link takes nothing, whatever room it has.
    pub fn stall(&self, stalled: bool) {
        self.switches.stalled.store(stalled, Ordering::Release);
    }

    /// Sends bytes back.
    pub fn answer(&self, bytes: &[u8]) {
        if let Some(answer) = &self.answer {
            // A link that was dropped no longer listens.
            let _ = answer.send(bytes.to_owned());
        }
    }

    /// Leaves: from now on the link is `Gone` and its receiver ends. What has arrived can still be
    /// taken.
    pub fn leave(&mut self) {
        self.switches.gone.store(true, Ordering::Release);
        self.answer = None;
    }
}

/// The near side.
pub(super) struct Memory {
    producer: Option<Producer<u8>>,
    switches: Arc<Switches>,
    answers: Option<mpsc::UnboundedReceiver<Vec<u8>>>,
}

impl Memory {
    pub(super) fn name(&self) -> String {
        "memory".to_owned()
    }

    pub(super) fn present(&self) -> bool {
        !self.switches.gone.load(Ordering::Acquire)
    }

    pub(super) async fn peer(&mut self) -> io::Result<()> {
        Ok(())
    }

    pub(super) fn sender(&mut self) -> Sender {
        let out = Out { producer: self.producer.take(), switches: Arc::clone(&self.switches) };
        Sender::new(To::Memory(out), Carry::packet())
    }

    pub(super) fn receiver(&mut self) -> Option<receiver::From> {
        let answers = self.answers.take()?;
        Some(receiver::From::Memory(In(answers)))
    }

    /// Nothing to wait for: what has arrived stays until it is taken.
    pub(super) async fn close(self) {}
}

/// The sending side.
pub(super) struct Out {
    producer: Option<Producer<u8>>,
    switches: Arc<Switches>,
}

impl Out {
    pub(super) fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let Some(producer) = &mut self.producer else {
            return Err(io::ErrorKind::NotConnected.into());
        };
        if self.switches.gone.load(Ordering::Acquire) || producer.is_abandoned() {
            return Err(io::ErrorKind::BrokenPipe.into());
        }
        let stalled = self.switches.stalled.load(Ordering::Acquire);
        if stalled || producer.slots() == 0 {
            return Err(io::ErrorKind::WouldBlock.into());
        }
        let (taken, _) = producer.push_partial_slice(bytes);
        Ok(taken.len())
    }

    pub(super) fn poll_fd(&self) -> Option<BorrowedFd<'_>> {
        None
    }

    pub(super) fn queued(&self) -> Option<usize> {
        let producer = self.producer.as_ref()?;
        Some(producer.buffer().capacity() - producer.slots())
    }
}

/// The receiving side.
pub(super) struct In(mpsc::UnboundedReceiver<Vec<u8>>);

impl In {
    pub(super) async fn recv(&mut self, buffer: &mut Vec<u8>) -> io::Result<usize> {
        match self.0.recv().await {
            Some(bytes) => {
                buffer.extend_from_slice(&bytes);
                Ok(bytes.len())
            }
            None => Ok(0),
        }
    }
}
