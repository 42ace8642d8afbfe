//! From a scene and what is left of it to the bytes of a file.

use crate::error::CliError;
use crate::input::{self, Kind};
use sightlines::cells::{Scene, SceneObject};
use sightlines::formats::scene::{self, read_scene_with_source, write_simplified_glb};
use sightlines::formats::{GltfSource, SceneFile};
use sightlines::simplify::Simplified;
use std::path::Path;

/// A scene, with what it takes to write its file again.
#[derive(Debug)]
pub(crate) struct ReadScene {
    pub(crate) file: SceneFile,
    /// None for an OBJ.
    pub(crate) source: Option<GltfSource>,
}

/// Reads a scene that is to be simplified. One of which triangles were moved is refused: its surfaces hide each other.
pub(crate) fn read(path: &Path) -> Result<ReadScene, CliError> {
    if input::kind_of(path)? != Some(Kind::Scene) {
        return Err(CliError::Kind { path: path.to_owned(), expected: "a GLB nor a glTF nor an OBJ scene" });
    }
    let (file, source) = read_scene_with_source(path)?;
    input::check_occluder(path, &file)?;
    if source.is_none() {
        tracing::warn!("{}: of an OBJ, triangles and names are kept; materials are not", path.display());
    }
    Ok(ReadScene { file, source })
}

/// What is left of a scene, as GLB.
pub(crate) fn written(
    path: &Path,
    scene: &Scene,
    source: Option<&GltfSource>,
    simplified: &Simplified,
) -> Result<Vec<u8>, CliError> {
    let said = scene::Simplified { occluder: simplified.is_part_of_the_original() };
    match source {
        Some(source) => {
            let change = |(k, list): (usize, &Vec<[u32; 3]>)| simplified.changes(scene, k).then(|| list.clone());
            let changes: Vec<_> = simplified.triangles.iter().enumerate().map(change).collect();
            source.rewrite(&changes, Some(said)).map_err(|source| CliError::Rewrite { path: path.to_owned(), source })
        }
        None => {
            let left = left(scene, simplified);
            write_simplified_glb(&left, said).map_err(|source| CliError::Glb { path: path.to_owned(), source })
        }
    }
}

/// The objects of which something is left, with the vertices that are used.
fn left(scene: &Scene, simplified: &Simplified) -> Scene {
    let is_mirror = |k: usize| scene.mirrors().iter().any(|&mirror| mirror as usize == k);
    let (mut objects, mut mirrors) = (Vec::new(), Vec::new());
    for (k, (o, triangles)) in scene.objects().iter().zip(&simplified.triangles).enumerate() {
        if triangles.is_empty() {
            continue;
        }
        let mut used: Vec<u32> = triangles.iter().flatten().copied().collect();
        used.sort_unstable();
        used.dedup();
        let place = |v: u32| used.partition_point(|&u| u < v) as u32;
        if is_mirror(k) {
            mirrors.push(objects.len() as u32);
        }
        objects.push(SceneObject {
            name: o.name.clone(),
            vertices: used.iter().map(|&v| o.vertices[v as usize]).collect(),
            triangles: triangles.iter().map(|t| t.map(place)).collect(),
        });
    }
    let scene = Scene::new(objects).expect("coordinates and indices are those of a scene");
    scene.with_mirrors(mirrors).expect("mirrors are objects")
}
