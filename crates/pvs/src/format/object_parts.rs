//! The section with the parts of objects.

use super::error::DecodeError;
use super::reader::Reader;
use super::writer::Writer;
use crate::{ObjectId, ObjectPart, ObjectParts};

pub(super) fn write(out: &mut Writer, ObjectParts { parts, seen }: &ObjectParts) {
    out.count(parts.len());
    for ObjectPart { object, start, end } in parts {
        [object.0, *start, *end].into_iter().for_each(|x| out.u32(x));
    }
    out.rows(seen);
}

pub(super) fn read(r: &mut Reader<'_>, n_cells: usize) -> Result<ObjectParts, DecodeError> {
    let n = r.count(12)?;
    let mut part = || Ok(ObjectPart { object: ObjectId(r.u32()?), start: r.u32()?, end: r.u32()? });
    let parts = (0..n).map(|_| part()).collect::<Result<Vec<_>, DecodeError>>()?;
    Ok(ObjectParts { parts, seen: r.rows(n_cells, n)? })
}
