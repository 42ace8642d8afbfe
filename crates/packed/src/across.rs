//! Rows that reach across tiles: what the cells of one tile of a world see of other tiles.
//!
//! A world that is too large for one table is cut into tiles, each with a table of its own. Beside it lie its rows across: for each of its
//! cells, which cells and which objects of the tiles nearby it may see, and which tiles farther away it may see anything of.
//!
//! # Form
//! All numbers are little-endian.
//!
//! | bytes | what |
//! | --- | --- |
//! | 8 | `SLPVACRS` |
//! | 4 | version, 1 |
//! | 4 | length of the header |
//! | 4 | CRC-32 of the header |
//! | … | the header: the key of the tile (16); numbers of rows, near tiles, far tiles and blocks (4 each); of each near tile the length of its name (4), the name, numbers of cells and objects (4 each); of each far tile the length of its name (4), the name; the end of each block, counted from the end of the header (8) |
//! | … | the blocks, each of 64 rows, the last of fewer: CRC-32 of the rest of it (4), then the rows as sets ([`runs`](sightlines_pvs::runs)) of columns |
//!
//! Columns are numbered through: the cells of the first near tile, its objects, those of the second, and so on, then far tiles, one each.

use crate::source::ByteSource;
use sightlines_pvs::CellId;
use sightlines_pvs::runs::{read_runs, write_runs};
use std::io::{self, Write};
use std::ops::Range;

const MAGIC: &[u8; 8] = b"SLPVACRS";

/// The version of the form.
const VERSION: u32 = 1;

/// Bytes before the header.
const BEFORE: usize = 20;

/// Rows in a block: the least that is read.
const ROWS: usize = 64;

/// A tile whose cells and objects are told apart.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NearColumns {
    /// Its name in the world.
    pub name: String,
    /// How many cells it has.
    pub n_cells: u32,
    /// How many objects it has.
    pub n_objects: u32,
}

/// What the columns of rows across are.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct AcrossColumns {
    /// The key of the tile that the rows are of: what tells this bake of it from others.
    pub key: [u8; 16],
    /// Tiles nearby.
    pub near: Vec<NearColumns>,
    /// The names of tiles farther away, of which is only known whether anything of them may be seen.
    pub far: Vec<String>,
}

impl AcrossColumns {
    /// How many columns there are; `None` if they are more than 2³²-1.
    pub fn n_columns(&self) -> Option<u32> {
        let near = self.near.iter().try_fold(0u32, |n, tile| n.checked_add(tile.n_cells)?.checked_add(tile.n_objects));
        near?.checked_add(u32::try_from(self.far.len()).ok()?)
    }
}

/// What a cell may see of another tile.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SeenAcross {
    /// Cells of a near tile, by its place among them.
    Cells(usize, Range<u32>),
    /// Objects of a near tile.
    Objects(usize, Range<u32>),
    /// Some of a far tile, by its place among them.
    Tile(usize),
}

