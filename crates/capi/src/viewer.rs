//! Viewers: what one eye sees in one view.

use crate::border;
use crate::handle::{self, Handle, lock};
use crate::info::below;
use crate::query::put_ids;
use crate::status::{Failure, Outcome, SL_NONE, SlStatus, guard};
use crate::table::{Shared, SlTable};
use crate::view::{SlView, view_of};
use sightlines_eye_to_cell::{Budget, Doors, Image, Method, Scratch, View, VisibleSet, VisibleSubgraph};
use sightlines_geometry::Aabb;
use sightlines_pvs::{CellId, Place, PlaceBuffer, PortalId, Table};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard};

/// What follows one eye through a table: the data of the cells that it was in lately, the doors that are closed for it, and its last
/// answer. One call at a time; take one for each thread that looks.
pub struct SlViewer {
    _opaque: [u8; 0],
}

impl Handle for SlViewer {
    type State = Mutex<Viewer>;
    const TAG: u64 = 0x51_6876_6965_7765;
    const NAME: &'static str = "viewer";
}

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
    budget: Budget,
    pub(crate) doors: Doors,
    kept: Kept,
    scratch: Scratch,
    place: PlaceBuffer,
    pub(crate) seen: VisibleSet,
    /// The last view; none before the first.
    view: Option<View>,
    pub(crate) answer: SlAnswer,
    pub(crate) images: Vec<Image>,
}

/// Memory for the data of cells, unless a viewer is told otherwise: 64 MiB.
const KEPT_BYTES: usize = 64 << 20;

impl Viewer {
    fn new(cells: Shared) -> Self {
        let nothing = SlAnswer { is_outside: 0, method: SL_NONE, cell_count: 0, object_count: 0, mirror_view_count: 0 };
        Self {
            cells,
            method: Method::Exact,
            budget: Budget::UNLIMITED,
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

    pub(crate) fn table_and_doors(&mut self) -> (&Table, &mut Doors) {
        (self.cells.table(), &mut self.doors)
    }

    fn look(&mut self, view: View) -> SlAnswer {
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
    fn portals(&self) -> Vec<PortalId> {
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

/// The viewer behind a handle, for one call.
///
/// # Safety
/// As for [`handle::behind`].
pub(crate) unsafe fn viewer<'a>(handle: *const SlViewer) -> Result<MutexGuard<'a, Viewer>, Failure> {
    // SAFETY: as for this function.
    lock(unsafe { handle::behind(handle)? }, SlViewer::NAME)
}

/// Makes a viewer of a table: exact, without a bound on its work, with all doors open.
///
/// @param table   The table, which may be freed before the viewer.
/// @param viewer  Where the handle goes; free it with `sl_viewer_free`. Null is stored there if the call fails.
/// @return `SL_OK`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_viewer_new(table: *const SlTable, viewer: *mut *mut SlViewer) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        unsafe { border::put(viewer, std::ptr::null_mut(), "the place of the viewer")? };
        // SAFETY: pointers are as the header demands.
        let cells = Arc::clone(unsafe { handle::behind(table)? });
        let made = handle::give::<SlViewer>(Mutex::new(Viewer::new(cells)));
        // SAFETY: pointers are as the header demands.
        unsafe { border::put(viewer, made, "the place of the viewer") }
    })
}

/// Frees a viewer.
///
/// @param viewer  A viewer that no other thread is using, or null, for which nothing is done.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_viewer_free(viewer: *mut SlViewer) {
    // SAFETY: pointers are as the header demands.
    guard(|| unsafe { handle::free(viewer) });
}

/// Chooses the method of all looks from here on, and what one look may do.
///
/// @param method     `SL_METHOD_…`: each sees less than the one before, and costs more.
/// @param max_steps  For the exact method: about so many tests of a box against a cone of sight, counted and never timed. An answer that
///                   would take more is exact near the eye, and that of the incident portals farther away. `SL_STEPS_FRAME`,
///                   `SL_STEPS_UNLIMITED`, or another number.
/// @return `SL_OK`, or `SL_ERROR_ARGUMENT` for a number that is no method.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_viewer_set_method(viewer: *mut SlViewer, method: u32, max_steps: u64) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let mut viewer = unsafe { self::viewer(viewer)? };
        let method = Method::ALL[below(method, Method::ALL.len(), "method")?];
        (viewer.method, viewer.budget) = (method, Budget::steps(max_steps));
        Ok(())
    })
}

/// Bounds the memory for the data of cells that the eye was in lately, 64 MiB at first. That of the cell that was asked for last is
/// kept in any case.
///
/// @param bytes  The bound.
/// @return `SL_OK`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_viewer_set_memory(viewer: *mut SlViewer, bytes: usize) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let mut viewer = unsafe { self::viewer(viewer)? };
        viewer.kept.limit = bytes;
        viewer.kept.evict();
        Ok(())
    })
}

/// Closes a portal for this viewer, from the next look on: nothing is seen through it. Nothing is computed anew. The methods from
/// `SL_METHOD_CONNECTED_COMPONENT` on heed it.
///
/// @param portal  Its number, below `portal_count`.
/// @return `SL_OK`, or `SL_ERROR_ARGUMENT` if there is no such portal.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_viewer_close_portal(viewer: *mut SlViewer, portal: u32) -> SlStatus {
    // SAFETY: pointers are as the header demands.
    guard(|| unsafe { set_portal(viewer, portal, false) })
}

