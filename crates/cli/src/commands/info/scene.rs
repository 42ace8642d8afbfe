//! What a scene in space holds.

use super::Error;
use crate::facts::Stated;
use serde::Serialize;
use sightlines::formats::scene::read_scene;
use std::fmt;
use std::path::Path;

/// The numbers of a scene.
#[derive(Debug, Serialize)]
pub(super) struct SceneInfo {
    file: String,
    kind: &'static str,
    #[serde(flatten)]
    stated: Stated,
    n_objects: usize,
    n_objects_without_triangles: usize,
    n_triangles: usize,
    /// Left out when the file was read.
    n_degenerate_triangles: usize,
    min: [f64; 3],
    max: [f64; 3],
}

impl SceneInfo {
    pub(super) fn read(path: &Path) -> Result<Self, Error> {
        let file = read_scene(path)?;
        let bounds = file.scene.bounds();
        Ok(Self {
            file: path.display().to_string(),
            kind: "scene",
            stated: Stated::new(&file.info),
            n_objects: file.info.n_objects,
            n_objects_without_triangles: file.info.n_objects_without_triangles,
            n_triangles: file.info.n_triangles,
            n_degenerate_triangles: file.info.n_degenerate_triangles,
            min: bounds.min,
            max: bounds.max,
        })
    }
}

impl fmt::Display for SceneInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}: scene in space, {}", self.file, self.stated)?;
        let empty = match self.n_objects_without_triangles {
            0 => String::new(),
            n => format!(", {n} of them without triangles"),
        };
        writeln!(f, "objects        {}{empty}", self.n_objects)?;
        let degenerate = match self.n_degenerate_triangles {
            0 => String::new(),
            n => format!(", besides {n} without area"),
        };
        writeln!(f, "triangles      {}{degenerate}", self.n_triangles)?;
        let ([x0, y0, z0], [x1, y1, z1]) = (self.min, self.max);
        writeln!(f, "extent         ({x0}, {y0}, {z0}) to ({x1}, {y1}, {z1})")
    }
}
