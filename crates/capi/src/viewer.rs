//! Viewers: what one eye sees in one view.

use crate::border;
use crate::eye::SlAnswer;
use crate::handle::{self, Handle, lock};
use crate::info::below;
use crate::query::put_ids;
use crate::status::{Failure, Outcome, SlStatus, guard};
use crate::table::SlTable;
use crate::view::{SlView, view_of};
use sightlines_eye_to_cell::{Method, StepBudget};
use sightlines_pvs::PortalId;
use sightlines_walkthrough::Viewer;
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

/// The viewer behind a handle, for one call.
///
/// # Safety
/// As for [`handle::behind`].
pub(crate) unsafe fn viewer<'a>(handle: *const SlViewer) -> Result<MutexGuard<'a, Viewer>, Failure> {
    // SAFETY: as for this function.
    lock(unsafe { handle::behind(handle)? }, SlViewer::NAME)
}

/// Makes a viewer of a table: exact within the work of a frame (`SL_STEPS_FRAME`), with all doors open.
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
        let made = handle::give::<SlViewer>(Mutex::new(Viewer::of(cells)));
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
        viewer.set_method(method);
        viewer.set_budget(StepBudget::steps(max_steps));
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
        unsafe { self::viewer(viewer)? }.set_memory(bytes);
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
    let doors = viewer.doors_mut();
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
        unsafe { self::viewer(viewer)? }.doors_mut().open_all();
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
        let closed = viewer.doors().closed().map(|portal| portal.0);
        // SAFETY: pointers are as the header demands.
        unsafe { put_ids(closed, viewer.doors().n_closed(), portals, capacity, count) }
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
        let found = SlAnswer::of(&viewer.look(&view));
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
        let found = viewer.seen().cells();
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
        let found = viewer.seen().objects();
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
