//! Which parts make a table, which are refused, and the answers of its queries.

use crate::common::{any_parts, assert_well_formed, located, rooms};
use proptest::prelude::*;
use sightlines_pvs::{BitMatrix, CellId, CellRecord, Item, Locator, LocatorError, LocatorNode, ObjectId};
use sightlines_pvs::{DimensionError, Place, PlaceBuffer, Table, TableError, TableKind, TableParts};

/// The first grid point, half-way points included, at which the table and brute force differ.
fn misplaced(table: &Table) -> Option<(Vec<f64>, Vec<CellId>, Vec<CellId>)> {
    let steps = || (-9i8..19).map(|i| f64::from(i) / 2.0);
    let zs: Vec<f64> = if table.dimension() == 2 { vec![0.0] } else { vec![-4.0, -0.5, 1.0, 2.0] };
    let points = zs.into_iter().flat_map(|z| steps().flat_map(move |y| steps().map(move |x| [x, y, z])));
    let n = usize::from(table.dimension());
    let both = |p: [f64; 3]| (table.place_at(p).cells().to_vec(), located(table.cells(), &p[..n]), p[..n].to_vec());
    points.map(both).find(|(a, b, _)| a != b).map(|(a, b, p)| (p, a, b))
}

proptest! {
    /// Invariant: a point is located in exactly the cells whose closed outline contains it. (On a small grid the error
    /// bound never matters.)
    #[test]
    fn location_is_what_brute_force_says(parts in any_parts()) {
        let table = Table::new(parts).unwrap();
        prop_assert_eq!(misplaced(&table), None);
        assert_well_formed(&table);
    }

    /// Invariant: a point sees what any cell there sees.
    #[test]
    fn view_from_a_point_unites_rows(parts in any_parts(), p in [-9i8..10, -9i8..10, -9i8..10]) {
        let table = Table::new(parts).unwrap();
        let p = p.map(|x| f64::from(x) / 2.0);
        let here = located(table.cells(), &p[..usize::from(table.dimension())]);
        let ids = (0..table.n_cells() as u32).map(CellId);
        let expected: Vec<CellId> = ids.filter(|&b| here.iter().any(|&a| table.sees(a, b))).collect();
        let mut buffer = PlaceBuffer::new();
        let Place::Inside(at) = table.place_at(p) else {
            prop_assert!(here.is_empty() && table.place_at_with(p, &mut buffer).is_outside());
            return Ok(());
        };
        prop_assert_eq!(at.cells(), here.as_slice());
        prop_assert_eq!(at.visible_cells().collect::<Vec<_>>(), expected.clone());
        let seen = at.visible_set();
        prop_assert_eq!((seen.len(), seen.is_empty()), (expected.len(), false));
        prop_assert!((0..table.n_cells() as u32 + 70).map(CellId).all(|c| at.sees(c) == expected.contains(&c) && at.sees(c) == seen.contains(c)));
        let touched = |o: &ObjectId| expected.iter().any(|&c| table.objects_of(c).contains(o));
        let objects: Vec<ObjectId> = (0..table.objects().len() as u32).map(ObjectId).filter(touched).collect();
        prop_assert_eq!(table.objects_in(&seen), objects.clone());
        // The same with a buffer, and in the dimension of the table only.
        let with = table.place_at_with(p, &mut buffer).inside().expect("inside as before");
        let mut listed = vec![ObjectId(7); 3];
        with.visible_objects_into(&mut listed);
        let objects = if table.parts().objects_seen.is_none() { objects } else { at.visible_objects() };
        prop_assert_eq!((with.cells(), listed), (at.cells(), objects));
        let flat = table.in_dimension().map(|query| query.at([p[0], p[1]]).cells().to_vec());
        let spatial = table.in_dimension().map(|query| query.at(p).cells().to_vec());
        let wrong = |points| DimensionError { table: table.dimension(), points };
        let expected = if table.dimension() == 2 { (Ok(here.clone()), Err(wrong(3))) } else { (Err(wrong(2)), Ok(here.clone())) };
        prop_assert_eq!((flat, spatial), expected);
    }

    /// Invariant: a box touches the cells that its points are located in, and only cells whose box it touches; the
    /// visitor is not called again after it returned `false`.
    #[test]
    fn boxes_touch_the_cells_of_their_points(parts in any_parts(), p in [-9i8..10, -9i8..10, -4i8..5], size in [0i8..4, 0i8..4, 0i8..4]) {
        let table = Table::new(parts).unwrap();
        let n = usize::from(table.dimension());
        let half = |k: usize, x: i8| if k < n { f64::from(x) / 2.0 } else { 0.0 };
        let (min, max): ([f64; 3], [f64; 3]) = (std::array::from_fn(|k| half(k, p[k])), std::array::from_fn(|k| half(k, p[k] + size[k])));
        let mut touched = Vec::new();
        table.for_each_touching(min, max, &mut Vec::new(), |cell| { touched.push(cell); true });
        for i in 0..64i8 {
            let step = [i % 4, i / 4 % 4, i / 16];
            let at: [f64; 3] = std::array::from_fn(|k| half(k, p[k] + step[k].min(size[k])));
            prop_assert!(table.place_at(at).cells().iter().all(|cell| touched.contains(cell)), "{:?}", at);
        }
        for cell in &touched {
            let cell = &table.cells()[cell.idx()];
            prop_assert!((0..3).all(|k| cell.min[k] <= max[k] && min[k] <= cell.max[k]));
        }
        let mut n_visited = 0;
        table.for_each_touching(min, max, &mut Vec::new(), |_| { n_visited += 1; false });
        prop_assert_eq!(n_visited, usize::from(!touched.is_empty()));
    }

    /// Invariant: a stripped table has the same rows and finds a point in no fewer cells.
    #[test]
    fn stripping_only_adds_cells(parts in any_parts(), p in [-9i8..10, -9i8..10, -9i8..10]) {
        let table = Table::new(parts).unwrap();
        let bare = table.strip_geometry();
        assert_well_formed(&bare);
        prop_assert!(bare.portals().is_empty());
        prop_assert_eq!(&bare.parts().rows, &table.parts().rows);
        let p = p.map(|x| f64::from(x) / 2.0);
        let found = bare.place_at(p);
        prop_assert!(table.place_at(p).cells().iter().all(|cell| found.cells().contains(cell)));
    }

    /// The impostor: a table with one visible pair removed on one side only is refused.
    #[test]
    fn impostor_asymmetric_is_refused(mut parts in any_parts(), at in any::<prop::sample::Index>()) {
        let n = parts.cells.len();
        let pairs: Vec<(usize, usize)> =
            (0..n).flat_map(|a| parts.rows.iter_ones(a).map(move |b| (a, b))).filter(|(a, b)| a != b).collect();
        prop_assume!(!pairs.is_empty());
        let (a, b) = pairs[at.index(pairs.len())];
        parts.rows.set(a, b, false);
        let pair = [a.max(b), a.min(b)].map(|i| CellId(i as u32));
        let either = [pair, [pair[1], pair[0]]].map(TableError::NotSymmetric);
        let error = Table::new(parts).unwrap_err();
        prop_assert!(either.contains(&error), "{:?}", error);
    }

    /// The impostor: a cell that does not see itself is refused.
    #[test]
    fn impostor_without_diagonal_is_refused(mut parts in any_parts(), at in any::<prop::sample::Index>()) {
        prop_assume!(!parts.cells.is_empty());
        let cell = at.index(parts.cells.len());
        parts.rows.set(cell, cell, false);
        prop_assert_eq!(Table::new(parts).unwrap_err(), TableError::NotReflexive(CellId(cell as u32)));
    }
}

