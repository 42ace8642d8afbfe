//! The kind of a table: stored, refused where it is invalid, and derived from the texts of older files.

use crate::common::file::File;
use crate::common::full::{kinds, map_of_wedges};
use crate::common::rooms;
use sightlines_pvs::format::{kind_from_bytes, kind_from_info, kind_to_bytes};
use sightlines_pvs::{Axis, DecodeErrorKind, SceneMethods, Table, TableError, TableKind, TableParts};

fn texts(pairs: &[(&str, &str)]) -> Vec<(String, String)> {
    pairs.iter().map(|&(k, v)| (k.to_owned(), v.to_owned())).collect()
}

#[test]
fn every_kind_survives_a_file() {
    for kind in kinds() {
        for dimension in [2, 3] {
            for up in [None, Some(Axis::X), Some(Axis::Y), Some(Axis::Z)] {
                assert_eq!(kind_from_bytes(kind_to_bytes(kind, up)), Ok((kind, up)));
                let parts = TableParts { up, ..TableParts::empty(dimension, kind) };
                if kind.dimension().is_some_and(|d| d != dimension) {
                    assert_eq!(Table::new(parts), Err(TableError::Kind { kind, dimension }));
                    continue;
                }
                let table = Table::new(parts).expect("a table without cells");
                let bytes = table.to_bytes();
                assert_eq!(Table::from_bytes(&bytes), Ok(table));
                // Empty information is not written.
                let is_said = (kind, up) != (TableKind::Unspecified, None);
                assert_eq!(bytes[10], if is_said { 4 } else { 0 }, "the minor version");
            }
        }
    }
}

#[test]
fn numbers_that_are_not_known_are_refused_or_from_a_later_version() {
    let house = Table::new(map_of_wedges()).expect("a map");
    for (field, value) in [(0, 7), (0, u32::MAX), (1, 1), (1, 8), (2, 4)] {
        let mut file = File::parse(&house.to_bytes());
        file.part(b"KIND").bytes[4 * field..4 * field + 4].copy_from_slice(&u32::to_le_bytes(value));
        let error = Table::from_bytes(&file.write()).expect_err("a number without a meaning");
        assert_eq!((error.section.map(|id| id.0), error.kind), (Some(*b"KIND"), DecodeErrorKind::Value { value }));
        file.minor = sightlines_pvs::format::MINOR + 1;
        let later = Table::from_bytes(&file.write()).expect("a later version may have more kinds");
        assert_eq!((later.kind(), later.up()), (TableKind::Unspecified, None));
    }
    let mut file = File::parse(&Table::new(rooms()).expect("rooms").to_bytes());
    let mut kind = File::parse(&house.to_bytes()).part(b"KIND").clone();
    file.parts.push(kind.clone());
    let error = Table::from_bytes(&file.write()).expect_err("a Quake map in the plane");
    let wrong = TableError::Kind { kind: TableKind::QuakeMap, dimension: 2 };
    assert_eq!(error.kind, DecodeErrorKind::Table(wrong));
    kind.bytes.push(0);
    *file.part(b"KIND") = kind;
    assert_eq!(Table::from_bytes(&file.write()).expect_err("too long").kind, DecodeErrorKind::Surplus { left: 1 });
}

/// A dimension, the texts of an old table, and the kind that they stand for.
type OldTable = (u8, &'static [(&'static str, &'static str)], TableKind);

/// What programs before version 1.4 of the format left in the texts of each kind of table.
#[test]
fn older_files_are_understood() {
    let by = |sightlines, from_region| SceneMethods { sightlines, from_region, only_in_air: false };
    let in_air = SceneMethods { sightlines: false, from_region: true, only_in_air: true };
    let cases: [OldTable; 15] = [
        (2, &[("subdivide", "kd"), ("tau", "0")], TableKind::PlanKdTree),
        (2, &[("subdivide", "triangulation")], TableKind::PlanTriangulation),
        (3, &[("subdivide", "kd"), ("tau", "0")], TableKind::SceneKdTree { hidden_by: by(true, false) }),
        (3, &[("method", "sightlines"), ("subdivide", "kd")], TableKind::SceneKdTree { hidden_by: by(true, false) }),
        (3, &[("method", "sightlines+mfz"), ("subdivide", "kd")], TableKind::SceneKdTree { hidden_by: by(true, true) }),
        (3, &[("method", "mfz"), ("subdivide", "kd")], TableKind::SceneKdTree { hidden_by: by(false, true) }),
        (3, &[("method", "sheets"), ("subdivide", "boxes")], TableKind::SceneGivenCells { hidden_by: by(false, true) }),
        (
            3,
            &[("method", "voxels-closed-64"), ("subdivide", "boxes")],
            TableKind::SceneGivenCells { hidden_by: in_air },
        ),
        (3, &[("search", "full"), ("source", "portal file PRT1")], TableKind::QuakePortalFile),
        (3, &[("source", "Quake map BSP 29 with PRT1"), ("up", "z")], TableKind::QuakeMap),
        (2, &[("source", "Quake map BSP 29 with PRT1")], TableKind::Unspecified),
        (2, &[("subdivide", "boxes")], TableKind::Unspecified),
        (3, &[("subdivide", "triangulation")], TableKind::Unspecified),
        (3, &[("source", "by hand")], TableKind::Unspecified),
        (2, &[], TableKind::Unspecified),
    ];
    for (dimension, info, kind) in cases {
        let info = texts(info);
        assert_eq!(kind_from_info(dimension, &info).0, kind, "{info:?}");
        // A file without the section means the same; in one with it, the section decides.
        let parts = TableParts { info, ..TableParts::empty(dimension, kind) };
        let table = Table::new(parts).expect("a table without cells");
        let mut file = File::parse(&table.to_bytes());
        file.parts.retain(|part| part.id != *b"KIND");
        file.minor = 3;
        let read = Table::from_bytes(&file.write()).expect("an older file");
        assert_eq!(read.kind(), kind);
        let unspecified = TableParts { kind: TableKind::Unspecified, ..table.into_parts() };
        let table = Table::new(unspecified).expect("a table without cells");
        assert_eq!(Table::from_bytes(&table.to_bytes()), Ok(table), "texts do not overrule the section");
    }
    let ups = ["x", "y", "z", "w"].map(|up| kind_from_info(3, &texts(&[("up", up)])).1);
    assert_eq!(ups, [Some(Axis::X), Some(Axis::Y), Some(Axis::Z), None]);
}

#[test]
fn golden_v1_4_is_read_and_written() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden/v1_4.pvs");
    let table = Table::new(map_of_wedges()).expect("a map");
    let bytes = table.to_bytes();
    if std::env::var_os("BLESS").is_some_and(|v| v == "1") {
        std::fs::write(path, &bytes).expect("the golden file can be written");
    }
    let golden = std::fs::read(path).expect("tests/golden/v1_4.pvs is missing; write it with BLESS=1");
    assert_eq!(Table::from_bytes(&golden), Ok(table));
    assert!(golden == bytes, "the bytes of version 1.4 have changed");
    assert_eq!(bytes[10], 4, "the minor version");
}
