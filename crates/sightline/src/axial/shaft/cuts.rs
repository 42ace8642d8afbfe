//! The ways past a rectangle, as sets of rows.

use super::super::rows::{Octant, Row, first_and_last, others, sign};
use super::BoxTarget;
use sightlines_geometry::{Aabb, Point2, orient2d};

/// One row, or two that have to hold together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BypassRows {
    rows: [Row; 2],
    n_rows: usize,
}

impl BypassRows {
    fn one(row: Row) -> Self {
        Self { rows: [row; 2], n_rows: 1 }
    }

    pub(super) fn rows(&self) -> &[Row] {
        &self.rows[..self.n_rows]
    }

    /// The row of the lines that do not go this way, if it is a single one.
    pub(super) fn complement(&self) -> Option<Row> {
        let row = self.rows[0];
        (self.n_rows == 1).then_some(Row { early: row.late, late: row.early, from: row.to, to: row.from })
    }
}

/// The lines of one octant from one box to another.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ends<'a> {
    pub(super) from: &'a Aabb<3>,
    pub(super) to: &'a Aabb<3>,
    pub(super) target: BoxTarget,
    pub(super) octant: Octant,
}

impl Ends<'_> {
    /// The rows of lines that pass the insides of both boxes.
    pub(super) fn rows(&self) -> impl Iterator<Item = Row> + '_ {
        [self.from, self.to].into_iter().flat_map(|bounds| {
            let extents = [0, 1, 2].map(|i| first_and_last(bounds, self.octant, i));
            let pairs = (0..3).flat_map(|i| others(i).map(|j| (i, j)));
            pairs.map(move |(i, j)| Row { early: i, late: j, from: extents[i][0], to: extents[j][1] })
        })
    }

    /// Whether lines of the octant can lead from the one box to the other at all.
    pub(super) fn are_in_order(&self) -> bool {
        (0..3).all(|i| {
            let [start, _] = first_and_last(self.from, self.octant, i);
            let [_, end] = first_and_last(self.to, self.octant, i);
            sign(self.octant, i) * end > sign(self.octant, i) * start
        })
    }

    /// Whether a row may hold for some line between the boxes; `false` is certain.
    ///
    /// A row about two axes fixes the side of a point on which the line passes in their plane. A line crosses the
    /// diagonals of both boxes that run from side to side of it, the first before the second if the boxes lie one after
    /// the other. The orientation of two points and a third is linear in each, so it is largest at two ends of the
    /// diagonals.
    pub(super) fn may_hold(&self, row: &Row) -> bool {
        let (i, j) = (row.early, row.late);
        let apart = |k: usize| self.from.max[k] <= self.to.min[k] || self.to.max[k] <= self.from.min[k];
        if !apart(i) && !apart(j) {
            return true;
        }
        let ends = |b: &Aabb<3>| {
            let ([i0, i1], [j0, j1]) = (first_and_last(b, self.octant, i), first_and_last(b, self.octant, j));
            [Point2::new(i1, j0), Point2::new(i0, j1)]
        };
        let turn = sign(self.octant, i) * sign(self.octant, j);
        let point = Point2::new(row.from, row.to);
        let (starts, stops) = (ends(self.from), ends(self.to));
        starts.into_iter().any(|a| stops.into_iter().any(|b| turn * orient2d(a, b, point) > 0.0))
    }

    /// The ways of a line past a rectangle that is perpendicular to `axis`: beside one of its edges,
    /// across its plane before the first box is left, or after the second is entered. Ways that no line
    /// between the boxes takes may be missing.
    pub(super) fn ways_past(&self, rectangle: &Aabb<3>, axis: usize, mut take: impl FnMut(BypassRows)) {
        let at = rectangle.min[axis];
        for b in others(axis) {
            let [first, last] = first_and_last(rectangle, self.octant, b);
            for row in
                [Row { early: axis, late: b, from: at, to: first }, Row { early: b, late: axis, from: last, to: at }]
            {
                if self.may_hold(&row) {
                    take(BypassRows::one(row));
                }
            }
        }
        let (turn, [b, c]) = (sign(self.octant, axis), others(axis));
        let leaves = |k: usize| first_and_last(self.from, self.octant, k)[1];
        let enters = |k: usize| first_and_last(self.to, self.octant, k)[0];
        if turn * at < turn * leaves(axis) {
            let before = |k: usize| Row { early: axis, late: k, from: at, to: leaves(k) };
            take(BypassRows { rows: [before(b), before(c)], n_rows: 2 });
        }
        let beyond = match self.target {
            BoxTarget::Inside => turn * at > turn * enters(axis),
            BoxTarget::Surface => turn * at >= turn * enters(axis),
        };
        if beyond {
            let after = |k: usize| Row { early: k, late: axis, from: enters(k), to: at };
            take(BypassRows { rows: [after(b), after(c)], n_rows: 2 });
        }
    }
}
