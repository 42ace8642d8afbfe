//! Doors, and where objects are in their file: found again, stored, and refused where they are invalid.

use crate::common::file::{
    File, assert_damage_is_noticed, assert_every_changed_byte_is_an_error, assert_every_prefix_is_an_error, changes,
    forge_every_byte, forged,
};
use crate::common::full::{named_villa, wedges};
use crate::common::{any_parts, assert_well_formed};
use proptest::prelude::*;
use proptest::sample::Index;
use sightlines_pvs::{
    DecodeErrorKind as Kind, DoorId, DoorRecord, Frame, ObjectId, ObjectSource, PortalId, Table, TableError, TableParts,
};

fn door(name: &str, object: Option<u32>, portals: &[u32]) -> DoorRecord {
    let portals = portals.iter().copied().map(PortalId).collect();
    DoorRecord { name: name.to_owned(), object: object.map(ObjectId), portals }
}

fn source(node: u32, primitive: u32) -> Option<ObjectSource> {
    Some(ObjectSource { node, primitive })
}

/// The villa with two doors of one name, one that closes nothing, and a lamp that is a primitive of a node.
fn doored_villa() -> TableParts {
    let doors = vec![door("Tür", Some(1), &[0, 2]), door("hatch", None, &[1]), door("Tür", None, &[])];
    TableParts { doors, object_sources: vec![source(7, 1), None], ..named_villa() }
}

fn table() -> Table {
    Table::new(doored_villa()).expect("a table")
}

type AnyDoor = (String, Option<Index>, u32);
type AnySource = (u8, u8);
type AnyParts = (TableParts, Vec<AnyDoor>, Option<Vec<AnySource>>, Vec<[i8; 3]>);

/// Random tables with doors and sources of objects; the corners of each portal are of their own, on a small grid.
fn any_doored() -> impl Strategy<Value = TableParts> {
    let doors = prop::collection::vec((".{0,4}", prop::option::of(any::<Index>()), any::<u32>()), 0..5);
    let sources = prop::option::of(prop::collection::vec((0u8..4, any::<u8>()), 4));
    let corners = prop::collection::vec(prop::array::uniform3(-2i8..3), 1..40);
    (any_parts(), doors, sources, corners).prop_map(with_doors)
}

fn with_doors((mut parts, doors, sources, corners): AnyParts) -> TableParts {
    let (flat, n_objects, n_portals) = (parts.dimension == 2, parts.objects.len(), parts.portals.len() as u32);
    let mut next = corners.iter().cycle();
    for p in parts.portals.iter_mut().flat_map(|portal| &mut portal.points) {
        let [x, y, z] = next.next().expect("an endless cycle").map(f64::from);
        *p = [x, y, if flat { 0.0 } else { z }];
    }
    let record = |(name, object, mask): AnyDoor| DoorRecord {
        name,
        object: object.filter(|_| n_objects > 0).map(|at| ObjectId(at.index(n_objects) as u32)),
        portals: (0..n_portals).filter(|k| mask >> (k % 32) & 1 == 1).map(PortalId).collect(),
    };
    parts.doors = doors.into_iter().map(record).collect();
    let of = |(node, primitive): AnySource| source(node.into(), primitive.into()).filter(|_| node > 0);
    parts.object_sources = sources.map_or(Vec::new(), |all| all.into_iter().take(n_objects).map(of).collect());
    parts
}

/// Another method: whether each of a lattice of points of a polygon, in units of a quarter, is in the box.
fn is_covered(points: &[[f64; 3]], d: usize, min: [i32; 3], max: [i32; 3]) -> bool {
    let whole = |p: &[f64; 3]| p.map(|x| x as i32);
    let all: Vec<[i32; 3]> = points.iter().map(whole).collect();
    let holds = |p: [i32; 3]| (0..d).all(|k| 4 * min[k] <= p[k] && p[k] <= 4 * max[k]);
    all.iter().all(|a| all.iter().all(|b| (0..=4).all(|w| holds(std::array::from_fn(|k| w * a[k] + (4 - w) * b[k])))))
}

