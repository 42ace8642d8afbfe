//! The large class answers as the table does, and refuses what is damaged.

use crate::common::{Recipe, SMALL, recipes, table};
use crate::damage::ask_all;
use crate::round_trip::compare;
use proptest::prelude::*;
use sightlines_packed::format::{MAJOR_LARGE, MAX_SMALL_CELLS};
use sightlines_packed::{PackOptions, Packed, PackedError, PackedErrorKind, SizeClass, pack};
use sightlines_pvs::{BitMatrix, CellId, CellRecord, Locator, PlaceBuffer, Table, TableKind, TableParts};

pub(crate) const LARGE: PackOptions = PackOptions { max_bytes: None, class: Some(SizeClass::Large) };

fn packed(table: &Table) -> Vec<u8> {
    pack(table, &LARGE).unwrap()
}

proptest! {
    #[test]
    fn a_table_comes_back_and_answers_the_same(recipe in recipes(), budget in prop::sample::select(vec![0usize, 3000, 1 << 20])) {
        let table = table(recipe);
        let bytes = packed(&table);
        prop_assert_eq!(&bytes[8..10], &MAJOR_LARGE.to_le_bytes());
        prop_assert_eq!(&bytes, &packed(&table));
        let packed = Packed::open(bytes, budget).unwrap();
        prop_assert_eq!(packed.size_class(), SizeClass::Large);
        compare(&packed, &table);
        prop_assert!(packed.bytes_in_use() <= budget);
        packed.verify().unwrap();
        // With room for one row at a time, and for all of them.
        packed.verify_within(0).unwrap();
        prop_assert_eq!(packed.to_table().unwrap(), table);
    }
}

/// A grid of rooms with sight lines along rows and columns, far more than fit one block or one page.
pub(crate) fn grid(width: u32, height: u32, dimension: u8) -> TableParts {
    let n = (width * height) as usize;
    let top = if dimension == 3 { 2.5 } else { 0.0 };
    let cell = |i: u32| {
        let (x, y) = (f64::from(i % width), f64::from(i / width));
        let square = vec![[x, y], [x + 1.0, y], [x + 1.0, y + 1.0], [x, y + 1.0]];
        let polygon = if dimension == 2 && i.is_multiple_of(3) { square } else { vec![] };
        CellRecord { min: [x, y, 0.0], max: [x + 1.0, y + 1.0, top], group: Some(i / 7), polygon }
    };
    let mut parts = TableParts::empty(dimension, TableKind::Unspecified);
    parts.cells = (0..width * height).map(cell).collect();
    parts.locator = Locator::build(&parts.cell_bounds(), dimension);
    parts.cell_objects = vec![vec![]; n];
    parts
}

/// Which cells a cell of the grid sees.
pub(crate) fn row_of(i: u32, width: u32, height: u32) -> Vec<CellId> {
    let (x, y) = (i % width, i / width);
    let sees = |a: u32, b: u32| (a * b + a + b) % 5 != 1;
    let all = 0..width * height;
    all.filter(|&j| j == i || (j % width == x && sees(y, j / width)) || (j / width == y && sees(x, j % width)))
        .map(CellId)
        .collect()
}

fn grid_table(width: u32, height: u32, dimension: u8) -> Table {
    let mut parts = grid(width, height, dimension);
    let n = (width * height) as usize;
    parts.rows = BitMatrix::new(n, n);
    for i in 0..width * height {
        row_of(i, width, height).iter().for_each(|j| parts.rows.set(i as usize, j.idx(), true));
    }
    Table::new(parts).unwrap()
}

#[test]
fn many_pages_and_blocks_answer_the_same() {
    for dimension in [2, 3] {
        let table = grid_table(90, 60, dimension);
        let packed = Packed::open(packed(&table), 1 << 20).unwrap();
        let blocks_of = |id: &[u8; 4]| packed.part_sizes().into_iter().find(|part| part.id.0 == *id).unwrap().bytes;
        assert!(blocks_of(b"PLAC") > 20_000 && blocks_of(b"LOCT") > 8 + 16 * 10, "more than ten pages");
        let mut buffer = PlaceBuffer::new();
        let mut n_several = 0;
        for (i, j) in (0..=180).flat_map(|i| (0..=120).map(move |j| (i, j))) {
            let p = [f64::from(i) / 2.0, f64::from(j) / 2.0, 1.0];
            let found = packed.cells_at(p, &mut buffer).unwrap().inside().unwrap_or_default();
            assert_eq!(found, table.place_at(p).cells(), "{p:?}");
            n_several += usize::from(found.len() > 1);
        }
        assert!(n_several > 10_000);
        let mut seen = Vec::new();
        for cell in (0..5400).map(CellId) {
            packed.visible(cell, &mut seen).unwrap();
            assert!(seen.iter().copied().eq(table.visible(cell)));
        }
        // Bands of some hundred rows.
        packed.verify_within(1 << 16).unwrap();
        assert_eq!(packed.to_table().unwrap(), table);
    }
}

