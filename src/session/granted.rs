//! What the pacing thread asks of the system, and what it gets.

use crate::os;

/// Real-time priority of the pacing thread: above ordinary work, below the kernel's own threads.
const PRIORITY: i32 = 50;

/// What the system granted the pacing thread.
#[derive(Clone, Debug, Default)]
pub(super) struct Granted {
    pub priority: bool,
    pub memory: bool,
    /// The processor it is bound to.
    pub cpu: Option<usize>,
    /// One notice: what the system refused, and what would make it possible.
    pub refused: Option<String>,
}

impl Granted {
    /// Asks for real-time priority, punctual sleeps and the processor `cpu` for the calling thread, and for locked
    /// memory for the process.
    pub(super) fn ask(cpu: Option<usize>) -> Granted {
        let priority = os::set_realtime_priority(PRIORITY);
        let memory = os::lock_memory();
        // Without real-time priority the kernel may wake a thread up to 50 µs late, to wake several together.
        os::set_punctual_sleep();
        let bound = cpu.map_or(Ok(()), |cpu| os::set_affinity(&[cpu]));
        let mut notices = Vec::new();
        let refused: Vec<_> = [("real-time priority", &priority), ("locked memory", &memory)]
            .into_iter()
            .filter_map(|(what, granted)| granted.as_ref().err().map(|error| format!("{what} ({error})")))
            .collect();
        if !refused.is_empty() {
            notices.push(format!(
                "not granted: {}; packets may be later on a busy machine. To grant it: `sudo setcap cap_sys_nice,cap_ipc_lock+ep` on this program, or `rtprio 50` and `memlock unlimited` in /etc/security/limits.conf",
                refused.join(", ")
            ));
        }
        if let (Some(cpu), Err(error)) = (cpu, &bound) {
            notices.push(format!("the pacing thread could not be bound to processor {cpu}: {error}"));
        }
        Granted {
            priority: priority.is_ok(),
            memory: memory.is_ok(),
            cpu: cpu.filter(|_| bound.is_ok()),
            refused: (!notices.is_empty()).then(|| notices.join("; ")),
        }
    }
}
