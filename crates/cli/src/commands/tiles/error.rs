//! Why `tiles` fails.

use crate::buffers::MethodFailed;
use crate::file_error::{FileError, from_file_error};
use crate::kept::KeptError;
use crate::place::LookupError;
use sightlines::bake::BakeError;
use sightlines::cells::SceneError;
use sightlines::progress::{Cancelled, Halt};
use sightlines::tiles::{TileFileError, WorldError};
use std::path::PathBuf;

/// Why `tiles` fails; exit code 2.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    /// A file cannot be read, used or written.
    #[error(transparent)]
    File(FileError),
    /// A plan of a world, or a scene of it that cannot be used in it.
    #[error("{}: {source}", path.display())]
    World { path: PathBuf, source: WorldError },
    /// A baked world that cannot be used; it names the file.
    #[error(transparent)]
    Tables(WorldError),
    /// A scene that cannot be moved to its place.
    #[error("{}: moved to its place in the world: {source}", path.display())]
    Moved { path: PathBuf, source: SceneError },
    /// A tile that cannot be baked.
    #[error("{}: {source}", path.display())]
    Bake { path: PathBuf, source: BakeError },
    /// A from-region method cannot be prepared.
    #[error(transparent)]
    Method(#[from] MethodFailed),
    /// A tile without cells.
    #[error("{}: the tile {tile:?} has no cells: no eye can be in it; leave it out, or give it \"viewers\"", path.display())]
    NoCells { path: PathBuf, tile: String },
    /// Two scenes with other axes or units.
    #[error("{}: up is {found}, and in {} it is {expected}: all scenes of a world have the same axes and units", path.display(), first.display())]
    Axes { path: PathBuf, first: PathBuf, found: String, expected: String },
    /// A file that was changed while tiles were baked from it.
    #[error("{}: the file was changed while the world was baked; bake it again", .0.display())]
    Changed(PathBuf),
    /// A tile that cannot be written: our bug, or more than 2³² of something.
    #[error("tile {tile:?}: {source}")]
    Write { tile: String, source: TileFileError },
    /// An option that the plan of a world takes the place of.
    #[error("{}: --cells is not for worlds: their plan names the cells of each tile", .0.display())]
    Cells(PathBuf),
    /// A point that is not one in space.
    #[error(transparent)]
    Lookup(#[from] LookupError),
    /// Results cannot be kept, or taken up.
    #[error(transparent)]
    Kept(#[from] KeptError),
    /// The store of results ends the bake.
    #[error(transparent)]
    Halted(#[from] Halt),
    /// The program was interrupted.
    #[error("{}; the same command goes on from the {n_done} of {n} tiles that are done", why.as_ref().map_or_else(|| "interrupted".to_owned(), |why| format!("stopped: {why}")))]
    Interrupted { why: Option<String>, n_done: usize, n: usize },
}

from_file_error!(Error);

impl From<Cancelled> for Error {
    fn from(cancelled: Cancelled) -> Self {
        Self::Halted(Halt::Cancelled(cancelled))
    }
}
