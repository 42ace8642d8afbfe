//! Pairs of groups of cells, halved until one hides from the other or they are single cells.

use super::Question;
use sightlines_geometry::Aabb;
use sightlines_sightline::{FreeLine, Shaft, Sight, Target};
use std::sync::atomic::Ordering::Relaxed;

/// Linear programs spent on a pair of groups; one that takes more is halved.
pub(super) const GROUP_BUDGET: u32 = 64;

/// Linear programs spent on a pair of single cells, or a cell and an object, before it counts as visible.
pub(super) const CELL_BUDGET: u32 = 2000;

/// Two nodes of the tree of cells, the first not after the second.
pub(super) type Pair = [u32; 2];

/// Whether two boxes do not overlap along some axis.
pub(super) fn apart(a: &Aabb<3>, b: &Aabb<3>) -> bool {
    (0..3).any(|k| a.max[k] <= b.min[k] || b.max[k] <= a.min[k])
}

impl Question<'_> {
    /// Decides what can be decided of a pair; the rest is handed on as smaller pairs.
    pub(super) fn settle(&self, [a, b]: Pair, shaft: &mut Shaft<'_>, smaller: &mut impl FnMut(Pair)) {
        let (na, nb) = (self.tree.nodes()[a as usize], self.tree.nodes()[b as usize]);
        if a == b {
            if !na.is_leaf() {
                let [left, right] = self.tree.children(a);
                [[left, left], [left, right], [right, right]].into_iter().for_each(smaller);
            }
            return;
        }
        let (rows, cols) = ([na.start as usize, na.end as usize], [nb.start as usize, nb.end as usize]);
        if self.cells.all(rows, cols) {
            return;
        }
        if na.is_leaf() && nb.is_leaf() {
            self.settle_cells([rows[0], cols[0]], [&na.bounds, &nb.bounds], shaft);
            return;
        }
        if apart(&na.bounds, &nb.bounds) && !self.cells.any(rows, cols) {
            match shaft.decide(&na.bounds, &nb.bounds, Target::Inside, GROUP_BUDGET) {
                Sight::Blocked => return,
                Sight::Open(line) => self.follow(&line, [&na.bounds, &nb.bounds]),
                Sight::Undecided => {}
            }
        }
        let size = |b: &Aabb<3>| (0..3).map(|k| b.max[k] - b.min[k]).fold(0.0, f64::max);
        if nb.is_leaf() || (!na.is_leaf() && size(&na.bounds) >= size(&nb.bounds)) {
            self.tree.children(a).into_iter().for_each(|a| smaller([a, b]));
        } else {
            self.tree.children(b).into_iter().for_each(|b| smaller([a, b]));
        }
    }

    fn settle_cells(&self, [a, b]: [usize; 2], bounds: [&Aabb<3>; 2], shaft: &mut Shaft<'_>) {
        if !self.may_see_cell(a, b) {
            return;
        }
        match shaft.decide(bounds[0], bounds[1], Target::Inside, CELL_BUDGET) {
            Sight::Blocked => {}
            Sight::Open(line) => {
                self.follow(&line, bounds);
                self.join(a, b);
            }
            Sight::Undecided => {
                self.n_assumed.fetch_add(1, Relaxed);
                self.join(a, b);
            }
        }
    }

    fn join(&self, a: usize, b: usize) {
        self.cells.set(a, b);
        self.cells.set(b, a);
    }

    /// Marks everything that a line passes: its cells see each other, and the objects on it.
    pub(super) fn follow(&self, line: &FreeLine, [from, to]: [&Aabb<3>; 2]) {
        let span = line.span(from, to, self.blockers);
        let mut cells: Vec<usize> = Vec::new();
        self.tree.visit(
            |b| span.may_meet(b),
            |i| {
                let cell = self.regular[i as usize] as usize;
                if span.passes(&self.graph.cells()[cell].bounds) {
                    cells.push(self.place[cell] as usize);
                }
            },
        );
        for (i, &a) in cells.iter().enumerate() {
            cells[..i].iter().for_each(|&b| self.join(a, b));
        }
        self.object_tree.visit(
            |b| span.may_meet(b),
            |object| {
                if span.meets(&self.boxes[object as usize]) {
                    cells.iter().for_each(|&cell| self.objects.set(object as usize, cell));
                }
            },
        );
    }
}
