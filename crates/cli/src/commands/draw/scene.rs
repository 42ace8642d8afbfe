//! The scene that a table was made of, to be drawn beside its cells.

use super::Error;
use crate::input;
use crate::surfaces::SurfaceArgs;
use sightlines::cells::Scene;
use sightlines::formats::quake::Bsp;
use sightlines::formats::{Input, ReadError};
use sightlines::pvs::Table;
use sightlines::report::Surfaces;
use std::path::Path;

/// Reads the surfaces of a scene in space, and refuses one that the table was not made of.
pub(super) fn surfaces(path: &Path, table: &Table) -> Result<Surfaces, Error> {
    match input::read(path, None, &SurfaceArgs::default().options_with(table.info()))? {
        Input::Scene(file) => of_scene(path, &file.scene, table),
        Input::Bsp(bsp) => of_map(path, &bsp, table),
        Input::Prt(_) => Err(other(path, "a portal file has nothing to draw; name its map")),
        _ => Err(other(path, "it is of a scene in space")),
    }
}

fn other(path: &Path, what: impl Into<String>) -> Error {
    Error::OtherScene { path: path.to_owned(), what: what.into() }
}

/// Objects are told by their names, and what has changed since by the digests of the table.
fn of_scene(path: &Path, scene: &Scene, table: &Table) -> Result<Surfaces, Error> {
    let (found, listed) = (scene.objects(), table.objects());
    if found.len() != listed.len() {
        return Err(other(path, format!("it has {} objects, and this file has {}", listed.len(), found.len())));
    }
    let mut both = found.iter().zip(listed).enumerate();
    if let Some((k, (object, record))) = both.find(|(_, (object, record))| object.name != record.name) {
        let what = format!("its object {k} is {:?}, and that of this file {:?}", record.name, object.name);
        return Err(other(path, what));
    }
    match table.digest().is_some_and(|digest| digest != scene.digest()) {
        true => Err(other(path, "its triangles differ from those of this file")),
        false => Ok(Surfaces::of_scene(scene)),
    }
}

/// The objects of the table of a Quake map are the faces of its world.
fn of_map(path: &Path, bsp: &Bsp, table: &Table) -> Result<Surfaces, Error> {
    let faces = bsp.world_faces().map_err(|error| ReadError::new(path, error))?;
    let (found, listed) = (faces.n_faces(), table.objects().len());
    match table.kind().is_quake() && found == listed {
        true => Ok(Surfaces::of_polygons((0..found).map(|k| faces.corners(k)))),
        false => Err(other(path, format!("it has {listed} objects, and the world of this map {found} faces"))),
    }
}
