//! What one eye sees: a table, a view, an answer.

use crate::cache::Cache;
use crate::coarse::CoarseVisibility;
use sightlines_eye_to_cell::{
    CellSource, Doors, Method, MirrorImage, Scratch, StepBudget, TableCells, View, VisibleSet, VisibleSubgraph,
    follow_reflections,
};
use sightlines_geometry::Aabb;
use sightlines_pvs::{CellId, DoorId, ObjectId, PlaceBuffer, PortalId, PortalRecord, Table};
use std::borrow::Borrow;
use std::convert::Infallible;
use std::fmt;
use std::sync::Arc;

/// Memory for the data of cells, unless a viewer is told otherwise.
const MEMORY: usize = 64 << 20;

/// Finds what one eye sees, look by look, all on the thread that asks.
///
/// Exact within [`StepBudget::FRAME`], with all doors open, unless it is told otherwise. The first look from a cell gathers the data of
/// that cell, which takes longer than later looks and is kept within [`Viewer::set_memory`]; [`crate::Walkthrough`] gathers it on another
/// thread before the eye is there.
///
/// `S` is the table: in memory ([`Viewer::new`]), or read piece by piece ([`Viewer::of`]). Viewers of one table share it; take one for
/// each thread that looks.
pub struct Viewer<S = TableCells<Arc<Table>>> {
    cells: Arc<S>,
    method: Method,
    budget: StepBudget,
    doors: Doors,
    /// The data of cells that were looked from lately.
    kept: Cache<VisibleSubgraph>,
    scratch: Scratch,
    place: PlaceBuffer,
    seen: VisibleSet,
    /// The last view; none before the first.
    view: Option<View>,
    /// Whether nothing is known at the eye, so that the last answer is everything.
    sees_all: bool,
    images: Vec<MirrorImage>,
}

/// The answer of [`Viewer::look`].
#[derive(Debug, Clone, Copy)]
pub struct Look<'a> {
    /// The cells and objects, each ascending, and the views into mirrors. Outside of every cell all cells and objects, and no views,
    /// although anything may be seen in mirrors.
    pub seen: &'a VisibleSet,
    /// The cells that contain the eye, ascending: several on a border, none outside.
    pub at: &'a [CellId],
    /// The method that answered: the one that was asked for, or the coarsest that one of `at` fell back to, where that had more to do
    /// than it may ([`Viewer::set_budget`]). The answer is no more than its, and may be less. None outside.
    pub method: Option<Method>,
}

impl Look<'_> {
    /// Whether the eye is in no cell. Nothing is known there, and everything counts as seen.
    pub fn is_outside(&self) -> bool {
        self.at.is_empty()
    }
}

impl Viewer {
    /// A viewer of a table in memory. O(portals), which are sorted by cell; [`Viewer::of`] shares them with other viewers.
    pub fn new(table: impl Into<Arc<Table>>) -> Self {
        Self::of(TableCells::new(table.into()))
    }
}

impl<S> Viewer<S> {
    /// A viewer of a table that is sorted already, or read piece by piece: `TableCells`, or `PackedCells` with the feature `packed`; by
    /// itself, or in an `Arc` that others share, as [`Viewer::cells`] of another viewer. O(1).
    pub fn of(cells: impl Into<Arc<S>>) -> Self {
        Self {
            cells: cells.into(),
            method: Method::Exact,
            budget: StepBudget::FRAME,
            doors: Doors::all_open(),
            kept: Cache::new(MEMORY),
            scratch: Scratch::new(),
            place: PlaceBuffer::new(),
            seen: VisibleSet::new(),
            view: None,
            sees_all: false,
            images: Vec::new(),
        }
    }

    /// What is looked at.
    pub fn cells(&self) -> &Arc<S> {
        &self.cells
    }

    /// Chooses the method of all looks from here on; [`Method::Exact`] at first.
    pub fn set_method(&mut self, method: Method) {
        self.method = method;
    }

    /// Bounds the work of each look from here on, and apart from that of following its mirrors; [`StepBudget::FRAME`] at first. An answer of
    /// the exact method that would take more is exact near the eye, and that of the incident portals farther away, which is never less.
    pub fn set_budget(&mut self, budget: StepBudget) {
        self.budget = budget;
    }

