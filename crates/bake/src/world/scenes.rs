//! Scenes of tiles with their cells, read when they are needed, and kept while there is room.

use super::WorldBakeError;
use super::input::{Loaded, TileInput};
use crate::request::{BakeRequest, Runtime};
use sightlines_formats::ViewCell;
use sightlines_formats::scene::SceneReadOptions;
use std::collections::{BTreeMap, VecDeque};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A tile with its cells.
#[derive(Debug)]
pub(super) struct Ready {
    pub(super) loaded: Loaded,
    pub(super) cells: Vec<ViewCell>,
}

/// A tile that is being read, or is there.
type Slot = Arc<Mutex<Option<Arc<Ready>>>>;

/// The tiles that are in memory.
pub(super) struct Scenes<'a> {
    inputs: &'a [TileInput],
    reading: &'a SceneReadOptions,
    request: &'a BakeRequest,
    runtime: Runtime<'a>,
    /// How many are kept.
    room: usize,
    kept: Mutex<(BTreeMap<usize, Slot>, VecDeque<usize>)>,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl<'a> Scenes<'a> {
    /// None yet; at most `room` are kept while nobody uses them.
    pub(super) fn new(
        inputs: &'a [TileInput],
        reading: &'a SceneReadOptions,
        (request, runtime): (&'a BakeRequest, Runtime<'a>),
        room: usize,
    ) -> Self {
        Self { inputs, reading, request, runtime, room, kept: Mutex::default() }
    }

    /// A tile, read if it is not there.
    pub(super) fn get(&self, tile: usize) -> Result<Arc<Ready>, WorldBakeError> {
        let slot = {
            let (slots, order) = &mut *lock(&self.kept);
            order.retain(|&other| other != tile);
            order.push_back(tile);
            if order.len() > self.room
                && let Some(oldest) = order.pop_front()
            {
                slots.remove(&oldest);
            }
            Arc::clone(slots.entry(tile).or_default())
        };
        // Others that need the same tile wait for it, and those that need another do not.
        let mut ready = lock(&slot);
        if let Some(ready) = &*ready {
            return Ok(Arc::clone(ready));
        }
        let input = &self.inputs[tile];
        let loaded = input.load(self.reading)?;
        let cells = input.cut(&loaded, self.request, &self.runtime)?;
        Ok(Arc::clone(ready.insert(Arc::new(Ready { loaded, cells }))))
    }
}
