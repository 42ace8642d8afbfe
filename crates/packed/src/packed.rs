//! An opened file and its queries.

use crate::bytes::{Origin, Reader, u32_at, u64_at};
use crate::cache::{Block, Cache, PackedStats};
use crate::container::ResidentPart;
use crate::doors::{self, Sources};
use crate::error::{PackedError, PackedErrorKind as Kind};
use crate::facts;
use crate::format::{self, HAS_SEEN, HEAD_LEN, NONE, SizeClass};
use crate::index::{Index, Spot, StoreIndex};
use crate::locate::{PointLocation, planes};
use crate::masks;
use crate::pages::Pages;
use crate::rows::{DenseRows, Rows};
use crate::source::ByteSource;
use sightlines_pvs::{
    Axis, CellId, DoorRecord, Frame, GeometryDigest, MirrorRecord, ObjectPart, PlaneTree, SectionId, TableKind,
};
use std::ops::Range;
use std::sync::Arc;

/// A packed table that is read piece by piece within a memory budget.
///
/// The resident part is read when the file is opened; rows, exits and objects are read on demand, in blocks that are
/// kept until others need their space. Of a large file boxes and locator are read on demand too: see
/// [`SizeClass`]. Any number of threads may query it at once.
#[derive(Debug)]
pub struct Packed<S: ByteSource> {
    pub(crate) source: S,
    pub(crate) resident: ResidentPart,
    pub(crate) index: Index,
    pub(crate) head: Head,
    pub(crate) places: Places,
    pub(crate) planes: Option<PlaneTree>,
    info: Vec<(String, String)>,
    kind: TableKind,
    frame: Option<Frame>,
    digest: Option<GeometryDigest>,
    up: Option<Axis>,
    mirrors: Vec<MirrorRecord>,
    pub(crate) doors: Vec<DoorRecord>,
    pub(crate) sources: Sources,
    pub(crate) rows: Rows,
    pub(crate) seen: Option<Rows>,
    /// The parts of objects, with what cells see of them.
    pub(crate) parts: Option<(Vec<ObjectPart>, Rows)>,
    pub(crate) cells: StoreIndex,
    pub(crate) portals: StoreIndex,
    pub(crate) objects: StoreIndex,
    pub(crate) nodes: Option<StoreIndex>,
    pub(crate) names: Option<StoreIndex>,
    cache: Cache,
}

/// How points are located.
#[derive(Debug)]
pub(crate) enum Places {
    /// In the resident part, of a small file.
    Resident(PointLocation),
    /// In blocks, of a large file.
    Paged(Pages),
}

/// The fields of `HEAD`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Head {
    pub(crate) dimension: u8,
    pub(crate) n_cells: u32,
    pub(crate) n_objects: u32,
    pub(crate) n_portals: u32,
    pub(crate) n_nodes: Option<u32>,
    pub(crate) flags: u32,
    codings: [u32; 2],
    pub(crate) page: u32,
    n_classes: [u32; 3],
}

impl Head {
    fn read(resident: &ResidentPart) -> Result<Self, PackedError> {
        let section = resident.need(format::HEAD)?;
        section.expect(HEAD_LEN as u64)?;
        let field = |k: usize| u32_at(section.bytes, 4 * k);
        let head = Self {
            dimension: if field(0) == 2 { 2 } else { 3 },
            n_cells: field(1),
            n_objects: field(2),
            n_portals: field(3),
            n_nodes: (field(4) != NONE).then_some(field(4)),
            flags: field(5),
            codings: [field(6), field(7)],
            page: field(8),
            n_classes: [field(9), field(10), field(11)],
        };
        let wrong = [(field(0), matches!(field(0), 2 | 3)), (head.flags, head.flags < 4), (head.page, head.page > 0)];
        match wrong.iter().find(|(_, right)| !right) {
            Some(&(value, _)) => Err(section.place.fail(Kind::Value { value: u64::from(value) })),
            None => Ok(head),
        }
    }

    pub(crate) fn n_pages(&self) -> usize {
        self.n_cells.div_ceil(self.page) as usize
    }
}

