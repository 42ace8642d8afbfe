//! From a table to bytes.

use crate::bytes::Writer;
use crate::classes::{Classes, Distinct, Members};
use crate::error::{PackError, StreamError};
use crate::format::{self, ENTRY, FIXED, MAGIC, MAJOR, MAX_SMALL_CELLS, OPTIONAL, SizeClass};
use crate::merge::{Sight, after, merge_order, merged};
use crate::sections::{frame_sections, minor};
use crate::store::Store;
use crate::stream::{PackReport, PackWriter, StreamOptions};
use crate::write;
use sightlines_pvs::{BitMatrix, CellId, ObjectId, SectionId, Table};

/// Options for packing.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct PackOptions {
    /// Largest size of the whole file, in bytes. If it is larger, cells are merged until it fits: merged cells see what
    /// any of them saw and are seen from where any of them was, so more is visible and nothing less. `None`: nothing is
    /// merged, and the table comes back exactly.
    pub max_bytes: Option<u64>,
    /// The size class of the file. `None`: large for more than [`MAX_SMALL_CELLS`] cells, else small.
    pub class: Option<SizeClass>,
}

/// Packs a table: same table and options, same bytes, on every machine.
///
/// In a small file equal rows and columns are stored once, and blocks of rows go through zstd. O(size); with a budget that needs
/// merging, also O(classes * ones of a row), and some ten times the packing of rows.
///
/// # Errors
/// [`PackError`] if a budget cannot be kept, or a record is larger than a block may be.
pub fn pack(table: &Table, options: &PackOptions) -> Result<Vec<u8>, PackError> {
    pack_report(table, options).map(|(bytes, _)| bytes)
}

/// Packs as [`pack`] does, and reports the result.
///
/// # Errors
/// As [`pack`].
pub fn pack_report(table: &Table, options: &PackOptions) -> Result<(Vec<u8>, PackReport), PackError> {
    let auto = if table.n_cells() > MAX_SMALL_CELLS { SizeClass::Large } else { SizeClass::Small };
    if options.class.unwrap_or(auto) == SizeClass::Large {
        return pack_large(table, options.max_bytes.unwrap_or(u64::MAX));
    }
    let frame = Frame::new(table)?;
    let exact = Visibility::new(table, None)?;
    let budget = options.max_bytes.unwrap_or(u64::MAX);
    if frame.len(&exact) <= budget {
        return Ok(frame.write(table, &exact, 0));
    }
    let whole = Whole::new(table);
    let order = merge_order(&whole.sight());
    let merge = |n: usize| {
        let merged = Visibility::new(table, Some((&whole, after(&order, n, whole.cells.n_rows()))))?;
        Ok((frame.len(&merged), merged))
    };
    let (n_merges, best) = fewest_merges(budget, frame.len(&exact), order.len(), merge)?;
    Ok(frame.write(table, &best, n_merges))
}

/// The fewest merges, of at most `all`, after which a file has at most `budget` bytes, and that file; `merge` gives the
/// size after a number of merges.
fn fewest_merges<T>(
    budget: u64,
    exact: u64,
    all: usize,
    merge: impl Fn(usize) -> Result<(u64, T), PackError>,
) -> Result<(usize, T), PackError> {
    // The last merges make the smallest table, or nearly: a table of one class has one row.
    let (smallest, mut best) = merge(all)?;
    if smallest > budget {
        return Err(PackError::Budget { budget, smallest: smallest.min(exact) });
    }
    let (mut enough, mut too_few) = (all, 0);
    while too_few + 1 < enough {
        let middle = usize::midpoint(too_few, enough);
        let (len, tried) = merge(middle)?;
        if len <= budget {
            (enough, best) = (middle, tried);
        } else {
            too_few = middle;
        }
    }
    Ok((enough, best))
}

/// Puts the cells and the objects that a cell sees into empty lists.
type RowOf<'a> = dyn Fn(CellId, &mut Vec<CellId>, &mut Vec<ObjectId>) + 'a;

