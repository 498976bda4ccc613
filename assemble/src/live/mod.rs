//! A page that shows a run while it goes on. In goes the run, as an observer sees it; out comes a page on this machine, and from
//! there the wish that the exchange ends after its round.

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

/// A page that is being served.
#[derive(Debug)]
pub struct Live {
    board: Arc<Board>,
    monitor: Arc<Monitor>,
    url: String,
}

/// How often it is asked whether to end.
const TICK: Duration = Duration::from_millis(100);

/// Viewers get this long to be told how it ended.
const FAREWELL: Duration = Duration::from_millis(500);

impl Live {
    /// Serve the page on this port of this machine, or on any free one for 0. `watched`: whether run follows run.
    pub fn start(port: u16, watched: bool, monitor: &Arc<Monitor>) -> anyhow::Result<Self> {
        let listener = listen(port).map_err(|error| {
            anyhow::anyhow!(
                "127.0.0.1:{port}: cannot serve the live page ({error}); expected a port that is free; choose another \
                 with --live PORT, or give none for any"
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

    /// Where the page is.
    pub fn url(&self) -> &str {
        &self.url
    }

    /// A run begins; it is to be told to the observer.
    pub fn begin(&self) -> &dyn Observer {
        self.board.begin();
        &*self.board
    }

    /// A run has ended.
    pub fn end(&self, outcome: Result<&Report, String>) {
        self.board.end(outcome);
    }

    /// Serve on until Ctrl-C, or until somebody closes the page.
    pub fn stay(&self) {
        while !self.monitor.stopped() {
            std::thread::sleep(TICK);
        }
    }
}

impl Drop for Live {
    /// Viewers are told how it ended before the program does.
    fn drop(&mut self) {
        let start = Instant::now();
        while self.board.viewers() > 0 && start.elapsed() < FAREWELL {
            std::thread::sleep(TICK);
        }
    }
}

fn listen(port: u16) -> std::io::Result<TcpListener> {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
    listener.set_nonblocking(true)?;
    Ok(listener)
}
