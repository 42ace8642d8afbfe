//! The scene that a table was made of, to be drawn beside its cells.

use crate::error::Result;
use crate::input;
use crate::same_scene::{drawn, other};
use crate::surfaces::SurfaceArgs;
use sightlines::formats::PlanReadOptions;
use sightlines::pvs::Table;
use sightlines::report::Surfaces;
use std::path::Path;

/// Reads the surfaces of a scene in space, and refuses one that the table was not made of.
pub(super) fn surfaces(path: &Path, table: &Table) -> Result<Surfaces> {
    let options = SurfaceArgs::default().options_with(table.info());
    let input = input::read(path, None, &options, &PlanReadOptions::default())?;
    let found = drawn(path, &input, table, Surfaces::of_scene, |faces| {
        Surfaces::of_polygons((0..faces.n_faces()).map(|k| faces.polygons(k)))
    })?;
    found.ok_or_else(|| other(path, "it is of a scene in space"))
}
