//! Lower bounds of how far bodies have to go from cell to cell.

use sightlines_geometry::Aabb;
use sightlines_pvs::{Frame, Table};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// On which ways bodies can get from one cell into another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Ways {
    /// On any, also through walls: distances are those between boxes. Holds for whatever moves.
    #[default]
    Straight,
    /// Through the portals of the table only, all doors open: distances are those of ways through portals. Holds if bodies cannot pass what hides: it does
    /// not for cloth, smoke or one-way glass that one can walk through, nor for teleporters.
    Portals,
}

/// A factor above 1 by more than the relative rounding error of any distance here: few operations, each within 2^-53.
const MORE: f64 = 1.0 + 1.0 / (1u64 << 40) as f64;

/// Boxes that contain the cells of a table, along its axes.
#[derive(Debug, Clone)]
pub(crate) struct Boxes {
    boxes: Vec<Aabb<3>>,
    frame: Option<Frame>,
}

impl Boxes {
    pub(crate) fn of(table: &Table) -> Self {
        let (frame, gap) = (table.frame().copied(), gap_of(table));
        let boxes = table.cells().iter().map(|c| widened(&Aabb { min: c.min, max: c.max }, gap)).collect();
        Self { boxes, frame }
    }

    /// A box of the scene along the axes of the table: a box that contains it, and what is within the gap of the frame.
    pub(crate) fn place(&self, b: &Aabb<3>) -> Aabb<3> {
        let (min, max) = self.frame.map_or((b.min, b.max), |frame| frame.around(b.min, b.max));
        Aabb { min, max }
    }

    pub(crate) fn len(&self) -> usize {
        self.boxes.len()
    }

    pub(crate) fn get(&self, cell: u32) -> &Aabb<3> {
        &self.boxes[cell as usize]
    }

    /// Whether a box along the axes of the table lies in the union of cells that are boxes. Exact; with many cells it gives up and denies it.
    pub(crate) fn cover(&self, b: &Aabb<3>, cells: &[u32]) -> bool {
        const MOST: usize = 64;
        cells.len() <= MOST && self.cover_rest(*b, cells)
    }

    fn cover_rest(&self, mut rest: Aabb<3>, cells: &[u32]) -> bool {
        let Some((&cell, others)) = cells.split_first() else {
            return false;
        };
        let cell = self.get(cell);
        if (0..3).any(|k| cell.min[k] > rest.max[k] || cell.max[k] < rest.min[k]) {
            return self.cover_rest(rest, others);
        }
        // What is beyond a side of the cell is cut off, and the others have to cover it.
        for k in 0..3 {
            if rest.min[k] < cell.min[k] {
                let mut beyond = rest;
                beyond.max[k] = cell.min[k];
                if !self.cover_rest(beyond, others) {
                    return false;
                }
                rest.min[k] = cell.min[k];
            }
            if rest.max[k] > cell.max[k] {
                let mut beyond = rest;
                beyond.min[k] = cell.max[k];
                if !self.cover_rest(beyond, others) {
                    return false;
                }
                rest.max[k] = cell.max[k];
            }
        }
        true
    }
}

/// How far cells and portals may be from where the table has them, along each axis. Maps of Quake state the boxes of their leafs in whole units, and compilers move
/// corners of portals by less.
fn gap_of(table: &Table) -> f64 {
    table.frame().map_or(if table.kind().is_quake() { 1.0 } else { 0.0 }, |frame| frame.gap())
}

/// A box with everything within a width of it along each axis.
pub(crate) fn widened(b: &Aabb<3>, width: f64) -> Aabb<3> {
    if width == 0.0 {
        return *b;
    }
    // One place of rounding more than the sum can be off by.
    Aabb { min: b.min.map(|x| (x - width).next_down()), max: b.max.map(|x| (x + width).next_up()) }
}

/// Whether a box is in another.
pub(crate) fn lies_in(b: &Aabb<3>, other: &Aabb<3>) -> bool {
    (0..3).all(|k| other.min[k] <= b.min[k] && b.max[k] <= other.max[k])
}

/// The distance between two boxes, rounded, or less where its square is too large for a double.
pub(crate) fn between(a: &Aabb<3>, b: &Aabb<3>) -> f64 {
    let apart: [f64; 3] = std::array::from_fn(|k| (a.min[k] - b.max[k]).max(b.min[k] - a.max[k]).max(0.0));
    let square = apart.iter().map(|x| x * x).sum::<f64>();
    if square.is_finite() { square.sqrt() } else { apart.into_iter().fold(0.0, f64::max) }
}

/// A lower bound of the true distance, for one by [`between`].
pub(crate) fn rounded_down(distance: f64) -> f64 {
    distance / MORE
}

/// Whether what is this far by [`between`], or by such distances added and rounded down, may be within a reach.
pub(crate) fn is_within(distance: f64, reach: f64) -> bool {
    distance <= reach * MORE
}

/// How far cells are from each other: a lower bound for any two points of them.
#[derive(Debug)]
pub(crate) struct Distances<'a> {
    boxes: &'a Boxes,
    /// None for straight ways.
    portals: Option<Portals>,
}

