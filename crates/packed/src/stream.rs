//! Large files, written row by row.

use crate::blocks::BlockWriter;
use crate::bytes::{Writer, bytes_of};
use crate::error::{PackError, StreamError};
use crate::format::{self, END, ENTRY, FIXED, MAGIC, MAJOR_LARGE, MASKS, OPTIONAL, SizeClass};
use crate::masks::{RowDefect, encode};
use crate::sections::{frame_sections, minor};
use crate::write;
use crate::write_pages::write_pages;
use sightlines_pvs::{BitMatrix, CellId, ObjectId, SectionId, TableError, TableParts};
use std::io::Write;

/// The result of packing.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct PackReport {
    /// Size of the file in bytes.
    pub bytes: u64,
    /// Size of the rows in it: the part that merging can reduce.
    pub row_bytes: u64,
    /// Number of distinct rows that are left; of a large file, which shares none, the number of cells.
    pub n_classes: usize,
    /// Number of merges of different classes of cells.
    pub n_merges: usize,
    /// The size class of the file.
    pub class: SizeClass,
}

/// Options for writing row by row.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct StreamOptions {
    /// Whether each row of cells has a row of objects beside it, as [`TableParts::objects_seen`]. Without them a cell sees the
    /// objects of all cells that it sees.
    pub objects_seen: bool,
}

/// Writes a table into a large file, one row after the other: for tables whose rows do not fit into memory as a square.
///
/// The bytes are those that [`crate::pack`] gives for the whole table in the large class, and nothing is read back: the
/// output may be a pipe. Memory: a few bytes for each block, one bit for each pair of pages of cells (at most half a
/// megabyte), and, with rows of objects, the lists of objects that touch cells.
///
/// Each row has to contain its own cell, and to be ascending; that rows are symmetric is for [`crate::Packed::verify`] to
/// check, or for the caller to guarantee.
///
/// ```
/// use sightlines_packed::{Packed, PackWriter, StreamOptions};
/// use sightlines_pvs::{CellId, CellRecord, Locator, TableKind, TableParts};
///
/// // A corridor of cells in a row, of which each sees its neighbours.
/// let n = 1000u32;
/// let cell = |i: u32| {
///     let x = f64::from(i);
///     CellRecord { min: [x, 0.0, 0.0], max: [x + 1.0, 1.0, 0.0], group: None, polygon: vec![] }
/// };
/// let mut parts = TableParts::empty(2, TableKind::Unspecified);
/// parts.cells = (0..n).map(cell).collect();
/// parts.locator = Locator::build(&parts.cell_bounds(), 2);
/// parts.cell_objects = vec![vec![]; 1000];
/// let mut writer = PackWriter::new(Vec::new(), &parts, &StreamOptions::default())?;
/// drop(parts); // No longer needed.
/// for i in 0..n {
///     let row: Vec<CellId> = (i.saturating_sub(1)..n.min(i + 2)).map(CellId).collect();
///     writer.push(&row, None)?;
/// }
/// let (bytes, _report) = writer.finish()?;
/// let packed = Packed::open(bytes, 1 << 20)?;
/// packed.verify()?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct PackWriter<W: Write> {
    blocks: BlockWriter<W>,
    /// Magic and versions, with zeros after them.
    fixed: [u8; FIXED],
    sections: Vec<(SectionId, Vec<u8>)>,
    n_cells: u32,
    n_objects: u32,
    page: u32,
    coarse: BitMatrix,
    rows: usize,
    seen: Option<Seen>,
    /// The cell whose row comes next.
    next: u32,
    scratch: Vec<u8>,
}

/// The rows of objects.
struct Seen {
    store: usize,
    /// The objects that touch each cell end here in the list.
    ends: Vec<usize>,
    touching: Vec<ObjectId>,
}

