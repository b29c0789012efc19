//! The few calls to the operating system that no safe crate offers, what the pacing thread asks of its scheduler, and
//! the processor's wider instructions: everything here is safe to call, and this is the only file with `unsafe`.
#![allow(unsafe_code)]

use std::io;
use std::mem::MaybeUninit;
use std::os::fd::{AsFd, AsRawFd, BorrowedFd, OwnedFd};
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll, ready};
use std::time::Duration;

use rustix::process::{Resource, getrlimit};
use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};
use tokio::io::unix::AsyncFd;
use tokio::io::{AsyncRead, Interest, ReadBuf};

/// Does `work` with the widest vectors this processor has: a closure marked `#[inline(always)]`, and whatever else is
/// inlined into it, is compiled again for AVX2 and for AVX-512, which do four and eight doubles at once where every
/// x86-64 does two.
///
/// The results are the same bit for bit: Rust neither reorders floating-point operations nor joins a product and a sum
/// into one rounding.
#[inline(always)]
pub fn widest<R>(work: impl FnOnce() -> R) -> R {
    #[cfg(target_arch = "x86_64")]
    {
        #[target_feature(enable = "avx2")]
        fn avx2<R>(work: impl FnOnce() -> R) -> R {
            work()
        }
        #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
        fn avx512<R>(work: impl FnOnce() -> R) -> R {
            work()
        }
        if has_avx512() {
            // SAFETY: the processor has them: that was just asked.
            return unsafe { avx512(work) };
        }
        if std::arch::is_x86_feature_detected!("avx2") {
            // SAFETY: as above.
            return unsafe { avx2(work) };
        }
    }
    work()
}

/// Whether the processor has the parts of AVX-512 that [`widest`] uses, as every one since 2017 that has any.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn has_avx512() -> bool {
    use std::arch::is_x86_feature_detected as has;
    static FOUND: std::sync::LazyLock<bool> = std::sync::LazyLock::new(|| {
        has!("avx512f") && has!("avx512bw") && has!("avx512dq") && has!("avx512vl")
    });
    *FOUND
}

/// Bytes that the kernel still holds for the other side of a terminal or a socket
/// (`TIOCOUTQ`, which on a socket is the same call as `SIOCOUTQ`).
///
/// On the master of a pty this is always 0: what its reader has not read is counted on the slave
/// ([`unread`]).
pub(crate) fn unsent(file: impl AsFd) -> io::Result<usize> {
    let mut bytes: libc::c_int = 0;
    // SAFETY: the descriptor is open for as long as `file` is borrowed, and TIOCOUTQ writes one
    // `int` to the address it is given, which is that of a live, exclusively borrowed `int`.
    let answer = unsafe { libc::ioctl(file.as_fd().as_raw_fd(), libc::TIOCOUTQ, &raw mut bytes) };
    checked(answer)?;
    Ok(usize::try_from(bytes).unwrap_or(0))
}

/// Bytes that have arrived on a terminal or a socket and have not been read (`FIONREAD`).
pub(crate) fn unread(file: impl AsFd) -> io::Result<usize> {
    let bytes = rustix::io::ioctl_fionread(file)?;
    Ok(usize::try_from(bytes).unwrap_or(usize::MAX))
}

/// Whether the process was started with SIGHUP ignored, as `nohup` starts one: the signal's bit of `SigIgn` in
/// `/proc/self/status`, proc_pid_status(5). Where that cannot be read, it was not.
pub(crate) fn ignores_hang_up() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (libc::SIGHUP - 1) & 1 == 1)
}

/// Puts what `to` refers to behind the descriptor `file`, whose number stays; what was behind it is closed.
///
/// Whoever writes to `file` meanwhile writes to the one or to the other.
pub(crate) fn redirect(file: &OwnedFd, to: &OwnedFd) -> io::Result<()> {
    // SAFETY: both descriptors are open while they are borrowed. dup3 replaces what the number of `file` refers to
    // in one step, so it stays a valid descriptor, owned by whom it was.
    let answer = unsafe { libc::dup3(to.as_raw_fd(), file.as_raw_fd(), libc::O_CLOEXEC) };
    checked(answer)
}

/// A descriptor that a task can wait on; it must be non-blocking.
pub(crate) struct Readable(AsyncFd<Arc<OwnedFd>>);

impl Readable {
    /// Registers `file` with the runtime of the calling task.
    ///
    /// # Panics
    /// Outside a tokio runtime with I/O enabled.
    pub fn new(file: Arc<OwnedFd>) -> io::Result<Self> {
        // SAFETY: the `Arc` keeps the descriptor open for as long as the `AsyncFd` lives, and as
        // the latter is never handed out, nobody can put another descriptor in its place.
        let registered = unsafe { AsyncFd::register_with_interest(file, Interest::READABLE) };
        Ok(Self(registered?))
    }

