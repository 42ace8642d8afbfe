//! The optional parts of a table in files: mirrors, numbers of polygons, planes, stab trees and names of cells.

use crate::common::assert_well_formed;
use crate::common::file::{
    File, assert_damage_is_noticed, assert_every_changed_byte_is_an_error, assert_every_prefix_is_an_error, changes,
    forge_every_byte, forged,
};
use crate::common::full::{any_full_parts, named_villa, villa, wedges};
use crate::common::rooms;
use proptest::prelude::*;
use sightlines_pvs::{
    CellId, DecodeErrorKind as Kind, Item, MirrorId, MirrorRecord, ObjectId, Table, TableError, TableKind, TableParts,
};

proptest! {
    #[test]
    fn extras_round_trip_is_bit_identical(parts in any_full_parts()) {
        let table = Table::new(parts).unwrap();
        let bytes = table.to_bytes();
        let read = Table::from_bytes(&bytes).unwrap();
        prop_assert_eq!(&read, &table);
        prop_assert_eq!(&read.to_bytes(), &bytes);
        let bare = table.strip_geometry();
        prop_assert_eq!((bare.mirrors(), bare.planes()), (table.mirrors(), table.planes()));
        prop_assert!(bare.stab().is_none());
        prop_assert_eq!(&bare.parts().cell_names, &table.parts().cell_names);
        prop_assert_eq!(Table::from_bytes(&bare.to_bytes()).unwrap(), bare);
        // The smallest version that has all the parts.
        let parts = table.parts();
        let new = parts.stab.is_some() || parts.planes.is_some() || !parts.mirrors.is_empty() || !parts.object_polygons.is_empty();
        let made = (table.kind(), table.up()) != (TableKind::Unspecified, None);
        let minor = if made { 4 } else if table.has_cell_names() { 3 } else if new { 2 } else { 0 };
        prop_assert_eq!(bytes[10], minor);
    }

    #[test]
    fn extras_damage_is_an_error(parts in any_full_parts(), at in any::<prop::sample::Index>(), flip in 1u8..=255) {
        assert_damage_is_noticed(&Table::new(parts).unwrap(), at, flip);
    }

    /// Bytes changed, removed or added in the new sections, with correct checksums: no panic, and what is accepted is a
    /// valid table. The encoding of stab trees is unique.
    #[test]
    fn extras_forgeries_are_errors_or_tables(
        parts in any_full_parts(),
        changes in changes(),
    ) {
        let mut file = File::parse(&Table::new(parts).unwrap().to_bytes());
        let new: Vec<usize> = (0..file.parts.len()).filter(|&i| is_new(&file.parts[i].id)).collect();
        // Most have a new section; the others pass unchanged.
        for change in changes.into_iter().filter(|_| !new.is_empty()) {
            let bytes = &mut file.parts[new[change.part.index(new.len())]].bytes;
            change.apply(bytes);
        }
        if let Ok(table) = Table::from_bytes(&file.write()) {
            assert_well_formed(&table);
            let again = File::parse(&table.to_bytes());
            let stab = |file: &File| file.parts.iter().find(|part| part.id == *b"STAB").cloned();
            prop_assert_eq!(stab(&again), stab(&file));
        }
    }
}

fn is_new(id: &[u8; 4]) -> bool {
    [b"MIRR", b"OPOL", b"PLNS", b"STAB", b"CNAM"].contains(&id)
}

fn full() -> [Table; 3] {
    [villa(), wedges(), named_villa()].map(|parts| Table::new(parts).unwrap())
}

/// Every strict prefix, and every byte changed into every other value.
#[test]
fn every_prefix_and_changed_byte_of_extras_is_an_error() {
    for table in full() {
        assert_every_prefix_is_an_error(&table);
        assert_every_changed_byte_is_an_error(&table);
    }
}

/// Every byte of the new sections, changed into every other value, with correct checksums; and every length.
#[test]
fn every_forged_byte_of_extras_is_an_error_or_a_table() {
    let found = full().map(|table| forge_every_byte(&table, is_new, assert_well_formed));
    let [n_tables, n_errors] = [0, 1].map(|k| found.iter().map(|n| n[k]).sum::<usize>());
    assert!(n_tables > 1000 && n_errors > 1000, "{n_tables} tables, {n_errors} errors");
}

/// Each optional section may be removed, but not the portals of stab trees.
#[test]
fn extras_may_go() {
    let mut n_gone = 0;
    for table in full() {
        let file = File::parse(&table.to_bytes());
        for i in (0..file.parts.len()).filter(|&i| file.parts[i].flags == 1) {
            let mut fewer = file.clone();
            let gone = fewer.parts.remove(i);
            match (&gone.id, Table::from_bytes(&fewer.write())) {
                (b"PORT", Err(error)) => assert_eq!(error.section.unwrap().0, *b"STAB"),
                (b"PORT", Ok(_)) => panic!("stab trees without portals"),
                (_, result) => assert_well_formed(&result.unwrap()),
            }
            n_gone += 1;
        }
        // A reader that does not know the new sections gets the table without them.
        let old = |parts: TableParts| {
            let (mirrors, object_polygons, cell_names) = (vec![], vec![], vec![]);
            Table::new(TableParts { mirrors, object_polygons, cell_names, planes: None, stab: None, ..parts }).unwrap()
        };
        let mut renamed = file.clone();
        renamed.parts.iter_mut().filter(|part| is_new(&part.id)).for_each(|part| part.id[0] = b'x');
        assert_eq!(Table::from_bytes(&renamed.write()), Ok(old(table.into_parts())));
    }
    assert_eq!(n_gone, 5 + 4 + 6);
}

