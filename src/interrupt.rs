//! The signals that end work: Ctrl-C (SIGINT), SIGTERM, and SIGHUP, which comes when the terminal is closed.
//!
//! The first of them lets work end cleanly: what is there is written, what was made for the while is removed. A second
//! Ctrl-C ends the program at once. SIGHUP is left alone where the program was started to outlive its terminal, as by
//! `nohup`.
//!
//! ```
//! use std::sync::atomic::Ordering;
//!
//! let stop = ratetable::interrupt::on_interrupt();
//! let mut done = 0;
//! while done < 3 && !stop.load(Ordering::Relaxed) {
//!     done += 1;
//! }
//! assert_eq!(done, 3);
//! ```

use crate::os;
use std::io;
use std::process;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock, mpsc};
use std::time::Duration;
use tokio::signal::unix::{Signal, SignalKind, signal};
use tokio::sync::watch;

/// The exit code after a second Ctrl-C: 128 and the number of SIGINT.
const AT_ONCE: i32 = 130;
/// A second Ctrl-C that comes as close behind the first is the same one: whoever ends a group of processes may send it
/// to each and to the group.
const SAME: Duration = Duration::from_millis(50);

/// What the process has been told.
#[derive(Clone, Debug)]
struct Told {
    flag: Arc<AtomicBool>,
    raised: watch::Receiver<bool>,
}

/// One for the whole process; why not, where the system does not let us listen.
static TOLD: OnceLock<Result<Told, io::ErrorKind>> = OnceLock::new();

/// Whether somebody ends the work.
#[derive(Debug)]
pub struct Interrupt(Told);

impl Interrupt {
    /// Listens from now on, in the whole process.
    ///
    /// # Errors
    /// The system does not let us.
    pub fn listen() -> io::Result<Interrupt> {
        TOLD.get_or_init(|| start().map_err(|error| error.kind())).clone().map(Interrupt).map_err(Into::into)
    }

    /// Returns when it was raised; at once ever after.
    pub async fn recv(&mut self) {
        if self.0.raised.wait_for(|raised| *raised).await.is_err() {
            std::future::pending().await
        }
    }
}

/// A flag that is raised when somebody ends the work. Where the system does not let us listen, signals end the program
/// at once, as without this.
pub fn on_interrupt() -> Arc<AtomicBool> {
    Interrupt::listen().map_or_else(|_| Arc::default(), |interrupt| interrupt.0.flag)
}

/// Starts the thread that listens, and returns once it does.
fn start() -> io::Result<Told> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    let (raise, raised) = watch::channel(false);
    let flag = Arc::new(AtomicBool::new(false));
    let (told, (tell, ready)) = (Told { flag: flag.clone(), raised }, mpsc::channel());
    let body = move || {
        runtime.block_on(async {
            match Signals::new() {
                Ok(signals) => {
                    let _ = tell.send(Ok(()));
                    attend(signals, &flag, &raise).await;
                }
                Err(error) => drop(tell.send(Err(error))),
            }
        });
    };
    std::thread::Builder::new().name("signals".into()).spawn(body)?;
    let answer =
        ready.recv().unwrap_or_else(|_| Err(io::Error::other("the thread that listens for signals ended")));
    answer.map(|()| told)
}

async fn attend(mut signals: Signals, flag: &AtomicBool, raise: &watch::Sender<bool>) {
    signals.any().await;
    flag.store(true, Ordering::Relaxed);
    let _ = raise.send(true);
    let _ = tokio::time::timeout(SAME, signals.forever()).await;
    signals.interrupt.recv().await;
    process::exit(AT_ONCE);
}

struct Signals {
    interrupt: Signal,
    terminate: Signal,
    hang_up: Option<Signal>,
}

impl Signals {
    fn new() -> io::Result<Signals> {
        // Asked before: listening to a signal is the end of ignoring it.
        let hang_up = (!os::ignores_hang_up()).then(|| signal(SignalKind::hangup())).transpose()?;
        Ok(Signals {
            interrupt: signal(SignalKind::interrupt())?,
            terminate: signal(SignalKind::terminate())?,
            hang_up,
        })
    }

    async fn any(&mut self) {
        let hung_up = async {
            match &mut self.hang_up {
                Some(signal) => signal.recv().await,
                None => std::future::pending().await,
            }
        };
        tokio::select! { _ = self.interrupt.recv() => {}, _ = self.terminate.recv() => {}, _ = hung_up => {} }
    }

    /// Takes every Ctrl-C in.
    async fn forever(&mut self) {
        loop {
            self.interrupt.recv().await;
        }
    }
}
