//! What tests across crates share: where real data is, and what was seen there.

pub mod certificates;
pub mod merged;
mod numbers;
pub mod quake_bytes;
pub mod scenes;
pub mod simplified;
pub mod stored;
pub mod surfaces;
pub mod volumes;
pub mod world_files;

#[cfg(doctest)]
#[doc = include_str!("../../docs/guides/rust-engine.md")]
struct GuideDoctests;

#[cfg(doctest)]
#[doc = include_str!("../../docs/guides/servers.md")]
struct ServerGuideDoctests;

#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct ReadmeDoctests;

pub use scenes::{CellWitness, scene_folders, scene_witness};

use std::path::{Path, PathBuf};

/// The folder that an environment variable names; `None`, said loudly, if it is not set.
///
/// # Panics
/// If it is set and is no folder: a wrong setting must not pass for "no data".
pub fn data_folder(variable: &str) -> Option<PathBuf> {
    let Some(folder) = std::env::var_os(variable).map(PathBuf::from) else {
        eprintln!("SKIPPED: {variable} is not set, so real data is not tested");
        return None;
    };
    assert!(folder.is_dir(), "{variable} names no folder: {}", folder.display());
    Some(folder)
}

/// Files of a folder with an extension, sorted by name.
///
/// # Panics
/// If the folder cannot be read or holds none.
pub fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut files: Vec<PathBuf> = entries.map(|e| e.expect("a folder entry").path()).collect();
    files.retain(|f| f.extension().is_some_and(|e| e == extension));
    files.sort();
    assert!(!files.is_empty(), "no .{extension} file in {}", folder.display());
    files
}

/// How a REJECT table compares with pairs that were seen.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Comparison {
    /// Ordered pairs that were seen and are rejected: wrong.
    pub n_wrong: u64,
    /// Ordered pairs that were not seen.
    pub n_unseen: u64,
    /// Ordered pairs that were not seen and are rejected.
    pub n_rejected_unseen: u64,
}

impl Comparison {
    /// Compares bit by bit; both are `n_sectors` squared bits, least significant first.
    ///
    /// # Panics
    /// If the lengths differ from that.
    pub fn of(n_sectors: u32, reject: &[u8], seen: &[u8]) -> Self {
        let n_bits = u64::from(n_sectors).pow(2);
        let n_bytes = usize::try_from(n_bits.div_ceil(8)).expect("tables fit memory");
        assert_eq!((reject.len(), seen.len()), (n_bytes, n_bytes), "tables of {n_sectors} sectors");
        let ones = |f: &dyn Fn(u8, u8) -> u8| -> u64 {
            reject.iter().zip(seen).map(|(&r, &s)| u64::from(f(r, s).count_ones())).sum()
        };
        Self {
            n_wrong: ones(&|r, s| r & s),
            n_unseen: n_bits - ones(&|_, s| s),
            n_rejected_unseen: ones(&|r, s| r & !s),
        }
    }

    /// Sums over maps.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self {
            n_wrong: self.n_wrong + other.n_wrong,
            n_unseen: self.n_unseen + other.n_unseen,
            n_rejected_unseen: self.n_rejected_unseen + other.n_rejected_unseen,
        }
    }

    /// Rejected pairs over pairs not seen.
    pub fn tightness(&self) -> f64 {
        self.n_rejected_unseen as f64 / self.n_unseen as f64
    }
}