impl<W: Write> PackWriter<W> {
    /// Writes everything but the rows. `rows` and `objects_seen` of the parts are not looked at, and nothing of the parts is
    /// needed afterwards. O(size of the parts), except for the locator, O(entries * depth).
    ///
    /// # Errors
    /// [`StreamError`] if the parts are not valid, cannot be packed, or cannot be written.
    pub fn new(out: W, parts: &TableParts, options: &StreamOptions) -> Result<Self, StreamError> {
        parts.check_without_rows()?;
        parts.check_rows_of_parts()?;
        if parts.object_parts.is_some() && !options.objects_seen {
            return Err(TableError::PartsAlone.into());
        }
        Self::unchecked(out, parts, options)
    }

    /// As [`PackWriter::new`], for the parts of a table, which need no check.
    pub(crate) fn unchecked(out: W, parts: &TableParts, options: &StreamOptions) -> Result<Self, StreamError> {
        let [n_cells, n_objects, n_portals, n_nodes, flags] = write::counts(parts, options.objects_seen);
        let mut sections = frame_sections(parts);
        let page = format::page_size(parts.cells.len()) as u32;
        let mut head = Writer::default();
        let d = u32::from(parts.dimension);
        let fields = [d, n_cells, n_objects, n_portals, n_nodes, flags, MASKS, MASKS, page, 0, 0, 0];
        fields.into_iter().for_each(|x| head.u32(x));
        sections.push((format::HEAD, head.0));
        let mut fixed = Writer::default();
        fixed.0.extend(MAGIC);
        fixed.0.extend(MAJOR_LARGE.to_le_bytes());
        fixed.0.extend(minor(parts, &sections).to_le_bytes());
        fixed.0.resize(FIXED, 0);
        let mut blocks = BlockWriter::new(out, &fixed.0)?;
        let rows = blocks.store(format::ROWS);
        let seen = options.objects_seen.then(|| {
            let mut seen = Seen { store: blocks.store(format::SEEN), ends: Vec::new(), touching: Vec::new() };
            for objects in &parts.cell_objects {
                seen.touching.extend_from_slice(objects);
                seen.ends.push(seen.touching.len());
            }
            seen
        });
        blocks.all(format::CELLS, write::cells(parts))?;
        blocks.all(format::PORTALS, write::portals(parts))?;
        blocks.all(format::OBJECTS, write::objects(parts))?;
        if let Some(stab) = &parts.stab {
            blocks.all(format::STAB, write::nodes(stab))?;
        }
        if let Some(of_objects) = &parts.object_parts {
            blocks.all(format::PARTS_SEEN, write::parts_seen(of_objects))?;
        }
        if !parts.cell_names.is_empty() {
            blocks.all(format::CELL_NAMES, write::cell_names(parts))?;
        }
        let top = write_pages(&mut blocks, parts)?;
        sections.push((format::LOCATOR_TOP, top));
        let n_pages = parts.cells.len().div_ceil(page as usize);
        let mut first = [0; FIXED];
        first.copy_from_slice(&fixed.0);
        Ok(Self {
            blocks,
            fixed: first,
            sections,
            n_cells,
            n_objects,
            page,
            coarse: BitMatrix::new(n_pages, n_pages),
            rows,
            seen,
            next: 0,
            scratch: Vec::new(),
        })
    }

