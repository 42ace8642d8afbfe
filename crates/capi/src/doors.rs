//! Doors by name, portals in a box, and where objects are in the file that a table was made of.

use crate::border;
use crate::info::{SlBox, below};
use crate::query::put_ids;
use crate::status::{Failure, SL_ERROR_NOT_FOUND, SL_NONE, SlStatus, guard};
use crate::table::{SlTable, table};
use crate::viewer::{SlViewer, viewer};
use sightlines_pvs::{DoorId, ObjectId};
use sightlines_walkthrough::Viewer;
use std::ffi::c_char;
use std::sync::Arc;

/// A door: what closes portals while it is shut.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SlDoor {
    /// The object that is the door; `SL_NONE` for one that was given as a box.
    pub object: u32,
    /// Number of portals that it closes; 0 if it fills no opening, or only parts of portals.
    pub portal_count: u32,
}

/// Where an object is in the glTF file that its table was made of.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SlSource {
    /// The index of the node in the `nodes` of the file; `SL_NONE` if it is not known.
    pub node: u32,
    /// The index of the primitive in the `primitives` of the node's mesh; `SL_NONE` if it is not known.
    pub primitive: u32,
}

/// Stores a door.
///
/// @param door  Its number, below `door_count`.
/// @param out   Where it goes.
/// @return `SL_OK`, or `SL_ERROR_ARGUMENT` if there is no such door.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_table_door(table: *const SlTable, door: u32, out: *mut SlDoor) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let table = unsafe { self::table(table)? };
        let record = &table.doors()[below(door, table.doors().len(), "door")?];
        let object = record.object.map_or(SL_NONE, |object| object.0);
        let value = SlDoor { object, portal_count: record.portals.len() as u32 };
        // SAFETY: pointers are as the header demands.
        unsafe { border::put(out, value, "the place of the door") }
    })
}

/// The name of a door, in UTF-8. Names may repeat: the two wings of a door may have one.
///
/// @param door      Its number, below `door_count`.
/// @param buffer    Where the name goes, with a zero byte behind it, or null to ask for its length.
/// @param capacity  Number of bytes that the buffer has room for, the zero byte included; 0 if it is null.
/// @param length    Where the length in bytes goes, without the zero byte.
/// @return `SL_OK`, `SL_ERROR_ARGUMENT` if there is no such door, or `SL_ERROR_BUFFER`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_table_door_name(
    table: *const SlTable,
    door: u32,
    buffer: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let table = unsafe { self::table(table)? };
        let record = &table.doors()[below(door, table.doors().len(), "door")?];
        // SAFETY: pointers are as the header demands.
        unsafe { border::put_text(&record.name, buffer, capacity, length) }
    })
}

/// The portals that a door closes while it is shut, ascending.
///
/// @param door      Its number, below `door_count`.
/// @param portals   Where their numbers go, or null to ask for how many there are.
/// @param capacity  Number of portals that the buffer has room for; 0 if it is null.
/// @param count     Where their number goes.
/// @return `SL_OK`, `SL_ERROR_ARGUMENT` if there is no such door, or `SL_ERROR_BUFFER`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_table_door_portals(
    table: *const SlTable,
    door: u32,
    portals: *mut u32,
    capacity: usize,
    count: *mut usize,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let table = unsafe { self::table(table)? };
        let found = &table.doors()[below(door, table.doors().len(), "door")?].portals;
        // SAFETY: pointers are as the header demands.
        unsafe { put_ids(found.iter().map(|portal| portal.0), found.len(), portals, capacity, count) }
    })
}

/// The doors of a name, ascending: names may repeat. O(doors).
///
/// @param name      UTF-8, with a zero byte at its end.
/// @param doors     Where their numbers go, or null to ask for how many there are.
/// @param capacity  Number of doors that the buffer has room for; 0 if it is null.
/// @param count     Where their number goes: 0 if there is no such door.
/// @return `SL_OK`, or `SL_ERROR_BUFFER`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_table_find_doors(
    table: *const SlTable,
    name: *const c_char,
    doors: *mut u32,
    capacity: usize,
    count: *mut usize,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let (table, name) = unsafe { (self::table(table)?, border::text(name, "the name")?) };
        let found: Vec<DoorId> = table.door(name).collect();
        // SAFETY: pointers are as the header demands.
        unsafe { put_ids(found.iter().map(|door| door.0), found.len(), doors, capacity, count) }
    })
}

/// The portals that lie entirely in a closed box, ascending: those that something solid of that shape closes. What is rounded errs
/// towards not in it. O(portals).
///
/// @param bounds    The box, in scene units; z does not count in a plane. One with a NaN contains nothing.
/// @param portals   Where their numbers go, or null to ask for how many there are.
/// @param capacity  Number of portals that the buffer has room for; 0 if it is null.
/// @param count     Where their number goes.
/// @return `SL_OK`, or `SL_ERROR_BUFFER`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_table_portals_within(
    table: *const SlTable,
    bounds: *const SlBox,
    portals: *mut u32,
    capacity: usize,
    count: *mut usize,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let (table, bounds) = unsafe { (self::table(table)?, *border::read(bounds, "the box")?) };
        let found = table.portals_within(bounds.min, bounds.max);
        // SAFETY: pointers are as the header demands.
        unsafe { put_ids(found.iter().map(|portal| portal.0), found.len(), portals, capacity, count) }
    })
}