    /// Bounds the memory for the data of cells that were looked from lately, in bytes; 64 MiB at first. What was used longest ago is
    /// forgotten first; that of the cell that was asked for last is kept in any case.
    pub fn set_memory(&mut self, n_bytes: usize) {
        self.kept.set_budget(n_bytes);
    }

    /// Bytes and number of the cells' data in memory.
    pub fn kept(&self) -> (usize, usize) {
        (self.kept.n_bytes(), self.kept.len())
    }

    /// Which portals are closed for this viewer.
    pub fn doors(&self) -> &Doors {
        &self.doors
    }

    /// Closes and opens portals and doors for this viewer, from the next look on. Nothing is computed anew.
    pub fn doors_mut(&mut self) -> &mut Doors {
        &mut self.doors
    }

    /// What the last look saw; nothing before the first. See [`Look::seen`].
    pub fn seen(&self) -> &VisibleSet {
        &self.seen
    }

    /// What the last look saw in mirrors, by ascending mirrors; nothing until [`Viewer::follow_reflections`].
    pub fn images(&self) -> &[MirrorImage] {
        &self.images
    }
}

impl<S: CellSource + CoarseVisibility<PlaceError = <S as CellSource>::Error>> Viewer<S> {
    /// What an eye sees in a view: [`Viewer::look`] for tables that are read piece by piece.
    ///
    /// # Errors
    /// If the eye cannot be located, or the data of its cell cannot be read. Everything counts as seen then, as outside.
    pub fn try_look(&mut self, view: &View) -> Result<Look<'_>, S::Error> {
        let Self { cells, method, budget, doors, kept, scratch, place, seen, .. } = self;
        let [n_cells, n_objects] = counts(&**cells);
        seen.clear(n_cells, n_objects);
        self.images.clear();
        scratch.allow(*budget);
        let found = cells.cells_at(view.eye(), place).and_then(|here| {
            let at = here.inside().unwrap_or_default();
            let mut by = *method;
            for &cell in at {
                let subgraph = subgraph(&**cells, kept, cell)?;
                by = by.min(method.look(&subgraph, view, doors, scratch, seen));
            }
            Ok((at, (!at.is_empty()).then_some(by)))
        });
        self.sees_all = !matches!(found, Ok((_, Some(_))));
        if self.sees_all {
            seen.clear(n_cells, n_objects);
            seen.add_cells((0..n_cells as u32).map(CellId));
            seen.add_objects((0..n_objects as u32).map(ObjectId));
        }
        seen.sort();
        match &mut self.view {
            Some(last) => last.clone_from(view),
            none => *none = Some(view.clone()),
        }
        found.map(|(at, method)| Look { seen, at, method })
    }

    /// Follows the views into mirrors of the last look: [`Viewer::follow_reflections`] for tables that are read piece by piece.
    ///
    /// # Errors
    /// If the data of a cell with a mirror cannot be read. The images for which it was needed are not complete then.
    pub fn try_follow_reflections(&mut self, bounces: usize) -> Result<&[MirrorImage], S::Error> {
        let Self { cells, method, budget, doors, kept, scratch, seen, images, .. } = self;
        scratch.allow(*budget);
        let mut failed = None;
        let there = |cell| subgraph(&**cells, kept, cell).map_err(|error| failed = Some(error)).ok();
        *images = follow_reflections(*method, seen, bounces, doors, scratch, counts(&**cells), there);
        failed.map_or(Ok(images), Err)
    }
}

impl<S: CellSource<Error = Infallible> + CoarseVisibility<PlaceError = Infallible>> Viewer<S> {
    /// What an eye sees in a view, in scene units. The answer stays in the viewer until the next look.
    ///
    /// Errs towards visible, as [`Method`] describes; outside of every cell everything counts as seen. On the border between cells it is
    /// what is seen from any of them. Costs the method, after locating the eye; where the data of its cell is not kept, gathering it too:
    /// O(cells and objects that the cell may see, and their portals).
    pub fn look(&mut self, view: &View) -> Look<'_> {
        let Ok(look) = self.try_look(view);
        look
    }

    /// Follows the views into mirrors of the last look, through `bounces` mirrors one after another at most. What is found stays in the
    /// viewer until the next look. By ascending mirrors; none before the first look, and outside, where anything may be seen in them.
    ///
    /// Errs towards visible, within [`MirrorImage::complete`]. Costs a look for each view into a mirror, all together within the budget of one.
    /// Allocates.
    pub fn follow_reflections(&mut self, bounces: usize) -> &[MirrorImage] {
        let Ok(images) = self.try_follow_reflections(bounces);
        images
    }
}

