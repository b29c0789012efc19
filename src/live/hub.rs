//! Everybody who looks on, and what each is told.

use super::about::About;
use super::batch::Batch;
use super::foxglove::{Channels, Subscriber};
use super::story::{Story, json};
use super::viewer::{Kind, Viewer};
use crate::ros::Status;
use crate::time::SimTime;
use std::cell::{Cell, RefCell};
use std::rc::Rc;
use tokio_tungstenite::tungstenite::{Message, Utf8Bytes};

/// Everybody who looks on.
pub(super) struct Hub {
    viewers: RefCell<Vec<Rc<Viewer>>>,
    channels: RefCell<Channels>,
    session: String,
    /// Set once nobody is let in any more.
    closed: Cell<bool>,
}

impl Hub {
    /// Nobody yet; `session` tells this run from others.
    pub(super) fn new(about: &About, session: String) -> Hub {
        Hub {
            viewers: RefCell::default(),
            channels: RefCell::new(Channels::new(about, None)),
            session,
            closed: Cell::new(false),
        }
    }

    /// The page has come.
    pub(super) fn page(&self) -> Rc<Viewer> {
        self.add(Viewer::new(Kind::Page(Cell::new(false))))
    }

    /// A viewer of another make has come.
    pub(super) fn foxglove(&self) -> Rc<Viewer> {
        let channels = self.channels.borrow();
        let viewer = Viewer::new(Kind::Foxglove(RefCell::new(Subscriber::new())));
        viewer.put(Message::text(channels.server_info(&self.session)));
        viewer.put(Message::text(channels.advertise()));
        drop(channels);
        self.add(viewer)
    }

    fn add(&self, viewer: Viewer) -> Rc<Viewer> {
        let viewer = Rc::new(viewer);
        if self.closed.get() {
            viewer.finish();
        }
        self.viewers.borrow_mut().push(viewer.clone());
        viewer
    }

    /// A viewer has gone.
    pub(super) fn remove(&self, gone: &Rc<Viewer>) {
        self.viewers.borrow_mut().retain(|viewer| !Rc::ptr_eq(viewer, gone));
    }

    /// A viewer of another make said something.
    pub(super) fn hear(&self, viewer: &Viewer, message: &Message) {
        let Kind::Foxglove(subscriber) = &viewer.kind else { return };
        let channels = self.channels.borrow();
        let answers = match message {
            Message::Text(text) => subscriber.borrow_mut().hear(&channels, text.as_str()),
            Message::Binary(bytes) => subscriber.borrow_mut().hear_binary(bytes),
            _ => Vec::new(),
        };
        answers.into_iter().for_each(|answer| viewer.put(Message::text(answer)));
    }

    /// Whether anybody looks on.
    pub(super) fn is_watched(&self) -> bool {
        !self.viewers.borrow().is_empty()
    }

    /// Whether a viewer of another make looks on.
    pub(super) fn has_subscribers(&self) -> bool {
        self.viewers.borrow().iter().any(|viewer| matches!(viewer.kind, Kind::Foxglove(_)))
    }

    /// Sensors have come: everybody is told anew what there is.
    pub(super) fn renew(&self, about: &About) {
        let channels = Channels::new(about, Some(&self.channels.borrow()));
        let before = self.channels.borrow().unadvertise();
        for viewer in self.viewers.borrow().iter() {
            match &viewer.kind {
                Kind::Page(told) => told.set(false),
                Kind::Foxglove(subscriber) => {
                    viewer.put(Message::text(before.clone()));
                    subscriber.borrow_mut().forget();
                    viewer.put(Message::text(channels.advertise()));
                }
            }
        }
        *self.channels.borrow_mut() = channels;
    }

    /// Tells pages what is new, and those that have just come everything so far.
    pub(super) fn tell_pages(&self, story: &mut Story) {
        let viewers = self.viewers.borrow();
        let pages = viewers.iter().filter_map(|viewer| match &viewer.kind {
            Kind::Page(told) => Some((viewer, told)),
            Kind::Foxglove(_) => None,
        });
        let (known, new): (Vec<_>, Vec<_>) = pages.partition(|(_, told)| told.get());
        if !new.is_empty() {
            let (begin, so_far) = (Utf8Bytes::from(story.begin()), Utf8Bytes::from(story.so_far()));
            for (viewer, told) in new {
                told.set(true);
                viewer.forget();
                viewer.put(Message::Text(begin.clone()));
                viewer.put(Message::Text(so_far.clone()));
            }
        }
        if known.is_empty() {
            return story.skip_news();
        }
        let news = Utf8Bytes::from(story.news());
        for (viewer, _) in known {
            if let Some(lost) = viewer.lost() {
                viewer.put(Message::text(format!(r#"{{"kind":"more","lost":{lost}}}"#)));
            }
            viewer.put(Message::Text(news.clone()));
        }
    }

    /// Tells viewers of another make what they have subscribed to, up to `now`, and how things are then.
    pub(super) fn tell_subscribers(&self, now: Option<SimTime>, batch: &Batch, status: Option<&[Status]>) {
        let viewers = self.viewers.borrow();
        let subscribers: Vec<_> = viewers
            .iter()
            .filter_map(|viewer| match &viewer.kind {
                Kind::Foxglove(subscriber) => Some((viewer, subscriber)),
                Kind::Page(_) => None,
            })
            .collect();
        if subscribers.is_empty() {
            return;
        }
        let wanted = |channel: u32| subscribers.iter().any(|(_, it)| it.borrow().wants(channel));
        let mut out = |channel: u32, t: SimTime, payload: &[u8]| {
            for (viewer, subscriber) in &subscribers {
                let mut subscriber = subscriber.borrow_mut();
                if subscriber.wants(channel) {
                    // What a firmware says of the future is sent as it is, and does not move the time.
                    let time = now.and_then(|now| subscriber.time(t.min(now)));
                    time.into_iter().for_each(|frame| viewer.put(Message::binary(frame)));
                    subscriber.frames(channel, t, payload, &mut |frame| viewer.put(Message::binary(frame)));
                }
            }
        };
        let channels = self.channels.borrow();
        channels.messages(batch, &wanted, &mut out);
        if let Some((now, status)) = now.zip(status) {
            channels.diagnostics(now, status, &wanted, &mut out);
        }
    }

    /// Tells everybody what came of it, and that nothing more comes.
    pub(super) fn end(&self, story: &Story) {
        self.closed.set(true);
        let end = story.end.as_ref().map(|end| Utf8Bytes::from(json(end)));
        for viewer in self.viewers.borrow().iter() {
            if let (Kind::Page(_), Some(end)) = (&viewer.kind, &end) {
                viewer.put(Message::Text(end.clone()));
            }
            viewer.finish();
        }
    }

    /// Whether everybody has everything.
    pub(super) fn is_done(&self) -> bool {
        self.viewers.borrow().iter().all(|viewer| viewer.is_done())
    }
}
