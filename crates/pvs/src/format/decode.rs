//! Reads a table.

use super::container::{self, Section, array};
use super::error::{DecodeError, DecodeErrorKind as Kind};
use super::reader::{Reader, read};
use super::{
    CELL_NAMES, CELL_OBJECTS, CELLS, DIGEST, DOORS, FRAME, INFO, KIND, KIND_LEN, LEAF, LOCATOR, MINOR, MIRRORS,
    OBJECT_PARTS, OBJECT_POLYGONS, OBJECTS, PLANES, POLYGONS, PORTALS, ROWS, SEEN, SOURCES, STAB, SectionId, doors,
    kind_from_bytes, kind_from_info, n_row_words, object_parts, planes, stab,
};
use crate::digest::{DIGEST_LEN, GeometryDigest};
use crate::frame::FRAME_LEN;
use crate::locator::Node;
use crate::{Axis, Frame, TableKind};
use crate::{
    BitMatrix, CellId, CellRecord, Item, Locator, LocatorError, MirrorId, MirrorRecord, ObjectId, ObjectRecord,
    PortalRecord,
};
use crate::{Table, TableError, TableParts};

impl Table {
    /// Reads the bytes of a `.pvs` file and checks them as [`Table::new`] does. O(size), and memory proportional to the
    /// number of bytes, whatever they claim.
    ///
    /// A truncated file, one with something after its end, and one with any single byte changed are errors.
    ///
    /// # Errors
    /// [`DecodeError`], with section and byte offset.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, DecodeError> {
        let (minor, found) = container::read(bytes)?;
        let sections = Sections { found, len: bytes.len() as u64 };
        let (dimension, mut cells) = read(sections.need(CELLS)?, cells)?;
        let d = usize::from(dimension);
        if let Some(section) = sections.find(POLYGONS) {
            read(section, |r| polygons(r, &mut cells))?;
        }
        let portals = sections.find(PORTALS).map_or(Ok(Vec::new()), |s| read(s, |r| portals(r, d)))?;
        let objects = read(sections.need(OBJECTS)?, |r| objects(r, d))?;
        let seen = sections.find(SEEN).map(|s| read(s, |r| r.rows(cells.len(), objects.len())));
        let mirrors = sections.find(MIRRORS).map_or(Ok(Vec::new()), |s| read(s, |r| mirrors(r, d)))?;
        let polygons_of = |s| read(s, |r: &mut Reader<'_>| r.u32s(objects.len() as u64));
        let object_polygons = sections.find(OBJECT_POLYGONS).map_or(Ok(Vec::new()), polygons_of)?;
        let sources_of = |s| read(s, |r: &mut Reader<'_>| doors::read_sources(r, objects.len()));
        let object_sources = sections.find(SOURCES).map_or(Ok(Vec::new()), sources_of)?;
        let names_of = |s| read(s, |r: &mut Reader<'_>| cell_names(r, cells.len()));
        let cell_names = sections.find(CELL_NAMES).map_or(Ok(Vec::new()), names_of)?;
        // Stab trees refer to the portals of cells, so these cells must exist.
        if let (Some(_), Some(error)) = (sections.find(STAB), unknown_cell(&portals, cells.len())) {
            return Err(sections.blame(error));
        }
        let stab = sections.find(STAB).map(|s| read(s, |r| stab::parse(r, &portals, cells.len()))).transpose()?;
        let info = read(sections.need(INFO)?, info)?;
        let (kind, up) = match sections.find(KIND) {
            Some(section) => read(section, |r| kind(r, minor > MINOR))?,
            None => kind_from_info(dimension, &info),
        };
        let parts = TableParts {
            kind,
            up,
            frame: sections.find(FRAME).map(|s| read(s, frame)).transpose()?,
            digest: sections.find(DIGEST).map(|s| read(s, digest)).transpose()?,
            mirrors,
            object_polygons,
            object_parts: sections
                .find(OBJECT_PARTS)
                .map(|s| read(s, |r| object_parts::read(r, cells.len())))
                .transpose()?,
            object_sources,
            doors: sections.find(DOORS).map_or(Ok(Vec::new()), |s| read(s, doors::read))?,
            cell_names,
            planes: sections.find(PLANES).map(planes::parse).transpose()?,
            stab,
            dimension,
            portals,
            rows: read(sections.need(ROWS)?, |r| rows(r, cells.len()))?,
            locator: locator(sections.need(LOCATOR)?)?,
            objects_seen: seen.transpose()?,
            objects,
            cell_objects: read(sections.need(CELL_OBJECTS)?, |r| cell_objects(r, cells.len()))?,
            info,
            cells,
        };
        Self::new(parts).map_err(|error| sections.blame(error))
    }
}

struct Sections<'a> {
    found: Vec<Section<'a>>,
    len: u64,
}

impl<'a> Sections<'a> {
    fn find(&self, id: SectionId) -> Option<Section<'a>> {
        self.found.iter().find(|section| section.id == id).copied()
    }

