//! Writing a file as a whole or not at all.

use crate::debris::{Hidden, remove_left};
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A file that could not be written. What was there before is untouched.
#[derive(Debug, thiserror::Error)]
#[error("{}: cannot be written: {source}", path.display())]
pub struct WriteError {
    /// The file, as the caller named it.
    pub path: PathBuf,
    /// The error of the system.
    #[source]
    pub source: io::Error,
}

/// Replaces the file at `path` by `bytes`, or leaves it as it was.
///
/// The bytes go into a new file in the same folder, which is then renamed: a reader of `path` finds the old content or
/// the new, never a part. Symbolic links are followed, and the permissions of a replaced file are kept. An existing
/// target that is not a regular file (a pipe, a terminal, `/dev/null`) has no old content to preserve and is written
/// directly.
///
/// New files that earlier calls for the same path left beside it, because their process was killed, are removed ([`remove_left`]). A file that is being written
/// is locked; one that is not, and whose process has ended, or that nobody has written to for a minute, is left over. Of another machine, or where there are no
/// locks, it has to be a day.
///
/// # Errors
/// [`WriteError`] with the system's reason; the new file is removed again.
pub fn atomic_write(path: impl AsRef<Path>, bytes: &[u8]) -> Result<(), WriteError> {
    let path = path.as_ref();
    replace(path, bytes).map_err(|source| WriteError { path: path.to_owned(), source })
}

fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let (target, permissions) = match fs::metadata(path) {
        Ok(old) if old.is_file() => (fs::canonicalize(path)?, Some(old.permissions())),
        Ok(_) => return OpenOptions::new().write(true).open(path)?.write_all(bytes),
        Err(error) if error.kind() == io::ErrorKind::NotFound => (path.to_owned(), None),
        Err(error) => return Err(error),
    };
    remove_left(&target);
    let (beside, mut file) = create_beside(&target)?;
    let written = file
        .write_all(bytes)
        .and_then(|()| permissions.map_or(Ok(()), |p| file.set_permissions(p)))
        .and_then(|()| file.sync_all());
    // Its lock holds until it has its name; but some systems refuse to rename a file that is still open.
    let open = cfg!(unix).then_some(file);
    let renamed = written.and_then(|()| fs::rename(&beside, &target));
    drop(open);
    if renamed.is_err() {
        // The reason above is the one to report, even if the removal fails too.
        let _ = fs::remove_file(&beside);
    }
    renamed
}

/// A new file in the folder of `target`, under a name that no file there has.
fn create_beside(target: &Path) -> io::Result<(PathBuf, File)> {
    for attempt in 0..100u32 {
        let beside = Hidden::New.beside(target, attempt).ok_or(io::ErrorKind::InvalidInput)?;
        match OpenOptions::new().write(true).create_new(true).open(&beside) {
            Ok(file) => {
                // Without locks its age protects it.
                let _ = file.try_lock();
                return Ok((beside, file));
            }
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
    Err(io::ErrorKind::AlreadyExists.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What this process writes is locked until it has its name.
    #[test]
    fn files_are_locked_while_they_are_written() {
        let folder = tempfile::tempdir().unwrap();
        let (beside, file) = create_beside(&folder.path().join("out.wad")).unwrap();
        let again = File::options().write(true).open(&beside).unwrap();
        assert!(matches!(again.try_lock(), Err(fs::TryLockError::WouldBlock)));
        drop(file);
        assert!(again.try_lock().is_ok());
    }
}
