//! Where the walls of a plan are joined, to be drawn over its cells.

use crate::error::{ErrorAbout, Result};
use crate::input;
use crate::plans::PlanArgs;
use crate::same_scene::other;
use sightlines::bake::{Bakeable, stated_gap};
use sightlines::formats::scene::SceneReadOptions;
use sightlines::geometry::Point2;
use sightlines::pvs::Table;
use std::path::Path;

/// Ends of walls.
#[derive(Debug, Default)]
pub(super) struct Rings {
    /// Those that are joined.
    pub(super) joints: Vec<Point2>,
    /// Those that nearly meet others.
    pub(super) near_misses: Vec<Point2>,
}

/// Reads the plan that a table was made of, as it was read then, and joins its walls as they were joined then.
pub(super) fn of(path: &Path, map: Option<&str>, table: &Table) -> Result<Rings> {
    let options = PlanArgs::default().options_with(path, table)?;
    let input = input::read(path, map, &SceneReadOptions::default(), &options)?;
    let Bakeable::Plan { plan, .. } = input::bakeable(path, input, map, None)? else {
        return Err(other(path, "it is of a plan"));
    };
    let plan = plan.joined(stated_gap(table)).in_file(path)?;
    if table.digest().is_some_and(|digest| digest != plan.digest()) {
        return Err(other(path, "its lines differ from those of this file"));
    }
    Ok(Rings { joints: plan.joined_ends(), near_misses: plan.near_misses() })
}