impl<T: Borrow<Table>> Viewer<TableCells<T>> {
    /// The table.
    pub fn table(&self) -> &Table {
        self.cells.table()
    }

    /// Shuts a door of the table from the next look on, as [`Doors::close_door`]. Returns whether it was open; not if there is none.
    pub fn close_door(&mut self, door: DoorId) -> bool {
        self.doors.close_door(self.cells.table().doors(), door)
    }

    /// The portals that a line of the last look may pass, ascending: open ones between two cells of the answer whose box the view meets,
    /// within rounding. All of the table outside of every cell; none before the first look. O(portals).
    pub fn portals(&self) -> Vec<PortalId> {
        let table = self.table();
        let Some(view) = &self.view else { return Vec::new() };
        let may_pass = |&(portal, record): &(PortalId, &PortalRecord)| {
            if self.sees_all {
                return true;
            }
            let joins = || record.cells.iter().all(|&cell| self.seen.has_cell(cell));
            let Aabb { min, max } = Aabb::around(record.points.iter().copied());
            let (min, max) = table.frame().map_or((min, max), |frame| frame.around_in_scene(min, max));
            self.doors.is_open(portal) && joins() && view.may_meet(&Aabb { min, max })
        };
        (0u32..).map(PortalId).zip(table.portals()).filter(may_pass).map(|(portal, _)| portal).collect()
    }
}

impl<S> fmt::Debug for Viewer<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Viewer").field("method", &self.method).field("budget", &self.budget).finish_non_exhaustive()
    }
}

/// Numbers of cells and of objects.
fn counts(cells: &impl CellSource) -> [usize; 2] {
    [cells.n_cells(), cells.n_objects()]
}

/// The data of a cell, gathered unless it is kept.
fn subgraph<S: CellSource>(
    cells: &S,
    kept: &mut Cache<VisibleSubgraph>,
    cell: CellId,
) -> Result<Arc<VisibleSubgraph>, S::Error> {
    if let Some(subgraph) = kept.get(cell) {
        return Ok(Arc::clone(subgraph));
    }
    let made = VisibleSubgraph::prepare(cells, cell)?;
    let n_bytes = made.n_bytes();
    Ok(kept.add(cell, made, n_bytes))
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines_pvs::{BitMatrix, CellRecord, Locator, TableKind, TableParts};

    #[test]
    fn what_was_used_longest_ago_is_forgotten_first() {
        let room = |x: f64| CellRecord { min: [x, 0.0, 0.0], max: [x + 1.0, 1.0, 0.0], group: None, polygon: vec![] };
        let cells: Vec<_> = [0.0, 1.0, 2.0].map(room).to_vec();
        let bounds: Vec<_> = cells.iter().map(|cell| (cell.min, cell.max)).collect();
        let table = Table::new(TableParts {
            locator: Locator::build(&bounds, 2),
            rows: BitMatrix::identity(3),
            cells,
            cell_objects: vec![vec![]; 3],
            ..TableParts::empty(2, TableKind::Unspecified)
        });
        let mut viewer = Viewer::new(table.unwrap());
        let look = |viewer: &mut Viewer, x: f64| {
            viewer.look(&View::all_round([x, 0.5, 0.0]).unwrap());
            (0..3).filter(|&cell| viewer.kept.has(CellId(cell))).collect::<Vec<_>>()
        };
        assert_eq!(look(&mut viewer, 0.5), [0]);
        let (one, _) = viewer.kept();
        let limit = 2 * one + one / 2;
        viewer.set_memory(limit);
        assert_eq!(look(&mut viewer, 1.5), [0, 1]);
        assert_eq!(look(&mut viewer, 0.5), [0, 1]);
        assert_eq!(look(&mut viewer, 2.5), [0, 2]);
        assert!(viewer.kept().0 <= limit);
        viewer.set_memory(0);
        assert_eq!(viewer.kept().1, 1);
        assert!(viewer.kept.has(CellId(2)));
    }
}