/// Why rows across cannot be read, or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AcrossError {
    /// The medium fails, or there are fewer bytes than there should be.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// Not rows across.
    #[error("these are no rows across tiles")]
    Magic,
    /// Of another version.
    #[error("version {0} of rows across tiles is not known")]
    Version(u32),
    /// Damaged.
    #[error("damaged: {0}")]
    Damaged(&'static str),
    /// A cell that is not in the tile.
    #[error("there is no cell {0} in the tile")]
    NoCell(u32),
    /// More than 2³²-1 columns or bytes of a header, or a row with columns that there are not.
    #[error("too large, or out of range: {0}")]
    Range(&'static str),
}

fn put(out: &mut Vec<u8>, n: usize, what: &'static str) -> Result<(), AcrossError> {
    let n = u32::try_from(n).map_err(|_| AcrossError::Range(what))?;
    out.extend(n.to_le_bytes());
    Ok(())
}

/// Writes rows across. Same columns and rows, same bytes.
///
/// * `rows`: for each cell of the tile the columns that it may see, as ascending runs with gaps between them
///
/// # Errors
/// [`AcrossError::Range`], and any error of `out`.
pub fn write_across<W: Write>(
    out: &mut W,
    columns: &AcrossColumns,
    rows: &[Vec<Range<u32>>],
) -> Result<(), AcrossError> {
    let n_columns = columns.n_columns().ok_or(AcrossError::Range("columns"))?;
    if rows.iter().filter_map(|row| row.last()).any(|last| last.end > n_columns) {
        return Err(AcrossError::Range("a row"));
    }
    let (mut blocks, mut ends) = (Vec::new(), Vec::new());
    for block in rows.chunks(ROWS) {
        let mut bytes = Vec::new();
        block.iter().for_each(|row| write_runs(row, &mut bytes));
        blocks.extend(crc32fast::hash(&bytes).to_le_bytes());
        blocks.extend(bytes);
        ends.push(blocks.len() as u64);
    }
    let mut header = columns.key.to_vec();
    for n in [rows.len(), columns.near.len(), columns.far.len(), ends.len()] {
        put(&mut header, n, "sizes")?;
    }
    for NearColumns { name, n_cells, n_objects } in &columns.near {
        put(&mut header, name.len(), "a name")?;
        header.extend(name.as_bytes());
        [n_cells, n_objects].into_iter().for_each(|n| header.extend(n.to_le_bytes()));
    }
    for name in &columns.far {
        put(&mut header, name.len(), "a name")?;
        header.extend(name.as_bytes());
    }
    ends.iter().for_each(|end| header.extend(end.to_le_bytes()));
    let mut before = MAGIC.to_vec();
    before.extend(VERSION.to_le_bytes());
    put(&mut before, header.len(), "the header")?;
    before.extend(crc32fast::hash(&header).to_le_bytes());
    [before, header, blocks].iter().try_for_each(|bytes| out.write_all(bytes))?;
    Ok(())
}

/// Rows across, read on demand: the header is in memory, and each row is read with the 63 others of its block.
#[derive(Debug)]
pub struct Across<S> {
    source: S,
    columns: AcrossColumns,
    n_columns: u32,
    n_rows: usize,
    /// Where the blocks begin, and the end of each counted from there.
    start: u64,
    ends: Vec<u64>,
}

/// Takes values from the front of the bytes of a header.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], AcrossError> {
        let (first, rest) = self.0.split_first_chunk().ok_or(AcrossError::Damaged("the header is too short"))?;
        self.0 = rest;
        Ok(*first)
    }

    fn number(&mut self) -> Result<u32, AcrossError> {
        self.take().map(u32::from_le_bytes)
    }

    fn name(&mut self) -> Result<String, AcrossError> {
        let n = self.number()? as usize;
        let (name, rest) = self.0.split_at_checked(n).ok_or(AcrossError::Damaged("the header is too short"))?;
        self.0 = rest;
        String::from_utf8(name.to_vec()).map_err(|_| AcrossError::Damaged("a name is not UTF-8"))
    }
}

impl<S: ByteSource> Across<S> {
    /// Reads the header. Memory in proportion to it.
    ///
    /// # Errors
    /// [`AcrossError`]
    pub fn open(source: S) -> Result<Self, AcrossError> {
        let length = source.len()?;
        let mut before = [0; BEFORE];
        source.read_at(0, &mut before)?;
        let mut reader = Reader(&before);
        if reader.take()? != *MAGIC {
            return Err(AcrossError::Magic);
        }
        let version = reader.number()?;
        if version != VERSION {
            return Err(AcrossError::Version(version));
        }
        let (n, sum) = (u64::from(reader.number()?), reader.number()?);
        let start = BEFORE as u64 + n;
        if start > length {
            return Err(AcrossError::Damaged("it ends in the header"));
        }
        let mut header = vec![0; usize::try_from(n).map_err(|_| AcrossError::Range("the header"))?];
        source.read_at(BEFORE as u64, &mut header)?;
        if crc32fast::hash(&header) != sum {
            return Err(AcrossError::Damaged("the header"));
        }
        let mut reader = Reader(&header);
        let mut columns = AcrossColumns { key: reader.take()?, ..AcrossColumns::default() };
        let [n_rows, n_near, n_far, n_blocks] = [(); 4].map(|()| reader.number());
        let (n_rows, n_blocks) = (n_rows? as usize, n_blocks? as usize);
        for _ in 0..n_near? {
            let (name, n_cells, n_objects) = (reader.name()?, reader.number()?, reader.number()?);
            columns.near.push(NearColumns { name, n_cells, n_objects });
        }
        for _ in 0..n_far? {
            columns.far.push(reader.name()?);
        }
        let mut ends = Vec::new();
        for _ in 0..n_blocks {
            ends.push(reader.take().map(u64::from_le_bytes)?);
        }
        let is_in_order = ends.is_sorted() && start.checked_add(ends.last().copied().unwrap_or(0)) == Some(length);
        if !is_in_order || n_blocks != n_rows.div_ceil(ROWS) || !reader.0.is_empty() {
            return Err(AcrossError::Damaged("the places of its blocks"));
        }
        let n_columns = columns.n_columns().ok_or(AcrossError::Damaged("more columns than there can be"))?;
        Ok(Self { source, columns, n_columns, n_rows, start, ends })
    }

