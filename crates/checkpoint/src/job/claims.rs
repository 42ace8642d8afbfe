//! Which process does which shard, where none is told: each claims some by locks, which end with the process.

use super::{Job, JobError};
use crate::lock::lock;
use sightlines_formats::WriteError;
use std::fs::{self, File, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};

/// How many shards a process does next, of so many that are left of `n` in all, if about `n_workers` share them.
///
/// What a process prepares takes time that is lost, so it takes several, and fewer towards the end, so that all end at about the same time (Polychronopoulos and Kuck,
/// "Guided self-scheduling", 1987). The last batches are as small as a sixteenth of what a worker has in all.
pub fn batch(left: usize, n: usize, n_workers: usize) -> usize {
    let n_workers = n_workers.max(1);
    left.div_ceil(n_workers.saturating_mul(2)).max(n / n_workers.saturating_mul(16)).max(1)
}

/// Shards that a process claims at once, at most. Each has two files open: its claim and its journal.
const MOST: usize = 128;

/// A lock on a file of a job, which other processes respect. On a file system without locks everybody gets it: work is then done twice, with the same results.
#[derive(Debug)]
pub(super) struct Claim {
    path: PathBuf,
    _file: File,
}

impl Claim {
    /// Claims what a file stands for; `None` if another process has it.
    pub(super) fn of(path: PathBuf) -> Result<Option<Self>, JobError> {
        let failed = |source| JobError::Write(WriteError { path: path.clone(), source });
        // The folder of parts may have been cleared.
        fs::create_dir_all(path.parent().unwrap_or(Path::new("."))).map_err(failed)?;
        loop {
            let Some(file) = Self::open(&path).map_err(failed)? else { return Ok(None) };
            if lock(&path, &file).is_err() {
                return Ok(None);
            }
            // Whoever had it may have removed the file between the two.
            if is_of_path(&file, &path) {
                return Ok(Some(Self { path, _file: file }));
            }
        }
    }

    fn open(path: &Path) -> io::Result<Option<File>> {
        match OpenOptions::new().create(true).truncate(false).write(true).open(path) {
            // Windows refuses to open what another process is about to remove.
            Err(error) if error.kind() == io::ErrorKind::PermissionDenied && cfg!(windows) => Ok(None),
            file => file.map(Some),
        }
    }
}

/// Whether an open file is the one that is found by its path.
#[cfg(unix)]
fn is_of_path(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let id = |metadata: fs::Metadata| (metadata.dev(), metadata.ino());
    file.metadata().is_ok_and(|open| fs::metadata(path).is_ok_and(|found| id(open) == id(found)))
}

/// Elsewhere a file that is open is not removed.
#[cfg(not(unix))]
fn is_of_path(_: &File, _: &Path) -> bool {
    true
}

impl Drop for Claim {
    fn drop(&mut self) {
        // What stays is claimed by the next process that needs it.
        let _ = fs::remove_file(&self.path);
    }
}

/// Shards that this process has claimed, and nobody has done.
#[derive(Debug, Default)]
pub(super) struct Claims {
    pub(super) shards: Vec<usize>,
    _held: Vec<Claim>,
}

impl Claims {
    /// Claims the first shards of these that nobody has, `size` of them at most, and no more than [`MOST`].
    pub(super) fn of(job: &Job, shards: impl IntoIterator<Item = usize>, size: usize) -> Result<Self, JobError> {
        let mut claims = Self::default();
        for shard in shards {
            if claims.shards.len() == size.min(MOST) {
                break;
            }
            let Some(claim) = Claim::of(job.part_path(shard).with_extension("part.claim"))? else { continue };
            // Whoever had it before may have done it.
            if !job.part_path(shard).is_file() {
                claims.shards.push(shard);
                claims._held.push(claim);
            }
        }
        Ok(claims)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn batches_shrink_and_are_few() {
        let batches = |n: usize, workers: usize| {
            let (mut left, mut all) = (n, Vec::new());
            while left > 0 {
                all.push(batch(left, n, workers).min(left));
                left -= all[all.len() - 1];
            }
            all
        };
        assert_eq!(batches(64, 2), [16, 12, 9, 7, 5, 4, 3, 2, 2, 2, 2]);
        assert_eq!(batches(5, 8), [1; 5]);
        assert_eq!((batches(0, 1), batch(7, 7, usize::MAX), batch(7, 7, 0)), (vec![], 1, 4));
        // However many shards there are, a worker prepares a few times.
        for n in [32, 64, 1000, 100_000] {
            for workers in [1, 2, 8] {
                let n_batches = batches(n, workers).len();
                assert!(n_batches <= 12 * workers, "{n} by {workers}: {n_batches}");
            }
        }
    }

    #[test]
    fn a_claim_is_of_one_process_until_it_ends() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("parts").join("3.part.claim");
        let claim = Claim::of(path.clone()).unwrap();
        assert!(claim.is_some());
        (0..2).for_each(|_| assert!(Claim::of(path.clone()).unwrap().is_none()));
        drop(claim);
        assert!(!path.exists());
        // What a process left that was killed is in nobody's way.
        fs::write(&path, b"").unwrap();
        assert!(Claim::of(path).unwrap().is_some());
    }
}
