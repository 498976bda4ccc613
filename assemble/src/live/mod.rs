//! A page that shows a run in progress. Input: the callbacks of the run. Output: a page on this machine, which can
//! request that the exchange end after its current round.

mod board;
mod field;
mod guard;
mod history;
mod model;
mod server;
mod status;

use crate::equation::observer::Observer;
use crate::report::Report;
use board::Board;
use equilux_bake::monitor::Monitor;
use guard::Guard;
use server::{Site, router};
use std::net::{Ipv4Addr, TcpListener};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The served page.
#[derive(Debug)]
pub struct Live {
    board: Arc<Board>,
    monitor: Arc<Monitor>,
    url: String,
}

/// Interval at which end conditions are checked.
const CHECK_INTERVAL: Duration = Duration::from_millis(100);

/// Time for viewers to receive the final state.
const FINAL_NEWS_TIME: Duration = Duration::from_millis(500);

impl Live {
    /// Serve the page on this port of this machine, or on any free port for 0. `watched`: whether runs repeat when
    /// files change. Fails if the port is in use.
    pub fn start(port: u16, watched: bool, monitor: &Arc<Monitor>) -> anyhow::Result<Self> {
        let listener = listen(port).map_err(|error| {
            anyhow::anyhow!(
                "127.0.0.1:{port}: cannot serve the live page ({error}); expected a free port; choose another \
                 with --live PORT, or give no port to use any"
            )
        })?;
        let guard = Guard::new(listener.local_addr()?.port())?;
        let (board, url) = (Arc::new(Board::new(watched)), guard.url());
        let site = Site { board: Arc::clone(&board), monitor: Arc::clone(monitor), guard };
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        std::thread::spawn(move || {
            runtime.block_on(async {
                let listener = tokio::net::TcpListener::from_std(listener)?;
                axum::serve(listener, router(site)).await
            })
        });
        Ok(Self { board, monitor: Arc::clone(monitor), url })
    }

    /// The address of the page.
    pub fn url(&self) -> &str {
        &self.url
    }

    /// Begin a run. Returns the observer to which the run must report.
    pub fn begin(&self) -> &dyn Observer {
        self.board.begin();
        &*self.board
    }

    /// End a run.
    pub fn end(&self, outcome: Result<&Report, String>) {
        self.board.end(outcome);
    }

    /// Keep serving until Ctrl-C, or until the page is closed.
    pub fn stay(&self) {
        while !self.monitor.stopped() {
            std::thread::sleep(CHECK_INTERVAL);
        }
    }
}

impl Drop for Live {
    /// Viewers receive the final state before the program ends.
    fn drop(&mut self) {
        let start = Instant::now();
        while self.board.viewers() > 0 && start.elapsed() < FINAL_NEWS_TIME {
            std::thread::sleep(CHECK_INTERVAL);
        }
    }
}

fn listen(port: u16) -> std::io::Result<TcpListener> {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
    listener.set_nonblocking(true)?;
    Ok(listener)
}
