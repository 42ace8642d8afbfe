//! An opened file and its queries.

use crate::bytes::{Place, Reader, u32_at, u64_at, words_of};
use crate::cache::{Block, Cache, PackedStats};
use crate::classes::Members;
use crate::container::{Index, ResidentPart, StoreIndex};
use crate::doors::{self, Sources};
use crate::error::{PackedError, PackedErrorKind as Kind};
use crate::format::{self, HAS_SEEN, HEAD_LEN, MAX_UNPACKED_BLOCK, NONE};
use crate::locate::PointLocation;
use crate::source::Source;
use sightlines_pvs::bits::ones;
use sightlines_pvs::format::{kind_from_bytes, kind_from_info};
use sightlines_pvs::{
    Axis, CellId, DoorRecord, Frame, FrameError, GeometryDigest, MirrorId, MirrorRecord, SectionId, TableKind,
};
use std::sync::Arc;

/// A packed table that is read piece by piece within a memory budget.
///
/// The resident part is read when the file is opened; rows, exits and objects are read on demand, in blocks that are
/// kept until others need their space. Any number of threads may query it at once.
#[derive(Debug)]
pub struct Packed<S: Source> {
    pub(crate) source: S,
    pub(crate) resident: ResidentPart,
    pub(crate) index: Index,
    pub(crate) head: Head,
    pub(crate) places: PointLocation,
    info: Vec<(String, String)>,
    kind: TableKind,
    frame: Option<Frame>,
    digest: Option<GeometryDigest>,
    up: Option<Axis>,
    mirrors: Vec<MirrorRecord>,
    pub(crate) doors: Vec<DoorRecord>,
    pub(crate) sources: Sources,
    pub(crate) rows: RowStore,
    pub(crate) seen: Option<RowStore>,
    pub(crate) cells: StoreIndex,
    pub(crate) portals: StoreIndex,
    pub(crate) objects: StoreIndex,
    pub(crate) nodes: Option<StoreIndex>,
    pub(crate) names: Option<StoreIndex>,
    cache: Cache,
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

/// A store of rows of bits between classes.
#[derive(Debug)]
pub(crate) struct RowStore {
    id: SectionId,
    store: StoreIndex,
    n_columns: usize,
    /// The class of each cell; `None` if each is its own class.
    row_of: Option<Vec<u32>>,
    /// The members of the classes of columns; `None` if each is its own class.
    columns: Option<Members>,
    n_items: usize,
}

impl RowStore {
    /// `sections` are those of the classes of rows and of columns, `n` the numbers of rows, items, row classes and
    /// column classes.
    fn read(
        resident: &ResidentPart,
        index: &Index,
        (id, coding): (SectionId, u32),
        sections: [SectionId; 2],
        n: [u32; 4],
    ) -> Result<Self, PackedError> {
        let [n_rows, n_items, n_row_classes, n_columns] = n;
        let store = index.need(id, n_row_classes)?;
        let offset = index.entries.get(store.first).map_or(0, |entry| entry.offset);
        let fail = |kind| PackedError::new(Some(id), offset, kind);
        if coding != format::DENSE {
            return Err(fail(Kind::Value { value: u64::from(coding) }));
        }
        let row_of = classes(resident, sections[0], n_rows, n_row_classes)?;
        let columns = classes(resident, sections[1], n_items, n_columns)?;
        let out = Self {
            id,
            store,
            n_columns: n_columns as usize,
            row_of,
            columns: columns.map(|of| Members::new(&of, n_columns as usize)),
            n_items: n_items as usize,
        };
        for block in 0..store.n_blocks {
            let needed = store.n_in_block(block) as u64 * 8 * out.stride() as u64;
            let found = u64::from(index.entries[store.first + block].raw);
            if needed != found {
                return Err(fail(Kind::Size { needed, found }));
            }
        }
        Ok(out)
    }

    fn stride(&self) -> usize {
        self.n_columns.div_ceil(64)
    }

    /// The rows of an unpacked block; bits past the last column are dropped.
    fn decode(&self, bytes: &[u8]) -> Vec<u64> {
        let mut words = words_of(bytes);
        let (stride, used) = (self.stride(), self.n_columns % 64);
        if used > 0 {
            words.chunks_exact_mut(stride).for_each(|row| row[stride - 1] &= !(u64::MAX << used));
        }
        words
    }

