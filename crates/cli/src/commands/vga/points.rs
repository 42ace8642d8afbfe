//! Which points there are.

use crate::error::{ErrorAbout, Result};
use crate::output::count;
use sightlines::cells::Plan;
use sightlines::formats::points::read_points;
use sightlines::geometry::Point2;
use sightlines::visibility_graph::{InteriorPoints, PixelGrid, Points};
use std::path::Path;

/// The points of a grid over a plan: those that seeds reach or, without seeds, the interior; and the grid's columns and rows.
pub(super) fn of_grid(path: &Path, plan: &Plan, spacing: f64, seeds: &[Point2]) -> Result<(Points, [usize; 2])> {
    let grid = PixelGrid::over(plan, spacing).in_file(path)?;
    if !seeds.is_empty() {
        return Ok((grid.fill(seeds).in_file(path)?, grid.size()));
    }
    let InteriorPoints { points, is_enclosed } = grid.interior().in_file(path)?;
    if !is_enclosed {
        let n = count(points.len() as u64, "point");
        tracing::warn!(
            "{}: walls leave gaps to the outside: {n} with walls around are taken; name a --seed for others",
            path.display()
        );
    }
    Ok((points, grid.size()))
}

pub(super) fn of_file(path: &Path) -> Result<Points> {
    let points = read_points(path)?.into_iter().map(|point| point.point);
    Points::new(points).in_file(path)
}