#[test]
fn the_class_follows_the_size_unless_it_is_chosen() {
    let class = |table: &Table, class: Option<SizeClass>| {
        let bytes = pack(table, &PackOptions { max_bytes: None, class }).unwrap();
        Packed::open(bytes, 0).unwrap().size_class()
    };
    let few = grid_table(5, 5, 2);
    assert_eq!(class(&few, None), SizeClass::Small);
    assert_eq!(class(&few, Some(SizeClass::Large)), SizeClass::Large);
    let n = MAX_SMALL_CELLS + 1;
    let parts = TableParts { rows: BitMatrix::identity(n), ..grid(n as u32, 1, 2) };
    let many = Table::new(parts).unwrap();
    assert_eq!(class(&many, None), SizeClass::Large);
}

/// A reader of version 1 knows no other; a reader of both refuses what comes after.
#[test]
fn later_versions_are_refused() {
    let mut bytes = packed(&table(SMALL[0]));
    bytes[8] = MAJOR_LARGE as u8 + 1;
    let error = Packed::open(bytes, 0).unwrap_err();
    assert!(matches!(error.kind, PackedErrorKind::Major { major: 3 }));
    assert_eq!(error.to_string(), "byte 8: version 3 of the packed format; this reader knows versions 1 to 2");
}

fn read(bytes: Vec<u8>) -> Result<Table, PackedError> {
    let packed = Packed::open(bytes, 1 << 16)?;
    ask_all(&packed);
    packed.verify()?;
    packed.to_table()
}

fn files() -> impl Iterator<Item = (Recipe, Vec<u8>)> {
    SMALL.into_iter().map(|recipe| (recipe, packed(&table(recipe))))
}

#[test]
fn every_prefix_is_refused() {
    let mut n = 0;
    for (_, bytes) in files() {
        assert!(read(bytes.clone()).is_ok());
        for len in 0..bytes.len() {
            assert!(Packed::open(bytes[..len].to_vec(), 0).is_err(), "{len} of {} bytes", bytes.len());
            n += 1;
        }
        let mut longer = bytes;
        longer.push(0);
        assert!(Packed::open(longer, 0).is_err());
    }
    assert!(n > 1000, "{n} prefixes");
}

/// Where the sections and the section table begin, from the description of the format.
fn borders(bytes: &[u8]) -> (usize, usize) {
    let tail = bytes.len() - 32;
    (number(bytes, tail, 8) as usize, tail - 24 * number(bytes, tail + 16, 4) as usize)
}

fn number(bytes: &[u8], at: usize, n: usize) -> u64 {
    bytes[at..at + n].iter().rev().fold(0, |x, &b| x << 8 | u64::from(b))
}

#[test]
fn every_changed_byte_is_noticed() {
    let mut n = [0; 2];
    for (_, bytes) in files() {
        let (base, _) = borders(&bytes);
        for at in 0..bytes.len() {
            let mut changed = bytes.clone();
            changed[at] ^= 1 << (at % 8);
            let in_block = (24..base).contains(&at);
            assert_eq!(Packed::open(changed.clone(), 0).is_ok(), in_block, "byte {at}");
            let error = read(changed).expect_err("a byte was changed");
            assert!(!in_block || error.section.is_some() && error.offset >= 24, "{error}");
            n[usize::from(in_block)] += 1;
        }
    }
    assert!(n[0] > 500 && n[1] > 500, "{n:?} resident and other bytes");
}

/// Corrects the checksums of sections and tail.
fn seal(bytes: &mut [u8]) {
    let (_, table) = borders(bytes);
    let tail = bytes.len() - 32;
    for entry in (table..tail).step_by(24) {
        let (offset, length) = (number(bytes, entry + 8, 8) as usize, number(bytes, entry + 16, 4) as usize);
        let crc = crc32fast::hash(&bytes[offset..offset + length]);
        bytes[entry + 20..entry + 24].copy_from_slice(&crc.to_le_bytes());
    }
    let sealed = [&bytes[..24], &bytes[table..tail + 20]].concat();
    bytes[tail + 20..tail + 24].copy_from_slice(&crc32fast::hash(&sealed).to_le_bytes());
}

#[test]
fn lies_with_right_checksums_are_refused_or_answered() {
    let (mut n_opened, mut n_refused) = (0, 0);
    for (_, bytes) in files() {
        let (base, table) = borders(&bytes);
        for (at, value) in (base..table).flat_map(|at| [1u8, 0xFF].map(|value| (at, value))) {
            let mut changed = bytes.clone();
            changed[at] = value;
            seal(&mut changed);
            match Packed::open(changed, 1 << 12) {
                Err(_) => n_refused += 1,
                Ok(packed) => {
                    ask_all(&packed);
                    let _ = packed.verify();
                    n_opened += 1;
                }
            }
        }
        // The tail: numbers that no file has, with the right checksum.
        for at in bytes.len() - 32..bytes.len() - 12 {
            let mut changed = bytes.clone();
            changed[at] = 0xFF;
            let tail = changed.len() - 32;
            let n_table = (24 * number(&changed, tail + 16, 4)) as usize;
            let Some(table) = tail.checked_sub(n_table) else {
                assert!(Packed::open(changed, 0).is_err());
                continue;
            };
            let sealed = [&changed[..24], &changed[table..tail + 20]].concat();
            changed[tail + 20..tail + 24].copy_from_slice(&crc32fast::hash(&sealed).to_le_bytes());
            assert!(Packed::open(changed, 0).is_err(), "byte {at}");
        }
    }
    assert!(n_opened > 500 && n_refused > 500, "{n_opened} opened, {n_refused} refused");
}

