//! The state of a search in a file: how far it came, for a run that continues after this one was stopped.

use super::Error;
use crate::error::InputError;
use sightlines::bake::quake::{StateKey, state};
use sightlines::cells::{CellGraph, Convex};
use sightlines::formats::atomic_write;
use sightlines::stabtree::ConvexState;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Where the state of a search is kept.
#[derive(Debug)]
pub(super) struct Saved {
    path: PathBuf,
    key: StateKey,
    /// Time between two savings.
    every: Duration,
    last: Instant,
    /// The stage that was under way then.
    stage: Option<u32>,
}

/// The end of a stage is saved too, unless the last saving is more recent than this.
const LEAST: Duration = Duration::from_secs(1);

impl Saved {
    /// The state in the file, if `resume` is set and there is one. Without `resume` a state that is there will be
    /// overwritten.
    ///
    /// Refuses a file that is not a state, and with `resume` a state of another search.
    pub(super) fn open(
        path: PathBuf,
        every: Duration,
        key: StateKey,
        graph: &CellGraph<Convex>,
        resume: bool,
    ) -> Result<(Self, Option<ConvexState>), Error> {
        let open = |source| InputError::Open { path: path.clone(), source };
        let state = match File::open(&path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => None,
            Err(error) => return Err(open(error).into()),
            Ok(mut file) => {
                let mut bytes = Vec::new();
                file.by_ref().take(state::MAGIC.len() as u64).read_to_end(&mut bytes).map_err(open)?;
                if !state::is_state(&bytes) {
                    return Err(Error::NotState(path));
                }
                if resume {
                    file.read_to_end(&mut bytes).map_err(open)?;
                    let decoded = state::decode(&key, graph, &bytes);
                    Some(decoded.map_err(|source| Error::State { path: path.clone(), source })?)
                } else {
                    None
                }
            }
        };
        match (&state, resume) {
            (Some(_), _) => tracing::info!("{}: going on from there", path.display()),
            (None, true) => tracing::warn!("{}: there is no state to go on from; beginning anew", path.display()),
            (None, false) => {}
        }
        Ok((Self { path, key, every, last: Instant::now(), stage: None }, state))
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the state if it is time to, or if a stage has ended.
    pub(super) fn save(&mut self, state: &ConvexState) {
        let since = self.last.elapsed();
        let has_ended = *self.stage.get_or_insert(state.stage) != state.stage;
        if since < self.every && !(has_ended && since >= LEAST) {
            return;
        }
        // A state that cannot be written is lost only if the run is stopped, so the run continues.
        if let Err(error) = atomic_write(&self.path, &state::encode(&self.key, state)) {
            tracing::warn!("{error}; a run that is stopped cannot be resumed");
        }
        (self.last, self.stage) = (Instant::now(), Some(state.stage));
    }

    /// Removes the file: the search is done, and its answer is kept.
    pub(super) fn remove(&self) {
        match fs::remove_file(&self.path) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => {
                tracing::warn!("{}: cannot be removed: {error}", self.path.display());
            }
            _ => {}
        }
    }
}
