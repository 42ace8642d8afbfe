//! Tables: from bytes and files, and back.

use crate::border;
use crate::handle::{self, Handle};
#[cfg(not(feature = "packed"))]
use crate::status::SL_ERROR_UNSUPPORTED;
use crate::status::{Failure, Outcome, SL_ERROR_FILE, SL_ERROR_FORMAT, SlStatus, guard};
use sightlines_eye_to_cell::TableCells;
use sightlines_pvs::Table;
use std::ffi::c_char;
use std::sync::Arc;

/// A visibility table: which cells and objects of a scene can be seen from which cells. It never changes, and any number of threads may
/// read it at once.
pub struct SlTable {
    _opaque: [u8; 0],
}

/// A table with its portals sorted by cell; shared with viewers, which may outlive the handle.
pub(crate) type Shared = Arc<TableCells<Arc<Table>>>;

impl Handle for SlTable {
    type State = Shared;
    const TAG: u64 = 0x51_6874_7461_626c;
    const NAME: &'static str = "table";
}

/// A new handle of a table.
pub(crate) fn give(table: Table) -> *mut SlTable {
    handle::give::<SlTable>(Arc::new(TableCells::new(Arc::new(table))))
}

/// The table behind a handle.
///
/// # Safety
/// As for [`handle::behind`].
pub(crate) unsafe fn table<'a>(handle: *const SlTable) -> Result<&'a Table, Failure> {
    // SAFETY: as for this function.
    Ok(unsafe { handle::behind(handle)? }.table())
}

/// The plain form of a table, as in files that end in `.pvs`.
pub const SL_FORM_PLAIN: u32 = 0;
/// The packed form, as in files that end in `.pvz`: a fraction of the size.
pub const SL_FORM_PACKED: u32 = 1;

/// Bytes of blocks that are kept while a table is unpacked: each is read many times in a row.
#[cfg(feature = "packed")]
const UNPACK_CACHE: usize = 64 << 20;

fn decode(bytes: Vec<u8>) -> Result<Table, Failure> {
    let failed = |error: &dyn std::fmt::Display| Failure::new(SL_ERROR_FORMAT, error.to_string());
    #[cfg(feature = "packed")]
    if bytes.starts_with(&sightlines_packed::format::MAGIC) {
        let packed = sightlines_packed::Packed::open(bytes, UNPACK_CACHE).map_err(|error| failed(&error))?;
        return packed.to_table().map_err(|error| failed(&error));
    }
    Table::from_bytes(&bytes).map_err(|error| failed(&error))
}

fn encode(table: &Table, form: u32) -> Result<Vec<u8>, Failure> {
    match form {
        SL_FORM_PLAIN => Ok(table.to_bytes()),
        #[cfg(feature = "packed")]
        SL_FORM_PACKED => sightlines_packed::pack(table, &sightlines_packed::PackOptions::default())
            .map_err(|error| Failure::argument(error.to_string())),
        #[cfg(not(feature = "packed"))]
        SL_FORM_PACKED => Err(Failure::new(SL_ERROR_UNSUPPORTED, "the library was built without packed tables")),
        _ => Err(Failure::argument(format!("{form} is no form of a table"))),
    }
}

fn open(path: &str) -> Result<Table, Failure> {
    let bytes = std::fs::read(path).map_err(|error| Failure::new(SL_ERROR_FILE, format!("{path}: {error}")))?;
    decode(bytes).map_err(|failure| Failure { message: format!("{path}: {}", failure.message), ..failure })
}

/// Loads a table from a file, plain or packed. The file is read whole.
///
/// @param path   UTF-8, with a zero byte at its end.
/// @param table  Where the handle goes; free it with `sl_table_free`. Null is stored there if the call fails.
/// @return `SL_OK`, `SL_ERROR_FILE`, or `SL_ERROR_FORMAT` for a file that is no table or damaged in any byte.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_table_load(path: *const c_char, table: *mut *mut SlTable) -> SlStatus {
    // SAFETY: pointers are as the header demands.
    guard(|| unsafe { new_table(table, || open(border::text(path, "the path")?)) })
}

/// Reads a table from memory, plain or packed. The bytes are copied and not needed afterwards.
///
/// @param bytes  The content of a file.
/// @param size   Number of bytes.
/// @param table  Where the handle goes; free it with `sl_table_free`. Null is stored there if the call fails.
/// @return `SL_OK`, or `SL_ERROR_FORMAT` for what is no table or damaged in any byte.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_table_from_bytes(bytes: *const u8, size: usize, table: *mut *mut SlTable) -> SlStatus {
    // SAFETY: pointers are as the header demands.
    guard(|| unsafe { new_table(table, || decode(border::slice(bytes, size, "the place of the bytes")?.to_vec())) })
}

/// Makes a table and stores its handle, or null.
///
/// # Safety
/// As for the module `border`.
pub(crate) unsafe fn new_table(to: *mut *mut SlTable, make: impl FnOnce() -> Result<Table, Failure>) -> Outcome {
    // SAFETY: as for this function.
    unsafe { border::put(to, std::ptr::null_mut(), "the place of the table")? };
    let table = give(make()?);
    // SAFETY: as for this function.
    unsafe { border::put(to, table, "the place of the table") }
}

/// Frees a table. Viewers made of it go on working.
///
/// @param table  A table that no other thread is using, or null, for which nothing is done.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_table_free(table: *mut SlTable) {
    // SAFETY: pointers are as the header demands.
    guard(|| unsafe { handle::free(table) });
}

/// The bytes of a table, as in a file. The same table has the same bytes on every machine.
///
/// The table is encoded in every call: ask for the size with a null buffer once, and pass a buffer of that size. O(size).
///
/// @param form      `SL_FORM_PLAIN` or `SL_FORM_PACKED`.
/// @param buffer    Where the bytes go, or null to ask for the size.
/// @param capacity  Number of bytes that the buffer has room for; 0 if it is null.
/// @param size      Where the number of bytes goes.
/// @return `SL_OK`, `SL_ERROR_BUFFER` if the buffer is too small, or `SL_ERROR_UNSUPPORTED` for a library without packed tables.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_table_bytes(
    table: *const SlTable,
    form: u32,
    buffer: *mut u8,
    capacity: usize,
    size: *mut usize,
) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let bytes = encode(unsafe { self::table(table)? }, form)?;
        // SAFETY: pointers are as the header demands.
        unsafe { border::put_all(&bytes, buffer, capacity, size) }
    })
}

/// Writes a table to a file, which is replaced. Written to another file beside it first, so that what was there stays whole if writing
/// fails.
///
/// @param path  UTF-8, with a zero byte at its end.
/// @param form  `SL_FORM_PLAIN` or `SL_FORM_PACKED`.
/// @return `SL_OK`, or `SL_ERROR_FILE`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sl_table_save(table: *const SlTable, path: *const c_char, form: u32) -> SlStatus {
    guard(|| {
        // SAFETY: pointers are as the header demands.
        let (table, path) = unsafe { (self::table(table)?, border::text(path, "the path")?) };
        let bytes = encode(table, form)?;
        let failed = |error: std::io::Error| Failure::new(SL_ERROR_FILE, format!("{path}: {error}"));
        let beside = format!("{path}.{}.part", std::process::id());
        std::fs::write(&beside, bytes).and_then(|()| std::fs::rename(&beside, path)).map_err(|error| {
            // What was begun is of no use; that it cannot be removed either is not the caller's question.
            let _ = std::fs::remove_file(&beside);
            failed(error)
        })
    })
}
