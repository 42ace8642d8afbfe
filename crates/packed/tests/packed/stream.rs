//! Large files written row by row.

use crate::common::{recipes, table};
use crate::large::{LARGE, grid, row_of};
use proptest::prelude::*;
use sightlines_packed::{PackWriter, Packed, PackedErrorKind, StreamError, StreamOptions, pack};
use sightlines_pvs::{CellId, ObjectId, Table, TableError};
use std::io::{self, Write};

/// Writes a table row by row.
fn streamed<W: Write>(table: &Table, out: W) -> Result<(W, u64), StreamError> {
    let seen = table.parts().objects_seen.as_ref();
    let mut writer = PackWriter::new(out, table.parts(), &StreamOptions { objects_seen: seen.is_some() })?;
    for cell in (0..table.n_cells() as u32).map(CellId) {
        let row: Vec<CellId> = table.visible(cell).collect();
        let objects: Option<Vec<ObjectId>> =
            seen.map(|seen| seen.iter_ones(cell.idx()).map(|o| ObjectId(o as u32)).collect());
        writer.push(&row, objects.as_deref())?;
    }
    writer.finish().map(|(out, report)| (out, report.bytes))
}

proptest! {
    #[test]
    fn rows_one_by_one_give_the_bytes_of_the_table(recipe in recipes()) {
        let table = table(recipe);
        let (bytes, n) = streamed(&table, Vec::new()).unwrap();
        prop_assert_eq!(bytes.len() as u64, n);
        prop_assert_eq!(bytes, pack(&table, &LARGE).unwrap());
    }
}

#[test]
fn rows_that_are_wrong_are_refused() {
    let parts = grid(3, 2, 2);
    let new = |objects_seen| PackWriter::new(Vec::new(), &parts, &StreamOptions { objects_seen }).unwrap();
    let row = |cells: &[u32]| cells.iter().map(|&cell| CellId(cell)).collect::<Vec<_>>();
    let refused = |cells: &[u32], text: &str| {
        let error = new(false).push(&row(cells), None).unwrap_err();
        assert_eq!(error.to_string(), text);
    };
    refused(&[0, 6], "a row of cell 0 has an entry that does not exist");
    refused(&[0, 2, 1], "a row of cell 0 is not ascending");
    refused(&[0, 0], "a row of cell 0 is not ascending");
    refused(&[1, 2], "cell 0 does not see itself");
    refused(&[], "cell 0 does not see itself");
    assert!(matches!(new(false).push(&row(&[0]), Some(&[])), Err(StreamError::RowOfObjects { expected: false, .. })));
    let error = new(true).push(&row(&[0]), None).unwrap_err();
    assert_eq!(error.to_string(), "cell 0 lacks a row of objects");
    assert!(new(true).push(&row(&[0]), Some(&[])).is_ok());
    assert!(matches!(new(true).push(&row(&[0]), Some(&[ObjectId(0)])), Err(StreamError::Unknown { .. })));
    let mut writer = new(false);
    writer.push(&row(&[0]), None).unwrap();
    assert_eq!(writer.finish().map(drop).unwrap_err().to_string(), "1 rows do not fit 6 cells");
    let mut writer = new(false);
    (0..6).for_each(|i| writer.push(&row(&[i]), None).unwrap());
    assert_eq!(writer.push(&row(&[6]), None).unwrap_err().to_string(), "7 rows do not fit 6 cells");
    // Parts that make no table.
    let mut wrong = parts.clone();
    wrong.cells[4].min[0] = 99.0;
    let error = PackWriter::new(Vec::new(), &wrong, &StreamOptions::default()).unwrap_err();
    assert!(matches!(error, StreamError::Table(TableError::Inverted { index: 4, .. })));
}

#[test]
fn an_object_that_touches_a_cell_must_be_seen() {
    let table = table((3, 6, 5, 7, 0xFF));
    let seen = table.parts().objects_seen.as_ref().unwrap();
    let mut writer = PackWriter::new(Vec::new(), table.parts(), &StreamOptions { objects_seen: true }).unwrap();
    let touching = table.objects_of(CellId(0));
    let objects: Vec<ObjectId> =
        seen.iter_ones(0).map(|o| ObjectId(o as u32)).filter(|o| Some(o) != touching.last()).collect();
    let error = writer.push(&table.visible(CellId(0)).collect::<Vec<_>>(), Some(&objects)).unwrap_err();
    assert!(matches!(error, StreamError::Unseen { cell: CellId(0), object } if Some(&object) == touching.last()));
}

/// The writer cannot see it, the check of the file does, however little memory it has.
#[test]
fn rows_that_are_not_symmetric_are_found_by_the_check() {
    let (width, height) = (40, 30);
    let write = |hidden: Option<(u32, u32)>| {
        let mut writer = PackWriter::new(Vec::new(), &grid(width, height, 2), &StreamOptions::default()).unwrap();
        for i in 0..width * height {
            let mut row = row_of(i, width, height);
            row.retain(|j| hidden != Some((i, j.0)));
            writer.push(&row, None).unwrap();
        }
        Packed::open(writer.finish().unwrap().0, 1 << 20).unwrap()
    };
    let mut n = 0;
    for bytes in [0, 5000, 1 << 30] {
        write(None).verify_within(bytes).unwrap();
        for (i, j) in [(0, 2), (2, 0), (5, 1165), (1165, 5), (1199, 1197)] {
            assert!(row_of(i, width, height).contains(&CellId(j)), "{i} {j}");
            let error = write(Some((i, j))).verify_within(bytes).unwrap_err();
            let PackedErrorKind::Table(TableError::NotSymmetric(pair)) = error.kind else { panic!("{error}") };
            assert!(pair == [CellId(i), CellId(j)] || pair == [CellId(j), CellId(i)], "{pair:?}");
            n += 1;
        }
    }
    assert_eq!(n, 15);
}

/// Takes so many bytes, then fails.
struct Full(usize);

impl Write for Full {
    fn write(&mut self, buf: &[u8]) -> io::Result<usize> {
        if self.0 == 0 {
            return Err(io::ErrorKind::StorageFull.into());
        }
        let n = buf.len().min(self.0);
        self.0 -= n;
        Ok(n)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_full_disk_is_an_error() {
    let table = table((2, 6, 5, 7, 0xFF));
    let (_, n) = streamed(&table, io::sink()).unwrap();
    for room in (0..n as usize).step_by(97) {
        assert!(matches!(streamed(&table, Full(room)), Err(StreamError::Io(_))), "{room} of {n} bytes");
    }
    assert!(streamed(&table, Full(n as usize)).is_ok());
}