/// The impostor for point location: brute force detects a table whose cell is not where its locator has it, and no
/// table can be made from a locator that misses a cell.
#[test]
fn impostor_locator_is_caught() {
    let mut parts = rooms();
    let mut nodes = parts.locator.to_nodes();
    for node in &mut nodes {
        if let LocatorNode::Leaf { cells } = node {
            cells.retain(|cell| cell.0 != 1);
        }
    }
    let locator = Locator::from_nodes(&nodes).unwrap();
    let mut found = vec![];
    locator.for_each_candidate([5.0, 1.0, 0.0], |cell| found.push(cell));
    assert!(!found.contains(&CellId(1)) && located(&parts.cells, &[5.0, 1.0]).contains(&CellId(1)));
    parts.locator = locator;
    let Err(TableError::Locator(error)) = Table::new(parts) else { panic!("an impostor") };
    assert!(matches!(error, LocatorError::Misses { cell: CellId(1), .. }));
    assert_eq!(misplaced(&Table::new(rooms()).unwrap()), None);
}

/// The same, through the comparison itself: the oracle reads the cells, so a moved cell is a difference.
#[test]
fn impostor_comparison_can_fail() {
    let table = Table::new(rooms()).unwrap();
    let mut cells = table.cells().to_vec();
    cells[4].polygon[2] = [0.0, 7.0];
    let p = [0.0, 7.5];
    assert_ne!(table.in_dimension().unwrap().at(p).cells().to_vec(), located(&cells, &p));
}