    /// Puts the items of the classes in a row into `out`, ascending.
    fn expand<T>(&self, row: &[u64], out: &mut Vec<T>, item: impl Fn(u32) -> T) {
        let Some(members) = &self.columns else {
            out.extend(ones(row).map(|i| item(i as u32)));
            return;
        };
        let mut set = vec![0u64; self.n_items.div_ceil(64)];
        for &i in ones(row).flat_map(|class| members.of(class)) {
            set[i as usize / 64] |= 1 << (i % 64);
        }
        out.extend(ones(&set).map(|i| item(i as u32)));
    }
}

/// The classes of `n` things, all below `n_classes`; `None` if each is its own class.
fn classes(resident: &ResidentPart, id: SectionId, n: u32, n_classes: u32) -> Result<Option<Vec<u32>>, PackedError> {
    let section = resident.need(id)?;
    if section.bytes.is_empty() && n == n_classes {
        return Ok(None);
    }
    let place = section.place;
    let raw = if section.bytes.len() < 4 { return Err(place.fail(Kind::Cut)) } else { u32_at(section.bytes, 0) };
    // Each takes at least one byte, so a file cannot claim more things than fit a block.
    if raw > MAX_UNPACKED_BLOCK || raw < n {
        return Err(place.fail(Kind::Value { value: u64::from(raw) }));
    }
    let bytes = zstd::bulk::decompress(&section.bytes[4..], raw as usize);
    let bytes =
        bytes.ok().filter(|bytes| bytes.len() == raw as usize).ok_or_else(|| place.fail(Kind::Unpack { raw }))?;
    let mut r = Reader::new(&bytes, place);
    let (mut of, mut next) = (Vec::with_capacity(n as usize), 0);
    for _ in 0..n {
        let back = r.below(u64::from(next) + 1)?;
        of.push(next - back);
        next = next.max(next - back + 1);
    }
    r.finish()?;
    if next == n_classes { Ok(Some(of)) } else { Err(place.fail(Kind::Value { value: u64::from(n_classes) })) }
}

impl<S: Source> Packed<S> {
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
        let places = PointLocation::read(&resident, usize::from(head.dimension), n_cells)?;
        let sections = [format::CLASSES; 2];
        let n = [n_cells, n_cells, n_classes[0], n_classes[0]];
        let rows = RowStore::read(&resident, &index, (format::ROWS, codings[0]), sections, n)?;
        let seen = if head.flags & HAS_SEEN == 0 {
            None
        } else {
            let sections = [format::SEEN_ROWS, format::SEEN_COLUMNS];
            let n = [n_cells, n_objects, n_classes[1], n_classes[2]];
            Some(RowStore::read(&resident, &index, (format::SEEN, codings[1]), sections, n)?)
        };
        let n_pages = head.n_pages() as u64;
        resident.need(format::COARSE)?.expect(n_pages * n_pages.div_ceil(64) * 8)?;
        let cache = Cache::new(index.entries.len(), cache_bytes);
        cache.count_read(resident.end());
        let info = info(&resident)?;
        let (kind, up) = kind(&resident, head.dimension, &info)?;
        Ok(Self {
            info,
            kind,
            frame: frame(&resident, head.dimension)?,
            digest: digest(&resident)?,
            up,
            mirrors: mirrors(&resident, &head)?,
            doors: doors::read(&resident, [n_objects, head.n_portals])?,
            sources: Sources::read(&resident, n_objects)?,
            rows,
            seen,
            cells: index.need_records(format::CELLS, n_cells)?,
            portals: index.need_records(format::PORTALS, head.n_portals)?,
            objects: index.need_records(format::OBJECTS, n_objects)?,
            nodes: head.n_nodes.map(|n| index.need_records(format::STAB, n)).transpose()?,
            names: index
                .has(format::CELL_NAMES)
                .then(|| index.need_records(format::CELL_NAMES, n_cells))
                .transpose()?,
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
        decode: impl FnOnce(Vec<u8>) -> Block,
    ) -> Result<Arc<Block>, PackedError> {
        if let Some(block) = self.cache.get(number) {
            return Ok(block);
        }
        let block = Arc::new(decode(self.index.unpack(&self.source, id, number)?));
        self.cache.count_read(u64::from(self.index.entries[number].len));
        self.cache.put(number, &block);
        Ok(block)
    }

    /// Calls `visit` with the row of a class in a store of rows.
    fn with_row<T>(&self, rows: &RowStore, cell: CellId, visit: impl FnOnce(&[u64]) -> T) -> Result<T, PackedError> {
        let class = rows.row_of.as_ref().map_or(cell.0, |of| of[cell.idx()]);
        let (block, row) = ((class / rows.store.per_block) as usize, (class % rows.store.per_block) as usize);
        let number = rows.store.first + block;
        let kept = self.block(rows.id, number, |bytes| Block::Words(rows.decode(&bytes)))?;
        match &*kept {
            Block::Words(words) => Ok(visit(&words[row * rows.stride()..(row + 1) * rows.stride()])),
            Block::Bytes(_) => unreachable!("blocks of rows are kept as words"),
        }
    }

    /// Puts the items in the row of a cell into `out`, which is cleared, ascending.
    pub(crate) fn items<T>(
        &self,
        rows: &RowStore,
        cell: CellId,
        out: &mut Vec<T>,
        item: impl Fn(u32) -> T,
    ) -> Result<(), PackedError> {
        out.clear();
        self.check_cell(cell)?;
        self.with_row(rows, cell, |row| rows.expand(row, out, item))
    }

    /// Calls `visit` with a record, which must exist in the store.
    pub(crate) fn with_record<T>(
        &self,
        (id, store): (SectionId, StoreIndex),
        record: u32,
        visit: impl FnOnce(Reader<'_>) -> Result<T, PackedError>,
    ) -> Result<T, PackedError> {
        let (block, k) = ((record / store.per_block) as usize, (record % store.per_block) as usize);
        let number = store.first + block;
        let kept = self.block(id, number, Block::Bytes)?;
        let place = Place { section: id, offset: self.index.entries[number].offset };
        let Block::Bytes(bytes) = &*kept else { unreachable!("blocks of records are kept as bytes") };
        let content = 4 * store.n_in_block(block);
        let ends = bytes.get(..content).ok_or_else(|| place.fail(Kind::Cut))?;
        let begin = if k == 0 { 0 } else { u32_at(ends, 4 * (k - 1)) as usize };
        let record = bytes[content..].get(begin..u32_at(ends, 4 * k) as usize).ok_or_else(|| place.fail(Kind::Cut))?;
        visit(Reader::new(record, place))
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

fn info(resident: &ResidentPart) -> Result<Vec<(String, String)>, PackedError> {
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
fn kind(
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

fn frame(resident: &ResidentPart, dimension: u8) -> Result<Option<Frame>, PackedError> {
    let Some(section) = resident.find(format::FRAME) else { return Ok(None) };
    let bytes = section.bytes.try_into().map_err(|_| section.place.fail(Kind::Cut))?;
    let read = if dimension == 3 { Frame::from_bytes(bytes) } else { Err(FrameError::Plane) };
    read.map(Some).map_err(|error| section.place.fail(Kind::Table(error.into())))
}

fn digest(resident: &ResidentPart) -> Result<Option<GeometryDigest>, PackedError> {
    let Some(section) = resident.find(format::DIGEST) else { return Ok(None) };
    let bytes = section.bytes.try_into().map_err(|_| section.place.fail(Kind::Cut))?;
    Ok(Some(GeometryDigest::from_bytes(bytes)))
}

fn mirrors(resident: &ResidentPart, head: &Head) -> Result<Vec<MirrorRecord>, PackedError> {
    let Some(section) = resident.find(format::MIRRORS) else { return Ok(Vec::new()) };
    let d = usize::from(head.dimension);
    let mut r = Reader::new(section.bytes, section.place);
    let n = r.count(3)?;
    let mut mirrors = Vec::new();
    for _ in 0..n {
        let (cell, mirror) = (CellId(r.below(u64::from(head.n_cells))?), MirrorId(r.below(1 << 32)?));
        let n_points = r.count(8 * d)?;
        let points = (0..n_points).map(|_| r.point(d)).collect::<Result<_, _>>()?;
        mirrors.push(MirrorRecord { cell, mirror, points });
    }
    r.finish()?;
    Ok(mirrors)
}
