//! Tables over a grid of unit cells, with pseudorandom rows, and an oracle in integers for which box touches which
//! cell.

use proptest::prelude::*;
use sightlines_eye_to_cell::{TableCells, VisibleSet};
use sightlines_geometry::Aabb;
use sightlines_pvs::{
    BitMatrix, CellId, CellRecord, Locator, PlaneChild, PlaneNode, PlaneTree, PortalRecord, Table, TableKind,
    TableParts,
};
use sightlines_walkthrough::{AnswerKind, DrawList};
use std::sync::Arc;

/// Quarters of a unit: all coordinates of the tests are integers in this unit.
pub(crate) const UNIT: i64 = 4;

/// What kind of cells a grid has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Unit squares; those with an even number are cut into two triangles.
    Plane,
    /// Unit cubes.
    Space,
    /// Unit cubes located by planes, with boxes that are too large.
    Planes,
}

/// A cell in the oracle's form, in quarters.
#[derive(Debug, Clone)]
pub(crate) struct Shape {
    pub(crate) min: [i64; 3],
    pub(crate) max: [i64; 3],
    pub(crate) triangle: Option<[[i64; 2]; 3]>,
}

#[derive(Debug, Clone)]
pub(crate) struct Grid {
    pub(crate) kind: Kind,
    pub(crate) table: Arc<Table>,
    pub(crate) shapes: Vec<Shape>,
    /// The grid, in quarters.
    pub(crate) size: [i64; 3],
}

pub(crate) type IntBox = ([i64; 3], [i64; 3]);

pub(crate) fn float(b: &IntBox) -> Aabb<3> {
    let unit = |x: i64| x as f64 / UNIT as f64;
    Aabb { min: b.0.map(unit), max: b.1.map(unit) }
}

fn cross(a: [i64; 2], b: [i64; 2], c: [i64; 2]) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

fn on(a: [i64; 2], b: [i64; 2], p: [i64; 2]) -> bool {
    cross(a, b, p) == 0 && (0..2).all(|k| a[k].min(b[k]) <= p[k] && p[k] <= a[k].max(b[k]))
}

fn meet(a: [i64; 2], b: [i64; 2], c: [i64; 2], d: [i64; 2]) -> bool {
    let signs = [cross(a, b, c), cross(a, b, d), cross(c, d, a), cross(c, d, b)].map(i64::signum);
    signs[0] * signs[1] < 0 && signs[2] * signs[3] < 0 || on(a, b, c) || on(a, b, d) || on(c, d, a) || on(c, d, b)
}

impl Shape {
    /// Whether a closed box touches the closed cell: a corner of one in the other, or edges that meet.
    pub(crate) fn touches(&self, b: &IntBox, dimension: usize) -> bool {
        if (0..dimension).any(|k| self.min[k] > b.1[k] || self.max[k] < b.0[k]) {
            return false;
        }
        let Some(t) = self.triangle else { return true };
        let (lo, hi) = ([b.0[0], b.0[1]], [b.1[0], b.1[1]]);
        let corners = [lo, [hi[0], lo[1]], hi, [lo[0], hi[1]]];
        let in_box = |p: &[i64; 2]| (0..2).all(|k| lo[k] <= p[k] && p[k] <= hi[k]);
        let in_triangle = |p: &[i64; 2]| (0..3).all(|i| cross(t[i], t[(i + 1) % 3], *p) >= 0);
        t.iter().any(in_box)
            || corners.iter().any(in_triangle)
            || (0..3).any(|i| (0..4).any(|j| meet(t[i], t[(i + 1) % 3], corners[j], corners[(j + 1) % 4])))
    }
}

impl Grid {
    pub(crate) fn cells(&self) -> TableCells<Arc<Table>> {
        TableCells::new(Arc::clone(&self.table))
    }

    pub(crate) fn dimension(&self) -> usize {
        usize::from(self.table.dimension())
    }

    pub(crate) fn n_cells(&self) -> usize {
        self.shapes.len()
    }

