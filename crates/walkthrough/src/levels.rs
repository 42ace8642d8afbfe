//! Simplified levels of a scene for the cells of the eye.
//!
//! A level is a variant of a scene for the eyes of some cells: drawn from there, it looks like the scene except for
//! what its budget allowed to change. How it is made, stored and read is up to a [`LoadLevel`], which reads it on
//! another thread.

use crate::coarse::CoarseVisibility;
use crate::prefetch::{Prefetcher, Prepare};
use sightlines_pvs::{CellId, Place, PlaceBuffer};
use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

/// The size of a level.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LevelSize {
    /// Bytes in memory.
    pub bytes: u64,
    /// Number of triangles.
    pub n_triangles: u64,
}

/// Which cells have which level.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct LevelIndex {
    level_of_cell: Vec<Option<u32>>,
    levels: Vec<LevelSize>,
    /// By level: the first cell that has it, the key by which it is requested.
    first_cell: Vec<Option<CellId>>,
}

/// What is drawn with levels by eyes in a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LevelsDrawn {
    /// Eyes in a cell.
    pub n_frames: usize,
    /// Those all of whose cells have the same level.
    pub n_with_level: usize,
    /// Triangles, by all eyes.
    pub n_triangles: u64,
    /// The most triangles by one.
    pub most: u64,
}

/// Why an index is invalid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum LevelError {
    /// A cell has a level that does not exist.
    #[error("cell {cell} has level {level} of {n_levels}")]
    UnknownLevel {
        /// The cell.
        cell: CellId,
        /// Its level.
        level: u32,
        /// Number of levels.
        n_levels: usize,
    },
}

impl LevelIndex {
    /// Checks that each level exists. `level_of_cell` has the level of each cell of the table, `None` where the original is to be drawn.
    /// O(cells + levels).
    ///
    /// # Errors
    /// [`LevelError`].
    pub fn new(level_of_cell: Vec<Option<u32>>, levels: Vec<LevelSize>) -> Result<Self, LevelError> {
        let mut index = Self { first_cell: vec![None; levels.len()], level_of_cell, levels };
        for (cell, level) in (0u32..).map(CellId).zip(&index.level_of_cell) {
            let Some(level) = *level else { continue };
            let n_levels = index.levels.len();
            let first = index.first_cell.get_mut(level as usize);
            first.ok_or(LevelError::UnknownLevel { cell, level, n_levels })?.get_or_insert(cell);
        }
        Ok(index)
    }

    /// Number of cells.
    pub fn n_cells(&self) -> usize {
        self.level_of_cell.len()
    }

    /// The levels, by number.
    pub fn levels(&self) -> &[LevelSize] {
        &self.levels
    }

    /// The level of a cell; `None` if it has none, or there is no such cell: the original is to be drawn.
    pub fn level_of(&self, cell: CellId) -> Option<u32> {
        self.level_of_cell.get(cell.idx()).copied().flatten()
    }

    /// What is drawn with these levels by some eyes. O(eyes), beside locating them.
    ///
    /// * `original`: the triangles of the scene without levels
    ///
    /// # Errors
    /// Those of [`CoarseVisibility::cells_at`].
    pub fn drawn_by<C: CoarseVisibility>(
        &self,
        original: u64,
        cells: &C,
        eyes: impl IntoIterator<Item = [f64; 3]>,
    ) -> Result<LevelsDrawn, C::PlaceError> {
        let (mut drawn, mut buffer) = (LevelsDrawn::default(), PlaceBuffer::new());
        for eye in eyes {
            if let Place::Inside(at) = cells.cells_at(eye, &mut buffer)? {
                let n = self.n_triangles_at(at, original);
                drawn.n_frames += 1;
                drawn.n_with_level += usize::from(self.level_at(at).is_some());
                drawn.n_triangles += n;
                drawn.most = drawn.most.max(n);
            }
        }
        Ok(drawn)
    }

