//! The ring between the producer and the pacing thread.
//!
//! A packet has room for the longest of any protocol, and most hold a quarter of that. So heads and bytes cross from one
//! processor to the other on two rings: as much as a packet holds, and no more.

use crate::wire::{Head, MAX_PACKET, Packet};
use rtrb::{Consumer, Producer, RingBuffer};

/// Bytes for each packet that the ring has room for: more than those of most protocols have.
const ROOM: usize = 128;

/// The head of a packet and the output that it is for; its bytes are on the other ring.
#[derive(Clone, Copy, Debug)]
pub(super) struct Item {
    pub lane: usize,
    pub head: Head,
}

/// There is no room.
#[derive(Debug)]
pub(super) struct Full;

/// The producer's end.
pub(super) struct Inlet {
    items: Producer<Item>,
    bytes: Producer<u8>,
}

/// The pacing thread's end.
pub(super) struct Outlet {
    items: Consumer<Item>,
    bytes: Consumer<u8>,
}

/// A ring for so many packets, fewer if they are long.
pub(super) fn ring(packets: usize) -> (Inlet, Outlet) {
    let (items, next) = RingBuffer::new(packets);
    let (bytes, held) = RingBuffer::new((packets * ROOM).max(MAX_PACKET));
    (Inlet { items, bytes }, Outlet { items: next, bytes: held })
}

impl Inlet {
    /// Appends a packet for an output.
    pub(super) fn push(&mut self, lane: usize, packet: &Packet) -> Result<(), Full> {
        if self.items.is_full() {
            return Err(Full);
        }
        // The bytes first: whoever sees the head finds them.
        self.bytes.push_entire_slice(packet.bytes()).map_err(|_| Full)?;
        self.items.push(Item { lane, head: **packet }).map_err(|_| Full)
    }

    /// Whether the pacing thread has taken every packet.
    pub(super) fn is_empty(&self) -> bool {
        self.items.slots() == self.items.buffer().capacity()
    }

    /// Whether nobody holds the other end any more.
    pub(super) fn is_abandoned(&self) -> bool {
        self.items.is_abandoned()
    }
}

impl Outlet {
    /// The next packet's head, without taking it.
    #[inline]
    pub(super) fn peek(&self) -> Option<&Item> {
        self.items.peek().ok()
    }

    /// Takes the next packet into `packet` and says which output it is for.
    #[inline]
    pub(super) fn take(&mut self, packet: &mut Packet) -> Option<usize> {
        let Item { lane, head } = self.items.pop().ok()?;
        // Its bytes were there before it.
        let _ = self.bytes.pop_entire_slice(packet.hold(head));
        Some(lane)
    }

    /// Whether there is no packet.
    pub(super) fn is_empty(&self) -> bool {
        self.items.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensor::{Kinds, SensorKind};
    use crate::time::SimTime;

    #[test]
    fn what_goes_in_comes_out_whatever_its_length_and_the_ring_says_when_it_is_full() {
        let (mut inlet, mut outlet) = ring(8);
        let packet = |k: usize| {
            let bytes: Vec<u8> = (0..k * 37 % (MAX_PACKET + 1)).map(|i| (i + k) as u8).collect();
            Packet::new(SimTime(k as i64), SensorKind::ALL[k % 3].into(), &bytes)
        };
        let (mut made, mut taken, mut refused) = (0, 0, 0);
        let mut next = Packet::new(SimTime::ZERO, Kinds::NONE, &[]);
        while taken < 2000 {
            // Fills it up, then empties it by a few.
            while inlet.push(made % 5, &packet(made)).is_ok() {
                made += 1;
            }
            refused += 1;
            for _ in 0..=taken % 5 {
                let Some(&Item { lane, head }) = outlet.peek() else { break };
                let expected = packet(taken);
                assert_eq!(outlet.take(&mut next), Some(lane));
                assert_eq!((lane, head.due, next.due), (taken % 5, expected.due, expected.due));
                assert_eq!((next.carries, next.bytes()), (expected.carries, expected.bytes()));
                taken += 1;
            }
        }
        assert!(refused > 100 && made - taken <= 8);
        while outlet.take(&mut next).is_some() {}
        assert!(inlet.is_empty() && outlet.is_empty() && !inlet.is_abandoned());
        drop(outlet);
        assert!(inlet.is_abandoned());
    }
}
