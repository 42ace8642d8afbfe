//! What a table is about: its cells, objects, portals and names.

use crate::border;
use crate::status::{Failure, SL_ERROR_NOT_FOUND, SL_NONE, SlStatus, guard};
use crate::table::{SlTable, table};
use sightlines_pvs::{CellId, ObjectId, Table, TableKind};
use std::ffi::c_char;

/// A box along the axes, in scene units. In a table of the plane z is 0.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlBox {
    /// The lower corner.
    pub min: [f64; 3],
    /// The upper corner.
    pub max: [f64; 3],
}

impl border::Plain for SlBox {}

/// A table that does not say what it was made of.
pub const SL_KIND_UNSPECIFIED: u32 = 0;
/// A plan cut along its axis-parallel walls.
pub const SL_KIND_PLAN_KD_TREE: u32 = 1;
/// A plan cut by a triangulation.
pub const SL_KIND_PLAN_TRIANGULATION: u32 = 2;
/// A scene in space cut by a k-d tree: boxes with portals between them. What is in no cell is inside of something solid.
pub const SL_KIND_SCENE_KD_TREE: u32 = 3;
/// A scene in space seen from boxes that were given or cut without portals; they may overlap, and leave gaps.
pub const SL_KIND_SCENE_BOXES: u32 = 4;
/// The portal file of a Quake map; points cannot be located.
pub const SL_KIND_QUAKE_PORTALS: u32 = 5;
/// A Quake map with its portals.
pub const SL_KIND_QUAKE_MAP: u32 = 6;

/// What a table is about: filled by `sl_table_get_info`. Set `struct_size` to `sizeof(sl_table_info)` before.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlTableInfo {
    /// The size of this structure, in bytes.
    pub struct_size: usize,
    /// 2 for a plane, 3 for space.
    pub dimension: u32,
    /// What was cut into cells, and how: `SL_KIND_…`.
    pub kind: u32,
    /// Number of cells; cells are numbered from 0.
    pub cell_count: u32,
    /// Number of objects; objects are numbered from 0, in the order of the scene.
    pub object_count: u32,
    /// Number of portals; portals are numbered from 0.
    pub portal_count: u32,
    /// Number of doors; doors are numbered from 0.
    pub door_count: u32,
    /// Number of parts of mirrors.
    pub mirror_part_count: u32,
    /// The axis that points up, 0 to 2; `SL_NONE` if it is not known.
    pub up_axis: u32,
    /// 1 if cells have names.
    pub has_cell_names: u32,
    /// 1 if it is known where objects are in the file that the table was made of.
    pub has_sources: u32,
    /// 1 if points can be located.
    pub has_places: u32,
    /// 1 if there may be air outside of every cell, within the box around them.
    pub leaves_gaps: u32,
    /// 1 if nothing is promised for eyes inside of solid matter.
    pub only_in_air: u32,
    /// 1 if the table stands along axes of its own, `frame_axes`. Points and views of queries are those of the scene all the same; only
    /// boxes and corners that are read out of the table are along these axes.
    pub has_frame: u32,
    /// Three unit vectors of the scene, one after the other; those of the scene if there is no frame.
    pub frame_axes: [f64; 9],
    /// How far coordinates may be from those of the scene, along the axes of the frame, in scene units: openings narrower than this may
    /// count as closed. 0 without a frame.
    pub frame_gap: f64,
    /// 1 if the digests are known.
    pub has_digest: u32,
    /// A hash of what hides in the scene that the table was made of, little-endian.
    pub digest_hiding: [u8; 16],
    /// A hash of what is seen in that scene, little-endian.
    pub digest_seen: [u8; 16],
    /// The box around all cells, along the axes of the table; all 0 without cells.
    pub bounds: SlBox,
    /// Of all pairs of different cells, the share that may see each other, from 0 to 1; 0 for fewer than two cells.
    pub mean_visible_share: f64,
}

/// A cell: where a viewer can be.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlCell {
    /// The box around it.
    pub bounds: SlBox,
    /// The group that it belongs to, such as a sector of a Doom map; `SL_NONE` for none.
    pub group: u32,
    /// In a plane: the number of its corners, see `sl_table_cell_corners`; 0 if the cell is the box itself.
    pub corner_count: u32,
}

/// An object: what is seen or not.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlObject {
    /// The box around it, wherever it moves.
    pub bounds: SlBox,
    /// The polygons that are drawn for it; 1 if it is not known.
    pub polygon_count: u32,
}

/// An opening between two cells.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlPortal {
    /// The two cells.
    pub cells: [u32; 2],
    /// The number of its corners, see `sl_table_portal_corners`.
    pub corner_count: u32,
}

pub(crate) fn box_of(min: [f64; 3], max: [f64; 3]) -> SlBox {
    SlBox { min, max }
}

