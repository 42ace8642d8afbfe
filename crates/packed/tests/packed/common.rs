//! Tables with all optional parts, and with rows and columns that repeat.

use proptest::prelude::*;
use sightlines_pvs::{
    Axis, BitMatrix, CellId, CellRecord, DoorRecord, Locator, MirrorId, MirrorRecord, ObjectId, ObjectPart,
    ObjectParts, ObjectRecord, ObjectSource, PlaneChild, PlaneNode, PlaneTree, PortalId, PortalRecord, SceneMethods,
    StabParts, StabTrees, Table, TableKind, TableParts,
};

/// What a table is made from: dimension, columns, rows, seed (cells have names if it is odd, and there are doors and sources of
/// objects if it leaves 1 by 4), and which optional parts it has.
pub(crate) type Recipe = (u8, u32, u32, u64, u8);

pub(crate) fn recipes() -> impl Strategy<Value = Recipe> {
    (2u8..4, 0u32..14, 1u32..8, any::<u64>(), any::<u8>())
}

/// A small table with every part, for tests that break each of its bytes.
pub(crate) const SMALL: [Recipe; 2] = [(2, 4, 2, 5, 0xFF), (3, 3, 2, 9, 0xFF)];

struct Dice(u64);

impl Dice {
    fn below(&mut self, n: u32) -> u32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) % u64::from(n.max(1))) as u32
    }
}

/// A grid of unit cells, some with equal visibility.
pub(crate) fn table((dimension, width, height, seed, parts): Recipe) -> Table {
    let mut dice = Dice(seed);
    let has = |k: u8| parts >> k & 1 == 1;
    let n = (width * height) as usize;
    let z = if dimension == 3 { 1.5 } else { 0.0 };
    let place = |i: usize| [f64::from(i as u32 % width.max(1)), f64::from(i as u32 / width.max(1))];
    let cell = |i: usize| {
        let [x, y] = place(i);
        let square = vec![[x, y], [x + 1.0, y], [x + 1.0, y + 0.75], [x, y + 1.0]];
        let polygon = if dimension == 2 && has(0) && i % 3 != 1 { square } else { vec![] };
        let group = if has(1) && !i.is_multiple_of(4) { Some(u32::MAX - i as u32) } else { None };
        CellRecord { min: [x, y, 0.0], max: [x + 1.0, y + 1.0, z], group, polygon }
    };
    let cells: Vec<CellRecord> = (0..n).map(cell).collect();
    let bounds: Vec<_> = cells.iter().map(|cell| (cell.min, cell.max)).collect();
    let mut out = TableParts {
        cells,
        locator: Locator::build(&bounds, dimension),
        ..TableParts::empty(dimension, TableKind::Unspecified)
    };
    out.rows = rows(n, &mut dice, 1 + u32::from(parts) % 5);
    out.portals = portals(n, width as usize, &place, dimension);
    let n_objects = if has(2) { dice.below(90) } else { 0 };
    let object = |o: u32| ObjectRecord { name: format!("ö{o}"), min: [0.5, -0.25, 0.0], max: [0.5, f64::from(o), z] };
    out.objects = (0..n_objects).map(object).collect();
    out.cell_objects = (0..n).map(|_| (0..n_objects).filter(|_| dice.below(4) == 0).map(ObjectId).collect()).collect();
    if has(3) {
        out.object_polygons = (0..n_objects).map(|_| dice.below(1000)).collect();
    }
    if has(4) {
        let mut seen = BitMatrix::new(n, n_objects as usize);
        for (i, list) in out.cell_objects.iter().enumerate() {
            list.iter().for_each(|&o| seen.set(i, o.idx(), true));
            (0..n_objects / 2).filter(|o| o % 3 == i as u32 % 2).for_each(|o| seen.set(i, o as usize, true));
        }
        out.objects_seen = Some(seen);
    }
    if has(5) && n > 0 {
        let mirror = |k: u32| {
            let points = (0..dimension).map(|i| [f64::from(i), f64::from(k), z]).collect();
            MirrorRecord { cell: CellId(k % n as u32), mirror: MirrorId(k / 2), points }
        };
        out.mirrors = (0..dice.below(5)).map(mirror).collect();
    }
    if has(6) && n > 0 {
        out.stab = Some(stab(&out));
        out.planes = (dimension == 3).then(|| planes(n as u32));
    }
    if has(7) {
        out.info = [("a", "b"), ("key", ""), ("ä", "value")].map(|(k, v)| (k.to_owned(), v.to_owned())).to_vec();
    }
    if seed % 3 == 0 {
        let hidden_by = SceneMethods { sightlines: seed % 2 == 1, from_region: true, only_in_air: seed % 5 == 0 };
        out.kind = if dimension == 2 { TableKind::PlanKdTree } else { TableKind::SceneGivenCells { hidden_by } };
        out.up = Some(Axis::ALL[seed as usize % 2]);
    }
    if seed % 2 == 1 {
        // Some are equal, some empty, some not ASCII.
        out.cell_names = (0..n).map(|i| ["", "room", "Küche", "room0_Living Room"][i % 4].repeat(1 + i % 3)).collect();
    }
    if seed % 4 == 1 {
        let n_portals = out.portals.len() as u32;
        let door = |k: u32| DoorRecord {
            name: ["Tür", "", "gate"][k as usize % 3].to_owned(),
            object: (k.is_multiple_of(2) && k < n_objects).then_some(ObjectId(k)),
            portals: (0..n_portals).filter(|portal| portal.is_multiple_of(k + 2)).map(PortalId).collect(),
        };
        out.doors = (0..dice.below(5)).map(door).collect();
        let of = |o: u32| (o % 5 != 3).then_some(ObjectSource { node: o * o % 7 * 60, primitive: o % 3 });
        out.object_sources = (0..n_objects).map(of).collect();
    }
    if let (Some(seen), true) = (&out.objects_seen, seed % 5 < 2) {
        let mut parts = Vec::new();
        for object in (0..n_objects).filter(|o| o % 3 != 1) {
            let mut end = 0;
            for _ in 0..1 + dice.below(4) {
                let start = end;
                end += 1 + dice.below(300);
                parts.push(ObjectPart { object: ObjectId(object), start, end });
            }
        }
        let mut of_parts = BitMatrix::new(n, parts.len());
        for (cell, part) in (0..n).flat_map(|cell| (0..parts.len()).map(move |part| (cell, part))) {
            if seen.get(cell, parts[part].object.idx()) && dice.below(3) > 0 {
                of_parts.set(cell, part, true);
            }
        }
        out.object_parts = Some(ObjectParts { parts, seen: of_parts });
    }
    Table::new(out).expect("a table")
}

