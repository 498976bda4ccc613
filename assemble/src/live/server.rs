//! The page's server. Input: requests. Output: the page's files, snapshots of fields, and news as server-sent events.
//!
//! Each viewer has its own connection and fetches a field after it has shown the previous one: slow viewers skip
//! rounds, and nothing waits for them.

use super::board::{Board, MIN_PUBLISH_INTERVAL};
use super::field::Field;
use super::guard::Guard;
use super::history::Point;
use super::status::Status;
use axum::Router;
use axum::extract::{Path, Query, Request, State};
use axum::http::{HeaderName, HeaderValue, StatusCode, header};
use axum::middleware::{self, Next};
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use equilux_bake::monitor::Monitor;
use futures_util::Stream;
use futures_util::stream::unfold;
use serde::{Deserialize, Serialize};
use std::convert::Infallible;
use std::sync::Arc;
use std::time::Duration;
use tokio::task::spawn_blocking;
use tokio::time::{Instant, sleep, timeout_at};

/// The data from which requests are answered.
#[derive(Clone)]
pub struct Site {
    /// The published state of the run.
    pub board: Arc<Board>,
    /// The run's progress.
    pub monitor: Arc<Monitor>,
    /// Access control.
    pub guard: Guard,
}

/// Time after which a request for a newer snapshot is answered even if there is none.
const MAX_WAIT: Duration = Duration::from_secs(10);

