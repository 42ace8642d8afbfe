//! What follows one eye: its answer, and what it keeps from look to look.

use crate::status::SL_NONE;
use crate::table::Shared;
use sightlines_eye_to_cell::{Budget, Doors, Image, Method, Scratch, View, VisibleSet, VisibleSubgraph};
use sightlines_geometry::Aabb;
use sightlines_pvs::{CellId, Place, PlaceBuffer, PortalId, Table};
use std::collections::BTreeMap;
use std::sync::Arc;

/// All that the table says the eye's cells may see, in view or not.
pub const SL_METHOD_CELL_TO_CELL: u32 = 0;
/// The cells whose box is in view.
pub const SL_METHOD_DISJOINT_CELL: u32 = 1;
/// Those that are reached through cells whose box is in view.
pub const SL_METHOD_CONNECTED_COMPONENT: u32 = 2;
/// Those that are reached through portals that are in view.
pub const SL_METHOD_INCIDENT_PORTALS: u32 = 3;
/// Those to which a line leads from the eye, through open portals, within the view. The default.
pub const SL_METHOD_EXACT: u32 = 4;

/// No bound on the work of a look. The default.
pub const SL_STEPS_UNLIMITED: u64 = u64::MAX;
/// What a frame can spare as a rule: some tens of microseconds.
pub const SL_STEPS_FRAME: u64 = 4096;

/// The answer to a look.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SlAnswer {
    /// 1 if the eye is in no cell. Nothing is known there: the answer has all cells, objects and portals, and anything may be seen in
    /// mirrors.
    pub is_outside: u32,
    /// The method that answered, `SL_METHOD_…`: the one that was asked for, or a coarser one where that had more to do than it may;
    /// `SL_NONE` outside.
    pub method: u32,
    /// Number of cells that are seen.
    pub cell_count: u32,
    /// Number of objects that are seen.
    pub object_count: u32,
    /// Number of views into mirrors, of which `sl_viewer_follow_mirrors` tells what is seen in them.
    pub mirror_view_count: u32,
}

/// The data of cells that were looked from lately.
struct Kept {
    subgraphs: BTreeMap<CellId, (Arc<VisibleSubgraph>, u64)>,
    n_bytes: usize,
    limit: usize,
    clock: u64,
}

impl Kept {
    fn get(&mut self, cells: &Shared, cell: CellId) -> Arc<VisibleSubgraph> {
        self.clock += 1;
        if let Some((subgraph, used)) = self.subgraphs.get_mut(&cell) {
            *used = self.clock;
            return Arc::clone(subgraph);
        }
        let Ok(made) = VisibleSubgraph::prepare(&**cells, cell);
        let made = Arc::new(made);
        self.n_bytes += made.n_bytes();
        self.subgraphs.insert(cell, (Arc::clone(&made), self.clock));
        self.evict();
        made
    }

    /// Forgets what was used longest ago, but for the last, until the rest is within the limit.
    fn evict(&mut self) {
        while self.n_bytes > self.limit && self.subgraphs.len() > 1 {
            let oldest = self.subgraphs.iter().min_by_key(|(_, (_, used))| *used).map(|(cell, _)| *cell);
            if let Some((subgraph, _)) = oldest.and_then(|cell| self.subgraphs.remove(&cell)) {
                self.n_bytes -= subgraph.n_bytes();
            }
        }
    }
}

/// What is behind a viewer's handle.
pub struct Viewer {
    cells: Shared,
    pub(crate) method: Method,
    pub(crate) budget: Budget,
    pub(crate) doors: Doors,
    kept: Kept,
    scratch: Scratch,
    place: PlaceBuffer,
    pub(crate) seen: VisibleSet,
    /// The last view; none before the first.
    view: Option<View>,
    answer: SlAnswer,
    pub(crate) images: Vec<Image>,
}

/// Memory for the data of cells, unless a viewer is told otherwise: 64 MiB.
const KEPT_BYTES: usize = 64 << 20;

impl Viewer {
    pub(crate) fn new(cells: Shared) -> Self {
        let nothing = SlAnswer { is_outside: 0, method: SL_NONE, cell_count: 0, object_count: 0, mirror_view_count: 0 };
        Self {
            cells,
            method: Method::Exact,
            budget: Budget::FRAME,
            doors: Doors::all_open(),
            kept: Kept { subgraphs: BTreeMap::new(), n_bytes: 0, limit: KEPT_BYTES, clock: 0 },
            scratch: Scratch::new(),
            place: PlaceBuffer::new(),
            seen: VisibleSet::new(),
            view: None,
            answer: nothing,
            images: Vec::new(),
        }
    }

