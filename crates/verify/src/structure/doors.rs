//! Doors: a portal that a door closes has to be covered by the door's leaf, or what is behind would be hidden when it is shut.
//!
//! A leaf covers a portal if triangles of the door lie in the plane of the portal and cover all of it, exactly, as they cover
//! [walls](crate::walls). Of a door that was given as a box the scene has no leaf: that box has to contain the portal. Where the table does not state
//! the box, such doors are counted; so are doors that are objects of plans and maps, which have no leafs.

use crate::findings::{Findings, Violation};
use crate::walls::uncovered;
use sightlines_cells::{Scene, SceneObject};
use sightlines_geometry::{Aabb, Point2, orient2d};
use sightlines_pvs::{DoorId, PortalId, PortalRecord, Table};

/// Compares the doors that were given as boxes with these. O(doors × portals) comparisons of corners.
///
/// * `has_leafs`: whether doors that are objects are compared with these
pub(super) fn as_boxes(table: &Table, has_leafs: bool, findings: &mut Findings) {
    let boxes = table.door_boxes();
    let n_unknown = table.doors().iter().filter(|door| !has_leafs || door.object.is_none()).count() - boxes.len();
    findings.remarks.doors_as_boxes = n_unknown as u64;
    for (door, [min, max]) in boxes {
        let (closed, within) = (&table.doors()[door.idx()].portals, table.portals_within(min, max));
        let open = closed.iter().filter(|portal| within.binary_search(portal).is_err());
        open.for_each(|&portal| findings.add(Violation::OpenDoor { door, portal }));
        let unlisted = within.iter().filter(|portal| closed.binary_search(portal).is_err());
        findings.remarks.unlisted_door_portals += unlisted.count() as u64;
    }
}

/// Compares the doors of a table with those of a scene. O(doors × portals) comparisons of boxes.
pub(super) fn of_scene(table: &Table, scene: &Scene, findings: &mut Findings) {
    for (door, record) in (0u32..).map(DoorId).zip(table.doors()) {
        let Some(object) = record.object else { continue };
        // A table of another scene may have objects that this one has not; that is found where they are counted.
        let Some(leaf) = scene.objects().get(object.idx()).filter(|_| scene.doors().contains(&object.0)) else {
            findings.add(Violation::NoDoor { door });
            continue;
        };
        if leaf.name != record.name {
            findings.add(Violation::DoorName { door });
        }
        let around = leaf.bounds();
        for (portal, opening) in (0u32..).map(PortalId).zip(table.portals()) {
            let is_listed = record.portals.binary_search(&portal).is_ok();
            let is_near = opening.points.iter().all(|&p| around.contains(p));
            match (is_listed, is_near && covers(leaf, opening)) {
                (true, false) => findings.add(Violation::OpenDoor { door, portal }),
                (false, true) => findings.remarks.unlisted_door_portals += 1,
                _ => {}
            }
        }
    }
}

/// Whether triangles of a leaf in the plane of a portal cover all of it.
fn covers(leaf: &SceneObject, portal: &PortalRecord) -> bool {
    let extent = Aabb::<3>::around(portal.points.iter().copied());
    // Portals that are no rectangles along the axes are found elsewhere.
    let Some(axis) = (0..3).find(|&axis| extent.min[axis] == extent.max[axis]) else { return false };
    let at = extent.min[axis];
    let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    let in_plane = leaf.corners().filter(|t| t.iter().all(|p| p[axis] == at));
    let flat = in_plane.map(|t| t.map(|p| Point2::new(p[u], p[v])));
    let triangles: Vec<[Point2; 3]> = flat.filter(|[a, b, c]| orient2d(*a, *b, *c) != 0.0).collect();
    uncovered([extent.min[u], extent.min[v], extent.max[u], extent.max[v]], &triangles).is_none()
}
