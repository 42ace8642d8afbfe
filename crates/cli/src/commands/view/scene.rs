//! The scene that a table was made of, as it is drawn.

use super::ViewArgs;
use crate::error::{ErrorAbout, Result};
use crate::input;
use crate::same_scene::{drawn, other};
use sightlines::bake::{Bakeable, stated_gap};
use sightlines::formats::Input;
use sightlines::pvs::Table;
use sightlines::viewer::Figure;
use std::path::Path;

/// Reads a scene, and refuses one that the table was not made of.
pub(super) fn figure(path: &Path, args: &ViewArgs, table: &Table) -> Result<Figure> {
    let (plan, map) = (args.plans.options_with(path, table)?, args.map.as_deref());
    let input = input::read(path, map, &args.surfaces.options_with(table.info()), &plan)?;
    let is_single_sided = matches!(&input, Input::Scene(file) if file.info.n_single_sided_triangles > 0);
    let found = drawn(path, &input, table, Figure::of_scene, |faces| {
        Figure::of_polygons((0..faces.n_faces()).map(|k| faces.polygons(k)))
    })?;
    if let Some(figure) = found {
        return Ok(figure.with_single_sided(is_single_sided));
    }
    let Bakeable::Plan { plan, .. } = input::bakeable(path, input, map, None)? else {
        return Err(other(path, "it is of another kind"));
    };
    if table.dimension() != 2 {
        return Err(other(path, "the table is of a scene in space"));
    }
    match table.digest().is_some_and(|digest| digest != plan.digest()) {
        true => Err(other(path, "its lines or objects differ from those of this file")),
        false => Ok(Figure::of_plan(&plan.joined(stated_gap(table)).in_file(path)?)),
    }
}
