//! The pacing thread, as the control side holds it.

use super::SessionError;
use super::granted::Granted;
use super::pacer::Pacer;
use crate::clock::{Clock, Precise, WallClock};
use std::thread::{self, JoinHandle, Thread};
use tokio::sync::oneshot;

/// From the start of the thread to stream time 0.
const LEAD: i64 = 5_000_000;

/// What it works with.
pub(super) type LivePacer = Pacer<Precise<WallClock>>;

/// The thread.
pub(super) struct Pacing {
    thread: JoinHandle<(LivePacer, Granted)>,
    refused: oneshot::Receiver<Option<String>>,
    over: oneshot::Receiver<()>,
}

impl Pacing {
    /// Starts it, on this processor.
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

    /// To wake it with.
    pub(super) fn thread(&self) -> Thread {
        self.thread.thread().clone()
    }

    /// What the system did not allow it, once it has asked; to be called once.
    pub(super) async fn refused(&mut self) -> Option<String> {
        (&mut self.refused).await.ok().flatten()
    }

    /// Returns when all is sent or it was told to stop; to be called until then.
    pub(super) async fn over(&mut self) {
        let _ = (&mut self.over).await;
    }

    /// Waits for its end.
    pub(super) fn join(self) -> (LivePacer, Granted) {
        self.thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    }
}