    /// The level for an eye in these cells: the one that all of them share. `None` if they share none, or if there is
    /// no cell.
    pub fn level_at(&self, cells: &[CellId]) -> Option<u32> {
        let (&first, others) = cells.split_first()?;
        let level = self.level_of(first)?;
        others.iter().all(|&cell| self.level_of(cell) == Some(level)).then_some(level)
    }

    /// The number of triangles drawn for an eye in these cells, if the original has `n_original`.
    pub fn n_triangles_at(&self, cells: &[CellId], n_original: u64) -> u64 {
        self.level_at(cells).map_or(n_original, |level| self.levels[level as usize].n_triangles)
    }

    /// Removes the levels of these cells. Levels keep their numbers.
    pub fn forget(&mut self, cells: impl IntoIterator<Item = CellId>) {
        for cell in cells {
            if let Some(level) = self.level_of_cell.get_mut(cell.idx()) {
                *level = None;
            }
        }
    }
}

/// Reads levels. May be slow: it is called on a thread of its own.
pub trait LoadLevel: Send + 'static {
    /// What is drawn.
    type Level: Send + Sync + 'static;
    /// Why a level cannot be read.
    type Error: Send + 'static;

    /// Reads a level.
    ///
    /// # Errors
    /// If it cannot be read. It is requested again while it is needed.
    fn load(&mut self, level: u32) -> Result<Self::Level, Self::Error>;
}

/// What to draw.
#[derive(Debug, PartialEq, Eq)]
pub enum Draw<L> {
    /// The scene as it is.
    Original,
    /// A level in its place.
    Level {
        /// Its number.
        level: u32,
        /// What was read.
        scene: Arc<L>,
    },
}

impl<L> Clone for Draw<L> {
    fn clone(&self) -> Self {
        match self {
            Self::Original => Self::Original,
            Self::Level { level, scene } => Self::Level { level: *level, scene: Arc::clone(scene) },
        }
    }
}

/// Reads the level of a cell: levels are requested by the first cell that had them.
struct OfCells<L> {
    loader: L,
    /// By that cell: the level, and its bytes.
    levels: BTreeMap<CellId, (u32, u64)>,
}

/// A level with its bytes.
struct Loaded<T> {
    scene: Arc<T>,
    bytes: u64,
}

impl<L: LoadLevel> Prepare for OfCells<L> {
    type Prepared = Loaded<L::Level>;
    type Error = L::Error;

    fn prepare(&mut self, cell: CellId) -> Result<Self::Prepared, L::Error> {
        let &(level, bytes) = self.levels.get(&cell).expect("only first cells are asked for");
        Ok(Loaded { scene: Arc::new(self.loader.load(level)?), bytes })
    }

    fn n_bytes(prepared: &Self::Prepared) -> usize {
        usize::try_from(prepared.bytes).unwrap_or(usize::MAX)
    }
}

/// What was drawn so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct LevelCounters {
    /// Frames.
    pub frames: u64,
    /// Frames with a level.
    pub with_level: u64,
    /// Frames with the original because the level had not arrived yet.
    pub late: u64,
}

/// The levels to draw along a walk, read in advance.
///
/// A frame never waits: until the level of the eye's cells has arrived, the original is drawn. A level that does not
/// fit the budget is never read.
pub struct LevelPrefetcher<L: LoadLevel> {
    index: LevelIndex,
    budget: u64,
    levels: Prefetcher<OfCells<L>>,
    wishes: Vec<CellId>,
    counters: LevelCounters,
}

impl<L: LoadLevel> LevelPrefetcher<L> {
    /// Starts with nothing read. `budget` bounds the bytes of the levels in memory, according to the index. The level
    /// of the eye's cells always stays, so a level that was being read when the eye turned aside may exceed the budget
    /// until the next one is read.
    pub fn new(index: LevelIndex, loader: L, budget: u64) -> Self {
        let first = (0u32..).zip(&index.first_cell).zip(&index.levels);
        let levels = first.filter_map(|((level, cell), size)| Some(((*cell)?, (level, size.bytes)))).collect();
        let of_cells = OfCells { loader, levels };
        let levels = Prefetcher::new(of_cells, usize::try_from(budget).unwrap_or(usize::MAX));
        Self { index, budget, levels, wishes: Vec::new(), counters: LevelCounters::default() }
    }

