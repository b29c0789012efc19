//! A run whose driver asks: the scene's chips behind a bridge, served on a thread of their own.
//!
//! Nothing is paced. The serving thread waits for bytes, plays the scene up to now, answers at once, and goes on. Every
//! millisecond it plays on without being asked, so that an answer never waits for much.

mod hints;
mod serve;
mod served;

use super::bus::serve::{Serving, Task};
use super::bus::served::Served;
use super::command::Program;
use super::control::Control;
use super::outside::Outside;
use super::{Event, Job, Outcome, Progress, SessionError};
use crate::bus::Change;
use crate::scene::Output;
use crate::wire::Protocol;
use std::sync::atomic::Ordering;
use std::time::Duration;
use tokio::sync::mpsc::{UnboundedReceiver, unbounded_channel};
use tokio::time::{interval, sleep};

/// Time between two progress reports, and between two looks at what conversations have due.
const PROGRESS: Duration = Duration::from_millis(100);

/// What the serving thread tells.
enum News {
    /// Its link is open: what to connect to.
    Open(String),
    /// The driver has set a sensor.
    Set(Box<Change>),
    /// Something the user should know.
    Notice(String),
    /// Somebody may have to be waited for.
    Waiting(Duration),
    /// It is served, and the vehicle is at rest.
    Still,
    /// A first sample was read, and the scene begins.
    Started,
    /// It is over.
    Over(Box<Result<Served, SessionError>>),
}

/// The output that is a bus, if there is one.
pub(super) fn of(job: &Job) -> Option<&Output> {
    job.outputs.iter().find(|output| output.to.protocol == Protocol::Bus)
}

/// Serves the bus of a run to its end. `control` holds the other outputs, on which nothing is sent.
pub(super) async fn run(
    control: Control,
    bus: Output,
    mut outside: Outside<'_>,
) -> Result<Outcome, SessionError> {
    let (tell, mut news) = unbounded_channel();
    let task = Task {
        plan: control.job.plan.clone(),
        output: bus,
        end: control.job.end,
        rest: control.job.rest.unwrap_or_default(),
        speed: control.job.speed,
        wait: control.job.wait,
        cpu: control.job.cpu,
    };
    let serving = Serving::start(task, control.shared.clone(), control.clock, tell)?;
    let served = attend(&control, &mut news, &mut outside).await;
    // The thread ends once it is told to.
    control.shared.stop.store(true, Ordering::Relaxed);
    let served = match served {
        Some(served) => served,
        None => last(&mut news).await,
    };
    serving.join();
    control.finish_bus(outside, served?).await
}

/// What the thread says in the end, once it was told to stop.
async fn last(news: &mut UnboundedReceiver<News>) -> Result<Served, SessionError> {
    while let Some(new) = news.recv().await {
        if let News::Over(served) = new {
            return *served;
        }
    }
    Ok(Served::default())
}

/// Passes news on to the user until the thread is over, which it gives back, or the user or the command ends it.
async fn attend(
    control: &Control,
    news: &mut UnboundedReceiver<News>,
    outside: &mut Outside<'_>,
) -> Option<Result<Served, SessionError>> {
    let mut ticks = interval(PROGRESS);
    let mut name = String::new();
    loop {
        tokio::select! {
            new = news.recv() => match new? {
                News::Open(at) => {
                    outside.tell(Event::Ready(&format!("{}@{at}", Protocol::Bus.name())));
                    match Program::start(&control.job.command, &at, control.job.keep_stdout) {
                        Ok(program) => outside.program = program,
                        Err(error) => return Some(Err(error)),
                    }
                    name = at;
                }
                News::Set(change) => outside.tell(Event::Set(&change)),
                News::Notice(notice) => outside.notice(notice),
                News::Waiting(left) => {
                    outside.tell(Event::Waiting { whom: &format!("a driver to open {name}"), left });
                }
                News::Still => outside.tell(Event::Still),
                News::Started => outside.tell(Event::Started),
                News::Over(served) => return Some(*served),
            },
            _ = ticks.tick() => {
                control.tick(outside);
                outside.tell(Event::Progress(Progress { dropped: 0, ..control.progress() }));
                control.tell_more(outside);
            }
            () = outside.ends() => return None,
        }
    }
}

impl Control {
    /// Closes everything, and says what came of it.
    async fn finish_bus(mut self, outside: Outside<'_>, served: Served) -> Result<Outcome, SessionError> {
        if self.talk.borrow().has_estimates() {
            sleep(super::control::LAST_ANSWERS).await;
        }
        self.ears.close().await;
        let played = served.played;
        let mut outcome = Outcome { speed: self.job.speed, ..served.outcome(&self.job.plan) };
        outcome.links.extend(self.silent_links());
        for output in self.outputs {
            output.close().await;
        }
        outcome.interrupted = outside.interrupted;
        outcome.command = outside.finish().await;
        let judgement = self.talk.borrow().judge(self.job.judging, played);
        Ok(Outcome { attitude: judgement.figures, estimates: judgement.estimates, ..outcome })
    }
}

#[cfg(test)]
mod tests;
