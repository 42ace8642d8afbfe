//! The scene that a table was made of, to be drawn beside its cells.

use crate::error::{Result, anyhow};
use crate::input;
use crate::same_scene::difference;
use crate::surfaces::SurfaceArgs;
use sightlines::cells::Scene;
use sightlines::formats::quake::Bsp;
use sightlines::formats::{Input, PlanReadOptions, ReadError};
use sightlines::pvs::Table;
use sightlines::report::Surfaces;
use std::path::Path;

/// Reads the surfaces of a scene in space, and refuses one that the table was not made of.
pub(super) fn surfaces(path: &Path, table: &Table) -> Result<Surfaces> {
    match input::read(path, None, &SurfaceArgs::default().options_with(table.info()), &PlanReadOptions::default())? {
        Input::Scene(file) => of_scene(path, &file.scene, table),
        Input::Bsp(bsp) => of_map(path, &bsp, table),
        Input::Prt(_) => Err(other(path, "a portal file has nothing to draw; name its map")),
        _ => Err(other(path, "it is of a scene in space")),
    }
}

fn other(path: &Path, what: impl std::fmt::Display) -> anyhow::Error {
    anyhow!("{}: the table was made of another scene: {what}", path.display())
}

fn of_scene(path: &Path, scene: &Scene, table: &Table) -> Result<Surfaces> {
    match difference(table, scene) {
        Some(what) => Err(other(path, what)),
        None => Ok(Surfaces::of_scene(scene)),
    }
}

/// The objects of the table of a Quake map are the faces of its world.
fn of_map(path: &Path, bsp: &Bsp, table: &Table) -> Result<Surfaces> {
    let faces = bsp.world_faces().map_err(|error| ReadError::new(path, error))?;
    let (found, listed) = (faces.n_faces(), table.objects().len());
    match table.kind().is_quake() && found == listed {
        true => Ok(Surfaces::of_polygons((0..found).map(|k| faces.polygons(k)))),
        false => Err(other(path, format!("it has {listed} objects, and the world of this map {found} faces"))),
    }
}
