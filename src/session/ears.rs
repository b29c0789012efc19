//! The control side's receivers: tasks that read what comes back. Each holds its link open.

use super::Tap;
use super::talk::Talk;
use crate::clock::{Clock, WallClock};
use crate::link::Receiver;
use bytes::BytesMut;
use std::cell::RefCell;
use std::rc::Rc;
use tokio::task::{JoinHandle, spawn_local};

/// All receiving tasks.
#[derive(Default)]
pub(super) struct Ears {
    tasks: Vec<JoinHandle<()>>,
    /// Whether one of them feeds a tap.
    pub tapped: bool,
}

impl Ears {
    /// Passes what a link receives to a tap.
    pub(super) fn tap(&mut self, receiver: Receiver, tap: Tap) {
        self.tasks.push(spawn_local(tapped(receiver, tap)));
        self.tapped = true;
    }

    /// Listens to the other side of a link.
    pub(super) fn listen(
        &mut self,
        link: usize,
        receiver: Receiver,
        talk: &Rc<RefCell<Talk>>,
        clock: WallClock,
    ) {
        self.tasks.push(spawn_local(listen(link, receiver, talk.clone(), clock)));
    }

    /// Listens where the other side of a link tells its attitude besides.
    pub(super) fn overhear(
        &mut self,
        link: usize,
        receiver: Receiver,
        talk: &Rc<RefCell<Talk>>,
        clock: WallClock,
    ) {
        self.tasks.push(spawn_local(overhear(link, receiver, talk.clone(), clock)));
    }

    /// Listens to a ground station.
    pub(super) fn listen_to_ground(&mut self, receiver: Receiver, talk: &Rc<RefCell<Talk>>) {
        self.tasks.push(spawn_local(listen_to_ground(receiver, talk.clone())));
    }

    /// Stops listening.
    pub(super) async fn close(&mut self) {
        for task in &self.tasks {
            task.abort();
        }
        for task in self.tasks.drain(..) {
            // A link's descriptor closes, and the other side sees the end, only when its task is gone.
            let _ = task.await;
        }
    }
}

/// Passes what one link receives to a tap until the other side leaves.
async fn tapped(mut receiver: Receiver, mut tap: Tap) {
    let mut buffer = BytesMut::with_capacity(4096);
    while matches!(receiver.recv(&mut buffer).await, Ok(1..)) {
        tap.0(&buffer);
        buffer.clear();
    }
}

/// Reads one link until the other side leaves. It also reads bytes without a meaning here, so that the other side
/// never blocks.
async fn listen(link: usize, mut receiver: Receiver, talk: Rc<RefCell<Talk>>, clock: WallClock) {
    let mut buffer = BytesMut::with_capacity(4096);
    while matches!(receiver.recv(&mut buffer).await, Ok(1..)) {
        talk.borrow_mut().hear(link, &buffer, clock.now());
        buffer.clear();
    }
}

/// Reads what a ground station sends, one datagram at a time. A station that is not there yet may come later.
async fn listen_to_ground(mut receiver: Receiver, talk: Rc<RefCell<Talk>>) {
    let mut buffer = BytesMut::with_capacity(4096);
    loop {
        buffer.clear();
        match receiver.recv(&mut buffer).await {
            Ok(1..) => talk.borrow_mut().pass_down(&buffer),
            // A socket reports "port unreachable" here for an earlier datagram.
            Ok(0) | Err(_) => tokio::time::sleep(super::shared::TICK).await,
        }
    }
}

/// Reads datagrams in which a controller tells its attitude. One that is not there yet may come.
async fn overhear(link: usize, mut receiver: Receiver, talk: Rc<RefCell<Talk>>, clock: WallClock) {
    let mut buffer = BytesMut::with_capacity(4096);
    loop {
        buffer.clear();
        match receiver.recv(&mut buffer).await {
            Ok(1..) => talk.borrow_mut().overhear(link, &buffer, clock.now()),
            Ok(0) | Err(_) => tokio::time::sleep(super::shared::TICK).await,
        }
    }
}