proptest! {
    #[test]
    fn doors_round_trip_is_bit_identical(parts in any_doored()) {
        let table = Table::new(parts).unwrap();
        let bytes = table.to_bytes();
        let read = Table::from_bytes(&bytes).unwrap();
        prop_assert_eq!(&read, &table);
        prop_assert_eq!(&read.to_bytes(), &bytes);
        let bare = table.strip_geometry();
        prop_assert!(bare.doors().is_empty());
        prop_assert_eq!(&bare.parts().object_sources, &table.parts().object_sources);
        prop_assert_eq!(Table::from_bytes(&bare.to_bytes()).unwrap(), bare);
        // Without either section, the version is as it was.
        prop_assert_eq!(bytes[10] == 7, !table.doors().is_empty() || !table.parts().object_sources.is_empty());
    }

    #[test]
    fn door_damage_is_an_error(parts in any_doored(), at in any::<Index>(), flip in 1u8..=255) {
        assert_damage_is_noticed(&Table::new(parts).unwrap(), at, flip);
    }

    #[test]
    fn door_forgeries_are_errors_or_tables(parts in any_doored(), changes in changes()) {
        let mut file = File::parse(&Table::new(parts).unwrap().to_bytes());
        let new: Vec<usize> = (0..file.parts.len()).filter(|&i| is_new(&file.parts[i].id)).collect();
        for change in changes.into_iter().filter(|_| !new.is_empty()) {
            change.apply(&mut file.parts[new[change.part.index(new.len())]].bytes);
        }
        let bytes = file.write();
        if let Ok(table) = Table::from_bytes(&bytes) {
            assert_well_formed(&table);
            assert_answers(&table);
            // Empty sections are not written again.
            prop_assert!(table.doors().is_empty() || table.to_bytes() == bytes);
        }
    }

    /// Invariant: doors by name, objects by node, and portals by box are those that a walk over all of them finds.
    #[test]
    fn doors_objects_and_portals_are_found(parts in any_doored(), low in prop::array::uniform3(-3i32..3), size in prop::array::uniform3(0i32..6)) {
        let table = Table::new(parts).unwrap();
        assert_answers(&table);
        let high: [i32; 3] = std::array::from_fn(|k| low[k] + size[k]);
        let found = table.portals_within(low.map(f64::from), high.map(f64::from));
        let d = usize::from(table.dimension());
        for (id, portal) in (0u32..).map(PortalId).zip(table.portals()) {
            prop_assert_eq!(found.contains(&id), is_covered(&portal.points, d, low, high), "{:?}", portal);
        }
        prop_assert!(found.is_sorted_by(|a, b| a < b));
        // A unit in the last place less on the side where the portal is, and it is no longer covered.
        if let Some(portal) = found.first().map(|id| &table.portals()[id.idx()]) {
            let x = portal.points.iter().map(|p| p[0]).fold(f64::MIN, f64::max);
            let mut short = high.map(f64::from);
            short[0] = x.next_down();
            prop_assert!(!table.portals_within(low.map(f64::from), short).contains(&found[0]));
        }
    }
}

/// Every door, node and object is found as the parts list them.
fn assert_answers(table: &Table) {
    let parts = table.parts();
    for record in &parts.doors {
        let named: Vec<DoorId> = table.door(&record.name).collect();
        let all = (0u32..).map(DoorId).zip(&parts.doors).filter(|(_, other)| other.name == record.name);
        assert_eq!(named, all.map(|(id, _)| id).collect::<Vec<_>>());
    }
    let objects = || (0..parts.objects.len() as u32).map(ObjectId);
    for node in 0..6 {
        let of: Vec<ObjectId> = table.objects_of_node(node).collect();
        let all = objects().filter(|&o| table.source_of(o).is_some_and(|source| source.node == node));
        assert_eq!(of, all.collect::<Vec<_>>(), "node {node}");
    }
    assert_eq!(table.has_sources(), objects().any(|o| table.source_of(o).is_some()));
}

fn is_new(id: &[u8; 4]) -> bool {
    [b"OSRC", b"DOOR"].contains(&id)
}

