//! Independent jobs over a few threads, results in the jobs' own order.

use std::num::NonZero;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

/// The number of threads this machine runs at once.
pub fn all_cores() -> usize {
    thread::available_parallelism().map_or(1, NonZero::get)
}

/// Told, from any thread, how many of how many jobs are done.
pub type Progress<'a> = &'a (dyn Fn(usize, usize) + Sync);

/// `work(0), …, work(count − 1)`, each done once by one of `threads` threads, the next job to the next free thread.
pub fn map<T: Send>(
    threads: usize,
    count: usize,
    progress: Progress,
    work: impl Fn(usize) -> T + Sync,
) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let done = Mutex::new(Vec::with_capacity(count));
    thread::scope(|scope| {
        for _ in 0..threads.clamp(1, count.max(1)) {
            scope.spawn(|| {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    if index >= count {
                        return;
                    }
                    let result = work(index);
                    if let Ok(mut done) = done.lock() {
                        done.push((index, result));
                        progress(done.len(), count);
                    }
                }
            });
        }
    });
    let mut done = done.into_inner().unwrap_or_default();
    done.sort_by_key(|(index, _)| *index);
    done.into_iter().map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    use super::map;

    #[test]
    fn results_come_in_the_order_of_the_jobs_whatever_the_number_of_threads() {
        for threads in [0, 1, 2, 7] {
            assert_eq!(map(threads, 100, &|_, _| (), |i| i * i), (0..100).map(|i| i * i).collect::<Vec<_>>());
        }
        assert_eq!(map(2, 0, &|_, _| (), |i| i), Vec::<usize>::new());
    }
}
