//! Rows of objects: finer than "whatever touches a visible cell".

use crate::common::rooms;
use sightlines_pvs::{BitMatrix, CellId, ObjectId, Table, TableError, TableParts};

/// The rooms, where the first sees only the lamp and the second both objects.
fn parts() -> TableParts {
    let mut parts = rooms();
    let mut seen = BitMatrix::new(5, 2);
    for (cell, object) in [(0, 0), (1, 0), (1, 1), (3, 1)] {
        seen.set(cell, object, true);
    }
    parts.objects_seen = Some(seen);
    parts
}

#[test]
fn rows_of_objects_answer_before_the_union() {
    let table = Table::new(parts()).unwrap();
    assert_eq!(table.visible_objects(CellId(1)), [ObjectId(0), ObjectId(1)]);
    assert_eq!(table.visible_objects(CellId(2)), []);
    // Without the rows, everything that touches a visible cell is visible.
    assert_eq!(Table::new(rooms()).unwrap().visible_objects(CellId(2)), [ObjectId(0), ObjectId(1)]);
    assert_eq!(
        table.in_dimension().unwrap().at([4.0, 1.0]).inside().map_or(Vec::new(), |at| at.visible_objects()),
        [ObjectId(0), ObjectId(1)]
    );
    assert_eq!(
        table.in_dimension().unwrap().at([1.0, 1.0]).inside().map_or(Vec::new(), |at| at.visible_objects()),
        [ObjectId(0)]
    );
    assert_eq!(
        table.in_dimension().unwrap().at([-1.0, 1.0]).inside().map_or(Vec::new(), |at| at.visible_objects()),
        []
    );
}

#[test]
fn rows_of_objects_survive_a_file() {
    let table = Table::new(parts()).unwrap();
    let bytes = table.to_bytes();
    assert_eq!(Table::from_bytes(&bytes), Ok(table));
    assert_eq!(bytes[10], 1, "the minor version");
    assert!((0..bytes.len()).all(|n| Table::from_bytes(&bytes[..n]).is_err()));
    for i in 0..bytes.len() {
        for flip in [1u8, 0x80, 0xFF] {
            let mut changed = bytes.clone();
            changed[i] ^= flip;
            assert!(Table::from_bytes(&changed).is_err(), "byte {i}");
        }
    }
}

/// The file of version 1.1 must be read as long as there is a reader.
#[test]
fn golden_v1_1_is_read_and_written() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden/v1_1.pvs");
    let table = Table::new(parts()).unwrap();
    if std::env::var_os("BLESS").is_some_and(|v| v == "1") {
        std::fs::write(path, table.to_bytes()).unwrap();
    }
    let golden = std::fs::read(path).expect("tests/golden/v1_1.pvs is missing; write it with BLESS=1");
    assert_eq!(Table::from_bytes(&golden), Ok(table.clone()));
    assert!(golden == table.to_bytes(), "the bytes of version 1.1 have changed");
}

#[test]
fn impostor_rows_of_objects_are_refused() {
    let broken = |change: &dyn Fn(&mut TableParts)| {
        let mut parts = parts();
        change(&mut parts);
        Table::new(parts).unwrap_err()
    };
    let unseen = broken(&|p| p.objects_seen.as_mut().unwrap().set(0, 0, false));
    assert_eq!(unseen, TableError::Unseen { cell: CellId(0), object: ObjectId(0) });
    assert_eq!(unseen.to_string(), "cell 0 does not see object 0, which touches it");
    let shape = broken(&|p| p.objects_seen = Some(BitMatrix::new(5, 3)));
    assert!(matches!(shape, TableError::SeenShape { n_cols: 3, n_objects: 2, .. }));
    let tail = broken(&|p| p.objects_seen.as_mut().unwrap().row_mut(2)[0] |= 4);
    assert_eq!(tail, TableError::SeenTail(CellId(2)));
}
