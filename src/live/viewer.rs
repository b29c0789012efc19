//! One viewer: what waits to be sent to it, in bounded memory, and what it said.

use super::foxglove::Subscriber;
use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use tokio::sync::Notify;
use tokio_tungstenite::tungstenite::Message;

/// Bytes that wait for a viewer, at most; the oldest messages go first.
const BYTES: usize = 4 << 20;
/// Messages that wait for a viewer, at most.
const MESSAGES: usize = 8192;

/// What a viewer is.
pub(super) enum Kind {
    /// The page; whether it has been told what there is so far.
    Page(Cell<bool>),
    /// A viewer of another make.
    Foxglove(RefCell<Subscriber>),
}

/// One viewer.
pub(super) struct Viewer {
    pub kind: Kind,
    waiting: RefCell<VecDeque<Message>>,
    bytes: Cell<usize>,
    /// Messages that it was too slow for, and how many of them it was told of.
    lost: Cell<u64>,
    told: Cell<u64>,
    /// Nothing more comes.
    over: Cell<bool>,
    more: Notify,
}

impl Viewer {
    /// One that has just come.
    pub(super) fn new(kind: Kind) -> Viewer {
        Viewer {
            kind,
            waiting: RefCell::default(),
            bytes: Cell::default(),
            lost: Cell::default(),
            told: Cell::default(),
            over: Cell::default(),
            more: Notify::new(),
        }
    }

    /// Has a message wait for it; its oldest ones are lost where too many do.
    pub(super) fn put(&self, message: Message) {
        let mut waiting = self.waiting.borrow_mut();
        self.bytes.set(self.bytes.get() + message.len());
        waiting.push_back(message);
        while waiting.len() > 1 && (waiting.len() > MESSAGES || self.bytes.get() > BYTES) {
            let oldest = waiting.pop_front().map_or(0, |oldest| oldest.len());
            self.bytes.set(self.bytes.get() - oldest);
            self.lost.set(self.lost.get() + 1);
        }
        self.more.notify_one();
    }

    /// How many messages it was too slow for so far; `None` where that is what it was told.
    pub(super) fn lost(&self) -> Option<u64> {
        let lost = self.lost.get();
        (self.told.replace(lost) != lost).then_some(lost)
    }

    /// Nothing more comes: it is let go once it has everything.
    pub(super) fn finish(&self) {
        self.over.set(true);
        self.more.notify_one();
    }

    /// Forgets what waits: something else replaces it.
    pub(super) fn forget(&self) {
        self.waiting.borrow_mut().clear();
        self.bytes.set(0);
    }

    /// Whether nothing waits and nothing more comes.
    pub(super) fn is_done(&self) -> bool {
        self.over.get() && self.waiting.borrow().is_empty()
    }

    /// The next message, once there is one; `None` when nothing more comes.
    pub(super) async fn next(&self) -> Option<Message> {
        loop {
            if let Some(message) = self.waiting.borrow_mut().pop_front() {
                self.bytes.set(self.bytes.get() - message.len());
                return Some(message);
            }
            if self.over.get() {
                return None;
            }
            self.more.notified().await;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slow_viewer_loses_its_own_oldest_and_they_are_counted() {
        let viewer = Viewer::new(Kind::Page(Cell::new(false)));
        (0..MESSAGES + 10).for_each(|i| viewer.put(Message::text(i.to_string())));
        assert_eq!((viewer.lost(), viewer.lost()), (Some(10), None), "told once");
        let runtime = tokio::runtime::Builder::new_current_thread().build().unwrap();
        let first = runtime.block_on(viewer.next()).unwrap();
        assert_eq!(first.to_text().unwrap(), "10");
        // One that is longer than all the room there is gets through by itself.
        viewer.put(Message::text("x".repeat(2 * BYTES)));
        assert_eq!((viewer.lost(), viewer.waiting.borrow().len()), (Some(MESSAGES as u64 + 9), 1), "in all");
        assert!(!viewer.is_done());
        viewer.finish();
        assert!(runtime.block_on(viewer.next()).is_some() && viewer.is_done());
        assert!(runtime.block_on(viewer.next()).is_none());
        assert_eq!(viewer.bytes.get(), 0);
    }
}
