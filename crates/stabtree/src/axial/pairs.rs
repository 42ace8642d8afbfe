//! Pairs of groups of cells, halved until one is hidden from the other or they are single cells.

use super::atomic_bits::words_of;
use super::witness_log::{FoundFor, Line, Proof, Worker};
use super::{AxialSearch, PairsInDoubt};
use sightlines_geometry::{Aabb, BoxTree};
use sightlines_sightline::{FreeLine, FreeSpan, ShaftLine, Verdict};
use std::sync::atomic::Ordering::Relaxed;

/// Linear programs spent on a pair of groups; one that takes more is halved.
pub(super) const GROUP_BUDGET: u32 = 64;

/// Linear programs spent on a pair of single cells, or a cell and an object, before it counts as visible.
pub(super) const CELL_BUDGET: u32 = 2000;

/// The same if only some pairs are to be decided: less depends on the answer.
pub(super) const FEW_BUDGET: u32 = 12;

/// If only some pairs are to be decided, groups with at most this many of them are halved at once.
pub(super) const FEW: u32 = 3;

/// Two nodes of the tree of cells, the first not after the second.
pub(crate) type Pair = [u32; 2];

/// Whether two boxes do not overlap along some axis.
pub(super) fn apart(a: &Aabb<3>, b: &Aabb<3>) -> bool {
    (0..3).any(|k| a.max[k] <= b.min[k] || b.max[k] <= a.min[k])
}

/// Which of two different nodes, not both leaves, is halved.
pub(crate) fn halves_first(tree: &BoxTree<3>, pair: Pair) -> bool {
    let [a, b] = pair.map(|n| tree.nodes()[n as usize]);
    let size = |b: &Aabb<3>| (0..3).map(|k| b.max[k] - b.min[k]).fold(0.0, f64::max);
    b.is_leaf() || (!a.is_leaf() && size(&a.bounds) >= size(&b.bounds))
}