impl<S: ByteSource> Packed<S> {
    /// Opens a file: reads and checks the resident part. At most `cache_bytes` of unpacked blocks will be kept; with 0
    /// every query reads its blocks anew.
    ///
    /// Memory is proportional to the resident part, whatever it claims; numbers of objects and the like are bounded by
    /// the content of the unpacked blocks. The content of blocks is checked when it is read; [`Packed::verify`] checks
    /// everything. O(resident part).
    ///
    /// # Errors
    /// [`PackedError`], with section and byte offset.
    pub fn open(source: S, cache_bytes: usize) -> Result<Self, PackedError> {
        let (resident, len) = ResidentPart::read(&source)?;
        let head = Head::read(&resident)?;
        let index = Index::read(&resident, len)?;
        let Head { n_cells, n_objects, codings, n_classes, .. } = head;
        let d = usize::from(head.dimension);
        let places = match resident.class() {
            SizeClass::Small => Places::Resident(PointLocation::read(&resident, d, n_cells)?),
            SizeClass::Large => Places::Paged(Pages::read(&resident, &index, d, n_cells)?),
        };
        let sections = [format::CLASSES; 2];
        let n = [n_cells, n_cells, n_classes[0], n_classes[0]];
        let rows = Rows::read(&resident, &index, (format::ROWS, codings[0]), sections, n)?;
        let seen = if head.flags & HAS_SEEN == 0 {
            None
        } else {
            let sections = [format::SEEN_ROWS, format::SEEN_COLUMNS];
            let n = [n_cells, n_objects, n_classes[1], n_classes[2]];
            Some(Rows::read(&resident, &index, (format::SEEN, codings[1]), sections, n)?)
        };
        let parts = doors::object_parts(&resident, n_objects)?.map(|parts| {
            let (id, n_items) = (format::PARTS_SEEN, parts.len() as u32);
            Ok::<_, PackedError>((parts, Rows::Masks { id, store: index.need_records(id, n_cells)?, n_items }))
        });
        let parts = parts.transpose()?;
        let n_pages = head.n_pages() as u64;
        resident.need(format::COARSE)?.expect(n_pages * n_pages.div_ceil(64) * 8)?;
        let cache = Cache::new(index.entries.len(), cache_bytes);
        cache.count_read(resident.end());
        let info = facts::info(&resident)?;
        let (kind, up) = facts::kind(&resident, head.dimension, &info)?;
        Ok(Self {
            info,
            kind,
            frame: facts::frame(&resident, head.dimension)?,
            digest: facts::digest(&resident)?,
            up,
            mirrors: facts::mirrors(&resident, (head.dimension, n_cells))?,
            doors: doors::read(&resident, [n_objects, head.n_portals])?,
            sources: Sources::read(&resident, n_objects)?,
            rows,
            seen,
            parts,
            cells: index.need_records(format::CELLS, n_cells)?,
            portals: index.need_records(format::PORTALS, head.n_portals)?,
            objects: index.need_records(format::OBJECTS, n_objects)?,
            nodes: head.n_nodes.map(|n| index.need_records(format::STAB, n)).transpose()?,
            names: index
                .has(format::CELL_NAMES)
                .then(|| index.need_records(format::CELL_NAMES, n_cells))
                .transpose()?,
            planes: resident.find(format::PLANES).map(|section| planes(section, d, n_cells)).transpose()?,
            places,
            cache,
            head,
            index,
            resident,
            source,
        })
    }

    /// Number of cells; ids are below it.
    pub fn n_cells(&self) -> usize {
        self.head.n_cells as usize
    }

    /// Number of objects; ids are below it.
    pub fn n_objects(&self) -> usize {
        self.head.n_objects as usize
    }

    /// Number of portals; ids are below it.
    pub fn n_portals(&self) -> usize {
        self.head.n_portals as usize
    }

    /// The size class of the file: what of it is in memory, and what is read on demand.
    pub fn size_class(&self) -> SizeClass {
        self.resident.class()
    }

    /// 2 for a plane, 3 for space.
    pub fn dimension(&self) -> u8 {
        self.head.dimension
    }

    /// What was cut into cells, and how.
    pub fn kind(&self) -> TableKind {
        self.kind
    }