    /// What to draw for an eye in the cells `at`. Requests the levels of the cells `ahead`, the most urgent first:
    /// [`crate::DrawList::at`] and [`crate::DrawList::ahead`].
    ///
    /// A level is drawn only if all cells that contain the eye share it; otherwise, and outside every cell, the
    /// original is. A level is valid for eyes in its cells, so draw what is seen in mirrors, by eyes behind them, from
    /// the original. Draw moving objects separately.
    pub fn frame(&mut self, at: &[CellId], ahead: &[CellId]) -> Draw<L::Level> {
        self.counters.frames += 1;
        self.levels.poll();
        self.wishes.clear();
        let mut room = self.budget;
        let level = self.index.level_at(at);
        let here = level.and_then(|level| self.wish(level, &mut room));
        let n_here = self.wishes.len();
        for &cell in at.iter().chain(ahead) {
            if let Some(level) = self.index.level_of(cell) {
                self.wish(level, &mut room);
            }
        }
        self.levels.pin(&self.wishes[..n_here]);
        self.levels.wish(&self.wishes);
        let Some((level, cell)) = level.zip(here) else { return Draw::Original };
        // Levels ahead count as used now too, so that unneeded ones are evicted first.
        for k in (1..self.wishes.len()).rev() {
            self.levels.get(self.wishes[k]);
        }
        match self.levels.get(cell) {
            Some(loaded) => {
                self.counters.with_level += 1;
                Draw::Level { level, scene: Arc::clone(&loaded.scene) }
            }
            None => {
                self.counters.late += 1;
                Draw::Original
            }
        }
    }

    /// Requests a level, once, if there is room for it beside the more urgent ones. Returns the cell that is its key.
    fn wish(&mut self, level: u32, room: &mut u64) -> Option<CellId> {
        let cell = self.index.first_cell[level as usize]?;
        if !self.wishes.contains(&cell) {
            *room = room.checked_sub(self.index.levels[level as usize].bytes)?;
            self.wishes.push(cell);
        }
        Some(cell)
    }

    /// Removes the levels of these cells, because the scene changed for eyes in them: cells that see a wall that was
    /// added or removed, or a door that was cut.
    pub fn forget(&mut self, cells: impl IntoIterator<Item = CellId>) {
        self.index.forget(cells);
    }

    /// Which cells have which level.
    pub fn index(&self) -> &LevelIndex {
        &self.index
    }

    /// Whether everything that the last frame requested has arrived, for callers that prefer to wait.
    pub fn is_idle(&mut self) -> bool {
        self.levels.is_idle()
    }

    /// Takes the last error of reading a level, with the number of the level. Until reading succeeds, the original is
    /// drawn.
    pub fn take_error(&mut self) -> Option<(u32, L::Error)> {
        let (cell, error) = self.levels.take_error()?;
        // The cell may have been forgotten since; it is still the key of that level.
        let level = self.index.first_cell.iter().position(|&first| first == Some(cell))?;
        Some((level as u32, error))
    }

    /// Bytes and number of the levels in memory.
    pub fn kept(&self) -> (u64, usize) {
        (self.levels.n_bytes() as u64, self.levels.n_kept())
    }

    /// Numbers of levels read so far, and of levels evicted to stay within the budget.
    pub fn read(&self) -> (u64, u64) {
        (self.levels.n_made(), self.levels.n_dropped())
    }

    /// What was drawn so far.
    pub fn counters(&self) -> LevelCounters {
        self.counters
    }
}

impl<L: LoadLevel> fmt::Debug for LevelPrefetcher<L> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("LevelPrefetcher")
            .field("budget", &self.budget)
            .field("counters", &self.counters)
            .finish_non_exhaustive()
    }
}
