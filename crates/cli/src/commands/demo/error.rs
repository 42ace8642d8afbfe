//! Why `demo` fails.

use crate::error::InputError;
use crate::error::OutputError;
use crate::glb::GlbError;
use crate::picture::PictureError;
use sightlines::bake::BakeError;
use sightlines::formats::ReadError;
use sightlines::scenes::SceneError;
use std::path::PathBuf;

/// Why `demo` fails; exit code 2.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    /// An input that is none.
    #[error(transparent)]
    Input(#[from] InputError),
    /// A WAD, a plan or a scene cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A result that cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A picture that cannot be drawn or written.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// A scene that cannot be written as GLB.
    #[error(transparent)]
    Glb(#[from] GlbError),
    /// A table that cannot be baked.
    #[error("{}: {source}", path.display())]
    Bake { path: PathBuf, source: Box<BakeError> },
    /// A scene cannot be generated.
    #[error(transparent)]
    Generate(#[from] SceneError),
}
