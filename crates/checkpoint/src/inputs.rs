//! What decides the results of a work: files as they were before they were read, and values.

use crate::error::StateError;
use crate::key::{Key, KeyHasher};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};
use std::{fmt, fs, io};

/// A file that a job reads.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct InputFile {
    /// Its path, as the command names it.
    pub path: String,
    /// Its length.
    pub n_bytes: u64,
    /// The key of its content.
    pub key: String,
}

/// The times of files are as coarse as this on some systems.
const COARSE: Duration = Duration::from_secs(3);

/// The files that a work reads, as they were before it read them.
#[derive(Debug, Default)]
pub struct Inputs(Vec<Looked>);

#[derive(Debug)]
struct Looked {
    path: PathBuf,
    n_bytes: u64,
    key: Key,
    modified: Option<SystemTime>,
    /// Whether it was written so recently that a change may leave the time of the last one as it is.
    is_fresh: bool,
}

impl Inputs {
    /// Looks at all content of files before they are read.
    ///
    /// # Errors
    /// [`StateError::Read`].
    pub fn look<'p>(paths: impl IntoIterator<Item = &'p Path>) -> Result<Self, StateError> {
        let looked = paths.into_iter().map(|path| Looked::new(path).map_err(|source| StateError::read(path, source)));
        Ok(Self(looked.collect::<Result<_, _>>()?))
    }

    /// Names of files alone, for a work whose results nobody keeps; no content and no time is that of these.
    pub fn names<'p>(paths: impl IntoIterator<Item = &'p Path>) -> Self {
        let nothing = |path: &Path| Looked {
            path: path.to_owned(),
            n_bytes: 0,
            key: Key([0; 16]),
            modified: None,
            is_fresh: false,
        };
        Self(paths.into_iter().map(nothing).collect())
    }

    /// Refuses files that are not what was looked at. Reads the content only of those that were just written.
    ///
    /// # Errors
    /// [`StateError`].
    pub fn check(&self) -> Result<(), StateError> {
        (0..self.0.len()).try_for_each(|nth| self.check_file(nth))
    }

    /// Refuses one of them if it is not what was looked at.
    ///
    /// # Errors
    /// [`StateError`].
    pub fn check_file(&self, nth: usize) -> Result<(), StateError> {
        let Some(looked) = self.0.get(nth) else { return Ok(()) };
        match looked.is_same() {
            Ok(true) => Ok(()),
            Ok(false) => Err(StateError::InputChanged(looked.path.clone())),
            Err(source) => Err(StateError::read(&looked.path, source)),
        }
    }

    /// The names of the files.
    pub fn paths(&self) -> impl Iterator<Item = &Path> {
        self.0.iter().map(|looked| looked.path.as_path())
    }
}

impl Looked {
    fn new(path: &Path) -> io::Result<Self> {
        // Before the content: what is changed in between has a later time.
        let modified = fs::metadata(path)?.modified().ok();
        let (n_bytes, key) = KeyHasher::new("").file("", path)?;
        let age = modified.and_then(|modified| modified.elapsed().ok());
        Ok(Self { path: path.to_owned(), n_bytes, key, modified, is_fresh: age.is_none_or(|age| age < COARSE) })
    }

    fn is_same(&self) -> io::Result<bool> {
        let found = fs::metadata(&self.path)?;
        if found.len() != self.n_bytes || found.modified().ok() != self.modified {
            return Ok(false);
        }
        Ok(!self.is_fresh || KeyHasher::new("").file("", &self.path)?.1 == self.key)
    }
}

/// What decides the results of a work: a key, and the files that it reads.
#[derive(Debug)]
pub struct Identity {
    hasher: KeyHasher,
    /// The files.
    pub inputs: Vec<InputFile>,
}

impl Identity {
    /// Of a kind of work on the content of files.
    ///
    /// * `program`: its version
    /// * `units`: to be raised when a work is divided into other units, or decides otherwise, while the version stays
    pub fn new((program, units): (&str, u32), kind: &str, inputs: &Inputs) -> Self {
        let mut identity = Self::apart_from((program, units), kind, inputs);
        inputs.0.iter().for_each(|file| identity.hasher.value("file", &file.key.0));
        identity
    }

    /// The same of what is added later only: the files may have other content with the same results.
    pub fn apart_from((program, units): (&str, u32), kind: &str, inputs: &Inputs) -> Self {
        let mut hasher = KeyHasher::new(program);
        hasher.value("kind", kind.as_bytes());
        hasher.value("units", &units.to_le_bytes());
        let file = |Looked { path, n_bytes, key, .. }: &Looked| InputFile {
            path: path.display().to_string(),
            n_bytes: *n_bytes,
            key: key.to_string(),
        };
        Self { hasher, inputs: inputs.0.iter().map(file).collect() }
    }

    /// Adds what a value looks like.
    pub fn debug(&mut self, name: &str, value: &dyn fmt::Debug) {
        self.hasher.debug(name, value);
    }

    /// The key of all so far.
    pub fn key(&self) -> Key {
        self.hasher.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_that_change_are_noticed_and_part_of_the_key() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("in");
        let look = |content: &str| {
            fs::write(&path, content).unwrap();
            Inputs::look([path.as_path()]).unwrap()
        };
        let key = |inputs: &Inputs| Identity::new(("1", 1), "toy", inputs).key();
        let (a, b) = (key(&look("a")), look("b"));
        assert!(b.check().is_ok() && key(&b) != a && key(&look("a")) == a);
        assert!(matches!(b.check(), Err(StateError::InputChanged(_))), "it has the same length");
        let apart = |inputs: &Inputs| Identity::apart_from(("1", 1), "toy", inputs).key();
        assert_eq!(apart(&look("c")), apart(&b));
        assert_ne!(Identity::apart_from(("1", 2), "toy", &b).key(), apart(&b));
        fs::remove_file(&path).unwrap();
        assert!(matches!(b.check(), Err(StateError::Read { .. })));
        assert!(Inputs::look([path.as_path()]).is_err() && Inputs::names([path.as_path()]).paths().eq([&*path]));
    }
}
