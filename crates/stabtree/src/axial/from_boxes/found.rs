//! What is known to be visible from boxes, while the search goes on.

use super::super::atomic_bits::AtomicBitMatrix;
use super::super::objects::touch;
use super::targets::{CellLocator, Targets};
use super::{Kind, PairMask, Unfinished};
use crate::search::ones;
use rayon::prelude::*;
use sightlines_cells::{Axial, CellGraph};
use sightlines_geometry::Aabb;
use sightlines_progress::read_whole;
use sightlines_pvs::BitMatrix;
use sightlines_pvs::runs::{read_runs, runs_of, write_runs};
use sightlines_sightline::{Blockers, FreeLine};

/// What is known to be visible: shared by all threads, and only ever extended.
pub(super) struct FoundVisible<'a> {
    pub(super) boxes: AtomicBitMatrix,
    pub(super) objects: AtomicBitMatrix,
    pub(super) of_boxes: &'a Targets<'a>,
    pub(super) of_objects: &'a Targets<'a>,
    pub(super) blockers: &'a Blockers,
}

impl FoundVisible<'_> {
    /// Marks what lies in one cell: nothing is between two points in it.
    pub(super) fn mark_within(&self, graph: &CellGraph<Axial>, places: &CellLocator) {
        // A box of eyes overlaps the interior of the cell; an object may be flat along an axis, but not within the
        // cell's border.
        let shares = |b: &Aabb<3>, cell: &Aabb<3>| (0..3).all(|k| b.min[k] < cell.max[k] && cell.min[k] < b.max[k]);
        (0..graph.n_cells()).into_par_iter().for_each(|cell| {
            let bounds = &places.extents[cell];
            let within = |targets: &Targets<'_>| {
                let mut row = vec![0u64; targets.boxes.len().div_ceil(64)];
                targets.tree.visit(
                    |node| shares(node, bounds),
                    |i| {
                        if shares(&targets.boxes[i as usize], bounds) && targets.can_be_reached(i as usize) {
                            row[i as usize / 64] |= 1 << (i % 64);
                        }
                    },
                );
                row
            };
            let boxes = within(self.of_boxes);
            if boxes.iter().all(|word| *word == 0) {
                return;
            }
            let objects = within(self.of_objects);
            for eye in boxes.iter().enumerate().flat_map(|(i, word)| ones(*word).map(move |bit| i * 64 + bit)) {
                self.boxes.set_all(eye, &boxes);
                self.objects.set_all(eye, &objects);
            }
        });
    }

    pub(super) fn marks(&self, kind: Kind) -> &AtomicBitMatrix {
        match kind {
            Kind::Box => &self.boxes,
            Kind::Object => &self.objects,
        }
    }

    pub(super) fn targets(&self, kind: Kind) -> &Targets<'_> {
        match kind {
            Kind::Box => self.of_boxes,
            Kind::Object => self.of_objects,
        }
    }

    /// Which of the asked targets have to be decided; marks those that are visible at once.
    pub(super) fn in_doubt(
        &self,
        kind: Kind,
        eye: usize,
        own: &Aabb<3>,
        places: &CellLocator,
        asked: impl Iterator<Item = usize>,
    ) -> Vec<bool> {
        let (targets, marks) = (self.targets(kind), self.marks(kind));
        let mut in_doubt = vec![false; targets.boxes.len()];
        let all = !places.holds(own);
        let near = places.components(own);
        for i in asked.filter(|&i| !marks.get(eye, i)) {
            if all || targets.outside[i] || touch(own, &targets.own[i]) {
                self.see(kind, eye, i);
            } else {
                let is_joined = || targets.components[i].iter().any(|c| near.binary_search(c).is_ok());
                in_doubt[i] = targets.can_be_reached(i) && is_joined();
            }
        }
        in_doubt
    }

    /// Marks as visible what was not decided, and returns it.
    pub(super) fn give_up(
        &self,
        unfinished: &[Unfinished],
        asked: &PairMask,
        places: &CellLocator,
        boxes: &[Aabb<3>],
    ) -> Option<PairMask> {
        let mut left = PairMask {
            boxes: BitMatrix::new(asked.boxes.n_rows(), asked.boxes.n_cols()),
            objects: BitMatrix::new(asked.objects.n_rows(), asked.objects.n_cols()),
        };
        for Unfinished { eye, of_boxes, of_objects } in unfinished {
            for (kind, nodes) in [(Kind::Box, of_boxes), (Kind::Object, of_objects)] {
                let (targets, marks) = (self.targets(kind), self.marks(kind));
                let asked: Vec<usize> = match kind {
                    Kind::Box => asked.boxes.iter_ones(*eye).filter(|other| other > eye).collect(),
                    Kind::Object => asked.objects.iter_ones(*eye).collect(),
                };
                let in_doubt = self.in_doubt(kind, *eye, &boxes[*eye], places, asked.into_iter());
                let nodes = nodes.iter().map(|&n| &targets.tree.nodes()[n as usize]);
                let within = nodes.flat_map(|node| &targets.tree.order()[node.start as usize..node.end as usize]);
                for i in within.map(|&i| i as usize).filter(|&i| in_doubt[i] && !marks.get(*eye, i)) {
                    match kind {
                        Kind::Box => [(*eye, i), (i, *eye)].iter().for_each(|&(a, b)| left.boxes.set(a, b, true)),
                        Kind::Object => left.objects.set(*eye, i, true),
                    }
                }
            }
        }
        for eye in 0..boxes.len() {
            left.boxes.iter_ones(eye).for_each(|i| self.see(Kind::Box, eye, i));
            left.objects.iter_ones(eye).for_each(|i| self.see(Kind::Object, eye, i));
        }
        (left.boxes.count_ones() + left.objects.count_ones() > 0).then_some(left)
    }

    /// What a box sees of what it was asked about, once that is decided: of boxes only later ones.
    pub(super) fn result_of(&self, eye: usize, asked: &PairMask) -> Vec<u8> {
        let boxes = asked.boxes.iter_ones(eye).filter(|&other| other > eye && self.boxes.get(eye, other));
        let objects = asked.objects.iter_ones(eye).filter(|&object| self.objects.get(eye, object));
        let mut out = Vec::new();
        write_runs(&runs_of(boxes.map(|other| other as u32)), &mut out);
        write_runs(&runs_of(objects.map(|object| object as u32)), &mut out);
        out
    }

    /// Marks what a box sees by a result; `None` if it is of other boxes, and then some may be marked.
    pub(super) fn restore(&self, eye: usize, bytes: &[u8]) -> Option<()> {
        let [n_boxes, n_objects] = [&self.of_boxes, &self.of_objects].map(|of| of.boxes.len() as u32);
        let [boxes, objects] =
            read_whole(bytes, |bytes| Some([read_runs(bytes, n_boxes)?, read_runs(bytes, n_objects)?]))?;
        boxes.into_iter().flatten().for_each(|other| self.see(Kind::Box, eye, other as usize));
        objects.into_iter().flatten().for_each(|object| self.see(Kind::Object, eye, object as usize));
        Some(())
    }

    /// Marks that a box sees something of a kind.
    pub(super) fn see(&self, kind: Kind, eye: usize, other: usize) {
        self.marks(kind).set(eye, other);
        if kind == Kind::Box {
            self.boxes.set(other, eye);
        }
    }

    /// Marks all boxes that a free line passes as seeing each other, and the objects on it.
    pub(super) fn follow(&self, line: &FreeLine, [from, to]: [&Aabb<3>; 2]) {
        let span = line.span(from, to, self.blockers);
        let mut passed: Vec<usize> = Vec::new();
        self.of_boxes.tree.visit(
            |node| span.may_meet(node),
            |i| {
                if span.passes_some_of(&self.of_boxes.boxes[i as usize]) {
                    passed.push(i as usize);
                }
            },
        );
        for (k, &a) in passed.iter().enumerate() {
            passed[..k].iter().for_each(|&b| self.see(Kind::Box, a, b));
        }
        self.of_objects.tree.visit(
            |node| span.may_meet(node),
            |i| {
                let target = &self.of_objects.boxes[i as usize];
                if span.meets(target) {
                    let is_both_ways = !self.blockers.has_one_way();
                    let leads = |eye: &&usize| is_both_ways || span.leads(&self.of_boxes.boxes[**eye], target);
                    passed.iter().filter(leads).for_each(|&eye| self.see(Kind::Object, eye, i as usize));
                }
            },
        );
    }
}
