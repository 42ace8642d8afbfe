//! Doors: the portals that they close, by name and by place.

use crate::parts::DOOR_BOXES;
use crate::{DoorId, DoorRecord, Frame, PortalId, Table};

/// A door that is given as a box of the scene, in its units.
#[derive(Debug, Clone, PartialEq)]
pub struct DoorBox {
    /// Its name; names may repeat.
    pub name: String,
    /// The lower corner.
    pub min: [f64; 3],
    /// The upper corner; z does not count in a plane.
    pub max: [f64; 3],
}

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

    /// The same table with these doors behind its own: each closes the [portals within](Self::portals_within) its box, which the table states.
    /// O(doors × portals).
    #[must_use]
    pub fn with_door_boxes(self, boxes: &[DoorBox]) -> Self {
        if boxes.is_empty() {
            return self;
        }
        let own = self.door_boxes();
        let text = own.iter().map(|(_, corners)| *corners).chain(boxes.iter().map(|door| [door.min, door.max]));
        let text: Vec<String> = text.map(|corners| written(corners.as_flattened())).collect();
        let record = |door: &DoorBox| DoorRecord {
            name: door.name.clone(),
            object: None,
            portals: self.portals_within(door.min, door.max),
        };
        let doors = self.doors().iter().cloned().chain(boxes.iter().map(record)).collect();
        let table = self.with_doors(doors).expect("the portals within a box are portals of the table, ascending");
        table.with_info(DOOR_BOXES, text.join("\n"))
    }

    /// The doors that were given as boxes, ascending, and the corners of these, low and high. None if the table does not state one for each such
    /// door, as in older files. O(doors).
    pub fn door_boxes(&self) -> Vec<(DoorId, [[f64; 3]; 2])> {
        let as_boxes = (0u32..).map(DoorId).zip(self.doors()).filter(|(_, door)| door.object.is_none());
        let ids: Vec<DoorId> = as_boxes.map(|(id, _)| id).collect();
        let stated: Option<Vec<_>> = self.info_value(DOOR_BOXES).unwrap_or_default().lines().map(corners).collect();
        match stated {
            Some(stated) if stated.len() == ids.len() => ids.into_iter().zip(stated).collect(),
            _ => Vec::new(),
        }
    }
}

fn written(numbers: &[f64]) -> String {
    numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(",")
}

fn corners(text: &str) -> Option<[[f64; 3]; 2]> {
    let numbers: Vec<f64> = text.split(',').map(|x| x.parse().ok()).collect::<Option<_>>()?;
    let [a, b, c, d, e, f] = numbers.try_into().ok()?;
    Some([[a, b, c], [d, e, f]])
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
