//! Parts of objects: found again, stored, and refused where they are invalid.

use crate::common::file::{
    File, assert_damage_is_noticed, assert_every_changed_byte_is_an_error, assert_every_prefix_is_an_error,
    forge_every_byte, forged,
};
use crate::common::{any_parts, assert_well_formed, rooms};
use proptest::prelude::*;
use proptest::sample::Index;
use sightlines_pvs::{
    BitMatrix, CellId, DecodeErrorKind as Kind, ObjectId, ObjectPart, ObjectParts, Table, TableError, TableParts,
    TriangleRange,
};
use std::collections::BTreeSet;

/// The rooms, where the first object is cut into three parts, and no cell sees the middle one alone.
fn parts() -> TableParts {
    let mut parts = rooms();
    let mut seen = BitMatrix::new(5, 2);
    [(0, 0), (1, 0), (1, 1), (2, 0), (3, 1)].into_iter().for_each(|(cell, object)| seen.set(cell, object, true));
    parts.objects_seen = Some(seen);
    let part = |start, end| ObjectPart { object: ObjectId(0), start, end };
    let mut seen = BitMatrix::new(5, 3);
    [(0, 0), (0, 1), (1, 0), (1, 2)].into_iter().for_each(|(cell, part)| seen.set(cell, part, true));
    parts.object_parts = Some(ObjectParts { parts: vec![part(0, 4), part(4, 5), part(5, 9)], seen });
    parts
}

fn table() -> Table {
    Table::new(parts()).expect("a table")
}

/// Random tables with rows of objects, of which some are cut.
fn any_cut() -> impl Strategy<Value = TableParts> {
    let cuts = prop::collection::vec(prop::collection::vec(1u32..5, 0..4), 4);
    (any_parts(), cuts, any::<u64>()).prop_map(|(mut parts, cuts, bits)| {
        let (n_cells, n_objects) = (parts.cells.len(), parts.objects.len());
        let bit = |k: usize, shift: usize| bits.rotate_left((7 * k + shift) as u32) & 1 == 1;
        let mut all = Vec::new();
        for (object, sizes) in (0..n_objects as u32).map(ObjectId).zip(cuts) {
            let mut end = 0;
            all.extend(sizes.into_iter().map(|n| {
                let start = end;
                end += n;
                ObjectPart { object, start, end }
            }));
        }
        let (mut seen, mut of_parts) = (BitMatrix::new(n_cells, n_objects), BitMatrix::new(n_cells, all.len()));
        for cell in 0..n_cells {
            parts.cell_objects[cell].iter().for_each(|o| seen.set(cell, o.idx(), true));
            (0..n_objects).filter(|&o| bit(cell, o)).for_each(|o| seen.set(cell, o, true));
            for (k, part) in all.iter().enumerate().filter(|(k, _)| bit(cell, 9 + k)) {
                if seen.get(cell, part.object.idx()) {
                    of_parts.set(cell, k, true);
                }
            }
        }
        parts.objects_seen = Some(seen);
        parts.object_parts = Some(ObjectParts { parts: all, seen: of_parts });
        parts
    })
}

/// Another method: every triangle of every object by itself.
fn triangles(table: &Table, cells: &[CellId]) -> BTreeSet<(ObjectId, Option<u32>)> {
    let parts = table.parts().object_parts.as_ref().expect("parts");
    let mut all = BTreeSet::new();
    for &cell in cells {
        for object in table.visible_objects(cell) {
            let mut of = parts.parts.iter().enumerate().filter(|(_, part)| part.object == object).peekable();
            if of.peek().is_none() {
                all.insert((object, None));
            }
            let seen = of.filter(|&(k, _)| parts.seen.get(cell.idx(), k));
            all.extend(seen.flat_map(|(_, part)| (part.start..part.end).map(|t| (part.object, Some(t)))));
        }
    }
    all
}

fn assert_answers(table: &Table) {
    for cell in (0..table.n_cells() as u32).map(CellId) {
        let ranges = table.visible_ranges(cell);
        let all = ranges.iter().flat_map(|(object, range)| match range {
            Some(range) => range.clone().map(|t| (*object, Some(t))).collect::<Vec<_>>(),
            None => vec![(*object, None)],
        });
        let all: Vec<_> = all.collect();
        let found: BTreeSet<_> = all.iter().copied().collect();
        assert_eq!((found.len(), found), (all.len(), triangles(table, &[cell])), "each once");
        let meet = |w: &[TriangleRange]| match (&w[0], &w[1]) {
            ((a, Some(x)), (b, Some(y))) => a == b && x.end >= y.start,
            (a, b) => a.0 >= b.0,
        };
        assert!(!ranges.windows(2).any(meet), "{ranges:?}");
    }
}

proptest! {
    #[test]
    fn parts_round_trip_is_bit_identical(parts in any_cut()) {
        let table = Table::new(parts).unwrap();
        assert_answers(&table);
        let bytes = table.to_bytes();
        let read = Table::from_bytes(&bytes).unwrap();
        prop_assert_eq!(&read, &table);
        prop_assert_eq!(&read.to_bytes(), &bytes);
        prop_assert_eq!(bytes[10], 8);
        let bare = table.strip_geometry();
        prop_assert_eq!(bare.object_parts(), table.object_parts());
    }

    #[test]
    fn damaged_parts_are_an_error(parts in any_cut(), at in any::<Index>(), flip in 1u8..=255) {
        assert_damage_is_noticed(&Table::new(parts).unwrap(), at, flip);
    }
}

