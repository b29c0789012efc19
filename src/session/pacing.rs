//! The control side's handle on the pacing thread.

use super::SessionError;
use super::granted::Granted;
use super::pacer::Pacer;
use crate::clock::{Clock, Precise, WallClock};
use std::thread::{self, JoinHandle, Thread};
use tokio::sync::oneshot;

/// Time from the start of the thread to stream time 0.
const LEAD: i64 = 5_000_000;

/// The pacer of a live run.
pub(super) type LivePacer = Pacer<Precise<WallClock>>;

/// A running pacing thread.
pub(super) struct Pacing {
    thread: JoinHandle<(LivePacer, Granted)>,
    refused: oneshot::Receiver<Option<String>>,
    over: oneshot::Receiver<()>,
}

impl Pacing {
    /// Starts the thread on this processor.
    pub(super) fn start(mut pacer: LivePacer, cpu: Option<usize>) -> Result<Pacing, SessionError> {
        let (tell, refused) = oneshot::channel();
        let (end, over) = oneshot::channel();
        let body = move || {
            let paced = pacer.pace.speed.is_paced();
            let granted = if paced { Granted::ask(cpu) } else { Granted::default() };
            let _ = tell.send(granted.refused.clone());
            pacer.run(pacer.pace.clock.now() + LEAD);
            let _ = end.send(());
            (pacer, granted)
        };
        let thread = thread::Builder::new().name("pacing".into()).spawn(body);
        let thread =
            thread.map_err(|source| SessionError::System { doing: "start the pacing thread", source })?;
        Ok(Pacing { thread, refused, over })
    }

    /// The thread to wake.
    pub(super) fn thread(&self) -> Thread {
        self.thread.thread().clone()
    }

    /// What the system refused, once the thread has asked for it. Call it once.
    pub(super) async fn refused(&mut self) -> Option<String> {
        (&mut self.refused).await.ok().flatten()
    }

    /// Returns when everything is sent or the thread was told to stop. Do not call it again after that.
    pub(super) async fn over(&mut self) {
        let _ = (&mut self.over).await;
    }

    /// Waits for the thread to end.
    pub(super) fn join(self) -> (LivePacer, Granted) {
        self.thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    }
}
