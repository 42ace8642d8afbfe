//! Whether a scene is the one that a table was made of.

use crate::error::{Result, anyhow};
use sightlines::cells::Scene;
use sightlines::formats::quake::Bsp;
use sightlines::formats::quake::bsp::WorldFaces;
use sightlines::formats::{Input, ReadError};
use sightlines::pvs::Table;
use std::path::Path;

/// What of a scene in space differs from what the table says, as the end of a sentence about the table. Objects are told by their names, and
/// what has changed since by the digest.
pub(crate) fn difference(table: &Table, scene: &Scene) -> Option<String> {
    let (found, listed) = (scene.objects(), table.objects());
    if found.len() != listed.len() {
        return Some(format!("it has {} objects, and this file has {}", listed.len(), found.len()));
    }
    let mut both = found.iter().zip(listed).enumerate();
    if let Some((k, (object, record))) = both.find(|(_, (object, record))| object.name != record.name) {
        return Some(format!("its object {k} is {:?}, and that of this file {:?}", record.name, object.name));
    }
    let has_changed = table.digest().is_some_and(|digest| digest != scene.digest());
    has_changed.then(|| "its triangles differ from those of this file".to_owned())
}

pub(crate) fn other(path: &Path, what: impl std::fmt::Display) -> anyhow::Error {
    anyhow!("{}: the table was made of another scene: {what}", path.display())
}

/// What is drawn of an input in space; `None` for one in the plane. Refuses one that the table was not made of.
pub(crate) fn drawn<T>(
    path: &Path,
    input: &Input,
    table: &Table,
    of_scene: fn(&Scene) -> T,
    of_faces: fn(&WorldFaces) -> T,
) -> Result<Option<T>> {
    match input {
        Input::Scene(_) if table.dimension() != 3 => Err(other(path, "the table is of a plan")),
        Input::Scene(file) => match difference(table, &file.scene) {
            Some(what) => Err(other(path, what)),
            None => Ok(Some(of_scene(&file.scene))),
        },
        Input::Bsp(bsp) => of_map(path, bsp, table, of_faces).map(Some),
        Input::Prt(_) => Err(other(path, "a portal file has nothing to draw; name its map")),
        _ => Ok(None),
    }
}

/// The objects of the table of a Quake map are the faces of its world.
fn of_map<T>(path: &Path, bsp: &Bsp, table: &Table, of_faces: fn(&WorldFaces) -> T) -> Result<T> {
    let faces = bsp.world_faces().map_err(|error| ReadError::new(path, error))?;
    let (found, listed) = (faces.n_faces(), table.objects().len());
    match table.kind().is_quake() && found == listed {
        true => Ok(of_faces(&faces)),
        false => Err(other(path, format!("it has {listed} objects, and the world of this map {found} faces"))),
    }
}