impl<'a> Distances<'a> {
    pub(crate) fn new(table: &Table, boxes: &'a Boxes, ways: Ways) -> Self {
        let portals = (ways == Ways::Portals).then(|| Portals::of(table));
        Self { boxes, portals }
    }

    /// Calls `visit` with each other cell that may be within `most` of a cell, and a lower bound of how far it is; in ascending order of cells.
    pub(crate) fn each_within(&self, cell: u32, most: f64, walk: &mut Walk, mut visit: impl FnMut(u32, f64)) {
        let here = self.boxes.get(cell);
        if let Some(portals) = &self.portals {
            portals.walk(cell, here, most, walk);
            for &(other, far) in &walk.found {
                visit(other, far.max(between(here, self.boxes.get(other))));
            }
            return;
        }
        for (other, there) in (0..).zip(&self.boxes.boxes) {
            let far = between(here, there);
            if other != cell && is_within(far, most) {
                visit(other, far);
            }
        }
    }
}

/// Working memory of walks.
#[derive(Debug, Default)]
pub(crate) struct Walk {
    far: Vec<f64>,
    touched: Vec<u32>,
    cells: Vec<f64>,
    heap: BinaryHeap<Step>,
    /// Cells with how far they are, ascending by cell.
    found: Vec<(u32, f64)>,
}

/// A portal with how far it is; the nearest is the greatest.
#[derive(Debug, PartialEq)]
struct Step {
    far: f64,
    portal: u32,
}

impl Eq for Step {}

impl PartialOrd for Step {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Step {
    fn cmp(&self, other: &Self) -> Ordering {
        other.far.total_cmp(&self.far).then(other.portal.cmp(&self.portal))
    }
}

/// Boxes around the portals, and which cells they join.
#[derive(Debug)]
struct Portals {
    boxes: Vec<Aabb<3>>,
    cells: Vec<[u32; 2]>,
    first: Vec<u32>,
    of_cell: Vec<u32>,
}

impl Portals {
    fn of(table: &Table) -> Self {
        let gap = gap_of(table);
        let boxes = table.portals().iter().map(|p| widened(&Aabb::around(p.points.iter().copied()), gap)).collect();
        let cells: Vec<[u32; 2]> = table.portals().iter().map(|p| p.cells.map(|c| c.idx() as u32)).collect();
        let mut first = vec![0; table.n_cells() + 1];
        cells.iter().flatten().for_each(|&c| first[c as usize + 1] += 1);
        (1..first.len()).for_each(|i| first[i] += first[i - 1]);
        let mut next = first.clone();
        let mut of_cell = vec![0; 2 * cells.len()];
        for (portal, sides) in (0..).zip(&cells) {
            for &c in sides {
                of_cell[next[c as usize] as usize] = portal;
                next[c as usize] += 1;
            }
        }
        Self { boxes, cells, first, of_cell }
    }

    fn of_cell(&self, cell: u32) -> &[u32] {
        &self.of_cell[self.first[cell as usize] as usize..self.first[cell as usize + 1] as usize]
    }

    /// The shortest ways through portals from anywhere in a cell (Dijkstra 1959), as long as they may be within `most`: from portal to portal the distance
    /// of their boxes counts, and up to each portal at least that on the straight way.
    fn walk(&self, from: u32, here: &Aabb<3>, most: f64, walk: &mut Walk) {
        walk.far.resize(self.boxes.len(), f64::INFINITY);
        walk.cells.resize(self.first.len() - 1, f64::INFINITY);
        walk.found.clear();
        for &portal in self.of_cell(from) {
            walk.reach(portal, 0.0);
        }
        while let Some(Step { far, portal }) = walk.heap.pop() {
            if far > walk.far[portal as usize] {
                continue;
            }
            for cell in self.cells[portal as usize] {
                if cell == from {
                    continue;
                }
                if walk.cells[cell as usize].is_infinite() {
                    // Portals come by distance, so the first one is the nearest.
                    walk.cells[cell as usize] = far;
                    walk.found.push((cell, far));
                }
                for &next in self.of_cell(cell) {
                    let step = between(&self.boxes[portal as usize], &self.boxes[next as usize]);
                    // A sum is off by half a place, however many there are on a way.
                    let there = if step > 0.0 { (far + step).next_down() } else { far };
                    let there = there.max(between(here, &self.boxes[next as usize]));
                    if is_within(there, most) {
                        walk.reach(next, there);
                    }
                }
            }
        }
        walk.touched.drain(..).for_each(|p| walk.far[p as usize] = f64::INFINITY);
        walk.found.iter().for_each(|&(cell, _)| walk.cells[cell as usize] = f64::INFINITY);
        walk.found.sort_unstable_by_key(|&(cell, _)| cell);
    }
}

impl Walk {
    fn reach(&mut self, portal: u32, far: f64) {
        let known = &mut self.far[portal as usize];
        if far < *known {
            if known.is_infinite() {
                self.touched.push(portal);
            }
            *known = far;
            self.heap.push(Step { far, portal });
        }
    }
}
