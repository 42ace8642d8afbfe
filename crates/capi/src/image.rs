//! What is seen in mirrors.

use crate::border;
use crate::info::below;
use crate::query::put_ids;
use crate::status::{Failure, SlStatus, guard};
use crate::viewer::{SlViewer, viewer};
use sightlines_eye_to_cell::MirrorImage;
use sightlines_walkthrough::Viewer;
use std::sync::MutexGuard;

/// What is seen by way of one mirror after another.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SlImage {
    /// Number of mirrors on the way.
    pub mirror_count: u32,
    /// Number of cells that are seen in them.
    pub cell_count: u32,
    /// Number of objects that are seen in them.
    pub object_count: u32,
    /// 1 if that is all. If 0, there were too many views: anything may be seen by way of these mirrors, and of others after them.
    pub is_complete: u32,
    /// 1 if a coarser method than the viewer's answered in some of these views.
    pub fell_back: u32,
}

/// Follows the views into mirrors of the last look. What is found stays in the viewer until the next look. Allocates.
///
/// @param bounces      The most mirrors one after another.
/// @param image_count  Where the number of images goes; images are numbered from 0, by ascending mirrors.
/// @return `SL_OK`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_viewer_follow_mirrors(
    viewer: *mut SlViewer,
    bounces: u32,
    image_count: *mut u32,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let mut viewer = unsafe { self::viewer(viewer)? };
        border::place(image_count, "the place of the count")?;
        let found = viewer.follow_reflections(bounces as usize).len() as u32;
        // SAFETY: pointers are as the header demands.
        unsafe { border::put(image_count, found, "the place of the count") }
    })
}

fn image_of<'a>(viewer: &'a MutexGuard<'_, Viewer>, image: u32) -> Result<&'a MirrorImage, Failure> {
    Ok(&viewer.images()[below(image, viewer.images().len(), "image")?])
}

/// Stores an image.
///
/// @param image  Its number, below the count of `sl_viewer_follow_mirrors`.
/// @param out    Where it goes.
/// @return `SL_OK`, or `SL_ERROR_ARGUMENT` if there is no such image.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_viewer_image(viewer: *const SlViewer, image: u32, out: *mut SlImage) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let viewer = unsafe { self::viewer(viewer)? };
        let image = image_of(&viewer, image)?;
        let value = SlImage {
            mirror_count: image.mirrors.len() as u32,
            cell_count: image.cells.len() as u32,
            object_count: image.objects.len() as u32,
            is_complete: image.complete.into(),
            fell_back: image.fell_back.into(),
        };
        // SAFETY: pointers are as the header demands.
        unsafe { border::put(out, value, "the place of the image") }
    })
}

/// The mirrors of an image, in the order in which a line from the eye meets them. In a scene each flat
/// rectangle of a mirror has a number of its own; in a plan it is that of the line.
///
/// @param image     Its number, below the count of `sl_viewer_follow_mirrors`.
/// @param mirrors   Where their numbers go, or null to ask for how many there are.
/// @param capacity  Number of mirrors that the buffer has room for; 0 if it is null.
/// @param count     Where their number goes.
/// @return `SL_OK`, `SL_ERROR_ARGUMENT` if there is no such image, or `SL_ERROR_BUFFER`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_viewer_image_mirrors(
    viewer: *const SlViewer,
    image: u32,
    mirrors: *mut u32,
    capacity: usize,
    count: *mut usize,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let viewer = unsafe { self::viewer(viewer)? };
        let found = &image_of(&viewer, image)?.mirrors;
        // SAFETY: pointers are as the header demands.
        unsafe { put_ids(found.iter().map(|mirror| mirror.0), found.len(), mirrors, capacity, count) }
    })
}

/// The cells of an image, ascending.
///
/// @param image     Its number, below the count of `sl_viewer_follow_mirrors`.
/// @param cells     Where their numbers go, or null to ask for how many there are.
/// @param capacity  Number of cells that the buffer has room for; 0 if it is null.
/// @param count     Where their number goes.
/// @return `SL_OK`, `SL_ERROR_ARGUMENT` if there is no such image, or `SL_ERROR_BUFFER`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_viewer_image_cells(
    viewer: *const SlViewer,
    image: u32,
    cells: *mut u32,
    capacity: usize,
    count: *mut usize,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let viewer = unsafe { self::viewer(viewer)? };
        let found = &image_of(&viewer, image)?.cells;
        // SAFETY: pointers are as the header demands.
        unsafe { put_ids(found.iter().map(|cell| cell.0), found.len(), cells, capacity, count) }
    })
}

/// The objects of an image, ascending.
///
/// @param image     Its number, below the count of `sl_viewer_follow_mirrors`.
/// @param objects   Where their numbers go, or null to ask for how many there are.
/// @param capacity  Number of objects that the buffer has room for; 0 if it is null.
/// @param count     Where their number goes.
/// @return `SL_OK`, `SL_ERROR_ARGUMENT` if there is no such image, or `SL_ERROR_BUFFER`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_viewer_image_objects(
    viewer: *const SlViewer,
    image: u32,
    objects: *mut u32,
    capacity: usize,
    count: *mut usize,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let viewer = unsafe { self::viewer(viewer)? };
        let found = &image_of(&viewer, image)?.objects;
        // SAFETY: pointers are as the header demands.
        unsafe { put_ids(found.iter().map(|object| object.0), found.len(), objects, capacity, count) }
    })
}