/// Packs into a large file.
fn pack_large(table: &Table, budget: u64) -> Result<(Vec<u8>, PackReport), PackError> {
    let parts = table.parts();
    let cells = (0..table.n_cells()).map(|i| CellId(i as u32));
    let write = |row: &RowOf<'_>| {
        let options = StreamOptions { objects_seen: parts.objects_seen.is_some() };
        let unchecked = |error| match error {
            StreamError::Pack(error) => error,
            error => unreachable!("a table can be written to memory: {error}"),
        };
        let mut writer = PackWriter::unchecked(Vec::new(), parts, &options).map_err(unchecked)?;
        let (mut seen, mut objects) = (Vec::new(), Vec::new());
        for cell in cells.clone() {
            seen.clear();
            objects.clear();
            row(cell, &mut seen, &mut objects);
            let objects = options.objects_seen.then_some(&objects[..]);
            writer.push(&seen, objects).map_err(unchecked)?;
        }
        writer.finish().map_err(unchecked)
    };
    let (bytes, report) = write(&|cell, seen, objects| {
        seen.extend(table.visible(cell));
        let row = parts.objects_seen.iter().flat_map(|seen| seen.iter_ones(cell.idx()));
        objects.extend(row.map(|o| ObjectId(o as u32)));
    })?;
    if report.bytes <= budget {
        return Ok((bytes, report));
    }
    let whole = Whole::new(table);
    let order = merge_order(&whole.sight());
    let merge = |n: usize| {
        let (of, n_left) = after(&order, n, whole.cells.n_rows());
        let rows = merged(&whole.cells, &of, n_left, true);
        let seen = whole.objects.as_ref().map(|bits| merged(bits, &of, n_left, false));
        let of: Vec<u32> = whole.classes.of.iter().map(|&class| of[class as usize]).collect();
        let members = Members::new(&of, n_left);
        let (bytes, report) = write(&|cell, cells, objects| {
            let class = of[cell.idx()] as usize;
            cells.extend(rows.iter_ones(class).flat_map(|other| members.of(other)).map(|&cell| CellId(cell)));
            cells.sort_unstable();
            objects.extend(seen.iter().flat_map(|seen| seen.iter_ones(class)).map(|o| ObjectId(o as u32)));
        })?;
        Ok((report.bytes, (bytes, report)))
    };
    let (n_merges, (bytes, report)) = fewest_merges(budget, report.bytes, order.len(), merge)?;
    Ok((bytes, PackReport { n_merges, ..report }))
}

/// The classes of cells with equal visibility, to be merged.
struct Whole {
    classes: Classes,
    cells: BitMatrix,
    objects: Option<BitMatrix>,
    n_members: Vec<u64>,
    weights: Vec<u64>,
    object_weights: Vec<u64>,
}

impl Whole {
    fn new(table: &Table) -> Self {
        let parts = table.parts();
        let seen = parts.objects_seen.as_ref();
        let classes = Classes::of_keys((0..table.n_cells()).map(|i| (parts.rows.row(i), seen.map(|s| s.row(i)))));
        let n = classes.first.len();
        // Columns are equal where rows are; classes that differ only in their rows of objects are not merged here.
        let (mut n_members, mut weights) = (vec![0u64; n], vec![0u64; n]);
        let object_weights: Vec<u64> =
            (0..parts.objects.len() as u32).map(|o| u64::from(table.polygons_of(ObjectId(o))).max(1)).collect();
        for (i, &class) in classes.of.iter().enumerate() {
            let polygons = parts.cell_objects[i].iter().map(|&o| object_weights[o.idx()]).sum::<u64>();
            n_members[class as usize] += 1;
            weights[class as usize] = weights[class as usize].saturating_add(polygons.max(1));
        }
        let mut cells = BitMatrix::new(n, n);
        for (p, &i) in classes.first.iter().enumerate() {
            parts.rows.iter_ones(i as usize).for_each(|j| cells.set(p, classes.of[j] as usize, true));
        }
        let objects = seen.map(|seen| {
            let mut rows = BitMatrix::new(n, seen.n_cols());
            let first = classes.first.iter().enumerate();
            first.for_each(|(p, &i)| rows.row_mut(p).copy_from_slice(seen.row(i as usize)));
            rows
        });
        Self { classes, cells, objects, n_members, weights, object_weights }
    }

