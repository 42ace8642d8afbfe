#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: the WAD container ([`wad`]), the maps inside ([`doom`]), their REJECT lumps ([`reject`]),
//!   plans ([`plan`]) as GeoJSON ([`geojson`]) and DXF ([`dxf`]), scenes in space ([`scene`]) and simplified levels of them
//!   ([`levels`]), view cells ([`view_cells`]), points ([`points`]), maps of the Quake family and their visibility
//!   ([`quake`]), files that are replaced as a whole ([`files::atomic_write`]), and folders ([`NewFolder`]), the list of all formats and how they are recognised
//!   ([`input`]), and errors that name the file and the place in it ([`ReadError`]).
//! - **Out of scope**: how a plan is cut into cells, what a sight line is, how a REJECT table is computed.
//! - **Invariants**: no input causes a panic; memory stays within a small multiple of the input's size
//!   (of a scene in space: with its meshes as often as it shows them, up to a limit; of a
//!   drawing: with its blocks as often as they are inserted, up to a limit), whatever counts
//!   the input claims; what is not understood is either passed through byte for byte
//!   or refused, never guessed; the same value is always written as the same bytes.

mod beside;
mod bytes;
mod cursor;
mod debris;
pub mod doom;
pub mod dxf;
pub mod error;
pub mod files;
mod folder;
pub mod geojson;
pub mod input;
mod json;
pub mod levels;
pub mod plan;
mod point;
pub mod points;
pub mod quake;
pub mod reject;
pub mod scene;
pub mod view_cells;
pub mod wad;

pub use debris::{Hidden, process_mark, remove_left};
pub use doom::{DoomMap, MapLumps};
pub use error::{Malformed, ReadError, ReadErrorKind};
pub use files::{WriteError, atomic_write};
pub use folder::{FolderError, NewFolder};
pub use input::{Input, InputKind, Source, detect_file};
pub use levels::{LevelFile, LevelsIndex};
pub use plan::{DroppedLines, PlanFile, PlanReadOptions};
pub use quake::{Bsp, Prt};
pub use reject::RejectTable;
pub use scene::{GltfSource, SceneFile, SceneInfo, Simplification};
pub use view_cells::{ViewCell, ViewCells};
pub use wad::{LumpName, Wad, WadBuilder, WadError};