/// The files of versions 1.2 and 1.3 must be read as long as there is a reader.
#[test]
fn golden_v1_2_and_v1_3_are_read_and_written() {
    for ((name, minor), table) in [("v1_2.pvs", 2), ("v1_2_space.pvs", 2), ("v1_3.pvs", 3)].into_iter().zip(full()) {
        let path = format!("{}/tests/golden/{name}", env!("CARGO_MANIFEST_DIR"));
        let bytes = table.to_bytes();
        if std::env::var_os("BLESS").is_some_and(|v| v == "1") {
            std::fs::write(&path, &bytes).unwrap();
        }
        let golden = std::fs::read(&path).unwrap_or_else(|e| panic!("{path}: {e}; write it with BLESS=1"));
        assert_eq!(Table::from_bytes(&golden), Ok(table));
        assert!(golden == bytes, "the bytes of version 1.{minor} have changed: {name}");
        assert_eq!(bytes[10], minor, "the minor version");
    }
}

#[test]
fn extras_answer() {
    let [villa, wedges, named] = full();
    assert_eq!((villa.polygons_of(ObjectId(0)), villa.polygons_of(ObjectId(1))), (12, 0));
    assert_eq!(Table::new(rooms()).unwrap().polygons_of(ObjectId(1)), 1, "not known");
    assert_eq!((villa.mirrors().len(), villa.mirrors()[1].mirror), (2, MirrorId(u32::MAX)));
    assert_eq!(wedges.mirrors()[0].points.len(), 3);
    assert!(villa.planes().is_none() && wedges.planes().is_some_and(|planes| planes.slack() == 0.5));
    let names: Vec<&str> = (0..5).map(|i| named.cell_name(CellId(i)).unwrap()).collect();
    assert_eq!((names, named.has_cell_names()), (vec!["room0_Living Room", "hall", "", "Küche", "hall"], true));
    assert_eq!((villa.cell_name(CellId(4)), villa.has_cell_names()), (None, false));
    assert_eq!(named.strip_geometry().cell_name(CellId(3)), Some("Küche"), "a stripped table keeps names");
}

/// Names are independent: without their section the file of a named table is that of the same table without names.
#[test]
fn names_are_a_section_of_their_own() {
    let [villa, _, named] = full();
    let mut file = File::parse(&named.to_bytes());
    file.parts.retain(|part| part.id != *b"CNAM");
    file.minor = 2;
    assert_eq!(file.write(), villa.to_bytes());
    // The impostor: another name is another file.
    let mut parts = named.clone().into_parts();
    parts.cell_names[1].push('!');
    assert_ne!(Table::new(parts).unwrap().to_bytes(), named.to_bytes());
}

#[test]
#[should_panic(expected = "cell 5 of 5")]
fn an_unknown_cell_has_no_name() {
    Table::new(named_villa()).unwrap().cell_name(CellId(5));
}

/// Not even in a table without any names.
#[test]
#[should_panic(expected = "cell 5 of 5")]
fn an_unknown_cell_is_not_one_without_a_name() {
    Table::new(rooms()).unwrap().cell_name(CellId(5));
}

#[test]
#[should_panic(expected = "object 2 of 2")]
fn an_unknown_object_has_no_polygons() {
    Table::new(rooms()).unwrap().polygons_of(ObjectId(2));
}

/// Each defect alone is refused, with its position and a message.
#[test]
fn defects_of_extras_are_refused() {
    let refused = |parts: TableParts, spoil: &dyn Fn(&mut TableParts)| {
        let mut parts = parts;
        spoil(&mut parts);
        let error = Table::new(parts).unwrap_err();
        (error.clone(), error.to_string())
    };
    let (error, text) = refused(villa(), &|p| p.object_polygons.truncate(1));
    assert_eq!(error, TableError::ObjectPolygons { n: 1, n_objects: 2 });
    assert_eq!(text, "1 numbers of polygons do not fit 2 objects");
    for n in [1, 4, 6] {
        let (error, text) = refused(villa(), &|p| p.cell_names = vec!["room".to_owned(); n]);
        assert_eq!(error, TableError::CellNames { n, n_cells: 5 });
        assert_eq!(text, format!("{n} names of cells do not fit 5 cells"));
    }
    let (error, text) = refused(villa(), &|p| p.mirrors[1].cell = CellId(5));
    assert_eq!(error, TableError::MirrorCell { mirror: 1, cell: CellId(5) });
    assert_eq!(text, "mirror 1 is in cell 5, which does not exist");
    let (error, text) = refused(villa(), &|p| p.mirrors[1].points.push([0.0; 3]));
    assert_eq!(error, TableError::MirrorPoints { mirror: 1, n: 3 });
    assert_eq!(text, "mirror 1 cannot have 3 points");
    let two = |p: &mut TableParts| p.mirrors[0].points.truncate(2);
    assert_eq!(refused(wedges(), &two).0, TableError::MirrorPoints { mirror: 0, n: 2 });
    let (error, text) = refused(villa(), &|p| p.mirrors[0].points[1][0] = f64::NAN);
    assert_eq!(error, TableError::NotFinite { item: Item::Mirror, index: 0 });
    assert_eq!(text, "mirror 0 has a coordinate that is not a finite number");
    let upright = |p: &mut TableParts| p.mirrors[0].points[1][2] = -0.0;
    assert_eq!(refused(villa(), &upright).0, TableError::OffPlane { item: Item::Mirror, index: 0 });
}