/// Stores where an object is in the glTF file that the table was made of.
///
/// @param object  Its number, below `object_count`.
/// @param out     Where it goes; `SL_NONE` twice if it is not known.
/// @return `SL_OK`, or `SL_ERROR_ARGUMENT` if there is no such object.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_table_object_source(table: *const SlTable, object: u32, out: *mut SlSource) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let table = unsafe { self::table(table)? };
        below(object, table.objects().len(), "object")?;
        let unknown = SlSource { node: SL_NONE, primitive: SL_NONE };
        let found = table.source_of(ObjectId(object));
        let value = found.map_or(unknown, |source| SlSource { node: source.node, primitive: source.primitive });
        // SAFETY: pointers are as the header demands.
        unsafe { border::put(out, value, "the place of the source") }
    })
}

/// The objects of a node of the glTF file that the table was made of, ascending: one for each primitive of its mesh.
///
/// @param node      Its index in the `nodes` of the file.
/// @param objects   Where the numbers of the objects go, or null to ask for how many there are.
/// @param capacity  Number of objects that the buffer has room for; 0 if it is null.
/// @param count     Where their number goes: 0 for a node without a mesh, and where it is not known.
/// @return `SL_OK`, or `SL_ERROR_BUFFER`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_table_objects_of_node(
    table: *const SlTable,
    node: u32,
    objects: *mut u32,
    capacity: usize,
    count: *mut usize,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let table = unsafe { self::table(table)? };
        let found: Vec<ObjectId> = table.objects_of_node(node).collect();
        // SAFETY: pointers are as the header demands.
        unsafe { put_ids(found.iter().map(|object| object.0), found.len(), objects, capacity, count) }
    })
}

/// Shuts a door for this viewer, from the next look on: nothing is seen through its portals. Shutting a shut door does nothing.
///
/// @param door  Its number, below `door_count` of the table.
/// @return `SL_OK`, or `SL_ERROR_ARGUMENT` if there is no such door.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_viewer_close_door(viewer: *mut SlViewer, door: u32) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let mut viewer = unsafe { self::viewer(viewer)? };
        below(door, viewer.table().doors().len(), "door")?;
        set_doors(&mut viewer, [DoorId(door)], false);
        Ok(())
    })
}

/// Opens a door that was shut. Its portals can be passed again, unless another shut door closes them, or they were closed alone.
///
/// @param door  Its number, below `door_count` of the table.
/// @return `SL_OK`, or `SL_ERROR_ARGUMENT` if there is no such door.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_viewer_open_door(viewer: *mut SlViewer, door: u32) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let mut viewer = unsafe { self::viewer(viewer)? };
        below(door, viewer.table().doors().len(), "door")?;
        set_doors(&mut viewer, [DoorId(door)], true);
        Ok(())
    })
}

/// Shuts all doors of a name, as the two wings of a door. O(doors).
///
/// @param name  UTF-8, with a zero byte at its end.
/// @return `SL_OK`, or `SL_ERROR_NOT_FOUND` if no door has that name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_viewer_close_doors_named(viewer: *mut SlViewer, name: *const c_char) -> SlStatus {
    // SAFETY: pointers are as the header demands.
    guard(|| unsafe { set_named(viewer, name, false) })
}

/// Opens all doors of a name. O(doors).
///
/// @param name  UTF-8, with a zero byte at its end.
/// @return `SL_OK`, or `SL_ERROR_NOT_FOUND` if no door has that name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_viewer_open_doors_named(viewer: *mut SlViewer, name: *const c_char) -> SlStatus {
    // SAFETY: pointers are as the header demands.
    guard(|| unsafe { set_named(viewer, name, true) })
}

/// Opens or shuts all doors of a name.
///
/// # Safety
/// As for [`viewer`], and for the module `border`.
unsafe fn set_named(viewer: *mut SlViewer, name: *const c_char, open: bool) -> Result<(), Failure> {
    // SAFETY: as for this function.
    let (mut viewer, name) = unsafe { (self::viewer(viewer)?, border::text(name, "the name")?) };
    let found: Vec<DoorId> = viewer.table().door(name).collect();
    if found.is_empty() {
        return Err(Failure::new(SL_ERROR_NOT_FOUND, format!("no door is called '{name}'")));
    }
    set_doors(&mut viewer, found, open);
    Ok(())
}

fn set_doors(viewer: &mut Viewer, ids: impl IntoIterator<Item = DoorId>, open: bool) {
    let cells = Arc::clone(viewer.cells());
    let doors = viewer.doors_mut();
    for door in ids {
        if open {
            doors.open_door(door);
        } else {
            doors.close_door(cells.table().doors(), door);
        }
    }
}
