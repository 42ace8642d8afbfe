//! Stores of rows: of cells, and of objects.

use crate::bytes::{Reader, u32_at, words_of};
use crate::classes::Members;
use crate::container::ResidentPart;
use crate::error::{PackedError, PackedErrorKind as Kind};
use crate::format::{self, MAX_UNPACKED_BLOCK, SizeClass};
use crate::index::{Index, StoreIndex};
use crate::zstandard;
use sightlines_pvs::SectionId;
use sightlines_pvs::bits::ones;

/// A store of rows.
#[derive(Debug)]
pub(crate) enum Rows {
    /// Of a small file.
    Dense(DenseRows),
    /// Of a large file: one record for each cell.
    Masks {
        id: SectionId,
        store: StoreIndex,
        /// Items are below it.
        n_items: u32,
    },
}

impl Rows {
    /// `sections` are those of the classes of rows and of columns, `n` the numbers of rows, items, row classes and
    /// column classes.
    pub(crate) fn read(
        resident: &ResidentPart,
        index: &Index,
        (id, coding): (SectionId, u32),
        sections: [SectionId; 2],
        n: [u32; 4],
    ) -> Result<Self, PackedError> {
        let expected = match resident.class() {
            SizeClass::Small => format::DENSE,
            SizeClass::Large => format::MASKS,
        };
        if coding != expected {
            return Err(PackedError::new(Some(id), 0, Kind::Value { value: u64::from(coding) }));
        }
        match resident.class() {
            SizeClass::Small => DenseRows::read(resident, index, id, sections, n).map(Self::Dense),
            SizeClass::Large => Ok(Self::Masks { id, store: index.need_records(id, n[0])?, n_items: n[1] }),
        }
    }
}

/// A store of rows of bits between classes.
#[derive(Debug)]
pub(crate) struct DenseRows {
    pub(crate) id: SectionId,
    pub(crate) store: StoreIndex,
    n_columns: usize,
    /// The class of each cell; `None` if each is its own class.
    pub(crate) row_of: Option<Vec<u32>>,
    /// The members of the classes of columns; `None` if each is its own class.
    columns: Option<Members>,
    n_items: usize,
}

impl DenseRows {
    /// `sections` are those of the classes of rows and of columns, `n` the numbers of rows, items, row classes and
    /// column classes.
    fn read(
        resident: &ResidentPart,
        index: &Index,
        id: SectionId,
        sections: [SectionId; 2],
        n: [u32; 4],
    ) -> Result<Self, PackedError> {
        let [n_rows, n_items, n_row_classes, n_columns] = n;
        let store = index.need(id, n_row_classes)?;
        let fail = |kind| PackedError::new(Some(id), index.offset_of(&store), kind);
        let row_of = classes(resident, sections[0], n_rows, n_row_classes)?;
        let columns = classes(resident, sections[1], n_items, n_columns)?;
        let stride = (n_columns as usize).div_ceil(64);
        for (number, n) in store.blocks() {
            let needed = n as u64 * 8 * stride as u64;
            let found = u64::from(index.entries[number].raw);
            if needed != found {
                return Err(fail(Kind::Size { needed, found }));
            }
        }
        Ok(Self {
            id,
            store,
            n_columns: n_columns as usize,
            row_of,
            columns: columns.map(|of| Members::new(&of, n_columns as usize)),
            n_items: n_items as usize,
        })
    }

    pub(crate) fn stride(&self) -> usize {
        self.n_columns.div_ceil(64)
    }

    /// The rows of an unpacked block; bits past the last column are dropped.
    pub(crate) fn decode(&self, bytes: &[u8]) -> Vec<u64> {
        let mut words = words_of(bytes);
        let (stride, used) = (self.stride(), self.n_columns % 64);
        if used > 0 {
            words.chunks_exact_mut(stride).for_each(|row| row[stride - 1] &= !(u64::MAX << used));
        }
        words
    }

    /// Puts the items of the classes in a row into `out`, ascending.
    pub(crate) fn expand<T>(&self, row: &[u64], out: &mut Vec<T>, item: impl Fn(u32) -> T) {
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
    let bytes = zstandard::decompress(&section.bytes[4..], raw as usize);
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
