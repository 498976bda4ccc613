//! Takes results from the cache, or computes and caches them. The reasons derive from the manifest that the key derives from.

use crate::monitor::Monitor;
use equilux_formats::fingerprint::{Key, Manifest};
use equilux_formats::store::{Lookup, Turn};
use equilux_formats::stored::Stored;
use equilux_formats::{Result, Store};
use std::time::Duration;

/// Where a result came from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Origin {
    /// It was in the cache.
    Reused,
    /// It was in the cache, made from other inputs with the same result; the difference of the inputs.
    Unchanged(String),
    /// It was computed for this reason.
    Computed(String),
}

impl Origin {
    /// Whether nothing had to be computed.
    pub fn is_reused(&self) -> bool {
        !matches!(self, Self::Computed(_))
    }
}

impl std::fmt::Display for Origin {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Reused => write!(f, "reused: all inputs are unchanged"),
            Self::Unchanged(reason) => write!(f, "reused: {reason}, and nothing of that matters here"),
            Self::Computed(reason) => write!(f, "computed: {reason}"),
        }
    }
}

/// The origin that [`cached`] would return, without computing anything.
pub fn foreseen<T: Stored>(store: &Store, name: &str, manifest: &Manifest) -> Origin {
    look_up::<T>(store, name, manifest).map_or_else(Origin::Computed, |_| Origin::Reused)
}

/// The value if the cache has it, or why it has to be computed.
fn look_up<T: Stored>(store: &Store, name: &str, manifest: &Manifest) -> std::result::Result<T, String> {
    match store.load::<T>(&manifest.key()) {
        Lookup::Found(value) => Ok(value),
        Lookup::Missing => Err(match store.last_manifest(name) {
            None => "never computed before".to_string(),
            Some(old) => manifest.difference(&old).unwrap_or_else(|| "the cached file is gone".to_string()),
        }),
        Lookup::Damaged(error) => Err(format!("the cached file cannot be used ({error})")),
    }
}

/// Interval between checks whether another process is done.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// A value that was not in the cache.
#[derive(Debug)]
pub enum NewValue<T> {
    /// Computed from scratch.
    Whole(T),
    /// An updated older value, and a description of how much of it was computed.
    Revised(T, String),
    /// Equal to the value already cached under this key.
    AsUnder(Key, T),
}

/// The value that `manifest` describes, and its origin. `name` identifies its older versions. Of all processes that
/// share the cache, one computes the value and the others wait for it. `compute` must not use the cache itself: see
/// [`Store::try_turn`].
pub fn cached<T: Stored>(
    store: &Store,
    name: &str,
    manifest: &Manifest,
    monitor: &Monitor,
    compute: impl FnOnce() -> Result<T>,
) -> Result<(T, Origin)> {
    cached_or_revised(store, name, manifest, monitor, || compute().map(NewValue::Whole))
}

/// Like [`cached`], for values that `make` may derive from an older value.
pub fn cached_or_revised<T: Stored>(
    store: &Store,
    name: &str,
    manifest: &Manifest,
    monitor: &Monitor,
    make: impl FnOnce() -> Result<NewValue<T>>,
) -> Result<(T, Origin)> {
    let mut found = look_up(store, name, manifest);
    let mut _turn = None;
    if found.is_err() {
        _turn = wait_for_turn(store, name, manifest, monitor);
        // Another process may have computed it in the meantime.
        found = look_up(store, name, manifest);
    }
    let (value, origin) = match found {
        Ok(value) => (value, Origin::Reused),
        Err(reason) => {
            let made = make()?;
            if let NewValue::Whole(value) | NewValue::Revised(value, _) = &made {
                store.save(manifest, value)?;
            }
            match made {
                NewValue::Whole(value) => (value, Origin::Computed(reason)),
                NewValue::Revised(value, how) => (value, Origin::Computed(format!("{reason}; {how}"))),
                NewValue::AsUnder(key, value) => {
                    store.save_alias(manifest, &key)?;
                    (value, Origin::Unchanged(reason))
                }
            }
        }
    };
    store.remember(name, manifest)?;
    Ok((value, origin))
}

/// Waits for the turn to compute; none if the monitor is stopped before another process is done.
fn wait_for_turn(store: &Store, name: &str, manifest: &Manifest, monitor: &Monitor) -> Option<Turn> {
    let key = manifest.key();
    while !monitor.stopped() {
        if let Some(turn) = store.try_turn(&key) {
            return Some(turn);
        }
        monitor.begin(format!("another process computes {name}: waiting for it"), 0, 0.0);
        std::thread::sleep(POLL_INTERVAL);
    }
    None
}
