//! Take from the cache, or compute and keep; and say which and why, from the same manifest that makes the key.

use equilux_formats::{Lookup, Manifest, Result, Store, Stored};

/// Where a result came from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Origin {
    /// It was in the cache.
    Reused,
    /// It was computed, for this reason.
    Computed(String),
}

impl Origin {
    /// Whether nothing had to be computed.
    pub fn is_reused(&self) -> bool {
        *self == Self::Reused
    }
}

impl std::fmt::Display for Origin {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Reused => write!(f, "reused: all inputs are unchanged"),
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

/// The value that `manifest` describes; `name` is what its older versions were called. `compute` returns none if it
/// was stopped, and then so does this.
pub fn cached<T: Stored>(
    store: &Store,
    name: &str,
    manifest: &Manifest,
    compute: impl FnOnce() -> Result<Option<T>>,
) -> Result<Option<(T, Origin)>> {
    let reason = match look_up(store, name, manifest) {
        Ok(value) => {
            store.remember(name, manifest)?;
            return Ok(Some((value, Origin::Reused)));
        }
        Err(reason) => reason,
    };
    let Some(value) = compute()? else { return Ok(None) };
    store.save(manifest, &value)?;
    store.remember(name, manifest)?;
    Ok(Some((value, Origin::Computed(reason))))
}
