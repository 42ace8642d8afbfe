//! The sections with sources of objects and with doors.

use super::error::DecodeError;
use super::reader::Reader;
use super::writer::Writer;
use crate::{DoorRecord, ObjectId, ObjectSource, PortalId};

/// Both numbers of an object that has no source.
const NOWHERE: [u32; 2] = [u32::MAX; 2];

pub(super) fn write_sources(out: &mut Writer, sources: &[Option<ObjectSource>]) {
    for source in sources {
        let [node, primitive] = source.map_or(NOWHERE, |source| [source.node, source.primitive]);
        out.u32(node);
        out.u32(primitive);
    }
}

pub(super) fn read_sources(r: &mut Reader<'_>, n: usize) -> Result<Vec<Option<ObjectSource>>, DecodeError> {
    r.expect(n as u64, 8)?;
    let mut source = || {
        let numbers = [r.u32()?, r.u32()?];
        Ok((numbers != NOWHERE).then_some(ObjectSource { node: numbers[0], primitive: numbers[1] }))
    };
    (0..n).map(|_| source()).collect()
}

pub(super) fn write(out: &mut Writer, doors: &[DoorRecord]) {
    out.count(doors.len());
    for DoorRecord { name, object, portals } in doors {
        // A checked object is below the number of objects, which has 32 bits.
        out.u32(object.map_or(0, |object| object.0 + 1));
        out.text(name);
        out.count(portals.len());
        portals.iter().for_each(|portal| out.u32(portal.0));
    }
}

pub(super) fn read(r: &mut Reader<'_>) -> Result<Vec<DoorRecord>, DecodeError> {
    let n = r.count(12)?;
    let mut doors = Vec::with_capacity(n);
    for _ in 0..n {
        let object = r.u32()?.checked_sub(1).map(ObjectId);
        let name = r.text()?;
        let n_portals = r.count(4)?;
        let portals = r.u32s(n_portals as u64)?.into_iter().map(PortalId).collect();
        doors.push(DoorRecord { name, object, portals });
    }
    Ok(doors)
}
