//! Before the stream: until somebody is on every link, and until every controller has been heard.

use super::control::{Program, Run, TICK};
use super::{Event, SessionError};
use crate::clock::Clock;
use crate::interrupt::Interrupt;
use crate::link::{Address, Link};
use std::pin::pin;
use std::time::Duration;
use tokio::time::{Instant, sleep, timeout_at};

/// Who comes within this is not told to be waited for: a command or a demonstration opens its link by itself.
const PATIENCE: Duration = Duration::from_millis(500);

/// What ended a wait.
enum Woke<T> {
    Done(T),
    Interrupted,
    CommandEnded,
}

/// Who has to come to a link.
fn whom(address: &Address, name: &str) -> String {
    match address {
        Address::TcpIn(_) => format!("somebody to connect to {name}"),
        Address::UdpIn(_) => format!("somebody to send to {name}"),
        _ => format!("a reader to open {name}"),
    }
}

impl Run {
    /// True when somebody is on every link; false when the user or the command ended the wait.
    pub(super) async fn wait_for_peers(
        &mut self,
        on: &mut dyn FnMut(Event<'_>),
        links: &mut [Link],
        signals: &mut Interrupt,
        program: &mut Program,
    ) -> Result<bool, SessionError> {
        if self.job.wait.is_zero() {
            return Ok(true);
        }
        let waited = self.job.wait;
        let deadline = Instant::now() + waited;
        for (i, link) in links.iter_mut().enumerate() {
            let name = link.name().to_string();
            let whom = whom(&self.job.outputs[i].to.address, &name);
            let mut peer = pin!(timeout_at(deadline, link.peer()));
            let mut patience = pin!(sleep(PATIENCE));
            let mut told = false;
            let woke = loop {
                tokio::select! {
                    peer = &mut peer => break Woke::Done(peer),
                    () = signals.recv() => break Woke::Interrupted,
                    code = program.ended() => {
                        self.ended = Some(code);
                        break Woke::CommandEnded;
                    }
                    () = &mut patience, if !told => {
                        told = true;
                        on(Event::Waiting { whom: whom.clone(), left: deadline - Instant::now() });
                    }
                }
            };
            match woke {
                Woke::Done(Ok(peer)) => peer?,
                Woke::Done(Err(_)) => return Err(SessionError::Nobody { link: name, waited }),
                Woke::Interrupted => {
                    self.interrupted = true;
                    return Ok(false);
                }
                Woke::CommandEnded => return Ok(false),
            }
        }
        Ok(true)
    }

    /// True when every other side may be sent samples; false when the user or the command ended the wait.
    pub(super) async fn wait_to_be_heard(
        &mut self,
        on: &mut dyn FnMut(Event<'_>),
        names: &[String],
        signals: &mut Interrupt,
        program: &mut Program,
    ) -> Result<bool, SessionError> {
        let waited = self.job.wait;
        let deadline = Instant::now() + waited;
        let mut ticks = tokio::time::interval(TICK);
        let mut told = false;
        loop {
            self.tick(on);
            let Some(link) = self.talk.borrow().silent().filter(|_| !waited.is_zero()) else {
                return Ok(true);
            };
            if Instant::now() >= deadline {
                let came = self.talk.borrow().what_came(link);
                return Err(SessionError::Unheard { link: names[link].clone(), waited, came });
            }
            if !std::mem::replace(&mut told, true) {
                on(Event::Silent(&names[link]));
            }
            tokio::select! {
                _ = ticks.tick() => {}
                () = signals.recv() => {
                    self.interrupted = true;
                    return Ok(false);
                }
                code = program.ended() => {
                    self.ended = Some(code);
                    return Ok(false);
                }
            }
        }
    }

    /// Tells of a controller that asks for more than the scene has.
    pub(super) fn compare_rates(&self, on: &mut dyn FnMut(Event<'_>)) {
        let Some(fastest) =
            self.job.plan.sensors.iter().max_by(|a, b| a.rate.as_hz().total_cmp(&b.rate.as_hz()))
        else {
            return;
        };
        let asked = self.talk.borrow().peers().into_iter().filter_map(|peer| peer.rate);
        for rate in asked.filter(|rate| rate.as_hz() > fastest.rate.as_hz()) {
            on(Event::Notice(format!(
                "the controller asks for {rate}, and the scene's fastest sensor, {}, has {}: --set {}.rate='{rate}' gives it all",
                fastest.kind, fastest.rate, fastest.kind
            )));
        }
    }

    /// What is due by itself, and what the other sides gave notice of.
    pub(super) fn tick(&mut self, on: &mut dyn FnMut(Event<'_>)) {
        self.talk.borrow_mut().tick(self.clock.now());
        let notices = self.talk.borrow_mut().take_notices();
        notices.into_iter().for_each(|notice| on(Event::Notice(notice)));
    }
}
