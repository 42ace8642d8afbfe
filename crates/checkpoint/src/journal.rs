//! Results in one file, to which each is added as it is found.

use crate::division::division_of;
use crate::error::StateError;
use crate::index::Results;
use crate::key::Key;
use crate::lock::{lock, new_mark};
use crate::records::{self, DIVISION, Owner, RecordSpan, record};
use sightlines_progress::{Halt, Pass, Phase, UnitStore};
use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// What to do with the results that a file has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OpenMode {
    /// Nothing: once there are other results, a file of results is renamed to [`Journal::before_path`].
    Anew,
    /// Go on from them; a file of another bake is refused.
    Resume,
}

/// Keeps the results of units in a file, in the order in which they come.
///
/// The file is not made before a while, so that short bakes leave nothing. Until then results are kept in memory; after that they are
/// read from the file. A process that is killed leaves whole records, and perhaps a part of one, which is cut off when the file is opened again.
/// Records that are damaged are passed over: only their units are computed again.
///
/// One process at a time uses a file: it is locked. Where the file system has no locks, two processes may lose results of each other, which a later run
/// computes again; neither takes wrong ones.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    owner: Owner,
    after: Duration,
    start: Instant,
    n_taken_up: usize,
    n_damaged: usize,
    n_before: usize,
    /// Whether a file that cannot be written ends the bake.
    insists: bool,
    state: Mutex<State>,
}

#[derive(Debug, Default)]
struct State {
    /// None until there is a file.
    results: Option<Results>,
    in_memory: BTreeMap<(String, u64), Vec<u8>>,
    /// A file of results that this bake replaces, and that nobody else may use until then.
    before: Option<Before>,
    /// The mark of results of the same bake that were put aside.
    aside: Option<[u8; 16]>,
    /// Why nothing more is written.
    failure: Option<StateError>,
}

/// A file of results that a bake begins without.
#[derive(Debug)]
struct Before {
    file: File,
    /// If they are of the same bake.
    mark: Option<[u8; 16]>,
}

