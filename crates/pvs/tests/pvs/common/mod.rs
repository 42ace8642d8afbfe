//! Tables to test with: a small one with every part, and random ones.

use proptest::prelude::*;
use sightlines_pvs::{
    BitMatrix, CellId, CellRecord, Locator, ObjectId, ObjectRecord, Place, PortalRecord, Table, TableKind, TableParts,
};
use std::collections::BTreeMap;

pub(crate) mod file;
pub(crate) mod full;

/// Four rooms in a row, doors alternating between the lower and the upper wall, a triangular closet
/// without doors, a lamp and a point. Small, with every section and every kind of field.
pub(crate) fn rooms() -> TableParts {
    let room = |i: u32| {
        let (x0, x1) = (4.0 * f64::from(i), 4.0 * f64::from(i + 1));
        let polygon = vec![[x0, 0.0], [x1, 0.0], [x1, 4.0], [x0, 4.0]];
        CellRecord { min: [x0, 0.0, 0.0], max: [x1, 4.0, 0.0], group: (i != 1).then_some(i), polygon }
    };
    let door = |i: u32, y: f64| {
        let x = 4.0 * f64::from(i + 1);
        let points = vec![[x, y + 1.0, 0.0], [x, y, 0.0]];
        PortalRecord { cells: [CellId(i), CellId(i + 1)], sides: [1, 3], points }
    };
    let mut cells: Vec<CellRecord> = (0..4).map(room).collect();
    cells[3].polygon.clear();
    let closet = vec![[0.0, 5.0], [2.0, 5.0], [0.0, 7.5]];
    cells.push(CellRecord { min: [0.0, 5.0, 0.0], max: [2.0, 7.5, 0.0], group: Some(u32::MAX), polygon: closet });
    let mut rows = BitMatrix::identity(5);
    for (a, b) in [(0, 1), (0, 2), (1, 2), (1, 3), (2, 3)] {
        rows.set(a, b, true);
        rows.set(b, a, true);
    }
    let pair = |k: &str, v: &str| (k.to_owned(), v.to_owned());
    let leaf = |ids: &[u32]| sightlines_pvs::LocatorNode::Leaf { cells: ids.iter().copied().map(CellId).collect() };
    let inner = |axis, split, low, high| sightlines_pvs::LocatorNode::Inner { axis, split, low, high };
    let tree = [inner(0, 8.0, 1, 2), inner(1, 4.5, 3, 4), leaf(&[2, 3]), leaf(&[0, 1]), leaf(&[4])];
    TableParts {
        cells,
        portals: vec![door(0, 0.0), door(1, 3.0), door(2, 0.0)],
        rows,
        objects: vec![
            ObjectRecord { name: "lamp".to_owned(), min: [3.5, 1.0, 0.0], max: [4.5, 2.0, 0.0] },
            ObjectRecord { name: "Wächter".to_owned(), min: [15.0, 1.0, 0.0], max: [15.0, 1.0, 0.0] },
        ],
        cell_objects: vec![vec![ObjectId(0)], vec![ObjectId(0)], vec![], vec![ObjectId(1)], vec![]],
        locator: Locator::from_nodes(&tree).expect("a tree"),
        info: vec![pair("method", "by hand"), pair("source", "")],
        ..TableParts::empty(2, TableKind::Unspecified)
    }
}

/// The cells' polygons, boxes for those without, doubled: integer coordinates on the grid.
fn outline(cell: &CellRecord) -> Vec<[i64; 2]> {
    let (a, b) = (cell.min, cell.max);
    let corners = match cell.polygon.is_empty() {
        true => vec![[a[0], a[1]], [b[0], a[1]], [b[0], b[1]], [a[0], b[1]]],
        false => cell.polygon.clone(),
    };
    corners.iter().map(|c| c.map(doubled)).collect()
}

pub(crate) fn doubled(x: f64) -> i64 {
    assert_eq!((2.0 * x).fract(), 0.0, "{x} is not on the grid");
    (2.0 * x) as i64
}

/// The oracle for point location: every cell, in integers.
pub(crate) fn located(cells: &[CellRecord], p: &[f64]) -> Vec<CellId> {
    let inside = |cell: &CellRecord| {
        let in_box =
            p.iter().enumerate().all(|(k, &x)| (doubled(cell.min[k])..=doubled(cell.max[k])).contains(&doubled(x)));
        let (corners, q) = (outline(cell), [doubled(p[0]), doubled(p[1])]);
        let n = corners.len();
        in_box
            && (0..n).all(|i| {
                let (a, b) = (corners[i], corners[(i + 1) % n]);
                (b[0] - a[0]) * (q[1] - a[1]) - (b[1] - a[1]) * (q[0] - a[0]) >= 0
            })
    };
    (0u32..).map(CellId).zip(cells).filter(|(_, cell)| inside(cell)).map(|(id, _)| id).collect()
}

type Corners = [[i8; 2]; 3];

fn cell(dimension: u8) -> impl Strategy<Value = CellRecord> {
    let grid = || prop::array::uniform2(-4i8..5);
    let shape = ([grid(), grid(), grid()], prop::array::uniform3(0i8..4), -4i8..5, 0u8..3);
    (shape, prop::option::of(0u32..5)).prop_map(move |((corners, size, z, kind), group)| {
        let cell = match (dimension, kind) {
            (3, _) => block(corners[0], z, size),
            (_, 0) => triangle(corners).unwrap_or_else(|| block(corners[0], 0, [size[0], size[1], 0])),
            (_, 1) => block(corners[0], 0, [size[0], size[1], 0]),
            _ => quad(corners[0], size[0] + 1, size[1] + 1),
        };
        CellRecord { group, ..cell }
    })
}

