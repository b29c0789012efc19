//! The control side's ears: tasks that read what comes back, each holding its link open.

use super::Tap;
use super::talk::Talk;
use crate::clock::{Clock, WallClock};
use crate::link::Receiver;
use bytes::BytesMut;
use std::cell::RefCell;
use std::rc::Rc;

/// Hands on what one link receives until the other side leaves.
pub(super) async fn tapped(mut receiver: Receiver, mut tap: Tap) {
    let mut buffer = BytesMut::with_capacity(4096);
    while matches!(receiver.recv(&mut buffer).await, Ok(1..)) {
        tap.0(&buffer);
        buffer.clear();
    }
}

/// Reads one link until the other side leaves; what has no meaning here is read all the same, so that nothing stands
/// in the other side's way.
pub(super) async fn listen(link: usize, mut receiver: Receiver, talk: Rc<RefCell<Talk>>, clock: WallClock) {
    let mut buffer = BytesMut::with_capacity(4096);
    while matches!(receiver.recv(&mut buffer).await, Ok(1..)) {
        talk.borrow_mut().hear(link, &buffer, clock.now());
        buffer.clear();
    }
}

/// Reads what a ground station sends, a datagram at a time. One that is not there yet may come.
pub(super) async fn listen_to_ground(mut receiver: Receiver, talk: Rc<RefCell<Talk>>) {
    let mut buffer = BytesMut::with_capacity(4096);
    loop {
        buffer.clear();
        match receiver.recv(&mut buffer).await {
            Ok(1..) => talk.borrow_mut().pass_down(&buffer),
            // Of a socket: a port unreachable, said of a datagram before.
            Ok(0) | Err(_) => tokio::time::sleep(super::control::TICK).await,
        }
    }
}
