//! A folder of results that appears whole or not at all.

use crate::error::OutputError;
use sightlines::formats::{Hidden, atomic_write, remove_left};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// A folder that is filled beside its place, and removed unless it is finished.
#[derive(Debug)]
pub(crate) struct NewFolder {
    target: PathBuf,
    beside: PathBuf,
}

impl NewFolder {
    /// Creates a folder that will replace `target`, which must not exist or contain only files whose names are `ours`.
    pub(crate) fn new(target: &Path, ours: impl Fn(&str) -> bool) -> Result<Self, OutputError> {
        let failed = |source| OutputError::Folder { path: target.to_owned(), source };
        // Resolves names that end in a dot or a slash.
        let target = match target.canonicalize() {
            Ok(found) => found,
            Err(error) if error.kind() == io::ErrorKind::NotFound => target.to_owned(),
            Err(error) => return Err(failed(error)),
        };
        // What is put back is there from here on.
        remove_left(&target);
        if target.exists() {
            for entry in fs::read_dir(&target).map_err(failed)? {
                let entry = entry.map_err(failed)?;
                let name = entry.file_name().to_string_lossy().into_owned();
                if !ours(&name) || !entry.file_type().map_err(failed)?.is_file() {
                    return Err(OutputError::NotLevels { path: target, name });
                }
            }
        }
        let beside = Hidden::New.beside(&target, 0).ok_or_else(|| failed(io::ErrorKind::InvalidInput.into()))?;
        fs::create_dir(&beside).map_err(failed)?;
        Ok(Self { target, beside })
    }

    /// Writes a file into it.
    pub(crate) fn save(&self, name: &str, bytes: &[u8]) -> Result<(), OutputError> {
        Ok(atomic_write(self.beside.join(name), bytes)?)
    }

    /// Puts it in its place.
    pub(crate) fn finish(self) -> Result<(), OutputError> {
        let failed = |source| OutputError::Folder { path: self.target.clone(), source };
        if !self.target.exists() {
            return fs::rename(&self.beside, &self.target).map_err(failed);
        }
        let old = Hidden::Old.beside(&self.target, 0).ok_or_else(|| failed(io::ErrorKind::InvalidInput.into()))?;
        fs::rename(&self.target, &old).map_err(failed)?;
        if let Err(error) = fs::rename(&self.beside, &self.target) {
            // The old folder is put back; the error above is the one to report.
            let _ = fs::rename(&old, &self.target);
            return Err(failed(error));
        }
        fs::remove_dir_all(&old).map_err(failed)
    }
}

impl Drop for NewFolder {
    fn drop(&mut self) {
        // Nothing is left once the folder is in its place.
        let _ = fs::remove_dir_all(&self.beside);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn folders_appear_whole_and_replace_only_ours() {
        let all = tempfile::tempdir().unwrap();
        let target = all.path().join("levels");
        let ours = |name: &str| name.ends_with(".x");
        drop(NewFolder::new(&target, ours).unwrap());
        assert!(names(all.path()).is_empty());
        for files in [&["a.x", "b.x"][..], &["c.x"], &[]] {
            let new = NewFolder::new(&target, ours).unwrap();
            files.iter().for_each(|name| new.save(name, b"").unwrap());
            new.finish().unwrap();
            assert_eq!(
                (names(&target), names(all.path())),
                (files.iter().map(|s| (*s).to_owned()).collect(), vec!["levels".to_owned()])
            );
        }
        fs::write(target.join("letter"), "dear").unwrap();
        let error = NewFolder::new(&target, ours).unwrap_err().to_string();
        assert!(error.contains("the folder has \"letter\" in it"), "{error}");
        assert!(NewFolder::new(&target.join("letter"), ours).is_err());
        assert!(NewFolder::new(&all.path().join("no/such"), ours).is_err());
        assert_eq!(names(all.path()), ["levels"]);
    }
}