    /// The plain method for one box.
    pub(crate) fn sees(&self, seen: &VisibleSet, b: &IntBox) -> bool {
        let beyond = (0..self.dimension()).any(|k| b.0[k] < self.lowest(k) || b.1[k] > self.highest(k));
        beyond || (0u32..).zip(&self.shapes).any(|(i, s)| seen.has_cell(CellId(i)) && s.touches(b, self.dimension()))
    }

    fn lowest(&self, k: usize) -> i64 {
        self.table.cells().iter().map(|c| (c.min[k] * UNIT as f64) as i64).min().unwrap_or(i64::MAX)
    }

    fn highest(&self, k: usize) -> i64 {
        self.table.cells().iter().map(|c| (c.max[k] * UNIT as f64) as i64).max().unwrap_or(i64::MIN)
    }
}

/// A grid of `n` cells along each axis; `solid` selects those without a cell, `see` is the visibility.
pub(crate) fn grid(
    kind: Kind,
    n: [usize; 3],
    solid: impl Fn(usize) -> bool,
    see: impl Fn(usize, usize) -> bool,
) -> Grid {
    let n = if kind == Kind::Plane { [n[0], n[1], 1] } else { n };
    let mut shapes = Vec::new();
    let mut at = vec![None; n[0] * n[1] * n[2]];
    for i in (0..at.len()).filter(|&i| !solid(i)) {
        let place = [i % n[0], i / n[0] % n[1], i / n[0] / n[1]].map(|x| x as i64 * UNIT);
        at[i] = Some(CellId(shapes.len() as u32));
        let (mut min, mut max) = (place, place.map(|x| x + UNIT));
        if kind == Kind::Plane {
            (min[2], max[2]) = (0, 0);
        }
        if kind == Kind::Plane && i % 2 == 0 {
            let [a, b, c, d] = [[min[0], min[1]], [max[0], min[1]], [max[0], max[1]], [min[0], max[1]]];
            shapes.push(Shape { min, max, triangle: Some([a, b, c]) });
            shapes.push(Shape { min, max, triangle: Some([a, c, d]) });
        } else {
            shapes.push(Shape { min, max, triangle: None });
        }
    }
    let slack = if kind == Kind::Planes { 1 } else { 0 };
    let record = |shape: &Shape| {
        let b = float(&(shape.min.map(|x| x - slack), shape.max.map(|x| x + slack)));
        let corner = |p: [i64; 2]| p.map(|x| x as f64 / UNIT as f64);
        let polygon = shape.triangle.map_or(vec![], |t| t.map(corner).to_vec());
        CellRecord { min: b.min, max: b.max, group: None, polygon }
    };
    let cells: Vec<CellRecord> = shapes.iter().map(record).collect();
    let bounds: Vec<_> = cells.iter().map(|c| (c.min, c.max)).collect();
    let mut rows = BitMatrix::identity(cells.len());
    for a in 0..cells.len() {
        for b in (0..a).filter(|&b| see(a, b)) {
            rows.set(a, b, true);
            rows.set(b, a, true);
        }
    }
    let dimension = if kind == Kind::Plane { 2 } else { 3 };
    let planes = (kind == Kind::Planes).then(|| planes(n, &at));
    // The border cells of a plane tree are unbounded.
    if kind == Kind::Planes {
        for shape in &mut shapes {
            for (k, &cells) in n.iter().enumerate() {
                shape.min[k] -= if shape.min[k] == 0 { 1 << 40 } else { 0 };
                shape.max[k] += if shape.max[k] == cells as i64 * UNIT { 1 << 40 } else { 0 };
            }
        }
    }
    let table = Table::new(TableParts {
        rows,
        portals: doors(&shapes, dimension),
        cell_objects: vec![vec![]; cells.len()],
        locator: Locator::build(&bounds, dimension),
        planes,
        cells,
        ..TableParts::empty(dimension, TableKind::Unspecified)
    });
    Grid { kind, table: Arc::new(table.unwrap()), shapes, size: n.map(|x| x as i64 * UNIT) }
}

