//! From-region queries for boxes that are not cells, past the walls of a graph.
//!
//! Such a box may lie anywhere among the cells, and walls may lie inside it. Those do not count: the eye may be
//! anywhere between them and the side through which a line leaves the box, so only what lies between the box and a
//! target matters ([`Shaft`]). This is exact: a line that is free from where it leaves the box is seen by eyes just
//! before that point, and what an eye in the box sees is seen along a line that is free from there on. Groups of
//! targets are tested first, then their halves; targets that share a cell with the box, or lie on a line found earlier,
//! are visible.

mod found;
mod targets;

use super::atomic_bits::AtomicBitMatrix;
use super::kept::OF;
use super::on_threads;
use super::opaque::blockers_of;
use super::pairs::{CELL_BUDGET, GROUP_BUDGET, apart};
use crate::search::SearchOptions;
use found::FoundVisible;
use rayon::prelude::*;
use sightlines_cells::{Axial, CellGraph};
use sightlines_geometry::{Aabb, OneWayRectangle};
use sightlines_progress::{Allowance, Counter, Halt, Phase, Shares, Units, shares_of};
use sightlines_pvs::BitMatrix;
use sightlines_sightline::{BoxTarget, Shaft, ShaftCounters, ShaftLine, ShaftVerdict, Verdict};
use std::collections::VecDeque;
use targets::{CellLocator, Targets};

/// The phase of units of work: one for each box.
const PHASE: &str = "boxes";

/// The pairs to decide: of two boxes, which has to be symmetric, and of a box and an object.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PairMask {
    /// Boxes by boxes.
    pub boxes: BitMatrix,
    /// Boxes by objects.
    pub objects: BitMatrix,
}

/// The answer for boxes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BoxVisibility {
    /// Boxes by boxes: the requested pairs that see each other. Symmetric.
    pub boxes: BitMatrix,
    /// Boxes by objects: the requested pairs in which the box sees the object.
    pub objects: BitMatrix,
    /// Number of opaque rectangles that the walls were merged into.
    pub n_blockers: usize,
    /// Pairs that count as visible because deciding them would take too much effort, or more digits than doubles have.
    /// Like `counters`, it varies with threads, as a line for another pair may prove such a pair visible first.
    pub n_assumed: u64,
    /// The visible pairs that were not decided because the budget was spent; none if all were.
    pub left: Option<PairMask>,
    /// The work done. With several threads the counts vary from run to run; the answer does not.
    pub counters: ShaftCounters,
}