impl AxialSearch<'_> {
    /// Decides a pair as far as possible; the rest is passed on as smaller pairs.
    pub(super) fn settle(&self, [a, b]: Pair, worker: &mut Worker<'_>, smaller: &mut impl FnMut(Pair)) {
        let (na, nb) = (self.tree.nodes()[a as usize], self.tree.nodes()[b as usize]);
        let (rows, cols) = ([na.start as usize, na.end as usize], [nb.start as usize, nb.end as usize]);
        if self.doubt.as_ref().is_some_and(|doubt| !doubt.cells.any_beyond(&self.cells, rows, cols)) {
            return;
        }
        if a == b {
            if !na.is_leaf() {
                let [left, right] = self.tree.children(a);
                [[left, left], [left, right], [right, right]].into_iter().for_each(smaller);
            }
            return;
        }
        if self.cells.all(rows, cols) || self.are_known_by_columns(rows, cols) {
            return;
        }
        if na.is_leaf() && nb.is_leaf() {
            if !self.is_beyond_horizon([a, b], worker) {
                self.settle_cells([rows[0], cols[0]], [&na.bounds, &nb.bounds], worker);
            }
            return;
        }
        let few = |doubt: &PairsInDoubt| doubt.cells.count_beyond(&self.cells, rows, cols, FEW) <= FEW;
        let worth_it = self.doubt.as_ref().is_none_or(|doubt| !few(doubt));
        if worth_it && apart(&na.bounds, &nb.bounds) && !self.cells.any(rows, cols) {
            if self.is_beyond_horizon([a, b], worker) {
                return;
            }
            if self.are_columns(rows, cols) {
                self.halve([a, b], smaller);
                return;
            }
            match worker.shaft.decide_either(&na.bounds, &nb.bounds, self.group_budget()) {
                Verdict::Hidden(()) => return,
                Verdict::Visible(ShaftLine::Free(line)) => {
                    self.follow(&line, [&na.bounds, &nb.bounds], FoundFor::Groups, worker);
                }
                Verdict::Visible(ShaftLine::Fine(_)) | Verdict::Undecided(_) => {}
            }
        }
        self.halve([a, b], smaller);
    }

    fn halve(&self, [a, b]: Pair, smaller: &mut impl FnMut(Pair)) {
        if halves_first(&self.tree, [a, b]) {
            self.tree.children(a).into_iter().for_each(|a| smaller([a, b]));
        } else {
            self.tree.children(b).into_iter().for_each(|b| smaller([a, b]));
        }
    }

    /// Whether two groups that contain two cells, given by their places in order, are hidden from each other. Not all of these
    /// groups have been tested: not those for which a [horizon](super::horizons) had not been sought yet, and few in a search in
    /// which only some pairs are in doubt.
    pub(super) fn is_hidden_in_groups(&self, [first, second]: [usize; 2], worker: &mut Worker<'_>) -> bool {
        let has = |n: u32, place: usize| {
            let node = &self.tree.nodes()[n as usize];
            (node.start as usize..node.end as usize).contains(&place)
        };
        let child = |n: u32, place: usize| {
            let [low, high] = self.tree.children(n);
            if has(low, place) { low } else { high }
        };
        let [mut a, mut b] = [0u32; 2];
        loop {
            if a == b {
                (a, b) = (child(a, first), child(b, second));
                continue;
            }
            let [na, nb] = [a, b].map(|n| self.tree.nodes()[n as usize]);
            if self.is_beyond([a, b], 0, worker) {
                return true;
            }
            if na.is_leaf() && nb.is_leaf() {
                return false;
            }
            let ask = apart(&na.bounds, &nb.bounds);
            if ask && worker.shaft.decide_either(&na.bounds, &nb.bounds, GROUP_BUDGET).is_hidden() {
                return true;
            }
            if halves_first(&self.tree, [a, b]) {
                a = child(a, first);
            } else {
                b = child(b, second);
            }
        }
    }

    /// Linear programs for a pair of groups.
    pub(super) const fn group_budget(&self) -> u32 {
        if self.doubt.is_some() { FEW_BUDGET } else { GROUP_BUDGET }
    }

    fn settle_cells(&self, [a, b]: [usize; 2], bounds: [&Aabb<3>; 2], worker: &mut Worker<'_>) {
        if !self.may_see_cell(a, b) || self.is_hidden_in_columns(a, b, worker) || self.cells.get(a, b) {
            return;
        }
        match worker.shaft.decide_either(bounds[0], bounds[1], CELL_BUDGET) {
            Verdict::Hidden(()) => {}
            Verdict::Visible(ShaftLine::Free(line)) => self.follow(&line, bounds, FoundFor::Cells([a, b]), worker),
            Verdict::Visible(ShaftLine::Fine(_)) => self.join_without_line([a, b], worker),
            Verdict::Undecided(_) if self.is_hidden_in_groups([a, b], worker) => {}
            Verdict::Undecided(_) => {
                self.n_assumed.fetch_add(1, Relaxed);
                self.join_without_line([a, b], worker);
            }
        }
    }

    /// Marks two cells, by place, as seeing each other where no line in doubles shows it.
    fn join_without_line(&self, [a, b]: [usize; 2], worker: &mut Worker<'_>) {
        if self.join(a, b) {
            let log = worker.log.iter_mut();
            log.for_each(|log| log.without_line.push([a, b].map(|place| self.cell_at[place])));
        }
    }

    /// Marks two cells, by index, as seeing each other and returns whether that was new; of several threads that join
    /// the same cells, one gets `true`.
    pub(super) fn join(&self, a: usize, b: usize) -> bool {
        let new = self.cells.set(a.min(b), a.max(b));
        self.cells.set(a.max(b), a.min(b));
        new
    }

    /// Marks everything that a line passes: its cells see each other, and the objects on it. Where walls hide from one side, only cells before
    /// an object are marked to see it.
    pub(super) fn follow(
        &self,
        line: &FreeLine,
        [from, to]: [&Aabb<3>; 2],
        found_for: FoundFor,
        worker: &mut Worker<'_>,
    ) {
        let span = line.span(from, to, self.blockers);
        let cells = self.cells_on(&span);
        self.mark(line, span, &cells, found_for, worker);
    }

    /// The cells, by their places, that the free part of a line certainly passes.
    pub(super) fn cells_on(&self, span: &FreeSpan) -> Vec<usize> {
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
        cells
    }

    /// Marks that `cells`, which the free part of a line passes, see each other, and the objects on it.
    pub(super) fn mark(
        &self,
        line: &FreeLine,
        span: FreeSpan,
        cells: &[usize],
        found_for: FoundFor,
        worker: &mut Worker<'_>,
    ) {
        if worker.log.is_none() {
            self.mark_all(&span, cells, found_for);
            return;
        }
        let number = worker.log.as_ref().map_or(0, |log| log.lines.len() as u32);
        let (mut pairs, mut seen) = (Vec::new(), Vec::new());
        let mut join = |a: usize, b: usize| {
            if self.join(a, b) {
                pairs.push(Proof { pair: [a, b].map(|place| self.cell_at[place]), line: number });
            }
        };
        for (i, &a) in cells.iter().enumerate() {
            cells[..i].iter().for_each(|&b| join(a, b));
        }
        if let FoundFor::Cells([a, b]) = found_for {
            join(a, b);
        }
        let mut see = |object: usize, place: usize| {
            if self.objects.set(object, place) {
                seen.push(Proof { pair: [object as u32, self.cell_at[place]], line: number });
            }
        };
        self.object_tree.visit(
            |b| span.may_meet(b),
            |object| {
                if span.meets(&self.boxes[object as usize]) {
                    cells.iter().for_each(|&place| see(object as usize, place));
                }
            },
        );
        if let FoundFor::Object([object, place]) = found_for {
            see(object, place);
        }
        if let Some(log) = worker.log.as_mut().filter(|_| !pairs.is_empty() || !seen.is_empty()) {
            log.lines.push(Line { line: *line, span });
            log.cells.append(&mut pairs);
            log.objects.append(&mut seen);
        }
    }

    /// The same if nobody keeps the line: a word of bits at a time, as a line down a stairwell passes cells of all storeys.
    fn mark_all(&self, span: &FreeSpan, cells: &[usize], found_for: FoundFor) {
        let words = words_of(cells);
        cells.iter().for_each(|&a| self.cells.set_words(a, &words));
        match found_for {
            FoundFor::Groups => {}
            FoundFor::Cells([a, b]) => {
                self.join(a, b);
            }
            FoundFor::Object([object, place]) => {
                self.objects.set(object, place);
            }
        }
        self.object_tree.visit(
            |b| span.may_meet(b),
            |object| {
                let target = &self.boxes[object as usize];
                if !span.meets(target) {
                    return;
                }
                if !self.blockers.has_one_way() {
                    return self.objects.set_words(object as usize, &words);
                }
                let leads =
                    |place: &&usize| span.leads(&self.graph.cells()[self.cell_at[**place] as usize].bounds, target);
                cells.iter().filter(leads).for_each(|&place| {
                    self.objects.set(object as usize, place);
                });
            },
        );
    }

    /// Marks what the free part of a line passes among places and objects that are new (`is_new`), paired with all that
    /// it passes; returns the newly marked pairs of cells, and of an object and a cell.
    pub(super) fn mark_new(&self, line: u32, span: &FreeSpan, is_new: &[Vec<bool>; 2]) -> [Vec<Proof>; 2] {
        let (mut pairs, mut seen) = (Vec::new(), Vec::new());
        let cells = self.cells_on(span);
        let (new, old): (Vec<usize>, Vec<usize>) = cells.iter().partition(|place| is_new[0][**place]);
        for (i, &a) in new.iter().enumerate() {
            for &b in new[..i].iter().chain(&old) {
                if self.join(a, b) {
                    pairs.push(Proof { pair: [a, b].map(|place| self.cell_at[place]), line });
                }
            }
        }
        let mut see = |object: u32, places: &[usize]| {
            let unseen = places.iter().filter(|place| self.objects.set(object as usize, **place));
            seen.extend(unseen.map(|&place| Proof { pair: [object, self.cell_at[place]], line }));
        };
        self.object_tree.visit(
            |b| span.may_meet(b),
            |object| {
                let places = if is_new[1][object as usize] { &cells } else { &new };
                if !places.is_empty() && span.meets(&self.boxes[object as usize]) {
                    see(object, places);
                }
            },
        );
        [pairs, seen]
    }
}
