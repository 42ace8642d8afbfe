//! Columns: cells of one cross-section that stand one behind the other along an axis, as above each other in a stairwell.
//!
//! Through a stairwell of n storeys, n² pairs of cells may see each other or may nearly do so, and groups are no help: the
//! box around cells beside a well contains the well. What hides such pairs is simple, though: from one cell, the cells
//! of a column are hidden from some member on. The box from that member to the last one is as narrow as the column, so one
//! query hides all of these. With the thresholds of all members of one column for another, one or two queries
//! for each member settle a number of pairs that grows with the square of the members.
//!
//! The thresholds of two columns depend on nothing but the scene, whoever asks first, and only pairs of a column that
//! are [far](FAR) from each other ever ask. So the answer depends neither on threads nor on the order of work. It
//! is that without columns, but for pairs that would be assumed visible, which may be proven hidden.

use super::AxialSearch;
use super::first_true::first_true;
use super::horizons::Horizons;
use super::witness_log::{FoundFor, Worker};
use sightlines_geometry::Aabb;
use sightlines_sightline::{ShaftLine, Verdict};
use std::sync::OnceLock;

/// Members of the shortest column that is worth it.
const SHORTEST: usize = 8;

/// Most columns, the longest ones; there is a place for each two of them.
const MOST: usize = 512;

/// Members of a column, next to a cell, that are decided as if there were no columns.
const FAR: usize = 3;

/// Most pairs of two groups that are looked up one by one.
const LOOKED_UP: usize = 4096;

/// Linear programs spent on a cell and a part of a column: what hides that is simple, or else pairs of cells are decided one by one.
const BUDGET: u32 = 32;

/// The column of a cell that is in none.
const NONE: u32 = u32::MAX;

/// The columns of a graph, and what has been found between them.
#[derive(Debug, Default)]
pub(super) struct Columns {
    columns: Vec<Column>,
    /// For each place its column and its index there.
    of: Vec<[u32; 2]>,
    /// For each column, and each that is seen from it, the thresholds of the members of the first: the least member of the
    /// second from which on all are hidden.
    thresholds: Vec<OnceLock<Box<[u32]>>>,
}

#[derive(Debug)]
struct Column {
    axis: usize,
    /// The places of its members, ascending along the axis.
    places: Vec<u32>,
}

/// Two cells of columns along one axis, the first before the second and far from it.
#[derive(Debug, Clone, Copy)]
struct FarPair {
    columns: [u32; 2],
    members: [u32; 2],
}

impl Columns {
    /// Finds the columns among the boxes at all places. O(n log n).
    pub(super) fn of(boxes: &[Aabb<3>]) -> Self {
        let mut found: Vec<Column> = (0..3).flat_map(|axis| along(boxes, axis)).collect();
        found.sort_by_key(|column| std::cmp::Reverse(column.places.len()));
        let mut all = Self { columns: Vec::new(), of: vec![[NONE; 2]; boxes.len()], thresholds: Vec::new() };
        for mut column in found {
            column.places.retain(|&place| all.of[place as usize][0] == NONE);
            if column.places.len() >= SHORTEST && all.columns.len() < MOST {
                for (index, &place) in (0u32..).zip(&column.places) {
                    all.of[place as usize] = [all.columns.len() as u32, index];
                }
                all.columns.push(column);
            }
        }
        all.thresholds.resize_with(all.columns.len().pow(2), OnceLock::new);
        all
    }

    fn between(&self, columns: [u32; 2]) -> &OnceLock<Box<[u32]>> {
        &self.thresholds[columns[0] as usize * self.columns.len() + columns[1] as usize]
    }
}

/// The columns along an axis that are long enough. Cells do not overlap, so those of one cross-section are in order.
fn along(boxes: &[Aabb<3>], axis: usize) -> Vec<Column> {
    let section = |place: u32| {
        let b = &boxes[place as usize];
        [(axis + 1) % 3, (axis + 2) % 3].map(|k| [b.min[k].to_bits(), b.max[k].to_bits()])
    };
    let mut places: Vec<u32> = (0..boxes.len() as u32).collect();
    let low = |place: u32| boxes[place as usize].min[axis];
    places.sort_unstable_by(|&a, &b| section(a).cmp(&section(b)).then(low(a).total_cmp(&low(b))).then(a.cmp(&b)));
    let same = places.chunk_by(|&a, &b| section(a) == section(b)).filter(|same| same.len() >= SHORTEST);
    same.map(|same| Column { axis, places: same.to_vec() }).collect()
}