fn block([x, y]: [i8; 2], z: i8, size: [i8; 3]) -> CellRecord {
    let at = [x, y, z];
    let max = std::array::from_fn(|k| f64::from(at[k] + size[k]));
    CellRecord { min: at.map(f64::from), max, group: None, polygon: vec![] }
}

fn quad([x, y]: [i8; 2], dx: i8, dy: i8) -> CellRecord {
    let polygon = [[x, y], [x + dx, y], [x + dx, y + dy], [x, y + dy]].map(|c| c.map(f64::from)).to_vec();
    CellRecord { polygon, ..block([x, y], 0, [dx, dy, 0]) }
}

fn triangle([a, b, c]: Corners) -> Option<CellRecord> {
    let wide = |p: [i8; 2]| p.map(i32::from);
    let (p, q, r) = (wide(a), wide(b), wide(c));
    let area = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    let polygon: Vec<[f64; 2]> = match area.signum() {
        0 => return None,
        1 => [a, b, c].map(|p| p.map(f64::from)).to_vec(),
        _ => [a, c, b].map(|p| p.map(f64::from)).to_vec(),
    };
    let side = |k: usize, pick: fn(f64, f64) -> f64| polygon.iter().map(|c| c[k]).reduce(pick).unwrap_or(0.0);
    let (min, max) = ([side(0, f64::min), side(1, f64::min), 0.0], [side(0, f64::max), side(1, f64::max), 0.0]);
    Some(CellRecord { min, max, group: None, polygon })
}

/// Any valid table; the cells lie on a small grid and overlap, some of them flat.
pub(crate) fn any_parts() -> impl Strategy<Value = TableParts> {
    (2u8..4, 0usize..70).prop_flat_map(|(dimension, n)| {
        let names = prop::collection::vec(".{0,4}", 0..4);
        let pairs = prop::collection::vec((0..n.max(1), 0..n.max(1)), 0..3 * n + 1);
        let points = prop::collection::vec(any::<[i8; 3]>(), 2..6);
        (
            prop::collection::vec(cell(dimension), n),
            pairs,
            names,
            prop::collection::vec(any::<u8>(), n),
            prop::collection::btree_map(".{0,4}", ".{0,8}", 0..4),
            points,
        )
            .prop_map(move |(cells, pairs, names, touches, info, points)| {
                assemble(dimension, cells, &pairs, names, &touches, info, &points)
            })
    })
}

fn assemble(
    dimension: u8,
    cells: Vec<CellRecord>,
    pairs: &[(usize, usize)],
    names: Vec<String>,
    touches: &[u8],
    info: BTreeMap<String, String>,
    points: &[[i8; 3]],
) -> TableParts {
    let n = cells.len();
    let mut rows = BitMatrix::identity(n);
    let mut portals = Vec::new();
    for &(a, b) in pairs.iter().filter(|(a, b)| a != b) {
        rows.set(a, b, true);
        rows.set(b, a, true);
        let z = |p: &[i8; 3]| [p[0], p[1], if dimension == 2 { 0 } else { p[2] }].map(f64::from);
        let kept = if dimension == 2 { 2 } else { 3.max(points.len()) };
        let points = points.iter().cycle().take(kept).map(z).collect();
        portals.push(PortalRecord { cells: [a, b].map(|i| CellId(i as u32)), sides: [b as u32, 7], points });
    }
    let object = |name| ObjectRecord { name, min: [-1.0, -0.5, 0.0], max: [0.1, 2.0, 0.0] };
    let objects: Vec<ObjectRecord> = names.into_iter().map(object).collect();
    let touched = |bits: &u8| (0..objects.len() as u32).filter(|o| bits >> o & 1 == 1).map(ObjectId).collect();
    let bounds: Vec<_> = cells.iter().map(|cell| (cell.min, cell.max)).collect();
    TableParts {
        locator: Locator::build(&bounds, dimension),
        cells,
        portals,
        rows,
        cell_objects: touches.iter().map(touched).collect(),
        objects,
        info: info.into_iter().collect(),
        ..TableParts::empty(dimension, TableKind::Unspecified)
    }
}

/// Makes all queries, and panics unless the answers agree with each other.
pub(crate) fn assert_well_formed(table: &Table) {
    Table::new(table.parts().clone()).expect("a table's parts make a table");
    let ids = || (0..table.n_cells() as u32).map(CellId);
    for a in ids() {
        assert!(table.sees(a, a), "{a} does not see itself");
        let listed: Vec<CellId> = table.visible(a).collect();
        assert_eq!(listed, ids().filter(|&b| table.sees(b, a)).collect::<Vec<_>>());
        let objects = table.visible_objects(a);
        assert!(objects.is_sorted_by(|a, b| a < b));
        assert!(objects.iter().all(|&o| listed.iter().any(|&c| table.objects_of(c).contains(&o))));
        let corner = table.cells()[a.idx()].min;
        let middle = middle_of(&table.cells()[a.idx()]);
        for p in [corner, middle] {
            let Place::Inside(at) = table.place_at(p) else { continue };
            let seen = at.visible_set();
            assert!(at.cells().iter().all(|&c| table.visible(c).all(|b| seen.contains(b))));
            table.objects_in(&seen);
            at.visible_objects();
        }
    }
    assert!((0.0..=1.0).contains(&table.mean_visible_share()));
}

fn middle_of(cell: &CellRecord) -> [f64; 3] {
    std::array::from_fn(|k| 0.5 * cell.min[k] + 0.5 * cell.max[k])
}
