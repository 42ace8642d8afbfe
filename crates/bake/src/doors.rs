//! Doors of a scene, and the portals of its table that they close.

use sightlines_cells::{Axial, CellGraph, Scene};
use sightlines_kdtree::shut_doors;
use sightlines_pvs::{DoorRecord, ObjectId, PortalId};

/// A door, and the portals of the table that it closes while it stands as it does in the scene. The table takes it to be open; a program
/// that knows that it is shut may close these portals, for every eye that is not inside the door.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DoorPortals {
    /// The object.
    pub object: u32,
    /// Ascending; none if the door fills no opening, or only parts of portals.
    pub portals: Vec<PortalId>,
}

/// All doors of a scene, and the portals of `graph` that each of them closes. O(doors × portals).
pub(crate) fn of_scene(graph: &CellGraph<Axial>, scene: &Scene) -> Vec<DoorPortals> {
    let shut = shut_doors(scene);
    let of = |&object: &u32| {
        let door = shut.iter().find(|door| door.object == object);
        let closes = |portal: &sightlines_cells::Portal<Axial>| door.is_some_and(|door| door.closes(&portal.shape));
        let portals = (0u32..).zip(graph.portals()).filter(|(_, portal)| closes(portal)).map(|(id, _)| PortalId(id));
        DoorPortals { object, portals: portals.collect() }
    };
    scene.doors().iter().map(of).collect()
}

/// Doors as a table stores them: each has the name of its object.
pub(crate) fn records(scene: &Scene, doors: &[DoorPortals]) -> Vec<DoorRecord> {
    let record = |DoorPortals { object, portals }: &DoorPortals| DoorRecord {
        name: scene.objects()[*object as usize].name.clone(),
        object: Some(ObjectId(*object)),
        portals: portals.clone(),
    };
    doors.iter().map(record).collect()
}
