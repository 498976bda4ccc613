//! Who may ask the page's server for anything: only pages that it served itself. In goes a request's head; out comes a refusal
//! or none.
//!
//! The token in the path keeps out other programs' users on this machine and pages of other origins that guess ports. A page of
//! another origin that has its name point here (DNS rebinding) names itself as the host, and whatever it sends across origins
//! names its origin.

use axum::http::{HeaderMap, HeaderName, Method, header};

/// What this server is called, and the token in its paths.
#[derive(Debug, Clone)]
pub struct Guard {
    port: u16,
    token: String,
}

impl Guard {
    /// The guard of a server on this port, with a token of 128 random bits. Fails where the system has none.
    pub fn new(port: u16) -> Result<Self, getrandom::Error> {
        let mut random = [0; 16];
        getrandom::fill(&mut random)?;
        Ok(Self { port, token: random.iter().map(|byte| format!("{byte:02x}")).collect() })
    }

    /// Where the page is.
    pub fn url(&self) -> String {
        format!("http://127.0.0.1:{}{}", self.port, self.path(""))
    }

    /// The path of something below the token.
    pub fn path(&self, name: &str) -> String {
        format!("/{}/{name}", self.token)
    }

    /// Why a request is refused, if it is.
    pub fn refuses(&self, method: &Method, headers: &HeaderMap) -> Option<&'static str> {
        let own = [format!("127.0.0.1:{}", self.port), format!("localhost:{}", self.port)];
        let Some(host) = only(headers, header::HOST).filter(|host| own.iter().any(|own| own == host)) else {
            return Some("this is not the host that the page is served from");
        };
        let is_own = |origin: &str| origin.strip_prefix("http://") == Some(host);
        match only(headers, header::ORIGIN) {
            Some(origin) if is_own(origin) => None,
            None if !headers.contains_key(header::ORIGIN) && method == Method::GET => None,
            _ => Some("only the page itself may ask for this"),
        }
    }
}

/// The header, if there is exactly one.
fn only(headers: &HeaderMap, name: HeaderName) -> Option<&str> {
    let mut all = headers.get_all(name).iter();
    all.next().filter(|_| all.next().is_none())?.to_str().ok()
}