    pub(crate) fn table(&self) -> &Table {
        self.cells.table()
    }

    /// Bounds what is kept of the cells that were looked from.
    pub(crate) fn set_memory(&mut self, n_bytes: usize) {
        self.kept.limit = n_bytes;
        self.kept.evict();
    }

    pub(crate) fn table_and_doors(&mut self) -> (&Table, &mut Doors) {
        (self.cells.table(), &mut self.doors)
    }

    pub(crate) fn look(&mut self, view: View) -> SlAnswer {
        let Self { cells, method, budget, doors, kept, scratch, place, seen, .. } = self;
        let table = cells.table();
        let (n_cells, n_objects) = (table.n_cells(), table.objects().len());
        seen.clear(n_cells, n_objects);
        self.images.clear();
        let number = |method: Method| Method::ALL.iter().position(|&m| m == method).map_or(SL_NONE, |i| i as u32);
        let (is_outside, method) = match table.cells_at(view.eye(), place) {
            Place::Outside => {
                seen.add_cells((0..n_cells as u32).map(CellId));
                seen.add_objects((0..n_objects as u32).map(sightlines_pvs::ObjectId));
                (1, SL_NONE)
            }
            Place::Inside(here) => {
                scratch.allow(*budget);
                let look = |&cell: &CellId| method.look(&kept.get(cells, cell), &view, doors, scratch, seen);
                (0, here.iter().map(look).min().map_or(SL_NONE, number))
            }
        };
        seen.sort();
        self.view = Some(view);
        self.answer = SlAnswer {
            is_outside,
            method,
            cell_count: seen.cells().len() as u32,
            object_count: seen.objects().len() as u32,
            mirror_view_count: seen.reflections().len() as u32,
        };
        self.answer
    }

    /// Open portals between two cells of the answer that the view may meet, ascending; outside all of the table.
    pub(crate) fn portals(&self) -> Vec<PortalId> {
        let table = self.table();
        let Some(view) = &self.view else { return Vec::new() };
        let portals = (0u32..).map(PortalId).zip(table.portals());
        let may_pass = |&(portal, record): &(PortalId, &sightlines_pvs::PortalRecord)| {
            if self.answer.is_outside == 1 {
                return true;
            }
            let joins = || record.cells.iter().all(|&cell| self.seen.has_cell(cell));
            let Aabb { min, max } = Aabb::around(record.points.iter().copied());
            let (min, max) = table.frame().map_or((min, max), |frame| frame.around_in_scene(min, max));
            self.doors.is_open(portal) && joins() && view.may_meet(&Aabb { min, max })
        };
        portals.filter(may_pass).map(|(portal, _)| portal).collect()
    }

    pub(crate) fn follow(&mut self, bounces: u32) {
        let Self { cells, method, budget, doors, kept, scratch, seen, .. } = self;
        scratch.allow(*budget);
        let sizes = [cells.table().n_cells(), cells.table().objects().len()];
        let subgraph = |cell: CellId| Some(kept.get(cells, cell));
        self.images = sightlines_eye_to_cell::follow_reflections(
            *method,
            seen,
            bounces as usize,
            doors,
            scratch,
            sizes,
            subgraph,
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines_eye_to_cell::TableCells;
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
        })
        .expect("a table");
        let mut viewer = Viewer::new(Arc::new(TableCells::new(Arc::new(table))));
        let look = |viewer: &mut Viewer, x: f64| {
            viewer.look(View::all_round([x, 0.5, 0.0]).expect("a view"));
            viewer.kept.subgraphs.keys().map(|cell| cell.0).collect::<Vec<_>>()
        };
        assert_eq!(look(&mut viewer, 0.5), [0]);
        let one = viewer.kept.n_bytes;
        viewer.kept.limit = 2 * one + one / 2;
        assert_eq!(look(&mut viewer, 1.5), [0, 1]);
        assert_eq!(look(&mut viewer, 0.5), [0, 1]);
        assert_eq!(look(&mut viewer, 2.5), [0, 2]);
        assert!(viewer.kept.n_bytes <= viewer.kept.limit);
        viewer.kept.limit = 0;
        viewer.kept.evict();
        assert_eq!(viewer.kept.subgraphs.len(), 1);
    }
}