fn kind_of(kind: TableKind) -> u32 {
    match kind {
        TableKind::PlanKdTree => SL_KIND_PLAN_KD_TREE,
        TableKind::PlanTriangulation => SL_KIND_PLAN_TRIANGULATION,
        TableKind::SceneKdTree { .. } => SL_KIND_SCENE_KD_TREE,
        TableKind::SceneGivenCells { .. } => SL_KIND_SCENE_BOXES,
        TableKind::QuakePortalFile => SL_KIND_QUAKE_PORTALS,
        TableKind::QuakeMap => SL_KIND_QUAKE_MAP,
        _ => SL_KIND_UNSPECIFIED,
    }
}

fn info_of(table: &Table) -> SlTableInfo {
    let frame = table.frame();
    let axes = frame.map_or([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], |frame| frame.axes());
    let mut frame_axes = [0.0; 9];
    frame_axes.copy_from_slice(axes.as_flattened());
    let united = |a: SlBox, b: SlBox| SlBox {
        min: std::array::from_fn(|k| a.min[k].min(b.min[k])),
        max: std::array::from_fn(|k| a.max[k].max(b.max[k])),
    };
    let bounds = table.cells().iter().map(|cell| box_of(cell.min, cell.max)).reduce(united);
    let digest = table.digest();
    SlTableInfo {
        struct_size: size_of::<SlTableInfo>(),
        dimension: table.dimension().into(),
        kind: kind_of(table.kind()),
        cell_count: table.n_cells() as u32,
        object_count: table.objects().len() as u32,
        portal_count: table.portals().len() as u32,
        door_count: table.doors().len() as u32,
        mirror_part_count: table.mirrors().len() as u32,
        up_axis: table.up().map_or(SL_NONE, |axis| axis.idx() as u32),
        has_cell_names: table.has_cell_names().into(),
        has_sources: table.has_sources().into(),
        has_places: table.has_places().into(),
        leaves_gaps: table.kind().leaves_gaps().into(),
        only_in_air: table.kind().only_in_air().into(),
        has_frame: frame.is_some().into(),
        frame_axes,
        frame_gap: frame.map_or(0.0, |frame| frame.gap()),
        has_digest: digest.is_some().into(),
        digest_hiding: digest.map_or([0; 16], |digest| digest.hiding.to_le_bytes()),
        digest_seen: digest.map_or([0; 16], |digest| digest.seen.to_le_bytes()),
        bounds: bounds.unwrap_or(box_of([0.0; 3], [0.0; 3])),
        mean_visible_share: table.mean_visible_share(),
    }
}

/// A number as the id of one of `n` things.
pub(crate) fn below(number: u32, n: usize, what: &str) -> Result<usize, Failure> {
    let idx = number as usize;
    if idx < n { Ok(idx) } else { Err(Failure::argument(format!("there is no {what} {number}: there are {n}"))) }
}

/// A number as a cell of a table.
pub(crate) fn cell_of(table: &Table, cell: u32) -> Result<CellId, Failure> {
    below(cell, table.n_cells(), "cell").map(|_| CellId(cell))
}

/// Stores what a table is about. O(cells).
///
/// @param info  Where it goes; its `struct_size` has to be set.
/// @return `SL_OK`, or `SL_ERROR_VERSION` if the size is not that of the library's structure.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_table_get_info(table: *const SlTable, info: *mut SlTableInfo) -> SlStatus {
    // SAFETY: pointers are as the header demands.
    guard(|| unsafe { border::put_sized(info, info_of(self::table(table)?), "the information") })
}

/// Stores a cell.
///
/// @param cell  Its number, below `cell_count`.
/// @param out   Where it goes.
/// @return `SL_OK`, or `SL_ERROR_ARGUMENT` if there is no such cell.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_table_cell(table: *const SlTable, cell: u32, out: *mut SlCell) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let table = unsafe { self::table(table)? };
        let record = &table.cells()[cell_of(table, cell)?.idx()];
        let bounds = box_of(record.min, record.max);
        let value =
            SlCell { bounds, group: record.group.unwrap_or(SL_NONE), corner_count: record.polygon.len() as u32 };
        // SAFETY: pointers are as the header demands.
        unsafe { border::put(out, value, "the place of the cell") }
    })
}

/// The corners of a cell in the plane, counter-clockwise, x and y of one after the other; none if the cell is its box.
///
/// @param cell      Its number, below `cell_count`.
/// @param corners   Where they go, or null to ask for their number.
/// @param capacity  Number of doubles that the buffer has room for; 0 if it is null.
/// @param count     Where the number of doubles goes: twice the number of corners.
/// @return `SL_OK`, `SL_ERROR_ARGUMENT` if there is no such cell, or `SL_ERROR_BUFFER`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_table_cell_corners(
    table: *const SlTable,
    cell: u32,
    corners: *mut f64,
    capacity: usize,
    count: *mut usize,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let table = unsafe { self::table(table)? };
        let polygon = &table.cells()[cell_of(table, cell)?.idx()].polygon;
        // SAFETY: pointers are as the header demands.
        unsafe { border::put_all(polygon.as_flattened(), corners, capacity, count) }
    })
}