    fn sight(&self) -> Sight<'_> {
        Sight {
            cells: &self.cells,
            objects: self.objects.as_ref(),
            n_members: &self.n_members,
            weights: &self.weights,
            object_weights: &self.object_weights,
        }
    }
}

/// The packed visibility.
struct Visibility {
    /// Classes of cells by rows, by rows of objects, and of objects.
    n_classes: [u32; 3],
    sections: Vec<(SectionId, Vec<u8>)>,
    stores: Vec<Store>,
}

impl Visibility {
    /// Packs the table's rows, or those of merged classes.
    fn new(table: &Table, classes: Option<(&Whole, (Vec<u32>, usize))>) -> Result<Self, PackError> {
        let parts = table.parts();
        let (mut rows, mut seen) = match &classes {
            None => (Distinct::new(&parts.rows), parts.objects_seen.as_ref().map(Distinct::new)),
            Some((whole, (of, n_left))) => {
                let rows = Distinct::new(&merged(&whole.cells, of, *n_left, true));
                let seen = whole.objects.as_ref().map(|bits| Distinct::new(&merged(bits, of, *n_left, false)));
                (rows, seen)
            }
        };
        if let Some((whole, (of, _))) = &classes {
            // From merged classes back to cells.
            let to_cells = |classes: &Classes| {
                let of = whole.classes.of.iter().map(|&class| classes.of[of[class as usize] as usize]);
                Classes::of_keys(of)
            };
            rows.rows = to_cells(&rows.rows);
            rows.columns = rows.rows.clone();
            if let Some(seen) = &mut seen {
                seen.rows = to_cells(&seen.rows);
            }
        }
        let mut stores = vec![Store::of_rows(format::ROWS, &rows.bits)?];
        let mut sections = vec![
            (format::COARSE, write::coarse(&rows, table.n_cells())),
            (format::CLASSES, write::classes(format::CLASSES, &rows.rows)?),
        ];
        let mut n_classes = [rows.rows.first.len() as u32, 0, 0];
        if let Some(seen) = &seen {
            stores.push(Store::of_rows(format::SEEN, &seen.bits)?);
            sections.push((format::SEEN_ROWS, write::classes(format::SEEN_ROWS, &seen.rows)?));
            sections.push((format::SEEN_COLUMNS, write::classes(format::SEEN_COLUMNS, &seen.columns)?));
            n_classes[1..].copy_from_slice(&[seen.rows.first.len() as u32, seen.columns.first.len() as u32]);
        }
        Ok(Self { n_classes, sections, stores })
    }

    /// Bytes in the file, including the parts of the index.
    fn len(&self) -> usize {
        self.sections.iter().map(|(_, bytes)| bytes.len()).sum::<usize>()
            + self.stores.iter().map(Store::len).sum::<usize>()
    }
}

/// Everything except the visibility, packed.
struct Frame {
    sections: Vec<(SectionId, Vec<u8>)>,
    stores: Vec<Store>,
}