/// Every strict prefix, every byte changed into every other value; and every byte of the section with correct checksums.
#[test]
fn every_prefix_and_changed_byte_of_parts_is_an_error() {
    let table = table();
    assert_every_prefix_is_an_error(&table);
    assert_every_changed_byte_is_an_error(&table);
    let [n_tables, n_errors] = forge_every_byte(
        &table,
        |id| id == b"OPRT",
        |read| {
            assert_well_formed(read);
            // Of millions of triangles it takes too long.
            if read.object_parts().iter().all(|part| part.end < 1000) {
                assert_answers(read);
            }
        },
    );
    assert!(n_tables > 10 && n_errors > 1000, "{n_tables} tables, {n_errors} errors");
}

/// The file of version 1.8 must be read as long as there is a reader; others may skip the section.
#[test]
fn golden_v1_8_is_read_and_written() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden/v1_8.pvs");
    let bytes = table().to_bytes();
    if std::env::var_os("BLESS").is_some_and(|v| v == "1") {
        std::fs::write(path, &bytes).unwrap();
    }
    let golden = std::fs::read(path).expect("tests/golden/v1_8.pvs is missing; write it with BLESS=1");
    assert_eq!(Table::from_bytes(&golden), Ok(table()));
    assert!(golden == bytes && bytes[10] == 8, "the bytes of version 1.8 have changed");
    let mut renamed = File::parse(&bytes);
    renamed.parts.iter_mut().filter(|part| part.id == *b"OPRT").for_each(|part| part.id[0] = b'x');
    let bare = Table::new(TableParts { object_parts: None, ..parts() });
    assert_eq!(Table::from_bytes(&renamed.write()).ok(), bare.ok(), "a reader that does not have it");
}

#[test]
fn ranges_of_triangles_are_those_of_the_parts() {
    let table = table();
    let [lamp, other] = [ObjectId(0), ObjectId(1)];
    assert_eq!(table.visible_ranges(CellId(0)), [(lamp, Some(0..5))], "two parts in a row are one range");
    assert_eq!(table.visible_ranges(CellId(1)), [(lamp, Some(0..4)), (lamp, Some(5..9)), (other, None)]);
    assert_eq!(table.visible_ranges(CellId(2)), [], "an object that is seen, of which no part is");
    assert_eq!(table.visible_ranges(CellId(3)), [(other, None)]);
    let at = |x: f64| table.in_dimension().unwrap().at([x, 1.0]).inside().map_or(Vec::new(), |at| at.visible_ranges());
    assert_eq!((at(1.0), at(-1.0)), (vec![(lamp, Some(0..5))], vec![]));
    assert_eq!(at(4.0), [(lamp, Some(0..9)), (other, None)], "on the border of the first two cells");
    // The impostor: without the rows of parts, the object is drawn as a whole.
    let whole = Table::new(TableParts { object_parts: None, ..parts() }).unwrap();
    assert_eq!(whole.visible_ranges(CellId(0)), [(lamp, None)]);
}

/// Each defect alone is refused, with its position and a message.
#[test]
fn defects_of_parts_are_refused() {
    let refused = |spoil: &dyn Fn(&mut TableParts, &mut ObjectParts)| {
        let mut all = parts();
        let mut of = all.object_parts.take().unwrap();
        spoil(&mut all, &mut of);
        all.object_parts = Some(of);
        let error = Table::new(all).unwrap_err();
        (error.clone(), error.to_string())
    };
    let (error, text) = refused(&|_, of| of.seen = BitMatrix::new(5, 2));
    assert_eq!(error, TableError::PartsShape { n_rows: 5, n_cols: 2, n_cells: 5, n_parts: 3 });
    assert_eq!(text, "5 x 2 bits of parts of objects do not fit 5 cells and 3 parts");
    let (error, text) = refused(&|_, of| of.seen.row_mut(4)[0] |= 8);
    assert_eq!(
        (error, &*text),
        (TableError::PartsTail(CellId(4)), "the row of parts of cell 4 has a one past the last part")
    );
    let (error, text) = refused(&|_, of| of.parts[2].object = ObjectId(2));
    assert_eq!(
        (error, &*text),
        (TableError::PartObject { part: 2, object: ObjectId(2) }, "part 2 is of object 2, which does not exist")
    );
    let (error, text) = refused(&|all, _| all.objects_seen = None);
    assert_eq!((error, &*text), (TableError::PartsAlone, "rows of parts of objects need rows of objects"));
    let (error, text) = refused(&|_, of| of.seen.set(3, 1, true));
    assert_eq!(error, TableError::PartSeen { cell: CellId(3), object: ObjectId(0) });
    assert_eq!(text, "cell 3 sees a part of object 0, but not the object");
    let orders: [fn(&mut ObjectParts); 5] = [
        |of| of.parts[0].start = 1,
        |of| of.parts[1].start = 3,
        |of| of.parts[1].end = 4,
        |of| of.parts[0].object = ObjectId(1),
        |of| of.parts[2].object = ObjectId(1),
    ];
    for (place, spoil) in [0, 1, 1, 1, 2].into_iter().zip(orders) {
        let (error, text) = refused(&|_, of| spoil(of));
        assert_eq!(error, TableError::PartOrder(place));
        assert_eq!(text, format!("part {place} does not begin where the one before ends, or has no triangles"));
    }
}

#[test]
fn forged_parts_are_refused() {
    let forge = |change: &dyn Fn(&mut Vec<u8>)| forged(&table(), b"OPRT", change);
    let huge = u32::MAX.to_le_bytes();
    assert!(matches!(forge(&|b| b[..4].copy_from_slice(&huge)), Kind::Cut { .. }));
    assert!(matches!(forge(&|b| b.extend([0; 8])), Kind::Surplus { .. }));
    assert!(matches!(forge(&|b| b.truncate(44)), Kind::Cut { .. }));
    assert_eq!(forge(&|b| b[8] = 1), Kind::Table(TableError::PartOrder(0)));
}