/// Blocks of cells with equal visibility, and some additional pairs.
fn rows(n: usize, dice: &mut Dice, size: u32) -> BitMatrix {
    let pattern = dice.0;
    let sees = |a: u32, b: u32| a == b || pattern.rotate_left(7 * a.min(b) + 5 * a.max(b)) & 3 == 0;
    let mut rows = BitMatrix::identity(n);
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
        rows.set(i, j, sees(i as u32 / size, j as u32 / size));
    }
    for _ in 0..dice.below(6) {
        let (a, b) = (dice.below(n as u32) as usize, dice.below(n as u32) as usize);
        if a < n {
            rows.set(a, b, true);
            rows.set(b, a, true);
        }
    }
    rows
}

fn portals(n: usize, width: usize, place: &dyn Fn(usize) -> [f64; 2], dimension: u8) -> Vec<PortalRecord> {
    let mut portals = Vec::new();
    for i in 0..n {
        let [x, y] = place(i);
        let right = (i % width + 1 < width).then(|| (i + 1, [[x + 1.0, y + 0.75], [x + 1.0, y]]));
        let up = (i + width < n).then(|| (i + width, [[x, y + 1.0], [x + 1.0, y + 1.0]]));
        for (to, [a, b]) in right.into_iter().chain(up) {
            let points = match dimension {
                2 => vec![[a[0], a[1], 0.0], [b[0], b[1], 0.0]],
                _ => vec![[a[0], a[1], 0.0], [b[0], b[1], 0.0], [b[0], b[1], 1.5], [a[0], a[1], 1.5]],
            };
            portals.push(PortalRecord { cells: [CellId(i as u32), CellId(to as u32)], sides: [1, i as u32], points });
        }
    }
    portals
}

/// Sequences of one and two portals.
fn stab(table: &TableParts) -> StabTrees {
    let mut parts = StabParts::default();
    let gates = |i: u32| (i / 2, i.is_multiple_of(2));
    let ends = |i: u32| {
        let [a, b] = table.portals[i as usize / 2].cells;
        if i.is_multiple_of(2) { (a, b) } else { (b, a) }
    };
    let n = 2 * table.portals.len() as u32;
    for gate in 0..n {
        parts.push_node(PortalId(gates(gate).0), gates(gate).1, &[], gate % 7 == 0);
    }
    for gate in 0..n {
        let next: Vec<u32> = (0..n).filter(|&next| next / 2 != gate / 2 && ends(next).0 == ends(gate).1).collect();
        parts.push_node(PortalId(gates(gate).0), gates(gate).1, &next, gate % 5 == 0);
    }
    for cell in (0..table.cells.len() as u32).map(CellId) {
        let roots: Vec<u32> = (0..n).filter(|&gate| ends(gate).0 == cell).map(|gate| n + gate).collect();
        parts.push_cell(&roots, cell.0 % 3 == 1);
    }
    StabTrees::new(parts, &table.portals, table.cells.len()).expect("trees")
}

/// A chain of planes, one between any two cells; it need not be correct.
fn planes(n: u32) -> PlaneTree {
    let node = |k: u32| PlaneNode {
        normal: [1.0, 0.25, 0.0],
        offset: f64::from(k),
        children: [
            if k + 1 < n.min(9) { PlaneChild::Node(k + 1) } else { PlaneChild::Nothing },
            PlaneChild::Cell(CellId(k % n)),
        ],
    };
    PlaneTree::new((0..n.min(9)).map(node).collect(), 0.125).expect("a tree")
}

/// Points on and off the grid, and some that are not finite.
pub(crate) fn points(dimension: u8) -> Vec<[f64; 3]> {
    let line = [-1.0, 0.0, 0.5, 1.0, 2.75, 3.0, 6.0, f64::NAN, f64::INFINITY];
    let z = if dimension == 2 { 0.0 } else { 0.75 };
    line.iter().flat_map(|&x| line.iter().map(move |&y| [x, y, z])).collect()
}
