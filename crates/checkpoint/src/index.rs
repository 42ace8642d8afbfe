//! Results in a file, found by their phase and unit.

use crate::error::StateError;
use crate::records::{self, DIVISION, Owner, RecordSpan, Scan, scan};
use std::collections::HashMap;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

/// A file of results, and where each is. Results are read when they are asked for.
#[derive(Debug)]
pub(crate) struct Results {
    path: PathBuf,
    /// None while it is closed.
    file: Option<File>,
    places: HashMap<String, HashMap<u64, RecordSpan>>,
    /// How phases are divided, by their names.
    divisions: HashMap<String, RecordSpan>,
    pub(crate) mark: [u8; 16],
    /// Where the next record goes.
    pub(crate) end: u64,
    pub(crate) is_finished: bool,
    pub(crate) is_torn: bool,
    /// Where damage begins, before the end.
    pub(crate) damage: Vec<u64>,
}

impl Results {
    /// The results in a file that is open; `None` if it is empty. Whatever follows the last whole record is ignored.
    ///
    /// # Errors
    /// [`StateError`] for a file of another owner, or of none.
    pub(crate) fn of(path: &Path, file: File, owner: &Owner) -> Result<Option<Self>, StateError> {
        let Some(Scan { header, records, end, is_finished, is_torn, damage }) = scan(path, &file)? else {
            return Ok(None);
        };
        let found = header.owner;
        if found.program != owner.program {
            let (found, expected) = (found.program, owner.program.clone());
            return Err(StateError::OtherProgram { path: path.to_owned(), found, expected });
        }
        if found.key != owner.key {
            return Err(StateError::OtherKey(path.to_owned()));
        }
        let new = Self::new(path, file, end, header.mark);
        let mut results = Self { is_finished, is_torn, damage, ..new };
        records.into_iter().for_each(|(phase, unit, place)| results.add(&phase, unit, place));
        Ok(Some(results))
    }

    /// The results in a file, which is only read; `None` if it is empty.
    ///
    /// # Errors
    /// [`StateError`] for a file that cannot be opened, of another owner, or of none.
    pub(crate) fn read(path: &Path, owner: &Owner) -> Result<Option<Self>, StateError> {
        let file = File::open(path).map_err(|source| StateError::read(path, source))?;
        Self::of(path, file, owner)
    }

    /// A new file without results.
    pub(crate) fn new(path: &Path, file: File, end: u64, mark: [u8; 16]) -> Self {
        Self {
            path: path.to_owned(),
            file: Some(file),
            places: HashMap::new(),
            divisions: HashMap::new(),
            mark,
            end,
            is_finished: false,
            is_torn: false,
            damage: Vec::new(),
        }
    }

    pub(crate) fn add(&mut self, phase: &str, unit: u64, place: RecordSpan) {
        if unit == DIVISION {
            self.divisions.insert(phase.to_owned(), place);
            return;
        }
        if !self.places.contains_key(phase) {
            self.places.insert(phase.to_owned(), HashMap::new());
        }
        if let Some(of_phase) = self.places.get_mut(phase) {
            of_phase.insert(unit, place);
        }
    }

    /// The file; one that was closed is opened to be read.
    pub(crate) fn file(&mut self) -> io::Result<&mut File> {
        let file = match self.file.take() {
            Some(file) => file,
            None => File::open(&self.path)?,
        };
        Ok(self.file.insert(file))
    }

    /// Closes the file until something of it is asked for.
    pub(crate) fn close(&mut self) {
        self.file = None;
    }

    pub(crate) fn has(&self, phase: &str, unit: u64) -> bool {
        self.places.get(phase).is_some_and(|places| places.contains_key(&unit))
    }

    /// Units of a phase that have results, in ascending order.
    pub(crate) fn units(&self, phase: &str) -> Vec<u64> {
        let mut units: Vec<u64> = self.places.get(phase).into_iter().flatten().map(|(&unit, _)| unit).collect();
        units.sort_unstable();
        units
    }

    /// Whether there are results of other phases.
    pub(crate) fn has_others(&self, phase: &str) -> bool {
        self.places.keys().any(|other| other != phase)
    }

    pub(crate) fn n_results(&self) -> usize {
        self.places.values().map(HashMap::len).sum()
    }

    /// # Errors
    /// [`StateError`] if the result cannot be read, or is no longer what it was.
    pub(crate) fn load(&mut self, phase: &str, unit: u64) -> Result<Option<Vec<u8>>, StateError> {
        let place = match unit {
            DIVISION => self.divisions.get(phase),
            unit => self.places.get(phase).and_then(|places| places.get(&unit)),
        };
        let Some(&place) = place else { return Ok(None) };
        let loaded = self.file().and_then(|file| records::load(file, place, phase, unit));
        let loaded = loaded.map_err(|source| StateError::read(&self.path, source))?;
        loaded.map(Some).ok_or_else(|| StateError::Damaged { path: self.path.clone(), offset: place.offset })
    }
}
