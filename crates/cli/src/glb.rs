//! Scenes written as GLB.

use crate::error::{ErrorAbout, Result};
use crate::output;
use sightlines::cells::Scene;
use sightlines::formats::scene::write_glb;
use std::path::Path;

pub(crate) fn save_glb(path: &Path, scene: &Scene) -> Result<usize> {
    let glb = write_glb(scene).in_file(path)?;
    output::save(path, &glb)?;
    Ok(glb.len())
}
