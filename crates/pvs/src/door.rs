//! Doors: the portals that they close, by name and by place.

use crate::{DoorId, DoorRecord, Frame, PortalId, Table};

impl Table {
    /// The doors, by id; empty in a stripped table, and in older files.
    pub fn doors(&self) -> &[DoorRecord] {
        &self.parts().doors
    }

    /// The doors of this name, ascending: names may repeat, as the two wings of a door may have one. None if there is no such door.
    /// O(doors).
    pub fn door(&self, name: &str) -> impl Iterator<Item = DoorId> {
        doors_named(self.doors(), name)
    }

    /// The portals that lie entirely in the closed box from `min` to `max` (of the scene, in its units; z does not count in a plane),
    /// ascending: those that something solid of that shape closes. None in a stripped table. See [`box_covers`] for what
    /// is exact and on which side it errs. O(portals).
    pub fn portals_within(&self, min: [f64; 3], max: [f64; 3]) -> Vec<PortalId> {
        let portals = (0u32..).map(PortalId).zip(self.portals());
        let within = portals.filter(|(_, portal)| box_covers(self.frame(), self.dimension(), min, max, &portal.points));
        within.map(|(id, _)| id).collect()
    }
}

/// The doors of a name, ascending. O(doors).
pub fn doors_named(doors: &[DoorRecord], name: &str) -> impl Iterator<Item = DoorId> {
    let ids = (0u32..).map(DoorId).zip(doors);
    ids.filter(move |(_, door)| door.name == name).map(|(id, _)| id)
}

/// Whether a portal with these corners, of a table with this frame and dimension, lies entirely in the closed box of the scene
/// from `min` to `max`; a box with a NaN, or with a lower corner above its upper one, contains nothing.
///
/// Without a frame this is exact: a portal is convex, so the box contains it if it contains its corners. With one, a corner of the table is
/// within the gap of one of the scene, and the box has to contain all places where that may be: whoever gives the box of an opening
/// widens it by √3 times the gap. What is rounded then errs towards not contained, so towards open.
pub fn box_covers(frame: Option<&Frame>, dimension: u8, min: [f64; 3], max: [f64; 3], points: &[[f64; 3]]) -> bool {
    points.iter().all(|&p| {
        let (low, high) = frame.map_or((p, p), |frame| frame.around_in_scene(p, p));
        (0..usize::from(dimension)).all(|k| min[k] <= low[k] && high[k] <= max[k])
    })
}
