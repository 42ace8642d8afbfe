//! Walking through a world: tiles are loaded ahead of the viewer.

use crate::error::WorldError;
use crate::tables::{Seen, TileScratch, TileTables};
use crate::world::{TileId, TiledWorld};
use sightlines_pvs::CellId;
use sightlines_walkthrough::{AnswerKind, Prefetcher, Prepare};
use std::sync::Arc;

/// Parameters of a [`TileWalk`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TileWalkOptions {
    /// Bytes that tiles may take in memory. Those of the eye stay whatever they take.
    pub budget: usize,
    /// Bytes of unpacked blocks that each table may keep.
    pub cache_bytes: usize,
    /// Tiles whose viewers are at most so far from the eye, along each axis, are loaded ahead, the nearest first.
    pub ahead: f64,
    /// Whether tiles are loaded on another thread. Otherwise a frame loads those that it needs before it returns.
    pub has_thread: bool,
}

impl Default for TileWalkOptions {
    /// 64 MiB, 1 MiB for each table, 50 scene units.
    fn default() -> Self {
        Self { budget: 64 << 20, cache_bytes: 1 << 20, ahead: 50.0, has_thread: true }
    }
}

/// Loads tiles.
struct Loader {
    world: Arc<TiledWorld>,
    cache_bytes: usize,
}

impl Prepare for Loader {
    type Prepared = TileTables;
    type Error = WorldError;

    fn prepare(&mut self, tile: CellId) -> Result<TileTables, WorldError> {
        TileTables::load(&self.world, TileId(tile.0), self.cache_bytes)
    }

    fn n_bytes(tables: &TileTables) -> usize {
        tables.n_bytes()
    }
}

/// What may be seen in a frame.
#[derive(Debug)]
pub struct TileFrame<'a> {
    /// Everything that may be seen.
    pub seen: &'a Seen,
    /// [`AnswerKind::Late`] and [`AnswerKind::Outside`]: all tiles.
    pub answer: AnswerKind,
}

/// Follows an eye through a world. A frame waits for blocks of tables that are loaded, and never for a tile to be loaded: until it has arrived, all of the world
/// counts as visible.
pub struct TileWalk {
    world: Arc<TiledWorld>,
    tiles: Prefetcher<Loader>,
    ahead: f64,
    at: Vec<TileId>,
    wishes: Vec<CellId>,
    seen: Seen,
    scratch: TileScratch,
    error: Option<WorldError>,
}

impl std::fmt::Debug for TileWalk {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("TileWalk").field("world", &self.world).field("at", &self.at).finish_non_exhaustive()
    }
}

/// How far a point is from a box, along the axis where it is farthest.
fn distance(eye: [f64; 3], b: &sightlines_geometry::Aabb<3>) -> f64 {
    (0..3).map(|k| (b.min[k] - eye[k]).max(eye[k] - b.max[k]).max(0.0)).fold(0.0, f64::max)
}

impl TileWalk {
    /// Begins a walk. With a thread of its own, if the options say so.
    pub fn new(world: Arc<TiledWorld>, options: TileWalkOptions) -> Self {
        let TileWalkOptions { budget, cache_bytes, ahead, has_thread } = options;
        let loader = Loader { world: Arc::clone(&world), cache_bytes };
        let tiles =
            if has_thread { Prefetcher::new(loader, budget) } else { Prefetcher::without_thread(loader, budget) };
        let (at, wishes, seen, scratch) = (Vec::new(), Vec::new(), Seen::default(), TileScratch::default());
        Self { world, tiles, ahead, at, wishes, seen, scratch, error: None }
    }

    /// What an eye sees. What cannot be read is reported by [`TileWalk::take_error`], and counts as visible.
    pub fn frame(&mut self, eye: [f64; 3]) -> TileFrame<'_> {
        self.tiles.poll();
        self.world.tiles_at(eye, &mut self.at);
        self.wish(eye);
        let answer = self.see(eye);
        if answer == AnswerKind::Full {
            self.seen.sort();
        } else {
            self.seen.set_everything(&self.world);
        }
        TileFrame { seen: &self.seen, answer }
    }

    /// Requests the tiles of the eye, and those ahead.
    fn wish(&mut self, eye: [f64; 3]) {
        let of_eye: Vec<CellId> = self.at.iter().map(|tile| CellId(tile.0)).collect();
        let mut ahead: Vec<(f64, CellId)> = Vec::new();
        self.world.visit_within(eye, self.ahead, |tile| {
            let away = self.world.tile(tile).map_or(f64::INFINITY, |entry| distance(eye, &entry.bounds.viewers));
            ahead.push((away, CellId(tile.0)));
        });
        ahead.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        self.wishes.clone_from(&of_eye);
        self.wishes.extend(ahead.into_iter().map(|(_, tile)| tile).filter(|tile| !of_eye.contains(tile)));
        self.tiles.pin(&of_eye);
        self.tiles.wish(&self.wishes);
        if let Some((_, error)) = self.tiles.take_error() {
            self.error = Some(error);
        }
    }

    fn see(&mut self, eye: [f64; 3]) -> AnswerKind {
        self.seen.clear();
        let mut is_inside = false;
        for &tile in &self.at {
            let Some(tables) = self.tiles.get(CellId(tile.0)) else { return AnswerKind::Late };
            match tables.see(eye, &mut self.seen, &mut self.scratch) {
                Ok(found) => is_inside |= found,
                Err(error) => {
                    self.error = Some(error);
                    return AnswerKind::Late;
                }
            }
        }
        if is_inside { AnswerKind::Full } else { AnswerKind::Outside }
    }

    /// The last error, if there was one since the last call.
    pub fn take_error(&mut self) -> Option<WorldError> {
        self.error.take()
    }

    /// Whether all that was requested is loaded.
    pub fn is_idle(&mut self) -> bool {
        self.tiles.is_idle()
    }

    /// How many tiles are in memory, how many were loaded so far, and the bytes that those in memory take.
    pub fn counts(&self) -> (usize, u64, usize) {
        (self.tiles.n_kept(), self.tiles.n_made(), self.tiles.n_bytes())
    }
}
