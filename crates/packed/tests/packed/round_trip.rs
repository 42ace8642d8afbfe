//! A packed table comes back unchanged.

use crate::common::{points, recipes, table};
use proptest::prelude::*;
use sightlines_packed::{PackOptions, Packed, PackedErrorKind, pack, pack_report};
use sightlines_pvs::format::kind_to_bytes;
use sightlines_pvs::{
    Axis, BitMatrix, CellId, CellRecord, Frame, Locator, ObjectId, PlaceBuffer, PortalId, Table, TableKind, TableParts,
};

/// Compares all queries of the packed table with the table; returns the number of comparisons.
pub(crate) fn compare(packed: &Packed<Vec<u8>>, table: &Table) -> usize {
    let (mut cells, mut numbers, mut n, mut buffer) = (Vec::new(), Vec::new(), 0, PlaceBuffer::new());
    let (mut nodes, mut ranges) = (Vec::new(), Vec::new());
    assert_eq!(packed.object_parts(), table.object_parts());
    assert_eq!((packed.n_cells(), packed.dimension()), (table.n_cells(), table.dimension()));
    assert_eq!((packed.kind(), packed.up()), (table.kind(), table.up()));
    assert_eq!((packed.info(), packed.mirrors(), packed.planes()), (table.info(), table.mirrors(), table.planes()));
    for p in points(table.dimension()) {
        assert_eq!(
            packed.cells_at(p, &mut buffer).unwrap().inside().unwrap_or_default(),
            table.place_at(p).cells(),
            "{p:?}"
        );
    }
    for (i, record) in (0u32..).zip(table.cells()) {
        let cell = CellId(i);
        packed.visible(cell, &mut cells).unwrap();
        assert!(cells.iter().copied().eq(table.visible(cell)));
        n += cells.len();
        let mut coarse = Vec::new();
        packed.coarse(cell, &mut coarse).unwrap();
        assert!(coarse.is_sorted() && cells.iter().all(|c| coarse.binary_search(c).is_ok()));
        packed.objects_of(cell, &mut numbers).unwrap();
        assert_eq!(numbers, table.objects_of(cell));
        packed.objects_seen(cell, &mut numbers).unwrap();
        assert_eq!(numbers, table.visible_objects(cell));
        packed.visible_ranges(cell, &mut ranges).unwrap();
        assert_eq!(ranges, table.visible_ranges(cell));
        assert_eq!(packed.cell_box(cell).unwrap(), (record.min, record.max));
        let mut polygon = Vec::new();
        packed.cell_polygon(cell, &mut polygon).unwrap();
        assert_eq!((&polygon, packed.group(cell).unwrap()), (&record.polygon, record.group));
        assert_eq!(packed.cell_name(cell).unwrap().as_deref(), table.cell_name(cell));
        let mut exits = Vec::new();
        packed
            .exits(cell, &mut |portal, forward, to, points| exits.push((portal, forward, to, points.to_vec())))
            .unwrap();
        let leads = |(k, portal): (usize, &sightlines_pvs::PortalRecord)| {
            let forward = portal.cells[0] == cell;
            let to = portal.cells[usize::from(forward)];
            portal.cells.contains(&cell).then(|| (PortalId(k as u32), forward, to, portal.points.clone()))
        };
        assert_eq!(exits, table.portals().iter().enumerate().filter_map(leads).collect::<Vec<_>>());
        let mut numbers = Vec::new();
        let open = packed.stab_roots(cell, &mut numbers).unwrap();
        match table.stab() {
            Some(stab) => assert_eq!((open, &numbers[..]), (stab.is_root_open(cell), stab.roots(cell))),
            None => assert!(open && numbers.is_empty()),
        }
    }
    assert_eq!((packed.doors(), packed.has_sources()), (table.doors(), table.has_sources()));
    for name in ["Tür", "", "door"] {
        assert!(packed.door(name).eq(table.door(name)));
    }
    for node in [0, 60, 120, 240, 1] {
        assert!(packed.objects_of_node(node).eq(table.objects_of_node(node)));
    }
    for (min, max) in [([0.0; 3], [2.0; 3]), ([1.0, 0.0, 0.0], [1.0, 1.0, 1.5]), ([-9.0; 3], [99.0; 3])] {
        assert_eq!(packed.portals_within(min, max).unwrap(), table.portals_within(min, max));
    }
    for (o, object) in (0u32..).map(ObjectId).zip(table.objects()) {
        assert_eq!(packed.source_of(o).unwrap(), table.source_of(o));
        assert_eq!(packed.object_box(o).unwrap(), (object.min, object.max));
        assert_eq!(
            (packed.object_name(o).unwrap(), packed.object_polygons(o).unwrap()),
            (object.name.clone(), table.polygons_of(o))
        );
    }
    for node in 0..packed.n_stab_nodes().unwrap_or(0) {
        let (stab, found) = (table.stab().unwrap(), packed.stab_node(node, &mut nodes).unwrap());
        assert_eq!(((found.portal, found.forward), found.open), (stab.gate(node), stab.is_open(node)));
        assert_eq!(nodes, stab.children(node));
        n += 1;
    }
    n
}

