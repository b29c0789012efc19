//! The control side's handle on the producer thread.

use super::feed::Feed;
use super::pacer::Pacer;
use super::producer::{self, Task};
use super::ring::Inlet;
use super::{Job, Shared};
use crate::clock::Clock;
use crate::wire::dialogue::Peer;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::Receiver;
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Time between two looks at whether it has ended.
const LOOK: Duration = Duration::from_micros(100);

/// The thread, or the ring that it will fill once it starts.
pub(super) enum Producing {
    NotYet(Inlet),
    Started(JoinHandle<Vec<Feed>>),
}

impl Producing {
    /// Starts it with what is known of the other side of each output, and where that may change, how it is told; if it
    /// is not started yet.
    pub(super) fn start(
        self,
        job: &Job,
        shared: &Arc<Shared>,
        peers: impl Iterator<Item = (Peer, Option<Receiver<Peer>>)>,
    ) -> Producing {
        let Producing::NotYet(ring) = self else { return self };
        let outputs = job.outputs.iter().zip(peers).enumerate();
        let feeds = outputs.map(|(i, (output, (peer, news)))| {
            let mut feed = Feed::new(&job.plan, i, output, peer);
            news.into_iter().for_each(|news| feed.listen(news));
            feed
        });
        let feeds = feeds.collect();
        let (plan, end, rest, shared) = (job.plan.clone(), job.end, job.rest, shared.clone());
        Producing::Started(thread::spawn(move || {
            producer::produce(Task { plan: &plan, end, rest }, feeds, ring, &shared)
        }))
    }

    /// Ends the thread before anything is sent, after a stop and with nobody reading the ring.
    pub(super) fn abandon(self) {
        if let Producing::Started(thread) = self {
            let _ = thread.join();
        }
    }

    /// Stops and joins the thread; meanwhile empties the ring into the count of what was left.
    pub(super) fn collect<C: Clock>(self, pacer: &mut Pacer<C>) -> Vec<Feed> {
        let Producing::Started(thread) = self else { return Vec::new() };
        pacer.pace.shared.stop.store(true, Ordering::Relaxed);
        loop {
            // Ask before emptying: then the ring holds what the producer pushed last.
            let over = thread.is_finished();
            pacer.give_up();
            if over {
                break;
            }
            thread::sleep(LOOK);
        }
        thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    }
}
