//! Scenes written as GLB.

use crate::error::{ErrorAbout, Result, bail};
use crate::output;
use sightlines::cells::Scene;
use sightlines::formats::scene::write_glb;
use std::path::Path;

/// Writes a scene as GLB, and returns the number of bytes.
pub(crate) fn save_glb(path: &Path, scene: &Scene) -> Result<usize> {
    let glb = write_glb(scene).in_file(path)?;
    output::save(path, &glb)?;
    Ok(glb.len())
}

/// Refuses a name that does not end in `.glb`.
pub(crate) fn check_name(path: &Path) -> Result<()> {
    if !path.extension().is_some_and(|e| e.eq_ignore_ascii_case("glb")) {
        bail!("{}: the scene is written as GLB; give a name that ends in .glb", path.display());
    }
    Ok(())
}
