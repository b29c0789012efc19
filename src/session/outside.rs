//! Everything outside a run: the user, who gets its events and can stop it, and the program under test, whose end
//! stops it.

use super::command::Program;
use super::{Event, SessionError};
use crate::interrupt::Interrupt;

/// The user and the program under test.
pub(super) struct Outside<'a> {
    on: &'a mut dyn FnMut(Event<'_>),
    signals: Interrupt,
    pub program: Program,
    /// The user ended the run.
    pub interrupted: bool,
    /// The program's exit code, if it ended by itself.
    pub ended: Option<i32>,
}

impl Outside<'_> {
    /// Listens for Ctrl-C from now on; there is no program yet.
    pub(super) fn new(on: &mut dyn FnMut(Event<'_>)) -> Result<Outside<'_>, SessionError> {
        let signals = Interrupt::listen();
        let signals =
            signals.map_err(|source| SessionError::System { doing: "listen for Ctrl-C", source })?;
        Ok(Outside { on, signals, program: Program::default(), interrupted: false, ended: None })
    }

    /// Passes an event to the user.
    pub(super) fn tell(&mut self, event: Event<'_>) {
        (self.on)(event);
    }

    /// Passes a notice to the user.
    pub(super) fn notice(&mut self, notice: String) {
        self.tell(Event::Notice(notice));
    }

    /// Returns once when the user ends the run, and once when the program ends.
    pub(super) async fn ends(&mut self) {
        tokio::select! {
            () = self.signals.recv(), if !self.interrupted => self.interrupted = true,
            code = self.program.ended(), if self.ended.is_none() => self.ended = Some(code),
            else => std::future::pending().await,
        }
    }

    /// Whether either has ended the run.
    pub(super) fn has_ended(&self) -> bool {
        self.interrupted || self.ended.is_some()
    }

    /// Waits for the program after the run is over: its exit code, or `None` if it had to be killed.
    pub(super) async fn finish(self) -> Option<i32> {
        match self.ended {
            Some(code) => Some(code),
            None => self.program.end().await,
        }
    }
}
