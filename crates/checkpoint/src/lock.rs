//! Locks on files, and marks that tell files apart.

use crate::error::StateError;
use sightlines_formats::process_mark;
use std::fs::{File, TryLockError};
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::SystemTime;
use xxhash_rust::xxh3::Xxh3;

/// Locks a file until it is closed, for this process alone. A file system without locks grants it.
///
/// # Errors
/// [`StateError::InUse`] if another one has it.
pub(crate) fn lock(path: &Path, file: &File) -> Result<(), StateError> {
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(StateError::InUse(path.to_owned())),
        Ok(()) | Err(TryLockError::Error(_)) => Ok(()),
    }
}

/// A mark that no other file has.
pub(crate) fn new_mark() -> [u8; 16] {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let mut hasher = Xxh3::new();
    hasher.update(process_mark().as_bytes());
    let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    hasher.update(&now.as_nanos().to_le_bytes());
    hasher.update(&COUNT.fetch_add(1, Relaxed).to_le_bytes());
    hasher.digest128().to_le_bytes()
}
