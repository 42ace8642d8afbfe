//! Cells that nobody can be in or look into: the insides of walls, and rooms without a way to them.
//!
//! Cells that portals join are a room here. A room is left out as a whole or not at all, so no cell that
//! stays loses a portal, and nothing that is seen from it changes.

use crate::coplanar::Union;
use crate::hollow::hollow_rooms;
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

/// The rooms of a tree.
#[derive(Debug)]
pub(crate) struct Rooms {
    /// The room of each cell.
    pub(crate) of_cell: Vec<u32>,
    /// The cells of each room, ascending.
    pub(crate) cells: Vec<Vec<u32>>,
}

impl Rooms {
    fn of(tree: &AxialTree<3>) -> Self {
        let mut union = Union::new(tree.cells().len());
        for portal in tree.portals() {
            let [a, b] = portal.cells;
            union.join(a.0, b.0);
        }
        let (mut of_cell, mut cells) = (Vec::new(), Vec::<Vec<u32>>::new());
        for cell in 0..tree.cells().len() as u32 {
            // The least cell of a room speaks for it, so it has its number before the others ask.
            let root = union.root(cell);
            let room = if root == cell { cells.len() as u32 } else { of_cell[root as usize] };
            if root == cell {
                cells.push(Vec::new());
            }
            of_cell.push(room);
            cells[room as usize].push(cell);
        }
        Self { of_cell, cells }
    }

    /// Whether the room of each index has a cell that fulfils `holds`.
    pub(crate) fn any(&self, mut holds: impl FnMut(u32) -> bool) -> Vec<bool> {
        self.cells.iter().map(|cells| cells.iter().any(|&c| holds(c))).collect()
    }
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
    let asked = solid.iter().map(|solid| !solid).collect();
    let hollow = hollow_rooms(scene, survey, &found.faces, tree, &rooms, asked);
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