/// Doors between neighbours in a row of squares; otherwise none.
fn doors(shapes: &[Shape], dimension: u8) -> Vec<PortalRecord> {
    let mut doors = Vec::new();
    for (i, pair) in (0u32..).zip(shapes.windows(2)) {
        if dimension == 2 && pair.iter().all(|s| s.triangle.is_none()) && pair[0].max[0] == pair[1].min[0] {
            let (x, y) = (pair[0].max[0] as f64 / UNIT as f64, pair[0].min[1] as f64 / UNIT as f64);
            let points = vec![[x, y + 0.75, 0.0], [x, y + 0.25, 0.0]];
            doors.push(PortalRecord { cells: [CellId(i), CellId(i + 1)], sides: [0, 1], points });
        }
    }
    doors
}

/// The tree of planes that cuts a grid into its cells.
fn planes(n: [usize; 3], at: &[Option<CellId>]) -> PlaneTree {
    fn cut(
        low: [usize; 3],
        high: [usize; 3],
        n: [usize; 3],
        at: &[Option<CellId>],
        nodes: &mut Vec<PlaneNode>,
    ) -> PlaneChild {
        let Some(k) = (0..3).find(|&k| high[k] - low[k] > 1) else {
            return at[low[0] + n[0] * (low[1] + n[1] * low[2])].map_or(PlaneChild::Nothing, PlaneChild::Cell);
        };
        let middle = (low[k] + high[k]) / 2;
        let mut normal = [0.0; 3];
        normal[k] = 1.0;
        let node = nodes.len();
        nodes.push(PlaneNode { normal, offset: middle as f64, children: [PlaneChild::Nothing; 2] });
        let (mut above, mut below) = (low, high);
        above[k] = middle;
        below[k] = middle;
        let children = [cut(above, high, n, at, nodes), cut(low, below, n, at, nodes)];
        nodes[node].children = children;
        PlaneChild::Node(node as u32)
    }
    let mut nodes = Vec::new();
    if let PlaneChild::Cell(_) | PlaneChild::Nothing = cut([0; 3], n, n, at, &mut nodes) {
        // A single cell: one plane with the cell above it.
        let children = [at[0].map_or(PlaneChild::Nothing, PlaneChild::Cell), PlaneChild::Nothing];
        nodes = vec![PlaneNode { normal: [1.0, 0.0, 0.0], offset: -9.0, children }];
    }
    PlaneTree::new(nodes, 0.0).unwrap()
}

/// Pseudorandom numbers that are the same everywhere.
#[derive(Debug, Clone)]
pub(crate) struct Chance(pub(crate) u64);

impl Chance {
    pub(crate) fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % n
    }

    pub(crate) fn one_in(&mut self, n: u64) -> bool {
        self.below(n) == 0
    }
}

/// Grids of all kinds, with some cells solid.
pub(crate) fn any_grid() -> impl Strategy<Value = Grid> {
    let kind = prop_oneof![Just(Kind::Plane), Just(Kind::Space), Just(Kind::Planes)];
    (kind, [1usize..6, 1usize..5, 1usize..4], any::<u64>()).prop_map(|(kind, n, seed)| {
        let hash = |i: usize, j: usize| Chance(seed ^ (i as u64 * 0x9e37_79b9) ^ ((j as u64) << 32)).below(1 << 20);
        // The first is never solid, so that there is a cell.
        grid(kind, n, |i| i > 0 && hash(i, 77) % 5 == 0, |a, b| hash(a, b) % 3 == 0)
    })
}

/// A frame that sees these cells.
pub(crate) fn see(seen: &mut VisibleSet, n_cells: usize, cells: impl IntoIterator<Item = u32>) {
    seen.clear(n_cells, 0);
    seen.add_cells(cells.into_iter().map(CellId));
}

pub(crate) fn frame<'a>(seen: &'a VisibleSet, answer: AnswerKind) -> DrawList<'a> {
    DrawList { seen, at: &[], answer, method: sightlines_eye_to_cell::Method::Exact, images: &[], ahead: &[] }
}
