//! Access control of the page's server: only pages that it served itself may send requests. Input: the head of a
//! request. Output: the reason for a refusal, or none.
//!
//! The token in the path excludes other users of this machine and pages of other origins that guess ports. A page of
//! another origin whose name resolves to this machine (DNS rebinding) sends that name as the host, and cross-origin
//! requests carry their origin.

use axum::http::{HeaderMap, HeaderName, Method, header};

/// The server's host name and port, and the token in its paths.
#[derive(Debug, Clone)]
pub struct Guard {
    port: u16,
    token: String,
}

impl Guard {
    /// The guard of a server on this port, with a token of 128 random bits. Fails if the operating system provides no
    /// random numbers.
    pub fn new(port: u16) -> Result<Self, getrandom::Error> {
        let mut random = [0; 16];
        getrandom::fill(&mut random)?;
        Ok(Self { port, token: random.iter().map(|byte| format!("{byte:02x}")).collect() })
    }

    /// The address of the page.
    pub fn url(&self) -> String {
        format!("http://127.0.0.1:{}{}", self.port, self.path(""))
    }

    /// The path of a resource below the token.
    pub fn path(&self, name: &str) -> String {
        format!("/{}/{name}", self.token)
    }

    /// The reason why a request is refused, if it is.
    pub fn refuses(&self, method: &Method, headers: &HeaderMap) -> Option<&'static str> {
        let own = [format!("127.0.0.1:{}", self.port), format!("localhost:{}", self.port)];
        let Some(host) = only(headers, header::HOST).filter(|host| own.iter().any(|own| own == host)) else {
            return Some("this is not the host that the page is served from");
        };
        let is_own = |origin: &str| origin.strip_prefix("http://") == Some(host);
        match only(headers, header::ORIGIN) {
            Some(origin) if is_own(origin) => None,
            None if !headers.contains_key(header::ORIGIN) && method == Method::GET => None,
            _ => Some("only the page itself may send this request"),
        }
    }
}

/// The header, if there is exactly one.
fn only(headers: &HeaderMap, name: HeaderName) -> Option<&str> {
    let mut all = headers.get_all(name).iter();
    all.next().filter(|_| all.next().is_none())?.to_str().ok()
}
