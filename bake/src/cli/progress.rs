//! Progress on stderr: one line for the whole run, updated in place on a terminal, printed every few seconds elsewhere.
//! Ctrl-C requests a stop at the next point where results are complete; a second Ctrl-C ends the program at once.

use super::program::tell;
use crate::monitor::{Monitor, Progress};
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// A monitor that Ctrl-C stops.
pub fn monitor_for_program() -> Arc<Monitor> {
    let monitor = Arc::new(Monitor::default());
    let on_interrupt = Arc::clone(&monitor);
    // Without a handler, Ctrl-C ends the program at once. That is safe because files are written atomically.
    let _ = ctrlc::set_handler(move || {
        if on_interrupt.stopped() {
            std::process::exit(130);
        }
        on_interrupt.stop();
    });
    monitor
}

/// The thread that shows progress; ends with [`Display::finish`].
#[derive(Debug)]
pub struct Display {
    done: Arc<AtomicBool>,
    thread: JoinHandle<()>,
}

/// Interval between updates on a terminal.
const TICK: Duration = Duration::from_millis(100);

/// A terminal shows no progress for shorter runs.
const TERMINAL_FROM: Duration = Duration::from_secs(1);

/// Without a terminal, no progress is printed for shorter runs.
const LINES_FROM: Duration = Duration::from_secs(10);

/// Without a terminal, interval between lines.
const LINES_EVERY: Duration = Duration::from_secs(5);

/// Shows the monitor's progress until [`Display::finish`].
pub fn show(monitor: &Arc<Monitor>) -> Display {
    let done = Arc::new(AtomicBool::new(false));
    let (monitor, ended) = (Arc::clone(monitor), Arc::clone(&done));
    let show = if std::io::stderr().is_terminal() { draw } else { print_lines };
    Display { done, thread: std::thread::spawn(move || show(&monitor, &ended)) }
}

impl Display {
    /// Removes the line and ends the thread.
    pub fn finish(self) {
        self.done.store(true, Ordering::Relaxed);
        self.thread.thread().unpark();
        // A panic of the drawing thread is ignored.
        let _ = self.thread.join();
    }
}

fn draw(monitor: &Monitor, ended: &AtomicBool) {
    let start = Instant::now();
    let mut bar: Option<ProgressBar> = None;
    while !ended.load(Ordering::Relaxed) {
        std::thread::park_timeout(TICK);
        let progress = monitor.now();
        if start.elapsed() < TERMINAL_FROM || progress.step.what.is_empty() {
            continue;
        }
        let bar = bar.get_or_insert_with(new_bar);
        bar.set_position((progress.share * STEPS_OF_BAR) as u64);
        bar.set_message(line(&progress));
    }
    if let Some(bar) = bar {
        bar.finish_and_clear();
    }
}

/// Resolution of the bar.
const STEPS_OF_BAR: f64 = 1000.0;

fn new_bar() -> ProgressBar {
    let style = ProgressStyle::with_template("[{bar:24}] {wide_msg}").expect("the template is well formed");
    ProgressBar::new(STEPS_OF_BAR as u64).with_style(style.progress_chars("=> "))
}

fn print_lines(monitor: &Monitor, ended: &AtomicBool) {
    let start = Instant::now();
    let mut next = LINES_FROM;
    while !ended.load(Ordering::Relaxed) {
        std::thread::park_timeout(next.saturating_sub(start.elapsed()));
        let progress = monitor.now();
        if start.elapsed() >= next && !progress.step.what.is_empty() && !ended.load(Ordering::Relaxed) {
            tell(line(&progress));
        }
        if start.elapsed() >= next {
            next = start.elapsed() + LINES_EVERY;
        }
    }
}

/// The completed share, the remaining time, and the current step.
fn line(progress: &Progress) -> String {
    let Progress { step, done, share, left } = progress;
    let left = left.map_or(String::new(), |left| format!(", about {} left", rounded(left)));
    let count = if step.total == 0 && *done > 0 { format!(", round {done}") } else { String::new() };
    format!("{:3.0} %{left}: {}{count}", (100.0 * share).floor(), step.what)
}

/// A duration, rounded to one or two digits.
fn rounded(time: Duration) -> String {
    match time.as_secs() {
        0..60 => format!("{} s", time.as_secs() + 1),
        60..3600 => format!("{} min", time.as_secs().div_ceil(60)),
        seconds => format!("{:.1} h", seconds as f64 / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::monitor::Step;

    #[test]
    fn a_line_has_the_share_the_time_left_and_the_step() {
        let step = Step { what: "coupling of crate".into(), total: 9 };
        let progress = Progress { step, done: 3, share: 0.349, left: Some(Duration::from_secs(100)) };
        assert_eq!(line(&progress), " 34 %, about 2 min left: coupling of crate");
        let step = Step { what: "exchange".into(), total: 0 };
        let progress = Progress { step, done: 3, share: 0.9, left: None };
        assert_eq!(line(&progress), " 90 %: exchange, round 3");
    }
}
