//! What a table answers: cells at a point, what a cell sees, what is seen from a point.

use crate::border;
use crate::info::cell_of;
use crate::status::{Failure, Outcome, SL_NONE, SlStatus, guard};
use crate::table::{SlTable, table};
use sightlines_pvs::{CellId, ObjectId, Place, Table, TriangleRange};
use std::ops::Range;

/// The cells that contain a point, ascending: several on borders, none outside of all cells.
///
/// Where there is none, nothing is known: draw everything. So it is for a point with a coordinate that is no finite number, and
/// for tables without places. Errs towards inside, by rounding only.
///
/// @param point     Three numbers: x, y and z, in scene units; in a table of the plane z does not count.
/// @param cells     Where the numbers of the cells go, or null to ask for how many there are.
/// @param capacity  Number of cells that the buffer has room for; 0 if it is null.
/// @param count     Where their number goes.
/// @return `SL_OK`, also where there is none, or `SL_ERROR_BUFFER`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_table_cells_at(
    table: *const SlTable,
    point: *const f64,
    cells: *mut u32,
    capacity: usize,
    count: *mut usize,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let (table, point) = unsafe { (self::table(table)?, point_of(point)?) };
        let place = table.place_at(point);
        // SAFETY: pointers are as the header demands.
        unsafe { put_ids(place.cells().iter().map(|cell| cell.0), place.cells().len(), cells, capacity, count) }
    })
}

/// The three coordinates of a point.
///
/// # Safety
/// As for the module `border`.
unsafe fn point_of(point: *const f64) -> Result<[f64; 3], Failure> {
    // SAFETY: as for this function; an array has the alignment of what is in it.
    unsafe { border::read(point.cast::<[f64; 3]>(), "the point") }.copied()
}

/// Stores numbers.
///
/// # Safety
/// As for the module `border`.
pub(crate) unsafe fn put_ids(
    ids: impl Iterator<Item = u32>,
    n: usize,
    to: *mut u32,
    capacity: usize,
    count: *mut usize,
) -> Outcome {
    // SAFETY: as for this function.
    unsafe { border::put_each(n, ids, to, capacity, count) }
}

/// Whether something in one cell may be seen from somewhere in another. Symmetric. O(1).
///
/// @param a     The number of one cell, below `cell_count`.
/// @param b     That of the other.
/// @param sees  Where 1 or 0 goes.
/// @return `SL_OK`, or `SL_ERROR_ARGUMENT` if there is no such cell.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_table_sees(table: *const SlTable, a: u32, b: u32, sees: *mut u32) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let table = unsafe { self::table(table)? };
        let answer = table.sees(cell_of(table, a)?, cell_of(table, b)?);
        // SAFETY: pointers are as the header demands.
        unsafe { border::put(sees, answer.into(), "the place of the answer") }
    })
}

/// The cells that a cell may see, itself included, ascending.
///
/// @param cell      Its number, below `cell_count`.
/// @param cells     Where their numbers go, or null to ask for how many there are.
/// @param capacity  Number of cells that the buffer has room for; 0 if it is null.
/// @param count     Where their number goes.
/// @return `SL_OK`, `SL_ERROR_ARGUMENT` if there is no such cell, or `SL_ERROR_BUFFER`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_table_visible_cells(
    table: *const SlTable,
    cell: u32,
    cells: *mut u32,
    capacity: usize,
    count: *mut usize,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let table = unsafe { self::table(table)? };
        let cell = cell_of(table, cell)?;
        let n = table.row(cell).iter().map(|word| word.count_ones() as usize).sum();
        // SAFETY: pointers are as the header demands.
        unsafe { put_ids(table.visible(cell).map(|other| other.0), n, cells, capacity, count) }
    })
}

/// The row of a cell, in place: bit `j % 64` of word `j / 64` is set if the cell may see cell `j`. Nothing is copied. O(1).
///
/// @param cell   Its number, below `cell_count`.
/// @param words  Where a pointer to the words goes. They must not be changed, and are valid until the table is freed, the
///               viewers made of it do not count.
/// @param count  Where the number of words goes.
/// @return `SL_OK`, or `SL_ERROR_ARGUMENT` if there is no such cell.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_table_row(
    table: *const SlTable,
    cell: u32,
    words: *mut *const u64,
    count: *mut usize,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let table = unsafe { self::table(table)? };
        let row = table.row(cell_of(table, cell)?);
        border::place(count, "the place of the count")?;
        // SAFETY: pointers are as the header demands.
        unsafe {
            border::put(words, row.as_ptr(), "the place of the words")?;
            border::put(count, row.len(), "the place of the count")
        }
    })
}