/// Finds which of `boxes` see each other, and which objects they see, past the walls of a graph.
///
/// * `graph`: cells that, together with `solid`, fill their whole bounding box; what is beyond it is unknown, so
///   whatever extends beyond it is visible.
/// * `solid`: boxes beside the cells that no line from a cell enters and that contain no eye.
/// * `boxes`: closed boxes, in scene units, that contain the eyes. They may overlap and straddle walls. Two of them see
///   each other if they touch, or if an open set of lines leads from inside one to inside the other without meeting a
///   wall between leaving the first and entering the second. Flat boxes, and those thinner than 2^-32 of the scene, are
///   thickened slightly.
/// * `fronts`, `objects`: as for [`axial_visibility`](super::axial_visibility).
/// * `asked`: the requested pairs.
///
/// Exact, except for thin boxes, which may see more, and pairs that take thousands of linear programs, which count as
/// visible. The same pairs for any number of threads. Cost: O(log n) queries for each hidden group; most visible
/// targets are found in the same cell, or on earlier lines. Memory: four bits for each pair.
///
/// # Errors
/// [`Halt`] by the observer, or by the store of units.
///
/// # Panics
/// If a matrix of `asked` has the wrong size.
pub fn box_visibility(
    graph: &CellGraph<Axial>,
    solid: &[Aabb<3>],
    fronts: &[OneWayRectangle],
    boxes: &[Aabb<3>],
    objects: &[Aabb<3>],
    asked: &PairMask,
    options: &SearchOptions<'_>,
) -> Result<BoxVisibility, Halt> {
    let fits = |m: &BitMatrix, n_cols: usize| m.n_rows() == boxes.len() && m.n_cols() == n_cols;
    assert!(fits(&asked.boxes, boxes.len()) && fits(&asked.objects, objects.len()), "a row for each box");
    let blockers = blockers_of(graph, solid, fronts);
    let places = CellLocator::new(graph);
    let thick: Vec<Aabb<3>> = boxes.iter().map(|b| places.thickened(b)).collect();
    let of_boxes = Targets::new(&thick, boxes, &places);
    let of_objects = Targets::new(objects, objects, &places);
    let known = FoundVisible {
        boxes: AtomicBitMatrix::new(boxes.len(), boxes.len()),
        objects: AtomicBitMatrix::new(boxes.len(), objects.len()),
        of_boxes: &of_boxes,
        of_objects: &of_objects,
        blockers: &blockers,
    };
    let counter = Counter::new(options.progress, "boxes past walls", boxes.len());
    let one = |shaft: &mut Shaft<'_>, Unfinished { eye, of_boxes, of_objects }: Unfinished, unit: Allowance<'_>| {
        let before = shaft.counters();
        let (own, thick, all) = (&boxes[eye], &thick[eye], options.budget);
        let mut from = BoxSearch { own, thick, id: eye, known: &known, shaft, all, n_assumed: 0 };
        // Each pair is decided once, from the lower number.
        let later = asked.boxes.iter_ones(eye).filter(|&other| other > eye);
        // Objects have half of what there is.
        let of_boxes = from.settle_all(Kind::Box, &places, later, of_boxes, unit.part(0.5));
        let of_objects = from.settle_all(Kind::Object, &places, asked.objects.iter_ones(eye), of_objects, unit);
        let n_assumed = from.n_assumed;
        (Unfinished { eye, of_boxes, of_objects }, n_assumed, shaft.counters() - before)
    };
    let mut answer = BoxVisibility {
        boxes: asked.boxes.clone(),
        objects: asked.objects.clone(),
        n_blockers: blockers.len(),
        n_assumed: 0,
        left: None,
        counters: ShaftCounters::default(),
    };
    // A result of a box says nothing of what was left.
    let units = if options.budget.is_limited() { Units::default() } else { options.units };
    let n_asked = |eye: usize| (asked.boxes.count_row(eye) + asked.objects.count_row(eye)) as f64;
    let costs: Vec<f64> = (0..boxes.len()).map(n_asked).collect();
    let shares_of_time = shares_of(&costs);
    on_threads(options.threads, |_| known.mark_within(graph, &places));
    let unfinished = units.through(&Phase::new(PHASE, &costs), || {
        on_threads(options.threads, |threads| {
            let mut unfinished: Vec<Unfinished> = (0..boxes.len()).map(Unfinished::all_of).collect();
            (answer.n_assumed, answer.counters) = (0, ShaftCounters::default());
            // What a box was refused for the sake of the others it gets when they are done.
            let mut is_first = true;
            while is_first || (!unfinished.is_empty() && !options.budget.is_over()) {
                let shares = Shares::new(options.budget, unfinished.len(), threads);
                let found = std::mem::take(&mut unfinished).into_par_iter().with_max_len(1).map_init(
                    || Shaft::new(&blockers),
                    |shaft, from| {
                        counter.check()?;
                        let eye = from.eye;
                        let (found, is_kept) = units.value(
                            (PHASE, eye, OF),
                            || Ok::<_, Halt>(Some(one(shaft, from, shares.next_unit()))),
                            |_| known.result_of(eye, asked),
                            |bytes| known.restore(eye, bytes).map(|()| None),
                        )?;
                        if is_first {
                            counter.step_by(shares_of_time[eye], is_kept)?
                        } else {
                            counter.check()?
                        }
                        Ok(found.flatten())
                    },
                );
                for (rest, n_assumed, counters) in found.collect::<Result<Vec<_>, Halt>>()?.into_iter().flatten() {
                    answer.n_assumed += n_assumed;
                    answer.counters = answer.counters + counters;
                    unfinished.extend(Some(rest).filter(Unfinished::is_some));
                }
                is_first = false;
            }
            Ok::<_, Halt>(unfinished)
        })
    })?;
    answer.left = known.give_up(&unfinished, asked, &places, boxes);
    for eye in 0..boxes.len() {
        for (matrix, marks) in [(&mut answer.boxes, &known.boxes), (&mut answer.objects, &known.objects)] {
            let hidden: Vec<usize> = matrix.iter_ones(eye).filter(|&other| !marks.get(eye, other)).collect();
            hidden.into_iter().for_each(|other| matrix.set(eye, other, false));
        }
        // A box sees itself, if that was requested.
        answer.boxes.set(eye, eye, asked.boxes.get(eye, eye));
    }
    Ok(answer)
}

