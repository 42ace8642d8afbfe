//! Why `vga` fails.

use crate::file_error::{FileError, from_file_error};
use crate::kept::{Interrupted, KeptError};
use crate::memory::TooLarge;
use crate::place::LookupError;
use sightlines::isovist::{EyeError, MeshError};
use sightlines::visibility_graph::{GraphError, GridError, PointsError};
use std::path::PathBuf;

/// Why `vga` fails; exit code 2.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    /// A file cannot be read, used or written.
    #[error(transparent)]
    File(FileError),
    /// A seed with three coordinates.
    #[error("--seed: {0}")]
    Seed(LookupError),
    /// No grid or no points on it.
    #[error("{}: {source}", path.display())]
    Grid { path: PathBuf, source: GridError },
    /// Walls in which nothing can be looked for.
    #[error("{}: {source}", path.display())]
    Mesh { path: PathBuf, source: MeshError },
    /// A point that cannot be used.
    #[error("{}: {source}", path.display())]
    Points { path: PathBuf, source: PointsError },
    /// A point where nothing can be looked for.
    #[error("{}: {source}", path.display())]
    Eye { path: PathBuf, source: EyeError },
    /// The graph cannot be built.
    #[error("{}: {source}", path.display())]
    Graph { path: PathBuf, source: GraphError },
    /// Results cannot be kept, or taken up.
    #[error(transparent)]
    Kept(#[from] KeptError),
    /// The program was interrupted.
    #[error("{0}")]
    Interrupted(Interrupted),
    /// There is no room for it in the memory that may be used.
    #[error("{}: {source}; allow more, or take fewer points", path.display())]
    Memory { path: PathBuf, source: TooLarge },
    /// An output of no known kind.
    #[error("{}: the name of the output ends in .csv, .geojson, .svg or .png", .0.display())]
    Kind(PathBuf),
    /// A picture of points that has no spacing.
    #[error("{}: a picture of points needs --spacing, the side of the square around each", .0.display())]
    Side(PathBuf),
    /// `--measure` for what is no picture.
    #[error("{}: --measure is for pictures, and this is a table of all --measures", .0.display())]
    Measure(PathBuf),
}

from_file_error!(Error);