/// Headers of every response: nothing is loaded from elsewhere, nothing is stored, and the address with its token is
/// not sent to other sites.
const HEADERS: [(HeaderName, &str); 6] = [
    (
        header::CONTENT_SECURITY_POLICY,
        "default-src 'none'; script-src 'self'; connect-src 'self'; style-src 'self'; img-src 'self' data:; \
         base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    ),
    (header::CACHE_CONTROL, "no-store"),
    (header::REFERRER_POLICY, "same-origin"),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
    (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
];

/// The page's files: name, type and text.
const FILES: [(&str, &str, &str); 8] = [
    ("", "text/html; charset=utf-8", include_str!("page.html")),
    ("page.css", "text/css", include_str!("page.css")),
    ("page.js", "text/javascript", include_str!("page.js")),
    ("scene.js", "text/javascript", include_str!("scene.js")),
    ("orbit.js", "text/javascript", include_str!("orbit.js")),
    ("curve.js", "text/javascript", include_str!("curve.js")),
    ("three.module.min.js", "text/javascript", include_str!("vendor/three.module.min.js")),
    ("three.core.min.js", "text/javascript", include_str!("vendor/three.core.min.js")),
];

/// The routes of the server. Requests without the token are refused.
pub fn router(site: Site) -> Router {
    let path = |name: &str| site.guard.path(name);
    let mut router = Router::new();
    for (name, kind, text) in FILES {
        router =
            router.route(&path(name), get(move || async move { ([(header::CONTENT_TYPE, kind)], text) }));
    }
    router
        .route(&path("events"), get(events))
        .route(&path("model"), get(model))
        .route(&path("field/{field}"), get(field))
        .route(&path("stop"), post(stop))
        .route(&path("close"), post(close))
        .fallback(|| async { (StatusCode::FORBIDDEN, "the address lacks the right token") })
        .layer(middleware::from_fn_with_state(site.clone(), guarded))
        .with_state(site)
}

async fn guarded(State(site): State<Site>, request: Request, next: Next) -> Response {
    let mut response = match site.guard.refuses(request.method(), request.headers()) {
        Some(reason) => (StatusCode::FORBIDDEN, reason).into_response(),
        None => next.run(request).await,
    };
    for (name, value) in HEADERS {
        response.headers_mut().insert(name, HeaderValue::from_static(value));
    }
    response
}

async fn model(State(site): State<Site>) -> Response {
    let model = site.board.state().model.clone();
    match model {
        Some(model) => bytes(move || model.bytes()).await,
        None => StatusCode::NO_CONTENT.into_response(),
    }
}

/// The query of a field request.
#[derive(Deserialize)]
struct FieldQuery {
    /// The version of the newest snapshot that the viewer has; 0 for none.
    after: u32,
}

/// A newer snapshot of a field, as soon as there is one.
async fn field(
    State(site): State<Site>,
    Path(field): Path<Field>,
    Query(known): Query<FieldQuery>,
) -> Response {
    let (mut changes, end) = (site.board.viewer(), Instant::now() + MAX_WAIT);
    loop {
        if let Some(snapshot) = site.board.newer(field, known.after) {
            return bytes(move || snapshot.bytes()).await;
        }
        if !matches!(timeout_at(end, changes.changed()).await, Ok(Ok(()))) {
            return StatusCode::NO_CONTENT.into_response();
        }
    }
}

/// Create bytes in another thread, while other requests are served.
async fn bytes(make: impl FnOnce() -> Vec<u8> + Send + 'static) -> Response {
    match spawn_blocking(make).await {
        Ok(bytes) => ([(header::CONTENT_TYPE, "application/octet-stream")], bytes).into_response(),
        Err(_) => StatusCode::INTERNAL_SERVER_ERROR.into_response(),
    }
}

async fn stop(State(site): State<Site>) -> Response {
    if site.board.stop() {
        StatusCode::NO_CONTENT.into_response()
    } else {
        (StatusCode::CONFLICT, "there is no exchange to stop now").into_response()
    }
}

/// End the program, unless a run is in progress.
async fn close(State(site): State<Site>) -> Response {
    let phase = site.board.state().status.phase;
    if phase.is_over() {
        site.monitor.stop();
        StatusCode::NO_CONTENT.into_response()
    } else {
        (StatusCode::CONFLICT, "the run is not over").into_response()
    }
}

/// News for a viewer, as JSON.
#[derive(Serialize)]
struct News {
    /// The status of the run, if it has changed.
    #[serde(skip_serializing_if = "Option::is_none")]
    status: Option<Status>,
    /// Points of the curve that were not sent yet.
    points: Vec<Point>,
    /// The newest round.
    now: Option<Point>,
    /// Times of the paper's steps 5 to 8 so far, seconds.
    steps: [f64; 4],
    /// The current stage, its finished steps and its total steps.
    stage: (String, u64, u64),
}

/// The state that a viewer has received.
#[derive(Default, PartialEq, Clone)]
struct ViewerState {
    run: u32,
    status: Option<u64>,
    points: usize,
    now: Option<Point>,
    stage: Option<(String, u64, u64)>,
}

async fn events(State(site): State<Site>) -> Sse<impl Stream<Item = Result<Event, Infallible>>> {
    // The receiver counts as a viewer while it exists.
    let viewer = site.board.viewer();
    let stream = unfold((site, ViewerState::default(), viewer), |(site, mut sent, viewer)| async move {
        loop {
            if sent.status.is_some() {
                sleep(MIN_PUBLISH_INTERVAL).await;
            }
            if let Some(news) = news(&site, &mut sent) {
                let event = Event::default().json_data(news).expect("news are plain data");
                return Some((Ok(event), (site, sent, viewer)));
            }
        }
    });
    Sse::new(stream).keep_alive(KeepAlive::default())
}

/// The changes since `sent`, if there are any.
fn news(site: &Site, sent: &mut ViewerState) -> Option<News> {
    let progress = site.monitor.now();
    let state = site.board.state();
    let run = state.status.run;
    let from = if sent.run == run { sent.points } else { 0 };
    let points = state.history.since(from).to_vec();
    let now = ViewerState {
        run,
        status: Some(state.status_number),
        points: from + points.len(),
        now: state.history.last(),
        stage: Some((progress.step.what, progress.done, progress.step.total)),
    };
    if now == *sent {
        return None;
    }
    let seconds = &state.status.seconds;
    let news = News {
        status: (sent.status != now.status).then(|| state.status.clone()),
        points,
        now: now.now,
        steps: [seconds.step5, seconds.step6, seconds.step7, seconds.step8],
        stage: now.stage.clone().expect("set above"),
    };
    *sent = now;
    Some(news)
}