/// A box, and the nodes of the trees of targets that were not visited for it.
struct Unfinished {
    eye: usize,
    of_boxes: Vec<u32>,
    of_objects: Vec<u32>,
}

impl Unfinished {
    /// A box for which nothing was visited.
    fn all_of(eye: usize) -> Self {
        Self { eye, of_boxes: vec![0], of_objects: vec![0] }
    }

    fn is_some(&self) -> bool {
        !self.of_boxes.is_empty() || !self.of_objects.is_empty()
    }
}

/// The kind of target.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Box,
    Object,
}

/// A box that contains eyes, and its solver.
struct BoxSearch<'a, 's, 'b> {
    own: &'a Aabb<3>,
    thick: &'a Aabb<3>,
    id: usize,
    known: &'a FoundVisible<'a>,
    shaft: &'s mut Shaft<'b>,
    /// What all boxes together may spend.
    all: Allowance<'a>,
    n_assumed: u64,
}

impl BoxSearch<'_, '_, '_> {
    /// Marks which of the given targets may be visible.
    ///
    /// Below the nodes `start` only; returns those that were not visited because the allowance was over.
    fn settle_all(
        &mut self,
        kind: Kind,
        places: &CellLocator,
        asked: impl Iterator<Item = usize>,
        start: Vec<u32>,
        allowance: Allowance<'_>,
    ) -> Vec<u32> {
        let known = self.known;
        let (targets, marks) = (known.targets(kind), known.marks(kind));
        if start.is_empty() || targets.boxes.is_empty() {
            return Vec::new();
        }
        let in_doubt = known.in_doubt(kind, self.id, self.own, places, asked);
        let (mut next, mut is_first) = (VecDeque::from(start), true);
        // With a limit the largest groups come first.
        let take = |next: &mut VecDeque<u32>| if allowance.is_limited() { next.pop_front() } else { next.pop_back() };
        while let Some(n) = take(&mut next) {
            // Each turn visits a node at least, unless all is spent, so turns come to an end.
            if allowance.is_over() && (!is_first || self.all.is_over()) {
                next.push_front(n);
                break;
            }
            is_first = false;
            let node = &targets.tree.nodes()[n as usize];
            let within = &targets.tree.order()[node.start as usize..node.end as usize];
            let is_left = |i: u32| in_doubt[i as usize] && !marks.get(self.id, i as usize);
            let n_left = within.iter().filter(|&&i| is_left(i)).count();
            if n_left == 0 {
                continue;
            }
            if node.is_leaf() {
                let left: Vec<u32> = within.iter().copied().filter(|&i| is_left(i)).collect();
                left.into_iter().for_each(|i| self.settle(kind, targets, i as usize));
                continue;
            }
            // If some member of a group is visible, nothing hides the whole group.
            let none_seen = || within.iter().all(|&i| !marks.get(self.id, i as usize));
            if n_left > 1 && apart(self.thick, &node.bounds) && none_seen() {
                match self.decide(kind, &node.bounds, GROUP_BUDGET) {
                    Verdict::Hidden(()) => continue,
                    Verdict::Visible(ShaftLine::Free(line)) => known.follow(&line, [self.thick, &node.bounds]),
                    Verdict::Visible(ShaftLine::Fine(_)) | Verdict::Undecided(_) => {}
                }
            }
            next.extend(targets.tree.children(n));
        }
        next.into()
    }

    /// Boxes see each other if either sees the other.
    fn decide(&mut self, kind: Kind, target: &Aabb<3>, budget: u32) -> ShaftVerdict {
        match kind {
            Kind::Box => self.shaft.decide_either(self.thick, target, budget),
            Kind::Object => self.shaft.decide(self.thick, target, BoxTarget::Surface, budget),
        }
    }

    fn settle(&mut self, kind: Kind, targets: &Targets<'_>, i: usize) {
        let target = &targets.boxes[i];
        let sight = if apart(self.thick, target) {
            self.decide(kind, target, CELL_BUDGET)
        } else {
            // After thickening, they overlap.
            return self.known.see(kind, self.id, i);
        };
        match sight {
            Verdict::Hidden(()) => return,
            Verdict::Visible(ShaftLine::Free(line)) => self.known.follow(&line, [self.thick, target]),
            Verdict::Visible(ShaftLine::Fine(_)) => {}
            Verdict::Undecided(_) => self.n_assumed += 1,
        }
        self.known.see(kind, self.id, i);
    }
}