/// Every strict prefix, every byte changed into every other value; and every byte of the new sections with correct checksums.
#[test]
fn every_prefix_and_changed_byte_of_doors_is_an_error() {
    let table = table();
    assert_every_prefix_is_an_error(&table);
    assert_every_changed_byte_is_an_error(&table);
    let [n_tables, n_errors] = forge_every_byte(&table, is_new, |read| {
        assert_well_formed(read);
        assert_answers(read);
    });
    assert!(n_tables > 1000 && n_errors > 1000, "{n_tables} tables, {n_errors} errors");
}

/// The file of version 1.7 must be read as long as there is a reader.
#[test]
fn golden_v1_7_is_read_and_written() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden/v1_7.pvs");
    let bytes = table().to_bytes();
    if std::env::var_os("BLESS").is_some_and(|v| v == "1") {
        std::fs::write(path, &bytes).unwrap();
    }
    let golden = std::fs::read(path).expect("tests/golden/v1_7.pvs is missing; write it with BLESS=1");
    assert_eq!(Table::from_bytes(&golden), Ok(table()));
    assert!(golden == bytes && bytes[10] == 7, "the bytes of version 1.7 have changed");
}

/// Both sections may be skipped; without their portals, doors are refused.
#[test]
fn doors_and_sources_are_sections_of_their_own() {
    let file = File::parse(&table().to_bytes());
    let without = |ids: &[&[u8; 4]]| {
        let mut fewer = file.clone();
        fewer.parts.retain(|part| !ids.contains(&&part.id));
        Table::from_bytes(&fewer.write())
    };
    let bare = Table::new(named_villa()).unwrap();
    assert_eq!(without(&[b"OSRC", b"DOOR"]), Ok(bare.clone()));
    let error = without(&[b"PORT", b"STAB"]).unwrap_err();
    assert_eq!(error.section.unwrap().0, *b"DOOR");
    let mut renamed = file.clone();
    renamed.parts.iter_mut().filter(|part| is_new(&part.id)).for_each(|part| part.id[0] = b'x');
    assert_eq!(Table::from_bytes(&renamed.write()), Ok(bare), "a reader that does not have them");
}

#[test]
fn doors_and_sources_answer() {
    let table = table();
    assert_eq!(table.door("Tür").collect::<Vec<_>>(), [DoorId(0), DoorId(2)]);
    assert_eq!(table.door("hatch").collect::<Vec<_>>(), [DoorId(1)]);
    assert_eq!(table.door("Hatch").count(), 0);
    assert_eq!(table.doors()[0].portals, [PortalId(0), PortalId(2)]);
    assert_eq!((table.source_of(ObjectId(0)), table.source_of(ObjectId(1))), (source(7, 1), None));
    assert_eq!(table.objects_of_node(7).collect::<Vec<_>>(), [ObjectId(0)]);
    assert!(table.objects_of_node(6).next().is_none() && table.objects_of_node(u32::MAX).next().is_none());
    // The doors of the rooms are at x = 4, 8 and 12; a height does not count in a plane.
    let within = |min: [f64; 2], max: [f64; 2]| table.portals_within([min[0], min[1], 5.0], [max[0], max[1], 5.0]);
    assert_eq!(within([4.0, 0.0], [4.0, 1.0]), [PortalId(0)], "the box is closed");
    assert_eq!(within([0.0, 0.0], [20.0, 9.0]), [PortalId(0), PortalId(1), PortalId(2)]);
    assert_eq!(within([4.0, 0.0], [4.0, 1.0f64.next_down()]), []);
    assert_eq!(within([4.0, f64::NAN], [4.0, 1.0]), []);
    assert_eq!(within([5.0, 1.0], [3.0, 0.0]), [], "corners the wrong way round");
}

