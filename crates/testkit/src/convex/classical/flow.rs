//! The walk from each gate, along every sequence of gates that planes do not rule out.

use super::clip::{Clipper, Plane, dot};
use super::gates::Gates;
use sightlines_geometry::Point3;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Steps between questions whether to stop.
const PATIENCE: u64 = 1024;

/// Where the walk is after some gates.
#[derive(Debug, Clone)]
struct Frame {
    /// The part of the first gate, and of the last, that lines may pass.
    source: Vec<Point3>,
    pass: Vec<Point3>,
    /// Cells that may still be seen.
    may_see: Vec<u64>,
    last: u32,
    /// Separators of source and pass, once a gate needed them.
    planes: Vec<Plane>,
    back_planes: Vec<Plane>,
    has_planes: bool,
}

/// The walk through a graph.
#[derive(Debug)]
pub(super) struct Walk<'g> {
    gates: &'g Gates,
    n_words: usize,
    tolerance: f64,
    pub(super) clipper: Clipper,
    pub(super) steps: u64,
    pub(super) n_finished: usize,
    /// Row by row for each gate: its bound, or what is seen through it once it is done.
    sets: Vec<u64>,
    is_done: Vec<bool>,
    frames: Vec<Frame>,
    /// What the gate under way sees.
    seen: Vec<u64>,
}

impl<'g> Walk<'g> {
    /// Finds the bounds. O(gates · gates reached).
    pub(super) fn new(gates: &'g Gates, tolerance: f64) -> Self {
        let n_words = gates.n_cells().div_ceil(64);
        let mut sets = vec![0u64; gates.len() * n_words];
        let mut waiting = Vec::new();
        for (row, gate) in sets.chunks_exact_mut(n_words.max(1)).zip(0..) {
            gates.bound(gate, tolerance, &mut waiting, row);
        }
        Self {
            gates,
            n_words,
            tolerance,
            clipper: Clipper::new(tolerance),
            steps: 0,
            n_finished: 0,
            sets,
            is_done: vec![false; gates.len()],
            frames: Vec::new(),
            seen: vec![0; n_words],
        }
    }

    /// Cells seen through a gate, or its bound.
    #[inline(always)]
    pub(super) fn seen_through(&self, gate: u32) -> &[u64] {
        &self.sets[gate as usize * self.n_words..][..self.n_words]
    }

    fn count(&self, gate: u32) -> u32 {
        self.seen_through(gate).iter().map(|word| word.count_ones()).sum()
    }

    /// Walks from all gates, those first that may see least: later ones then find their sets.
    pub(super) fn run(&mut self, stop: &mut dyn FnMut() -> bool) {
        let all = 0..self.gates.len() as u32;
        let mut waiting: BinaryHeap<_> = all.map(|gate| Reverse((self.count(gate), gate))).collect();
        while let Some(Reverse((count, gate))) = waiting.pop() {
            // Bounds that have shrunk were put into the heap again.
            if self.is_done[gate as usize] || count != self.count(gate) {
                continue;
            }
            if !self.walk_from(gate, stop) {
                return;
            }
            for shrunk in self.finish(gate) {
                waiting.push(Reverse((self.count(shrunk), shrunk)));
            }
        }
    }

    /// The walk from one gate; false if it was stopped.
    fn walk_from(&mut self, gate: u32, stop: &mut dyn FnMut() -> bool) -> bool {
        self.seen.fill(0);
        self.frame(0);
        let first = &mut self.frames[0];
        first.source.clone_from(&self.gates.get(gate).corners);
        first.may_see.clear();
        first.may_see.extend_from_slice(&self.sets[gate as usize * self.n_words..][..self.n_words]);
        first.last = gate;
        self.enter(gate, 0, stop)
    }

    /// Makes sure that there is a frame of a depth.
    fn frame(&mut self, depth: usize) {
        if self.frames.len() == depth {
            self.frames.push(Frame {
                source: Vec::new(),
                pass: Vec::new(),
                may_see: Vec::new(),
                last: 0,
                planes: Vec::new(),
                back_planes: Vec::new(),
                has_planes: false,
            });
        }
    }

