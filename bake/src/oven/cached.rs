//! Take from the cache, or compute and keep; and say which and why, from the same manifest that makes the key.

use crate::monitor::Monitor;
use equilux_formats::{Key, Lookup, Manifest, Result, Store, Stored, Turn};
use std::time::Duration;

/// Where a result came from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Origin {
    /// It was in the cache.
    Reused,
    /// It was in the cache, made from something else, but that changes nothing; what changed.
    Unchanged(String),
    /// It was computed, for this reason.
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

/// Where [`cached`] would take the value from.
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

/// How often it is asked whether another process is done.
const PATIENCE: Duration = Duration::from_millis(50);

/// How a value was made that the cache did not have.
#[derive(Debug)]
pub enum NewValue<T> {
    /// From the start.
    Whole(T),
    /// By bringing an older one up to date; how much of it, for a person.
    Revised(T, String),
    /// It is what already lies under this key.
    AsUnder(Key, T),
}

/// The value that `manifest` describes; `name` is what its older versions were called. Of all processes that share the
/// cache one computes it, the others wait for that one.
/// It must not ask for anything cached itself: see [`Store::try_turn`].
pub fn cached<T: Stored>(
    store: &Store,
    name: &str,
    manifest: &Manifest,
    monitor: &Monitor,
    compute: impl FnOnce() -> Result<T>,
) -> Result<(T, Origin)> {
    cached_or_revised(store, name, manifest, monitor, || compute().map(NewValue::Whole))
}

/// The same where `make` may know an older value to start from.
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
        // Another process may have made it meanwhile.
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

/// The turn to compute; none if the monitor is stopped before another process is done.
fn wait_for_turn(store: &Store, name: &str, manifest: &Manifest, monitor: &Monitor) -> Option<Turn> {
    let key = manifest.key();
    while !monitor.stopped() {
        if let Some(turn) = store.try_turn(&key) {
            return Some(turn);
        }
        monitor.begin(format!("another process computes {name}: waiting for it"), 0, 0.0);
        std::thread::sleep(PATIENCE);
    }
    None
}