/// Opens a portal that was closed, unless a shut door closes it too.
///
/// @param portal  Its number, below `portal_count`.
/// @return `SL_OK`, or `SL_ERROR_ARGUMENT` if there is no such portal.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_viewer_open_portal(viewer: *mut SlViewer, portal: u32) -> SlStatus {
    // SAFETY: pointers are as the header demands.
    guard(|| unsafe { set_portal(viewer, portal, true) })
}

/// Opens or closes a portal.
///
/// # Safety
/// As for [`viewer`].
unsafe fn set_portal(viewer: *mut SlViewer, portal: u32, open: bool) -> Outcome {
    // SAFETY: as for this function.
    let mut viewer = unsafe { self::viewer(viewer)? };
    below(portal, viewer.table().portals().len(), "portal")?;
    let doors = &mut viewer.doors;
    if open {
        doors.open(PortalId(portal))
    } else {
        doors.close(PortalId(portal))
    };
    Ok(())
}

/// Opens all portals and doors.
///
/// @return `SL_OK`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_viewer_open_all(viewer: *mut SlViewer) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        unsafe { self::viewer(viewer)? }.doors.open_all();
        Ok(())
    })
}

/// The portals that are closed, ascending.
///
/// @param portals   Where their numbers go, or null to ask for how many there are.
/// @param capacity  Number of portals that the buffer has room for; 0 if it is null.
/// @param count     Where their number goes.
/// @return `SL_OK`, or `SL_ERROR_BUFFER`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_viewer_closed_portals(
    viewer: *const SlViewer,
    portals: *mut u32,
    capacity: usize,
    count: *mut usize,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let viewer = unsafe { self::viewer(viewer)? };
        let closed = viewer.doors.closed().map(|portal| portal.0);
        // SAFETY: pointers are as the header demands.
        unsafe { put_ids(closed, viewer.doors.n_closed(), portals, capacity, count) }
    })
}

/// Finds what an eye sees in a view. The answer stays in the viewer until the next look; `sl_viewer_cells`, `sl_viewer_objects`
/// and `sl_viewer_portals` copy it out.
///
/// Errs towards visible. Outside of every cell the answer is everything. The first look from a cell gathers the data of that cell,
/// which takes longer; later ones from there do not.
///
/// @param view    Where the eye is and what it looks at.
/// @param answer  Where counts and the method go; may be null.
/// @return `SL_OK`, `SL_ERROR_VIEW` for numbers that are no view of this table, or `SL_ERROR_BUSY`. After a failure the last answer
///         stands.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_viewer_look(viewer: *mut SlViewer, view: *const SlView, answer: *mut SlAnswer) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let (mut viewer, view) = unsafe { (self::viewer(viewer)?, border::read(view, "the view")?) };
        let view = view_of(view, viewer.table().dimension())?;
        if !answer.is_null() {
            border::place(answer, "the place of the answer")?;
        }
        let found = viewer.look(view);
        // SAFETY: pointers are as the header demands.
        if answer.is_null() { Ok(()) } else { unsafe { border::put(answer, found, "the place of the answer") } }
    })
}

/// The cells of the last look, ascending; none before the first.
///
/// @param cells     Where their numbers go, or null to ask for how many there are.
/// @param capacity  Number of cells that the buffer has room for; 0 if it is null.
/// @param count     Where their number goes.
/// @return `SL_OK`, or `SL_ERROR_BUFFER`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_viewer_cells(
    viewer: *const SlViewer,
    cells: *mut u32,
    capacity: usize,
    count: *mut usize,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let viewer = unsafe { self::viewer(viewer)? };
        let found = viewer.seen.cells();
        // SAFETY: pointers are as the header demands.
        unsafe { put_ids(found.iter().map(|cell| cell.0), found.len(), cells, capacity, count) }
    })
}

/// The objects of the last look, ascending: what to draw. None before the first.
///
/// @param objects   Where their numbers go, or null to ask for how many there are.
/// @param capacity  Number of objects that the buffer has room for; 0 if it is null.
/// @param count     Where their number goes.
/// @return `SL_OK`, or `SL_ERROR_BUFFER`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_viewer_objects(
    viewer: *const SlViewer,
    objects: *mut u32,
    capacity: usize,
    count: *mut usize,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let viewer = unsafe { self::viewer(viewer)? };
        let found = viewer.seen.objects();
        // SAFETY: pointers are as the header demands.
        unsafe { put_ids(found.iter().map(|object| object.0), found.len(), objects, capacity, count) }
    })
}

/// The portals that a line of the last look may pass, ascending: open ones between two cells of the answer whose box is in view. All
/// of the table outside of every cell; none before the first look. O(portals).
///
/// @param portals   Where their numbers go, or null to ask for how many there are.
/// @param capacity  Number of portals that the buffer has room for; 0 if it is null.
/// @param count     Where their number goes.
/// @return `SL_OK`, or `SL_ERROR_BUFFER`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_viewer_portals(
    viewer: *const SlViewer,
    portals: *mut u32,
    capacity: usize,
    count: *mut usize,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let found = unsafe { self::viewer(viewer)? }.portals();
        // SAFETY: pointers are as the header demands.
        unsafe { put_ids(found.iter().map(|portal| portal.0), found.len(), portals, capacity, count) }
    })
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