/// With a frame, the box is one of the scene, and has to hold everything within the gap of a portal.
#[test]
fn boxes_are_taken_into_frames() {
    let frame = |gap: f64| Frame::new([[0.8, 0.6, 0.0], [-0.6, 0.8, 0.0], [0.0, 0.0, 1.0]], gap).unwrap();
    let table = |gap: f64| Table::new(TableParts { frame: Some(frame(gap)), ..wedges() }).unwrap();
    // The portal stands on the diagonal of a square of four units: in the scene, from the origin to (0.8, 5.6).
    let within = |gap: f64, wide: f64| {
        let (min, max) = ([-wide; 3], [0.8 + wide, 5.6 + wide, 4.0 + wide]);
        table(gap).portals_within(min, max).len()
    };
    assert_eq!((within(0.0, 1e-9), within(0.0, -1e-9)), (1, 0));
    // Within the gap of a corner is a box along the frame: 1.4 gaps wide to each side of x and y, in the scene.
    assert_eq!((within(0.5, 0.7 + 1e-9), within(0.5, 0.7 - 1e-9)), (1, 0));
    // The impostor: a box that is taken to stand along the frame covers another place.
    let along = table(0.0).with_frame(None).unwrap();
    assert_eq!(along.portals_within([-1e-9; 3], [0.8 + 1e-9, 5.6 + 1e-9, 4.0 + 1e-9]), []);
}

/// Each defect alone is refused, with its position and a message.
#[test]
fn defects_of_doors_are_refused() {
    let refused = |spoil: &dyn Fn(&mut TableParts)| {
        let mut parts = doored_villa();
        spoil(&mut parts);
        let error = Table::new(parts).unwrap_err();
        (error.clone(), error.to_string())
    };
    let (error, text) = refused(&|p| p.doors[1].object = Some(ObjectId(2)));
    assert_eq!(error, TableError::DoorObject { door: DoorId(1), object: ObjectId(2) });
    assert_eq!(text, "door 1 is object 2, which does not exist");
    let (error, text) = refused(&|p| p.doors[0].portals.push(PortalId(3)));
    assert_eq!(error, TableError::DoorPortal { door: DoorId(0), portal: PortalId(3) });
    assert_eq!(text, "door 0 closes portal 3, which does not exist");
    let (error, text) = refused(&|p| p.doors[0].portals.push(PortalId(2)));
    assert_eq!(error, TableError::DoorOrder(DoorId(0)));
    assert_eq!(text, "the portals of door 0 are not ascending");
    let others = Table::new(named_villa()).unwrap().with_doors(doored_villa().doors).unwrap();
    assert_eq!(others.doors(), table().doors());
    let error = others.with_doors(vec![door("new", None, &[9])]).unwrap_err();
    assert_eq!(error, TableError::DoorPortal { door: DoorId(0), portal: PortalId(9) });
    let (error, text) = refused(&|p| p.object_sources.truncate(1));
    assert_eq!(error, TableError::ObjectSources { n: 1, n_objects: 2 });
    assert_eq!(text, "1 sources of objects do not fit 2 objects");
    let (error, text) = refused(&|p| p.object_sources[1] = source(u32::MAX, 0));
    assert_eq!(error, TableError::ObjectNode(ObjectId(1)));
    assert_eq!(text, "object 1 cannot be of node 4294967295");
}

fn forge(id: &[u8; 4], change: impl Fn(&mut Vec<u8>)) -> Kind {
    forged(&table(), id, change)
}

#[test]
fn forged_doors_are_refused() {
    let huge = u32::MAX.to_le_bytes();
    for at in [0, 8] {
        assert!(matches!(forge(b"DOOR", |b| b[at..at + 4].copy_from_slice(&huge)), Kind::Cut { .. }), "{at}");
    }
    assert_eq!(forge(b"DOOR", |b| b[12] = 0xff), Kind::Text);
    let object = TableError::DoorObject { door: DoorId(0), object: ObjectId(8) };
    assert_eq!(forge(b"DOOR", |b| b[4] = 9), Kind::Table(object));
    assert!(matches!(forge(b"DOOR", |b| b.push(0)), Kind::Surplus { .. }));
    assert!(matches!(forge(b"OSRC", |b| b.truncate(8)), Kind::Cut { .. }));
    assert!(matches!(forge(b"OSRC", |b| b.extend([0; 8])), Kind::Surplus { .. }));
    assert_eq!(forge(b"OSRC", |b| b[12] = 0), Kind::Table(TableError::ObjectNode(ObjectId(1))));
}

#[test]
#[should_panic(expected = "object 2 of 2")]
fn an_unknown_object_has_no_source() {
    table().source_of(ObjectId(2));
}
