//! What comes back on the links: decoded, set against the truth, kept.

use super::{Shared, Speed, Tap};
use crate::clock::{Clock, WallClock};
use crate::geometry::Attitude;
use crate::link::Receiver;
use crate::scene::Plan;
use crate::score::{AttitudeError, Scorer};
use crate::time::SimTime;
use crate::wire::{Protocol, answer::Listener};
use bytes::BytesMut;
use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// Estimates of all links together.
#[derive(Default)]
pub(super) struct Heard {
    pub scorer: Scorer,
    pub estimates: Vec<(SimTime, Attitude)>,
    pub newest_deg: Option<f64>,
    /// Bytes that were no answer, by link.
    pub damaged: Vec<u64>,
}

/// Hands on what one link receives until the other side leaves.
pub(super) async fn tapped(mut receiver: Receiver, mut tap: Tap) {
    let mut buffer = BytesMut::with_capacity(4096);
    while matches!(receiver.recv(&mut buffer).await, Ok(1..)) {
        tap.0(&buffer);
        buffer.clear();
    }
}

/// What a listening task knows.
pub(super) struct Ear {
    pub plan: Arc<Plan>,
    pub shared: Arc<Shared>,
    pub clock: WallClock,
    pub speed: Speed,
    pub heard: Rc<RefCell<Heard>>,
}

impl Ear {
    /// Reads one link until the other side leaves; what has no meaning here is read all the same, so that nothing
    /// stands in the other side's way.
    pub(super) async fn listen(self, link: usize, protocol: Protocol, mut receiver: Receiver) {
        let mut listener = Listener::new(protocol);
        let mut buffer = BytesMut::with_capacity(4096);
        loop {
            buffer.clear();
            match receiver.recv(&mut buffer).await {
                Ok(0) | Err(_) => return,
                Ok(_) => {}
            }
            let Some(listener) = &mut listener else { continue };
            let now = self.clock.now();
            let mut heard = self.heard.borrow_mut();
            listener.feed(&buffer, |estimate| {
                let truth = self.plan.trajectory.at(estimate.t).attitude;
                let error = AttitudeError::between(truth, estimate.attitude);
                heard.scorer.add(error, self.delay_ms(now, estimate.t));
                heard.newest_deg = Some(error.total.to_degrees());
                heard.estimates.push((estimate.t, estimate.attitude));
            });
            heard.damaged[link] = listener.damaged;
        }
    }

    /// From when the sample was due to now, in real time.
    fn delay_ms(&self, now: i64, t: SimTime) -> Option<f64> {
        let stretched_at = self.shared.stretched_at_ns.load(Ordering::Relaxed);
        let start = self.shared.start_ns.load(Ordering::Relaxed);
        if t.0 < stretched_at {
            // Due by an earlier start than this one.
            return None;
        }
        match self.speed {
            Speed::Times(times) if start >= 0 => Some((now - start) as f64 / 1e6 - t.0 as f64 / 1e6 / times),
            _ => None,
        }
    }
}