/// Overwrites or replaces a section of the villa with names and returns the error, which must name the section.
fn forge(id: &[u8; 4], change: impl Fn(&mut Vec<u8>)) -> Kind {
    forged(&Table::new(named_villa()).unwrap(), id, change)
}

#[test]
fn forged_extras_are_refused() {
    let huge = u32::MAX.to_le_bytes();
    for at in [0, 12] {
        assert!(matches!(forge(b"MIRR", |b| b[at..at + 4].copy_from_slice(&huge)), Kind::Cut { .. }), "{at}");
    }
    let cell = TableError::MirrorCell { mirror: 0, cell: CellId(9) };
    assert_eq!(forge(b"MIRR", |b| b[4] = 9), Kind::Table(cell));
    assert!(matches!(forge(b"OPOL", |b| b.truncate(4)), Kind::Cut { .. }));
    assert!(matches!(forge(b"OPOL", |b| b.extend([0; 4])), Kind::Surplus { .. }));
    // Names: a length that is too large, a text that is not UTF-8, one name too few and one too many.
    assert!(matches!(forge(b"CNAM", |b| b[..4].copy_from_slice(&huge)), Kind::Cut { .. }));
    assert_eq!(forge(b"CNAM", |b| b[4] = 0xff), Kind::Text);
    assert!(matches!(forge(b"CNAM", |b| b.truncate(b.len() - 8)), Kind::Cut { .. }));
    assert!(matches!(forge(b"CNAM", |b| b.extend([0; 4])), Kind::Surplus { left: 4 }));
    assert!(matches!(forge(b"CNAM", |b| b.truncate(19)), Kind::Cut { need: 20, left: 19 }));
    // A number that is longer than necessary, one that does not fit, one that does not end.
    let replaced = |bytes: &'static [u8]| move |b: &mut Vec<u8>| *b = bytes.to_vec();
    assert_eq!(forge(b"STAB", replaced(&[0x80, 0])), Kind::Number);
    let long = [0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 2];
    assert_eq!(forge(b"STAB", |b| *b = long.to_vec()), Kind::Number);
    assert!(matches!(forge(b"STAB", replaced(&[0xff; 3])), Kind::Cut { .. }));
    // Too many groups, a group of no cell, a list without a gate, a child where none was, roots likewise.
    assert!(matches!(forge(b"STAB", replaced(&[100, 1])), Kind::Cut { .. }));
    assert_eq!(forge(b"STAB", replaced(&[1, 10, 2])), Kind::StabOrder);
    assert_eq!(forge(b"STAB", replaced(&[1, 0, 0])), Kind::StabOrder);
    assert!(matches!(forge(b"STAB", replaced(&[1, 0, 6])), Kind::Cut { .. }), "a child is promised");
    assert_eq!(forge(b"STAB", replaced(&[1, 0, 6, 0])), Kind::NoNode);
    assert_eq!(forge(b"STAB", replaced(&[0, 2, 0])), Kind::NoNode);
    // A node that is never referenced.
    assert_eq!(forge(b"STAB", replaced(&[1, 0, 2, 0, 0, 0, 0, 0, 0])), Kind::StabOrder);
    assert!(matches!(forge(b"STAB", |b| b.push(0)), Kind::Surplus { .. }));
    let text = |kind: Kind| kind.to_string();
    assert_eq!(text(Kind::Number), "the number is not written as short as it can be, or is too large");
    assert_eq!(text(Kind::NoNode), "the node of the stab trees is not there");
    assert_eq!(text(Kind::StabOrder), "the stab trees are not in order");
}

/// A table may consist of nothing but cells with mirrors.
#[test]
fn mirrors_have_any_number_of_corners_in_space() {
    let mut parts = wedges();
    let ring = (0..200).map(|i| [f64::from(i), 0.0, 0.0]).collect();
    parts.mirrors = vec![MirrorRecord { cell: CellId(0), mirror: MirrorId(3), points: ring }];
    let table = Table::new(parts).unwrap();
    assert_eq!(Table::from_bytes(&table.to_bytes()), Ok(table));
}
