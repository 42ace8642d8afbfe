//! Cells that no viewer can be in or look into: the insides of walls, and unreachable rooms.
//!
//! A room is left out as a whole or not at all, so no cell that stays loses a portal, and nothing that is
//! seen from it changes.

use crate::hollow::hollow_rooms;
use crate::rooms::Rooms;
use crate::scene_faces::{SceneFaces, Survey};
use crate::solid::solid_rooms;
use crate::tree::AxialTree;
use sightlines_cells::Scene;
use sightlines_geometry::Aabb;

/// Why a cell is left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum LeftOut {
    /// Inside of a closed piece of an object.
    Solid,
    /// Closed, empty, and shows only back sides.
    Hollow,
    /// Closed, and not in the view region.
    Unreachable,
}

/// For each cell of the tree why it is left out, if it is.
pub(crate) fn left_out(
    scene: &Scene,
    survey: &Survey,
    found: &SceneFaces,
    tree: &AxialTree<3>,
    view_region: Option<Aabb<3>>,
) -> Vec<Option<LeftOut>> {
    let rooms = Rooms::of(tree);
    let solid = solid_rooms(scene, survey, tree, &rooms);
    let candidates = solid.iter().map(|solid| !solid).collect();
    let hollow = hollow_rooms(scene, survey, &found.faces, tree, &rooms, candidates);
    let in_region = |c: u32| view_region.is_none_or(|region| meet(&tree.cells()[c as usize].bounds, &region));
    let reachable = rooms.any(in_region);
    let why = |room: usize| match (solid[room], hollow[room], reachable[room]) {
        (true, ..) => Some(LeftOut::Solid),
        (_, true, _) => Some(LeftOut::Hollow),
        (.., false) => Some(LeftOut::Unreachable),
        _ => None,
    };
    let why: Vec<Option<LeftOut>> = (0..rooms.cells.len()).map(why).collect();
    if why.iter().all(Option::is_some) {
        return vec![None; tree.cells().len()];
    }
    rooms.of_cell.iter().map(|&room| why[room as usize]).collect()
}

/// Whether two closed boxes have a point in common.
fn meet(a: &Aabb<3>, b: &Aabb<3>) -> bool {
    (0..3).all(|k| a.min[k] <= b.max[k] && b.min[k] <= a.max[k])
}