impl AxialSearch<'_> {
    /// From now on pairs of columns are decided together.
    pub(super) fn use_columns(&mut self) {
        let boxes: Vec<Aabb<3>> = (0..self.cell_at.len()).map(|place| *self.bounds_at(place)).collect();
        self.columns = Columns::of(&boxes);
        self.horizons = Horizons::new(self.tree.nodes().len());
    }

    fn bounds_at(&self, place: usize) -> &Aabb<3> {
        &self.graph.cells()[self.cell_at[place] as usize].bounds
    }

    /// Two cells as a pair of columns, if they are one.
    fn far_pair(&self, a: usize, b: usize) -> Option<FarPair> {
        let all = &self.columns;
        let [of_a, of_b] = [*all.of.get(a)?, *all.of.get(b)?];
        if of_a[0] == NONE || of_b[0] == NONE {
            return None;
        }
        let axis = all.columns[of_a[0] as usize].axis;
        if axis != all.columns[of_b[0] as usize].axis {
            return None;
        }
        let first_is_a = self.bounds_at(a).min[axis] <= self.bounds_at(b).min[axis];
        let (first, [from, from_member], [to, to_member]) = if first_is_a { (a, of_a, of_b) } else { (b, of_b, of_a) };
        let is_far = to_member >= self.first_far(first, to);
        is_far.then_some(FarPair { columns: [from, to], members: [from_member, to_member] })
    }

    /// The first member of a column, or the end of it, that is far behind a cell.
    fn first_far(&self, place: usize, column: u32) -> u32 {
        let Column { axis, places } = &self.columns.columns[column as usize];
        let end = self.bounds_at(place).max[*axis];
        let behind = places.partition_point(|&other| self.bounds_at(other as usize).min[*axis] < end);
        (behind + FAR).min(places.len()) as u32
    }

    /// Whether two cells are hidden from each other by what is known about their columns.
    fn is_known_hidden(&self, a: usize, b: usize) -> bool {
        self.far_pair(a, b).is_some_and(|far| {
            let known = self.columns.between(far.columns).get();
            known.is_some_and(|thresholds| far.members[1] >= thresholds[far.members[0] as usize])
        })
    }

    /// Whether nothing remains to be decided of some places and others, by what is known about their columns; `false` for
    /// many pairs.
    pub(super) fn are_known_by_columns(&self, rows: [usize; 2], cols: [usize; 2]) -> bool {
        let is_in_column = |place: usize| self.columns.of.get(place).is_some_and(|of| of[0] != NONE);
        let known = |a: usize, b: usize| self.cells.get(a, b) || self.is_known_hidden(a, b);
        is_in_column(rows[0])
            && is_in_column(cols[0])
            && (rows[1] - rows[0]) * (cols[1] - cols[0]) <= LOOKED_UP
            && (rows[0]..rows[1]).all(|a| (cols[0]..cols[1]).all(|b| known(a, b)))
    }

    /// Whether all of some places and others are far pairs of columns, as far as the first of them tells. Columns decide those, and
    /// nearly all that is left sees each other.
    pub(super) fn are_columns(&self, rows: [usize; 2], cols: [usize; 2]) -> bool {
        let in_columns = |places: [usize; 2]| self.columns.of[places[0]..places[1]].iter().all(|of| of[0] != NONE);
        !self.columns.of.is_empty()
            && in_columns(rows)
            && in_columns(cols)
            && self.far_pair(rows[0], cols[0]).is_some()
            && self.far_pair(rows[1] - 1, cols[1] - 1).is_some()
    }

    /// Whether two cells are hidden from each other by their columns, which are examined if they are far from each
    /// other.
    pub(super) fn is_hidden_in_columns(&self, a: usize, b: usize, worker: &mut Worker<'_>) -> bool {
        self.far_pair(a, b).is_some_and(|far| {
            let between = self.columns.between(far.columns);
            let thresholds = between.get_or_init(|| self.thresholds_of(far.columns, worker));
            far.members[1] >= thresholds[far.members[0] as usize]
        })
    }

    /// For each member of a column, the first far member of another from which on all are hidden from it.
    ///
    /// From one member to the next, thresholds move along: so each begins where the last one ended.
    fn thresholds_of(&self, [from, to]: [u32; 2], worker: &mut Worker<'_>) -> Box<[u32]> {
        let end = self.columns.columns[to as usize].places.len() as u32;
        let mut beyond = 0;
        let of_member = |&place: &u32| {
            let first = self.first_far(place as usize, to);
            let guess = (first + beyond).min(end);
            let threshold = first_true(first, end, guess, |member| self.is_hidden_from(place, to, member, worker));
            beyond = threshold - first;
            threshold
        };
        self.columns.columns[from as usize].places.iter().map(of_member).collect()
    }

    /// Whether a column, from one of its members on, is hidden from a cell before it.
    fn is_hidden_from(&self, place: u32, column: u32, member: u32, worker: &mut Worker<'_>) -> bool {
        let Column { places, .. } = &self.columns.columns[column as usize];
        let [first, last] = [places[member as usize], places[places.len() - 1]].map(|place| place as usize);
        // What is assumed to be visible is so after the thresholds of its columns are known, so this changes nothing but the time.
        if self.cells.get(place as usize, first) {
            return false;
        }
        let from = self.bounds_at(place as usize);
        let rest = Aabb { min: self.bounds_at(first).min, max: self.bounds_at(last).max };
        match worker.shaft.decide_either(from, &rest, BUDGET) {
            Verdict::Hidden(()) => true,
            Verdict::Visible(ShaftLine::Free(line)) => {
                self.follow(&line, [from, &rest], FoundFor::Groups, worker);
                false
            }
            Verdict::Visible(ShaftLine::Fine(_)) | Verdict::Undecided(_) => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::opaque::opaque_rectangles;
    use super::*;
    use crate::search::SearchOptions;
    use sightlines_cells::{Axial, BoxCell, CellGraph, Portal};
    use sightlines_geometry::AxialDoor;
    use sightlines_kdtree::{AxialFace, AxialPortal, KdOptions, subdivide};
    use sightlines_sightline::Blockers;

    /// Two rooms above each other on each storey, both with a hole in the floor, the second hole every other time smaller; the
    /// graph of its cells.
    fn wells(storeys: usize) -> CellGraph<Axial> {
        let slab = |x: f64, y: f64, wide: f64| AxialFace::new(1, [x, y, 0.0], [x + wide, y, 2.0]);
        let storey = |k: usize| {
            let y = k as f64;
            // Between wells, half a wall on each storey.
            [
                slab(0.0, y, 1.0),
                slab(2.0, y, 1.0 - 0.25 * (k % 2) as f64),
                AxialFace::new(0, [1.0, y, 0.0], [1.0, y + 0.5, 2.0]),
            ]
        };
        let faces: Vec<AxialFace<3>> = (1..storeys).flat_map(storey).collect();
        let bounds = Aabb { min: [0.0; 3], max: [3.0, storeys as f64, 2.0] };
        let tree = subdivide(&faces, bounds, &KdOptions::default()).unwrap();
        let portal = |p: &AxialPortal<3>| {
            let shape = AxialDoor { extent: Aabb { min: p.min, max: p.max }, axis: p.axis as u8, forward: true };
            Portal { cells: p.cells, sides: [2 * p.axis as u32 + 1, 2 * p.axis as u32], shape }
        };
        let cells = tree.cells().iter().map(|cell| BoxCell { bounds: cell.bounds }).collect();
        CellGraph::new(cells, tree.portals().iter().map(portal).collect())
    }

    /// The impostor: thresholds that are one member too near hide what is seen, and a comparison notices.
    #[test]
    fn thresholds_that_are_too_near_hide_what_is_seen() {
        let graph = wells(16);
        let blockers = Blockers::new(opaque_rectangles(&graph, &[]));
        let seen = |by: Option<u32>| {
            let mut search = AxialSearch::new(&graph, &[], &blockers);
            if let Some(by) = by {
                search.use_columns();
                let other = {
                    let mut other = AxialSearch::new(&graph, &[], &blockers);
                    other.use_columns();
                    other
                };
                let n = search.columns.columns.len() as u32;
                let pairs = (0..n).flat_map(|a| (0..n).map(move |b| [a, b]));
                let along_one = |[a, b]: &[u32; 2]| {
                    search.columns.columns[*a as usize].axis == search.columns.columns[*b as usize].axis
                };
                for pair in pairs.filter(along_one) {
                    let mut near = other.thresholds_of(pair, &mut other.worker());
                    near.iter_mut().for_each(|threshold| *threshold = threshold.saturating_sub(by));
                    search.columns.between(pair).set(near).unwrap();
                }
            }
            let (counters, _) = search.answer(1, &SearchOptions::default()).unwrap();
            search.into_seen(counters).cells
        };
        let (right, exact, near) = (seen(Some(0)), seen(None), seen(Some(2)));
        assert_eq!(right, exact);
        assert!(near.count_ones() < exact.count_ones(), "{} of {}", near.count_ones(), exact.count_ones());
    }

    #[test]
    fn columns_are_cells_of_one_cross_section() {
        let cube = |x: usize, y: usize| {
            let min = [x as f64, y as f64, 0.0];
            Aabb { min, max: [min[0] + 1.0, min[1] + 1.0, 1.0] }
        };
        // Ten above each other, from the top down; nine of them begin rows of three; and one that is wider.
        let mut boxes: Vec<Aabb<3>> = (0..10).rev().map(|y| cube(0, y)).collect();
        boxes.extend((0..9).flat_map(|y| [cube(1, y), cube(2, y)]));
        boxes.push(Aabb { max: [1.5, 12.0, 1.0], ..cube(0, 11) });
        let all = Columns::of(&boxes);
        assert_eq!(all.columns.iter().map(|c| (c.axis, c.places.len())).collect::<Vec<_>>(), [(1, 10), (1, 9), (1, 9)]);
        assert_eq!(all.columns[0].places, (0..10).rev().collect::<Vec<u32>>());
        assert_eq!(all.of[28], [NONE; 2]);
        assert!((0..28).all(|place| {
            let [column, index] = all.of[place];
            all.columns[column as usize].places[index as usize] as usize == place
        }));
    }
}
