//! Ctrl-C for work without a live loop.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use tokio::signal::unix::{SignalKind, signal};

/// A flag that Ctrl-C (SIGINT) or SIGTERM raises, so that work in progress can end cleanly. Where the system
/// refuses to listen for signals they end the program at once, as without this.
pub fn on_interrupt() -> Arc<AtomicBool> {
    let raised = Arc::new(AtomicBool::new(false));
    let raise = raised.clone();
    std::thread::spawn(move || {
        let Ok(runtime) = tokio::runtime::Builder::new_current_thread().enable_all().build() else { return };
        runtime.block_on(async {
            let (Ok(mut interrupt), Ok(mut end)) =
                (signal(SignalKind::interrupt()), signal(SignalKind::terminate()))
            else {
                return;
            };
            tokio::select! { _ = interrupt.recv() => {}, _ = end.recv() => {} }
            raise.store(true, Ordering::Relaxed);
        });
    });
    raised
}
