//! Memory and processor time of this process, where the operating system reports them.

#[cfg(unix)]
use nix::sys::resource::{Usage, UsageWho, getrusage};

/// Peak memory of this process so far, bytes; none where the operating system does not report it. On Linux, getrusage
/// also counts the memory before the process became this program, which for a child process is that of its parent.
#[cfg(target_os = "linux")]
pub fn peak_rss() -> Option<usize> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kilobytes: usize = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kilobytes * 1024)
}

/// Peak memory of this process so far, bytes; none where the operating system does not report it.
#[cfg(all(unix, not(target_os = "linux")))]
pub fn peak_rss() -> Option<usize> {
    // Kilobytes, except on Apple's systems, which use bytes.
    let unit = if cfg!(target_vendor = "apple") { 1 } else { 1024 };
    usize::try_from(usage()?.max_rss()).ok().map(|size| size * unit)
}

/// Processor time of this process so far, all threads together, seconds; none where the operating system does not
/// report it.
#[cfg(unix)]
pub fn cpu_seconds() -> Option<f64> {
    let usage = usage()?;
    let seconds =
        [usage.user_time(), usage.system_time()].map(|t| t.tv_sec() as f64 + 1e-6 * t.tv_usec() as f64);
    Some(seconds.iter().sum())
}

#[cfg(unix)]
fn usage() -> Option<Usage> {
    getrusage(UsageWho::RUSAGE_SELF).ok()
}

/// Peak memory of this process so far, bytes; none, since this operating system does not report it.
#[cfg(not(unix))]
pub fn peak_rss() -> Option<usize> {
    None
}

/// Processor time of this process so far, seconds; none, since this operating system does not report it.
#[cfg(not(unix))]
pub fn cpu_seconds() -> Option<f64> {
    None
}

/// Processor time since [`cpu_seconds`] was `start`, seconds; none where the operating system does not report it.
pub fn cpu_since(start: Option<f64>) -> Option<f64> {
    cpu_seconds().zip(start).map(|(now, start)| now - start)
}