    /// Writes the rows of the next cell: the cells that it sees, itself included, ascending; and the objects that it sees,
    /// ascending, among them those that touch it, if and only if there are rows of objects. O(row).
    ///
    /// # Errors
    /// [`StreamError`] if a row is not valid, or cannot be written; then the file is of no use.
    pub fn push(&mut self, cells: &[CellId], objects: Option<&[ObjectId]>) -> Result<(), StreamError> {
        let cell = CellId(self.next);
        if self.next >= self.n_cells {
            return Err(StreamError::NumberOfRows { n_rows: u64::from(self.next) + 1, n_cells: self.n_cells });
        }
        self.scratch.clear();
        let defect = |defect| match defect {
            RowDefect::TooLarge => StreamError::Unknown { cell },
            RowDefect::Order => StreamError::Order { cell },
        };
        encode(cells.iter().map(|other| other.0), self.n_cells, &mut self.scratch).map_err(defect)?;
        if cells.binary_search(&cell).is_err() {
            return Err(StreamError::NotReflexive { cell });
        }
        let page = (cell.0 / self.page) as usize;
        let mut last = usize::MAX;
        for other in cells {
            let other = (other.0 / self.page) as usize;
            if other != last {
                self.coarse.set(page, other, true);
                last = other;
            }
        }
        self.blocks.push(self.rows, &self.scratch)?;
        match (&self.seen, objects) {
            (None, None) => {}
            (Some(seen), Some(objects)) => {
                self.scratch.clear();
                encode(objects.iter().map(|object| object.0), self.n_objects, &mut self.scratch).map_err(defect)?;
                let begin = cell.idx().checked_sub(1).map_or(0, |before| seen.ends[before]);
                let touching = &seen.touching[begin..seen.ends[cell.idx()]];
                if let Some(&object) = touching.iter().find(|object| objects.binary_search(object).is_err()) {
                    return Err(StreamError::Unseen { cell, object });
                }
                self.blocks.push(seen.store, &self.scratch)?;
            }
            (seen, _) => return Err(StreamError::RowOfObjects { cell, expected: seen.is_some() }),
        }
        self.next += 1;
        Ok(())
    }

    /// Writes what follows the rows; gives the output back, flushed, and a report. O(blocks).
    ///
    /// # Errors
    /// [`StreamError`] if there are fewer rows than cells, or if something cannot be written.
    pub fn finish(mut self) -> Result<(W, PackReport), StreamError> {
        if self.next != self.n_cells {
            return Err(StreamError::NumberOfRows { n_rows: u64::from(self.next), n_cells: self.n_cells });
        }
        let n_pages = self.coarse.n_rows();
        self.sections.push((format::COARSE, (0..n_pages).flat_map(|p| bytes_of(self.coarse.row(p))).collect()));
        let (mut out, mut at, blocks, bytes_of_stores) = self.blocks.finish()?;
        self.sections.push((format::BLOCKS, blocks));
        let base = at;
        let mut table = Writer::default();
        let ordered = format::SECTIONS.iter().filter_map(|(id, optional)| {
            self.sections.iter().find(|(own, _)| own == id).map(|(_, bytes)| (*id, *optional, bytes))
        });
        for (id, optional, bytes) in ordered {
            table.0.extend(id.0);
            table.u32(if optional { OPTIONAL } else { 0 });
            table.u64(at);
            table.u32(u32::try_from(bytes.len()).map_err(|_| PackError::TooMany { store: id })?);
            table.u32(crc32fast::hash(bytes));
            out.write_all(bytes)?;
            at += bytes.len() as u64;
        }
        let n_sections = (table.0.len() / ENTRY) as u32;
        let total = at + table.0.len() as u64 + format::TAIL as u64;
        let mut tail = Writer::default();
        tail.u64(base);
        tail.u64(total);
        tail.u32(n_sections);
        let mut crc = crc32fast::Hasher::new();
        crc.update(&self.fixed);
        crc.update(&table.0);
        crc.update(&tail.0);
        tail.u32(crc.finalize());
        tail.0.extend(END);
        out.write_all(&table.0)?;
        out.write_all(&tail.0)?;
        out.flush()?;
        let row_bytes = bytes_of_stores[self.rows] + self.seen.as_ref().map_or(0, |seen| bytes_of_stores[seen.store]);
        let n_classes = self.n_cells as usize;
        Ok((out, PackReport { bytes: total, row_bytes, n_classes, n_merges: 0, class: SizeClass::Large }))
    }
}

impl<W: Write> std::fmt::Debug for PackWriter<W> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("PackWriter").field("n_cells", &self.n_cells).field("next", &self.next).finish_non_exhaustive()
    }
}
