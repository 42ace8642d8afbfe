//! Small sections that are read whole when a file is opened.

use crate::bytes::Reader;
use crate::container::ResidentPart;
use crate::error::{PackedError, PackedErrorKind as Kind};
use crate::format;
use sightlines_pvs::format::{kind_from_bytes, kind_from_info};
use sightlines_pvs::{Axis, CellId, Frame, FrameError, GeometryDigest, MirrorId, MirrorRecord, TableKind};

pub(crate) fn info(resident: &ResidentPart) -> Result<Vec<(String, String)>, PackedError> {
    let section = resident.need(format::INFO)?;
    let mut r = Reader::new(section.bytes, section.place);
    let n = r.count(2)?;
    let mut info = Vec::new();
    for _ in 0..n {
        info.push((r.text()?.to_owned(), r.text()?.to_owned()));
    }
    r.finish()?;
    Ok(info)
}

/// Kind and upward axis; a file of a later minor version may have values that are unknown here.
pub(crate) fn kind(
    resident: &ResidentPart,
    dimension: u8,
    info: &[(String, String)],
) -> Result<(TableKind, Option<Axis>), PackedError> {
    let Some(section) = resident.find(format::KIND) else { return Ok(kind_from_info(dimension, info)) };
    let bytes = section.bytes.try_into().map_err(|_| section.place.fail(Kind::Cut))?;
    match kind_from_bytes(bytes) {
        Ok(known) => Ok(known),
        Err(_) if resident.minor() > format::MINOR => Ok((TableKind::Unspecified, None)),
        Err(value) => Err(section.place.fail(Kind::Value { value: u64::from(value) })),
    }
}

pub(crate) fn frame(resident: &ResidentPart, dimension: u8) -> Result<Option<Frame>, PackedError> {
    let Some(section) = resident.find(format::FRAME) else { return Ok(None) };
    let bytes = section.bytes.try_into().map_err(|_| section.place.fail(Kind::Cut))?;
    let read = if dimension == 3 { Frame::from_bytes(bytes) } else { Err(FrameError::Plane) };
    read.map(Some).map_err(|error| section.place.fail(Kind::Table(error.into())))
}

pub(crate) fn digest(resident: &ResidentPart) -> Result<Option<GeometryDigest>, PackedError> {
    let Some(section) = resident.find(format::DIGEST) else { return Ok(None) };
    let bytes = section.bytes.try_into().map_err(|_| section.place.fail(Kind::Cut))?;
    Ok(Some(GeometryDigest::from_bytes(bytes)))
}

pub(crate) fn mirrors(
    resident: &ResidentPart,
    (dimension, n_cells): (u8, u32),
) -> Result<Vec<MirrorRecord>, PackedError> {
    let Some(section) = resident.find(format::MIRRORS) else { return Ok(Vec::new()) };
    let d = usize::from(dimension);
    let mut r = Reader::new(section.bytes, section.place);
    let n = r.count(3)?;
    let mut mirrors = Vec::new();
    for _ in 0..n {
        let (cell, mirror) = (CellId(r.below(u64::from(n_cells))?), MirrorId(r.below(1 << 32)?));
        let n_points = r.count(8 * d)?;
        let points = (0..n_points).map(|_| r.point(d)).collect::<Result<_, _>>()?;
        mirrors.push(MirrorRecord { cell, mirror, points });
    }
    r.finish()?;
    Ok(mirrors)
}