impl Journal {
    /// Results of the bake `key` of a version of a program, in the file at `path`, which is made after `after`.
    ///
    /// # Errors
    /// [`StateError`] for a file that cannot be read, for one that another process uses, for one that holds no results, and with [`OpenMode::Resume`] for
    /// one of another bake.
    pub fn open(path: &Path, key: Key, program: &str, opening: OpenMode, after: Duration) -> Result<Self, StateError> {
        let owner = Owner { key, program: program.to_owned() };
        let mut state = State::default();
        let (mut n_before, mut n_damaged) = (0, 0);
        match OpenOptions::new().read(true).append(true).open(path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Err(source) => return Err(StateError::read(path, source)),
            Ok(file) => {
                lock(path, &file)?;
                let again = || file.try_clone().map_err(|source| StateError::read(path, source));
                match (Results::of(path, again()?, &owner), opening) {
                    (Ok(results), OpenMode::Resume) => state.results = results,
                    (Ok(results), OpenMode::Anew) => {
                        n_before = results.as_ref().map_or(0, Results::n_results);
                        state.before = Some(Before { file, mark: results.map(|results| results.mark) });
                    }
                    (
                        Err(StateError::OtherKey(_) | StateError::OtherProgram { .. } | StateError::OtherForm(_)),
                        OpenMode::Anew,
                    ) => state.before = Some(Before { file, mark: None }),
                    (Err(error), _) => return Err(error),
                }
            }
        }
        if let Some(results) = &mut state.results {
            n_damaged = results.damage.len();
            let end = results.end;
            if results.is_torn {
                results.file().and_then(|file| file.set_len(end)).map_err(|source| StateError::write(path, source))?;
            }
        }
        let n_taken_up = state.results.as_ref().map_or(0, Results::n_results);
        let (start, state, path) = (Instant::now(), Mutex::new(state), path.to_owned());
        Ok(Self { path, owner, after, start, n_taken_up, n_damaged, n_before, insists: true, state })
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

    /// Records, or places with something else, that were damaged when the file was opened: results that are computed again.
    pub fn n_damaged(&self) -> usize {
        self.n_damaged
    }

    /// With [`OpenMode::Anew`], how many results of the same bake a file has that this bake begins without.
    pub fn n_before(&self) -> usize {
        self.n_before
    }

    /// Where a file of results goes that another one replaces. What is there is replaced in turn.
    pub fn before_path(&self) -> PathBuf {
        let mut name = self.path.as_os_str().to_owned();
        name.push(".before");
        name.into()
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
    /// [`StateError::Write`], and [`StateError::InUse`].
    pub fn flush(&self) -> Result<(), StateError> {
        self.write(&mut self.lock())
    }

    /// Removes the file that this journal has written or gone on from, and older results of the same bake: it is done.
    ///
    /// # Errors
    /// [`StateError::Replaced`] for another file of that name, which stays, and [`StateError::Write`].
    pub fn remove(self) -> Result<(), StateError> {
        let aside = self.before_path();
        let state = self.state.into_inner().unwrap_or_else(PoisonError::into_inner);
        let own = state.results.as_ref().map(|results| results.mark);
        let before = state.before.as_ref().and_then(|before| before.mark);
        for (path, mark) in [(&self.path, own), (&self.path, before), (&aside, state.aside)] {
            let Some(mark) = mark else { continue };
            match is_at(path, &self.owner, mark) {
                Err(error) if error.kind() == io::ErrorKind::NotFound => continue,
                Err(error) => return Err(StateError::write(path, error)),
                Ok(false) => return Err(StateError::Replaced(path.clone())),
                Ok(true) => {}
            }
            match fs::remove_file(path) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(StateError::write(path, error)),
                _ => {}
            }
        }
        Ok(())
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn write(&self, state: &mut State) -> Result<(), StateError> {
        let has_results = state.in_memory.keys().any(|(_, unit)| *unit != DIVISION);
        if state.in_memory.is_empty() || state.failure.is_some() || (state.results.is_none() && !has_results) {
            return Ok(());
        }
        let results = match &mut state.results {
            Some(results) => results,
            none => {
                if let Some(before) = state.before.take() {
                    state.aside = self.put_aside(before)?;
                }
                none.insert(self.create()?)
            }
        };
        while let Some((key, result)) = state.in_memory.pop_first() {
            if let Err(source) = append(results, &key.0, key.1, &result) {
                state.in_memory.insert(key, result);
                return Err(StateError::write(&self.path, source));
            }
        }
        Ok(())
    }

    /// Gives a file of results another name, and returns its mark if it is of the same bake.
    fn put_aside(&self, Before { file, mark }: Before) -> Result<Option<[u8; 16]>, StateError> {
        let aside = self.before_path();
        // Something else of that name is not to be lost.
        match File::open(&aside) {
            Ok(mut found) => match records::header(&aside, &mut found) {
                Ok(_) | Err(StateError::OtherForm(_)) => {}
                Err(error) => return Err(error),
            },
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Err(source) => return Err(StateError::read(&aside, source)),
        }
        let failed = |source| StateError::write(&self.path, source);
        let n_bytes = file.metadata().map_err(failed)?.len();
        match if n_bytes == 0 { fs::remove_file(&self.path) } else { fs::rename(&self.path, aside) } {
            Err(error) if error.kind() != io::ErrorKind::NotFound => Err(failed(error)),
            _ => Ok(mark),
        }
    }

    /// A new file with a header.
    fn create(&self) -> Result<Results, StateError> {
        let failed = |source| StateError::write(&self.path, source);
        // Whoever finds a file of this name from here on finds one without results, or one that is locked.
        let mark = new_mark();
        let header = self.owner.header(mark);
        let mut file = OpenOptions::new().read(true).append(true).create(true).open(&self.path).map_err(failed)?;
        lock(&self.path, &file)?;
        // Another process may have made it since, and ended.
        if records::scan(&self.path, &file)?.is_some_and(|found| !found.records.is_empty()) {
            return Err(StateError::InUse(self.path.clone()));
        }
        if let Err(source) = file.set_len(0).and_then(|()| file.write_all(&header)) {
            // Without a header it is of no use.
            let _ = fs::remove_file(&self.path);
            return Err(failed(source));
        }
        if !is_at(&self.path, &self.owner, mark).map_err(failed)? {
            return Err(StateError::InUse(self.path.clone()));
        }
        Ok(Results::new(&self.path, file, header.len() as u64, mark))
    }
}

/// Whether the file of a name begins with the header of an owner with a mark.
fn is_at(path: &Path, owner: &Owner, mark: [u8; 16]) -> io::Result<bool> {
    let found = records::header(path, &mut File::open(path)?);
    Ok(matches!(found, Ok(Some(found)) if found.owner == *owner && found.mark == mark))
}

/// Adds a record; if that fails, takes back what was written of it.
fn append(results: &mut Results, phase: &str, unit: u64, result: &[u8]) -> io::Result<()> {
    let record = record(phase, unit, result);
    let file = results.file()?;
    // Without locks another process may have added to the file.
    let offset = file.metadata()?.len();
    if let Err(error) = file.write_all(&record) {
        // The first reason is the one to report. What stays is found to be torn later.
        let _ = file.set_len(offset);
        return Err(error);
    }
    results.add(phase, unit, RecordSpan { offset, n_bytes: record.len() as u64 });
    results.end = offset + record.len() as u64;
    Ok(())
}

fn halt(error: &StateError) -> Halt {
    Halt::Store(error.to_string())
}

impl UnitStore for Journal {
    fn begin(&self, phase: &Phase<'_>) -> Result<(), Halt> {
        let division = division_of(phase);
        match self.find(phase.name, DIVISION)? {
            Some(found) if found == division => Ok(()),
            Some(_) => {
                let (path, phase) = (self.path.clone(), phase.name.to_owned());
                Err(halt(&StateError::OtherUnitsOfPhase { path, phase }))
            }
            None => self.keep(phase.name, DIVISION, &division),
        }
    }

    fn wants(&self, _: &'static str, _: usize) -> bool {
        true
    }

    fn load(&self, phase: &'static str, unit: usize) -> Result<Option<Vec<u8>>, Halt> {
        self.find(phase, unit as u64)
    }

    fn save(&self, phase: &'static str, unit: usize, result: &[u8]) -> Result<(), Halt> {
        self.keep(phase, unit as u64, result)
    }

    fn end(&self, _: &'static str) -> Result<Pass, Halt> {
        Ok(Pass::Last)
    }
}

impl Journal {
    fn find(&self, phase: &str, unit: u64) -> Result<Option<Vec<u8>>, Halt> {
        let mut state = self.lock();
        if let Some(result) = state.in_memory.get(&(phase.to_owned(), unit)) {
            return Ok(Some(result.clone()));
        }
        match state.results.as_mut().map(|results| results.load(phase, unit)) {
            None => Ok(None),
            Some(Ok(found)) => Ok(found),
            // Somebody changed the file under our hands: what is lost can be computed.
            Some(Err(StateError::Damaged { .. })) if !self.insists => Ok(None),
            Some(Err(error)) => Err(halt(&error)),
        }
    }

    fn keep(&self, phase: &str, unit: u64, result: &[u8]) -> Result<(), Halt> {
        let mut state = self.lock();
        state.in_memory.insert((phase.to_owned(), unit), result.to_vec());
        if state.results.is_none() && self.start.elapsed() < self.after {
            return Ok(());
        }
        match self.write(&mut state) {
            // Two runs that write one output are one too many.
            Err(error) if self.insists || matches!(error, StateError::InUse(_)) => Err(halt(&error)),
            Err(error) => {
                state.failure = Some(error);
                Ok(())
            }
            Ok(()) => Ok(()),
        }
    }
}
