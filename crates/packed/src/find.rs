//! Doors by name and place, and objects by their place in their file.

use crate::error::{PackedError, PackedErrorKind as Kind};
use crate::packed::Packed;
use crate::source::ByteSource;
use sightlines_pvs::{DoorId, DoorRecord, ObjectId, ObjectSource, PortalId, box_covers, doors_named};

impl<S: ByteSource> Packed<S> {
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