    fn need(&self, id: SectionId) -> Result<Section<'a>, DecodeError> {
        self.find(id).ok_or(DecodeError { section: Some(id), offset: self.len, kind: Kind::Missing })
    }

    /// Adds the section of the defect.
    fn blame(&self, error: TableError) -> DecodeError {
        let id = section_of(&error);
        let offset = self.find(id).map_or(self.len, |section| section.offset as u64);
        DecodeError { section: Some(id), offset, kind: Kind::Table(error) }
    }
}

/// The first portal that leads to a cell that does not exist, as an error.
fn unknown_cell(portals: &[PortalRecord], n_cells: usize) -> Option<TableError> {
    let mut ends = portals.iter().enumerate().flat_map(|(i, portal)| portal.cells.map(|cell| (i, cell)));
    ends.find(|(_, cell)| cell.idx() >= n_cells).map(|(portal, cell)| TableError::PortalCell { portal, cell })
}

fn section_of(error: &TableError) -> SectionId {
    match error {
        TableError::TooMany { item, .. }
        | TableError::NotFinite { item, .. }
        | TableError::Inverted { item, .. }
        | TableError::OffPlane { item, .. } => match item {
            Item::Cell => CELLS,
            Item::Polygon => POLYGONS,
            Item::Portal => PORTALS,
            Item::Object => OBJECTS,
            Item::Mirror => MIRRORS,
            Item::Door => DOORS,
        },
        TableError::Dimension(_) => CELLS,
        TableError::Kind { .. } => KIND,
        TableError::Corners { .. } | TableError::NotConvex { .. } | TableError::OutsideBox { .. } => POLYGONS,
        TableError::PortalCell { .. } | TableError::PortalLoop { .. } | TableError::PortalPoints { .. } => PORTALS,
        TableError::RowsShape { .. }
        | TableError::RowTail(_)
        | TableError::NotReflexive(_)
        | TableError::NotSymmetric(_) => ROWS,
        TableError::CellObjects { .. } | TableError::ObjectOrder(_) | TableError::UnknownObject { .. } => CELL_OBJECTS,
        TableError::SeenShape { .. } | TableError::SeenTail(_) | TableError::Unseen { .. } => SEEN,
        TableError::ObjectPolygons { .. } => OBJECT_POLYGONS,
        TableError::ObjectSources { .. } | TableError::ObjectNode(_) => SOURCES,
        TableError::PartsAlone
        | TableError::PartsShape { .. }
        | TableError::PartsTail(_)
        | TableError::PartOrder(_)
        | TableError::PartObject { .. }
        | TableError::PartSeen { .. } => OBJECT_PARTS,
        TableError::DoorObject { .. } | TableError::DoorPortal { .. } | TableError::DoorOrder(_) => DOORS,
        TableError::CellNames { .. } => CELL_NAMES,
        TableError::MirrorCell { .. } | TableError::MirrorPoints { .. } => MIRRORS,
        TableError::Frame(_) => FRAME,
        TableError::Planes(_) => PLANES,
        TableError::Stab(_) => STAB,
        TableError::Locator(_) => LOCATOR,
        TableError::InfoOrder(_) | TableError::TooLong(_) => INFO,
    }
}

