//! The state of a search in a file: how far it came, for a run that continues after this one was stopped.

use super::Error;
use crate::error::InputError;
use crate::plain::plain;
use sightlines::bake::quake::{StateKey, state};
use sightlines::cells::{CellGraph, Convex};
use sightlines::formats::{atomic_write, remove_left};
use sightlines::stabtree::{ConvexSearch, ConvexState};
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// What to do with the state of an earlier run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum StateUse {
    /// Nothing; this run overwrites it with its own.
    Anew,
    /// Continue from it; refuse one of another search.
    Resume,
    /// Continue from it, unless it is of another search.
    ResumeIfItFits,
    /// Neither read one nor write one.
    Off,
}

/// Where the state of a search is kept.
#[derive(Debug)]
pub(super) struct Saved {
    path: PathBuf,
    key: StateKey,
    /// Time between two savings; none if nothing is saved.
    every: Option<Duration>,
    /// Whether the last state of all is saved, and kept.
    keep: bool,
    /// Whether this run has written the file, and could the last time.
    is_written: bool,
    last: Instant,
    /// The stage that was under way then.
    stage: Option<u32>,
}

/// The end of a stage is saved too, unless the last saving is more recent than this.
const LEAST: Duration = Duration::from_secs(1);

impl Saved {
    /// A place for states that is used as `usage` says, and the state in it, if it is one to continue from.
    ///
    /// Refuses a file that is no state, and with [`StateUse::Resume`] a state of another search. [`StateUse::ResumeIfItFits`] leaves the one
    /// alone and ignores the other, with a warning.
    pub(super) fn open(
        path: PathBuf,
        every: Duration,
        key: StateKey,
        graph: &CellGraph<Convex>,
        usage: StateUse,
    ) -> Result<(Self, Option<ConvexState>), Error> {
        if usage != StateUse::Off {
            // This run may be done before it writes one.
            remove_left(&path);
        }
        let mut saved =
            Self { path, key, every: Some(every), keep: false, is_written: false, last: Instant::now(), stage: None };
        if usage == StateUse::Off {
            saved.every = None;
            return Ok((saved, None));
        }
        let state = match saved.read(graph, usage) {
            Ok(state) => state,
            Err(error) if usage == StateUse::ResumeIfItFits => {
                if matches!(error, Error::State { .. }) {
                    tracing::warn!("{}; beginning anew", plain(&error.without_advice()));
                } else {
                    saved.every = None;
                    tracing::warn!("{}; the state of this run is not saved", plain(&error.without_advice()));
                }
                None
            }
            Err(error) => return Err(error),
        };
        match (&state, usage) {
            (Some(_), _) => tracing::info!("{}: going on from there", saved.path.display()),
            (None, StateUse::Resume) => {
                tracing::warn!("{}: there is no state to go on from; beginning anew", saved.path.display());
            }
            (None, _) => {}
        }
        Ok((saved, state))
    }

    /// The state in the file, if there is one to continue from.
    fn read(&self, graph: &CellGraph<Convex>, usage: StateUse) -> Result<Option<ConvexState>, Error> {
        let path = &self.path;
        let open = |source| InputError::Open { path: path.clone(), source };
        let mut file = match File::open(path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            file => file.map_err(open)?,
        };
        let mut bytes = Vec::new();
        file.by_ref().take(state::MAGIC.len() as u64).read_to_end(&mut bytes).map_err(open)?;
        // What a run leaves that is stopped as it begins to write, on some file systems.
        if bytes.is_empty() {
            return Ok(None);
        }
        if !state::is_state(&bytes) {
            return Err(Error::NotState(path.clone()));
        }
        if usage == StateUse::Anew {
            return Ok(None);
        }
        file.read_to_end(&mut bytes).map_err(open)?;
        let decoded = state::decode(&self.key, graph, &bytes);
        Ok(Some(decoded.map_err(|source| Error::State { path: path.clone(), source })?))
    }

    /// Keeps the file after the end, with the last state of all.
    pub(super) fn keep(&mut self) {
        self.keep = true;
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// The file, if this run has written it.
    pub(super) fn path_if_written(&self) -> Option<PathBuf> {
        self.is_written.then(|| self.path.clone())
    }

    /// Writes the state if it is time to, if a stage has ended, or if the search ends early.
    pub(super) fn save(&mut self, search: &ConvexSearch, ends: bool) {
        let (Some(every), state) = (self.every, search.state()) else { return };
        let since = self.last.elapsed();
        let has_ended = *self.stage.get_or_insert(state.stage) != state.stage;
        let is_kept = self.keep && search.is_done();
        let is_due = since >= every || has_ended && since >= LEAST;
        if !(is_due || is_kept || ends) {
            return;
        }
        // A state that cannot be written is lost only if the run is stopped, so the run continues.
        let written = atomic_write(&self.path, &state::encode(&self.key, state));
        self.is_written = written.is_ok();
        if let Err(error) = written {
            tracing::warn!("{}; a run that is stopped cannot be resumed", plain(&error.to_string()));
        }
        (self.last, self.stage) = (Instant::now(), Some(state.stage));
    }

    /// Removes the file, unless it is to be kept: the search is done, and its answer is kept.
    pub(super) fn remove(&self) {
        if self.every.is_none() || self.keep {
            return;
        }
        match fs::remove_file(&self.path) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => {
                tracing::warn!("{}: cannot be removed: {}", self.path.display(), plain(&error.to_string()));
            }
            _ => {}
        }
    }
}
