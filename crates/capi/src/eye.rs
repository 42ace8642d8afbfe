//! What a look is asked for, and its answer.

use crate::status::SL_NONE;
use sightlines_eye_to_cell::Method;
use sightlines_walkthrough::Look;

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

impl SlAnswer {
    pub(crate) fn of(look: &Look<'_>) -> Self {
        let number = |by: Method| Method::ALL.iter().position(|&method| method == by).map_or(SL_NONE, |i| i as u32);
        Self {
            is_outside: look.is_outside().into(),
            method: look.method.map_or(SL_NONE, number),
            cell_count: look.seen.cells().len() as u32,
            object_count: look.seen.objects().len() as u32,
            mirror_view_count: look.seen.reflections().len() as u32,
        }
    }
}