#[test]
fn small_house_answers() {
    let table = Table::new(rooms()).unwrap();
    assert_well_formed(&table);
    assert_eq!((table.n_cells(), table.portals().len(), table.objects().len()), (5, 3, 2));
    assert!(!table.sees(CellId(0), CellId(3)) && table.sees(CellId(3), CellId(1)));
    assert_eq!(table.row(CellId(1)), [0b1111]);
    assert_eq!(table.visible_objects(CellId(0)), [ObjectId(0)]);
    assert_eq!(table.visible_objects(CellId(1)), [ObjectId(0), ObjectId(1)]);
    assert_eq!(table.in_dimension().unwrap().at([4.0, 4.0]).cells(), [CellId(0), CellId(1)]);
    assert_eq!(table.in_dimension().unwrap().at([1.0, 6.25]).cells(), [CellId(4)], "on the long side of the closet");
    assert_eq!(table.in_dimension().unwrap().at([1.0, 6.5]).cells(), []);
    assert_eq!(table.strip_geometry().in_dimension().unwrap().at([1.0, 6.5]).cells(), [CellId(4)]);
    assert_eq!(table.in_dimension().unwrap().at([f64::NAN, 1.0]).cells(), []);
    assert_eq!(table.in_dimension().unwrap().at([f64::INFINITY, 1.0]).cells(), []);
    assert_eq!(table.mean_visible_share(), 10.0 / 20.0);
    assert_eq!((table.info_value("method"), table.info_value("missing")), (Some("by hand"), None));
    let at = table.in_dimension().unwrap().at([1.0, 1.0]).inside().unwrap();
    assert!(!at.sees(CellId(1000)) && !at.visible_set().contains(CellId(1000)));
}

#[test]
fn empty_tables_are_tables() {
    for dimension in [2, 3] {
        let nothing = TableParts {
            cells: vec![],
            rows: BitMatrix::default(),
            cell_objects: vec![],
            locator: Locator::default(),
            ..TableParts::empty(dimension, TableKind::Unspecified)
        };
        let table = Table::new(nothing).unwrap();
        assert_eq!(table.mean_visible_share(), 0.0);
        assert!(table.place_at([0.0; 3]).is_outside());
        assert_eq!(Table::from_bytes(&table.to_bytes()).unwrap(), table);
    }
}

#[test]
fn a_point_of_space_is_no_point_of_the_plane() {
    let table = Table::new(rooms()).unwrap();
    assert_eq!(table.in_dimension::<3>().unwrap_err().to_string(), "the table has 2 dimensions, not 3");
    assert_eq!(table.in_dimension::<4>().unwrap_err(), DimensionError { table: 2, points: 4 });
    assert!(table.in_dimension::<2>().unwrap().at([-1.0, 1.0]).is_outside());
    // For code that serves both dimensions, z does not count.
    assert_eq!(table.place_at([1.0, 1.0, f64::NAN]).cells(), [CellId(0)]);
}

#[test]
fn clusters_without_planes_are_nowhere() {
    let kind = TableKind::QuakePortalFile;
    let mut parts = TableParts { kind, ..crate::common::full::wedges() };
    assert!(!Table::new(parts.clone()).unwrap().place_at([1.0; 3]).is_outside(), "the planes know");
    parts.planes = None;
    let table = Table::new(parts).unwrap();
    assert!(!table.has_places() && table.place_at([1.0; 3]).is_outside());
}

/// Introduces one defect.
type Spoil = fn(&mut TableParts);