    /// The axis that points up, in its positive direction; `None` if it is not known.
    pub fn up(&self) -> Option<Axis> {
        self.up
    }

    /// Digests of what the table was made of, as [`sightlines_pvs::Table::digest`].
    pub const fn digest(&self) -> Option<GeometryDigest> {
        self.digest
    }

    /// The axes along which the coordinates of the table are, as [`sightlines_pvs::Table::frame`].
    pub fn frame(&self) -> Option<&Frame> {
        self.frame.as_ref()
    }

    /// Whether cells can be found at points, as [`sightlines_pvs::Table::has_places`].
    pub fn has_places(&self) -> bool {
        !self.kind.is_quake() || self.planes().is_some()
    }

    /// Free keys and values of the table, for people.
    pub fn info(&self) -> &[(String, String)] {
        &self.info
    }

    /// The parts of mirrors, in the order of the table.
    pub fn mirrors(&self) -> &[MirrorRecord] {
        &self.mirrors
    }

    /// Size of the unpacked blocks in memory, including their bookkeeping, in bytes; never more than the budget.
    ///
    /// In addition, each query in progress holds the blocks that it reads.
    pub fn bytes_in_use(&self) -> usize {
        self.cache.bytes()
    }

    /// The budget for kept blocks.
    pub fn cache_bytes(&self) -> usize {
        self.cache.budget()
    }

    /// Size of the resident part in the file, in bytes; it stays in memory.
    pub fn resident_bytes(&self) -> usize {
        self.resident.bytes().len()
    }

    /// Counters of what was read so far.
    pub fn stats(&self) -> PackedStats {
        self.cache.stats()
    }

    pub(crate) fn check_cell(&self, cell: CellId) -> Result<(), PackedError> {
        let n_cells = self.head.n_cells;
        if cell.0 < n_cells { Ok(()) } else { Err(PackedError::asked(Kind::NoCell { cell, n_cells })) }
    }

    /// The block with a number, from memory or newly read.
    fn block(
        &self,
        id: SectionId,
        number: usize,
        decode: impl FnOnce(Vec<u8>) -> Result<Block, PackedError>,
    ) -> Result<Arc<Block>, PackedError> {
        if let Some(block) = self.cache.get(number) {
            return Ok(block);
        }
        let block = Arc::new(decode(self.index.unpack(&self.source, id, number)?)?);
        self.cache.count_read(u64::from(self.index.entries[number].len));
        self.cache.put(number, &block);
        Ok(block)
    }

    /// Calls `visit` with the row of a class in a store of rows.
    fn with_row<T>(&self, rows: &DenseRows, cell: CellId, visit: impl FnOnce(&[u64]) -> T) -> Result<T, PackedError> {
        let class = rows.row_of.as_ref().map_or(cell.0, |of| of[cell.idx()]);
        let Spot { number, k, .. } = rows.store.find(class);
        let kept = self.block(rows.id, number, |bytes| Ok(Block::Words(rows.decode(&bytes))))?;
        match &*kept {
            Block::Words(words) => Ok(visit(&words[k * rows.stride()..(k + 1) * rows.stride()])),
            Block::Bytes(_) => unreachable!("blocks of rows are kept as words"),
        }
    }

    /// Puts the items in the row of a cell into `out`, which is cleared, ascending.
    pub(crate) fn items<T>(
        &self,
        rows: &Rows,
        cell: CellId,
        out: &mut Vec<T>,
        item: impl Fn(u32) -> T,
    ) -> Result<(), PackedError> {
        out.clear();
        self.check_cell(cell)?;
        match rows {
            Rows::Dense(rows) => self.with_row(rows, cell, |row| rows.expand(row, out, item)),
            Rows::Masks { id, store, n_items } => self.with_record((*id, store), cell.0, |mut r| {
                let read = masks::decode(&mut r, *n_items, |i| out.push(item(i)));
                // Half a row would hide things.
                read.inspect_err(|_| out.clear())
            }),
        }
    }

