//! Why `demo` fails.

use crate::file_error::{FileError, from_file_error};
use crate::glb::GlbError;
use sightlines::bake::BakeError;
use sightlines::scenes::SceneError;
use sightlines::viewer::PageError;
use std::path::PathBuf;

/// Why `demo` fails; exit code 2.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    /// A file cannot be read, used or written.
    #[error(transparent)]
    File(FileError),
    /// A scene that cannot be written as GLB.
    #[error(transparent)]
    Glb(#[from] GlbError),
    /// A table that cannot be baked.
    #[error("{}: {source}", path.display())]
    Bake { path: PathBuf, source: Box<BakeError> },
    /// A page of a table that cannot be made.
    #[error("{}: {source}", path.display())]
    Page { path: PathBuf, source: PageError },
    /// A scene cannot be generated.
    #[error(transparent)]
    Generate(#[from] SceneError),
}

from_file_error!(Error);
