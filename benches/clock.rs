//! How benches measure: seconds of one thread's CPU, two programs in turn, medians of many pairs.
//!
//! Other work on the machine costs elapsed time but hardly any CPU seconds. So the clock counts the
//! CPU seconds of the thread, and two programs are compared pair by pair, not by their means.

use std::fs;
use std::hint::black_box;
use std::time::Instant;

/// CPU seconds that this thread has used, where the system reports them (Linux; exact to a tick of
/// the scheduler, 1 to 10 ms).
fn thread_cpu_seconds() -> Option<f64> {
    let stat = fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = stat.split_whitespace().next()?.parse().ok()?;
    Some(nanoseconds * 1e-9)
}

/// CPU seconds of a piece of work that stays on this thread (elapsed seconds where they are not
/// reported), and its result.
pub(crate) fn cpu_seconds<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let (cpu, wall) = (thread_cpu_seconds(), Instant::now());
    let result = black_box(work());
    let seconds = match (cpu, thread_cpu_seconds()) {
        (Some(before), Some(after)) => after - before,
        _ => wall.elapsed().as_secs_f64(),
    };
    (seconds, result)
}