    /// Calls `visit` with a record, which must exist in the store.
    pub(crate) fn with_record<T>(
        &self,
        (id, store): (SectionId, &StoreIndex),
        record: u32,
        visit: impl FnOnce(Reader<'_>) -> Result<T, PackedError>,
    ) -> Result<T, PackedError> {
        let Spot { number, k, n } = store.find(record);
        let kept = self.block(id, number, |bytes| Ok(Block::Bytes(bytes)))?;
        let place = Origin { section: id, offset: self.index.entries[number].offset };
        let Block::Bytes(bytes) = &*kept else { unreachable!("blocks of records are kept as bytes") };
        visit(Reader::new(record_of(bytes, k, n, place)?, place))
    }

    /// As [`Packed::with_record`], with all records of a block checked when it is read: then `visit` may rely on that.
    pub(crate) fn with_checked_record<T>(
        &self,
        (id, store): (SectionId, &StoreIndex),
        record: u32,
        check: impl Fn(&[u8], Origin) -> Result<(), PackedError>,
        visit: impl FnOnce(&[u8]) -> T,
    ) -> Result<T, PackedError> {
        let Spot { number, k, n } = store.find(record);
        let place = Origin { section: id, offset: self.index.entries[number].offset };
        let decode = |bytes: Vec<u8>| {
            (0..n).try_for_each(|k| check(record_of(&bytes, k, n, place)?, place))?;
            Ok(Block::Bytes(bytes))
        };
        let kept = self.block(id, number, decode)?;
        let Block::Bytes(bytes) = &*kept else { unreachable!("blocks of records are kept as bytes") };
        Ok(visit(record_of(bytes, k, n, place)?))
    }

    /// Calls `visit` with records in turn, until it returns `false`; each block is read once, and none is kept.
    pub(crate) fn for_each_record(
        &self,
        (id, store): (SectionId, &StoreIndex),
        records: Range<u32>,
        mut visit: impl FnMut(u32, Reader<'_>) -> Result<bool, PackedError>,
    ) -> Result<(), PackedError> {
        let mut record = records.start;
        while record < records.end {
            let Spot { number, k, n } = store.find(record);
            let place = Origin { section: id, offset: self.index.entries[number].offset };
            let bytes = self.index.unpack(&self.source, id, number)?;
            for k in k..n {
                if record == records.end || !visit(record, Reader::new(record_of(&bytes, k, n, place)?, place))? {
                    return Ok(());
                }
                record += 1;
            }
        }
        Ok(())
    }

    /// Puts the cells of the pages that the page of `cell` sees into `out`, which is cleared, ascending.
    ///
    /// A superset of [`Packed::visible`] that is always in memory: what to draw until the row has been read.
    /// O(result).
    ///
    /// # Errors
    /// If there is no such cell.
    pub fn coarse(&self, cell: CellId, out: &mut Vec<CellId>) -> Result<(), PackedError> {
        out.clear();
        self.check_cell(cell)?;
        let (page, n_pages) = (self.head.page, self.head.n_pages());
        for other in (0..n_pages).filter(|&other| self.page_sees((cell.0 / page) as usize, other)) {
            let first = other as u32 * page;
            out.extend((first..self.head.n_cells.min(first.saturating_add(page))).map(CellId));
        }
        Ok(())
    }

    /// Whether some cell of a page sees some cell of another; both must exist.
    #[inline]
    pub(crate) fn page_sees(&self, page: usize, other: usize) -> bool {
        let stride = self.head.n_pages().div_ceil(64);
        let start = self.resident.range(format::COARSE).map_or(0, |range| range.start);
        let word = u64_at(self.resident.bytes(), start + 8 * (page * stride + other / 64));
        word >> (other % 64) & 1 == 1
    }
}

/// Record `k` of the `n` in a block.
fn record_of(bytes: &[u8], k: usize, n: usize, place: Origin) -> Result<&[u8], PackedError> {
    let content = 4 * n;
    let ends = bytes.get(..content).ok_or_else(|| place.fail(Kind::Cut))?;
    let begin = if k == 0 { 0 } else { u32_at(ends, 4 * (k - 1)) as usize };
    bytes[content..].get(begin..u32_at(ends, 4 * k) as usize).ok_or_else(|| place.fail(Kind::Cut))
}
