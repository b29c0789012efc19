//! The program under test: `-- COMMAND` with `{}` replaced by the link.

use super::SessionError;
use rustix::process::{Pid, Signal, kill_process};
use std::os::unix::process::ExitStatusExt;
use std::process::{ExitStatus, Stdio};
use std::time::Duration;
use tokio::process::{Child, Command};

/// How long the program may keep running after its link closes, and again after it is asked to end.
const PATIENCE: Duration = Duration::from_secs(2);

/// The program, if there is one.
#[derive(Default)]
pub(super) struct Program(Option<Child>);

impl Program {
    /// Starts a command, if there is one. `link` replaces every `{}` and is also in `$RATETABLE_LINK`.
    pub(super) fn start(command: &[String], link: &str, keep_stdout: bool) -> Result<Program, SessionError> {
        let [program, arguments @ ..] = command else { return Ok(Program(None)) };
        let place = |text: &String| text.replace("{}", link);
        let mut start = Command::new(place(program));
        start.args(arguments.iter().map(place)).env("RATETABLE_LINK", link).kill_on_drop(true);
        if keep_stdout {
            // Standard output carries our JSON, so the program's output goes to standard error with ours.
            start.stdout(rustix::io::dup(rustix::stdio::stderr()).map_or(Stdio::null(), Stdio::from));
        }
        let child = start.spawn();
        let child = child.map_err(|source| SessionError::Command { program: program.clone(), source })?;
        Ok(Program(Some(child)))
    }

    /// Its exit code once it ends by itself; never resolves without a program.
    pub(super) async fn ended(&mut self) -> i32 {
        match &mut self.0 {
            Some(child) => child.wait().await.map_or(1, code),
            None => std::future::pending().await,
        }
    }

    /// Waits for the program after the run is over: `None` if there is none or it had to be killed.
    pub(super) async fn end(self) -> Option<i32> {
        let mut child = self.0?;
        if let Ok(Ok(status)) = tokio::time::timeout(PATIENCE, child.wait()).await {
            return Some(code(status));
        }
        if let Some(pid) = child.id().and_then(|id| Pid::from_raw(id as i32)) {
            let _ = kill_process(pid, Signal::TERM);
        }
        if tokio::time::timeout(PATIENCE, child.wait()).await.is_err() {
            let _ = child.kill().await;
        }
        None
    }
}

/// An exit code as a shell gives it: 128 + the signal that ended it.
fn code(status: ExitStatus) -> i32 {
    status.code().unwrap_or_else(|| 128 + status.signal().unwrap_or(0))
}