    /// Looks round in the cell behind the last gate of a frame.
    fn enter(&mut self, first: u32, depth: usize, stop: &mut dyn FnMut() -> bool) -> bool {
        self.steps += 1;
        if self.steps.is_multiple_of(PATIENCE) && stop() {
            return false;
        }
        let gates = self.gates;
        let cell = gates.get(self.frames[depth].last).to;
        self.seen[cell as usize / 64] |= 1 << (cell % 64);
        self.frame(depth + 1);
        self.frames[depth].has_planes = false;
        for &exit in gates.exits(cell) {
            if self.narrow(depth, exit) && self.cut(first, depth, exit) && !self.enter(first, depth + 1, stop) {
                return false;
            }
        }
        true
    }

    /// What may be seen through another gate, for the next frame; whether there is anything new.
    #[inline]
    fn narrow(&mut self, depth: usize, exit: u32) -> bool {
        let to = self.gates.get(exit).to as usize;
        let [frame, next] = &mut self.frames[depth..=depth + 1] else { return false };
        if frame.may_see[to / 64] >> (to % 64) & 1 == 0 {
            return false;
        }
        let own = &self.sets[exit as usize * self.n_words..][..self.n_words];
        next.may_see.resize(self.n_words, 0);
        let mut new = 0;
        for (((next, may_see), own), seen) in next.may_see.iter_mut().zip(&frame.may_see).zip(own).zip(&self.seen) {
            *next = may_see & own;
            new |= *next & !seen;
        }
        new != 0
    }

    /// Source and pass of the next frame; whether lines may be left.
    #[inline]
    fn cut(&mut self, first: u32, depth: usize, exit: u32) -> bool {
        let [frame, next] = &mut self.frames[depth..=depth + 1] else { return false };
        let (gates, clipper) = (self.gates, &mut self.clipper);
        let (start, last, target) = (gates.get(first), gates.get(frame.last), gates.get(exit));
        // The same plane the other way cannot be crossed again.
        let is_opposite = dot(last.plane.normal, target.plane.normal) < -1.0 + 1e-9;
        if is_opposite && (last.plane.offset + target.plane.offset).abs() <= self.tolerance {
            return false;
        }
        next.last = exit;
        next.pass.clone_from(&target.corners);
        for plane in [&start.plane, &last.plane] {
            let ahead = plane.distance(target.center);
            if ahead < -target.radius || (ahead <= target.radius && !clipper.clip(&mut next.pass, plane)) {
                return false;
            }
        }
        let ahead = target.plane.distance(start.center);
        if ahead > start.radius {
            return false;
        }
        next.source.clone_from(&frame.source);
        if ahead >= -start.radius && !clipper.clip(&mut next.source, &target.plane.flipped()) {
            return false;
        }
        if depth == 0 {
            // Any line through two gates passes what their planes leave of them.
            return true;
        }
        if !frame.has_planes {
            clipper.separators(&frame.source, &frame.pass, false, &mut frame.planes);
            clipper.separators(&frame.pass, &frame.source, true, &mut frame.back_planes);
            frame.has_planes = true;
        }
        frame.planes.iter().chain(&frame.back_planes).all(|plane| clipper.clip(&mut next.pass, plane))
            && clipper.clip_between(&next.pass, &frame.pass, false, &mut next.source)
            && clipper.clip_between(&frame.pass, &next.pass, true, &mut next.source)
    }

    /// Puts what was seen in the place of the bound. Cells that no gate of this cell sees any more do not see it
    /// either: takes it out of the bounds of their gates, and returns these.
    fn finish(&mut self, gate: u32) -> Vec<u32> {
        let from = self.gates.get(gate).from;
        let mut lost: Vec<u64> =
            self.seen_through(gate).iter().zip(&self.seen).map(|(may, seen)| may & !seen).collect();
        let start = gate as usize * self.n_words;
        self.sets[start..start + self.n_words].copy_from_slice(&self.seen);
        self.is_done[gate as usize] = true;
        self.n_finished += 1;
        for &sibling in self.gates.exits(from) {
            lost.iter_mut().zip(self.seen_through(sibling)).for_each(|(lost, set)| *lost &= !set);
        }
        let mut shrunk = Vec::new();
        for (k, word) in lost.into_iter().enumerate() {
            let mut left = word;
            while left != 0 {
                let cell = 64 * k as u32 + left.trailing_zeros();
                left &= left - 1;
                for &exit in self.gates.exits(cell) {
                    let word = &mut self.sets[exit as usize * self.n_words + from as usize / 64];
                    if !self.is_done[exit as usize] && *word >> (from % 64) & 1 == 1 {
                        *word &= !(1 << (from % 64));
                        shrunk.push(exit);
                    }
                }
            }
        }
        shrunk
    }
}