fn cells(r: &mut Reader<'_>) -> Result<(u8, Vec<CellRecord>), DecodeError> {
    let dimension = match r.u32()? {
        2 => 2u8,
        3 => 3,
        value => return Err(r.fail(4, Kind::Value { value })),
    };
    let d = usize::from(dimension);
    let n = r.count(16 * d + 8)?;
    let mut cells = Vec::with_capacity(n);
    for _ in 0..n {
        let (min, max) = (r.point(d)?, r.point(d)?);
        let group = match (r.u32()?, r.u32()?) {
            (0, 0) => None,
            (1, group) => Some(group),
            (0, value) => return Err(r.fail(4, Kind::Value { value })),
            (value, _) => return Err(r.fail(8, Kind::Value { value })),
        };
        cells.push(CellRecord { min, max, group, polygon: Vec::new() });
    }
    Ok((dimension, cells))
}

/// The lengths of `n` lists, with a check that as many items of `size` bytes follow.
fn lengths(r: &mut Reader<'_>, n: usize, size: usize) -> Result<Vec<u32>, DecodeError> {
    let lengths = r.u32s(n as u64)?;
    // At most 2^32 lengths below 2^32: the sum fits.
    r.expect(lengths.iter().map(|&n| u64::from(n)).sum(), size)?;
    Ok(lengths)
}

fn polygons(r: &mut Reader<'_>, cells: &mut [CellRecord]) -> Result<(), DecodeError> {
    let lengths = lengths(r, cells.len(), 16)?;
    for (cell, n) in cells.iter_mut().zip(lengths) {
        cell.polygon = (0..n).map(|_| Ok([r.f64()?, r.f64()?])).collect::<Result<_, _>>()?;
    }
    Ok(())
}

fn portals(r: &mut Reader<'_>, d: usize) -> Result<Vec<PortalRecord>, DecodeError> {
    let n = r.count(20)?;
    let mut portals = Vec::with_capacity(n);
    for _ in 0..n {
        let cells = [CellId(r.u32()?), CellId(r.u32()?)];
        let sides = [r.u32()?, r.u32()?];
        let n_points = r.count(8 * d)?;
        let points = (0..n_points).map(|_| r.point(d)).collect::<Result<_, _>>()?;
        portals.push(PortalRecord { cells, sides, points });
    }
    Ok(portals)
}

fn mirrors(r: &mut Reader<'_>, d: usize) -> Result<Vec<MirrorRecord>, DecodeError> {
    let n = r.count(12)?;
    let mut mirrors = Vec::with_capacity(n);
    for _ in 0..n {
        let (cell, mirror) = (CellId(r.u32()?), MirrorId(r.u32()?));
        let n_points = r.count(8 * d)?;
        let points = (0..n_points).map(|_| r.point(d)).collect::<Result<_, _>>()?;
        mirrors.push(MirrorRecord { cell, mirror, points });
    }
    Ok(mirrors)
}

fn rows(r: &mut Reader<'_>, n: usize) -> Result<BitMatrix, DecodeError> {
    r.expect(n_row_words(n as u64), 8)?;
    let mut rows = BitMatrix::new(n, n);
    for i in 0..n {
        let (last, bits) = (i / 64, i % 64);
        let words = &mut rows.row_mut(i)[..=last];
        for word in &mut *words {
            *word = r.u64()?;
        }
        if words[last] & !(u64::MAX >> (63 - bits)) != 0 {
            return Err(r.fail(8, Kind::PastDiagonal { row: i as u32 }));
        }
    }
    rows.mirror_lower();
    Ok(rows)
}