/// The objects that touch a cell, ascending.
///
/// @param cell      Its number, below `cell_count`.
/// @param objects   Where their numbers go, or null to ask for how many there are.
/// @param capacity  Number of objects that the buffer has room for; 0 if it is null.
/// @param count     Where their number goes.
/// @return `SL_OK`, `SL_ERROR_ARGUMENT` if there is no such cell, or `SL_ERROR_BUFFER`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_table_objects_in_cell(
    table: *const SlTable,
    cell: u32,
    objects: *mut u32,
    capacity: usize,
    count: *mut usize,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let table = unsafe { self::table(table)? };
        let found = table.objects_of(cell_of(table, cell)?);
        // SAFETY: pointers are as the header demands.
        unsafe { put_ids(found.iter().map(|object| object.0), found.len(), objects, capacity, count) }
    })
}

/// The objects that a cell may see, ascending.
///
/// @param cell      Its number, below `cell_count`.
/// @param objects   Where their numbers go, or null to ask for how many there are.
/// @param capacity  Number of objects that the buffer has room for; 0 if it is null.
/// @param count     Where their number goes.
/// @return `SL_OK`, `SL_ERROR_ARGUMENT` if there is no such cell, or `SL_ERROR_BUFFER`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_table_visible_objects(
    table: *const SlTable,
    cell: u32,
    objects: *mut u32,
    capacity: usize,
    count: *mut usize,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let table = unsafe { self::table(table)? };
        let found = table.visible_objects(cell_of(table, cell)?);
        // SAFETY: pointers are as the header demands.
        unsafe { put_ids(found.iter().map(|object| object.0), found.len(), objects, capacity, count) }
    })
}

/// Triangles of an object that follow each other in its file. Those of a primitive that is a list of triangles are drawn by an offset of three times
/// `start` indices and a count of three times the difference.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct SlRange {
    /// The object.
    pub object: u32,
    /// The first triangle.
    pub start: u32,
    /// The one behind the last triangle; `SL_NONE` for all, as of objects that were not cut into parts.
    pub end: u32,
}

/// What a cell may see, by ascending object: of objects that were cut into parts the ranges of triangles, and all of the others.
///
/// @param cell      Its number, below `cell_count`.
/// @param ranges    Where the ranges go, or null to ask for how many there are.
/// @param capacity  Number of ranges that the buffer has room for; 0 if it is null.
/// @param count     Where their number goes.
/// @return `SL_OK`, `SL_ERROR_ARGUMENT` if there is no such cell, or `SL_ERROR_BUFFER`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_table_visible_ranges(
    table: *const SlTable,
    cell: u32,
    ranges: *mut SlRange,
    capacity: usize,
    count: *mut usize,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let table = unsafe { self::table(table)? };
        let found = table.visible_ranges(cell_of(table, cell)?);
        // SAFETY: pointers are as the header demands.
        unsafe { border::put_each(found.len(), found.into_iter().map(range_of), ranges, capacity, count) }
    })
}

fn range_of((object, range): TriangleRange) -> SlRange {
    let Range { start, end } = range.unwrap_or(0..SL_NONE);
    SlRange { object: object.0, start, end }
}

/// The objects that a cell may see, as bits: bit `j % 64` of word `j / 64` is set for object `j`.
///
/// @param cell      Its number, below `cell_count`.
/// @param words     Where the words go, or null to ask for how many there are.
/// @param capacity  Number of words that the buffer has room for; 0 if it is null.
/// @param count     Where their number goes: the number of objects divided by 64, rounded up.
/// @return `SL_OK`, `SL_ERROR_ARGUMENT` if there is no such cell, or `SL_ERROR_BUFFER`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_table_visible_object_bits(
    table: *const SlTable,
    cell: u32,
    words: *mut u64,
    capacity: usize,
    count: *mut usize,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let table = unsafe { self::table(table)? };
        let bits = object_bits(table, &table.visible_objects(cell_of(table, cell)?));
        // SAFETY: pointers are as the header demands.
        unsafe { border::put_all(&bits, words, capacity, count) }
    })
}

fn object_bits(table: &Table, objects: &[ObjectId]) -> Vec<u64> {
    let mut bits = vec![0u64; table.objects().len().div_ceil(64)];
    objects.iter().for_each(|object| bits[object.idx() / 64] |= 1 << (object.0 % 64));
    bits
}

/// The cells that may be seen from a point, ascending. Outside of every cell nothing is known, and these are all cells.
///
/// @param point       Three numbers: x, y and z, in scene units; in a table of the plane z does not count.
/// @param cells       Where their numbers go, or null to ask for how many there are.
/// @param capacity    Number of cells that the buffer has room for; 0 if it is null.
/// @param count       Where their number goes.
/// @param is_outside  Where 1 goes if the point is in no cell, else 0; may be null.
/// @return `SL_OK`, or `SL_ERROR_BUFFER`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_table_visible_cells_at(
    table: *const SlTable,
    point: *const f64,
    cells: *mut u32,
    capacity: usize,
    count: *mut usize,
    is_outside: *mut u32,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let (table, point) = unsafe { (self::table(table)?, point_of(point)?) };
        let (found, outside): (Vec<CellId>, bool) = match table.place_at(point) {
            Place::Inside(here) => (here.visible_cells().collect(), false),
            Place::Outside => ((0..table.n_cells() as u32).map(CellId).collect(), true),
        };
        // SAFETY: pointers are as the header demands.
        unsafe {
            put_outside(is_outside, outside)?;
            put_ids(found.iter().map(|cell| cell.0), found.len(), cells, capacity, count)
        }
    })
}

