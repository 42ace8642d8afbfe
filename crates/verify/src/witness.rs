//! A line of sight between two cells of a table of a scene.

use crate::framed::along_frame;
use crate::oracle::{RayOracle, SolidWorld};
use crate::sight::Target;
use crate::truth::{Truth, VerifyError};
use sightlines_cells::Scene;
use sightlines_geometry::{Point3, Random};
use sightlines_pvs::{CellId, Table};

/// Looks for a segment from inside one cell to inside another that nothing in the scene touches, from both cells, with about so many rays from
/// each.
///
/// What is found is a proof: that nothing touches the segment is decided exactly. That none is found proves nothing. A table with a frame is looked at along
/// its axes, in the scene as [`along_frame`] moves it; ends of the segment are along these. The same arguments give the same answer.
///
/// Cost: O(n log n) of triangles to prepare; each ray visits what is near it.
///
/// # Errors
/// [`VerifyError`] for a table that cannot be of such a scene.
pub fn sight_between(
    table: &Table,
    scene: &Scene,
    cells: [CellId; 2],
    tries: u32,
) -> Result<Option<[Point3; 2]>, VerifyError> {
    Truth::Scene(scene).check_kind(table)?;
    if let Some((table, scene)) = along_frame(table, scene)? {
        return Ok(aimed(&table, &scene, cells, tries));
    }
    Ok(aimed(table, scene, cells, tries))
}

fn aimed(table: &Table, scene: &Scene, [a, b]: [CellId; 2], tries: u32) -> Option<[Point3; 2]> {
    let world = SolidWorld::new(table, scene);
    let mut random = Random::new(0);
    let mut aim = |from: CellId, to: CellId| world.aim(table, from.0, Target::Cell(to), tries, &mut random);
    if let Some(sight) = aim(a, b) {
        return Some(sight.segment);
    }
    // What one way only shows is no line in the other.
    if world.has_one_way() {
        return None;
    }
    aim(b, a).map(|sight| {
        let [from, to] = sight.segment;
        [to, from]
    })
}
