//! Maps of the Quake family: portal files (`.prt`) and maps (`.bsp`), as far as visibility needs them.
//!
//! | | read | refused by name |
//! | --- | --- | --- |
//! | portals ([`prt`]) | `PRT1`, `PRT2`, `PRT1-AM`, those of Half-Life and of Quake III | anything else |
//! | maps ([`bsp`]) | Quake's version 29, `BSP2`, `2PSB`, Half-Life's version 30, Hexen II's 29, Quake II's `IBSP` 38, Qbism's `QBSP` 38, `IBSP` 46 and 47 of Quake III and Wolfenstein | other versions, Blue Shift, Quake Live |
//!
//! Words of these files: a *leaf* is a cell of the map's tree; a *cluster* is one leaf, or several that share a
//! visibility row. Portal files count leafs from 0, maps from 1, because leaf 0 of a map is solid. Visibility is stored
//! for clusters here ([`LeafClusters`] maps between the two), and [`visibility`] and [`rle`] write it in the form that
//! engines load.

pub mod bsp;
mod leafs;
pub mod overrides;
pub mod prt;
pub mod rle;
pub mod vis_patch;
pub mod visibility;

pub use bsp::{Bsp, BspFormat};
pub use leafs::LeafClusters;
pub use prt::{Prt, graph_of_prt};
pub use visibility::{VisibilityError, VisibilityLump};

use crate::ReadError;
use crate::error::in_file;
use std::path::{Path, PathBuf};

/// The most clusters that are read: their table takes 512 MiB. Engines hold as many leafs.
pub const MAX_CLUSTERS: u32 = 1 << 16;

/// Where compilers write the portals of a map: beside it, under its name.
pub fn portals_beside(map: impl AsRef<Path>) -> PathBuf {
    map.as_ref().with_extension("prt")
}

/// Reads a portal file.
///
/// # Errors
/// [`ReadError`] with the file's name, and line and column in it.
pub fn read_prt(path: impl AsRef<Path>) -> Result<Prt, ReadError> {
    let path = path.as_ref();
    in_file(path, || Ok(prt::parse_prt(&std::fs::read(path)?)?))
}

/// Reads a map.
///
/// # Errors
/// [`ReadError`] with the file's name, and the place in it.
pub fn read_bsp(path: impl AsRef<Path>) -> Result<Bsp, ReadError> {
    let path = path.as_ref();
    in_file(path, || Ok(Bsp::parse(std::fs::read(path)?)?))
}
