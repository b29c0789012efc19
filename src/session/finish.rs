//! The end of a run: everything joined, taken leave of, closed and added up.

use super::control::{Ended, Run};
use super::links::{self, Account};
use super::pacer::{Left, Pacer};
use super::producer::{Encoders, Made};
use super::tally::{self, LinkTally};
use super::{Outcome, SessionError, Speed, command};
use crate::clock::{Clock, Precise, WallClock};
use crate::link::Sent;
use crate::report::{LinkReport, PacingReport};
use crate::sensor::ByKind;
use crate::time::SimTime;
use std::sync::atomic::Ordering;
use std::thread::{self, JoinHandle};
use std::time::Duration;
use tokio::time::Instant;

/// For answers that are still on their way when the last packet is out.
const LAST_ANSWERS: Duration = Duration::from_millis(200);
/// A link that does not take a farewell for so long does not get it.
const FAREWELL: Duration = Duration::from_secs(1);

/// What was made, what of it is left, and the encoders.
pub(super) type Collected = (Made, Left, Encoders);

impl Run {
    /// Joins the producer, emptying the ring into the count of what was left while it ends.
    pub(super) fn collect(
        &self,
        producer: JoinHandle<(Made, Encoders)>,
        pacer: &mut Pacer<Precise<WallClock>>,
    ) -> Collected {
        self.shared.stop.store(true, Ordering::Relaxed);
        let mut left = Left::nothing(self.job.outputs.len());
        loop {
            // Asked before emptying: what the producer pushed last is then in the ring.
            let over = producer.is_finished();
            left += pacer.left();
            if over {
                break;
            }
            thread::sleep(Duration::from_micros(100));
        }
        let (made, encoders) = producer.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        (made, left, encoders)
    }

    /// Lets the other side take what was sent, closes everything, and adds up.
    pub(super) async fn finish(mut self, ended: Ended) -> Result<Outcome, SessionError> {
        let Ended { mut pacer, links, program, names, granted, made: (mut made, left, encoders) } = ended;
        self.take_leave(&mut pacer, encoders).await;
        for (sender, gone) in pacer.senders.iter_mut().zip(&mut pacer.gone) {
            if let Err(error) = sender.finish() {
                gone.get_or_insert(error.kind());
            }
        }
        let pacing =
            pacer.effort.share().filter(|_| self.job.speed != Speed::Max).map(|share| PacingReport {
                spin_us: pacer.clock.margin().ns() as f64 / 1000.0,
                pacing_cpu: share,
                pinned_cpu: granted.cpu,
            });
        let (mut tallies, gone, stretched) = (pacer.tallies, pacer.gone, pacer.stretched);
        let now = self.clock.now();
        tallies.iter_mut().for_each(|tally| tally.gaps.end(now));
        drop(pacer.senders);
        if self.tapped || !self.talk.borrow().heard.is_empty() {
            tokio::time::sleep(LAST_ANSWERS).await;
        }
        for ear in &self.ears {
            ear.abort();
        }
        for ear in std::mem::take(&mut self.ears) {
            // Only when its task is gone does a link's descriptor close, and the other side see the end.
            let _ = ear.await;
        }
        for link in links {
            link.close().await;
        }
        let command = match (self.ended, program.0) {
            (Some(code), _) => Some(code),
            (None, Some(child)) => command::end(child).await,
            (None, None) => None,
        };
        if let Some(error) = self.failed.take() {
            return Err(error);
        }
        let sum = |rows: &[ByKind<u64>]| -> ByKind<u64> {
            std::array::from_fn(|i| rows.iter().map(|row| row[i]).sum())
        };
        let (total, waiting) = (sum(&made.samples), sum(&made.waiting));
        let queued = std::array::from_fn(|i| left.samples[i] + waiting[i]);
        let paced = self.job.speed != Speed::Max;
        let played = self.played(&gone);
        made.faults.iter_mut().flatten().for_each(|acts| acts.settle(played + self.rest()));
        let judgement = self.talk.borrow().heard.judge(self.job.judging, played);
        Ok(Outcome {
            played,
            interrupted: self.interrupted,
            rest_s: self.rest().seconds(),
            stretched_s: stretched as f64 * 1e-9,
            realtime: granted.priority,
            memory_locked: granted.memory,
            pacing,
            watched: pacer.watching.map(|watching| watching.seen),
            sensors: tally::sensors(&self.job.plan, &tallies, total, queued, paced),
            links: self.link_reports(&tallies, &gone, names, &made, &left),
            faults: links::fired(&self.job.outputs, &made),
            attitude: judgement.figures,
            estimates: judgement.estimates,
            command,
        })
    }