proptest! {
    #[test]
    fn a_table_comes_back_and_answers_the_same(recipe in recipes()) {
        let table = table(recipe);
        let (bytes, report) = pack_report(&table, &PackOptions::default()).unwrap();
        prop_assert_eq!(&bytes, &pack(&table, &PackOptions { max_bytes: Some(bytes.len() as u64), class: None }).unwrap());
        prop_assert_eq!((report.bytes, report.n_merges), (bytes.len() as u64, 0));
        let packed = Packed::open(bytes, 1 << 20).unwrap();
        compare(&packed, &table);
        packed.verify().unwrap();
        prop_assert_eq!(packed.to_table().unwrap(), table);
    }
}

/// Names are a separate store: without them a file has version 1.0, and the rest of it is unchanged.
#[test]
fn names_come_and_go_alone() {
    let named = table((3, 6, 5, 7, 0xFF));
    let mut parts = named.clone().into_parts();
    parts.cell_names.clear();
    let bare = Table::new(parts).unwrap();
    let [with, without] = [&named, &bare].map(|table| pack(table, &PackOptions::default()).unwrap());
    assert_eq!([&with, &without].map(|bytes| u16::from_le_bytes([bytes[10], bytes[11]])), [1, 0]);
    let [with, without] = [with, without].map(|bytes| Packed::open(bytes, 1 << 16).unwrap());
    assert!(with.has_cell_names() && !without.has_cell_names());
    assert_eq!((without.cell_name(CellId(3)).unwrap(), without.to_table().unwrap()), (None, bare));
    assert_eq!(with.cell_name(CellId(2)).unwrap().as_deref(), Some("KücheKücheKüche"));
    // Every part except the names and the index of blocks is as long as before; names are not resident.
    let index = sightlines_pvs::SectionId(*b"BLKS");
    let rest = |packed: &Packed<Vec<u8>>| {
        packed.part_sizes().into_iter().filter(|part| part.id.0 != *b"CNAM" && part.id != index).collect::<Vec<_>>()
    };
    assert_eq!(rest(&with), rest(&without));
    let names: Vec<_> = with.part_sizes().into_iter().filter(|part| part.id.0 == *b"CNAM").collect();
    assert!(matches!(names[..], [part] if part.bytes > 0 && !part.resident));
    // Merged cells keep their names, each its own: ids stay.
    let (_, report) = pack_report(&named, &PackOptions::default()).unwrap();
    let max_bytes = Some(report.bytes - report.row_bytes / 4);
    let (bytes, report) = pack_report(&named, &PackOptions { max_bytes, class: None }).unwrap();
    assert!(report.n_merges > 0);
    let merged = Packed::open(bytes, 0).unwrap().to_table().unwrap();
    assert_eq!(merged.parts().cell_names, named.parts().cell_names);
}

/// The comparison can fail: a table with one pair less differs.
#[test]
fn impostor_a_table_without_a_pair_is_found_out() {
    let table = table((2, 6, 5, 7, 0xFF));
    let mut parts = table.clone().into_parts();
    let (a, b) = (0..30).flat_map(|a| (0..a).map(move |b| (a, b))).find(|&(a, b)| parts.rows.get(a, b)).unwrap();
    parts.rows.set(a, b, false);
    parts.rows.set(b, a, false);
    let other = Packed::open(pack(&Table::new(parts).unwrap(), &PackOptions::default()).unwrap(), 0).unwrap();
    assert_ne!(other.to_table().unwrap(), table);
    assert!(std::panic::catch_unwind(|| compare(&other, &table)).is_err());
    let same = Packed::open(pack(&table, &PackOptions::default()).unwrap(), 0).unwrap();
    assert!(compare(&same, &table) > 100);
}

#[test]
fn what_is_not_there_is_an_error_that_says_so() {
    let table = table((2, 4, 2, 5, 0xFF));
    let packed = Packed::open(pack(&table, &PackOptions::default()).unwrap(), 0).unwrap();
    let (mut cells, mut numbers) = (vec![CellId(1)], vec![1]);
    let errors = [
        packed.visible(CellId(8), &mut cells).unwrap_err(),
        packed.object_box(ObjectId(packed.n_objects() as u32)).unwrap_err(),
        packed.portal(PortalId(u32::MAX)).unwrap_err(),
        packed.cell_name(CellId(8)).unwrap_err(),
        packed.stab_node(u32::MAX, &mut numbers).unwrap_err(),
    ];
    assert!(cells.is_empty() && numbers.is_empty());
    let texts: Vec<String> = errors.iter().map(ToString::to_string).collect();
    assert_eq!(texts[0], "there is no cell 8, only 8");
    assert_eq!(texts[1], format!("there is no object {0}, only {0}", packed.n_objects()));
    assert_eq!(texts[2], "there is no portal 4294967295, only 10");
    let error = packed.in_dimension::<3>().unwrap_err();
    assert_eq!(error.to_string(), "the table has 2 dimensions, not 3");
    assert_eq!(texts[3], "there is no cell 8, only 8");
    assert!(texts[4].starts_with("there is no node 4294967295, only "));
    let error = Packed::open(b"\x89PVS\r\n\x1a\n".to_vec(), 0).unwrap_err();
    assert!(matches!(error.kind, PackedErrorKind::Magic));
    assert_eq!(error.to_string(), "byte 0: this is no packed visibility table");
}

