//! The exact method: all sequences of portals that the eye looks through.

use super::Scratch;
use super::budget::CLIP;
use super::missing::{list_missing, meets};
use super::query::{Query, keep_mirrors};
use super::sweep::{keep_unfinished, sweep};
use crate::front::Facing;
use crate::trees::NO_NODE;
use sightlines_pvs::PortalId;

/// Portals that are looked at sequence by sequence, before the method turns to putting pieces together.
///
/// An eye in the open can look through very many sequences of portals, as open space is cut into many cells. The
/// limit is about where the other way begins to be quicker, by measurement.
const MOST_STEPS: u64 = 200;

/// The same where cells have no order from front to back, as in a pinwheel, or there are too many pieces. Beyond it the
/// answer is that of the incident portals: some 10 ms are enough for a frame.
const MOST_STEPS_WITHOUT_ORDER: u64 = 1 << 16;

/// A cell on the way from the eye.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frame {
    cell: u32,
    /// The portal that was crossed into it; none has this number at the root.
    entry: PortalId,
    /// The node of the stab tree, or none: then any way may follow.
    node: u32,
    /// What is to be tried next, and where that ends: children of the node, or ways of the cell.
    next: u32,
    end: u32,
    /// Whether ways are tried rather than children.
    by_ways: bool,
    /// Where its cone begins among the sides; it goes on to the next frame's.
    first_side: u32,
}

/// Keeps what a line from the eye leads to, through open portals, within the view; within rounding. `false` if that is too
/// much work: then what is near is kept as exactly as the work allowed, and of the rest all that the incident portals lead to.
pub(super) fn exact(query: &mut Query<'_>) -> bool {
    let allowed = query.scratch.work.left();
    list_missing(query);
    let left = query.scratch.work.left();
    // Where listing what there is takes more than half of the work, deciding about it would hardly come to an end.
    if left < allowed - left {
        keep_wanted(query);
        return false;
    }
    let first = query.seen.reflections.len();
    // Where there are too many sequences, the sweep needs what is left of the work.
    let most = MOST_STEPS.min(left / (4 * CLIP));
    if by_sequences(query, most) {
        return true;
    }
    // The next way finds all mirrors anew.
    query.seen.reflections.truncate(first);
    if sweep(query) {
        return true;
    }
    let mut swept = query.seen.reflections.split_off(first);
    if !query.scratch.work.is_spent() && by_sequences(query, MOST_STEPS_WITHOUT_ORDER) {
        return true;
    }
    query.seen.reflections.truncate(first);
    query.seen.reflections.append(&mut swept);
    keep_unfinished(query);
    false
}

/// Keeps all that the incident portals lead to, which is known already.
fn keep_wanted(query: &mut Query<'_>) {
    for k in 0..query.scratch.wanted.list().len() {
        query.keep(query.scratch.wanted.list()[k]);
    }
}

/// Looks along the sequences of portals, at `most` portals at most; `false` if there are more. What was kept until
/// then is right.
pub(super) fn by_sequences(query: &mut Query<'_>, most: u64) -> bool {
    let limit = query.scratch.n_steps.saturating_add(most);
    Search::begin(query).run(limit)
}

struct Search<'q, 'a> {
    query: &'q mut Query<'a>,
}

impl<'q, 'a> Search<'q, 'a> {
    fn begin(query: &'q mut Query<'a>) -> Self {
        let n_cells = query.subgraph.cells.len();
        let scratch = &mut *query.scratch;
        scratch.frames.clear();
        scratch.sides.clear();
        scratch.sides.extend_from_slice(&scratch.view);
        scratch.on_way.clear();
        scratch.on_way.resize(n_cells, false);
        Self { query }
    }

    /// Goes through all sequences; `false` if they are more than `limit` allows.
    fn run(&mut self, limit: u64) -> bool {
        self.enter(
            self.query.subgraph.root,
            PortalId(u32::MAX),
            self.query.subgraph.trees.as_ref().map_or(NO_NODE, |t| t.root()),
            0,
        );
        while let Some((way, node)) = self.next_way() {
            self.query.scratch.n_steps += 1;
            self.query.scratch.work.take(CLIP);
            if self.query.scratch.n_steps > limit || self.query.scratch.work.is_spent() {
                return false;
            }
            self.step(way, node);
        }
        true
    }