/// The file with block `wanted` changed, with right checksums; `None` if there are not that many blocks.
fn with_block(bytes: &[u8], wanted: usize, change: impl FnOnce(&mut Vec<u8>)) -> Option<Vec<u8>> {
    let (base, table) = borders(bytes);
    let entry = (table..bytes.len() - 32).step_by(24).find(|&at| bytes[at..at + 4] == *b"BLKS")?;
    let index = number(bytes, entry + 8, 8) as usize;
    let first = index + 4 + 8 * number(bytes, index, 4) as usize;
    if wanted >= number(bytes, first, 4) as usize {
        return None;
    }
    let field = |block: usize, k: usize| number(bytes, first + 4 + 16 * block + 4 * k, 4) as usize;
    let offset = 24 + (0..wanted).map(|block| field(block, 1)).sum::<usize>();
    let (len, raw) = (field(wanted, 1), field(wanted, 2));
    let packed = &bytes[offset..offset + len];
    let mut block = if len == raw { packed.to_vec() } else { zstd::bulk::decompress(packed, raw).unwrap() };
    change(&mut block);
    let mut out = [&bytes[..offset], &block[..], &bytes[offset + len..]].concat();
    let moved = |at: usize| at + block.len() - len;
    let at = moved(first + 4 + 16 * wanted + 4);
    for (k, field) in [block.len() as u32, block.len() as u32, crc32fast::hash(&block)].into_iter().enumerate() {
        out[at + 4 * k..at + 4 * k + 4].copy_from_slice(&field.to_le_bytes());
    }
    let tail = out.len() - 32;
    for entry in (moved(table)..tail).step_by(24) {
        let offset = moved(number(&out, entry + 8, 8) as usize) as u64;
        out[entry + 8..entry + 16].copy_from_slice(&offset.to_le_bytes());
    }
    let total = out.len() as u64;
    out[tail..tail + 8].copy_from_slice(&(moved(base) as u64).to_le_bytes());
    out[tail + 8..tail + 16].copy_from_slice(&total.to_le_bytes());
    seal(&mut out);
    Some(out)
}

#[test]
fn blocks_that_lie_with_right_checksums_are_refused_or_answered() {
    let (mut n_files, mut n_errors, mut n_blocks, mut n_found) = (0, 0, 0, 0);
    for (recipe, bytes) in files() {
        let table = table(recipe);
        for wanted in 0.. {
            let mut n = 0;
            let Some(same) = with_block(&bytes, wanted, |block| n = block.len()) else { break };
            assert_eq!(read(same).unwrap(), table, "an unpacked block says the same");
            n_blocks += 1;
            for (at, value) in (0..n).flat_map(|at| [0u8, 0x7F, 0xFF].map(|value| (at, value))) {
                let lie = with_block(&bytes, wanted, |block| block[at] = value).unwrap();
                let packed = Packed::open(lie, 1 << 16).expect("only a block was changed");
                n_errors += ask_all(&packed);
                n_found += usize::from(packed.verify().is_err());
                n_files += 1;
            }
            let cut = with_block(&bytes, wanted, |block| block.truncate(n / 2)).unwrap();
            assert!(read(cut).is_err());
        }
    }
    let text = format!("{n_blocks} blocks, {n_files} files, {n_errors} errors, {n_found} found");
    assert!(n_blocks >= 14 && n_files > 3000 && n_errors > 3000 && n_found > 2000, "{text}");
}

/// What a coding that loses the last cell of a run would write: the comparison and the check of the file find it.
#[test]
fn impostor_a_row_without_the_end_of_a_run_is_found_out() {
    let table = grid_table(9, 7, 2);
    let bytes = packed(&table);
    let last = (0..).take_while(|&block| with_block(&bytes, block, |_| ()).is_some()).last().unwrap();
    let lost = with_block(&bytes, last, |block| {
        // The last block is that of `ROWS`. Its first record begins behind 63 ends: a number of bytes of 0, and eight cells.
        let mask = &mut block[4 * 63 + 1];
        *mask &= !(1 << mask.ilog2());
    });
    let lost = Packed::open(lost.expect("there is such a block"), 1 << 20).unwrap();
    assert!(matches!(lost.verify().unwrap_err().kind, PackedErrorKind::Table(_)));
    assert!(std::panic::catch_unwind(|| compare(&lost, &table)).is_err());
    assert!(compare(&Packed::open(bytes, 1 << 20).unwrap(), &table) > 100);
}
