//! Scenes written as GLB.

use crate::error::OutputError;
use crate::output;
use sightlines::cells::Scene;
use sightlines::formats::scene::SceneWriteError;
use sightlines::formats::scene::write_glb;
use std::path::{Path, PathBuf};

/// Why a scene was not written as GLB.
#[derive(Debug, thiserror::Error)]
pub(crate) enum GlbError {
    /// A result that cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The name of a GLB ends otherwise.
    #[error("{}: the scene is written as GLB; give a name that ends in .glb", path.display())]
    NotGlb { path: PathBuf },
    /// A scene cannot be written as GLB.
    #[error("{}: {source}", path.display())]
    Glb { path: PathBuf, source: SceneWriteError },
}

/// Writes a scene as GLB, and returns the number of bytes.
pub(crate) fn save_glb(path: &Path, scene: &Scene) -> Result<usize, GlbError> {
    let glb = write_glb(scene).map_err(|source| GlbError::Glb { path: path.to_owned(), source })?;
    output::save(path, &glb)?;
    Ok(glb.len())
}

/// Refuses a name that does not end in `.glb`.
pub(crate) fn check_name(path: &Path) -> Result<(), GlbError> {
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("glb")) {
        Ok(())
    } else {
        Err(GlbError::NotGlb { path: path.to_owned() })
    }
}
