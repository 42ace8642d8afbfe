//! A folder of results that appears whole or not at all.

use crate::debris::{Hidden, remove_left};
use crate::files::{WriteError, atomic_write};
use std::cell::OnceCell;
use std::path::{Path, PathBuf};
use std::{fs, io};

/// Why a folder is not replaced. What was there before is untouched.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FolderError {
    /// It cannot be made.
    #[error("{}: cannot be made: {source}", path.display())]
    Make {
        /// The folder.
        path: PathBuf,
        /// The error of the system.
        source: io::Error,
    },
    /// It has something in it that is not of its kind.
    #[error("{}: the folder has {name:?} in it", path.display())]
    Other {
        /// The folder.
        path: PathBuf,
        /// What is in it.
        name: String,
    },
    /// A file in it cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// A folder that is filled beside its place, and removed unless it is finished.
#[derive(Debug)]
pub struct NewFolder {
    target: PathBuf,
    /// None before anything is written: what stands empty for long would be taken for something that a killed process left.
    beside: OnceCell<PathBuf>,
}

impl NewFolder {
    /// Expects a folder that will replace `target`, which must not exist or contain only files whose names are `ours`.
    ///
    /// # Errors
    /// [`FolderError::Make`] for a place where no folder can be made, and [`FolderError::Other`].
    pub fn new(target: &Path, ours: impl Fn(&str) -> bool) -> Result<Self, FolderError> {
        let failed = |error| cannot_be_made(target, error);
        // Resolves names that end in a dot or a slash.
        let target = match target.canonicalize() {
            Ok(found) => found,
            Err(error) if error.kind() == io::ErrorKind::NotFound => behind_link(target),
            Err(error) => return Err(failed(error)),
        };
        // What is put back is there from here on.
        remove_left(&target);
        if target.exists() {
            for entry in fs::read_dir(&target).map_err(failed)? {
                let entry = entry.map_err(failed)?;
                let name = entry.file_name().to_string_lossy().into_owned();
                if !ours(&name) || !entry.file_type().map_err(failed)?.is_file() {
                    return Err(FolderError::Other { path: target, name });
                }
            }
        }
        // One can be made there.
        fs::remove_dir(create_beside(&target).map_err(failed)?).map_err(failed)?;
        Ok(Self { target, beside: OnceCell::new() })
    }

    fn beside(&self) -> Result<&Path, FolderError> {
        if let Some(beside) = self.beside.get() {
            return Ok(beside);
        }
        let made = create_beside(&self.target).map_err(|error| cannot_be_made(&self.target, error))?;
        Ok(self.beside.get_or_init(|| made))
    }

    /// Writes a file into it.
    ///
    /// # Errors
    /// [`FolderError::Make`], and [`FolderError::Write`].
    pub fn save(&self, name: &str, bytes: &[u8]) -> Result<(), FolderError> {
        Ok(atomic_write(self.beside()?.join(name), bytes)?)
    }

    /// Puts it in its place. Returns what the folder was before, if that cannot be removed, and why.
    ///
    /// # Errors
    /// [`FolderError::Make`].
    pub fn finish(self) -> Result<Option<(PathBuf, io::Error)>, FolderError> {
        let failed = |error| cannot_be_made(&self.target, error);
        let beside = self.beside()?;
        if !self.target.exists() {
            return fs::rename(beside, &self.target).map(|()| None).map_err(failed);
        }
        let old = free_beside(&self.target, Hidden::Old).map_err(failed)?;
        fs::rename(&self.target, &old).map_err(failed)?;
        if let Err(error) = fs::rename(beside, &self.target) {
            // The old folder is put back; the error above is the one to report.
            let _ = fs::rename(&old, &self.target);
            return Err(failed(error));
        }
        Ok(fs::remove_dir_all(&old).err().map(|error| (old, error)))
    }
}

fn cannot_be_made(path: &Path, source: io::Error) -> FolderError {
    FolderError::Make { path: path.to_owned(), source }
}

/// What a link leads to that leads nowhere; anything else as it is.
fn behind_link(target: &Path) -> PathBuf {
    let behind = fs::read_link(target).map(|to| target.parent().unwrap_or(Path::new("")).join(to));
    behind.unwrap_or_else(|_| target.to_owned())
}

/// A hidden path that nothing has.
fn free_beside(target: &Path, hidden: Hidden) -> io::Result<PathBuf> {
    for attempt in 0..100 {
        let path = hidden.beside(target, attempt).ok_or(io::ErrorKind::InvalidInput)?;
        if fs::symlink_metadata(&path).is_err_and(|error| error.kind() == io::ErrorKind::NotFound) {
            return Ok(path);
        }
    }
    Err(io::ErrorKind::AlreadyExists.into())
}

fn create_beside(target: &Path) -> io::Result<PathBuf> {
    let path = free_beside(target, Hidden::New)?;
    fs::create_dir(&path)?;
    Ok(path)
}

impl Drop for NewFolder {
    fn drop(&mut self) {
        // Nothing is left once the folder is in its place.
        let _ = self.beside.get().map(fs::remove_dir_all);
    }
}
