//! Results in one file, to which each is added as it is found.

use crate::error::StateError;
use crate::index::Results;
use crate::key::Key;
use crate::records::{Owner, Place, record};
use sightlines_formats::process_mark;
use sightlines_progress::{Halt, Phase, UnitStore};
use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// What to do with the results that a file has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Opening {
    /// Nothing: a file of results is replaced.
    Anew,
    /// Go on from them; a file of another bake is refused.
    Resume,
}

/// Keeps the results of units in a file, in the order in which they come.
///
/// The file is not made before a while, so that short bakes leave nothing. Until then results are kept in memory; after that they are
/// read from the file. A process that is killed leaves whole records, and perhaps a part of one, which is cut off when the file is opened again.
/// Two processes may write to one file at once if both go on from it.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    owner: Owner,
    after: Duration,
    start: Instant,
    n_taken_up: usize,
    /// Whether a file that cannot be written ends the bake.
    insists: bool,
    state: Mutex<State>,
}

#[derive(Debug, Default)]
struct State {
    /// None until there is a file.
    results: Option<Results>,
    in_memory: BTreeMap<(String, u64), Vec<u8>>,
    /// Why nothing more is written.
    failure: Option<StateError>,
}

impl Journal {
    /// Results of the bake `key` of a version of a program, in the file at `path`, which is made after `after`.
    ///
    /// # Errors
    /// [`StateError`] for a file that cannot be read, for one that holds no results, and with [`Opening::Resume`] for one of another bake.
    pub fn open(path: &Path, key: Key, program: &str, opening: Opening, after: Duration) -> Result<Self, StateError> {
        let owner = Owner { key, program: program.to_owned() };
        let open = OpenOptions::new().read(true).append(true).open(path);
        let results = match open {
            Err(error) if error.kind() == io::ErrorKind::NotFound => None,
            Err(source) => return Err(StateError::read(path, source)),
            Ok(file) => match (Results::of(path, file, &owner), opening) {
                (Err(StateError::OtherKey(_) | StateError::OtherProgram { .. }), Opening::Anew) => None,
                (results, _) => results?.filter(|_| opening == Opening::Resume),
            },
        };
        let mut state = State { results, ..State::default() };
        if let Some(results) = state.results.as_mut().filter(|results| results.is_torn) {
            let end = results.end;
            results.file().set_len(end).map_err(|source| StateError::write(path, source))?;
        }
        let n_taken_up = state.results.as_ref().map_or(0, Results::n_results);
        let (start, state) = (Instant::now(), Mutex::new(state));
        Ok(Self { path: path.to_owned(), owner, after, start, n_taken_up, insists: true, state })
    }

    /// The same, for a bake that goes on, with all further results in memory, if the file cannot be written: see [`Journal::failure`].
    #[must_use]
    pub fn or_in_memory(self) -> Self {
        Self { insists: false, ..self }
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// How many results the file had when it was opened.
    pub fn n_taken_up(&self) -> usize {
        self.n_taken_up
    }

    /// Why results that came later are not in the file; `None` if they are.
    pub fn failure(&self) -> Option<String> {
        self.lock().failure.as_ref().map(ToString::to_string)
    }

    /// Whether there is a file with results that a later run can go on from.
    pub fn is_in_file(&self) -> bool {
        self.lock().results.as_ref().is_some_and(|results| results.n_results() > 0)
    }

    /// Writes all results that are still in memory, even if it is early.
    ///
    /// # Errors
    /// [`StateError::Write`].
    pub fn flush(&self) -> Result<(), StateError> {
        self.write(&mut self.lock())
    }

    /// Removes the file: the bake is done.
    ///
    /// # Errors
    /// [`StateError::Write`].
    pub fn remove(self) -> Result<(), StateError> {
        match fs::remove_file(&self.path) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => Err(StateError::write(&self.path, error)),
            _ => Ok(()),
        }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn write(&self, state: &mut State) -> Result<(), StateError> {
        if state.in_memory.is_empty() || state.failure.is_some() {
            return Ok(());
        }
        let results = match &mut state.results {
            Some(results) => results,
            none => none.insert(self.create()?),
        };
        while let Some((key, result)) = state.in_memory.pop_first() {
            if let Err(source) = append(results, &key.0, key.1, &result) {
                state.in_memory.insert(key, result);
                return Err(StateError::write(&self.path, source));
            }
        }
        Ok(())
    }

    /// A new file with a header, in the place of one that may be there. It is made under another name, so that it always has a whole header.
    fn create(&self) -> Result<Results, StateError> {
        let failed = |source| StateError::write(&self.path, source);
        let mut name = std::ffi::OsString::from(".");
        name.push(self.path.file_name().ok_or_else(|| failed(io::ErrorKind::InvalidInput.into()))?);
        name.push(format!(".{}-0.tmp", process_mark()));
        let beside = self.path.with_file_name(name);
        let header = self.owner.header();
        let make = || -> io::Result<File> {
            let mut file = OpenOptions::new().read(true).write(true).create(true).truncate(true).open(&beside)?;
            file.write_all(&header)?;
            drop(file);
            fs::rename(&beside, &self.path)?;
            OpenOptions::new().read(true).append(true).open(&self.path)
        };
        let made = make().inspect_err(|_| drop(fs::remove_file(&beside))).map_err(failed)?;
        Ok(Results::new(&self.path, made, header.len() as u64))
    }
}

/// Adds a record; if that fails, takes back what was written of it.
fn append(results: &mut Results, phase: &str, unit: u64, result: &[u8]) -> io::Result<()> {
    let record = record(phase, unit, result);
    let file = results.file();
    // Another process may have added to the file.
    let offset = file.metadata()?.len();
    if let Err(error) = file.write_all(&record) {
        // The first reason is the one to report. What stays is found to be torn later.
        let _ = file.set_len(offset);
        return Err(error);
    }
    results.add(phase, unit, Place { offset, n_bytes: record.len() as u64 });
    results.end = offset + record.len() as u64;
    Ok(())
}

fn halt(error: &StateError) -> Halt {
    Halt::Store(error.to_string())
}

impl UnitStore for Journal {
    fn begin(&self, _: &Phase<'_>) -> Result<(), Halt> {
        Ok(())
    }

    fn wants(&self, _: &'static str, _: usize) -> bool {
        true
    }

    fn load(&self, phase: &'static str, unit: usize) -> Result<Option<Vec<u8>>, Halt> {
        let mut state = self.lock();
        if let Some(result) = state.in_memory.get(&(phase.to_owned(), unit as u64)) {
            return Ok(Some(result.clone()));
        }
        match state.results.as_mut().map(|results| results.load(phase, unit as u64)) {
            None => Ok(None),
            Some(Ok(found)) => Ok(found),
            // Somebody changed the file under our hands: what is lost can be computed.
            Some(Err(StateError::Damaged { .. })) if !self.insists => Ok(None),
            Some(Err(error)) => Err(halt(&error)),
        }
    }

    fn save(&self, phase: &'static str, unit: usize, result: &[u8]) -> Result<(), Halt> {
        let mut state = self.lock();
        state.in_memory.insert((phase.to_owned(), unit as u64), result.to_vec());
        if state.results.is_none() && self.start.elapsed() < self.after {
            return Ok(());
        }
        match self.write(&mut state) {
            Err(error) if self.insists => Err(halt(&error)),
            Err(error) => {
                state.failure = Some(error);
                Ok(())
            }
            Ok(()) => Ok(()),
        }
    }

    fn end(&self, _: &'static str) -> Result<(), Halt> {
        Ok(())
    }
}
