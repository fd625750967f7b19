//! CPU time and peak memory of this process, as Linux counts them; wall time and nothing where it does not.

use std::time::{Duration, Instant};

/// CPU time of this thread so far, s; the kernel brings it up to date every few milliseconds.
fn cpu() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = text.split_whitespace().next()?.parse().ok()?;
    Some(1e-9 * nanoseconds)
}

/// What `f` gives, and the CPU time it took, s.
pub fn timed<T>(f: impl FnOnce() -> T) -> (T, f64) {
    let (before, begin) = (cpu(), Instant::now());
    let out = f();
    let spent = match (before, cpu()) {
        (Some(before), Some(after)) => after - before,
        _ => begin.elapsed().as_secs_f64(),
    };
    (out, spent)
}

/// Shortest wall time of one of `count` calls in a row, us, over `patience`.
pub fn shortest(patience: Duration, count: u32, mut f: impl FnMut()) -> f64 {
    let begin = Instant::now();
    let mut shortest = f64::INFINITY;
    while begin.elapsed() < patience {
        let start = Instant::now();
        (0..count).for_each(|_| f());
        shortest = shortest.min(1e6 * start.elapsed().as_secs_f64() / f64::from(count));
    }
    shortest
}

/// Peak memory of this process so far, MB.
pub fn peak_memory() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    let kilobytes: f64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kilobytes / 1024.0)
}