    /// The next way to try, and the node that it leads to; leaves cells that are done. `None` at the end.
    fn next_way(&mut self) -> Option<(u32, u32)> {
        loop {
            let subgraph = self.query.subgraph;
            let scratch = &mut *self.query.scratch;
            let frame = scratch.frames.last_mut()?;
            if frame.next < frame.end {
                frame.next += 1;
                let at = frame.next - 1;
                return Some(match &subgraph.trees {
                    Some(trees) if !frame.by_ways => {
                        let node = trees.child(at);
                        (trees.way(node), node)
                    }
                    _ => (at, NO_NODE),
                });
            }
            match &subgraph.trees {
                // The tree was cut here: whatever it has not, the ways have.
                Some(trees) if !frame.by_ways && trees.is_open(frame.node) => {
                    let ways = subgraph.ways_of(frame.cell);
                    (frame.by_ways, frame.next, frame.end) = (true, ways.start, ways.end);
                }
                _ => {
                    scratch.on_way[frame.cell as usize] = false;
                    scratch.sides.truncate(frame.first_side as usize);
                    scratch.frames.pop();
                }
            }
        }
    }

    fn step(&mut self, index: u32, node: u32) {
        let (subgraph, view) = (self.query.subgraph, self.query.view);
        let way = &subgraph.ways[index as usize];
        let Some(&Frame { entry, first_side, .. }) = self.query.scratch.frames.last() else { return };
        // A line goes through a convex cell once, and not back through the portal it came by.
        if way.portal == entry || self.query.scratch.on_way[way.to as usize] || !self.query.way_in_view(index) {
            return;
        }
        let (first, end) = (first_side as usize, self.query.scratch.sides.len());
        let passes = match way.front.facing(subgraph.corners(way.first_corner, way.n_corners), view.eye, view.slack) {
            Facing::Behind => false,
            Facing::Before => {
                let corners = subgraph.corners(way.first_corner, way.n_corners);
                let eye = self.query.eye();
                let Scratch { sides, cone, clipper, .. } = &mut *self.query.scratch;
                cone.clear();
                let passes = clipper.narrow(eye, corners, &sides[first..end], cone);
                sides.extend_from_slice(cone);
                passes
            }
            // The portal cannot narrow what its plane may contain.
            Facing::Level => {
                self.query.scratch.sides.extend_from_within(first..end);
                true
            }
        };
        let Query { subgraph, view, scratch, seen, .. } = &mut *self.query;
        if passes && meets(&mut scratch.missing, &mut scratch.work, &scratch.sides[end..], subgraph, view, seen) {
            self.enter(way.to, way.portal, node, end as u32);
        } else {
            scratch.sides.truncate(end);
        }
    }

    /// Enters a cell with the cone of the sides from `first_side` on, and keeps what that meets there.
    fn enter(&mut self, cell: u32, entry: PortalId, node: u32, first_side: u32) {
        let subgraph = self.query.subgraph;
        let ways = subgraph.ways_of(cell);
        let (by_ways, range) = match &subgraph.trees {
            Some(trees) if node != NO_NODE => (false, trees.children_range(node)),
            _ => (true, ways),
        };
        let frame = Frame { cell, entry, node, next: range.start, end: range.end, by_ways, first_side };
        self.query.scratch.frames.push(frame);
        self.query.scratch.on_way[cell as usize] = true;
        self.keep(cell, first_side as usize);
    }

    fn keep(&mut self, cell: u32, first_side: usize) {
        let subgraph = self.query.subgraph;
        self.query.seen.add_cell(subgraph.cells[cell as usize]);
        // No query from here on adds sides.
        let sides = std::mem::take(&mut self.query.scratch.sides);
        let cone = &sides[first_side..];
        self.query.keep_objects_in(cell, cone);
        keep_mirrors(self.query, cell, cone);
        self.query.scratch.sides = sides;
    }
}