impl Frame {
    fn new(table: &Table) -> Result<Self, PackError> {
        let parts = table.parts();
        let mut sections =
            vec![(format::BOXES, write::boxes(parts)), (format::LOCATOR, write::locator(&parts.locator))];
        if parts.cells.iter().any(|cell| !cell.polygon.is_empty()) {
            sections.push((format::POLYGONS, write::polygons(&parts.cells)));
        }
        sections.extend(frame_sections(parts));
        let mut stores = vec![
            Store::of_records(format::CELLS, write::cells(parts))?,
            Store::of_records(format::PORTALS, write::portals(parts))?,
            Store::of_records(format::OBJECTS, write::objects(parts))?,
        ];
        if let Some(stab) = &parts.stab {
            stores.push(Store::of_records(format::STAB, write::nodes(stab))?);
        }
        if let Some(of_objects) = &parts.object_parts {
            stores.push(Store::of_records(format::PARTS_SEEN, write::parts_seen(of_objects))?);
        }
        if !parts.cell_names.is_empty() {
            stores.push(Store::of_records(format::CELL_NAMES, write::cell_names(parts))?);
        }
        Ok(Self { sections, stores })
    }

    /// Size of the file with this visibility, in bytes.
    fn len(&self, visibility: &Visibility) -> u64 {
        // `HEAD` and `BLKS` in addition to the existing sections.
        let n_sections = self.sections.len() + visibility.sections.len() + 2;
        let n_stores = self.stores.len() + visibility.stores.len();
        let fixed = FIXED + ENTRY * n_sections + 4 + format::HEAD_LEN + 4 + 12 * n_stores;
        let own = self.sections.iter().map(|(_, bytes)| bytes.len()).sum::<usize>();
        (fixed + own + self.stores.iter().map(Store::len).sum::<usize>() + visibility.len()) as u64
    }

    fn write(&self, table: &Table, visibility: &Visibility, n_merges: usize) -> (Vec<u8>, PackReport) {
        let [n_rows, n_seen_rows, n_seen_columns] = visibility.n_classes;
        let [n_cells, n_objects, n_portals, n_nodes, flags] =
            write::counts(table.parts(), table.parts().objects_seen.is_some());
        let page = format::page_size(table.n_cells()) as u32;
        let fields = [
            u32::from(table.dimension()),
            n_cells,
            n_objects,
            n_portals,
            n_nodes,
            flags,
            format::DENSE,
            format::DENSE,
            page,
            n_rows,
            n_seen_rows,
            n_seen_columns,
        ];
        let (mut head, mut blocks) = (Writer::default(), Writer::default());
        fields.iter().for_each(|&x| head.u32(x));
        let stores = || visibility.stores.iter().chain(&self.stores);
        blocks.u32(stores().count() as u32);
        stores().for_each(|store| store.write_index(&mut blocks));
        let own = [(format::HEAD, head.0), (format::BLOCKS, blocks.0)];
        let all = || own.iter().chain(&self.sections).chain(&visibility.sections);
        let ordered: Vec<_> = format::SECTIONS
            .iter()
            .filter_map(|(id, optional)| all().find(|(own, _)| own == id).map(|(_, bytes)| (*id, *optional, bytes)))
            .collect();
        let total = self.len(visibility);
        let mut out = Writer(Vec::with_capacity(total as usize));
        out.0.extend(MAGIC);
        out.0.extend(MAJOR.to_le_bytes());
        out.0.extend(minor(table.parts(), &self.sections).to_le_bytes());
        out.u32(ordered.len() as u32);
        out.u64(total);
        let mut at = (FIXED + ENTRY * ordered.len() + 4) as u64;
        for (id, optional, bytes) in &ordered {
            out.0.extend(id.0);
            out.u32(if *optional { OPTIONAL } else { 0 });
            out.u64(at);
            out.u32(bytes.len() as u32);
            out.u32(crc32fast::hash(bytes));
            at += bytes.len() as u64;
        }
        out.u32(crc32fast::hash(&out.0));
        ordered.iter().for_each(|(_, _, bytes)| out.0.extend_from_slice(bytes));
        stores().for_each(|store| out.0.extend_from_slice(&store.bytes));
        let report = PackReport {
            bytes: out.0.len() as u64,
            row_bytes: visibility.len() as u64,
            n_classes: n_rows as usize,
            n_merges,
            class: SizeClass::Small,
        };
        (out.0, report)
    }
}
