//! The sections with doors, with parts of objects, and with where objects are in their file: all are resident.

use crate::bytes::Reader;
use crate::container::ResidentPart;
use crate::error::{PackedError, PackedErrorKind as Kind};
use crate::format;
use sightlines_pvs::{DoorRecord, NodeIndex, ObjectId, ObjectPart, ObjectSource, PortalId};

/// The sources of all objects.
#[derive(Debug)]
pub(crate) struct Sources {
    /// In the order of the objects; empty if none is known.
    pub(crate) of_objects: Vec<Option<ObjectSource>>,
    pub(crate) nodes: NodeIndex,
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
}

/// The parts of objects of a table with so many objects.
pub(crate) fn object_parts(resident: &ResidentPart, n_objects: u32) -> Result<Option<Vec<ObjectPart>>, PackedError> {
    let Some(section) = resident.find(format::OBJECT_PARTS) else { return Ok(None) };
    let mut r = Reader::new(section.bytes, section.place);
    let n = r.count(2)?;
    let mut parts: Vec<ObjectPart> = Vec::new();
    for _ in 0..n {
        let object = ObjectId(r.below(u64::from(n_objects))?);
        let last = parts.last();
        let start = last.filter(|last| last.object == object).map_or(0, |last| last.end);
        let end = start + r.below(u64::from(u32::MAX - start) + 1)?;
        if end == start || last.is_some_and(|last| last.object > object) {
            return Err(r.fail(Kind::Value { value: u64::from(object.0) }));
        }
        parts.push(ObjectPart { object, start, end });
    }
    r.finish()?;
    Ok(Some(parts))
}

/// The doors of a table with so many objects and portals.
pub(crate) fn read(resident: &ResidentPart, [n_objects, n_portals]: [u32; 2]) -> Result<Vec<DoorRecord>, PackedError> {
    let Some(section) = resident.find(format::DOORS) else { return Ok(Vec::new()) };
    let mut r = Reader::new(section.bytes, section.place);
    let n = r.count(3)?;
    let mut doors = Vec::new();
    for _ in 0..n {
        let object = r.below(u64::from(n_objects) + 1)?.checked_sub(1).map(ObjectId);
        let name = r.text()?.to_owned();
        let mut portals = Vec::new();
        r.ascending(u64::from(n_portals), |portal| portals.push(PortalId(portal)))?;
        doors.push(DoorRecord { name, object, portals });
    }
    r.finish()?;
    Ok(doors)
}