/// The section `KIND` of a packed table, renamed to an unknown id, or changed; with correct checksums.
fn with_kind(bytes: &[u8], id: [u8; 4], content: Option<[u8; 12]>, minor: u8) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    bytes[10] = minor;
    let number = |bytes: &[u8], at: usize| u32::from_le_bytes(std::array::from_fn(|i| bytes[at + i]));
    let n = number(&bytes, 12) as usize;
    let entry = (0..n).map(|i| 24 + 24 * i).find(|&at| bytes[at..at + 4] == *b"KIND").expect("the kind is stored");
    bytes[entry..entry + 4].copy_from_slice(&id);
    if let Some(content) = content {
        let at = number(&bytes, entry + 8) as usize;
        bytes[at..at + 12].copy_from_slice(&content);
        bytes[entry + 20..entry + 24].copy_from_slice(&crc32fast::hash(&content).to_le_bytes());
    }
    let crc = crc32fast::hash(&bytes[..24 + 24 * n]).to_le_bytes();
    bytes[24 + 24 * n..28 + 24 * n].copy_from_slice(&crc);
    bytes
}

#[test]
fn kinds_are_stored_and_older_files_understood() {
    let info = vec![("source".to_owned(), "portal file PRT1".to_owned()), ("up".to_owned(), "z".to_owned())];
    let kind = TableKind::QuakePortalFile;
    let table = Table::new(TableParts { info, up: Some(Axis::Z), ..TableParts::empty(3, kind) }).unwrap();
    let bytes = pack(&table, &PackOptions::default()).unwrap();
    let made = |bytes: Vec<u8>| Packed::open(bytes, 0).map(|packed| (packed.kind(), packed.up(), packed.has_places()));
    assert_eq!(bytes[10], 2, "the minor version");
    let known = (kind, Some(Axis::Z), false);
    assert_eq!(made(bytes.clone()).unwrap(), known);
    // As before version 1.2, from the texts.
    assert_eq!(made(with_kind(&bytes, *b"xIND", None, 1)).unwrap(), known);
    // The section, if there is one, takes precedence over the texts.
    let other = kind_to_bytes(TableKind::QuakeMap, None);
    assert_eq!(made(with_kind(&bytes, *b"KIND", Some(other), 2)).unwrap(), (TableKind::QuakeMap, None, false));
    let unknown = [9; 12];
    let error = made(with_kind(&bytes, *b"KIND", Some(unknown), 2)).unwrap_err();
    assert!(matches!(error.kind, PackedErrorKind::Value { .. }), "{error}");
    let later = sightlines_packed::format::MINOR as u8 + 1;
    assert_eq!(made(with_kind(&bytes, *b"KIND", Some(unknown), later)).unwrap(), (TableKind::Unspecified, None, true));
}

/// A table with a frame: packed and back it is the same, and points are found in the same cells.
#[test]
fn frames_are_packed() {
    let frame = Frame::new([[0.8, 0.6, 0.0], [-0.6, 0.8, 0.0], [0.0, 0.0, 1.0]], 0.25).unwrap();
    let cell = |i: u32| {
        let x = 2.0 * f64::from(i);
        CellRecord { min: [x, 0.0, 0.0], max: [x + 2.0, 3.0, 4.0], group: None, polygon: Vec::new() }
    };
    let cells: Vec<CellRecord> = (0..40).map(cell).collect();
    let bounds: Vec<_> = cells.iter().map(|c| (c.min, c.max)).collect();
    let parts = TableParts {
        rows: BitMatrix::identity(40),
        cell_objects: vec![Vec::new(); 40],
        locator: Locator::build(&bounds, 3),
        cells,
        frame: Some(frame),
        ..TableParts::empty(3, TableKind::Unspecified)
    };
    let table = Table::new(parts).unwrap();
    let bytes = pack(&table, &PackOptions::default()).unwrap();
    assert_eq!(bytes[10], 3, "the minor version");
    let packed = Packed::open(bytes, 1 << 20).unwrap();
    assert_eq!((packed.frame(), packed.to_table().unwrap()), (table.frame(), table.clone()));
    let mut buffer = PlaceBuffer::new();
    let mut n_several = 0;
    for i in 0..400 {
        let p = frame.to_scene([f64::from(i) * 0.21 - 1.0, 2.9, 1.0]);
        let found = packed.cells_at(p, &mut buffer).unwrap().inside().unwrap_or_default();
        assert_eq!(found, table.place_at(p).cells(), "{p:?}");
        n_several += usize::from(found.len() > 1);
    }
    assert!(n_several > 20, "{n_several} points near borders");
}