    /// Waits until there is something to read, and calls `read` until it answers anything but
    /// `WouldBlock`. Cancelling it loses nothing.
    pub async fn read<T>(&self, mut read: impl FnMut(BorrowedFd<'_>) -> io::Result<T>) -> io::Result<T> {
        loop {
            let mut ready = self.0.readable().await?;
            if let Ok(answer) = ready.try_io(|file| read(file.get_ref().as_fd())) {
                return answer;
            }
        }
    }
}

impl AsyncRead for Readable {
    fn poll_read(
        self: Pin<&mut Self>,
        task: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        loop {
            let mut ready = ready!(self.0.poll_read_ready(task))?;
            let read = |file: &AsyncFd<Arc<OwnedFd>>| {
                Ok(rustix::io::read(file.get_ref(), buffer.initialize_unfilled())?)
            };
            if let Ok(answer) = ready.try_io(read) {
                return Poll::Ready(answer.map(|count| buffer.advance(count)));
            }
        }
    }
}

/// The kernel's `struct serial_struct` (`linux/serial.h`).
#[repr(C)]
struct SerialStruct {
    kind: libc::c_int,
    line: libc::c_int,
    port: libc::c_uint,
    irq: libc::c_int,
    flags: libc::c_int,
    xmit_fifo_size: libc::c_int,
    custom_divisor: libc::c_int,
    baud_base: libc::c_int,
    close_delay: libc::c_ushort,
    io_type: libc::c_char,
    reserved_char: libc::c_char,
    hub6: libc::c_int,
    closing_wait: libc::c_ushort,
    closing_wait2: libc::c_ushort,
    iomem_base: *mut libc::c_uchar,
    iomem_reg_shift: libc::c_ushort,
    port_high: libc::c_uint,
    iomap_base: libc::c_ulong,
}

/// `ASYNC_LOW_LATENCY` of `linux/tty_flags.h`.
const LOW_LATENCY: libc::c_int = 1 << 13;

/// Asks a serial driver to hand over what it receives at once (`ASYNC_LOW_LATENCY`).
///
/// An FTDI adapter otherwise holds received bytes for up to 16 ms. `Unsupported` where the driver
/// has no such setting, as on a pty.
pub(crate) fn set_low_latency(port: impl AsFd) -> io::Result<()> {
    let port = port.as_fd().as_raw_fd();
    let mut settings = MaybeUninit::<SerialStruct>::zeroed();
    // SAFETY: the descriptor is open while `port` is borrowed by the caller, and TIOCGSERIAL fills
    // the one `serial_struct` at the address it is given.
    let answer = unsafe { libc::ioctl(port, libc::TIOCGSERIAL, settings.as_mut_ptr()) };
    checked(answer).map_err(unsupported)?;
    // SAFETY: every field is a plain integer or a raw pointer, for which zero is a valid value;
    // the kernel has overwritten them with its own.
    let mut settings = unsafe { settings.assume_init() };
    if settings.flags & LOW_LATENCY != 0 {
        return Ok(());
    }
    settings.flags |= LOW_LATENCY;
    // SAFETY: as above; TIOCSSERIAL only reads the `serial_struct`.
    let answer = unsafe { libc::ioctl(port, libc::TIOCSSERIAL, &raw const settings) };
    checked(answer).map_err(unsupported)
}

/// A driver that does not know the call says ENOTTY or EINVAL.
fn unsupported(error: io::Error) -> io::Error {
    match error.raw_os_error() {
        Some(libc::ENOTTY | libc::EINVAL | libc::EOPNOTSUPP) => io::ErrorKind::Unsupported.into(),
        _ => error,
    }
}

/// Gives the calling thread the real-time priority `priority` (1 to 99, `SCHED_FIFO`); threads and
/// processes it starts do not inherit it.
///
/// An ordinary user is usually refused: `ulimit -r`, `rtprio` in `/etc/security/limits.conf` or
/// `CAP_SYS_NICE` grants it. Such a thread must not spin without sleeping: the kernel stops
/// real-time threads that use more than 95 % of a second.
pub fn set_realtime_priority(priority: i32) -> io::Result<()> {
    let parameters = libc::sched_param { sched_priority: priority };
    let policy = libc::SCHED_FIFO | libc::SCHED_RESET_ON_FORK;
    let calling_thread: libc::pid_t = 0;
    // SAFETY: the system call only reads the `sched_param` at the address it is given, which
    // outlives the call. It is called directly because musl's wrapper always fails.
    let answer =
        unsafe { libc::syscall(libc::SYS_sched_setscheduler, calling_thread, policy, &raw const parameters) };
    if answer == 0 { Ok(()) } else { Err(io::Error::last_os_error()) }
}

/// Has the calling thread woken as soon after a sleep's end as the timer allows: an ordinary thread is otherwise up
/// to 50 µs late, so that the kernel can wake several together. Never refused where Linux knows it at all; threads of
/// real-time priority are punctual anyhow.
pub fn set_punctual_sleep() {
    // An old kernel without it only wakes as late as it does.
    let _ = rustix::thread::set_current_timer_slack(std::num::NonZeroU64::new(1));
}

/// Keeps the whole process in memory, now and as it grows, so that a page fault never delays a
/// packet.
///
/// Where memory locking is limited (`ulimit -l`) nothing is locked and `PermissionDenied` is
/// returned: with a limit in force, later allocations would fail.
pub fn lock_memory() -> io::Result<()> {
    if let Some(bytes) = getrlimit(Resource::Memlock).current
        && !may_lock_without_limit()
    {
        return Err(io::Error::new(
            io::ErrorKind::PermissionDenied,
            format!("memory locking is limited to {} KiB", bytes / 1024),
        ));
    }
    use rustix::mm::{MlockAllFlags, mlockall};
    mlockall(MlockAllFlags::CURRENT | MlockAllFlags::FUTURE)?;
    Ok(())
}

/// Whether this process has `CAP_IPC_LOCK`, which no limit on locked memory binds.
fn may_lock_without_limit() -> bool {
    const CAP_IPC_LOCK: u32 = 14;
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    status
        .lines()
        .find_map(|line| line.strip_prefix("CapEff:"))
        .and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok())
        .is_some_and(|mask| mask >> CAP_IPC_LOCK & 1 == 1)
}

