//! Errors of reading a file: its path, and what is wrong inside.

use crate::quake::{BspError, PrtError};
use crate::{DoomError, GeoJsonError, LevelsIndexError, SceneReadError, ViewCellsError, WadError};
use sightlines_pvs::DecodeError;
use std::io;
use std::path::{Path, PathBuf};

/// A file that could not be read, shown as `e1m1.wad: map MAP01: LINEDEFS 12: ...`.
#[derive(Debug, thiserror::Error)]
#[error("{}: {kind}", path.display())]
pub struct ReadError {
    /// The file, as the caller named it.
    pub path: PathBuf,
    /// What is wrong.
    #[source]
    pub kind: ReadErrorKind,
}

impl ReadError {
    /// Puts the file's name before what is wrong inside.
    pub fn new(path: impl AsRef<Path>, kind: impl Into<ReadErrorKind>) -> Self {
        Self { path: path.as_ref().to_owned(), kind: kind.into() }
    }
}

/// What is wrong with a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadErrorKind {
    /// The system could not read it.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// It is not a sound WAD.
    #[error(transparent)]
    Wad(#[from] WadError),
    /// A map in it cannot be used.
    #[error(transparent)]
    Doom(#[from] DoomError),
    /// It is not a GeoJSON plan.
    #[error(transparent)]
    GeoJson(Box<GeoJsonError>),
    /// It is not a scene in space.
    #[error(transparent)]
    Scene(Box<SceneReadError>),
    /// It has no view cells.
    #[error(transparent)]
    ViewCells(Box<ViewCellsError>),
    /// It is no index of levels.
    #[error(transparent)]
    Levels(#[from] LevelsIndexError),
    /// It is not a sound portal file of a Quake map.
    #[error(transparent)]
    Prt(#[from] PrtError),
    /// It is not a sound Quake map.
    #[error(transparent)]
    Bsp(#[from] BspError),
    /// It is not a sound table.
    #[error(transparent)]
    Table(#[from] DecodeError),
}

impl From<SceneReadError> for ReadErrorKind {
    fn from(error: SceneReadError) -> Self {
        Self::Scene(Box::new(error))
    }
}

impl From<ViewCellsError> for ReadErrorKind {
    fn from(error: ViewCellsError) -> Self {
        Self::ViewCells(Box::new(error))
    }
}

impl From<GeoJsonError> for ReadErrorKind {
    fn from(error: GeoJsonError) -> Self {
        Self::GeoJson(Box::new(error))
    }
}