    /// What the columns are.
    pub fn columns(&self) -> &AcrossColumns {
        &self.columns
    }

    /// How many cells the tile has.
    pub fn n_rows(&self) -> usize {
        self.n_rows
    }

    /// Bytes in memory, about.
    pub fn resident_bytes(&self) -> usize {
        let names = self.columns.near.iter().map(|near| near.name.len() + size_of::<NearColumns>());
        let far = self.columns.far.iter().map(|name| name.len() + size_of::<String>());
        8 * self.ends.len() + names.chain(far).sum::<usize>()
    }

    /// What a cell may see of other tiles, appended to `out`: tile by tile, ascending.
    ///
    /// # Errors
    /// [`AcrossError`]
    pub fn seen(&self, cell: CellId, out: &mut Vec<SeenAcross>) -> Result<(), AcrossError> {
        let row = cell.0 as usize;
        if row >= self.n_rows {
            return Err(AcrossError::NoCell(cell.0));
        }
        let block = row / ROWS;
        let rows = self.block(block)?;
        self.tell_apart(&rows[row - block * ROWS], out);
        Ok(())
    }

    /// Reads everything.
    ///
    /// # Errors
    /// [`AcrossError`] for the first damage.
    pub fn verify(&self) -> Result<(), AcrossError> {
        (0..self.ends.len()).try_for_each(|block| self.block(block).map(drop))
    }

    /// The rows of a block.
    fn block(&self, block: usize) -> Result<Vec<Vec<Range<u32>>>, AcrossError> {
        let begin = if block == 0 { 0 } else { self.ends[block - 1] };
        // The ends lie within the bytes that there are.
        let n = usize::try_from(self.ends[block] - begin).map_err(|_| AcrossError::Range("a block"))?;
        let mut bytes = vec![0; n];
        self.source.read_at(self.start + begin, &mut bytes)?;
        let damaged = AcrossError::Damaged("rows");
        let Some((sum, mut bytes)) = bytes.split_first_chunk().map(|(sum, rest)| (*sum, rest)) else {
            return Err(damaged);
        };
        if crc32fast::hash(bytes) != u32::from_le_bytes(sum) {
            return Err(damaged);
        }
        let n_rows = (self.n_rows - block * ROWS).min(ROWS);
        let rows: Option<Vec<_>> = (0..n_rows).map(|_| read_runs(&mut bytes, self.n_columns)).collect();
        rows.filter(|_| bytes.is_empty()).ok_or(damaged)
    }