/// Processor time used by the calling thread since it started.
pub fn thread_cpu_time() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Duration::new(u64::try_from(time.tv_sec).unwrap_or(0), u32::try_from(time.tv_nsec).unwrap_or(0))
}

/// The processors that the calling thread may run on, in ascending order.
pub fn affinity() -> io::Result<Vec<usize>> {
    let allowed = sched_getaffinity(None)?;
    Ok((0..CpuSet::MAX_CPU).filter(|&cpu| allowed.is_set(cpu)).collect())
}

/// Binds the calling thread to `processors`; `InvalidInput` where none of them exists.
pub fn set_affinity(processors: &[usize]) -> io::Result<()> {
    let mut wanted = CpuSet::new();
    for &cpu in processors {
        if cpu >= CpuSet::MAX_CPU {
            return Err(io::ErrorKind::InvalidInput.into());
        }
        wanted.set(cpu);
    }
    Ok(sched_setaffinity(None, &wanted)?)
}

/// The error of a call that answers −1 for failure.
fn checked(answer: libc::c_int) -> io::Result<()> {
    if answer == -1 { Err(io::Error::last_os_error()) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use std::io::Write;
    use std::os::unix::net::UnixStream;

    use super::*;

    #[test]
    fn bytes_on_their_way_are_counted_on_both_sides() {
        let (mut near, far) = UnixStream::pair().unwrap();
        assert_eq!(unread(&far).unwrap(), 0);
        near.write_all(b"abc").unwrap();
        assert_eq!(unread(&far).unwrap(), 3);
        assert!(unsent(&near).unwrap() >= 3);
    }

    #[test]
    fn what_is_behind_a_descriptor_changes_and_what_was_is_closed() {
        let (near, far) = UnixStream::pair().unwrap();
        let (other_near, other_far) = UnixStream::pair().unwrap();
        let near = OwnedFd::from(near);
        redirect(&near, &other_near.into()).unwrap();
        rustix::io::write(&near, b"abc").unwrap();
        assert_eq!(unread(&other_far).unwrap(), 3);
        let mut nothing = [0; 1];
        assert_eq!(io::Read::read(&mut &far, &mut nothing).unwrap(), 0, "its other end is closed");
    }

    #[test]
    fn a_file_that_is_no_port_has_no_low_latency() {
        let (near, _far) = UnixStream::pair().unwrap();
        let error = set_low_latency(&near).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::Unsupported);
    }

    #[test]
    fn a_thread_can_be_bound_to_one_of_its_processors() {
        let before = affinity().unwrap();
        set_affinity(&before[..1]).unwrap();
        assert_eq!(affinity().unwrap(), before[..1]);
        set_affinity(&before).unwrap();
        assert!(set_affinity(&[usize::MAX]).is_err());
        assert!(set_affinity(&[]).is_err());
    }

    #[test]
    fn a_thread_can_be_woken_punctually() {
        set_punctual_sleep();
        let slack = rustix::thread::current_timer_slack().unwrap();
        // A thread of real-time priority has none to begin with.
        assert!(slack <= 1, "{slack} ns");
    }

    #[test]
    fn a_threads_processor_time_grows_as_it_works() {
        let before = thread_cpu_time();
        let mut sum = 0_u64;
        while thread_cpu_time() == before {
            sum = std::hint::black_box(sum.wrapping_add(1));
        }
        assert!(thread_cpu_time() > before);
    }

    #[test]
    fn a_real_time_priority_is_granted_or_refused_in_words() {
        let answer = std::thread::spawn(|| set_realtime_priority(1)).join().unwrap();
        if let Err(error) = answer {
            assert_eq!(error.kind(), io::ErrorKind::PermissionDenied);
        }
        let error = set_realtime_priority(1000).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::InvalidInput);
    }
}