fn locator(section: Section<'_>) -> Result<Locator, DecodeError> {
    let (nodes, cells) = read(section, locator_parts)?;
    let whole = Reader::new(section);
    Locator::from_raw(nodes, cells).map_err(|error| whole.fail(0, Kind::Table(TableError::Locator(error))))
}

fn locator_parts(r: &mut Reader<'_>) -> Result<(Vec<Node>, Vec<CellId>), DecodeError> {
    let (n_nodes, n_cells) = (r.u32()?, r.u32()?);
    r.expect(16 * u64::from(n_nodes) + 4 * u64::from(n_cells), 1)?;
    let mut nodes = Vec::with_capacity(n_nodes as usize);
    let mut start = 0u32;
    for node in 0..n_nodes as usize {
        let (tag, second, rest) = (r.u32()?, r.u32()?, r.u64()?);
        nodes.push(if tag == LEAF {
            if rest != 0 {
                return Err(r.fail(8, Kind::NotZero));
            }
            let too_many = || Kind::Table(TableError::Locator(LocatorError::Order { node }));
            let end = start.checked_add(second).filter(|&end| end <= n_cells);
            let leaf = Node::Leaf { start, end: end.ok_or_else(|| r.fail(12, too_many()))? };
            start += second;
            leaf
        } else {
            let axis = u8::try_from(tag).map_err(|_| r.fail(16, Kind::Value { value: tag }))?;
            Node::Inner { axis, split: f64::from_bits(rest), high: second }
        });
    }
    let cells = r.u32s(u64::from(n_cells))?.into_iter().map(CellId).collect();
    Ok((nodes, cells))
}

fn objects(r: &mut Reader<'_>, d: usize) -> Result<Vec<ObjectRecord>, DecodeError> {
    let n = r.count(16 * d + 4)?;
    let mut objects = Vec::with_capacity(n);
    for _ in 0..n {
        let (min, max) = (r.point(d)?, r.point(d)?);
        objects.push(ObjectRecord { name: r.text()?, min, max });
    }
    Ok(objects)
}

fn cell_objects(r: &mut Reader<'_>, n: usize) -> Result<Vec<Vec<ObjectId>>, DecodeError> {
    let ids = |list: Vec<u32>| list.into_iter().map(ObjectId).collect();
    lengths(r, n, 4)?.into_iter().map(|n| r.u32s(u64::from(n)).map(ids)).collect()
}

fn cell_names(r: &mut Reader<'_>, n: usize) -> Result<Vec<String>, DecodeError> {
    // Each takes at least four bytes, so memory is allocated for no more names than there can be.
    r.expect(n as u64, 4)?;
    (0..n).map(|_| r.text()).collect()
}

/// Kind and upward axis; a file of a later minor version may have values that are unknown here.
fn kind(r: &mut Reader<'_>, is_later: bool) -> Result<(TableKind, Option<Axis>), DecodeError> {
    let bytes = r.take(KIND_LEN)?;
    match kind_from_bytes(array(bytes, 0)) {
        Err(_) if is_later => Ok((TableKind::Unspecified, None)),
        Err(value) => Err(r.fail(KIND_LEN, Kind::Value { value })),
        Ok(known) => Ok(known),
    }
}

fn frame(r: &mut Reader<'_>) -> Result<Frame, DecodeError> {
    let bytes = r.take(FRAME_LEN)?;
    let wrong = |error| r.fail(FRAME_LEN, Kind::Table(TableError::Frame(error)));
    Frame::from_bytes(&array(bytes, 0)).map_err(wrong)
}

fn digest(r: &mut Reader<'_>) -> Result<GeometryDigest, DecodeError> {
    Ok(GeometryDigest::from_bytes(&array(r.take(DIGEST_LEN)?, 0)))
}

fn info(r: &mut Reader<'_>) -> Result<Vec<(String, String)>, DecodeError> {
    let n = r.count(8)?;
    let mut info = Vec::with_capacity(n);
    for _ in 0..n {
        info.push((r.text()?, r.text()?));
    }
    Ok(info)
}