    /// Splits runs of columns where another kind of them begins.
    fn tell_apart(&self, runs: &[Range<u32>], out: &mut Vec<SeenAcross>) {
        let mut runs = runs.iter().cloned().peekable();
        let mut first = 0;
        let mut within = |n: u32, show: &mut dyn FnMut(Range<u32>)| {
            let end = first + n;
            while let Some(run) = runs.peek_mut().filter(|run| run.start < end) {
                show(run.start - first..run.end.min(end) - first);
                if run.end > end {
                    run.start = end;
                    break;
                }
                runs.next();
            }
            first = end;
        };
        for (k, near) in self.columns.near.iter().enumerate() {
            within(near.n_cells, &mut |cells| out.push(SeenAcross::Cells(k, cells)));
            within(near.n_objects, &mut |objects| out.push(SeenAcross::Objects(k, objects)));
        }
        let n_far = self.columns.far.len() as u32;
        within(n_far, &mut |far| out.extend(far.map(|k| SeenAcross::Tile(k as usize))));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use sightlines_pvs::runs::runs_of;
    use std::collections::BTreeSet;

    fn bytes_of(columns: &AcrossColumns, sets: &[BTreeSet<u32>]) -> Vec<u8> {
        let rows: Vec<_> = sets.iter().map(|set| runs_of(set.iter().copied())).collect();
        let mut bytes = Vec::new();
        write_across(&mut bytes, columns, &rows).unwrap();
        bytes
    }

    fn columns(sizes: &[(u32, u32)], n_far: usize) -> AcrossColumns {
        let near = sizes.iter().enumerate().map(|(k, &(n_cells, n_objects))| NearColumns {
            name: format!("near {k}"),
            n_cells,
            n_objects,
        });
        let far = (0..n_far).map(|k| format!("far {k}")).collect();
        AcrossColumns { key: [7; 16], near: near.collect(), far }
    }

    /// Column by column, another way.
    fn expand(columns: &AcrossColumns, seen: &[SeenAcross]) -> BTreeSet<u32> {
        let firsts: Vec<u32> = columns
            .near
            .iter()
            .scan(0, |first, near| {
                let at = *first;
                *first += near.n_cells + near.n_objects;
                Some(at)
            })
            .collect();
        let n_near: u32 = columns.near.iter().map(|near| near.n_cells + near.n_objects).sum();
        let of = |seen: &SeenAcross| -> Vec<u32> {
            match seen {
                SeenAcross::Cells(k, cells) => cells.clone().map(|c| firsts[*k] + c).collect(),
                SeenAcross::Objects(k, objects) => {
                    objects.clone().map(|o| firsts[*k] + columns.near[*k].n_cells + o).collect()
                }
                SeenAcross::Tile(k) => vec![n_near + *k as u32],
            }
        };
        seen.iter().flat_map(of).collect()
    }

    proptest! {
        #[test]
        fn rows_come_back(
            sizes in prop::collection::vec((0u32..9, 0u32..5), 0..6),
            n_far in 0usize..9,
            n_rows in 0usize..140,
            seed in any::<u64>(),
        ) {
            let columns = columns(&sizes, n_far);
            let n = columns.n_columns().unwrap();
            let sets: Vec<BTreeSet<u32>> = (0..n_rows as u64)
                .map(|row| (0..n).filter(|&c| (seed ^ (row * 64 + u64::from(c))).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 62 != 0).collect())
                .collect();
            let bytes = bytes_of(&columns, &sets);
            let across = Across::open(bytes).unwrap();
            prop_assert_eq!((across.columns(), across.n_rows()), (&columns, n_rows));
            across.verify().unwrap();
            for (row, set) in (0..).zip(&sets) {
                let mut seen = Vec::new();
                across.seen(CellId(row), &mut seen).unwrap();
                prop_assert_eq!(&expand(&columns, &seen), set);
            }
            prop_assert!(matches!(across.seen(CellId(n_rows as u32), &mut Vec::new()), Err(AcrossError::NoCell(_))));
        }
    }

    #[test]
    fn damage_is_an_error() {
        let columns = columns(&[(3, 2), (4, 0)], 2);
        let sets: Vec<BTreeSet<u32>> = (0..70u32).map(|row| (0..11).filter(|c| (row + c) % 3 == 0).collect()).collect();
        let bytes = bytes_of(&columns, &sets);
        let reads = |bytes: Vec<u8>| Across::open(bytes).and_then(|across| across.verify());
        assert!(reads(bytes.clone()).is_ok());
        for at in 0..bytes.len() {
            let mut other = bytes.clone();
            other[at] ^= 0x10;
            assert!(reads(other).is_err(), "byte {at}");
            assert!(reads(bytes[..at].to_vec()).is_err(), "prefix {at}");
        }
        assert!(reads([&bytes[..], &[0]].concat()).is_err());
        let outside = vec![vec![0..12]];
        assert!(matches!(write_across(&mut Vec::new(), &columns, &outside), Err(AcrossError::Range(_))));
    }
}