/// The objects that may be seen from a point, ascending: what to draw there. Outside of every cell nothing is known, and these are all
/// objects.
///
/// @param point       Three numbers: x, y and z, in scene units; in a table of the plane z does not count.
/// @param objects     Where their numbers go, or null to ask for how many there are.
/// @param capacity    Number of objects that the buffer has room for; 0 if it is null.
/// @param count       Where their number goes.
/// @param is_outside  Where 1 goes if the point is in no cell, else 0; may be null.
/// @return `SL_OK`, or `SL_ERROR_BUFFER`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_table_visible_objects_at(
    table: *const SlTable,
    point: *const f64,
    objects: *mut u32,
    capacity: usize,
    count: *mut usize,
    is_outside: *mut u32,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let (table, point) = unsafe { (self::table(table)?, point_of(point)?) };
        let (found, outside): (Vec<ObjectId>, bool) = match table.place_at(point) {
            Place::Inside(here) => (here.visible_objects(), false),
            Place::Outside => ((0..table.objects().len() as u32).map(ObjectId).collect(), true),
        };
        // SAFETY: pointers are as the header demands.
        unsafe {
            put_outside(is_outside, outside)?;
            put_ids(found.iter().map(|object| object.0), found.len(), objects, capacity, count)
        }
    })
}

/// Stores whether a point is outside, where that is asked.
///
/// # Safety
/// As for the module `border`.
unsafe fn put_outside(to: *mut u32, outside: bool) -> Result<(), Failure> {
    // SAFETY: as for this function.
    if to.is_null() { Ok(()) } else { unsafe { border::put(to, outside.into(), "the place of the answer") } }
}

/// The cells that a box touches, ascending; none outside of all cells. For placing what moves: it may be seen from where any of
/// these cells may be seen.
///
/// @param bounds    The box, in scene units; in a table of the plane z does not count. No coordinate may be NaN.
/// @param cells     Where the numbers of the cells go, or null to ask for how many there are.
/// @param capacity  Number of cells that the buffer has room for; 0 if it is null.
/// @param count     Where their number goes.
/// @return `SL_OK`, `SL_ERROR_ARGUMENT` for a NaN or a table without places, or `SL_ERROR_BUFFER`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_table_cells_touching(
    table: *const SlTable,
    bounds: *const crate::info::SlBox,
    cells: *mut u32,
    capacity: usize,
    count: *mut usize,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let (table, bounds) = unsafe { (self::table(table)?, *border::read(bounds, "the box")?) };
        let (mut min, mut max) = (bounds.min, bounds.max);
        if table.dimension() == 2 {
            (min[2], max[2]) = (0.0, 0.0);
        }
        if min.iter().chain(&max).any(|x| x.is_nan()) {
            return Err(Failure::argument("the box has a coordinate that is no number"));
        }
        if !table.has_places() {
            return Err(Failure::argument("the table does not know where its cells are"));
        }
        let mut found = Vec::new();
        table.for_each_touching(min, max, &mut Vec::new(), |cell| {
            found.push(cell);
            true
        });
        found.sort_unstable();
        found.dedup();
        // SAFETY: pointers are as the header demands.
        unsafe { put_ids(found.iter().map(|cell| cell.0), found.len(), cells, capacity, count) }
    })
}

/// What may be seen from a point, by ascending object, as for `sl_table_visible_ranges`: what to draw there. Outside of every cell nothing is known,
/// and it is all of every object.
///
/// @param point       Three numbers: x, y and z, in scene units; in a table of the plane z does not count.
/// @param ranges      Where the ranges go, or null to ask for how many there are.
/// @param capacity    Number of ranges that the buffer has room for; 0 if it is null.
/// @param count       Where their number goes.
/// @param is_outside  Where 1 goes if the point is in no cell, else 0; may be null.
/// @return `SL_OK`, or `SL_ERROR_BUFFER`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_table_visible_ranges_at(
    table: *const SlTable,
    point: *const f64,
    ranges: *mut SlRange,
    capacity: usize,
    count: *mut usize,
    is_outside: *mut u32,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let (table, point) = unsafe { (self::table(table)?, point_of(point)?) };
        let (found, outside) = match table.place_at(point) {
            Place::Inside(here) => (here.visible_ranges(), false),
            Place::Outside => ((0..table.objects().len() as u32).map(|o| (ObjectId(o), None)).collect(), true),
        };
        // SAFETY: pointers are as the header demands.
        unsafe {
            put_outside(is_outside, outside)?;
            border::put_each(found.len(), found.into_iter().map(range_of), ranges, capacity, count)
        }
    })
}