    /// The end if all was played, else where the last packet was due.
    fn played(&self, gone: &[Option<std::io::ErrorKind>]) -> SimTime {
        let stopped = self.interrupted || self.ended.is_some() || self.left.is_some();
        let cut_short = stopped || !gone.contains(&None);
        // An end is exclusive: a nanosecond on, so that the last packet is within.
        let last = self.shared.scene_time(self.sent()).map_or(SimTime::ZERO, |t| t + SimTime(1));
        if cut_short { last.min(self.job.end) } else { self.job.end }
    }

    /// Stream time of the last packet.
    fn sent(&self) -> SimTime {
        SimTime(self.shared.stream_ns.load(Ordering::Relaxed))
    }

    /// For how long the vehicle was held still.
    fn rest(&self) -> SimTime {
        SimTime(self.shared.scene_starts_ns.load(Ordering::Relaxed)).min(self.sent())
    }

    /// Leaves every other side with a vehicle that has stopped.
    async fn take_leave(&self, pacer: &mut Pacer<Precise<WallClock>>, mut encoders: Encoders) {
        let t = self.sent() + SimTime(1);
        let deadline = Instant::now() + FAREWELL;
        let mut packets = Vec::new();
        for (output, encoder) in encoders.iter_mut().enumerate() {
            packets.clear();
            encoder.farewell(t, &mut packets);
            for packet in packets.iter().filter(|_| pacer.gone[output].is_none()) {
                let sent = loop {
                    match pacer.senders[output].send(packet.bytes()) {
                        Sent::Full if Instant::now() < deadline => {
                            tokio::time::sleep(super::control::TICK).await
                        }
                        sent => break sent,
                    }
                };
                pacer.tallies[output].replies += u64::from(sent == Sent::Done);
            }
        }
    }

    fn link_reports(
        &self,
        tallies: &[LinkTally],
        gone: &[Option<std::io::ErrorKind>],
        names: Vec<String>,
        made: &Made,
        left: &Left,
    ) -> Vec<LinkReport> {
        let (damaged, replies) = (&self.talk.borrow().damaged(), &self.talk.borrow().replies());
        let (outputs, lookout, abandoned) = (&self.job.outputs, &self.lookout, self.left);
        Account { outputs, names, tallies, gone, made, left, lookout, damaged, replies, abandoned }.reports()
    }

    pub(super) fn never_started(&self, names: Vec<String>) -> Outcome {
        let tallies: Vec<_> = names.iter().map(|_| LinkTally::new()).collect();
        let gone = vec![None; names.len()];
        Outcome {
            played: SimTime::ZERO,
            interrupted: self.interrupted,
            rest_s: 0.0,
            stretched_s: 0.0,
            realtime: false,
            memory_locked: false,
            pacing: None,
            watched: None,
            sensors: tally::sensors(&self.job.plan, &tallies, ByKind::default(), ByKind::default(), false),
            links: self.link_reports(&tallies, &gone, names, &Made::default(), &Left::nothing(gone.len())),
            faults: Vec::new(),
            attitude: None,
            estimates: Vec::new(),
            command: self.ended,
        }
    }
}
