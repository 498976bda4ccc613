//! Memory and processor time of this process, where the operating system reports them.

#[cfg(unix)]
use nix::sys::resource::{Usage, UsageWho, getrusage};

/// The most memory this process held so far, bytes; none where the system does not report it.
#[cfg(unix)]
pub fn peak_rss() -> Option<usize> {
    // Kilobytes, but for Apple's systems, where they are bytes.
    let unit = if cfg!(target_vendor = "apple") { 1 } else { 1024 };
    usize::try_from(usage()?.max_rss()).ok().map(|size| size * unit)
}

/// Processor time that this process took so far, all threads together, seconds; none where the system does not report it.
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

/// The most memory this process held so far, bytes; none, as this system does not report it.
#[cfg(not(unix))]
pub fn peak_rss() -> Option<usize> {
    None
}

/// Processor time that this process took so far, seconds; none, as this system does not report it.
#[cfg(not(unix))]
pub fn cpu_seconds() -> Option<f64> {
    None
}

/// Processor time since [`cpu_seconds`] was `start`, seconds; none where the system does not report it.
pub fn cpu_since(start: Option<f64>) -> Option<f64> {
    cpu_seconds().zip(start).map(|(now, start)| now - start)
}