/// Each defect alone is refused, with its position.
#[test]
fn defects_are_refused() {
    let refused = |spoil: Spoil| {
        let mut parts = rooms();
        spoil(&mut parts);
        Table::new(parts).unwrap_err()
    };
    let cell = CellId;
    let cases: [(Spoil, TableError); 27] = [
        (|p| p.dimension = 4, TableError::Dimension(4)),
        (|p| p.cells[1].min[0] = f64::NAN, TableError::NotFinite { item: Item::Cell, index: 1 }),
        (|p| p.cells[1].max[0] = 3.0, TableError::Inverted { item: Item::Cell, index: 1 }),
        (|p| p.cells[1].max[2] = 3.0, TableError::OffPlane { item: Item::Cell, index: 1 }),
        (|p| drop(p.cells[0].polygon.drain(2..)), TableError::Corners { cell: cell(0), n: 2 }),
        (|p| p.cells[0].polygon[0][0] = f64::INFINITY, TableError::NotFinite { item: Item::Polygon, index: 0 }),
        (|p| p.cells[0].polygon[3] = [3.0, 2.5], TableError::NotConvex { cell: cell(0), corner: 3 }),
        (|p| p.cells[0].polygon[2][1] = 4.5, TableError::OutsideBox { cell: cell(0), corner: 2 }),
        (|p| p.portals[2].cells[1] = CellId(5), TableError::PortalCell { portal: 2, cell: cell(5) }),
        (|p| p.portals[2].cells[1] = CellId(2), TableError::PortalLoop { portal: 2, cell: cell(2) }),
        (|p| p.portals[1].points.push([0.0; 3]), TableError::PortalPoints { portal: 1, n: 3 }),
        (|p| p.portals[1].points[0][1] = f64::NAN, TableError::NotFinite { item: Item::Portal, index: 1 }),
        (|p| p.portals[1].points[0][2] = -0.0, TableError::OffPlane { item: Item::Portal, index: 1 }),
        (|p| p.rows = BitMatrix::new(5, 4), TableError::RowsShape { n_rows: 5, n_cols: 4, n_cells: 5 }),
        (|p| p.rows.row_mut(2)[0] |= 1 << 5, TableError::RowTail(cell(2))),
        (|p| p.rows.set(4, 4, false), TableError::NotReflexive(cell(4))),
        (|p| p.rows.set(1, 0, false), TableError::NotSymmetric([cell(0), cell(1)])),
        (|p| p.objects[1].max[1] = f64::NAN, TableError::NotFinite { item: Item::Object, index: 1 }),
        (|p| p.objects[1].max[1] = 0.0, TableError::Inverted { item: Item::Object, index: 1 }),
        (|p| drop(p.cell_objects.pop()), TableError::CellObjects { n: 4, n_cells: 5 }),
        (|p| p.cell_objects[2] = vec![ObjectId(1), ObjectId(0)], TableError::ObjectOrder(cell(2))),
        (|p| p.cell_objects[2] = vec![ObjectId(0), ObjectId(0)], TableError::ObjectOrder(cell(2))),
        (
            |p| p.cell_objects[2] = vec![ObjectId(1), ObjectId(2)],
            TableError::UnknownObject { cell: cell(2), object: ObjectId(2) },
        ),
        (|p| p.cells[4].max[0] = 9.0, TableError::Locator(LocatorError::Misses { node: 4, cell: cell(4) })),
        (|p| p.locator = Locator::default(), TableError::Locator(LocatorError::Misses { node: 0, cell: cell(0) })),
        (|p| p.info.swap(0, 1), TableError::InfoOrder(1)),
        (|p| p.info[1].0 = "method".to_owned(), TableError::InfoOrder(1)),
    ];
    for (spoil, expected) in cases {
        assert_eq!(refused(spoil), expected);
    }
    let in_space = |p: &mut TableParts| p.dimension = 3;
    assert_eq!(refused(in_space), TableError::Corners { cell: cell(0), n: 4 });
}

#[test]
fn errors_speak_to_users() {
    let text = |error: TableError| error.to_string();
    assert_eq!(text(TableError::NotSymmetric([CellId(3), CellId(1)])), "of cells 3 and 1 only one sees the other");
    let nan = TableError::NotFinite { item: Item::Polygon, index: 7 };
    assert_eq!(text(nan), "the polygon of cell 7 has a coordinate that is not a finite number");
    let misses = TableError::Locator(LocatorError::Misses { node: 4, cell: CellId(2) });
    assert_eq!(text(misses), "locator node 4 misses cell 2");
}

/// Coordinates of any finite size make a table that answers, and errs towards "inside".
#[test]
fn huge_and_tiny_coordinates_are_safe() {
    for size in [f64::MAX / 2.0, f64::MIN_POSITIVE, 5e-324, 1.0] {
        let polygon = vec![[-size, -size], [size, -size], [size, size], [-size, size]];
        let cell = CellRecord { min: [-size, -size, 0.0], max: [size, size, 0.0], group: None, polygon };
        let parts = TableParts {
            objects_seen: None,
            locator: Locator::build(&[(cell.min, cell.max)], 2),
            cells: vec![cell],
            portals: vec![],
            rows: BitMatrix::identity(1),
            cell_objects: vec![vec![]],
            ..rooms()
        };
        let table = Table::new(parts).unwrap();
        for p in [[0.0, 0.0], [size, size], [-size, 0.0]] {
            assert_eq!(table.in_dimension().unwrap().at(p).cells(), [CellId(0)]);
        }
        assert_eq!(table.in_dimension().unwrap().at([0.0, 1.5 * size + 5e-324]).cells(), []);
    }
}
