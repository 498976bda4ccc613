//! Progress for a person: a bar on stderr for anything over a second, nothing where stderr is no terminal. Ctrl-C
//! asks for an end where results are whole; a second one ends at once.

use crate::monitor::Monitor;
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
    // Without a handler Ctrl-C ends the program at once: a pity, but nothing is lost, for files are written whole.
    let _ = ctrlc::set_handler(move || {
        if on_interrupt.stopped() {
            std::process::exit(130);
        }
        on_interrupt.stop();
    });
    monitor
}

/// The thread that draws; ends with [`Display::finish`].
pub struct Display {
    done: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

/// How often the bar is drawn.
const TICK: Duration = Duration::from_millis(100);

/// What takes less time than this is not shown.
const PATIENCE: Duration = Duration::from_secs(1);

/// Show the monitor's progress until the display is finished.
pub fn show(monitor: &Arc<Monitor>) -> Display {
    let done = Arc::new(AtomicBool::new(false));
    if !std::io::stderr().is_terminal() {
        return Display { done, thread: None };
    }
    let (monitor, ended) = (Arc::clone(monitor), Arc::clone(&done));
    Display { done, thread: Some(std::thread::spawn(move || draw(&monitor, &ended))) }
}

impl Display {
    /// Take the bar away.
    pub fn finish(self) {
        self.done.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread {
            // A panic there only concerns the drawing.
            let _ = thread.join();
        }
    }
}

fn draw(monitor: &Monitor, done: &AtomicBool) {
    let start = Instant::now();
    let mut bar: Option<(String, ProgressBar)> = None;
    while !done.load(Ordering::Relaxed) {
        std::thread::sleep(TICK);
        let (stage, steps) = monitor.now();
        if start.elapsed() < PATIENCE || stage.what.is_empty() {
            continue;
        }
        if bar.as_ref().is_none_or(|(what, _)| *what != stage.what) {
            if let Some((_, old)) = bar.take() {
                old.finish_and_clear();
            }
            bar = Some((stage.what.clone(), new_bar(stage.what, stage.total)));
        }
        if let Some((_, bar)) = &bar {
            bar.set_position(steps);
        }
    }
    if let Some((_, bar)) = bar {
        bar.finish_and_clear();
    }
}

fn new_bar(what: String, total: u64) -> ProgressBar {
    let (bar, template) = if total == 0 {
        (ProgressBar::new_spinner(), "{spinner} {msg}: {pos} rounds, {elapsed}")
    } else {
        (ProgressBar::new(total), "{msg} [{bar:30}] {percent:>3} %, {eta} left")
    };
    bar.set_style(
        ProgressStyle::with_template(template).expect("the template is well formed").progress_chars("=> "),
    );
    bar.set_message(what);
    bar
}