/// The name of a cell, in UTF-8; empty if the cells have none. Names may repeat.
///
/// @param cell      Its number, below `cell_count`.
/// @param buffer    Where the name goes, with a zero byte behind it, or null to ask for its length.
/// @param capacity  Number of bytes that the buffer has room for, the zero byte included; 0 if it is null.
/// @param length    Where the length in bytes goes, without the zero byte.
/// @return `SL_OK`, `SL_ERROR_ARGUMENT` if there is no such cell, or `SL_ERROR_BUFFER`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_table_cell_name(
    table: *const SlTable,
    cell: u32,
    buffer: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let table = unsafe { self::table(table)? };
        let name = table.cell_name(cell_of(table, cell)?).unwrap_or("");
        // SAFETY: pointers are as the header demands.
        unsafe { border::put_text(name, buffer, capacity, length) }
    })
}

/// Stores an object.
///
/// @param object  Its number, below `object_count`.
/// @param out     Where it goes.
/// @return `SL_OK`, or `SL_ERROR_ARGUMENT` if there is no such object.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_table_object(table: *const SlTable, object: u32, out: *mut SlObject) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let table = unsafe { self::table(table)? };
        let record = &table.objects()[below(object, table.objects().len(), "object")?];
        let polygon_count = table.polygons_of(ObjectId(object));
        let value = SlObject { bounds: box_of(record.min, record.max), polygon_count };
        // SAFETY: pointers are as the header demands.
        unsafe { border::put(out, value, "the place of the object") }
    })
}

/// The name of an object, in UTF-8. Names may repeat, be empty, and contain zero bytes: the length counts.
///
/// @param object    Its number, below `object_count`.
/// @param buffer    Where the name goes, with a zero byte behind it, or null to ask for its length.
/// @param capacity  Number of bytes that the buffer has room for, the zero byte included; 0 if it is null.
/// @param length    Where the length in bytes goes, without the zero byte.
/// @return `SL_OK`, `SL_ERROR_ARGUMENT` if there is no such object, or `SL_ERROR_BUFFER`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_table_object_name(
    table: *const SlTable,
    object: u32,
    buffer: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let table = unsafe { self::table(table)? };
        let record = &table.objects()[below(object, table.objects().len(), "object")?];
        // SAFETY: pointers are as the header demands.
        unsafe { border::put_text(&record.name, buffer, capacity, length) }
    })
}

/// Finds the first object of a name. O(objects).
///
/// @param name    UTF-8, with a zero byte at its end.
/// @param object  Where its number goes.
/// @return `SL_OK`, or `SL_ERROR_NOT_FOUND`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_table_find_object(
    table: *const SlTable,
    name: *const c_char,
    object: *mut u32,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let (table, name) = unsafe { (self::table(table)?, border::text(name, "the name")?) };
        let found = table.objects().iter().position(|record| record.name == name);
        let found = found.ok_or_else(|| Failure::new(SL_ERROR_NOT_FOUND, format!("no object is called '{name}'")))?;
        // SAFETY: pointers are as the header demands.
        unsafe { border::put(object, found as u32, "the place of the object") }
    })
}

/// Stores a portal.
///
/// @param portal  Its number, below `portal_count`.
/// @param out     Where it goes.
/// @return `SL_OK`, or `SL_ERROR_ARGUMENT` if there is no such portal.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_table_portal(table: *const SlTable, portal: u32, out: *mut SlPortal) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let table = unsafe { self::table(table)? };
        let record = &table.portals()[below(portal, table.portals().len(), "portal")?];
        let value = SlPortal { cells: record.cells.map(|cell| cell.0), corner_count: record.points.len() as u32 };
        // SAFETY: pointers are as the header demands.
        unsafe { border::put(out, value, "the place of the portal") }
    })
}

/// The corners of a portal, x, y and z of one after the other. As seen going from its first cell to its second they are the left end
/// and the right end in a plane, and counter-clockwise in space.
///
/// @param portal    Its number, below `portal_count`.
/// @param corners   Where they go, or null to ask for their number.
/// @param capacity  Number of doubles that the buffer has room for; 0 if it is null.
/// @param count     Where the number of doubles goes: three times the number of corners.
/// @return `SL_OK`, `SL_ERROR_ARGUMENT` if there is no such portal, or `SL_ERROR_BUFFER`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_table_portal_corners(
    table: *const SlTable,
    portal: u32,
    corners: *mut f64,
    capacity: usize,
    count: *mut usize,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let table = unsafe { self::table(table)? };
        let record = &table.portals()[below(portal, table.portals().len(), "portal")?];
        // SAFETY: pointers are as the header demands.
        unsafe { border::put_all(record.points.as_flattened(), corners, capacity, count) }
    })
}
