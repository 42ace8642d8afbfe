//! The cells that a body is in, and those that it may get into.

use crate::distance::{Boxes, Distances, Walk, Ways, between, is_within, lies_in, widened};
use crate::reaches::Reaches;
use sightlines_geometry::Aabb;
use sightlines_pvs::{CellId, Table, TableKind};
use std::sync::Arc;

/// A table with what its cells are to bodies.
#[derive(Debug)]
pub(crate) struct World {
    pub(crate) table: Arc<Table>,
    pub(crate) reaches: Reaches,
    boxes: Boxes,
    walks: Option<Walks>,
    /// The box around all cells, along the axes of the table.
    bounds: Aabb<3>,
    /// Whether there may be air outside of the cells, so that a box that is not all within them is partly where nothing is known.
    has_gaps: bool,
}

/// How far cells are from each other through portals, as far as that is kept.
#[derive(Debug)]
struct Walks {
    most: f64,
    first: Vec<u32>,
    cells: Vec<(u32, f64)>,
}

impl Walks {
    fn of(table: &Table, boxes: &Boxes, most: f64) -> Self {
        let distances = Distances::new(table, boxes, Ways::Portals);
        let (mut first, mut cells, mut walk) = (vec![0], Vec::new(), Walk::default());
        for cell in 0..boxes.len() as u32 {
            distances.each_within(cell, most, &mut walk, |other, far| cells.push((other, far)));
            first.push(cells.len() as u32);
        }
        Self { most, first, cells }
    }

    /// Whether a cell may be got to from one of these within a reach.
    fn may_reach(&self, from: &[u32], to: u32, reach: f64) -> bool {
        reach > self.most
            || from.iter().any(|&i| {
                let near = &self.cells[self.first[i as usize] as usize..self.first[i as usize + 1] as usize];
                let far = near.binary_search_by_key(&to, |&(cell, _)| cell).map(|at| near[at].1);
                i == to || far.is_ok_and(|far| is_within(far, reach))
            })
    }
}

impl World {
    /// `walks`: up to which distance ways through portals are kept, where they count
    pub(crate) fn new(table: Arc<Table>, reaches: Reaches, walks: f64) -> Self {
        let boxes = Boxes::of(&table);
        // A distance of which nothing can be said is none: then ways through portals count by cells alone.
        let walks = if walks >= 0.0 { walks } else { 0.0 };
        let walks = (reaches.ways() == Ways::Portals).then(|| Walks::of(&table, &boxes, walks));
        let bounds = (0..boxes.len() as u32).fold(Aabb::EMPTY, |all, cell| all.united(*boxes.get(cell)));
        let has_gaps = table.kind().leaves_gaps() || table.kind() == TableKind::Unspecified;
        Self { table, reaches, boxes, walks, bounds, has_gaps }
    }

    pub(crate) fn n_cells(&self) -> usize {
        self.boxes.len()
    }

    /// A box of the scene that can be looked up; none if nothing can be said of it.
    pub(crate) fn valid(&self, b: &Aabb<3>) -> Option<Aabb<3>> {
        let mut b = *b;
        if self.table.dimension() == 2 {
            (b.min[2], b.max[2]) = (0.0, 0.0);
        }
        let is_box = (0..3).all(|k| b.min[k].is_finite() && b.max[k].is_finite() && b.min[k] <= b.max[k]);
        is_box.then_some(b)
    }

    /// The cells that a valid box touches, ascending.
    pub(crate) fn touching(&self, b: &Aabb<3>, pending: &mut Vec<u32>, cells: &mut Vec<u32>) {
        cells.clear();
        self.table.for_each_touching(b.min, b.max, pending, |cell| {
            cells.push(cell.0);
            true
        });
        cells.sort_unstable();
        cells.dedup();
    }

    /// Whether a valid box, which touches these cells, is all where something is known: nothing of it is in air outside of all cells.
    pub(crate) fn is_known(&self, b: &Aabb<3>, touches: &[u32]) -> bool {
        let placed = self.boxes.place(b);
        let covered = if self.has_gaps {
            self.boxes.cover(&placed, touches)
        } else {
            // What is between cells is solid there, and nothing that is seen is in it.
            lies_in(&placed, &self.bounds)
        };
        covered && !touches.is_empty()
    }

    /// The cells that somebody in a valid box may get into within a reach; ascending. With the cells that the box touches, on the ways of the reaches.
    pub(crate) fn near(
        &self,
        b: &Aabb<3>,
        here: Option<&[u32]>,
        reach: f64,
        pending: &mut Vec<u32>,
        cells: &mut Vec<u32>,
    ) {
        cells.clear();
        let around = widened(b, reach);
        if self.valid(&around).is_none() {
            cells.extend(0..self.n_cells() as u32);
            return;
        }
        let around = if self.table.dimension() == 2 {
            Aabb { min: [around.min[0], around.min[1], 0.0], max: [around.max[0], around.max[1], 0.0] }
        } else {
            around
        };
        let placed = self.boxes.place(b);
        self.table.for_each_touching(around.min, around.max, pending, |cell| {
            if is_within(between(&placed, self.boxes.get(cell.0)), reach) {
                cells.push(cell.0);
            }
            true
        });
        cells.sort_unstable();
        cells.dedup();
        if let (Some(walks), Some(here)) = (&self.walks, here) {
            cells.retain(|&cell| walks.may_reach(here, cell, reach));
        }
    }

    /// Of cells that somebody in a valid box may get into, those into which somebody in a part of it may.
    pub(crate) fn near_part(&self, b: &Aabb<3>, here: &[u32], reach: f64, cells: &mut Vec<u32>) {
        let placed = self.boxes.place(b);
        let walks = |cell: u32| self.walks.as_ref().is_none_or(|walks| walks.may_reach(here, cell, reach));
        cells.retain(|&cell| is_within(between(&placed, self.boxes.get(cell)), reach) && walks(cell));
    }

    /// How far a cell is at least from a valid box.
    pub(crate) fn far(&self, b: &Aabb<3>, cell: u32) -> f64 {
        between(&self.boxes.place(b), self.boxes.get(cell))
    }

    pub(crate) fn row(&self, cell: u32) -> &[u64] {
        self.table.row(CellId(cell))
    }

    /// Whether bodies in some of these cells cannot see each other within these reaches, by reaches alone. A camera on an arm goes on no ways.
    pub(crate) fn are_hidden(&self, a: &[u32], a_reach: f64, has_arm: bool, b: &[u32], b_reach: f64) -> bool {
        use crate::reaches::WhoMoves;
        let hidden = |i: u32, j: u32| match self.reaches.movers() {
            WhoMoves::Both => self.reaches.are_hidden_within(i, j, a_reach.max(b_reach)),
            WhoMoves::One if b_reach == 0.0 => self.reaches.are_hidden_within(i, j, a_reach),
            WhoMoves::One if a_reach == 0.0 => self.reaches.are_hidden_within(j, i, b_reach),
            WhoMoves::One => false,
        };
        let holds = !has_arm || self.reaches.ways() == Ways::Straight;
        holds && a.iter().all(|&i| b.iter().all(|&j| hidden(i, j)))
    }
}
