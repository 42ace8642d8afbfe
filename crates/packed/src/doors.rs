//! Doors, and where objects are in their file: both are resident.

use crate::bytes::Reader;
use crate::container::ResidentPart;
use crate::error::{PackedError, PackedErrorKind as Kind};
use crate::format;
use crate::packed::{Head, Packed};
use crate::source::Source;
use sightlines_pvs::{DoorId, DoorRecord, NodeIndex, ObjectId, ObjectSource, PortalId, box_covers, doors_named};

impl<S: Source> Packed<S> {
    /// The doors, as [`sightlines_pvs::Table::doors`]; always in memory.
    pub fn doors(&self) -> &[DoorRecord] {
        &self.doors
    }

    /// The doors of a name, as [`sightlines_pvs::Table::door`]. O(doors).
    pub fn door(&self, name: &str) -> impl Iterator<Item = DoorId> {
        doors_named(&self.doors, name)
    }

    /// The portals in a closed box of the scene, as [`sightlines_pvs::Table::portals_within`]. Reads all portals: O(portals).
    ///
    /// # Errors
    /// If a block cannot be read.
    pub fn portals_within(&self, min: [f64; 3], max: [f64; 3]) -> Result<Vec<PortalId>, PackedError> {
        let mut within = Vec::new();
        for portal in (0..self.head.n_portals).map(PortalId) {
            let points = self.portal(portal)?.points;
            if box_covers(self.frame(), self.head.dimension, min, max, &points) {
                within.push(portal);
            }
        }
        Ok(within)
    }

    /// Where an object is in the file that the table was made of, as [`sightlines_pvs::Table::source_of`]; always in memory.
    ///
    /// # Errors
    /// If there is no such object.
    pub fn source_of(&self, object: ObjectId) -> Result<Option<ObjectSource>, PackedError> {
        let n_objects = self.head.n_objects;
        if object.0 >= n_objects {
            return Err(PackedError::asked(Kind::NoObject { object, n_objects }));
        }
        Ok(self.sources.of_objects.get(object.idx()).copied().flatten())
    }

    /// Whether it is known where any of the objects are in that file.
    pub fn has_sources(&self) -> bool {
        !self.sources.nodes.is_empty()
    }

    /// The objects of a node of that file, as [`sightlines_pvs::Table::objects_of_node`]; always in memory. O(log n).
    pub fn objects_of_node(&self, node: u32) -> impl Iterator<Item = ObjectId> + '_ {
        self.sources.nodes.objects_of(node)
    }
}

/// The sources of all objects.
#[derive(Debug)]
pub(crate) struct Sources {
    of_objects: Vec<Option<ObjectSource>>,
    nodes: NodeIndex,
}

impl Sources {
    pub(crate) fn read(resident: &ResidentPart, n_objects: u32) -> Result<Self, PackedError> {
        let mut of_objects = Vec::new();
        if let Some(section) = resident.find(format::SOURCES) {
            let mut r = Reader::new(section.bytes, section.place);
            for _ in 0..n_objects {
                let source = match r.below(1 << 32)?.checked_sub(1) {
                    None => None,
                    Some(node) => Some(ObjectSource { node, primitive: r.below(1 << 32)? }),
                };
                of_objects.push(source);
            }
            r.finish()?;
        }
        Ok(Self { nodes: NodeIndex::new(&of_objects), of_objects })
    }

    /// In the order of the objects; empty if none is known.
    pub(crate) fn of_objects(&self) -> &[Option<ObjectSource>] {
        &self.of_objects
    }
}

pub(crate) fn read(resident: &ResidentPart, head: &Head) -> Result<Vec<DoorRecord>, PackedError> {
    let Some(section) = resident.find(format::DOORS) else { return Ok(Vec::new()) };
    let mut r = Reader::new(section.bytes, section.place);
    let n = r.count(3)?;
    let mut doors = Vec::new();
    for _ in 0..n {
        let object = r.below(u64::from(head.n_objects) + 1)?.checked_sub(1).map(ObjectId);
        let name = r.text()?.to_owned();
        let mut portals = Vec::new();
        r.ascending(u64::from(head.n_portals), |portal| portals.push(PortalId(portal)))?;
        doors.push(DoorRecord { name, object, portals });
    }
    r.finish()?;
    Ok(doors)
}
