//! Tables of small grids, with anything visible from anywhere.

use proptest::prelude::*;
use sightlines_geometry::{Aabb, Random};
use sightlines_pvs::{
    BitMatrix, CellId, CellRecord, Locator, ObjectId, ObjectRecord, PortalRecord, SceneMethods, Table, TableKind,
    TableParts,
};
use sightlines_relevance::{Body, Ways};
use std::sync::Arc;

/// A grid of boxes with whole coordinates, some pairs of which see each other, and some sides of which are open.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Grid {
    pub(crate) size: [usize; 3],
    pub(crate) seed: u64,
    /// One pair of so many sees each other.
    pub(crate) blind: usize,
}

pub(crate) fn grids() -> impl Strategy<Value = Grid> {
    ([1usize..5, 1usize..4, 1usize..4], any::<u64>(), 2usize..40).prop_map(|(size, seed, blind)| Grid {
        size,
        seed,
        blind,
    })
}

impl Grid {
    pub(crate) fn parts(self) -> TableParts {
        let mut random = Random::new(self.seed);
        let lines: [Vec<f64>; 3] = self.size.map(|n| {
            let mut line = vec![0.0];
            (0..n).for_each(|i| line.push(line[i] + 1.0 + random.below(3) as f64));
            line
        });
        let kind = TableKind::SceneKdTree { hidden_by: SceneMethods { sightlines: true, ..SceneMethods::default() } };
        let mut parts = TableParts::empty(3, kind);
        let [nx, ny, nz] = self.size;
        let idx = |[x, y, z]: [usize; 3]| (z * ny + y) * nx + x;
        let places = || (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])));
        for p in places() {
            let [min, max] = [0, 1].map(|up| std::array::from_fn(|k| lines[k][p[k] + up]));
            parts.cells.push(CellRecord { min, max, group: None, polygon: Vec::new() });
        }
        let n = parts.cells.len();
        for p in places() {
            for k in 0..3 {
                let mut q = p;
                q[k] += 1;
                if q[k] == self.size[k] || random.below(3) == 0 {
                    continue;
                }
                let (a, b) = (idx(p), idx(q));
                let mut side = Aabb { min: parts.cells[a].min, max: parts.cells[a].max };
                side.min[k] = side.max[k];
                let [u, v] = [(k + 1) % 3, (k + 2) % 3];
                let corner = |s: [f64; 2]| {
                    let mut c = side.min;
                    (c[u], c[v]) = (s[0], s[1]);
                    c
                };
                let [lo, hi] = [[side.min[u], side.min[v]], [side.max[u], side.max[v]]];
                let points = vec![corner(lo), corner([hi[0], lo[1]]), corner(hi), corner([lo[0], hi[1]])];
                parts.portals.push(PortalRecord { cells: [CellId(a as u32), CellId(b as u32)], sides: [0, 0], points });
            }
        }
        let mut rows = BitMatrix::identity(n);
        for i in 0..n {
            for j in 0..i {
                if random.below(self.blind) == 0 {
                    rows.set(i, j, true);
                    rows.set(j, i, true);
                }
            }
        }
        parts.rows = rows;
        parts.cell_objects = vec![Vec::new(); n];
        for (i, c) in parts.cells.iter().enumerate() {
            parts.objects.push(ObjectRecord { name: format!("o{i}"), min: c.min, max: c.max });
            parts.cell_objects[i].push(ObjectId(i as u32));
        }
        let bounds: Vec<_> = parts.cells.iter().map(|c| (c.min, c.max)).collect();
        parts.locator = Locator::build(&bounds, 3);
        parts
    }

    pub(crate) fn table(self) -> Arc<Table> {
        Arc::new(Table::new(self.parts()).expect("a table"))
    }
}

pub(crate) fn cell(table: &Table, i: usize) -> Aabb<3> {
    Aabb { min: table.cells()[i].min, max: table.cells()[i].max }
}

/// The box around all cells.
pub(crate) fn world(table: &Table) -> Aabb<3> {
    (0..table.n_cells()).fold(Aabb::EMPTY, |all, i| all.united(cell(table, i)))
}

/// The distance of two boxes, squared and in whole numbers as long as these are.
pub(crate) fn square(a: &Aabb<3>, b: &Aabb<3>) -> f64 {
    (0..3).map(|k| (a.min[k] - b.max[k]).max(b.min[k] - a.max[k]).max(0.0).powi(2)).sum()
}

/// How far cells are from each other.
pub(crate) fn distances(table: &Table, ways: Ways) -> Vec<Vec<f64>> {
    let n = table.n_cells();
    let straight = |i: usize, j: usize| square(&cell(table, i), &cell(table, j)).sqrt();
    let mut far: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| straight(i, j)).collect()).collect();
    if ways == Ways::Portals {
        let portals: Vec<Aabb<3>> = table.portals().iter().map(|p| Aabb::around(p.points.iter().copied())).collect();
        let m = portals.len();
        let mut of = vec![vec![f64::INFINITY; m]; m];
        let touches = |p: usize, cell: CellId| table.portals()[p].cells.contains(&cell);
        for p in 0..m {
            for q in 0..m {
                if table.portals()[p].cells.iter().any(|&c| touches(q, c)) {
                    of[p][q] = square(&portals[p], &portals[q]).sqrt();
                }
            }
        }
        for (i, row) in far.iter_mut().enumerate() {
            // Bellman and Ford, as distances from the cell count at each portal.
            let here = cell(table, i);
            let mut walked: Vec<f64> =
                (0..m).map(|p| if touches(p, CellId(i as u32)) { 0.0 } else { f64::INFINITY }).collect();
            for _ in 0..m {
                for p in 0..m {
                    for q in 0..m {
                        walked[q] = walked[q].min((walked[p] + of[p][q]).max(square(&here, &portals[q]).sqrt()));
                    }
                }
            }
            for (j, far) in row.iter_mut().enumerate() {
                let into = (0..m).filter(|&q| touches(q, CellId(j as u32)));
                let walked = into.map(|q| walked[q]).fold(f64::INFINITY, f64::min);
                *far = if i == j { 0.0 } else { far.max(walked) };
            }
        }
    }
    far
}

pub(crate) fn point(p: [f64; 3]) -> Aabb<3> {
    Aabb { min: p, max: p }
}

pub(crate) fn body(p: [f64; 3]) -> Body {
    Body::new(point(p), point(p))
}
