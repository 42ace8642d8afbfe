//! The bytes of the files of a tile.

use crate::world::TiledWorld;
use sightlines_packed::across::{AcrossColumns, AcrossError, NearColumns, write_across};
use sightlines_packed::{PackError, PackOptions, pack};
use sightlines_pvs::{Table, TableError};
use std::ops::Range;

/// Why a tile cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TileFileError {
    /// The table cannot be packed.
    #[error(transparent)]
    Pack(#[from] PackError),
    /// The table does not take the key of its tile.
    #[error(transparent)]
    Table(#[from] TableError),
    /// What is seen of others cannot be written.
    #[error(transparent)]
    Across(#[from] AcrossError),
}

/// The table of a tile, packed; its information states the key.
///
/// # Errors
/// [`TileFileError`]
pub fn table_bytes(table: Table, key: [u8; 16]) -> Result<Vec<u8>, TileFileError> {
    let mut parts = table.into_parts();
    parts.info.push(TiledWorld::stated(key));
    parts.info.sort();
    Ok(pack(&Table::new(parts)?, &PackOptions::default())?)
}

/// What the cells of a tile see nearby.
///
/// * `near`: names of tiles, each with the numbers of its cells and of its objects
/// * `rows`: for each cell runs of columns: the cells of the first tile, its objects, the cells of the second, and so on
///
/// # Errors
/// [`TileFileError::Across`]
pub fn near_bytes(
    key: [u8; 16],
    near: impl IntoIterator<Item = (String, [u32; 2])>,
    rows: &[Vec<Range<u32>>],
) -> Result<Vec<u8>, TileFileError> {
    let near = near.into_iter().map(|(name, [n_cells, n_objects])| NearColumns { name, n_cells, n_objects }).collect();
    across(&AcrossColumns { key, near, far: Vec::new() }, rows)
}

/// Of which tiles farther away the cells of a tile see anything.
///
/// * `far`: names of tiles
/// * `rows`: for each cell runs of these
///
/// # Errors
/// [`TileFileError::Across`]
pub fn far_bytes(key: [u8; 16], far: Vec<String>, rows: &[Vec<Range<u32>>]) -> Result<Vec<u8>, TileFileError> {
    across(&AcrossColumns { key, near: Vec::new(), far }, rows)
}

fn across(columns: &AcrossColumns, rows: &[Vec<Range<u32>>]) -> Result<Vec<u8>, TileFileError> {
    let mut bytes = Vec::new();
    write_across(&mut bytes, columns, rows)?;
    Ok(bytes)
}
