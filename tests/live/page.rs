//! A program that serves its live page, and requests to it.

use equilux_tests::program::program;
use equilux_tests::workshop::Workshop;
use serde_json::Value;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// Timeout, far above the duration of any step.
pub const PATIENCE: Duration = Duration::from_secs(60);

/// A running program and its page; the program is ended whatever happens.
pub struct Page {
    child: Child,
    /// Where the page is.
    pub url: String,
    stdout: Receiver<String>,
}

/// A response.
#[derive(Debug)]
pub struct Answer {
    /// Such as 200.
    pub status: u16,
    /// The header lines.
    pub head: String,
    /// The body.
    pub body: Vec<u8>,
}

impl Page {
    /// Assemble scene.glb with the page and these arguments.
    pub fn of(workshop: &Workshop, arguments: &[&str]) -> Self {
        let mut child = Command::new(program("assemble"))
            .args(["scene.glb", "--live"])
            .args(arguments)
            .current_dir(workshop.path(""))
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program runs");
        let stderr = lines(child.stderr.take().expect("a pipe"));
        let stdout = lines(child.stdout.take().expect("a pipe"));
        let said = stderr.recv_timeout(PATIENCE).expect("the program says where its page is");
        let url = said.strip_prefix("live page: ").unwrap_or_else(|| panic!("said '{said}'")).to_owned();
        Self { child, url, stdout }
    }

    /// Host and port.
    pub fn host(&self) -> &str {
        self.url.split('/').nth(2).expect("a host")
    }

    /// The path of something below the token.
    pub fn path(&self, name: &str) -> String {
        let host = self.host();
        let (_, path) = self.url.split_once(host).expect("the host is in the address");
        format!("{path}{name}")
    }

    /// The response to a request with only these header lines.
    pub fn ask(&self, method: &str, path: &str, headers: &[&str]) -> Answer {
        let mut stream = self.open(method, path, headers);
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes).expect("an answer in time");
        let end = bytes.windows(4).position(|w| w == b"\r\n\r\n").expect("a head");
        let head = String::from_utf8_lossy(&bytes[..end]).into_owned();
        let status = head.split(' ').nth(1).and_then(|code| code.parse().ok()).expect("a status");
        Answer { status, head, body: bytes[end + 4..].to_vec() }
    }

    /// The response to a request from the page itself.
    pub fn fetch(&self, name: &str) -> Answer {
        self.ask("GET", &self.path(name), &[&format!("Host: {}", self.host())])
    }

    /// The response to a command from the page itself.
    pub fn post(&self, name: &str) -> Answer {
        let (host, origin) = (format!("Host: {}", self.host()), format!("Origin: http://{}", self.host()));
        self.ask("POST", &self.path(name), &[&host, &origin])
    }

    /// Sends a request; the caller reads the response.
    pub fn open(&self, method: &str, path: &str, headers: &[&str]) -> TcpStream {
        let mut stream = TcpStream::connect(self.host()).expect("the server listens");
        stream.set_read_timeout(Some(PATIENCE)).expect("a time limit");
        let lines: String = headers.iter().map(|line| format!("{line}\r\n")).collect();
        write!(stream, "{method} {path} HTTP/1.1\r\n{lines}Connection: close\r\nContent-Length: 0\r\n\r\n")
            .expect("the server reads");
        stream
    }

    /// The stream of events from now on.
    pub fn news(&self) -> impl Iterator<Item = Value> + use<> {
        let stream = self.open("GET", &self.path("events"), &[&format!("Host: {}", self.host())]);
        // Lines without news keep the connection alive, so its time limit ends no wait.
        let start = Instant::now();
        let lines = BufReader::new(stream).lines().map_while(Result::ok);
        let lines = lines.take_while(move |_| start.elapsed() < PATIENCE);
        lines.filter_map(|line| serde_json::from_str(line.strip_prefix("data: ")?).ok())
    }

    /// Waits for an event that satisfies a condition, and returns the run's status.
    pub fn wait(&self, until: impl Fn(&Value, &Value) -> bool) -> Value {
        let (start, mut status) = (Instant::now(), Value::Null);
        for news in self.news() {
            if !news["status"].is_null() {
                status = news["status"].clone();
            }
            if until(&status, &news) {
                return status;
            }
            assert!(start.elapsed() < PATIENCE, "still waiting at {news}");
        }
        panic!("no more news after {status}");
    }

    /// A line of what it prints.
    pub fn says(&self) -> String {
        self.stdout.recv_timeout(PATIENCE).expect("something printed")
    }

    /// Waits for its end.
    pub fn code(&mut self) -> Option<i32> {
        let start = Instant::now();
        while start.elapsed() < PATIENCE {
            if let Some(status) = self.child.try_wait().expect("a child") {
                return status.code();
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        panic!("it did not end");
    }

    /// Sends Ctrl-C.
    pub fn interrupt(&self) {
        let sent = Command::new("kill").args(["-INT", &self.child.id().to_string()]).status();
        assert!(sent.expect("kill runs").success());
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The lines of a pipe as they come.
fn lines(pipe: impl Read + Send + 'static) -> Receiver<String> {
    let (sender, lines) = channel();
    std::thread::spawn(move || {
        // The test may be over.
        BufReader::new(pipe).lines().map_while(Result::ok).for_each(|line| drop(sender.send(line)));
    });
    lines
}
