//! Why a world is not baked.

use crate::error::BakeError;
use sightlines_cells::SceneError;
use sightlines_formats::{ReadError, WriteError};
use sightlines_packed::PackedError;
use sightlines_progress::{Cancelled, Halt};
use sightlines_tiles::{TileFileError, WorldError};
use std::io;
use std::path::{Path, PathBuf};

/// Why a world is not baked.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WorldBakeError {
    /// A scene or its view cells cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Another file or folder cannot be read or made.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The error of the system.
        source: io::Error,
    },
    /// The plan is wrong.
    #[error("{}: {source}", path.display())]
    Plan {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: WorldError,
    },
    /// A simplified scene whose triangles were moved: it may hide what can be seen.
    #[error("{}: the triangles of the scene were moved when it was simplified, so it may hide what can be seen", .0.display())]
    Occluder(PathBuf),
    /// A scene cannot be where its plan has it.
    #[error("{}: moved to its place in the world: {source}", path.display())]
    Moved {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: SceneError,
    },
    /// Two scenes have other axes or units.
    #[error(
        "{}: up is {found}, and in {} it is {expected}: all scenes of a world have the same axes and units",
        path.display(), first.display()
    )]
    Axes {
        /// The file.
        path: PathBuf,
        /// Its axes and units.
        found: String,
        /// The first file.
        first: PathBuf,
        /// Its axes and units.
        expected: String,
    },
    /// A file is not what it was at first.
    #[error("{}: the file was changed while the world was baked; bake it again", .0.display())]
    Changed(PathBuf),
    /// A tile without room for an eye.
    #[error("{}: the tile {tile:?} has no cells: no eye can be in it; leave it out, or give it \"viewers\"", path.display())]
    NoCells {
        /// The file of its scene.
        path: PathBuf,
        /// Its name.
        tile: String,
    },
    /// A scene cannot be baked.
    #[error("{}: {source}", path.display())]
    Bake {
        /// The file.
        path: PathBuf,
        /// Why not.
        source: Box<BakeError>,
    },
    /// What was baked of a tile cannot be written.
    #[error("tile {name:?}: {source}")]
    Tile {
        /// Its name.
        name: String,
        /// Why not.
        source: TileFileError,
    },
    /// The table of a tile cannot be read again.
    #[error("{}: {source}", path.display())]
    Table {
        /// The file.
        path: PathBuf,
        /// Why not.
        source: PackedError,
    },
    /// The observer, or the store of units, ends the bake.
    #[error(transparent)]
    Halt(#[from] Halt),
}

impl From<Cancelled> for WorldBakeError {
    fn from(cancelled: Cancelled) -> Self {
        Self::Halt(cancelled.into())
    }
}

impl WorldBakeError {
    pub(super) fn scene(path: &Path, source: BakeError) -> Self {
        match source {
            BakeError::Cancelled(cancelled) => cancelled.into(),
            source => Self::Bake { path: path.to_owned(), source: Box::new(source) },
        }
    }
}
