//! The scene that a table was made of, as it is drawn.

use super::ViewArgs;
use crate::error::{Result, anyhow};
use crate::input;
use crate::same_scene::difference;
use sightlines::bake::Bakeable;
use sightlines::cells::{Plan, Scene};
use sightlines::formats::quake::Bsp;
use sightlines::formats::{Input, ReadError};
use sightlines::pvs::Table;
use sightlines::viewer::Figure;
use std::path::Path;

/// Reads a scene, and refuses one that the table was not made of.
pub(super) fn figure(path: &Path, args: &ViewArgs, table: &Table) -> Result<Figure> {
    let plan = args.plans.options_with(path, table)?;
    match input::read(path, args.map.as_deref(), &args.surfaces.options_with(table.info()), &plan)? {
        Input::Scene(file) => of_scene(path, &file.scene, table),
        Input::Bsp(bsp) => of_map(path, &bsp, table),
        Input::Prt(_) => Err(other(path, "a portal file has nothing to draw; name its map")),
        other => match input::bakeable(path, other, args.map.as_deref(), None)? {
            Bakeable::Plan { plan, .. } => of_plan(path, &plan, table),
            _ => Err(self::other(path, "it is of another kind")),
        },
    }
}

fn other(path: &Path, what: impl std::fmt::Display) -> anyhow::Error {
    anyhow!("{}: the table was made of another scene: {what}", path.display())
}

fn of_scene(path: &Path, scene: &Scene, table: &Table) -> Result<Figure> {
    if table.dimension() != 3 {
        return Err(other(path, "the table is of a plan"));
    }
    match difference(table, scene) {
        Some(what) => Err(other(path, what)),
        None => Ok(Figure::of_scene(scene)),
    }
}

/// The objects of the table of a Quake map are the faces of its world.
fn of_map(path: &Path, bsp: &Bsp, table: &Table) -> Result<Figure> {
    let faces = bsp.world_faces().map_err(|error| ReadError::new(path, error))?;
    let (found, listed) = (faces.n_faces(), table.objects().len());
    match table.kind().is_quake() && found == listed {
        true => Ok(Figure::of_polygons((0..found).map(|k| faces.polygons(k)))),
        false => Err(other(path, format!("it has {listed} objects, and the world of this map {found} faces"))),
    }
}

fn of_plan(path: &Path, plan: &Plan, table: &Table) -> Result<Figure> {
    if table.dimension() != 2 {
        return Err(other(path, "the table is of a scene in space"));
    }
    match table.digest().is_some_and(|digest| digest != plan.digest()) {
        true => Err(other(path, "its lines or objects differ from those of this file")),
        false => Ok(Figure::of_plan(plan)),
    }
}
